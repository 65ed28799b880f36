// Whole runs of both models over two belts with a gap: what is bridged, what falls, and what is told of it.

#include "core/advice/validity.h"
#include "core/observe/figure.h"
#include "core/run/run.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>

#define RADIUS 0.012

enum { LEFT = 1, FALLEN = 2 }; // columns, behind the only counter

static const run_model models[] = { RUN_MACRO, RUN_MICRO };

// Belts of 0.4 m/s in a domain of 0.8 m x 0.6 m, up to 0.4 m and from there on behind a gap, in cells of 8 mm.
static void add_belts(scene *s, double gap)
{
    const vec2 first[] = { { 0.0, 0.0 }, { 0.4, 0.0 }, { 0.4, 0.6 }, { 0.0, 0.6 } };
    const vec2 second[] = { { 0.4 + gap, 0.0 }, { 0.8, 0.0 }, { 0.8, 0.6 }, { 0.4 + gap, 0.6 } };

    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, first, 4);
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, second, 4);
    s->duration = 10.0;
    s->output.curve_every = 0.05;
    s->output.snapshot_every = 5.0;
    s->micro.integrator = SCENE_IMPLICIT;
    s->micro.step = 1e-3;
    s->micro.modulus_reduction = 1e4;
}

// A feed of 20 parts/s from the west.
static void make_fed(scene *s, double gap, scene_closure closure)
{
    helper_scene_belt(s, 0.8, 0.6, 0.008, NULL, 0);
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->macro.closure = closure;
    add_belts(s, gap);
    helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 20.0);
    s->warmup = 4.0;
    helper_scene_resolve(s);
    bf_faults faults = { 0 };
    scene_check(s, &faults);
    assert_int_equal(faults_status(&faults, NULL), BF_OK);
}

// Two parts at the start, one on the first belt and one on the second.
static void make_unfed(scene *s, double gap)
{
    static const scene_pose poses[] = { { 0.2, 0.3, 0.0 }, { 0.6, 0.3, 0.0 } };

    helper_scene_belt(s, 0.8, 0.6, 0.008, poses, 2);
    add_belts(s, gap);
    helper_scene_resolve(s);
    bf_faults faults = { 0 };
    scene_check(s, &faults);
    assert_int_equal(faults_status(&faults, NULL), BF_OK);
}

static helper_run_log *run_model_of(const scene *s, run_model model)
{
    helper_run_log *log = calloc(1, sizeof *log);

    log->model = model;
    assert_int_equal(helper_run(s, 1, 0, log), BF_OK);
    return log;
}

static double throughput(const scene *s, const helper_run_log *log)
{
    return log->figures[figure_at(s, FIGURE_THROUGHPUT, 0)];
}

// At every sample all that entered is on the belts, has left or has fallen.
static void check_balance(const helper_run_log *log)
{
    const frame_end *end = &log->end;
    const double *last = log->values[log->n_samples - 1];
    const double all = end->parts_start + end->parts_entered;

    assert_near(last[LEFT] + last[FALLEN] + end->parts_end, all, 1e-12 * all);
    assert_near(last[FALLEN], end->parts_fallen, 0.0);
    for (size_t k = 1; k < log->n_samples; k++)
        assert_true(log->values[k][FALLEN] >= log->values[k - 1][FALLEN]);
}

static void a_narrow_gap_costs_no_throughput(void **state)
{
    static const double gaps[] = { 0.0, 0.4 * RADIUS, 0.9 * RADIUS };

    for (size_t m = 0; m < 3; m++) {
        for (size_t g = 0; g < 3; g++) {
            scene s;
            make_fed(&s, gaps[g], m == 0 ? SCENE_DISPERSIVE : SCENE_CONGESTED);
            helper_run_log *log = run_model_of(&s, m < 2 ? RUN_MACRO : RUN_MICRO);
            assert_near(throughput(&s, log), 72000.0, 0.01 * 72000.0);
            assert_near(log->end.parts_fallen, 0.0, 0.0);
            assert_int_equal(log->begin.n_columns, gaps[g] > 0.0 ? 7 : 6);
            if (gaps[g] > 0.0)
                check_balance(log);
            helper_run_free(log);
            scene_fini(&s);
        }
    }
}

// All that enters comes to the border 1 s later, and none of it to the outlet, also where the gap is hardly too wide.
static void what_comes_to_a_wide_gap_falls_and_is_no_throughput(void **state)
{
    static const double gaps[] = { 1.1 * RADIUS, 3.0 * RADIUS };

    for (size_t k = 0; k < 6; k++) {
        const size_t m = k / 2;
        scene s;
        make_fed(&s, gaps[k % 2], m == 0 ? SCENE_DISPERSIVE : SCENE_CONGESTED);
        helper_run_log *log = run_model_of(&s, m < 2 ? RUN_MACRO : RUN_MICRO);
        assert_near(throughput(&s, log), 0.0, 0.0);
        assert_near(log->end.parts_fallen, 20.0 * 9.0, 3.0);
        assert_near(log->end.parts_end, 20.0, 3.0);
        check_balance(log);
        helper_run_free(log);
        scene_fini(&s);
    }
}

// A gap of a fifth of a cell about the centre of one, and about the face between two.
static void cells_that_are_too_large_for_a_gap_let_nothing_pass(void **state)
{
    static const double cells[] = { 0.8 / 11.0, 0.1 };

    for (int k = 0; k < 2 * SCENE_CLOSURE_COUNT; k++) {
        scene s;
        make_fed(&s, 0.02, (scene_closure)(k / 2));
        s.macro.cell = cells[k % 2];
        s.macro.step = 0.0;
        s.belts[0].polygon[1].x = s.belts[0].polygon[2].x = 0.39;
        s.belts[1].polygon[0].x = s.belts[1].polygon[3].x = 0.41;
        helper_run_log *log = run_model_of(&s, RUN_MACRO);
        assert_near(throughput(&s, log), 0.0, 0.0);
        assert_true(log->end.parts_fallen > 150.0);
        check_balance(log);
        helper_run_free(log);
        scene_fini(&s);
    }
}

// Of a scene with the second part alone.
static double sustained_alone(run_model model)
{
    static const scene_pose pose = { 0.6, 0.3, 0.0 };
    scene s;

    helper_scene_belt(&s, 0.8, 0.6, 0.008, &pose, 1);
    add_belts(&s, 3.0 * RADIUS);
    helper_scene_resolve(&s);
    bf_faults faults = { 0 };
    scene_check(&s, &faults);
    assert_int_equal(faults_status(&faults, NULL), BF_OK);
    helper_run_log *log = run_model_of(&s, model);
    const double rate = log->figures[figure_at(&s, FIGURE_SUSTAINED, 0)];
    helper_run_free(log);
    scene_fini(&s);
    return rate;
}

// The counter is the whole domain, and only the second part comes out of it by the belt.
static void what_falls_does_not_pass_a_counter(void **state)
{
    for (size_t m = 0; m < 2; m++) {
        scene s;
        make_unfed(&s, 3.0 * RADIUS);
        helper_run_log *log = run_model_of(&s, models[m]);
        assert_near(log->end.parts_fallen, 1.0, 1e-2);
        assert_near(log->values[log->n_samples - 1][LEFT], 1.0, 1e-2);
        check_balance(log);
        const double rate = sustained_alone(models[m]);
        assert_near(log->figures[figure_at(&s, FIGURE_SUSTAINED, 0)], rate, 1e-9 * rate);
        helper_run_free(log);
        scene_fini(&s);
    }
}

static void a_run_that_was_interrupted_or_has_threads_has_the_same_bits(void **state)
{
    for (size_t m = 0; m < 2; m++) {
        scene s;
        make_fed(&s, 3.0 * RADIUS, SCENE_CONGESTED);
        helper_run_log *whole = run_model_of(&s, models[m]);
        for (int n_threads = HELPER_AMOUNT(1, 2); n_threads <= 2; n_threads++) {
            helper_run_log *parted = calloc(1, sizeof *parted);
            parted->model = models[m];
            parted->stop_at = whole->n_askings / 2;
            assert_int_equal(helper_run(&s, n_threads, 0, parted), BF_OK);
            assert_true(parted->end.stopped && parted->end.parts_fallen > 0.0);
            parted->stop_at = 0;
            assert_int_equal(helper_run(&s, n_threads, 1, parted), BF_OK);
            assert_true(helper_run_is_same(whole, parted));
            helper_run_free(parted);
        }
        helper_run_free(whole);
        scene_fini(&s);
    }
}

static bool was_never_compared(const validity *of)
{
    bool is_told = false;

    for (size_t k = 0; k < of->n_never; k++)
        is_told = is_told || of->never[k].figure == VALIDITY_FALLS;
    return is_told && !of->is_compared;
}

static void where_cargo_falls_the_models_were_never_compared(void **state)
{
    static const double gaps[] = { 0.9 * RADIUS, 1.1 * RADIUS };

    for (size_t g = 0; g < 2; g++) {
        static validity of;
        scene s;
        make_fed(&s, gaps[g], SCENE_CONGESTED);
        assert_int_equal(validity_of(&s, &of, NULL), BF_OK);
        assert_true(was_never_compared(&of) == (g == 1));
        assert_int_equal(validity_of_parts(&s, 0.01, &of, NULL), BF_OK);
        assert_true(was_never_compared(&of) == (g == 1));
        scene_fini(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_narrow_gap_costs_no_throughput),
        cmocka_unit_test(what_comes_to_a_wide_gap_falls_and_is_no_throughput),
        cmocka_unit_test(cells_that_are_too_large_for_a_gap_let_nothing_pass),
        cmocka_unit_test(what_falls_does_not_pass_a_counter),
        cmocka_unit_test(a_run_that_was_interrupted_or_has_threads_has_the_same_bits),
        cmocka_unit_test(where_cargo_falls_the_models_were_never_compared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
