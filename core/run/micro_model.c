// The microscopic model's run_backend: scenario to solver, parts to counts and density.

#include "core/base/faults.h"
#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/micro/hardness.h"
#include "core/micro/part_index.h"
#include "core/run/beam.h"
#include "core/run/micro_feeds.h"
#include "core/run/micro_press.h"
#include "core/run/micro_setup.h"
#include "core/run/micro_sinks.h"
#include "core/run/run_priv.h"
#include "core/run/schedule.h"
#include "core/scene/belt.h"
#include "core/scene/belt_range.h"
#include "core/scene/counter.h"
#include "core/scene/density.h"
#include "core/scene/mix.h"
#include "core/scene/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Steps of so many parts take some 10 ms on a slow processor, more where bodies move in space.
enum { PARTS_ADVANCED_PLANAR = 200000, PARTS_ADVANCED_SPATIAL = 10000 };

static const double longest_tick = 0.1; // s, where belts hardly move

// A row of FRAME_PARTS.
typedef struct part_row {
    uint64_t id;
    size_t part;
} part_row;

typedef struct micro_run {
    micro_solver *solver;
    const scene *scene;
    double packing; // parts/m2 at density 1
    bf_grid grid;
    double *rho;       // of the last snapshot
    scene_pose *poses; // of the parts in the domain then
    size_t n_poses_max;
    part_row *rows; // of the parts in the domain then, where parts may enter
    size_t n_rows, n_rows_max;
    size_t n_start;         // parts at the start
    double reduction_start; // of the moduli
    micro_sinks sinks;
    micro_feeds feeds;
    shape_footprint footprints[SCENE_KINDS_MAX];
    double bounding_radius; // no part extends farther from its centre, m
    passages_part *seen;    // at the beam looked at last
    size_t n_seen_max;
    photo_eye_part *seen_kinds; // the same parts
    size_t n_seen_kinds_max;
} micro_run;

static void destroy_run(void *solver)
{
    micro_run *run = solver;

    if (run == NULL)
        return;
    micro_feeds_fini(&run->feeds);
    micro_sinks_fini(&run->sinks);
    micro_destroy(run->solver);
    memory_free(run->rho);
    memory_free(run->poses);
    memory_free(run->rows);
    memory_free(run->seen);
    memory_free(run->seen_kinds);
    memory_free(run);
}

// How far a part extends from its centre at most, however it lies.
static double bound_radius(const scene_shape *shape, const shape_footprint *footprint)
{
    double farthest = 0.0;

    if (shape->type != SCENE_HULL)
        return hypot(footprint->bounding_radius, shape->height);
    for (size_t k = 0; k < shape->n_vertices; k++) {
        const double *at = shape->vertices[k];
        farthest = fmax(farthest, sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]));
    }
    return 2.0 * farthest; // no two points of it are farther apart
}

static bf_status fill_run(const scene *s, const micro_setup *setup, micro_run *run, bf_error *err)
{
    const micro_def *def = &setup->def;

    run->scene = s;
    run->packing = scene_packing_density(s);
    run->grid = scene_grid(s);
    run->n_start = def->n_parts;
    mix_footprints(s, run->footprints);
    for (size_t k = 0; k < s->n_cargo; k++)
        run->bounding_radius =
            fmax(run->bounding_radius, bound_radius(&s->cargo[k].shape, &run->footprints[k]));
    run->rho = memory_alloc(grid_cells(&run->grid), sizeof *run->rho);
    if (run->rho == NULL ||
        memory_reserve(&run->poses, &run->n_poses_max, def->n_parts, sizeof *run->poses) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the density of the parts");
    const bf_status status = micro_create(def, &run->solver, err);
    if (status != BF_OK)
        return status;
    run->reduction_start = micro_reduction(run->solver);
    micro_sinks_init(&run->sinks, s);
    return micro_feeds_init(&run->feeds, s, run->solver, &setup->placement, err);
}

// The smallest distance from the centre of a part of any kind to its border, seen from above.
static double smallest_radius(const micro_run *run)
{
    double smallest = INFINITY;

    for (size_t k = 0; k < run->scene->n_cargo; k++) {
        const shape_footprint *f = &run->footprints[k];
        const vec2 centre = { 0.0, 0.0 };
        if (f->n_corners == 0)
            smallest = fmin(smallest, f->bounding_radius);
        for (size_t i = 0; i < f->n_corners; i++)
            smallest = fmin(smallest, polygon_segment_distance(centre, f->corners[i],
                                                               f->corners[(i + 1) % f->n_corners]));
    }
    return smallest;
}

// In a tick no belt moves by more than a quarter of a part's radius, so that few parts of a feed come late and
// photo eyes see every part.
static uint64_t choose_tick(const micro_run *run, double dt)
{
    const scene *s = run->scene;
    double speed = 0.0;

    for (size_t k = 0; k < s->n_sections; k++)
        speed = fmax(speed, belt_largest_speed(&s->belts[k]) * belt_range_largest(&s->belts[k]));
    const double most = fmin(longest_tick, 0.25 * smallest_radius(run) / speed);
    return (uint64_t)fmax(floor(most / dt), 1.0);
}

static bf_status create_run(const scene *s, bf_world *w, int n_threads, void **ret_solver,
                            run_plan *ret_plan, bf_error *err)
{
    micro_setup setup;
    micro_run *run = NULL;
    bf_faults faults = { 0 };

    bf_status status = micro_setup_init(s, w, n_threads, &setup, err);
    if (status != BF_OK)
        return status;
    micro_setup_check(s, &setup, &faults);
    status = faults_status(&faults, err);
    if (status == BF_OK && (run = memory_alloc(1, sizeof *run)) == NULL)
        status = bf_fail(err, BF_ENOMEM, "", "no memory for a run");
    if (status == BF_OK)
        status = fill_run(s, &setup, run, err);
    micro_setup_fini(&setup);
    if (status != BF_OK) {
        destroy_run(run);
        return status;
    }
    const size_t n_parts = micro_parts(run->solver);
    const bool is_planar = micro_is_planar(run->solver);
    const size_t n_advance =
        (is_planar ? PARTS_ADVANCED_PLANAR : PARTS_ADVANCED_SPATIAL) / (n_parts + 1);
    const double dt = micro_dt(run->solver);
    *ret_plan =
        (run_plan){ .dt = dt,
                    .n_steps = schedule_steps_until(run->scene->duration, dt),
                    .grid = run->grid,
                    .n_parts = n_parts,
                    .n_values = (uint32_t)(is_planar ? FRAME_VALUES_PLANAR : FRAME_VALUES_SPATIAL) +
                                (run->scene->n_feeds > 0 ? FRAME_VALUES_FED : 0U),
                    .n_advance = n_advance + 1,
                    .n_tick = choose_tick(run, dt) };
    *ret_solver = run;
    return BF_OK;
}

static bf_status advance_run(void *solver, uint64_t n, bf_error *err)
{
    micro_run *run = solver;

    if (run->feeds.entry != NULL)
        micro_feeds_count_steps(&run->feeds, n);
    const bf_status status = micro_advance(run->solver, n, err);
    if (status != BF_ENUMERIC)
        return status;
    const double t = (double)micro_steps(run->solver) * micro_dt(run->solver);
    micro_press press;
    if (micro_press_now(run->solver, &press))
        return micro_press_fail(run->scene, &press, t, err);
    micro_thrown fastest = { .speed = 0.0 };
    for (size_t k = 0; k < micro_parts(run->solver); k++) {
        const micro_part part = micro_part_of(run->solver, k);
        const double speed = hypot(part.v[0], part.v[1]);
        if (!part.is_gone && speed > fastest.speed)
            fastest =
                (micro_thrown){ micro_id_of(run->solver, k), { part.x[0], part.x[1] }, speed };
    }
    return micro_press_fail_thrown(run->scene, &fastest, t, err);
}

static void count_parts(const void *solver, double *ret_parts)
{
    const micro_run *run = solver;
    const scene *s = run->scene;

    for (size_t c = 0; c < s->n_counters; c++)
        ret_parts[c] = 0.0;
    for (size_t k = 0; k < micro_parts(run->solver); k++) {
        const micro_part part = micro_part_of(run->solver, k);
        const vec2 at = micro_feeds_counted_place(s, (vec2){ part.x[0], part.x[1] });
        for (size_t c = 0; c < s->n_counters && !part.is_gone; c++)
            ret_parts[c] += counter_counts(&s->counters[c], run->feeds.tags[k].kind) &&
                                    counter_holds(&s->counters[c], at)
                                ? 1.0
                                : 0.0;
    }
}

static double fallen_in(const void *solver, size_t counter)
{
    const micro_run *run = solver;
    const scene_counter *c = &run->scene->counters[counter];
    double n = 0.0;

    for (size_t k = 0; k < micro_parts(run->solver); k++) {
        const micro_part part = micro_part_of(run->solver, k);
        const vec2 at = { part.x[0], part.x[1] };
        const bool is_counted =
            part.has_fallen && counter_counts(c, run->feeds.tags[k].kind) && counter_holds(c, at);
        n += is_counted ? 1.0 : 0.0;
    }
    return n;
}

static run_load measure_run(const void *solver)
{
    const micro_run *run = solver;
    run_load load = { .entered = micro_feeds_entered(&run->feeds) };

    for (size_t k = 0; k < micro_parts(run->solver); k++)
        load.parts += micro_is_gone(run->solver, k) ? 0.0 : 1.0;
    load.fallen = (double)micro_fallen(run->solver);
    load.n_rows = run->scene->n_feeds > 0 ? (uint64_t)load.parts : micro_parts(run->solver);
    return load;
}

static double largest_of(const double *rho, size_t n)
{
    double largest = 0.0;

    for (size_t c = 0; c < n; c++)
        largest = rho[c] > largest ? rho[c] : largest; // fmax() here makes GCC 12 for AArch64 fail
    return largest;
}

// The density (18) of the parts in the domain, so that both models can be compared cell by cell.
static bf_status take_snapshot(void *solver, float *ret_rho, run_load *ret_load, bf_error *err)
{
    micro_run *run = solver;
    const size_t n_cells = grid_cells(&run->grid), n_handles = micro_parts(run->solver);
    const double mollifier = run->scene->macro.initial_mollifier;
    const double widest = M_PI / scene_mean_footprint(run->scene); // deviation of a part's radius
    size_t n = 0;

    if (memory_reserve(&run->poses, &run->n_poses_max, n_handles, sizeof *run->poses) != 0 ||
        memory_reserve(&run->rows, &run->n_rows_max, n_handles, sizeof *run->rows) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts", n_handles);
    for (size_t k = 0; k < n_handles; k++) {
        const micro_part part = micro_part_of(run->solver, k);
        if (part.is_gone)
            continue;
        const vec2 at = micro_feeds_counted_place(run->scene, (vec2){ part.x[0], part.x[1] });
        run->rows[n] = (part_row){ micro_id_of(run->solver, k), k };
        run->poses[n++] = (scene_pose){ at.x, at.y, 0.0 };
    }
    run->n_rows = n;
    bf_status status =
        density_from_parts(&run->grid, run->packing, mollifier, run->poses, n, run->rho, err);
    if (status != BF_OK)
        return status;
    for (size_t c = 0; c < n_cells; c++)
        ret_rho[c] = (float)run->rho[c];
    const double peak = largest_of(run->rho, n_cells);
    if (mollifier > widest)
        status = density_from_parts(&run->grid, run->packing, widest, run->poses, n, run->rho, err);
    if (status != BF_OK)
        return status;
    *ret_load = measure_run(run);
    ret_load->peak = peak;
    ret_load->smooth_peak = largest_of(run->rho, n_cells);
    return BF_OK;
}

static void fill_row(const micro_part *part, bool is_planar, double *ret_row)
{
    if (is_planar) {
        const double row[FRAME_VALUES_PLANAR] = { part->x[0], part->x[1], part->heading,
                                                  part->v[0], part->v[1], part->w[2] };
        memcpy(ret_row, row, sizeof row);
        return;
    }
    memcpy(ret_row, part->x, sizeof part->x);
    memcpy(ret_row + 3, part->q, sizeof part->q);
    memcpy(ret_row + 7, part->v, sizeof part->v);
    memcpy(ret_row + 10, part->w, sizeof part->w);
}

static int compare_rows(const void *left, const void *right)
{
    const part_row *a = left, *b = right;

    return (a->id > b->id) - (a->id < b->id);
}

static void copy_parts(void *solver, double *ret_rows)
{
    micro_run *run = solver;
    const bool is_planar = micro_is_planar(run->solver);
    const size_t n_values = is_planar ? FRAME_VALUES_PLANAR : FRAME_VALUES_SPATIAL;

    if (run->scene->n_feeds > 0) {
        if (run->n_rows > 0)
            qsort(run->rows, run->n_rows, sizeof *run->rows, compare_rows);
        for (size_t k = 0; k < run->n_rows; k++) {
            const part_row *row = &run->rows[k];
            const micro_part part = micro_part_of(run->solver, row->part);
            *ret_rows++ = (double)row->id;
            *ret_rows++ = run->feeds.tags[row->part].kind;
            fill_row(&part, micro_is_planar(run->solver), ret_rows);
            ret_rows += n_values;
        }
        return;
    }
    for (size_t k = 0; k < micro_parts(run->solver); k++) {
        double *row = ret_rows + k * n_values;
        const micro_part part = micro_part_of(run->solver, k);
        if (!part.is_gone)
            fill_row(&part, is_planar, row);
        for (size_t v = 0; v < n_values && part.is_gone; v++)
            row[v] = NAN;
    }
}

static void fill_end(const void *solver, frame_end *end)
{
    const micro_run *run = solver;
    const micro_totals totals = micro_measure(run->solver);
    const size_t n_entered = (size_t)micro_feeds_entered(&run->feeds);

    end->n_parts_left =
        run->n_start + n_entered - totals.n_parts - (size_t)micro_fallen(run->solver);
    end->part_steps = run->feeds.entry != NULL
                          ? run->feeds.part_steps
                          : (double)run->n_start * (double)micro_steps(run->solver);
    end->n_contacts = totals.n_contacts;
    end->kinetic_energy = totals.kinetic_energy;
    end->largest_overlap = totals.largest_overlap;
    end->overlap_share = totals.overlap_share;
    if (run->scene->micro.modulus_reduction == 0.0) {
        end->reduction_start = run->reduction_start;
        end->reduction = micro_reduction(run->solver);
    }
}

// Whether what the run's parts did before is needed to go on.
static bool has_tags(const micro_run *run)
{
    return run->scene->n_feeds > 0 || run->scene->n_sinks > 0;
}

static bf_status save_run(const void *solver, checkpoint_writer *w, bf_error *err)
{
    const micro_run *run = solver;

    if (run->scene->n_sinks > 0)
        micro_sinks_save(&run->sinks, w);
    return has_tags(run) ? micro_feeds_save(&run->feeds, w, err)
                         : micro_save(run->solver, w->out, err);
}

static bf_status load_run(void *solver, checkpoint_reader *r, bf_error *err)
{
    micro_run *run = solver;

    if (run->scene->n_sinks > 0 && !micro_sinks_load(&run->sinks, r))
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint's sinks are damaged");
    return has_tags(run) ? micro_feeds_load(&run->feeds, r, err)
                         : micro_load(run->solver, r->at, r->n_left, err);
}

static void count_flows(void *solver, const double *contents, double left, double *ret_flows)
{
    const micro_run *run = solver;

    (void)contents;
    (void)left;
    memcpy(ret_flows, run->feeds.flows, run->feeds.n_flows * sizeof *ret_flows);
}

static void taken(const void *solver, double *ret_parts)
{
    const micro_run *run = solver;

    memcpy(ret_parts, run->sinks.taken, run->scene->n_sinks * sizeof *ret_parts);
}

static bf_status remove_at_sinks(void *solver, bf_error *err)
{
    micro_run *run = solver;

    return micro_sinks_take(&run->sinks, &run->feeds, err);
}

static bf_status depart(void *solver, run_departures *ret_departures, bf_error *err)
{
    micro_run *run = solver;

    return micro_feeds_depart(&run->feeds, ret_departures, err);
}

static void tell_cargo(const void *solver, figures *to)
{
    const micro_run *run = solver;

    for (size_t k = 0; k < micro_parts(run->solver); k++) {
        if (micro_is_gone(run->solver, k))
            continue;
        const micro_part part = micro_part_of(run->solver, k);
        const vec2 at = { part.x[0], part.x[1] };
        const figures_cargo cargo = {
            .at = at,
            .speed = hypot(part.v[0], part.v[1]),
            .belt_speed = vec2_length(micro_belt_velocity(run->solver, at)),
            .parts = 1.0,
            .age = run->feeds.entry == NULL ? (double)NAN : micro_feeds_age(&run->feeds, k)
        };
        double fractions[SCENE_KINDS_MAX] = { 0.0 };
        fractions[run->feeds.tags[k].kind] = 1.0;
        figures_add_cargo(to, &cargo, fractions);
    }
}

// A beam that is looked at.
typedef struct look {
    micro_run *run;
    const vec2 *beam;
    vec2 across; // unit normal, to where the belt under the middle moves
    size_t n;    // parts that break it
    bool has_memory;
} look;

// Of a part that breaks the beam, when its front and back cross it.
static void look_at_part(void *context, size_t part, const micro_extent *extent)
{
    look *l = context;
    micro_run *run = l->run;
    shape_footprint room;
    const shape_footprint *footprint =
        micro_footprint(extent, &run->footprints[extent->kind], &room);

    if (!beam_meets_part(l->beam, footprint, extent->pose))
        return;
    const beam_extent on_beam = beam_extent_of(l->beam[0], l->across, footprint, extent->pose);
    const micro_part state = micro_part_of(run->solver, part);
    const double speed = state.v[0] * l->across.x + state.v[1] * l->across.y;
    const double slowness = speed > 0.0 ? 1.0 / speed : (double)INFINITY; // s/m

    l->has_memory =
        l->has_memory &&
        memory_reserve(&run->seen, &run->n_seen_max, l->n + 1, sizeof *run->seen) == 0 &&
        memory_reserve(&run->seen_kinds, &run->n_seen_kinds_max, l->n + 1,
                       sizeof *run->seen_kinds) == 0;
    if (!l->has_memory)
        return;
    const uint64_t id = micro_id_of(run->solver, part);
    run->seen_kinds[l->n] = (photo_eye_part){ id, extent->kind };
    run->seen[l->n++] =
        (passages_part){ .id = id,
                         .since = on_beam.most > 0.0 ? on_beam.most * slowness : 0.0,
                         .left = on_beam.least < 0.0 ? -on_beam.least * slowness : 0.0 };
}

static int compare_seen(const void *left, const void *right)
{
    const passages_part *a = left, *b = right;

    return (a->id > b->id) - (a->id < b->id);
}

static bf_status look_at_beam(void *solver, size_t eye, run_view *ret_view, bf_error *err)
{
    micro_run *run = solver;
    const surroundings around = surroundings_of(run->scene);
    const vec2 *beam = run->scene->eyes[eye].line;
    const vec2 along = { beam[1].x - beam[0].x, beam[1].y - beam[0].y };
    const vec2 middle = { 0.5 * (beam[0].x + beam[1].x), 0.5 * (beam[0].y + beam[1].y) };
    const vec2 now = micro_belt_velocity(run->solver, middle);
    const vec2 belt = vec2_length(now) > 0.0 ? now : surroundings_velocity_under(&around, middle);
    const double length = copysign(vec2_length(along), along.y * belt.x - along.x * belt.y);
    look l = { .run = run,
               .beam = beam,
               .across = { along.y / length, -along.x / length },
               .has_memory = true };

    bf_status status = micro_visit_near(run->solver, beam[0], beam[1], run->bounding_radius,
                                        look_at_part, &l, err);
    if (status == BF_OK && !l.has_memory)
        status = bf_fail(err, BF_ENOMEM, "", "no memory for what a photo eye sees");
    if (status != BF_OK)
        return status;
    if (l.n > 0)
        qsort(run->seen, l.n, sizeof *run->seen, compare_seen);
    *ret_view =
        (run_view){ .is_broken = l.n > 0,
                    .passages = { .belt_speed = vec2_length(now), .n = l.n, .parts = run->seen },
                    .n_parts = l.n,
                    .parts = run->seen_kinds };
    return BF_OK;
}

static void hold(void *solver, size_t feed, bool is_held)
{
    const micro_run *run = solver;

    feed_parts_hold(run->feeds.entry, feed, is_held);
}

static bf_status admit(void *solver, figures *to, bf_error *err)
{
    micro_run *run = solver;

    return micro_feeds_admit(&run->feeds, to, err);
}

static feed_balance balance_of(const void *solver, size_t feed)
{
    const micro_run *run = solver;

    return feed_parts_balance(run->feeds.entry, feed);
}

static bool is_exhausted(const void *solver)
{
    const micro_run *run = solver;

    return feed_parts_are_exhausted(run->feeds.entry);
}

static uint64_t digest_run(const void *solver)
{
    const micro_run *run = solver;

    return micro_digest(run->solver);
}

const run_backend run__micro = {
    .check_scenario = micro_setup_check_scenario,
    .create = create_run,
    .destroy = destroy_run,
    .advance = advance_run,
    .count = count_parts,
    .measure = measure_run,
    .count_flows = count_flows,
    .taken = taken,
    .fallen_in = fallen_in,
    .snapshot = take_snapshot,
    .parts = copy_parts,
    .fill_end = fill_end,
    .save = save_run,
    .load = load_run,
    .digest = digest_run,
    .remove_at_sinks = remove_at_sinks,
    .depart = depart,
    .tell_cargo = tell_cargo,
    .look = look_at_beam,
    .hold = hold,
    .admit = admit,
    .balance = balance_of,
    .is_exhausted = is_exhausted,
};
