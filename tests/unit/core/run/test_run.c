// Unit tests of runs: what they report, when, and that stopping in between changes nothing.

#include "core/base/memory.h"
#include "core/run/run.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A short jam: Example 1's obstacle, coarse cells, the first 1.2 s.
static void make_jam(scene *s)
{
    helper_scene_example(s, 60.0, SCENE_SEALED);
    s->duration = 1.2;
    s->macro.cell = 0.01;
    s->macro.step = 0.0025;
}

static helper_run_log *run_jam(int n_threads)
{
    helper_run_log *log = calloc(1, sizeof *log);
    scene s;

    make_jam(&s);
    assert_int_equal(helper_run(&s, n_threads, 0, log), BF_OK);
    scene_fini(&s);
    return log;
}

// 1.2 s in samples of 0.01 s and snapshots of 0.1 s, both ends included.
static void a_run_samples_both_ends_and_every_period_between(void **state)
{
    helper_run_log *log = run_jam(1);
    assert_int_equal(log->n_samples, 121);
    assert_int_equal(log->n_snapshots, 13);
    for (int k = 0; k <= 120; k++)
        assert_near(log->t[k], 0.01 * k, 1e-12);
    assert_int_equal(log->n_frames[FRAME_BEGIN], 1);
    assert_int_equal(log->n_frames[FRAME_END], 1);
    assert_int_equal(log->begin.n_steps, 480);
    assert_int_equal(log->end.n_steps, 480);
    assert_int_equal(log->end.n_samples, 121);
    assert_int_equal(log->end.stopped, 0);
    helper_run_free(log);
}

// Steps of 0.7 ms do not fit into 10 ms: the sample is the first at or past each multiple.
static void samples_follow_their_period_when_steps_do_not_fit(void **state)
{
    helper_run_log *log = calloc(1, sizeof *log);
    scene s;
    make_jam(&s);
    s.duration = 0.1;
    s.macro.step = 7e-4;
    assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
    assert_int_equal(log->end.n_steps, 143); // the first at or past 0.1 s
    for (size_t k = 0; k + 1 < log->n_samples; k++)
        assert_near(log->t[k], ceil(0.01 * (double)k / 7e-4 - 1e-9) * 7e-4, 1e-12);
    scene_fini(&s);
    helper_run_free(log);
}

static void parts_are_either_in_the_domain_or_have_left_it(void **state)
{
    helper_run_log *log = run_jam(1);
    for (size_t k = 0; k < log->n_samples; k++)
        assert_true(log->values[k][1] >= -1e-9);
    double left = log->values[log->n_samples - 1][1];
    assert_near(log->end.parts_start - log->end.parts_end, left, 0.0);
    // The tails of the outermost parts extend over the western edge: fewer than 192 by 2e-6.
    assert_near(log->end.parts_start, 192.0, 1e-5);
    helper_run_free(log);
}

static void threads_and_reports_change_no_result(void **state)
{
    helper_run_log *one = run_jam(1), *two = run_jam(2), *reporting = calloc(1, sizeof *reporting);
    scene s;
    make_jam(&s);
    reporting->report_every = 3;
    assert_int_equal(helper_run(&s, 1, 0, reporting), BF_OK);
    assert_true(helper_run_is_same(one, two));
    assert_true(helper_run_is_same(one, reporting));
    assert_true(reporting->n_frames[FRAME_PROGRESS] > 100);
    scene_fini(&s);
    helper_run_free(one);
    helper_run_free(two);
    helper_run_free(reporting);
}

static void a_run_stopped_anywhere_resumes_to_the_same_results(void **state)
{
    static const uint64_t stops[] = { 1, 2, 3, 4, 77, 200, 480 };
    helper_run_log *whole = run_jam(1);
    scene s;
    make_jam(&s);
    for (size_t k = 0; k < sizeof stops / sizeof *stops; k++) {
        helper_run_log *log = calloc(1, sizeof *log);
        log->stop_at = stops[k];
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        assert_int_equal(log->end.stopped, 1);
        assert_int_equal(log->end.n_steps, stops[k] - 1);
        assert_int_equal(log->n_frames[FRAME_CHECKPOINT], 1);
        assert_int_equal(helper_run(&s, 2, 1, log), BF_OK);
        assert_int_equal(log->begin.first_step, stops[k] - 1);
        assert_true(helper_run_is_same(whole, log));
        helper_run_free(log);
    }
    scene_fini(&s);
    helper_run_free(whole);
}

static void a_damaged_or_foreign_checkpoint_is_refused(void **state)
{
    helper_run_log *log = calloc(1, sizeof *log);
    scene s;
    make_jam(&s);
    log->stop_at = 50;
    assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
    for (size_t k = 0; k < log->checkpoint.n; k += k < 128 ? 5 : 1009) {
        log->checkpoint.bytes[k] ^= 4;
        assert_int_equal(helper_run(&s, 1, 1, log), BF_ECORRUPT);
        log->checkpoint.bytes[k] ^= 4;
    }
    s.macro.cell = 0.02;
    assert_int_equal(helper_run(&s, 1, 1, log), BF_ECORRUPT);
    scene_fini(&s);
    helper_run_free(log);
}

// Changes one number of a scenario, of whose cargo there is one kind and which has one belt and one plate.
static void change_scene(scene *s, int k)
{
    double *const numbers[] = { &s->belts[0].velocity.x,
                                &s->obstacles[0].path[1].x,
                                &s->obstacles[0].slide_width,
                                &s->cargo[0].mass,
                                &s->micro.contact[SCENE_HANDLING_CARGO].friction,
                                &s->micro.damping,
                                &s->macro.mollifier,
                                &s->macro.initial_mollifier,
                                &s->macro.dispersion,
                                &s->macro.packing,
                                &s->initial.spacing,
                                &s->duration,
                                &s->output.curve_every,
                                &s->counters[0].rect.x_max };

    *numbers[k] *= 1.0 + 0x1p-40;
}

enum { SCENE_CHANGES = 14 };

static void check_foreign(run_model model, scene_path path, scene_integrator integrator)
{
    helper_run_log *log = calloc(1, sizeof *log);
    scene s;

    for (int k = -1; k < SCENE_CHANGES; k++) {
        run *r = NULL;
        make_jam(&s);
        s.micro.path = path;
        s.micro.integrator = integrator;
        s.micro.step = 1e-5;
        if (k < 0) {
            log->model = model;
            log->stop_at = 1;
            assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        } else {
            change_scene(&s, k);
        }
        assert_int_equal(
            run_resume(&s, model, 1, log->checkpoint.bytes, log->checkpoint.n, &r, NULL),
            k < 0 ? BF_OK : BF_ECORRUPT);
        assert_true((r != NULL) == (k < 0));
        run_destroy(r);
        scene_fini(&s);
    }
    helper_run_free(log);
}

static void a_checkpoint_fits_no_scenario_that_differs_in_one_number(void **state)
{
    check_foreign(RUN_MACRO, SCENE_PATH_AUTO, SCENE_VERLET);
    check_foreign(RUN_MICRO, SCENE_PATH_PLANAR, SCENE_VERLET);
    check_foreign(RUN_MICRO, SCENE_PATH_PLANAR, SCENE_IMPLICIT);
    check_foreign(RUN_MICRO, SCENE_PATH_SPATIAL, SCENE_VERLET);
    check_foreign(RUN_MICRO, SCENE_PATH_SPATIAL, SCENE_IMPLICIT);
}

static bf_status refuse_snapshots(void *context, const frame *f, bf_error *err)
{
    return f->type == FRAME_SNAPSHOT ? bf_fail(err, BF_ESYSTEM, "", "no room") : BF_OK;
}

static void a_sink_that_fails_ends_the_run_with_its_error(void **state)
{
    const run_sink sink = { NULL, refuse_snapshots, NULL };
    bf_error err = { 0 };
    run *r = NULL;
    scene s;
    make_jam(&s);
    assert_int_equal(run_create(&s, RUN_MACRO, 1, &r, NULL), BF_OK);
    assert_int_equal(run_execute(r, &sink, &err), BF_ESYSTEM);
    assert_string_equal(err.text, "no room");
    run_destroy(r);
    scene_fini(&s);
}

static void a_model_that_is_not_built_in_is_refused(void **state)
{
    bf_error err = { 0 };
    run *r = NULL;
    scene s;
    make_jam(&s);
    assert_true(run_model_is_available(RUN_MACRO));
    for (int model = 0; model <= RUN_MODEL_COUNT; model++)
        if (!run_model_is_available((run_model)model)) {
            assert_int_equal(run_create(&s, (run_model)model, 1, &r, &err), BF_EINPUT);
            assert_string_equal(err.pointer, "/model");
        }
    assert_null(r);
    scene_fini(&s);
}

static void out_of_memory_anywhere_is_an_error(void **state)
{
    bf_status status = BF_ENOMEM;
    run *r = NULL;
    scene s;
    make_jam(&s);
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = run_create(&s, RUN_MACRO, 1, &r, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK ? r != NULL : status == BF_ENOMEM && r == NULL);
    }
    run_destroy(r);
    assert_null(run_destroy(NULL));
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_samples_both_ends_and_every_period_between),
        cmocka_unit_test(samples_follow_their_period_when_steps_do_not_fit),
        cmocka_unit_test(parts_are_either_in_the_domain_or_have_left_it),
        cmocka_unit_test(threads_and_reports_change_no_result),
        cmocka_unit_test(a_run_stopped_anywhere_resumes_to_the_same_results),
        cmocka_unit_test(a_damaged_or_foreign_checkpoint_is_refused),
        cmocka_unit_test(a_checkpoint_fits_no_scenario_that_differs_in_one_number),
        cmocka_unit_test(a_sink_that_fails_ends_the_run_with_its_error),
        cmocka_unit_test(a_model_that_is_not_built_in_is_refused),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
