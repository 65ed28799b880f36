// The four microscopic solvers on belts that turn about a point. Expected values are derived.

#include "core/micro/micro.h"
#include "tests/unit/core/helper_micro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

#define RADIUS 0.5                // of the circle that a part rides on, m
#define TURN   (2.0 * M_PI / 8.0) // rad/s

static const scene_shape cylinder = { .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.008 };
static const scene_shape box = { .type = SCENE_BOX, .length = 0.06, .width = 0.02, .height = 0.01 };

enum { COLUMNS = 30, CROWD = 40 * COLUMNS, CROWD_IN_SPACE = 2 * COLUMNS };

// A belt that turns about the middle of the domain, and later ones on it. Do not move it once it was made.
typedef struct world {
    micro_def def;
    scene_belt belts[2];
    vec2 corners[4];
    double times[2], factors[2];
    micro_kind kind;
    scene_pose poses[CROWD];
} world;

static void make_world(world *w, int solver, const scene_shape *shape)
{
    *w = (world){ .def = helper_micro_def(solver),
                  .kind = { .shape = *shape,
                            .material = { 210e9, 0.28 },
                            .mass = 0.0284,
                            .spin_radius = 0.008 },
                  .poses = { { RADIUS, 0.0, 0.0 } } };
    w->def.domain = (scene_rect){ -1.5, 1.5, -1.5, 1.5 };
    w->def.contact[SCENE_CONVEYOR_CARGO].tanh_linear = 100.0;
    w->def.n_belts = w->def.n_kinds = w->def.n_parts = 1;
    w->def.belts = w->belts;
    w->def.kinds = &w->kind;
    w->def.poses = w->poses;
    for (int k = 0; k < 2; k++)
        w->belts[k] = (scene_belt){ .velocity = { TURN * RADIUS, 0.0 },
                                    .turn = k == 0 ? TURN : 0.0,
                                    .acceleration = INFINITY,
                                    .deceleration = INFINITY };
}

// Calls check for all solvers with a cylinder, and for those in space with a box.
static void for_each(void (*check)(int solver, const scene_shape *shape))
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        check(k, &cylinder);
        if (helper_micro_solvers[k].path == MICRO_PATH_SPATIAL)
            check(k, &box);
    }
}

// In the frame of the belt a part moves by z'' + (k + 2 i w) z' - w^2 z = 0, k = mu g lambda: friction is linear up to a
// relative (w^2 r/(mu g))^2/3 of the drift, 4e-4. Its slow root is w^2/k up to a relative w^2/k^2, so that
// r = r_0 exp(w^2 t/k). Explicit steps go on along the tangent: by w^2 r dt/2 more outwards each second.
static void check_turn(int solver, const scene_shape *shape)
{
    static world w;

    make_world(&w, solver, shape);
    const double t = 2.0 * M_PI / TURN, dt = w.def.dt;
    const scene_contact *law = &w.def.contact[SCENE_CONVEYOR_CARGO];
    const double growth =
        expm1(TURN * TURN * t / (law->friction * w.def.gravity * law->tanh_linear));
    micro_solver *s = helper_micro_start(&w.def);
    assert_near(micro_part_of(s, 0).v[1], TURN * RADIUS, 1e-12);
    helper_micro_advance_to(s, t / 4.0);
    const micro_part quarter = micro_part_of(s, 0);
    assert_near(atan2(quarter.x[1], quarter.x[0]), 0.5 * M_PI, 1e-4);
    assert_near(quarter.heading, 0.5 * M_PI, 1e-3);
    helper_micro_advance_to(s, t);
    const micro_part whole = micro_part_of(s, 0);
    const double off = 0.5 * TURN * TURN * dt * t + 0.02 * growth;
    assert_near(hypot(whole.x[0], whole.x[1]) / RADIUS, 1.0 + growth, off);
    assert_near(atan2(whole.x[1], whole.x[0]), 0.0, 1e-4);
    micro_destroy(s);
}

static void a_part_comes_back_after_one_turn_but_for_the_drift_of_its_friction(void **state)
{
    for_each(check_turn);
}

// The belt stands at first; then friction (7) and (8) give a part the velocity and the spin of the belt.
static void check_start(int solver, const scene_shape *shape)
{
    static world w;

    make_world(&w, solver, shape);
    w.times[1] = 0.1;
    w.factors[1] = 0.5;
    w.belts[0].speed_schedule = (scene_speed_schedule){ 2, w.times, 2, w.factors };
    micro_solver *s = helper_micro_start(&w.def);
    helper_micro_advance_to(s, 0.1);
    assert_near(micro_part_of(s, 0).w[2], 0.0, 1e-9);
    helper_micro_advance_to(s, 2.0);
    assert_near(micro_part_of(s, 0).w[2], 0.5 * TURN, 1e-3 * TURN);
    assert_near(hypot(micro_part_of(s, 0).v[0], micro_part_of(s, 0).v[1]), 0.5 * TURN * RADIUS,
                2e-3 * TURN * RADIUS);
    micro_destroy(s);
}

static void a_part_at_rest_is_taken_along_and_turned_by_the_belt(void **state)
{
    for_each(check_start);
}

// Straight on, an eighth of a turn to the left, 0.5 m aslant, an eighth to the right, straight on. The drifts of both arcs are outwards
// of each, so that the second one takes the first one back but for its square.
static void check_path(int solver, const scene_shape *shape)
{
    const double speed = TURN * RADIUS, cut = RADIUS * tan(M_PI / 8.0), way = 0.5 + 2.0 * cut;
    const double turning = 0.25 * M_PI / TURN, side = way * sqrt(0.5);
    const vec2 points[] = { { -1.5, -1.0 },
                            { -1.0 + cut, -1.0 },
                            { -1.0 + cut + side, -1.0 + side },
                            { 1.5, -1.0 + side } };
    static world w;
    scene s;

    helper_scene_belt(&s, 3.0, 3.0, 0.05, (scene_pose[]){ { 0.0, 0.0, 0.0 } }, 1);
    helper_scene_add_path(&s, speed, 0.3, RADIUS, points, 4);
    helper_scene_resolve(&s);
    make_world(&w, solver, shape);
    w.poses[0] = (scene_pose){ -1.2, -1.0, 0.0 };
    w.def.n_belts = s.n_sections;
    w.def.belts = s.belts;
    const scene_contact *law = &w.def.contact[SCENE_CONVEYOR_CARGO];
    const double k = law->friction * w.def.gravity * law->tanh_linear;
    const double drift = RADIUS * expm1(TURN * TURN / k * turning);
    micro_solver *solved = helper_micro_start(&w.def);
    // In the middle of the way aslant it is beside its line, to the right, by the drift of the first arc.
    helper_micro_advance_to(solved, 0.2 / speed + turning + 0.25 / speed);
    const micro_part half = micro_part_of(solved, 0);
    const vec2 middle = vec2_scale(vec2_add(points[1], points[2]), 0.5);
    const vec2 off = vec2_sub((vec2){ half.x[0], half.x[1] }, middle);
    assert_near(vec2_dot(off, (vec2){ sqrt(0.5), -sqrt(0.5) }), drift, 0.1 * drift + 4e-4);
    assert_near(vec2_dot(off, (vec2){ sqrt(0.5), sqrt(0.5) }), 0.0, 1e-3);
    helper_micro_advance_to(solved, 0.9 / speed + 2.0 * turning);
    const micro_part end = micro_part_of(solved, 0);
    assert_near(end.x[1], points[2].y, 0.1 * drift + 4e-4);
    assert_near(end.x[0], points[2].x + cut + 0.2, 2e-3);
    if (shape->type == SCENE_CYLINDER) { // a box comes to turn with its arc more slowly
        assert_near(half.heading, 0.25 * M_PI, 1e-4);
        assert_near(end.heading, 0.0, 1e-4);
    }
    micro_destroy(solved);
    scene_fini(&s);
}

static void a_part_rides_along_the_centre_line_of_a_path_but_for_the_drift_of_its_friction(
    void **state)
{
    for_each(check_path);
}

// A crowd that touches, half of it on a straight belt.
static void make_crowd(world *w, int solver)
{
    make_world(w, solver, &cylinder);
    for (int k = 0; k < CROWD; k++)
        w->poses[k] =
            (scene_pose){ 0.2 + 0.0239 * (k % COLUMNS), -0.4 + 0.0239 * (k / COLUMNS), 0.0 };
    w->def.n_parts =
        helper_micro_solvers[solver].path == MICRO_PATH_PLANAR ? CROWD : CROWD_IN_SPACE;
    w->corners[0] = (vec2){ 0.5, -1.5 };
    w->corners[1] = (vec2){ 1.5, -1.5 };
    w->corners[2] = (vec2){ 1.5, 1.5 };
    w->corners[3] = (vec2){ 0.5, 1.5 };
    w->belts[1].polygon = w->corners;
    w->belts[1].n_points = 4;
    w->def.n_belts = 2;
}

static uint64_t digest_of_run(world *w, int n_threads, uint64_t n_first, uint64_t n_steps)
{
    bf_buffer saved = { 0 };

    w->def.n_threads = n_threads;
    micro_solver *s = helper_micro_start(&w->def);
    assert_int_equal(micro_advance(s, n_first, NULL), BF_OK);
    assert_int_equal(micro_save(s, &saved, NULL), BF_OK);
    micro_destroy(s);
    s = helper_micro_start(&w->def);
    assert_int_equal(micro_load(s, saved.bytes, saved.n, NULL), BF_OK);
    assert_int_equal(micro_advance(s, n_steps - n_first, NULL), BF_OK);
    assert_true(micro_measure(s).n_contacts > 5);
    const uint64_t digest = micro_digest(s);
    micro_destroy(s);
    buffer_fini(&saved);
    return digest;
}

static void threads_and_resumes_change_no_bit_on_a_belt_that_turns(void **state)
{
    static const uint64_t steps[HELPER_MICRO_SOLVERS] = { 600, 60, 300, 60 };
    static world w;

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        make_crowd(&w, k);
        const uint64_t n = steps[k], digest = digest_of_run(&w, 1, 0, n);
        for (int n_threads = HELPER_AMOUNT(2, 3); n_threads <= 3; n_threads++)
            assert_true(digest_of_run(&w, n_threads, n_threads == 2 ? n / 3 : n / 2, n) == digest);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_part_comes_back_after_one_turn_but_for_the_drift_of_its_friction),
        cmocka_unit_test(a_part_at_rest_is_taken_along_and_turned_by_the_belt),
        cmocka_unit_test(
            a_part_rides_along_the_centre_line_of_a_path_but_for_the_drift_of_its_friction),
        cmocka_unit_test(threads_and_resumes_change_no_bit_on_a_belt_that_turns),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
