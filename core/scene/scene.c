#include "core/scene/scene.h"

#include "core/base/memory.h"
#include "core/base/vec2.h"
#include "core/scene/arc_lanes.h"
#include "core/scene/belt.h"
#include "core/scene/belt_path.h"
#include "core/scene/belt_range.h"
#include "core/scene/goods.h"
#include "core/scene/placement.h"
#include "core/scene/plate_range.h"
#include "core/scene/shape.h"
#include "core/scene/sink.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/// Velocity of a belt (m/s) and mollifier (1/m2) of the paper.
static const double paper_speed = 0.395;
static const double paper_mollifier = 10000.0;

static const scene_contact paper_contacts[SCENE_PAIR_COUNT] = {
    [SCENE_CARGO_CARGO] = { 0.008, 119.0, NAN, 10.0, 1.0 },
    [SCENE_CONVEYOR_CARGO] = { 0.008, 230.0, NAN, 10.0, 1.0 },
    [SCENE_HANDLING_CARGO] = { 0.008, 120.0, NAN, 10.0, 1.0 },
};

static const scene_rect unknown_rect = { NAN, NAN, NAN, NAN };

void scene_init(scene *s)
{
    *s = (scene){ .duration = NAN, .domain = unknown_rect };
    s->edges[SCENE_WEST] = SCENE_EDGE_INFLOW;
    s->edges[SCENE_EAST] = SCENE_EDGE_OUTFLOW;
    s->edges[SCENE_SOUTH] = SCENE_EDGE_WALL;
    s->edges[SCENE_NORTH] = SCENE_EDGE_WALL;
    s->n_cargo = 1;
    s->cargo_seed = 1;
    scene_cargo_init(&s->cargo[0]);
    s->initial = (scene_initial){ .type = SCENE_INITIAL_COUNT,
                                  .first = { NAN, NAN },
                                  .spacing = NAN,
                                  .region = unknown_rect,
                                  .seed = 1 };
    s->output = (scene_output){ .curve_every = 0.01, .snapshot_every = 0.1 };
    s->jam_time = SCENE_JAM_TIME;
    s->steady_precision = 0.05;
    s->macro = (scene_macro){ .step = NAN,
                              .closure = SCENE_CONGESTED,
                              .jam_density = 0.93,
                              .scheme = SCENE_SCHEME_ROE,
                              .heaviside = SCENE_HEAVISIDE_SHARP,
                              .heaviside_width = 0.05,
                              .dispersion = NAN,
                              .packing = NAN,
                              .mollifier = paper_mollifier,
                              .initial_mollifier = NAN };
    s->micro = (scene_micro){ .integrator = SCENE_INTEGRATOR_AUTO,
                              .step = NAN,
                              .overlap_limit = 0.2,
                              .damping = 0.1,
                              .gravity = 9.81,
                              .spin_friction_radius = NAN,
                              .wall_friction = NAN,
                              .conveyor = { 40e9, 0.05 },
                              .handling = { 70e9, 0.34 } };
    memcpy(s->micro.contact, paper_contacts, sizeof paper_contacts);
    s->surfaces = (scene_surfaces){ SCENE_SURFACE_COUNT, SCENE_SURFACE_COUNT };
}

void scene_cargo_init(scene_cargo *k)
{
    *k = (scene_cargo){ .goods = SCENE_GOODS_COUNT,
                        .share = 1.0,
                        .shape = { .type = SCENE_CYLINDER,
                                   .radius = 0.012,
                                   .height = 0.008,
                                   .length = NAN,
                                   .width = NAN },
                        .mass = NAN,
                        .surface = SCENE_SURFACE_COUNT,
                        .material = { 210e9, 0.28 },
                        .spin_friction_radius = NAN };
}

void scene_belt_init(scene_belt *b)
{
    *b = (scene_belt){ .velocity = { paper_speed, 0.0 },
                       .arc = { .reference_radius = NAN },
                       .path = { .width = NAN },
                       .acceleration = INFINITY,
                       .deceleration = INFINITY };
}

void scene_obstacle_init(scene_obstacle *o)
{
    *o = (scene_obstacle){ .thickness = 0.005,
                           .treatment = SCENE_SEALED,
                           .band = NAN,
                           .slide_width = NAN,
                           .pivot = { NAN, NAN },
                           .turn = { .repeat = INFINITY },
                           .presence = { .repeat = INFINITY } };
}

void scene_feed_init(scene_feed *f)
{
    *f = (scene_feed){ .edge = SCENE_SIDE_COUNT,
                       .line = { { NAN, NAN }, { NAN, NAN } },
                       .end = INFINITY,
                       .count = INFINITY,
                       .shape = 2,
                       .batch_size = 10,
                       .demand = SCENE_DEMAND_COUNT,
                       .rate = NAN,
                       .profile = { .repeat = INFINITY },
                       .seed = 1 };
}

void scene_photo_eye_init(scene_photo_eye *e)
{
    *e = (scene_photo_eye){ .line = { { NAN, NAN }, { NAN, NAN } } };
}

void scene_action_init(scene_action *a)
{
    *a = (scene_action){ .eye = SIZE_MAX,
                         .kind = SCENE_KIND_ANY,
                         .type = SCENE_ACTION_COUNT,
                         .target = SIZE_MAX,
                         .value = NAN,
                         .over = 0.5 };
}

void scene_output_window_init(scene_output_window *w)
{
    *w = (scene_output_window){ .from = NAN, .to = NAN, .curve_every = NAN, .snapshot_every = NAN };
}

void scene_counter_init(scene_counter *c)
{
    *c = (scene_counter){ .rect = unknown_rect, .kind = SCENE_KIND_ANY };
}

void scene_lane_init(scene_lane *lane)
{
    *lane = (scene_lane){ SIZE_MAX, SIZE_MAX };
}

void scene_merge_init(scene_merge *merge)
{
    *merge = (scene_merge){ .parts = INFINITY, .time = INFINITY };
}

void scene_sink_init(scene_sink *sink)
{
    *sink = (scene_sink){ .rate = INFINITY };
}

/// The value, or where there is none the one that follows from other members.
static void fill_in(double *value, double derived)
{
    if (isnan(*value))
        *value = derived;
}

/// The id of item n (from 0) where it has none: word, or word-2 and so on.
static void fill_in_id(char *id, const char *word, size_t n)
{
    if (id[0] == '\0' && n == 0)
        snprintf(id, SCENE_ID_SIZE, "%s", word);
    else if (id[0] == '\0')
        snprintf(id, SCENE_ID_SIZE, "%s-%zu", word, n + 1);
}

void scene_resolve_obstacle(scene_obstacle *o, double mollifier)
{
    bool is_sealed = o->treatment == SCENE_SEALED;

    if (o->n_points > 0) {
        fill_in(&o->pivot.x, o->path[0].x);
        fill_in(&o->pivot.y, o->path[0].y);
    }
    fill_in(&o->band, SCENE_BAND_FACTOR / sqrt(mollifier));
    fill_in(&o->slide_width, is_sealed ? SCENE_SLIDE_FACTOR / sqrt(mollifier) : SCENE_SLIDE_WIDTH);
}

// See scene_packing_density(). Rounding errors must not turn 1000 into 999.9.
static double cut_to_four_digits(double value)
{
    double unit = pow(10.0, floor(log10(value)) - 3.0);

    return unit >= 1.0 ? floor(value / unit * (1.0 + 1e-12)) * unit
                       : floor(value * round(1.0 / unit) * (1.0 + 1e-12)) / round(1.0 / unit);
}

// 2/3 of the radius: a disk with uniform pressure.
static double spin_radius_of(const scene_shape *shape)
{
    double radius =
        shape->type == SCENE_CYLINDER ? shape->radius : sqrt(shape_footprint_of(shape).area / M_PI);
    return 2.0 * radius / 3.0;
}

// 1/rho_max is the mean area of a part, weighted by the proportions.
static double mean_packing(const scene *s)
{
    double sum = 0.0, area = 0.0;

    if (s->n_cargo == 1)
        return shape_packing_density(&s->cargo[0].shape);
    for (size_t k = 0; k < s->n_cargo; k++) {
        sum += s->cargo[k].share;
        area += s->cargo[k].share / shape_packing_density(&s->cargo[k].shape);
    }
    return sum / area;
}

bool scene_acts_by_kind(const scene *s)
{
    bool acts = false;

    for (size_t k = 0; k < s->n_actions; k++)
        acts = acts || s->actions[k].kind != SCENE_KIND_ANY;
    return acts;
}

bool scene_tells_kinds(const scene *s)
{
    bool tells = scene_acts_by_kind(s);

    for (size_t k = 0; k < s->n_counters; k++)
        tells = tells || s->counters[k].kind != SCENE_KIND_ANY;
    for (size_t k = 0; k < s->n_sinks; k++)
        for (size_t kind = 0; kind < s->n_cargo; kind++)
            tells = tells || !sink_takes(&s->sinks[k], kind);
    return tells;
}

double scene_mean_footprint(const scene *s)
{
    double sum = 0.0, area = 0.0;

    for (size_t k = 0; k < s->n_cargo; k++) {
        sum += s->cargo[k].share;
        area += s->cargo[k].share * shape_footprint_of(&s->cargo[k].shape).area;
    }
    return area / sum;
}

// The Gaussian of a part (18) has the paper's proportion to it: 2 cm for a radius of 12 mm. Cells that are longer would miss it
// between their centres.
static double derived_initial_mollifier(const scene *s)
{
    const double edge = scene_cell_edge(s), paper = 2500.0 * 0.012 * 0.012;
    const double of_parts = cut_to_four_digits(paper * M_PI / scene_mean_footprint(s));

    return edge > 0.0 && isfinite(edge) ? fmin(of_parts, 1.0 / (edge * edge)) : of_parts;
}

static void resolve_cargo(scene *s)
{
    bool are_sound = true;

    s->is_mix = s->is_mix || s->n_cargo > 1;
    for (size_t k = 0; k < s->n_cargo; k++) {
        scene_cargo *kind = &s->cargo[k];
        const bool has_shape = shape_is_sound(&kind->shape) && kind->share > 0.0;
        are_sound = are_sound && has_shape;
        if (isnan(kind->mass))
            kind->mass = has_shape ? SCENE_STEEL_DENSITY * shape_volume(&kind->shape) : 1.0;
        if (s->micro.spin_friction_radius >= 0.0)
            fill_in(&kind->spin_friction_radius, s->micro.spin_friction_radius);
        fill_in(&kind->spin_friction_radius, has_shape ? spin_radius_of(&kind->shape) : 0.0);
    }
    fill_in(&s->micro.spin_friction_radius, s->cargo[0].spin_friction_radius);
    fill_in(&s->macro.packing, are_sound ? cut_to_four_digits(mean_packing(s)) : 1.0);
    fill_in(&s->macro.initial_mollifier, are_sound ? derived_initial_mollifier(s) : 1.0);
}

static void resolve_feed(const scene *s, scene_feed *f)
{
    const bool is_along_y = f->edge == SCENE_WEST || f->edge == SCENE_EAST;
    const scene_rect *domain = &s->domain;

    // On a side what is not given of the line's extent along it is the whole side.
    for (int end = 0; f->is_edge && end < 2; end++) {
        fill_in(&f->line[end].x, end == 0 ? domain->x_min : domain->x_max);
        fill_in(&f->line[end].y, end == 0 ? domain->y_min : domain->y_max);
        if (is_along_y)
            f->line[end].x = f->edge == SCENE_WEST ? domain->x_min : domain->x_max;
        else
            f->line[end].y = f->edge == SCENE_SOUTH ? domain->y_min : domain->y_max;
    }
    if (f->n_cargo > 0)
        return;
    f->n_cargo = s->n_cargo;
    for (size_t k = 0; k < s->n_cargo; k++)
        f->cargo[k] = (scene_feed_kind){ (uint32_t)k, s->cargo[k].share };
}

static void fill_in_numbered(char *id, const char *word, size_t n)
{
    if (id[0] == '\0')
        snprintf(id, SCENE_ID_SIZE, "%s-%zu", word, n + 1);
}

static void resolve_feeds_and_eyes(scene *s)
{
    if (s->initial.type == SCENE_INITIAL_COUNT && s->n_feeds > 0)
        s->initial.type = SCENE_INITIAL_EMPTY;
    for (size_t k = 0; k < s->n_cargo && s->n_feeds > 0; k++)
        fill_in_id(s->cargo[k].id, "cargo", k);
    for (size_t k = 0; k < s->n_feeds; k++) {
        fill_in_numbered(s->feeds[k].id, "feed", k);
        resolve_feed(s, &s->feeds[k]);
    }
    // Targets know what actions may do to them.
    for (size_t k = 0; k < s->n_actions; k++) {
        const scene_action *a = &s->actions[k];
        const bool is_plate = a->type == SCENE_ACTION_TURN || a->type == SCENE_ACTION_SHIFT ||
                              a->type == SCENE_ACTION_PRESENCE;
        if (is_plate && a->target < s->n_obstacles)
            s->obstacles[a->target].is_commanded = true;
        if (a->type == SCENE_ACTION_BELT && a->target < s->n_belts) {
            scene_belt *belt = &s->belts[a->target];
            belt->is_commanded = true;
            belt->command_factor = fmax(belt->command_factor, fabs(a->value));
            belt->command_reverses = belt->command_reverses || a->value < 0.0;
        }
    }
    for (size_t k = 0; k < s->n_merges; k++) {
        scene_merge *merge = &s->merges[k];
        fill_in_numbered(merge->id, "merge", k);
        if (merge->parts == INFINITY && merge->time == INFINITY)
            merge->parts = 1;
        for (size_t i = 0; i < merge->n_lanes; i++) {
            if (merge->lanes[i].belt >= s->n_belts)
                continue;
            scene_belt *belt = &s->belts[merge->lanes[i].belt];
            belt->is_commanded = true;
            belt->command_factor = fmax(belt->command_factor, 1.0);
        }
    }
    for (size_t k = 0; k < s->n_eyes; k++)
        fill_in_numbered(s->eyes[k].id, "eye", k);
    for (size_t k = 0; k < s->n_sinks; k++)
        fill_in_numbered(s->sinks[k].id, "sink", k);
    for (size_t k = 0; k < s->output.n_windows; k++) {
        fill_in(&s->output.windows[k].curve_every, s->output.curve_every);
        fill_in(&s->output.windows[k].snapshot_every, s->output.snapshot_every);
    }
}

// A member at fault is reported once, at its own place: derived values must then be valid.
static void resolve_derived(scene *s)
{
    double speed = scene_belt_speed(s);
    double mollifier = s->macro.mollifier > 0.0 ? s->macro.mollifier : paper_mollifier;

    resolve_cargo(s);
    goods_resolve(s);
    fill_in(&s->micro.wall_friction, fmax(s->micro.contact[SCENE_HANDLING_CARGO].friction, 0.0));
    fill_in(&s->micro.step, s->micro.integrator == SCENE_VERLET ? SCENE_MICRO_STEP : 0.0);
    // The paper's step belongs to its cells.
    const bool is_papers = s->macro.closure == SCENE_DISPERSIVE && s->macro.cell != 0.0;
    fill_in(&s->macro.step, is_papers ? SCENE_MACRO_STEP : 0.0);
    fill_in(&s->macro.dispersion, 2.0 * (isfinite(speed) ? speed : paper_speed));
    for (size_t k = 0; k < s->n_belts; k++)
        fill_in_id(s->belts[k].id, k == 0 ? "main" : "belt", k);
    size_t n = 0;
    for (size_t k = 0; k < s->n_belts; k++) {
        scene_stops *stops = &s->belts[k].stops;
        for (size_t i = 0; i < stops->n_failures; i++)
            fill_in_numbered(stops->failures[i].id, "failure", n++);
        stops->substream = s->substream;
        stops->until = s->duration;
    }
    for (size_t k = 0; k < s->n_obstacles; k++) {
        fill_in_numbered(s->obstacles[k].id, "obstacle", k);
        scene_resolve_obstacle(&s->obstacles[k], mollifier);
    }
    for (size_t k = 0; k < s->n_counters; k++) {
        scene_counter *c = &s->counters[k];
        fill_in_id(c->id, "upstream", k);
        fill_in(&c->rect.x_min, s->domain.x_min);
        fill_in(&c->rect.x_max, s->domain.x_max);
        fill_in(&c->rect.y_min, s->domain.y_min);
        fill_in(&c->rect.y_max, s->domain.y_max);
    }
    resolve_feeds_and_eyes(s);
}

bf_status scene_resolve(scene *s, bf_error *err)
{
    scene_belt *belt = s->n_belts == 0 ? memory_alloc(1, sizeof *belt) : NULL;
    scene_counter *counter = s->n_counters == 0 ? memory_alloc(1, sizeof *counter) : NULL;

    if ((s->n_belts == 0 && belt == NULL) || (s->n_counters == 0 && counter == NULL)) {
        memory_free(belt);
        memory_free(counter);
        return bf_fail(err, BF_ENOMEM, "", "no memory for a scenario");
    }
    if (belt != NULL) {
        scene_belt_init(belt);
        memory_free(s->belts);
        s->belts = belt;
        s->n_belts = 1;
    }
    if (counter != NULL) {
        scene_counter_init(counter);
        memory_free(s->counters);
        s->counters = counter;
        s->n_counters = 1;
    }
    for (size_t k = 0; k < s->n_belts; k++)
        if (s->belts[k].path.n_points == 0 && belt_resolve_arc(&s->belts[k], err) != BF_OK)
            return BF_ENOMEM;
    if (belt_path_lay_out(s, err) != BF_OK)
        return BF_ENOMEM;
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *o = &s->obstacles[k];
        scene_series *turn = &s->obstacles[k].turn;
        if (o->n_shifts == 0 || turn->n_values > 0)
            continue;
        // A schedule that only shifts an obstacle leaves its angle at 0.
        memory_free(turn->values);
        turn->values = memory_alloc(turn->n_times, sizeof *turn->values);
        if (turn->values == NULL)
            return bf_fail(err, BF_ENOMEM, "", "no memory for the motion of obstacles");
        turn->n_values = turn->n_times;
    }
    resolve_derived(s);
    belt_path_hand_on(s);
    surroundings around = { .domain = s->domain, .n_belts = s->n_sections, .belts = s->belts };
    memcpy(around.edges, s->edges, sizeof around.edges);
    s->may_drop = surroundings_may_drop(&around);
    for (size_t k = 0; k < s->n_belts; k++)
        s->belts[k].is_outlet = surroundings_is_outlet(&around, k);
    for (size_t k = s->n_belts; k < s->n_sections; k++)
        s->belts[s->belts[k].of].is_outlet |= surroundings_is_outlet(&around, k);
    return BF_OK;
}

static void free_series(scene_series *series)
{
    memory_free(series->times);
    memory_free(series->values);
}

bool scene_obstacle_moves(const scene_obstacle *o)
{
    return o->turn.n_times > 0 || o->presence.n_times > 0 || o->is_commanded;
}

bool scene_has_moving_obstacles(const scene *s)
{
    bool has = false;

    for (size_t k = 0; k < s->n_obstacles; k++)
        has = has || scene_obstacle_moves(&s->obstacles[k]);
    return has;
}

void scene_fini(scene *s)
{
    if (s == NULL)
        return;
    for (size_t k = 0; k < s->n_belts; k++) {
        memory_free(s->belts[k].speed_schedule.times);
        memory_free(s->belts[k].speed_schedule.factors);
        for (size_t i = 0; i < s->belts[k].stops.n_failures; i++) {
            memory_free(s->belts[k].stops.failures[i].times);
            memory_free(s->belts[k].stops.failures[i].durations);
        }
        memory_free(s->belts[k].stops.failures);
        memory_free(s->belts[k].stops.breaks);
        memory_free(s->belts[k].path.points);
        memory_free(s->belts[k].path.radii);
        memory_free(s->belts[k].polygon);
    }
    for (size_t k = s->n_belts; k < s->n_sections; k++)
        memory_free(s->belts[k].polygon);
    for (size_t k = 0; k < s->n_obstacles; k++) {
        memory_free(s->obstacles[k].path);
        free_series(&s->obstacles[k].turn);
        memory_free(s->obstacles[k].shifts);
        free_series(&s->obstacles[k].presence);
    }
    for (size_t k = 0; k < s->n_feeds; k++) {
        scene_feed *feed = &s->feeds[k];
        free_series(&feed->profile);
        memory_free(feed->schedule.times);
        memory_free(feed->schedule.counts);
        memory_free(feed->schedule.kinds);
        memory_free(feed->schedule.places);
        memory_free(feed->schedule.headings);
    }
    for (size_t k = 0; k < s->n_sinks; k++) {
        memory_free(s->sinks[k].polygon);
        memory_free(s->sinks[k].kinds);
    }
    for (size_t k = 0; k < s->n_merges; k++)
        memory_free(s->merges[k].lanes);
    memory_free(s->merges);
    memory_free(s->sinks);
    memory_free(s->feeds);
    memory_free(s->eyes);
    memory_free(s->actions);
    memory_free(s->output.windows);
    memory_free(s->belts);
    memory_free(s->obstacles);
    memory_free(s->counters);
    for (size_t k = 0; k < s->n_cargo; k++)
        memory_free(s->cargo[k].shape.vertices);
    memory_free(s->initial.poses);
    placement_fini(&s->placement);
    *s = (scene){ 0 };
}

double scene_packing_density(const scene *s)
{
    return s->macro.packing;
}

double scene_belt_speed(const scene *s)
{
    double speed = 0.0;

    for (size_t k = 0; k < s->n_belts; k++)
        speed = fmax(speed, vec2_length(s->belts[k].velocity));
    return speed;
}

// Due times up to the duration with a period outside windows and one of each window's own, and the start and end.
static double count_results(const scene *s, double every, size_t member)
{
    double n = floor(s->duration / every) + 2.0;

    for (size_t k = 0; k < s->output.n_windows; k++) {
        const scene_output_window *w = &s->output.windows[k];
        const double length = fmin(w->to, s->duration) - w->from;
        double own;
        memcpy(&own, (const char *)w + member, sizeof own);
        // At most one more than fits at each end.
        if (length > 0.0)
            n += floor(length / own) - floor(length / every) + 2.0;
    }
    return n;
}

double scene_samples(const scene *s)
{
    return count_results(s, s->output.curve_every, offsetof(scene_output_window, curve_every));
}

double scene_snapshots(const scene *s)
{
    return count_results(s, s->output.snapshot_every,
                         offsetof(scene_output_window, snapshot_every));
}

bool scene_is_fed(const scene *s, scene_side side)
{
    bool is_fed = false;

    for (size_t k = 0; k < s->n_feeds; k++)
        is_fed |= s->feeds[k].is_edge && s->feeds[k].edge == side;
    return is_fed;
}

bool scene_mirrors_walls(const scene *s)
{
    for (size_t k = 0; k < s->n_obstacles; k++) {
        if (s->obstacles[k].treatment != SCENE_SEALED)
            return false;
    }
    return true;
}

double scene_fit_step(const scene *s, double most, bool is_below)
{
    double every = s->output.curve_every, step = is_below ? most * (1.0 - 1e-9) : most;

    if (every >= most) {
        double n = is_below ? floor(every / most) + 1.0 : ceil(every / most * (1.0 - 1e-12));
        step = is_below && every / n >= most ? every / (n + 1.0) : every / n;
    }
    return fmin(step, s->duration);
}

// The largest speeds of a density.
typedef struct speeds {
    double face; // across a face, m/s
    double
        outflow; // out of a cell through all its faces, m/s, where that is bounded by its diagonal; else twice the first
    double dispersion; // m/s
} speeds;

// Belts that run apart, or come to, empty a cell between them through all its faces, where a plate turns cargo aside.
static bool may_part(const scene *s)
{
    bool may = s->n_belts > 1 && belt_range_may_reverse_any(s->n_belts, s->belts);

    // Sections of a path follow each other.
    for (size_t k = 0; s->n_obstacles > 0 && k < s->n_sections; k++)
        for (size_t m = 0; m < k; m++)
            may = may || (scene_belt_of(s, k) != scene_belt_of(s, m) &&
                          vec2_dot(s->belts[k].velocity, s->belts[m].velocity) < 0.0);
    return may;
}

// No component of v_stat exceeds the speed of the fastest belt in any other region. The dispersion speed has the
// factor of the belt under it, and 1 off every belt.
static speeds speeds_of(const scene *s)
{
    const double edge = scene_cell_edge(s);
    speeds of = { .face = 0.0 };
    const bool is_parting = may_part(s);
    double factor = 1.0;

    for (size_t k = 0; k < s->n_sections; k++) {
        const scene_belt *belt = &s->belts[k];
        const double faces = is_parting ? 4.0 : belt_has_lanes(belt) ? M_SQRT2 : 2.0;
        const double largest = belt_range_largest(belt);
        const double speedup = belt_has_lanes(belt) ? arc_lanes_speedup(s, belt, edge) : 1.0;
        const double face = speedup * belt_largest_speed(belt) * largest;
        of.face = fmax(of.face, face);
        of.outflow = fmax(of.outflow, faces * face);
        factor = fmax(factor, largest);
    }
    of.dispersion = s->macro.dispersion * factor;
    return of;
}

double scene_step_stable(const scene *s)
{
    const bool is_muscl = s->macro.scheme == SCENE_SCHEME_MUSCL;
    const speeds of = speeds_of(s);

    if (s->macro.closure == SCENE_CONGESTED)
        return scene_cell_edge(s) / (is_muscl ? 4.0 * of.face : of.outflow);
    return scene_cell_edge(s) / ((is_muscl ? 2.0 : 1.0) * (of.face + of.dispersion));
}

double scene_step_positive(const scene *s)
{
    return s->macro.closure == SCENE_CONGESTED ? INFINITY : 0.5 * scene_step_stable(s);
}

double scene_step_turning(const scene *s)
{
    double speed = 0.0;

    for (size_t k = 0; k < s->n_obstacles; k++)
        speed = fmax(speed, plate_range_largest_speed(s->obstacles, k, s->n_actions, s->actions));
    return scene_cell_edge(s) / speed;
}

double scene_macro_step(const scene *s)
{
    const double turning = scene_step_turning(s);

    if (s->macro.step > 0.0)
        return s->macro.step;
    return s->macro.closure == SCENE_CONGESTED
               ? scene_fit_step(s, fmin(scene_step_stable(s), turning), false)
               : scene_fit_step(s, fmin(scene_step_positive(s), turning), true);
}

scene_rect scene_rect_around(const vec2 *points, size_t n)
{
    scene_rect box = { points[0].x, points[0].x, points[0].y, points[0].y };

    for (size_t k = 1; k < n; k++)
        box = (scene_rect){ fmin(box.x_min, points[k].x), fmax(box.x_max, points[k].x),
                            fmin(box.y_min, points[k].y), fmax(box.y_max, points[k].y) };
    return box;
}
