#include "tests/unit/core/helper_outflow.h"

#include "core/base/check.h"

#include <math.h>
#include <string.h>

static void place_parts(scene_pose *poses)
{
    const double spacing = 1.02 * 2.0 * 0.012;

    for (int k = 0; k < HELPER_OUTFLOW_PARTS; k++) {
        int row = k / 12, column = k % 12;
        poses[k].x = 0.10 + spacing * (column + 0.5 * (row % 2));
        poses[k].y = 0.11 + spacing * 0.5 * sqrt(3.0) * row;
        poses[k].heading = 0.0;
    }
}

void helper_outflow_example(helper_outflow *e, double angle_deg, double modulus_reduction)
{
    memset(e, 0, sizeof *e);
    e->def = micro_def_default();
    e->def.modulus_reduction = modulus_reduction;
    e->def.domain = (scene_rect){ 0.0, 1.0, 0.0, 0.6 };
    e->belt.velocity = (vec2){ 0.395, 0.0 };
    e->path[0] = (vec2){ angle_deg == 90.0 ? 0.75 : 0.461325, 0.0 };
    e->path[1] = (vec2){ 0.75, 0.5 };
    e->obstacle = (scene_obstacle){ .n_points = 2, .path = e->path, .thickness = 0.005 };
    e->kind.shape = (scene_shape){ .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.008 };
    e->kind.material = (scene_material){ 210e9, 0.28 };
    e->kind.mass = 7850.0 * M_PI * 0.012 * 0.012 * 0.008;
    e->kind.spin_radius = 0.008;
    place_parts(e->poses);
    e->def.n_belts = e->def.n_obstacles = e->def.n_kinds = 1;
    e->def.belts = &e->belt;
    e->def.obstacles = &e->obstacle;
    e->def.kinds = &e->kind;
    e->def.n_parts = HELPER_OUTFLOW_PARTS;
    e->def.poses = e->poses;
}

static double count_upstream(const micro_solver *s)
{
    double n = 0.0;

    for (size_t k = 0; k < micro_parts(s); k++)
        n += !micro_is_gone(s, k) && micro_part_of(s, k).x[0] < 0.75;
    return n;
}

void helper_outflow_curve(const micro_def *def, double t_end, double *ret_u)
{
    micro_solver *s = NULL;

    BF_CHECK(micro_create(def, &s, NULL) == BF_OK);
    for (int k = 0; k < HELPER_OUTFLOW_SAMPLES; k++) {
        double t = t_end * k / (HELPER_OUTFLOW_SAMPLES - 1);
        uint64_t steps = (uint64_t)llround(t / micro_dt(s));
        BF_CHECK(micro_advance(s, steps - micro_steps(s), NULL) == BF_OK);
        ret_u[k] = count_upstream(s);
    }
    micro_destroy(s);
}

double helper_outflow_gap(const double *a, const double *b)
{
    double sum = 0.0;

    for (int k = 0; k < HELPER_OUTFLOW_SAMPLES; k++)
        sum += fabs(a[k] - b[k]);
    return sum / HELPER_OUTFLOW_SAMPLES / HELPER_OUTFLOW_PARTS;
}
