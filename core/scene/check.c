#include "core/scene/scene.h"

#include "core/scene/check_priv.h"
#include "core/scene/placement.h"

#include <math.h>
#include <stdio.h>

enum { TOLD_MAX = 4 }; ///< bad positions that are told of

#define ABOVE_0(pointer, member, high)   SCENE_CHECK__ABOVE_0(pointer, scene, member, high)
#define FROM(pointer, member, low, high) SCENE_CHECK__FROM(pointer, scene, member, low, high)
#define BELOW_HALF(pointer, member)      SCENE_CHECK__BELOW_HALF(pointer, scene, member)
#define CONTACT(word, pair)                                                                        \
    ABOVE_0("/contacts/" word "/length_m", micro.contact[pair].length, SCENE_LENGTH_MAX),          \
        FROM("/contacts/" word "/damping_n_s_m", micro.contact[pair].damping, 0.0, 1e12),          \
        FROM("/contacts/" word "/friction", micro.contact[pair].friction, 0.0, 1e6),               \
        ABOVE_0("/contacts/" word "/tanh_linear_s_m", micro.contact[pair].tanh_linear, 1e12),      \
        ABOVE_0("/contacts/" word "/tanh_spin_s", micro.contact[pair].tanh_spin, 1e12)

static const scene_check__rule number_rules[] = {
    ABOVE_0("/duration_s", duration, 1e9),
    ABOVE_0("/output/curve_every_s", output.curve_every, 1e9),
    ABOVE_0("/output/snapshot_every_s", output.snapshot_every, 1e9),
    ABOVE_0("/macro/cell_m", macro.cell, SCENE_LENGTH_MAX),
    FROM("/macro/step_s", macro.step, 0.0, 1e9),
    ABOVE_0("/macro/heaviside_width", macro.heaviside_width, 1e6),
    FROM("/macro/dispersion_m_s", macro.dispersion, 0.0, 2.0 * SCENE_SPEED_MAX),
    ABOVE_0("/macro/mollifier_per_m2", macro.mollifier, 1e18),
    ABOVE_0("/macro/initial_mollifier_per_m2", macro.initial_mollifier, 1e18),
    ABOVE_0("/macro/packing_density_per_m2", macro.packing, 1e18),
    FROM("/micro/step_s", micro.step, 0.0, 1.0),
    FROM("/micro/modulus_reduction", micro.modulus_reduction, 1.0, 1e15),
    FROM("/micro/damping_per_s", micro.damping, 0.0, 1e9),
    FROM("/micro/gravity_m_s2", micro.gravity, 0.0, 1e6),
    FROM("/micro/spin_friction_radius_m", micro.spin_friction_radius, 0.0, SCENE_LENGTH_MAX),
    ABOVE_0("/materials/conveyor/young_modulus_pa", micro.conveyor.young_modulus, 1e15),
    BELOW_HALF("/materials/conveyor/poisson_ratio", micro.conveyor.poisson_ratio),
    ABOVE_0("/materials/handling/young_modulus_pa", micro.handling.young_modulus, 1e15),
    BELOW_HALF("/materials/handling/poisson_ratio", micro.handling.poisson_ratio),
    CONTACT("cargo_cargo", SCENE_CARGO_CARGO),
    CONTACT("conveyor_cargo", SCENE_CONVEYOR_CARGO),
    CONTACT("handling_cargo", SCENE_HANDLING_CARGO),
};

void scene_check__numbers(const void *item, const char *pointer, const scene_check__rule *rules,
                          size_t n, bf_faults *faults)
{
    char at[BF_POINTER_SIZE];

    for (size_t k = 0; k < n; k++) {
        const scene_check__rule *rule = &rules[k];
        double value = *(const double *)((const char *)item + rule->offset);
        bool is_low =
            rule->open & SCENE_CHECK__OPEN_LOW ? !(value > rule->low) : !(value >= rule->low);
        bool is_high =
            rule->open & SCENE_CHECK__OPEN_HIGH ? !(value < rule->high) : !(value <= rule->high);
        if (!is_low && !is_high)
            continue;
        snprintf(at, sizeof at, "%s%s", pointer, rule->pointer);
        faults_add(faults, at, "must be %s %g and %s %g, not %g",
                   rule->open & SCENE_CHECK__OPEN_LOW ? "above" : "at least", rule->low,
                   rule->open & SCENE_CHECK__OPEN_HIGH ? "below" : "at most", rule->high, value);
    }
}

static void check_words(const scene *s, bf_faults *faults)
{
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

static void check_count(double n, const char *pointer, bf_faults *faults)
{
    if (n < 1.0)
        faults_add(faults, pointer, "must be at least 1 part");
    else if (n > SCENE_PARTS_MAX)
        faults_add_limit(faults, pointer, "%.0f parts, the limit is %d", n, SCENE_PARTS_MAX);
}

static void check_positions(const scene_initial *initial, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];
    size_t n_told = 0;

    check_count((double)initial->n_poses, "/initial/positions_m", faults);
    for (size_t k = 0; k < initial->n_poses && n_told < TOLD_MAX; k++) {
        scene_pose at = initial->poses[k];
        if (fabs(at.x) <= SCENE_LENGTH_MAX && fabs(at.y) <= SCENE_LENGTH_MAX &&
            isfinite(at.heading))
            continue;
        snprintf(pointer, sizeof pointer, "/initial/positions_m/%zu", k);
        faults_add(faults, pointer, "must be numbers within %g m", SCENE_LENGTH_MAX);
        n_told++;
    }
}

static void check_hexagonal(const scene_initial *initial, bf_faults *faults)
{
    size_t n_before = faults->n;

    if (initial->n_rows < 1)
        faults_add(faults, "/initial/hexagonal/rows", "must be at least 1");
    if (initial->n_columns < 1)
        faults_add(faults, "/initial/hexagonal/columns", "must be at least 1");
    if (faults->n == n_before)
        check_count((double)initial->n_rows * initial->n_columns, "/initial/hexagonal", faults);
    if (!(fabs(initial->first.x) <= SCENE_LENGTH_MAX && fabs(initial->first.y) <= SCENE_LENGTH_MAX))
        faults_add(faults, "/initial/hexagonal/first_m", "must be numbers within %g m",
                   SCENE_LENGTH_MAX);
    if (!(initial->spacing > 0.0 && initial->spacing <= SCENE_LENGTH_MAX))
        faults_add(faults, "/initial/hexagonal/spacing_m", "must be above 0 and at most %g, not %g",
                   SCENE_LENGTH_MAX, initial->spacing);
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
    if (s->initial.seed >= UINT64_C(1) << 53)
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
    default:
        faults_add(faults, "/initial", "must say where the cargo is at the start");
    }
}

/// Note cargo that finds no room, lies outside or overlaps. Needs sound domain, shape and source.
static void check_placement(const scene *s, bf_faults *faults)
{
    bf_error err;
    placement p;

    if (placement_make(s, &p, &err) != BF_OK) {
        faults_add_error(faults, &err);
        return;
    }
    bf_status status = placement_check(s, &p, faults);
    if (status != BF_OK) {
        (void)bf_fail(&err, status, "/initial", "no memory for %zu parts", p.n);
        faults_add_error(faults, &err);
    }
    placement_fini(&p);
}

void scene_check(const scene *s, bf_faults *faults)
{
    size_t n_before = faults->n;

    check_domain(s, faults);
    size_t n_domain = faults->n;
    scene_check__numbers(s, "", number_rules, sizeof number_rules / sizeof *number_rules, faults);
    check_words(s, faults);
    scene_check__cargo(s, faults);
    scene_check__items(s, faults);
    if (faults->n == n_before)
        scene_check__sizes(s, faults);
    size_t n_others = faults->n;
    scene_check__shapes(s, faults);
    check_initial(s, faults);
    if (n_domain == n_before && faults->n == n_others)
        check_placement(s, faults);
}
