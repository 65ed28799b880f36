// Key figures of whole runs of both models, on belts where they follow by hand.

#include "core/base/memory.h"
#include "core/observe/figure.h"
#include "core/run/run.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>

static const run_model models[] = { RUN_MACRO, RUN_MICRO };

// A belt of 0.4 m/s, 0.8 m x 0.6 m, that a feed in the middle of its western side gives 4 cylinders of 12 mm in a second, in
// single file; a photo eye across it at 0.6 m; the first 5 of 30 s are warm-up.
static void make_file(scene *s)
{
    helper_scene_belt(s, 0.8, 0.6, 0.01, NULL, 0);
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->duration = 30.0;
    s->warmup = 5.0;
    s->output.curve_every = 0.05;
    s->output.snapshot_every = 5.0;
    s->micro.integrator = SCENE_IMPLICIT;
    s->micro.step = 1e-3;
    s->micro.modulus_reduction = 1e4;
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, NULL, 0);
    scene_feed *feed = helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 4.0);
    feed->line[0] = (vec2){ 0.0, 0.28 };
    feed->line[1] = (vec2){ 0.0, 0.32 };
    s->n_eyes = 1;
    s->eyes = memory_alloc(1, sizeof *s->eyes);
    scene_photo_eye_init(s->eyes);
    s->eyes[0].line[0] = (vec2){ 0.6, 0.1 };
    s->eyes[0].line[1] = (vec2){ 0.6, 0.5 };
    helper_scene_resolve(s);
    bf_faults faults = { 0 };
    scene_check(s, &faults);
    assert_int_equal(faults_status(&faults, NULL), BF_OK);
}

static double value(const scene *s, const helper_run_log *log, figure_id id)
{
    assert_int_equal(log->n_figures, figure_values(s));
    return log->figures[figure_at(s, id, 0)];
}

static helper_run_log *run_model_of(const scene *s, run_model model)
{
    helper_run_log *log = calloc(1, sizeof *log);

    log->model = model;
    assert_int_equal(helper_run(s, 1, 0, log), BF_OK);
    return log;
}

// 4 parts/s leave, each after 0.8/0.4 = 2 s: by Little's law 8 parts are inside. All run with the belt. The tick and the
// last cell cost 1 %.
static void a_free_file_has_the_throughput_residence_and_content_of_its_feed(void **state)
{
    scene s;
    make_file(&s);
    for (size_t m = 0; m < 2; m++) {
        helper_run_log *log = run_model_of(&s, models[m]);
        assert_near(value(&s, log, FIGURE_THROUGHPUT), 14400.0, 1e-6 * 14400.0);
        assert_true(isnan(value(&s, log, FIGURE_THROUGHPUT_ERROR))); // no chance in it
        assert_true(isnan(value(&s, log, FIGURE_THROUGHPUT_NEEDS)));
        assert_near(value(&s, log, FIGURE_STEADY_AT), 13.0, 1e-9); // 32 batches of 0.25 s
        assert_near(value(&s, log, FIGURE_RESIDENCE_MEAN), 2.0, 0.02);
        assert_near(value(&s, log, FIGURE_RESIDENCE_P99), 2.0, 0.03);
        assert_near(value(&s, log, FIGURE_CONTENT_MEAN), 8.0, 0.08);
        assert_near(value(&s, log, FIGURE_JAM_COUNT), 0.0, 0.0);
        assert_near(value(&s, log, FIGURE_OFFERED), 120.0, 1e-6);
        assert_near(value(&s, log, FIGURE_ADMITTED), 120.0, 1e-6);
        assert_near(value(&s, log, FIGURE_WAIT_MEAN), 0.0, 0.01);
        assert_true(isnan(value(&s, log, FIGURE_DRAINED_AT)));
        helper_run_free(log);
    }
    scene_fini(&s);
}

// Boxes of the length L, a gap g apart on a belt of the speed v: 3600 v/(L + g) of them pass in an hour, by hand; and the photo eye
// finds gaps of g. All that is offered is admitted, whatever the room between two.
static void singulated_boxes_pass_at_the_speed_over_their_pitch(void **state)
{
    static const struct {
        double length, gap, speed; // m, m, m/s
    } rows[] = { { 0.3, 0.2, 0.5 }, { 0.6, 0.1, 1.0 } };

    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        const double pitch = rows[k].length + rows[k].gap;
        scene s;
        helper_scene_belt(&s, 2.0, 0.6, 0.05, NULL, 0);
        s.initial.type = SCENE_INITIAL_EMPTY;
        s.duration = 30.0;
        s.warmup = 5.0;
        s.output.curve_every = 0.05;
        s.output.snapshot_every = 30.0;
        s.macro.closure = SCENE_CONGESTED;
        s.micro.integrator = SCENE_IMPLICIT;
        s.cargo->shape = (scene_shape){
            .type = SCENE_BOX, .length = rows[k].length, .width = 0.3, .height = 0.2
        };
        s.cargo->mass = 2.0;
        helper_scene_add_belt(&s, (vec2){ rows[k].speed, 0.0 }, NULL, 0);
        scene_feed *feed =
            helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, rows[k].speed / pitch);
        feed->line[0] = (vec2){ 0.0, 0.15 };
        feed->line[1] = (vec2){ 0.0, 0.45 };
        s.n_eyes = 1;
        s.eyes = memory_alloc(1, sizeof *s.eyes);
        scene_photo_eye_init(s.eyes);
        s.eyes[0].line[0] = (vec2){ 1.5, 0.1 };
        s.eyes[0].line[1] = (vec2){ 1.5, 0.5 };
        helper_scene_resolve(&s);
        for (size_t m = 0; m < 2; m++) {
            helper_run_log *log = run_model_of(&s, models[m]);
            const double by_hand = 3600.0 * rows[k].speed / pitch;
            assert_near(value(&s, log, FIGURE_THROUGHPUT), by_hand, 0.01 * by_hand);
            if (models[m] == RUN_MICRO)
                assert_near(value(&s, log, FIGURE_GAP_MEAN), rows[k].gap, 0.01 * rows[k].gap);
            helper_run_free(log);
        }
        scene_fini(&s);
    }
}

// Cargo that comes evenly over the width, onto a half of the belt that runs at 0.4 m/s and one at 0.2 m/s: half of it
// leaves after 2 s, half after 4 s.
static void lanes_have_times_of_their_own(void **state)
{
    static const vec2 slow[] = { { 0.0, 0.3 }, { 0.8, 0.3 }, { 0.8, 0.6 }, { 0.0, 0.6 } };

    for (int closure = 0; closure < SCENE_CLOSURE_COUNT; closure++) {
        scene s;
        make_file(&s);
        s.macro.closure = (scene_closure)closure;
        s.feeds[0].line[0] = (vec2){ 0.0, 0.0 };
        s.feeds[0].line[1] = (vec2){ 0.0, 0.6 };
        helper_scene_add_belt(&s, (vec2){ 0.2, 0.0 }, slow, 4);
        helper_scene_resolve(&s);
        helper_run_log *log = run_model_of(&s, RUN_MACRO);
        assert_near(value(&s, log, FIGURE_RESIDENCE_MEAN), 3.0, 0.06);
        assert_near(value(&s, log, FIGURE_RESIDENCE_P90), 4.0, 0.06);
        helper_run_free(log);
        scene_fini(&s);
    }
}

// The same belts, each of which is an outlet, and two counters: upstream, where both pass, and the end of the slow lane. What leaves the outlets is what leaves the domain, at each sample; half of it in each lane.
static void flows_of_counters_and_outlets_agree_with_the_throughput(void **state)
{
    static const vec2 slow[] = { { 0.0, 0.3 }, { 0.8, 0.3 }, { 0.8, 0.6 }, { 0.0, 0.6 } };
    static const scene_rect rects[] = { { 0.0, 0.4, 0.0, 0.6 }, { 0.4, 0.8, 0.3, 0.6 } };
    static const struct {
        run_model model;
        scene_closure closure;
        double tolerance; // of half the throughput
    } ways[] = { { RUN_MACRO, SCENE_DISPERSIVE, 1e-3 },
                 { RUN_MACRO, SCENE_CONGESTED, 1e-3 },
                 { RUN_MICRO, SCENE_CONGESTED, 0.25 } }; // 100 parts by lot

    for (size_t way = 0; way < 3; way++) {
        scene s;
        make_file(&s);
        s.n_eyes = 0;
        s.macro.closure = ways[way].closure;
        s.feeds[0].line[0] = (vec2){ 0.0, 0.0 };
        s.feeds[0].line[1] = (vec2){ 0.0, 0.6 };
        helper_scene_add_belt(&s, (vec2){ 0.2, 0.0 }, slow, 4);
        memory_free(s.counters);
        s.n_counters = 2;
        s.counters = memory_alloc(2, sizeof *s.counters);
        for (size_t k = 0; k < 2; k++) {
            scene_counter_init(&s.counters[k]);
            s.counters[k].rect = rects[k];
        }
        helper_scene_resolve(&s);
        assert_int_equal(figure_items(&s, FIGURE_OF_OUTLET), 2);
        helper_run_log *log = run_model_of(&s, ways[way].model);
        const double *of = log->figures, through = value(&s, log, FIGURE_THROUGHPUT);
        const double fast = of[figure_at(&s, FIGURE_OUTFLOW, 0)];
        const double lane = of[figure_at(&s, FIGURE_OUTFLOW, 1)];
        for (size_t k = 0; k < log->n_samples; k++) {
            const double *columns =
                log->values[k]; // counters, left_domain, the feed's four, outlets
            assert_near(columns[7] + columns[8], columns[2], 1e-9 + 1e-9 * columns[2]);
        }
        assert_near(fast + lane, through, 1e-9 * through);
        assert_near(lane, 0.5 * through, ways[way].tolerance * through);
        assert_near(of[figure_at(&s, FIGURE_FLOW, 0)], 14400.0, 0.02 * 14400.0);
        assert_near(of[figure_at(&s, FIGURE_FLOW, 1)], lane, 1e-6 * through);
        helper_run_free(log);
        scene_fini(&s);
    }
}

// Parts follow each other at 0.4/4 = 0.1 m, of which they take 0.024 m.
static void gaps_are_those_between_the_parts(void **state)
{
    scene s;
    make_file(&s);
    helper_run_log *log = run_model_of(&s, RUN_MICRO);
    assert_near(value(&s, log, FIGURE_GAP_MEAN), 0.076, 2e-4);
    assert_near(value(&s, log, FIGURE_GAP_MIN), 0.076, 4e-3); // they enter at ticks
    assert_near(value(&s, log, FIGURE_DOUBLES), 0.0, 0.0);
    assert_near(value(&s, log, FIGURE_STATE_FREE), 1.0, 0.0);
    helper_run_free(log);
    scene_fini(&s);
}

// Of parts 0.1 m apart, by a Gaussian as wide as a part, sigma = 1/r^2, the peak is that of one: sigma/(2 pi rho_max), less what cells of
// 1 cm miss, exp(-sigma 50 mm2 / 2). By the one that the scenario gives, a quarter as wide, a part is 8 times as dense as close packing.
static void the_peak_of_parts_is_not_that_of_one_part(void **state)
{
    const double sigma = 1.0 / (0.012 * 0.012);
    scene s;
    make_file(&s);
    s.macro.initial_mollifier = 16.0 * sigma;
    const double one = sigma / (2.0 * M_PI * s.macro.packing);
    helper_run_log *log = run_model_of(&s, RUN_MICRO);
    assert_true(value(&s, log, FIGURE_PEAK) <= one * (1.0 + 1e-9));
    assert_true(value(&s, log, FIGURE_PEAK) >= one * exp(-0.5 * sigma * 50e-6));
    assert_true(log->end.peak > 1.0);
    helper_run_free(log);
    scene_fini(&s);
}

// The belt stops at 10 s for good: a jam from the last exit on, everything is blocked, and what comes waits. Until 30 s.
static void a_belt_that_stops_is_a_jam(void **state)
{
    static const double times[] = { 10.0 }, factors[] = { 0.0 };
    scene s;
    make_file(&s);
    helper_scene_schedule(&s.belts[0], 1, times, factors);
    for (size_t m = 0; m < 2; m++) {
        helper_run_log *log = run_model_of(&s, models[m]);
        assert_near(value(&s, log, FIGURE_JAM_COUNT), 1.0, 0.0);
        assert_near(value(&s, log, FIGURE_JAM_FIRST), 10.0, 0.3); // exits come every 0.25 s
        assert_near(value(&s, log, FIGURE_JAM_TOTAL), 20.0, 0.3);
        assert_true(value(&s, log, FIGURE_WAITING_MAX) > 70.0);   // of 80, less what the line took
        assert_true(value(&s, log, FIGURE_STATE_BLOCKED) > 0.75); // for 20 of 25 s
        helper_run_free(log);
    }
    scene_fini(&s);
}

// A part every 10 s crosses in 2 s, so that nothing leaves for 8 s. Then 4 parts/s come to a wall across the belt at 0.7 m, past which
// nothing gets: 120 parts, which in close packing take 0.1 m of the width of 0.6 m.
static void queue_states_and_jams_agree(void **state)
{
    static const vec2 wall[] = { { 0.7, 0.0 }, { 0.7, 0.6 } };

    for (int is_closed = 0; is_closed < 2; is_closed++) {
        scene s;
        make_file(&s);
        s.feeds[0].rate = is_closed ? 4.0 : 0.1;
        if (is_closed)
            helper_scene_add_obstacle(&s, wall, 2, SCENE_SEALED);
        helper_scene_resolve(&s);
        for (size_t m = 0; m < 2; m++) {
            helper_run_log *log = run_model_of(&s, models[m]);
            const double queued =
                value(&s, log, FIGURE_STATE_QUEUED) + value(&s, log, FIGURE_STATE_BLOCKED);
            assert_near(value(&s, log, FIGURE_JAM_COUNT), is_closed, 0.0);
            if (is_closed) {
                assert_true(queued > 0.5);
                assert_true(value(&s, log, FIGURE_QUEUE_END) > 0.09);
            } else {
                assert_near(queued, 0.0, 0.0);
                assert_near(value(&s, log, FIGURE_QUEUE_END), 0.0, 0.0);
            }
            helper_run_free(log);
        }
        scene_fini(&s);
    }
}

static void a_run_ends_when_its_throughput_is_steady(void **state)
{
    scene s;
    make_file(&s);
    s.until = SCENE_UNTIL_STEADY;
    for (size_t m = 0; m < 2; m++) {
        helper_run_log *log = run_model_of(&s, models[m]);
        assert_int_equal(log->end.reason, FRAME_END_STEADY);
        assert_near(log->end.t, 13.0, 1e-6);
        helper_run_free(log);
    }
    scene_fini(&s);
}

// Stopped half way and resumed, the values have the bits of a run in one piece.
static void stops_do_not_change_a_bit(void **state)
{
    scene s;
    make_file(&s);
    s.duration = 12.0;
    for (size_t m = 0; m < 2; m++) {
        helper_run_log *whole = run_model_of(&s, models[m]);
        helper_run_log *parts = calloc(1, sizeof *parts);
        parts->model = models[m];
        parts->stop_at = whole->n_askings / 2;
        assert_int_equal(helper_run(&s, 1, 0, parts), BF_OK);
        parts->stop_at = 0;
        assert_int_equal(helper_run(&s, 1, 1, parts), BF_OK);
        assert_true(helper_run_is_same(whole, parts));
        helper_run_free(whole);
        helper_run_free(parts);
    }
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_free_file_has_the_throughput_residence_and_content_of_its_feed),
        cmocka_unit_test(singulated_boxes_pass_at_the_speed_over_their_pitch),
        cmocka_unit_test(lanes_have_times_of_their_own),
        cmocka_unit_test(flows_of_counters_and_outlets_agree_with_the_throughput),
        cmocka_unit_test(gaps_are_those_between_the_parts),
        cmocka_unit_test(the_peak_of_parts_is_not_that_of_one_part),
        cmocka_unit_test(a_belt_that_stops_is_a_jam),
        cmocka_unit_test(queue_states_and_jams_agree),
        cmocka_unit_test(a_run_ends_when_its_throughput_is_steady),
        cmocka_unit_test(stops_do_not_change_a_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
