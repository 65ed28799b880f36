// The checks of a scenario: every fault that can be found, with its pointer, in the order of the document's
// members.

#include "core/scene/scene.h"

#include "core/scene/cells.h"
#include "core/scene/check_work.h"
#include "core/scene/density.h"
#include "core/scene/goods.h"
#include "core/scene/placement.h"
#include "core/scene/ranges.h"
#include "core/scene/scene_priv.h"
#include "core/scene/shape.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/// Largest ratio of the disk about the part that extends farthest to the smallest footprint: with
/// more, far too many small parts fit into one cell of the search for overlaps.
#define UNLIKE_MAX 1000.0

#define CONTACT(word, pair)                                                                        \
    RULE("/contacts/" word "/length_m", scene, micro.contact[pair].length, scene_range_length),    \
        RULE("/contacts/" word "/damping_n_s_m", scene, micro.contact[pair].damping,               \
             scene_range_contact_damping),                                                         \
        RULE("/contacts/" word "/tanh_linear_s_m", scene, micro.contact[pair].tanh_linear,         \
             scene_range_tanh),                                                                    \
        RULE("/contacts/" word "/tanh_spin_s", scene, micro.contact[pair].tanh_spin,               \
             scene_range_tanh)

/// The cell, m, and steps, s; 0 is "auto".
static const bf_range macro_cell = { 0.0, INFINITY, false, false, SCENE_LENGTH_MAX };
static const bf_range macro_step = { 0.0, INFINITY, false, false, 1e9 };
static const bf_range micro_step = { 0.0, INFINITY, false, false, 1.0 };

static const number_rule number_rules[] = {
    RULE("/duration_s", scene, duration, scene_range_time),
    RULE("/warmup_s", scene, warmup, scene_range_instant),
    RULE("/jam_time_s", scene, jam_time, scene_range_time),
    RULE("/steady_precision", scene, steady_precision, scene_range_ratio),
    RULE("/output/curve_every_s", scene, output.curve_every, scene_range_time),
    RULE("/output/snapshot_every_s", scene, output.snapshot_every, scene_range_time),
    RULE("/macro/cell_m", scene, macro.cell, macro_cell),
    RULE("/macro/step_s", scene, macro.step, macro_step),
    RULE("/macro/jam_density", scene, macro.jam_density, scene_range_jam_density),
    RULE("/macro/heaviside_width", scene, macro.heaviside_width, scene_range_heaviside_width),
    RULE("/macro/dispersion_m_s", scene, macro.dispersion, scene_range_dispersion),
    RULE("/macro/mollifier_per_m2", scene, macro.mollifier, scene_range_per_area),
    RULE("/macro/initial_mollifier_per_m2", scene, macro.initial_mollifier, scene_range_per_area),
    RULE("/macro/packing_density_per_m2", scene, macro.packing, scene_range_per_area),
    RULE("/micro/step_s", scene, micro.step, micro_step),
    RULE("/micro/overlap_limit", scene, micro.overlap_limit, scene_range_overlap_limit),
    RULE("/micro/damping_per_s", scene, micro.damping, scene_range_damping_rate),
    RULE("/micro/gravity_m_s2", scene, micro.gravity, scene_range_gravity),
    RULE("/micro/spin_friction_radius_m", scene, micro.spin_friction_radius, scene_range_lever),
    RULE("/materials/conveyor/young_modulus_pa", scene, micro.conveyor.young_modulus,
         scene_range_young_modulus),
    RULE("/materials/conveyor/poisson_ratio", scene, micro.conveyor.poisson_ratio,
         scene_range_poisson_ratio),
    RULE("/materials/handling/young_modulus_pa", scene, micro.handling.young_modulus,
         scene_range_young_modulus),
    RULE("/materials/handling/poisson_ratio", scene, micro.handling.poisson_ratio,
         scene_range_poisson_ratio),
    CONTACT("cargo_cargo", SCENE_CARGO_CARGO),
    CONTACT("conveyor_cargo", SCENE_CONVEYOR_CARGO),
    CONTACT("handling_cargo", SCENE_HANDLING_CARGO),
    RULE("/contacts/wall_friction", scene, micro.wall_friction, scene_range_friction),
};

static void check_words(const scene *s, bf_faults *faults)
{
    if (s->micro.modulus_reduction != 0.0) // 0 stands for "auto"
        range_check(&scene_range_modulus_reduction, s->micro.modulus_reduction,
                    "/micro/modulus_reduction", faults);
    if ((unsigned)s->macro.closure >= SCENE_CLOSURE_COUNT)
        faults_add(faults, "/macro/closure", "is not a closure");
    if ((unsigned)s->macro.scheme >= SCENE_SCHEME_COUNT)
        faults_add(faults, "/macro/scheme", "is not a scheme");
    if ((unsigned)s->macro.heaviside >= SCENE_HEAVISIDE_COUNT)
        faults_add(faults, "/macro/heaviside", "is not a form of H");
    if ((unsigned)s->micro.integrator >= SCENE_INTEGRATOR_COUNT)
        faults_add(faults, "/micro/integrator", "is not an integrator");
    if ((unsigned)s->micro.path >= SCENE_PATH_COUNT)
        faults_add(faults, "/micro/path", "is not a path");
}

static bool is_interval(double low, double high)
{
    return fabs(low) <= SCENE_LENGTH_MAX && fabs(high) <= SCENE_LENGTH_MAX && low < high;
}

static void check_domain(const scene *s, bf_faults *faults)
{
    static const char *const pointers[SCENE_SIDE_COUNT] = { "/edges/west", "/edges/east",
                                                            "/edges/south", "/edges/north" };

    if (!is_interval(s->domain.x_min, s->domain.x_max))
        faults_add(faults, "/domain/x_m", "must be [from, to] with from < to, within %g m",
                   SCENE_LENGTH_MAX);
    if (!is_interval(s->domain.y_min, s->domain.y_max))
        faults_add(faults, "/domain/y_m", "must be [from, to] with from < to, within %g m",
                   SCENE_LENGTH_MAX);
    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        if ((unsigned)s->edges[side] >= SCENE_EDGE_COUNT)
            faults_add(faults, pointers[side], "is not a kind of edge");
    }
}

static void check_interval(double low, double high, size_t k, const char *member, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    if (is_interval(low, high))
        return;
    snprintf(pointer, sizeof pointer, "/counters/%zu/%s", k, member);
    faults_add(faults, pointer, "must be [from, to] with from < to, within %g m", SCENE_LENGTH_MAX);
}

/// Note a time at which results change that is out of order.
static void check_windows(const scene_output *output, bf_faults *faults)
{
    static const number_rule rules[] = {
        RULE("/t_s/0", scene_output_window, from, scene_range_instant),
        RULE("/t_s/1", scene_output_window, to, scene_range_time),
        RULE("/curve_every_s", scene_output_window, curve_every, scene_range_time),
        RULE("/snapshot_every_s", scene_output_window, snapshot_every, scene_range_time),
    };
    char pointer[BF_POINTER_SIZE], times[BF_POINTER_SIZE + ROOM_FOR_INDEX];

    if (!scene__check_count(output->n_windows, SCENE_WINDOWS_MAX, "/output/windows", "windows",
                            faults))
        return;
    for (size_t k = 0; k < output->n_windows; k++) {
        const scene_output_window *w = &output->windows[k];
        snprintf(pointer, sizeof pointer, "/output/windows/%zu", k);
        scene__check_numbers(w, pointer, rules, sizeof rules / sizeof *rules, faults);
        snprintf(times, sizeof times, "%s/t_s", pointer);
        if (!(w->from < w->to))
            faults_add(faults, times, "must be [from, to] with from < to");
        if (k > 0 && !(w->from >= w[-1].to))
            faults_add(faults, times,
                       "begins at %.15g s, before the end of the window before it at "
                       "%.15g s",
                       w->from, w[-1].to);
    }
}

static void check_counters(const scene *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    if (s->n_counters < 1 || s->n_counters > SCENE_COUNTERS_MAX) {
        faults_add_limit(faults, "/counters", "%zu counters, the limits are 1 and %d",
                         s->n_counters, SCENE_COUNTERS_MAX);
        return;
    }
    for (size_t k = 0; k < s->n_counters; k++) {
        const scene_counter *counter = &s->counters[k];
        scene__check_id(s->counters, sizeof *s->counters, "counters", k, faults);
        snprintf(pointer, sizeof pointer, "/counters/%zu/id", k);
        if (strcmp(counter->id, "t_s") == 0 || strcmp(counter->id, "left_domain") == 0)
            faults_add(faults, pointer, "'%s' is a column of every curve", counter->id);
        check_interval(counter->rect.x_min, counter->rect.x_max, k, "x_m", faults);
        check_interval(counter->rect.y_min, counter->rect.y_max, k, "y_m", faults);
        snprintf(pointer, sizeof pointer, "/counters/%zu/kind", k);
        if (counter->kind != SCENE_KIND_ANY && counter->kind >= s->n_cargo)
            faults_add(faults, pointer, "must be the id of a kind of cargo in the scenario");
    }
}

static const number_rule kind_rules[] = {
    RULE("/mass_kg", scene_cargo, mass, scene_range_mass),
    RULE("/material/young_modulus_pa", scene_cargo, material.young_modulus,
         scene_range_young_modulus),
    RULE("/material/poisson_ratio", scene_cargo, material.poisson_ratio, scene_range_poisson_ratio),
};

/// Members that only a kind of a mix has.
static const number_rule mix_rules[] = {
    RULE("/spin_friction_radius_m", scene_cargo, spin_friction_radius, scene_range_lever),
};

/// The member that determines how many parts are of a kind.
static const number_rule share_rule = RULE("/share", scene_cargo, share, scene_range_share);

/// The pointer of kind k: "/cargo", or "/cargo/<k>" in a mix.
static const char *point_at(const scene *s, size_t k, char *room, size_t size)
{
    if (!s->is_mix)
        return "/cargo";
    snprintf(room, size, "/cargo/%zu", k);
    return room;
}

static void check_cargo(const scene *s, bf_faults *faults)
{
    char room[BF_POINTER_SIZE];

    for (size_t k = 0; k < s->n_cargo; k++) {
        const scene_cargo *kind = &s->cargo[k];
        const char *pointer = point_at(s, k, room, sizeof room);
        if (kind->id[0] != '\0' && s->is_mix)
            scene__check_id(s->cargo, sizeof *s->cargo, "cargo", k, faults);
        else if (kind->id[0] != '\0' && !scene_is_id(kind->id))
            faults_add(faults, "/cargo/id", ID_TEXT, SCENE_ID_SIZE - 1);
        scene__check_numbers(kind, pointer, kind_rules, sizeof kind_rules / sizeof *kind_rules,
                             faults);
        if (s->is_mix)
            scene__check_numbers(kind, pointer, mix_rules, sizeof mix_rules / sizeof *mix_rules,
                                 faults);
        if (s->micro.path == SCENE_PATH_PLANAR && kind->shape.type != SCENE_CYLINDER)
            faults_add(faults, "/micro/path", "planar is for cylinders; %s has another shape",
                       pointer);
    }
    if ((double)s->cargo_seed > scene_range_seed.maximum)
        faults_add(faults, "/cargo_seed", "must be below 2^53");
}

static void check_shapes(const scene *s, bf_faults *faults)
{
    double bounding_radius = 0.0, area = INFINITY;
    size_t n_before = faults->n;
    char room[BF_POINTER_SIZE], at[2 * BF_POINTER_SIZE];

    for (size_t k = 0; k < s->n_cargo; k++) {
        const char *pointer = point_at(s, k, room, sizeof room);
        if (s->is_mix)
            scene__check_numbers(&s->cargo[k], pointer, &share_rule, 1, faults);
        snprintf(at, sizeof at, "%s/shape", pointer);
        shape_check(&s->cargo[k].shape, at, faults);
    }
    for (size_t k = 0; k < s->n_cargo && faults->n == n_before; k++) {
        shape_footprint f = shape_footprint_of(&s->cargo[k].shape);
        bounding_radius = fmax(bounding_radius, f.bounding_radius);
        area = fmin(area, f.area);
    }
    if (faults->n == n_before && s->n_cargo > 1 &&
        M_PI * bounding_radius * bounding_radius > UNLIKE_MAX * area)
        faults_add_limit(faults, "/cargo",
                         "kinds are too unlike in size: the disk about the largest has %g times "
                         "the area of the smallest, the limit is %g",
                         M_PI * bounding_radius * bounding_radius / area, UNLIKE_MAX);
}

/// Note a number beyond its limit.
static void check_limit(double figure, double limit, const char *what, const char *pointer,
                        bf_faults *faults)
{
    if (!(figure <= limit))
        faults_add_limit(faults, pointer, "%.10g %s, the limit is %.10g", figure, what, limit);
}

static void check_sizes(const scene *s, bf_faults *faults)
{
    const cells c = cells_of(s);
    const double n_snapshots = scene_snapshots(s);
    const bool is_congested = s->macro.closure == SCENE_CONGESTED;

    check_limit(scene_samples(s), SCENE_SAMPLES_MAX, "samples of the curve",
                "/output/curve_every_s", faults);
    check_limit(n_snapshots, SCENE_SNAPSHOTS_MAX, "snapshots", "/output/snapshot_every_s", faults);
    // Faults that follow from an invalid cell size are not reported again.
    const size_t n_before = faults->n;
    check_limit(c.n1 * c.n2, is_congested ? SCENE_CONGESTED_CELLS_MAX : SCENE_CELLS_MAX,
                is_congested ? "cells with the congested closure" : "cells", "/macro/cell_m",
                faults);
    check_limit(fmax(c.n1, c.n2), SCENE_CELLS_SIDE_MAX, "cells in a row", "/macro/cell_m", faults);
    if (faults->n > n_before)
        return;
    check_limit(n_snapshots * c.n1 * c.n2 * (double)sizeof(float), SCENE_SNAPSHOT_BYTES_MAX,
                "bytes of snapshots", "/output/snapshot_every_s", faults);
    // Too many parts are reported at their source.
    const double n_reached = density_cells(s->macro.initial_mollifier, c.d1 * c.d2, c.n1 * c.n2);
    const double n_parts = fmin((double)scene_parts(s), SCENE_PARTS_MAX);
    check_limit(n_parts * n_reached, SCENE_INITIAL_WORK_MAX,
                "values to sum up for the density at the start", "/macro/initial_mollifier_per_m2",
                faults);
}

static void check_count(double n, const char *pointer, bf_faults *faults)
{
    if (n < scene_range_count.minimum)
        faults_add(faults, pointer, "must be at least %g part", scene_range_count.minimum);
    else if (n > SCENE_PARTS_MAX)
        faults_add_limit(faults, pointer, "%.0f parts, the limit is %d", n, SCENE_PARTS_MAX);
}

static void check_positions(const scene_initial *initial, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];
    size_t n_reported = 0;

    check_count((double)initial->n_poses, "/initial/positions_m", faults);
    for (size_t k = 0; k < initial->n_poses && n_reported < REPORTED_MAX; k++) {
        scene_pose at = initial->poses[k];
        if (fabs(at.x) <= SCENE_LENGTH_MAX && fabs(at.y) <= SCENE_LENGTH_MAX &&
            isfinite(at.heading))
            continue;
        snprintf(pointer, sizeof pointer, "/initial/positions_m/%zu", k);
        faults_add(faults, pointer, "must be numbers within %g m", SCENE_LENGTH_MAX);
        n_reported++;
    }
}

static void check_hexagonal(const scene_initial *initial, bf_faults *faults)
{
    size_t n_before = faults->n;

    if (initial->n_rows < scene_range_count.minimum)
        faults_add(faults, "/initial/hexagonal/rows", "must be at least %g",
                   scene_range_count.minimum);
    if (initial->n_columns < scene_range_count.minimum)
        faults_add(faults, "/initial/hexagonal/columns", "must be at least %g",
                   scene_range_count.minimum);
    if (faults->n == n_before)
        check_count((double)initial->n_rows * initial->n_columns, "/initial/hexagonal", faults);
    if (!(fabs(initial->first.x) <= SCENE_LENGTH_MAX && fabs(initial->first.y) <= SCENE_LENGTH_MAX))
        faults_add(faults, "/initial/hexagonal/first_m", "must be numbers within %g m",
                   SCENE_LENGTH_MAX);
    range_check(&scene_range_length, initial->spacing, "/initial/hexagonal/spacing_m", faults);
}

static void check_random(const scene *s, bf_faults *faults)
{
    const scene_rect *region = &s->initial.region;

    check_count(s->initial.n_random, "/initial/random/count", faults);
    if (!(region->x_min >= s->domain.x_min && region->x_min <= region->x_max &&
          region->x_max <= s->domain.x_max))
        faults_add(faults, "/initial/random/region/x_m",
                   "must be [from, to] with from <= to, within the domain");
    if (!(region->y_min >= s->domain.y_min && region->y_min <= region->y_max &&
          region->y_max <= s->domain.y_max))
        faults_add(faults, "/initial/random/region/y_m",
                   "must be [from, to] with from <= to, within the domain");
    if ((double)s->initial.seed > scene_range_seed.maximum)
        faults_add(faults, "/initial/random/seed", "must be below 2^53");
}

static void check_initial(const scene *s, bf_faults *faults)
{
    switch (s->initial.type) {
    case SCENE_INITIAL_POSITIONS:
        check_positions(&s->initial, faults);
        break;
    case SCENE_INITIAL_HEXAGONAL:
        check_hexagonal(&s->initial, faults);
        break;
    case SCENE_INITIAL_RANDOM:
        check_random(s, faults);
        break;
    case SCENE_INITIAL_EMPTY:
        if (s->n_feeds == 0)
            faults_add(faults, "/initial", "must say where the cargo is at the start");
        break;
    default:
        faults_add(faults, "/initial", "must say where the cargo is at the start");
    }
}

/// Note cargo that does not fit, lies outside or overlaps. Needs a valid domain, shape and source. The
/// places are stored in the scene.
static void check_placement(scene *s, bf_faults *faults)
{
    scene_placement p;
    bf_error err;

    if (placement_make_within(s, SCENE_PLACEMENT_STEPS_MAX, faults, &p, &err) != BF_OK) {
        faults_add_error(faults, &err);
        return;
    }
    s->placement = p;
    if (placement_check(s, &p, faults, &err) != BF_OK)
        faults_add_error(faults, &err);
}

void scene_check(scene *s, bf_faults *faults)
{
    size_t n_before = faults->n;

    placement_fini(&s->placement);
    if (!check_work(s, faults))
        return;
    check_domain(s, faults);
    size_t n_domain = faults->n;
    scene__check_numbers(s, "", number_rules, sizeof number_rules / sizeof *number_rules, faults);
    check_words(s, faults);
    if ((unsigned)s->until >= SCENE_UNTIL_COUNT)
        faults_add(faults, "/until", "is not an end of a run");
    if (s->until == SCENE_UNTIL_STEADY && s->n_feeds == 0)
        faults_add(faults, "/until", "nothing becomes steady without a feed");
    if (s->warmup > 0.0 && s->duration > 0.0 && s->warmup >= s->duration)
        faults_add(faults, "/warmup_s", "must be shorter than duration_s, %.15g s, not %.15g s",
                   s->duration, s->warmup);
    if ((double)s->substream > scene_range_seed.maximum)
        faults_add(faults, "/substream", "must be below 2^53");
    check_cargo(s, faults);
    goods_check(s, faults);
    scene__check_belts(s, faults);
    scene__check_obstacles(s, faults);
    scene__check_feeds(s, faults);
    scene__check_photo_eyes(s, faults);
    scene__check_sinks(s, faults);
    scene__check_actions(s, faults);
    scene__check_merges(s, faults);
    check_counters(s, faults);
    check_windows(&s->output, faults);
    if (faults->n == n_before)
        check_sizes(s, faults);
    size_t n_others = faults->n;
    check_shapes(s, faults);
    check_initial(s, faults);
    const bool is_sound = faults->n == n_before;
    if (n_domain == n_before && faults->n == n_others)
        check_placement(s, faults);
    if (is_sound)
        scene__check_feed_lines(s, faults);
}
