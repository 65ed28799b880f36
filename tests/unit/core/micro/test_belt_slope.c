// The four microscopic solvers on belts that rise or fall. Expected values are derived.

#include "core/micro/micro.h"
#include "core/scene/belt_slope.h"
#include "tests/unit/core/helper_micro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

#define G       9.81
#define SPEED   0.4 // of the belt, m/s
#define DEGREES (M_PI / 180.0)
#define LAMBDA  1e3  // of friction, s/m: that of a part that slides is mu g
#define SMOOTH  10.0 // the paper's: without a hold parts creep at artanh(tau)/lambda

static const scene_shape cylinder = { .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.008 };
static const scene_shape box = { .type = SCENE_BOX, .length = 0.03, .width = 0.02, .height = 0.01 };
static const scene_shape *const shapes[] = { &cylinder, &box };

// One belt along a direction, and a part on it. Do not move it once it was made.
typedef struct world {
    micro_def def;
    scene_belt belt;
    double time, factor;
    micro_kind kind;
    scene_pose pose;
    scene_obstacle stop;
    vec2 path[2];
} world;

static void make_world(world *w, int solver, const scene_shape *shape, double incline,
                       double friction, double lambda)
{
    *w = (world){ .def = helper_micro_def(solver),
                  .belt = { .velocity = { SPEED * cos(0.5), SPEED * sin(0.5) },
                            .incline = incline,
                            .friction = friction,
                            .acceleration = INFINITY,
                            .deceleration = INFINITY },
                  .kind = { .shape = *shape,
                            .material = { 210e9, 0.28 },
                            .mass = 0.0284,
                            .spin_radius = 0.008 },
                  .pose = { 0.0, 0.0, 0.5 } };
    w->def.domain = (scene_rect){ -1.0, 1.0, -1.0, 1.0 };
    w->def.contact[SCENE_CONVEYOR_CARGO].tanh_linear = lambda;
    w->def.damping = 0.0;
    w->def.n_kinds = w->def.n_parts = w->def.n_belts = 1;
    w->def.belts = &w->belt;
    w->def.kinds = &w->kind;
    w->def.poses = &w->pose;
}

static void let_stand(world *w)
{
    w->belt.speed_schedule = (scene_speed_schedule){ 1, &w->time, 1, &w->factor };
}

static bool fits(int solver, const scene_shape *shape)
{
    return shape == &cylinder || helper_micro_solvers[solver].path == MICRO_PATH_SPATIAL;
}

// The velocity along the belt and the way along it after t, s.
static void move_for(const world *w, double t, double *ret_speed, double *ret_way)
{
    const vec2 along = vec2_scale(w->belt.velocity, 1.0 / SPEED);
    micro_solver *s = helper_micro_start(&w->def);

    helper_micro_advance_to(s, t);
    const micro_part part = micro_part_of(s, 0);
    *ret_speed = vec2_dot((vec2){ part.v[0], part.v[1] }, along);
    *ret_way = vec2_dot((vec2){ part.x[0] - w->pose.x, part.x[1] - w->pose.y }, along);
    micro_destroy(s);
}

// Without the hold it would have gone artanh(tan(10 degrees)/0.25)/lambda t = 26 mm.
static void what_a_standing_slope_holds_stays(void **state)
{
    static world w;

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++)
        for (size_t m = 0; m < 2; m++)
            for (double incline = -10.0; incline <= 10.0 && fits(k, shapes[m]); incline += 20.0) {
                double speed, way;
                make_world(&w, k, shapes[m], incline * DEGREES, 0.25, SMOOTH);
                let_stand(&w);
                move_for(&w, 0.3, &speed, &way);
                assert_near(speed, 0.0, 1e-4);
                assert_near(way, 0.0, 2e-4);
            }
}

static void a_slope_that_holds_carries_at_its_speed(void **state)
{
    static world w;

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++)
        for (size_t m = 0; m < 2 && fits(k, shapes[m]); m++) {
            double speed, way;
            make_world(&w, k, shapes[m], 10.0 * DEGREES, 0.25, SMOOTH);
            move_for(&w, 0.3, &speed, &way);
            assert_near(speed, SPEED, 1e-4);
            assert_near(way, 0.3 * SPEED, 2e-4);
        }
}

// Down the belt, against its direction where it rises.
static void on_a_steeper_slope_parts_slide(void **state)
{
    const double friction = 0.2, t = 0.2;
    static world w;

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++)
        for (size_t m = 0; m < 2; m++)
            for (double incline = -20.0; incline <= 20.0 && fits(k, shapes[m]); incline += 40.0) {
                const double angle = incline * DEGREES;
                const double gain = G * (sin(fabs(angle)) - friction * cos(angle));
                double speed, way;
                make_world(&w, k, shapes[m], angle, friction, LAMBDA);
                let_stand(&w);
                move_for(&w, t, &speed, &way);
                assert_near(speed, -copysign(gain * t, angle), 0.01 * gain * t);
                assert_near(way, -copysign(0.5 * gain * t * t, angle), 0.01 * gain * t * t);
            }
}

// A part that a moving belt pushes against a stop across it overlaps it by its force over the stiffness of the contact. The same
// on a level belt gives the ratio of the forces, cos(alpha) - sin(alpha)/mu.
static void a_stop_bears_friction_less_the_pull_uphill_and_both_downhill(void **state)
{
    static const double inclines[] = { 0.0, 8.0 * DEGREES, -8.0 * DEGREES };
    const double friction = 0.25;

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        double overlaps[3];
        for (int n = 0; n < 3; n++) {
            static world w;
            make_world(&w, k, &cylinder, inclines[n], friction, LAMBDA);
            w.belt.velocity = (vec2){ SPEED, 0.0 };
            w.def.modulus_reduction = 1e5;
            w.path[0] = (vec2){ cylinder.radius, -0.3 };
            w.path[1] = (vec2){ cylinder.radius, 0.3 };
            w.stop = (scene_obstacle){ .n_points = 2, .path = w.path, .thickness = 0.01 };
            w.def.n_obstacles = 1;
            w.def.obstacles = &w.stop;
            double speed;
            move_for(&w, 0.3, &speed, &overlaps[n]);
            assert_near(speed, 0.0, 1e-3);
        }
        for (int n = 1; n < 3; n++)
            assert_near(overlaps[n] / overlaps[0], cos(inclines[n]) - sin(inclines[n]) / friction,
                        0.02);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_standing_slope_holds_stays),
        cmocka_unit_test(a_slope_that_holds_carries_at_its_speed),
        cmocka_unit_test(on_a_steeper_slope_parts_slide),
        cmocka_unit_test(a_stop_bears_friction_less_the_pull_uphill_and_both_downhill),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
