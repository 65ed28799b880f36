// What a run says in sentences: which kinds, by figures that are made up, and what the sentences name.

#include "api/results/run_verdict.h"

#include "api/scenario/scenario.h"
#include "core/base/memory.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

// 1 m of belt, a plate whose lower end is 0.9 m from the west side, 2 parts/s = 7,200 parts/h for 100 s.
#define FED                                                                                        \
    "{'duration_s': 100, 'warmup_s': 10, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': "    \
    "{}, "                                                                                         \
    "'obstacles': [{'from_m': [0.6, 0], 'to_m': [0.9, 0.4]}], "                                    \
    "'feeds': [{'id': 'infeed', 'edge': 'west', 'rate_per_s': 2}]}"
// The same with an opening of 2 parts, and more offered than it passes.
#define NARROW                                                                                     \
    "{'duration_s': 100, 'warmup_s': 10, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': "    \
    "{}, "                                                                                         \
    "'obstacles': [{'from_m': [0.6, 0], 'to_m': [0.9, 0.55]}], "                                   \
    "'feeds': [{'id': 'infeed', 'edge': 'west', 'rate_per_s': 50}]}"
#define HEAP "{" DOCUMENT_NEEDED "}"

// A run that is told of, with the words of its verdicts.
typedef struct told {
    scene scene;
    advice advice;
    frame_end end;
    double values[FIGURE_COUNT + FIGURE_COUNT];
    verdicts verdicts;
} told;

static told *begin(const char *document, run_model model)
{
    bf_buffer text = document_resolve(document);
    told *t = memory_alloc(1, sizeof *t);

    assert_non_null(t);
    assert_int_equal(scenario_read_resolved(text.bytes, text.n, &t->scene, NULL), BF_OK);
    buffer_fini(&text);
    assert_int_equal(advice_of(&t->scene, model, &t->advice, NULL), BF_OK);
    assert_true(figure_values(&t->scene) <= sizeof t->values / sizeof *t->values);
    for (size_t k = 0; k < figure_values(&t->scene); k++)
        t->values[k] = (double)NAN;
    t->end = (frame_end){ .t = t->scene.duration, .parts_start = 1.0 };
    return t;
}

static void set(told *t, figure_id id, double value)
{
    t->values[figure_at(&t->scene, id, 0)] = value;
}

// The verdict of a kind, which must be there.
static const verdict *say(told *t, const char *kind)
{
    const run_verdict_subject of = {
        .scene = &t->scene, .advice = &t->advice, .end = &t->end, .values = t->values
    };

    t->verdicts.n = 0;
    assert_int_equal(run_verdict_find(&of, &t->verdicts, NULL), BF_OK);
    for (size_t k = 0; k < t->verdicts.n; k++)
        if (strcmp(t->verdicts.items[k].kind, kind) == 0)
            return &t->verdicts.items[k];
    fail_msg("no verdict of this kind");
    return &t->verdicts.items[0];
}

static void finish(told *t)
{
    scene_fini(&t->scene);
    memory_free(t);
}

static void feed(told *t, double through, double offered, double admitted)
{
    set(t, FIGURE_THROUGHPUT, through);
    set(t, FIGURE_OFFERED, offered);
    set(t, FIGURE_ADMITTED, admitted);
    set(t, FIGURE_RESIDENCE_MEAN, 3.0);
    set(t, FIGURE_QUEUE_END, 0.1);
}

static void everything_gets_through_up_to_what_chance_leaves_open(void **unused)
{
    told *t = begin(FED, RUN_MICRO);

    feed(t, 7100.0, 200.0, 199.0);
    set(t, FIGURE_THROUGHPUT_ERROR, 120.0);
    const verdict *v = say(t, "everything_through");
    assert_non_null(strstr(v->text, "7,100 ± 120 parts/h of 7,200 offered"));
    assert_string_equal(v->advice, "");
    assert_string_equal(v->figures[0].name, "throughput_per_h");
    assert_true(v->figures[0].value == 7100.0);
    assert_null(strstr(v->text, "warm-up"));
    set(t, FIGURE_THROUGHPUT, 7300.0); // 1.4 % more than 7,200
    assert_non_null(
        strstr(say(t, "everything_through")->text, "Some of it was offered during the warm-up."));
    set(t, FIGURE_THROUGHPUT, 7100.0);
    set(t, FIGURE_THROUGHPUT_ERROR, 1.0);
    v = say(t, "queue_grows");
    assert_non_null(strstr(v->text, "nothing waits"));
    finish(t);
}

// The warm-up is 10 s.
static void a_belt_fills_until_twice_as_long_as_parts_stay(void **unused)
{
    told *t = begin(FED, RUN_MICRO);

    feed(t, 7100.0, 200.0, 199.0);
    set(t, FIGURE_RESIDENCE_MEAN, 4.9);
    (void)say(t, "queue_grows");
    set(t, FIGURE_RESIDENCE_MEAN, 5.1);
    assert_string_equal(say(t, "belt_fills")->advice,
                        "Let warmup_s be at least 10.2, twice as long as parts stay.");
    finish(t);
}

// Of 7,200 parts/h that are offered 6,480 are 90 %: an interval that is wider does not make them all.
static void a_wide_interval_does_not_make_up_for_what_is_missing(void **unused)
{
    told *t = begin(FED, RUN_MICRO);

    feed(t, 6500.0, 200.0, 199.0);
    set(t, FIGURE_THROUGHPUT_ERROR, 2000.0);
    (void)say(t, "everything_through");
    set(t, FIGURE_THROUGHPUT, 6400.0);
    (void)say(t, "queue_grows");
    finish(t);
}

// The plate's end is 0.9 m from the inlet: a queue of 0.8 m comes up to it, one of 0.1 m does not.
static void parts_that_wait_are_held_by_the_queue_or_by_the_inlet(void **unused)
{
    told *t = begin(FED, RUN_MICRO);

    feed(t, 3600.0, 200.0, 120.0);
    const verdict *v = say(t, "inlet_limit");
    assert_non_null(strstr(v->text, "'infeed'"));
    set(t, FIGURE_QUEUE_END, 0.8);
    v = say(t, "queue_at_inlet");
    assert_non_null(strstr(v->text, "80 of 200 parts have not entered"));
    assert_non_null(strstr(v->text, v->advice));
    assert_string_equal(v->figures[2].of, "infeed");
    // 40 parts are missing behind the line, of which 6 wait before it: the others are on the belt.
    set(t, FIGURE_QUEUE_END, 0.1);
    set(t, FIGURE_THROUGHPUT, 7200.0 - 40.0 * 3600.0 / (t->end.t - t->scene.warmup));
    set(t, FIGURE_ADMITTED, 194.0);
    assert_non_null(strstr(say(t, "queue_grows")->text, "6 parts wait at the inlet"));
    set(t, FIGURE_ADMITTED, 198.0); // two parts find the place taken by others
    (void)say(t, "queue_grows");
    finish(t);
}

// A belt carries 2004 parts/m2 times 0.6 m times 0.395 m/s = 475 parts/s: 2 parts/s that wait are a queue.
// With a plate 0.4 m from the west side before the other one, which is 0.9 m from it.
static void the_queue_at_the_inlet_is_that_of_the_next_plate(void **unused)
{
    told *t = begin("{'duration_s': 100, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': {}, "
                    "'obstacles': [{'from_m': [0.6, 0], 'to_m': [0.9, 0.4]}, "
                    "{'from_m': [0.3, 0], 'to_m': [0.4, 0.4]}], "
                    "'feeds': [{'id': 'infeed', 'edge': 'west', 'rate_per_s': 2}]}",
                    RUN_MICRO);

    feed(t, 3600.0, 200.0, 100.0);
    set(t, FIGURE_QUEUE_END, 0.3);
    (void)say(t, "inlet_limit");
    set(t, FIGURE_QUEUE_END, 0.39);
    (void)say(t, "queue_at_inlet");
    finish(t);
}

static void a_density_has_a_queue_where_the_inlet_could_take_more(void **unused)
{
    told *t = begin(FED, RUN_MACRO);

    feed(t, 3600.0, 200.0, 120.0);
    set(t, FIGURE_QUEUE_END, (double)NAN);
    (void)say(t, "queue_at_inlet");
    finish(t);
}

static void a_heap_is_drained_or_not(void **unused)
{
    told *t = begin(HEAP, RUN_MICRO);

    set(t, FIGURE_DRAINED_AT, 0.75);
    const verdict *v = say(t, "drained");
    assert_non_null(strstr(v->text, "since 0.75 s"));
    set(t, FIGURE_DRAINED_AT, (double)NAN);
    t->end.parts_end = 1.0;
    v = say(t, "not_drained");
    assert_string_not_equal(v->advice, "");
    finish(t);
}

static void parts_bridge_where_they_stand_before_a_plate(void **unused)
{
    told *t = begin(FED, RUN_MICRO);

    feed(t, 7200.0, 200.0, 200.0);
    set(t, FIGURE_JAM_COUNT, 2.0);
    set(t, FIGURE_JAM_FIRST, 20.5);
    set(t, FIGURE_JAM_TOTAL, 12.0);
    set(t, FIGURE_STATE_BLOCKED, 0.001);
    (void)say(t, "pauses");
    set(t, FIGURE_STATE_BLOCKED, 0.3);
    const verdict *v = say(t, "bridges");
    assert_non_null(strstr(v->text, "for 12 s, 2 times, the first from 20.5 s"));
    finish(t);
}

static void plates_that_cargo_stops_are_told(void **unused)
{
    told *t = begin("{'duration_s': 100, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': {}, "
                    "'obstacles': [{'from_m': [0.6, 0], 'to_m': [0.9, 0.4]}, {'id': 'arm', "
                    "'from_m': [0.4, 0], 'to_m': [0.4, 0.2], 'motion': {'t_s': [0, 1], 'turn_deg': "
                    "[0, -45]}}], 'feeds': [{'id': 'infeed', 'edge': 'west', 'rate_per_s': 2}]}",
                    RUN_MICRO);

    feed(t, 7200.0, 200.0, 200.0);
    set(t, FIGURE_STALL_COUNT, 2.0);
    set(t, FIGURE_STALL_FIRST, 4.25);
    set(t, FIGURE_STALL_TOTAL, 1.5);
    const verdict *v = say(t, "stalled");
    assert_non_null(strstr(v->text, "'arm'"));
    assert_non_null(strstr(v->text, "2 times, the first at 4.25 s, for 1.5 s together"));
    assert_int_equal(v->n_figures, 3);
    finish(t);
}

static void a_density_tells_no_throughput_where_parts_bridge(void **unused)
{
    told *t = begin(NARROW, RUN_MACRO);

    feed(t, 90000.0, 5000.0, 2600.0);
    const verdict *v = say(t, "bridged");
    assert_ptr_equal(v, &t->verdicts.items[0]);
    assert_non_null(strstr(v->text, "Parts bridge this opening: "));
    assert_non_null(strstr(v->advice, "Solve it with the microscopic model"));
    for (size_t k = 0; k < t->verdicts.n; k++)
        assert_null(strstr(t->verdicts.items[k].text, "parts/h"));
    finish(t);
    t = begin(NARROW, RUN_MICRO);
    feed(t, 90000.0, 5000.0, 2600.0);
    assert_non_null(strstr(say(t, "inlet_limit")->text, "parts/h"));
    finish(t);
}

static void a_run_that_is_too_short_says_how_long_it_has_to_be(void **unused)
{
    told *t = begin(FED, RUN_MICRO);

    feed(t, 7200.0, 200.0, 200.0);
    set(t, FIGURE_THROUGHPUT_NEEDS, 655.2);
    // Places on the line are drawn, though arrivals are regular.
    assert_non_null(
        strstr(say(t, "too_short")->text, "What arrives when and where is left to chance"));
    assert_non_null(strstr(say(t, "too_short")->advice, "duration_s be about 655,"));
    t->advice.validity.is_compared = false;
    assert_ptr_equal(say(t, "not_compared"), &t->verdicts.items[2]);
    finish(t);
}

// Further verdicts than there is room for are dropped, and so are figures.
static void more_than_there_is_room_for_is_dropped(void **unused)
{
    verdicts *all = memory_alloc(1, sizeof *all);

    assert_non_null(all);
    for (size_t k = 0; k < VERDICTS_MAX + 3; k++) {
        verdict *v = verdict_add(all, "kind");
        for (size_t i = 0; i < VERDICT_FIGURES_MAX + 2; i++)
            verdict_rests_on(v, "figure", "", (double)i);
        verdict_rests_on(v, "figure", "", (double)NAN);
        assert_int_equal(v->n_figures, VERDICT_FIGURES_MAX);
        for (size_t i = 0; i < VERDICT_TEXT_SIZE; i++)
            verdict_advise(v, "ab");
        assert_int_equal(strlen(v->text), VERDICT_TEXT_SIZE - 1);
        assert_int_equal(strlen(v->advice), VERDICT_ADVICE_SIZE - 1);
    }
    assert_int_equal(all->n, VERDICTS_MAX);
    memory_free(all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_gets_through_up_to_what_chance_leaves_open),
        cmocka_unit_test(a_belt_fills_until_twice_as_long_as_parts_stay),
        cmocka_unit_test(a_wide_interval_does_not_make_up_for_what_is_missing),
        cmocka_unit_test(parts_that_wait_are_held_by_the_queue_or_by_the_inlet),
        cmocka_unit_test(the_queue_at_the_inlet_is_that_of_the_next_plate),
        cmocka_unit_test(a_density_has_a_queue_where_the_inlet_could_take_more),
        cmocka_unit_test(a_heap_is_drained_or_not),
        cmocka_unit_test(parts_bridge_where_they_stand_before_a_plate),
        cmocka_unit_test(plates_that_cargo_stops_are_told),
        cmocka_unit_test(a_density_tells_no_throughput_where_parts_bridge),
        cmocka_unit_test(a_run_that_is_too_short_says_how_long_it_has_to_be),
        cmocka_unit_test(more_than_there_is_room_for_is_dropped),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
