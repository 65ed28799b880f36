// The four microscopic solvers on belts with frictions of their own. Expected values are derived.

#include "core/micro/micro.h"
#include "tests/unit/core/helper_micro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

#define SPEED  0.8  // of the belts, m/s
#define SLOW   0.1  // mu of the one at y < 0
#define FAST   0.25 // mu of the one at y > 0
#define LAMBDA 1e3  // of friction, s/m: that of a sliding part is mu g

static const scene_shape cylinder = { .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.008 };
static const scene_shape box = { .type = SCENE_BOX, .length = 0.06, .width = 0.02, .height = 0.01 };

// Two belts beside each other, which stand until 0.05 s. Do not move it once it was made.
typedef struct world {
    micro_def def;
    scene_belt belts[2];
    vec2 corners[2][4];
    double times[2], factors[2];
    micro_kind kind;
    scene_pose pose;
} world;

static void make_world(world *w, int solver, const scene_shape *shape, double y)
{
    *w = (world){ .def = helper_micro_def(solver),
                  .corners = { { { -1.0, -1.0 }, { 1.0, -1.0 }, { 1.0, 0.0 }, { -1.0, 0.0 } },
                               { { -1.0, 0.0 }, { 1.0, 0.0 }, { 1.0, 1.0 }, { -1.0, 1.0 } } },
                  .times = { 0.0, 0.05 },
                  .factors = { 0.0, 1.0 },
                  .kind = { .shape = *shape,
                            .material = { 210e9, 0.28 },
                            .mass = 0.0284,
                            .spin_radius = 0.008 },
                  .pose = { -0.5, y, 0.5 * M_PI } };
    w->def.domain = (scene_rect){ -1.0, 1.0, -1.0, 1.0 };
    w->def.contact[SCENE_CONVEYOR_CARGO].tanh_linear = LAMBDA;
    w->def.damping = 0.0;
    w->def.n_kinds = w->def.n_parts = 1;
    w->def.n_belts = 2;
    w->def.belts = w->belts;
    w->def.kinds = &w->kind;
    w->def.poses = &w->pose;
    for (int k = 0; k < 2; k++)
        w->belts[k] = (scene_belt){ .velocity = { SPEED, 0.0 },
                                    .friction = k == 0 ? SLOW : FAST,
                                    .acceleration = INFINITY,
                                    .deceleration = INFINITY,
                                    .n_points = 4,
                                    .polygon = w->corners[k],
                                    .speed_schedule = { 2, w->times, 2, w->factors } };
}

// The velocity 0.15 s after the belts start.
static double speed_of(int solver, const scene_shape *shape, double y)
{
    static world w;

    make_world(&w, solver, shape, y);
    micro_solver *s = helper_micro_start(&w.def);
    helper_micro_advance_to(s, 0.2);
    const double speed = micro_part_of(s, 0).v[0];
    micro_destroy(s);
    return speed;
}

static void a_part_that_slides_gains_speed_by_the_friction_of_its_belt(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        assert_near(speed_of(k, &cylinder, -0.5), SLOW * 9.81 * 0.15, 2e-3);
        assert_near(speed_of(k, &cylinder, 0.5), FAST * 9.81 * 0.15, 4e-3);
    }
}

// A box lies lengthwise across both, and does not slip on its way.
static void a_body_on_two_belts_has_the_mean_of_their_frictions(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++)
        if (helper_micro_solvers[k].path == MICRO_PATH_SPATIAL)
            assert_near(speed_of(k, &box, 0.0), 0.5 * (SLOW + FAST) * 9.81 * 0.15, 0.02);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_part_that_slides_gains_speed_by_the_friction_of_its_belt),
        cmocka_unit_test(a_body_on_two_belts_has_the_mean_of_their_frictions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
