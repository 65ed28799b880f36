// The macroscopic model's run_backend: scenario to solver, density to parts.

#include "core/base/checkpoint.h"
#include "core/base/memory.h"
#include "core/feed/density_entry.h"
#include "core/macro/macro.h"
#include "core/macro/mollifier.h"
#include "core/macro/moving_field.h"
#include "core/macro/velocity_field.h"
#include "core/run/beam.h"
#include "core/run/crossings.h"
#include "core/run/macro_flows.h"
#include "core/run/macro_sinks.h"
#include "core/run/macro_start.h"
#include "core/run/run_priv.h"
#include "core/run/schedule.h"
#include "core/scene/belt_range.h"
#include "core/scene/belt_slope.h"
#include "core/scene/counter.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct macro_run {
    macro_solver *solver;
    bool is_fed; // there are feeds
    bool tells_kinds;
    size_t n_belts;
    const scene_belt *belts; // borrowed from the scene
    uint16_t *belt_of;       // under each cell, n_belts off every one; NULL without feeds
    double *speeds;          // scratch: of a row's cells; same
    macro_flows *flows;      // same
    macro_sinks *sinks;      // NULL without sinks
    feed_density *feeds;
    moving_field *moving; // NULL: no obstacle moves, and no belt runs backwards
    double packing;       // parts/m2 at density 1
    bool may_drop;        // there are cells off every belt
    bf_grid grid;
    size_t n_counters;
    counter_cells counters[SCENE_COUNTERS_MAX];
    uint32_t kinds[SCENE_COUNTERS_MAX]; // that they count
    size_t n_eyes;
    crossings *crossings;
    beam_cells beams[SCENE_EYES_MAX]; // of eyes that see a density
    double broken_from
        [SCENE_EYES_MAX]; // density from which on such a beam is broken; 0: it sees parts
} macro_run;

static void check_step(const scene *s, bf_faults *faults)
{
    double step = s->macro.step, stable = scene_step_stable(s), turning = scene_step_turning(s);
    double n = ceil(s->duration / scene_macro_step(s));

    if (step > stable * (1.0 + RUN__STABLE_SLACK))
        faults_add(faults, "/macro/step_s",
                   "a step of %.10g s is unstable (CFL): the largest stable one is %.10g s", step,
                   stable);
    else if (step > turning * (1.0 + RUN__STABLE_SLACK))
        faults_add(faults, "/macro/step_s",
                   "in a step of %.10g s an obstacle moves by more than a cell; the largest one "
                   "without that is %.10g s",
                   step, turning);
    else if (s->duration < step)
        faults_add(faults, "/duration_s", "%.10g s are less than one step of %.10g s", s->duration,
                   step);
    else if (!(n <= SCENE_STEPS_MAX))
        faults_add_limit(faults, step > 0.0 ? "/macro/step_s" : "/duration_s",
                         "%.10g steps of the macroscopic model, the limit is %.10g", n,
                         SCENE_STEPS_MAX);
}

// A density is carried by belts that hold it.
static void check_slopes(const scene *s, bf_faults *faults)
{
    const scene_contact *conveyor = &s->micro.contact[SCENE_CONVEYOR_CARGO];
    char pointer[BF_POINTER_SIZE];

    for (size_t k = 0; k < s->n_belts; k++) {
        const scene_belt *belt = &s->belts[k];
        snprintf(pointer, sizeof pointer, "/belts/%zu/incline_deg", k);
        if (belt->incline == 0.0)
            continue;
        if (s->macro.closure == SCENE_DISPERSIVE)
            faults_add(faults, pointer,
                       "the density model has slopes with the closure 'congested' alone");
        else if (!(fabs(belt_slope_ratio(belt, conveyor)) <= BELT_SLOPE_HELD))
            faults_add(faults, pointer,
                       "cargo slides on such a slope, which a density does not: its tangent may be "
                       "%.2g of the friction of cargo on the belt",
                       BELT_SLOPE_HELD);
    }
}

// Kinds are carried by the fluxes of one closure and scheme (core/macro/kinds.h).
static void check_kinds(const scene *s, bf_faults *faults)
{
    if (!scene_tells_kinds(s))
        return;
    if (s->macro.closure != SCENE_CONGESTED)
        faults_add(
            faults, "/macro/closure",
            "the density model tells kinds of cargo apart with the closure 'congested' alone");
    if (s->macro.scheme != SCENE_SCHEME_ROE)
        faults_add(faults, "/macro/scheme",
                   "the density model tells kinds of cargo apart with the scheme 'roe' alone");
}

enum { CELL_BYTES = 80, CONGESTED_CELL_BYTES = 265 }; // see SCENE_CELLS_MAX

// Cells of which kinds and sinks have something are larger, so fewer of them fit the memory of a solver.
static void check_cells(const scene *s, bf_faults *faults)
{
    const bool is_congested = s->macro.closure == SCENE_CONGESTED, is_told = scene_tells_kinds(s);
    const bf_grid grid = scene_grid(s);
    const double n_kinds = is_told ? (double)s->n_cargo : 1.0, n_cells = (double)grid_cells(&grid);
    const double bytes = is_congested ? CONGESTED_CELL_BYTES : CELL_BYTES;
    double most = is_congested ? SCENE_CONGESTED_CELLS_MAX : SCENE_CELLS_MAX, more = 0.0;

    // Fractions before and after a step, while parts are placed once more, and what fell; three numbers for all kinds.
    if (is_told)
        more += sizeof(double) * ((s->may_drop ? 4.0 : 3.0) * n_kinds + 3.0);
    // An array that grows, and its copy, of a sink's cells for each kind; two numbers for all sinks.
    if (s->n_sinks > 0)
        more += 36.0 * n_kinds + 12.0;
    most = floor(most * bytes / (bytes + more));
    if (n_cells > most)
        faults_add_limit(faults, "/macro/cell_m",
                         "%.10g cells with kinds of cargo or sinks, the limit is %.10g", n_cells,
                         most);
}

static void check_scenario(const scene *s, bf_faults *faults)
{
    const bool is_dispersive = s->macro.closure == SCENE_DISPERSIVE;
    const int reach = mollifier_reach(s->macro.mollifier, scene_cell_edge(s));

    check_step(s, faults);
    check_slopes(s, faults);
    check_kinds(s, faults);
    check_cells(s, faults);
    macro_sinks_check(s, faults);
    if (is_dispersive && reach > MOLLIFIER_REACH_MAX)
        faults_add_limit(faults, "/macro/mollifier_per_m2",
                         "%d cells to reach over, the limit is %d", reach, MOLLIFIER_REACH_MAX);
}

// Enough tracers for a 95th percentile: about a thousand of what is offered, more where more than twice what the belts
// hold comes through.
static double tracer_portion(const scene *s, const macro_run *run)
{
    const double of_run = 1024.0, of_full_belts = 512.0;
    const double parts_per_cell = run->packing * run->grid.d1 * run->grid.d2;
    const double offered = feed_density_offered(run->feeds, s->duration);
    const double held = (double)grid_cells(&run->grid) / of_full_belts;

    if (!run->is_fed)
        return 0.0;
    return offered > 0.0 ? fmin(offered / (of_run * parts_per_cell), held) : held;
}

static macro_def def_of(const scene *s, const bf_world *w, const macro_run *run,
                        const velocity_field *f, int n_threads)
{
    macro_def def = macro_def_default();

    def.grid = f->grid;
    def.dt = scene_macro_step(s);
    def.scheme = s->macro.scheme;
    def.closure = s->macro.closure;
    def.heaviside = s->macro.heaviside;
    def.heaviside_width = s->macro.heaviside_width;
    memcpy(def.faces, f->faces, sizeof def.faces);
    def.off = f->off;
    def.tracer_portion = tracer_portion(s, run);
    def.n_kinds = run->tells_kinds ? s->n_cargo : 0;
    if (f->faces[0].belt != NULL) {
        def.n_belts = s->n_sections;
        def.belts = run->moving != NULL && moving_field_belts(run->moving) != NULL
                        ? moving_field_belts(run->moving)
                        : s->belts;
        def.world = w;
    }
    def.n_threads = n_threads;
    if (s->macro.closure == SCENE_CONGESTED) {
        const double edge = scene_cell_edge(s);
        def.dispersion = 0.0;
        def.mollifier = 16.0 / (edge * edge); // reaches over one cell: nothing is smoothed
        def.jam_density = s->macro.jam_density;
        def.slip_rate = s->micro.contact[SCENE_CONVEYOR_CARGO].tanh_linear;
        def.friction = s->micro.contact[SCENE_CONVEYOR_CARGO].friction;
        for (int side = 0; side < SCENE_SIDE_COUNT; side++)
            def.one_way[side] =
                s->edges[side] != SCENE_EDGE_OUTFLOW || scene_is_fed(s, (scene_side)side);
        return def;
    }
    def.dispersion = s->macro.dispersion;
    def.mollifier = s->macro.mollifier;
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        def.mirror[side] = scene_mirrors_walls(s) &&
                           (s->edges[side] == SCENE_EDGE_WALL || scene_is_fed(s, (scene_side)side));
    return def;
}

static bf_status create_solver(const scene *s, bf_world *w, int n_threads, macro_run *run,
                               bf_error *err)
{
    velocity_field *f = NULL;
    const bool changes =
        scene_has_moving_obstacles(s) || belt_range_may_reverse_any(s->n_sections, s->belts);
    bf_status status =
        changes ? moving_field_create(s, w, &run->moving, err) : velocity_field_create(s, &f, err);

    if (status != BF_OK)
        return status;
    const velocity_field *field = changes ? moving_field_now(run->moving) : f;
    const macro_def def = def_of(s, w, run, field, n_threads);
    run->may_drop = field->off != NULL;
    status = macro_create(&def, &run->solver, err);
    velocity_field_destroy(f);
    return status;
}

static void destroy_run(void *solver)
{
    macro_run *run = solver;

    if (run == NULL)
        return;
    macro_destroy(run->solver);
    feed_density_destroy(run->feeds);
    moving_field_destroy(run->moving);
    crossings_destroy(run->crossings);
    macro_flows_destroy(run->flows);
    macro_sinks_destroy(run->sinks);
    memory_free(run->belt_of);
    memory_free(run->speeds);
    for (size_t k = 0; k < run->n_eyes; k++)
        beam_cells_fini(&run->beams[k]);
    memory_free(run);
}

// The density of saturated cargo is jam_density with the congested closure.
static bf_status create_eyes(const scene *s, macro_run *run, bf_error *err)
{
    const double saturated = s->macro.closure == SCENE_CONGESTED ? s->macro.jam_density : 1.0;
    bf_status status = s->n_eyes > 0 ? crossings_create(s, &run->crossings, err) : BF_OK;

    for (size_t k = 0; k < s->n_eyes && status == BF_OK; k++, run->n_eyes++) {
        run->broken_from[k] = s->eyes[k].density_ratio * saturated;
        status = beam_cells_of(s->eyes[k].line, &run->grid, &run->beams[k], err);
    }
    return status;
}

static bf_status find_belts(const scene *s, macro_run *run, bf_error *err)
{
    const surroundings around = surroundings_of(s);
    const bf_grid *g = &run->grid;

    run->n_belts = s->n_sections;
    run->belts = s->belts;
    run->belt_of = memory_alloc(grid_cells(g), sizeof *run->belt_of);
    run->speeds = memory_alloc(g->n1, sizeof *run->speeds);
    if (run->belt_of == NULL || run->speeds == NULL)
        return bf_fail(err, BF_ENOMEM, "/macro/cell_m", "no memory for %zu cells", grid_cells(g));
    for (size_t cell = 0; cell < grid_cells(g); cell++) {
        const vec2 at = { grid_x1(g, cell % g->n1), grid_x2(g, cell / g->n1) };
        run->belt_of[cell] = (uint16_t)surroundings_belt_at(&around, at);
    }
    return BF_OK;
}

static bf_status create_run(const scene *s, bf_world *w, int n_threads, void **ret_solver,
                            run_plan *ret_plan, bf_error *err)
{
    macro_run *run = memory_alloc(1, sizeof *run);
    bf_status status;
    uint64_t n_parts = 0;

    if (run == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a run");
    run->is_fed = s->n_feeds > 0;
    run->tells_kinds = scene_tells_kinds(s);
    run->grid = scene_grid(s);
    run->packing = scene_packing_density(s);
    run->n_counters = s->n_counters;
    for (size_t k = 0; k < s->n_counters; k++) {
        run->counters[k] = counter_cells_of(&s->counters[k], &run->grid);
        run->kinds[k] = s->counters[k].kind;
    }
    if ((status = feed_density_create(s, scene_macro_step(s), &run->feeds, err)) != BF_OK ||
        (status = create_solver(s, w, n_threads, run, err)) != BF_OK ||
        (status = create_eyes(s, run, err)) != BF_OK ||
        (run->is_fed && (status = find_belts(s, run, err)) != BF_OK) ||
        (status = macro_start(s, run->solver, &n_parts, err)) != BF_OK ||
        (run->is_fed &&
         (status = macro_flows_create(s, run->solver, run->belt_of, &run->flows, err)) != BF_OK) ||
        (s->n_sinks > 0 &&
         (status = macro_sinks_create(s, run->solver, run->flows, &run->sinks, err)) != BF_OK)) {
        destroy_run(run);
        return status;
    }
    const double dt = scene_macro_step(s);
    *ret_plan = (run_plan){ .dt = dt,
                            .n_steps = schedule_steps_until(s->duration, dt),
                            .grid = run->grid,
                            .n_parts = n_parts,
                            .n_advance = 1,
                            .n_tick = 1 };
    *ret_solver = run;
    return BF_OK;
}

static double density_of_cell(const void *context, size_t cell)
{
    const macro_run *run = context;

    return macro_density(run->solver, cell);
}

static double factor_of_belt(const void *context, size_t belt)
{
    const macro_run *run = context;

    return macro_belt_factor(run->solver, belt);
}

static double parts_of(const macro_run *run, double density)
{
    return run->packing * run->grid.d1 * run->grid.d2 * density;
}

static const double *fractions_of_cell(const void *context, size_t cell)
{
    const macro_run *run = context;

    return macro_fractions(run->solver, cell);
}

static void add_to_cell(void *context, size_t cell, double density, vec2 at,
                        const double *fractions)
{
    const macro_run *run = context;

    macro_add(run->solver, cell, density, fractions);
    macro_trace(run->solver, at, density);
    macro_flows_add(run->flows, cell, parts_of(run, density), fractions);
}

static bf_status look_run(void *solver, size_t eye, run_view *ret_view, bf_error *err)
{
    const macro_run *run = solver;
    const crossings_field field = { run, density_of_cell, factor_of_belt,
                                    run->tells_kinds ? fractions_of_cell : NULL };
    const beam_cells *beam = &run->beams[eye];
    const double dense = run->broken_from[eye];
    bool is_broken = !(dense > 0.0) && crossings_advance(run->crossings, eye, &field);

    (void)err;
    for (size_t i = 0; dense > 0.0 && i < beam->n && !is_broken; i++)
        is_broken = density_of_cell(run, beam->cells[i]) >= dense;
    *ret_view = (run_view){ .is_broken = is_broken, .n_left = crossings_left(run->crossings, eye) };
    if (run->tells_kinds)
        ret_view->parts = crossings_parts(run->crossings, eye, &ret_view->n_parts);
    return BF_OK;
}

static bf_status admit_run(void *solver, figures *to, bf_error *err)
{
    macro_run *run = solver;
    const feed_field field = {
        .context = run, .density = density_of_cell, .factor = factor_of_belt, .add = add_to_cell
    };

    (void)to;
    (void)err;
    feed_density_advance(run->feeds, macro_time(run->solver), &field);
    return BF_OK;
}

static void hold(void *solver, size_t feed, bool is_held)
{
    const macro_run *run = solver;

    feed_density_hold(run->feeds, feed, is_held);
}

static feed_balance balance_run(const void *solver, size_t feed)
{
    const macro_run *run = solver;

    return feed_density_balance(run->feeds, feed);
}

static bool is_exhausted_run(const void *solver)
{
    const macro_run *run = solver;

    return feed_density_is_exhausted(run->feeds);
}

static bf_status remove_at_sinks(void *solver, bf_error *err)
{
    macro_run *run = solver;

    (void)err;
    macro_sinks_take(run->sinks);
    return BF_OK;
}

static void taken(const void *solver, double *ret_parts)
{
    const macro_run *run = solver;

    macro_sinks_taken(run->sinks, ret_parts);
}

static bf_status advance_run(void *solver, uint64_t n, bf_error *err)
{
    macro_run *run = solver;

    (void)err;
    for (uint64_t k = 0; k < n; k++) {
        if (run->moving != NULL)
            moving_field_update(run->moving, run->solver);
        macro_step(run->solver);
        if (run->is_fed)
            macro_flows_follow(run->flows);
    }
    return BF_OK;
}

static bf_status check_run(const void *solver, bf_error *err)
{
    const macro_run *run = solver;

    return macro_check(run->solver, err);
}

static void count_parts(const void *solver, double *ret_parts)
{
    const macro_run *run = solver;

    for (size_t k = 0; k < run->n_counters; k++) {
        ret_parts[k] =
            run->packing * macro_flows_mass_in(run->solver, run->kinds[k], &run->counters[k]);
    }
}

static void count_flows(void *solver, const double *contents, double left, double *ret_flows)
{
    const macro_run *run = solver;

    macro_flows_settle(run->flows, contents, left, ret_flows);
}

static double fallen_in(const void *solver, size_t counter)
{
    const macro_run *run = solver;

    return run->packing *
           macro_flows_fallen_in(run->solver, run->kinds[counter], &run->counters[counter]);
}

static run_load measure_run(const void *solver)
{
    const macro_run *run = solver;
    const macro_totals totals = macro_measure(run->solver);
    size_t n_tracers = 0;
    double portion;

    if (run->is_fed)
        (void)macro_tracers(run->solver, &n_tracers, &portion);
    return (run_load){ .parts = run->packing * totals.mass,
                       .fallen = run->packing * totals.fallen,
                       .entered = feed_density_admitted(run->feeds),
                       .peak = totals.peak,
                       .smooth_peak = totals.peak,
                       .relaxed = totals.relaxed,
                       .n_fields = totals.n_fields,
                       .n_tracers = (double)n_tracers,
                       .swept = totals.swept.all,
                       .varied = totals.swept.varied,
                       .dispersed = totals.swept.dispersed };
}

// What density thins out to without end is no cargo that has a time.
static const double least_density = 1e-9;

static void tell_exits(const void *solver, figures *to)
{
    const macro_run *run = solver;
    double portion;
    size_t n;
    const macro_exit *exits = macro_exits(run->solver, &n, &portion);

    for (size_t k = 0; k < n; k++)
        figures_exit(to, exits[k].left - exits[k].entered, parts_of(run, portion));
}

static void tell_ages(const void *solver, figures *to)
{
    const macro_run *run = solver;
    double portion;
    size_t n;
    const macro_tracer *tracers = macro_tracers(run->solver, &n, &portion);

    figures_forget_ages(to);
    for (size_t k = 0; k < n; k++)
        figures_add_age(to, macro_time(run->solver) - tracers[k].entered, parts_of(run, portion));
}

static void tell_cargo(const void *solver, figures *to)
{
    const macro_run *run = solver;
    const bf_grid *g = &run->grid;
    double factors[SCENE_BELTS_MAX], speeds[SCENE_BELTS_MAX]; // speeds: of straight belts

    for (size_t k = 0; k < run->n_belts; k++) {
        factors[k] = fabs(macro_belt_factor(run->solver, k));
        speeds[k] = vec2_length(run->belts[k].velocity) * factors[k];
    }
    for (size_t j = 0; run->is_fed && j < g->n2; j++) {
        const double *densities = macro_row(run->solver, j);
        macro_speeds(run->solver, j, run->speeds);
        for (size_t i = 0; i < g->n1; i++) {
            const size_t cell = j * g->n1 + i, belt = run->belt_of[cell];
            if (densities[i] <= least_density || belt == run->n_belts)
                continue;
            const vec2 at = { grid_x1(g, i), grid_x2(g, j) };
            const bool is_straight = run->belts[belt].turn == 0.0;
            const vec2 velocity = belt_velocity(&run->belts[belt], at);
            const figures_cargo cargo = { .at = at,
                                          .speed = run->speeds[i],
                                          .belt_speed = is_straight
                                                            ? speeds[belt]
                                                            : vec2_length(velocity) * factors[belt],
                                          .parts = parts_of(run, densities[i]),
                                          .age = (double)NAN };
            figures_add_cargo(to, &cargo, macro_fractions(run->solver, cell));
        }
    }
}

static bf_status take_snapshot(void *solver, float *ret_rho, run_load *ret_load, bf_error *err)
{
    const macro_run *run = solver;

    (void)err;
    macro_copy_density_float(run->solver, ret_rho);
    *ret_load = measure_run(run);
    return BF_OK;
}

static bf_status save_run(const void *solver, checkpoint_writer *w, bf_error *err)
{
    const macro_run *run = solver;

    if (run->moving != NULL)
        moving_field_save(run->moving, w);
    if (run->crossings != NULL)
        crossings_save(run->crossings, w);
    if (run->is_fed) {
        feed_density_save(run->feeds, w);
        macro_flows_save(run->flows, w);
    }
    if (run->sinks != NULL)
        macro_sinks_save(run->sinks, w);
    return macro_save(run->solver, w->out, err);
}

static bf_status load_run(void *solver, checkpoint_reader *r, bf_error *err)
{
    macro_run *run = solver;

    if ((run->moving != NULL && !moving_field_load(run->moving, run->solver, r)) ||
        (run->crossings != NULL && !crossings_load(run->crossings, r)) ||
        (run->is_fed && (!feed_density_load(run->feeds, r) || !macro_flows_load(run->flows, r))) ||
        (run->sinks != NULL && !macro_sinks_load(run->sinks, r)))
        return bf_fail(err, BF_ECORRUPT, "",
                       "the checkpoint's feeds, sinks or obstacles are damaged");
    return macro_load(run->solver, r->at, r->n_left, err);
}

static uint64_t digest_run(const void *solver)
{
    const macro_run *run = solver;

    return macro_digest(run->solver);
}

const run_backend run__macro = {
    .check_scenario = check_scenario,
    .create = create_run,
    .destroy = destroy_run,
    .advance = advance_run,
    .check = check_run,
    .count = count_parts,
    .measure = measure_run,
    .count_flows = count_flows,
    .taken = taken,
    .fallen_in = fallen_in,
    .snapshot = take_snapshot,
    .save = save_run,
    .load = load_run,
    .digest = digest_run,
    .tell_cargo = tell_cargo,
    .tell_ages = tell_ages,
    .tell_exits = tell_exits,
    .remove_at_sinks = remove_at_sinks,
    .look = look_run,
    .hold = hold,
    .admit = admit_run,
    .balance = balance_run,
    .is_exhausted = is_exhausted_run,
};
