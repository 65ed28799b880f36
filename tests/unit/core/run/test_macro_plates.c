// Runs of the macroscopic model with a diverter that swings: stops, checkpoints, commands, and steps at fault.

#include "core/run/run.h"
#include "core/run/run_priv.h"
#include "tests/unit/core/helper_backend.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/core/helper_world.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degree = M_PI / 180.0;

// Example 1's belt; its plate turns by 20 degrees within 0.1 s and back, and is away from 0.26 s on.
static void make_swing(scene *s, scene_closure closure, scene_scheme scheme)
{
    static const double times[] = { 0.02, 0.12, 0.16, 0.24 }, gone[] = { 0.26 }, none[] = { 0.0 };
    const double angles[] = { 0.0, 20.0 * degree, 20.0 * degree, -5.0 * degree };

    helper_scene_example(s, 60.0, SCENE_SEALED);
    s->initial.first = (vec2){ 0.35, 0.11 };
    s->duration = 0.3;
    s->macro.cell = 0.01;
    s->macro.step = 0.0025;
    s->macro.closure = closure;
    s->macro.scheme = scheme;
    s->obstacles[0].turn = helper_scene_series(4, times, angles, INFINITY);
    s->obstacles[0].presence = helper_scene_series(1, gone, none, INFINITY);
}

static helper_run_log *new_log(void)
{
    helper_run_log *log = calloc(1, sizeof *log);

    assert_non_null(log);
    return log;
}

static void a_run_stopped_in_a_swing_resumes_to_the_same_results(void **state)
{
    for (int k = 0; k < 4; k++) {
        scene s;
        make_swing(&s, k < 2 ? SCENE_DISPERSIVE : SCENE_CONGESTED,
                   k % 2 == 0 ? SCENE_SCHEME_ROE : SCENE_SCHEME_MUSCL);
        helper_run_free(helper_run_check_stops(&s, RUN_MACRO, 6, HELPER_AMOUNT(1, 3),
                                               (helper_run_threads){ .before = 1, .after = 2 }));
        scene_fini(&s);
    }
}

static void a_checkpoint_fits_no_other_motion(void **state)
{
    helper_run_log *log = new_log();
    scene s;

    make_swing(&s, SCENE_DISPERSIVE, SCENE_SCHEME_ROE);
    log->stop_at = 1;
    assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
    s.obstacles[0].turn.values[3] *= 1.0 + 0x1p-40;
    assert_int_equal(helper_run(&s, 1, 1, log), BF_ECORRUPT);
    scene_fini(&s);
    helper_run_free(log);
}

static bf_world *make(const scene *s, void **ret_solver)
{
    bf_world *w = helper_world(s->n_belts, s->belts, s->n_obstacles, s->obstacles);
    run_plan plan;

    assert_int_equal(run__macro.create(s, w, 1, ret_solver, &plan, NULL), BF_OK);
    return w;
}

static void command(bf_world *w, uint64_t step, scene_action_type type, double value)
{
    const scene_action action = { .type = type, .value = value, .over = 0.125 };

    world_command(w, &action, (double)step * 0x1p-9);
}

static void advance(void *solver, uint64_t n_steps)
{
    assert_int_equal(run__macro.advance(solver, n_steps, NULL), BF_OK);
}

static uint64_t digest_after(const scene *s, uint64_t n_steps)
{
    void *solver;

    (void)make(s, &solver);
    advance(solver, n_steps);
    const uint64_t digest = run__macro.digest(solver);
    run__macro.destroy(solver);
    return digest;
}

// A turn, an absence and a stop of the belt by command are those of a schedule, also after a stop of the run. Steps of
// 2^-9 s, so that all times are exact.
static void commands_act_as_schedules_do(void **state)
{
    static const double turn_times[] = { 0.0625, 0.1875 }, zero[] = { 0.0 };
    const double angles[] = { 0.0, 20.0 * degree };

    for (int k = 0; k < 2; k++) {
        const scene_closure closure = k == 0 ? SCENE_DISPERSIVE : SCENE_CONGESTED;
        scene s;
        void *first, *then;
        bf_buffer saved = { 0 };
        make_swing(&s, closure, SCENE_SCHEME_ROE);
        s.macro.step = 0x1p-9;
        s.obstacles[0].turn.n_times = s.obstacles[0].turn.n_values = 0;
        s.obstacles[0].presence.n_times = s.obstacles[0].presence.n_values = 0;
        s.obstacles[0].is_commanded = s.belts[0].is_commanded = true;
        bf_world *w = make(&s, &first), *w_then = make(&s, &then);
        advance(first, 32);
        command(w, 32, SCENE_ACTION_TURN, 20.0 * degree);
        advance(first, 72);
        command(w, 104, SCENE_ACTION_PRESENCE, 0.0);
        advance(first, 16);
        command(w, 120, SCENE_ACTION_BELT, 0.0);
        helper_world_copy(w, w_then);
        assert_int_equal(helper_backend_save(&run__macro, first, &saved), BF_OK);
        assert_int_equal(helper_backend_load(&run__macro, then, &saved), BF_OK);
        advance(then, 30);
        const uint64_t commanded = run__macro.digest(then);
        run__macro.destroy(first);
        run__macro.destroy(then);
        buffer_fini(&saved);
        scene_fini(&s);

        make_swing(&s, closure, SCENE_SCHEME_ROE);
        s.macro.step = 0x1p-9;
        s.obstacles[0].turn.n_times = s.obstacles[0].turn.n_values = 2;
        memcpy(s.obstacles[0].turn.times, turn_times, sizeof turn_times);
        memcpy(s.obstacles[0].turn.values, angles, sizeof angles);
        s.obstacles[0].presence.times[0] = 104 * 0x1p-9;
        helper_scene_schedule(&s.belts[0], 1, (double[]){ 120 * 0x1p-9 }, zero);
        assert_true(digest_after(&s, 150) == commanded);
        scene_fini(&s);
    }
}

// The path is 0.5 m/sin 60 degrees long, and with its thickness 0.5824 m; 25 degrees in 0.08 s are 5.4542 rad/s.
static void a_plate_that_turns_by_more_than_a_cell_in_a_step_is_refused(void **state)
{
    scene s;
    bf_faults faults = { 0 };

    make_swing(&s, SCENE_DISPERSIVE, SCENE_SCHEME_ROE);
    const double most = 0.01 / ((0.5 / sin(60.0 * degree) + 0.005) * 25.0 * degree / 0.08);
    s.macro.step = most;
    run_check(&s, RUN_MACRO, &faults);
    assert_int_equal(faults.n, 0);
    s.macro.step = most * (1.0 + 1e-6);
    run_check(&s, RUN_MACRO, &faults);
    assert_int_equal(faults.n, 1);
    assert_string_equal(faults.items[0].pointer, "/macro/step_s");
    assert_non_null(strstr(faults.items[0].text, "obstacle"));
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_stopped_in_a_swing_resumes_to_the_same_results),
        cmocka_unit_test(a_checkpoint_fits_no_other_motion),
        cmocka_unit_test(commands_act_as_schedules_do),
        cmocka_unit_test(a_plate_that_turns_by_more_than_a_cell_in_a_step_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
