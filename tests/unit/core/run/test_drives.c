// Runs of both models with a plate whose drive stalls: what they tell of it, and resuming.

#include "core/observe/figure.h"
#include "core/run/run.h"
#include "core/world/plate_drive.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 11, ROWS = 8 };

static const double pitch = 0.0245; // of parts of 12 mm radius, m
static const double degree = M_PI / 180.0;

static helper_run_log *new_log(run_model model)
{
    helper_run_log *log = calloc(1, sizeof *log);

    assert_non_null(log);
    log->model = model;
    return log;
}

// A closed box of 0.6 m x 0.2 m. A plate in its middle, longer than the box is wide, turns by 55 degrees towards the eastern
// half, 0.06 m2, of which 88 parts take 0.047 m2 where they are packed to 0.84. There is room for 33 degrees,
// 0.2^2 tan(33 degrees)/2 = 0.013 m2; for a few more in the density, of which some lies behind the walls at the start.
static void make_press(scene *s)
{
    static const vec2 path[] = { { 0.3, 0.0 }, { 0.3, 0.36 } };
    static const double times[] = { 0.05, 0.55, 0.7, 1.2 };
    const double angles[] = { 0.0, -55.0 * degree, -55.0 * degree, 0.0 };
    scene_pose poses[COLUMNS * ROWS];

    for (int k = 0; k < COLUMNS * ROWS; k++)
        poses[k] =
            (scene_pose){ 0.6 - pitch * (0.5 + k % COLUMNS), pitch * (0.5 + k / COLUMNS), 0.0 };
    helper_scene_belt(s, 0.6, 0.2, 0.01, poses, COLUMNS * ROWS);
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        s->edges[side] = SCENE_EDGE_WALL;
    helper_scene_add_belt(s, (vec2){ 0.1, 0.0 }, NULL, 0);
    scene_obstacle *o = helper_scene_add_obstacle(s, path, 2, SCENE_SEALED);
    snprintf(o->id, sizeof o->id, "arm");
    o->turn = helper_scene_series(4, times, angles, INFINITY);
    s->macro.closure = SCENE_CONGESTED;
    s->duration = 1.3;
    helper_scene_resolve(s);
}

static double figure_of(const scene *s, const helper_run_log *log, figure_id id)
{
    return log->figures[figure_at(s, id, 0)];
}

// It stalls on its way, after some angle and before the last one, and is as told again when it comes back.
static void a_run_tells_of_a_drive_that_stalls_and_of_one_that_has_caught_up(void **state)
{
    for (int model = RUN_MACRO; model <= RUN_MICRO; model++) {
        helper_run_log *log = new_log((run_model)model);
        scene s;
        make_press(&s);
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        size_t n_stalls = 0, first = 0;
        assert_true(log->n_changes > 0);
        for (size_t k = 0; k < log->n_changes; k++) {
            const frame_change *c = &log->changes[k];
            assert_int_equal(c->type, FRAME_CHANGE_DRIVE);
            assert_string_equal(c->id, "arm");
            if (c->state != PLATE_DRIVE_STALLED)
                continue;
            first = n_stalls++ == 0 ? k : first;
        }
        assert_true(n_stalls > 0);
        const frame_change *stalled = &log->changes[first];
        assert_true(stalled->t > 0.05 && stalled->t < 0.55);
        assert_true(stalled->turn < -0.02 && stalled->turn > -55.0 * degree + 0.1);
        const frame_change *last = &log->changes[log->n_changes - 1];
        assert_int_equal(last->state, PLATE_DRIVE_AS_TOLD);
        assert_true(last->t > 0.7 && last->t <= 1.2);
        assert_true(figure_of(&s, log, FIGURE_STALL_COUNT) == (double)n_stalls);
        assert_near(figure_of(&s, log, FIGURE_STALL_FIRST), stalled->t, 1e-11);
        assert_true(figure_of(&s, log, FIGURE_STALL_TOTAL) > 0.1);
        assert_true(figure_of(&s, log, FIGURE_STALL_TOTAL) < last->t - stalled->t);
        scene_fini(&s);
        helper_run_free(log);
    }
}

static void a_run_stopped_while_its_drive_stalls_resumes_to_the_same_results(void **state)
{
    for (int model = RUN_MACRO; model <= RUN_MICRO; model++) {
        helper_run_log *whole = new_log((run_model)model), *log = new_log((run_model)model);
        scene s;
        make_press(&s);
        assert_int_equal(helper_run(&s, 1, 0, whole), BF_OK);
        log->stop_at = whole->n_askings / 2; // while it is told to stand at 55 degrees
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        assert_int_equal(log->end.stopped, 1);
        assert_int_equal(helper_run(&s, 2, 1, log), BF_OK);
        assert_true(helper_run_is_same(log, whole));
        scene_fini(&s);
        helper_run_free(log);
        helper_run_free(whole);
    }
}

// A full line of cans of 76 mm at 1.6 m/s before an arm that leaves them less than a diameter: it encloses cargo on its way back
// against the belt, stalls, and lets the cargo go when it turns the other way.
static void cargo_that_an_arm_has_enclosed_is_let_go(void **state)
{
    static const vec2 path[] = { { 0.5334, 0.0 }, { 0.5334, 0.4234 } };
    static const double times[] = { 0.0, 2.0, 4.0, 6.0 };
    const double angles[] = { 80.0 * degree, 80.0 * degree, 0.0, 80.0 * degree };
    helper_run_log *log = new_log(RUN_MACRO);
    scene s;

    helper_scene_belt(&s, 0.762, 0.499, 0.0254, NULL, 0);
    s.initial.type = SCENE_INITIAL_EMPTY;
    s.cargo[0].shape.radius = 0.0381;
    s.cargo[0].mass = 0.49;
    (void)helper_scene_add_belt(&s, (vec2){ 1.6, 0.0 }, NULL, 0);
    (void)helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 55.0);
    scene_obstacle *o = helper_scene_add_obstacle(&s, path, 2, SCENE_SEALED);
    o->turn = helper_scene_series(4, times, angles, 8.0);
    s.macro.closure = SCENE_CONGESTED;
    s.macro.step = 0.0;
    s.duration = 12.0;
    helper_scene_resolve(&s);
    assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
    assert_true(figure_of(&s, log, FIGURE_STALL_COUNT) > 0.0);
    scene_fini(&s);
    helper_run_free(log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_tells_of_a_drive_that_stalls_and_of_one_that_has_caught_up),
        cmocka_unit_test(a_run_stopped_while_its_drive_stalls_resumes_to_the_same_results),
        cmocka_unit_test(cargo_that_an_arm_has_enclosed_is_let_go),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
