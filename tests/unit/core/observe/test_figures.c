// Unit tests of the key figures: each by hand.

#include "core/observe/figures.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

enum { VALUES_MAX = 64 };

// A belt of 1 m x 0.6 m along +x with two counters, a feed or none, and a photo eye.
typedef struct fixture {
    scene s;
    figures *f;
    double values[VALUES_MAX];
} fixture;

static void begin_with(fixture *x, double warmup, bool has_parts, size_t n_feeds)
{
    static const scene_pose pose = { 0.5, 0.3, 0.0 };

    helper_scene_belt(&x->s, 1.0, 0.6, 0.005, &pose, 1);
    x->s.warmup = warmup;
    x->s.jam_time = 5.0;
    x->s.n_feeds = n_feeds;
    x->s.feeds = memory_alloc(n_feeds, sizeof *x->s.feeds);
    x->s.n_eyes = 1;
    x->s.eyes = memory_alloc(1, sizeof *x->s.eyes);
    x->s.n_counters = 2;
    x->s.counters = memory_alloc(2, sizeof *x->s.counters);
    x->s.counters[0].rect = (scene_rect){ 0.0, 1.0, 0.0, 0.6 };
    x->s.counters[1].rect = (scene_rect){ 0.0, 0.5, 0.0, 0.6 };
    helper_scene_resolve(&x->s);
    assert_int_equal(figures_create(&x->s, has_parts, &x->f, NULL), BF_OK);
}

static void begin(fixture *x, double warmup, bool has_parts)
{
    begin_with(x, warmup, has_parts, 1);
}

static void end(fixture *x)
{
    figures_destroy(x->f);
    scene_fini(&x->s);
}

static double value(fixture *x, figure_id id, size_t item)
{
    assert_true(figure_values(&x->s) <= VALUES_MAX);
    figures_fill(x->f, x->values);
    return x->values[figure_at(&x->s, id, item)];
}

static void sample_feed(fixture *x, double t, double inside, double exited, feed_balance balance)
{
    const double counters[] = { inside, 0.5 * inside };
    const figures_now now = { .t = t,
                              .inside = inside,
                              .entered = inside + exited,
                              .exited = exited,
                              .counters = counters,
                              .flows = (const double[]){ exited, 0.5 * exited },
                              .feeds = &balance };

    figures_sample(x->f, &now);
}

static void sample(fixture *x, double t, double inside, double exited)
{
    sample_feed(x, t, inside, exited, (feed_balance){ .offered = 0.0 });
}

// Every value but those that a run without events has is absent.
static void what_is_not_known_is_absent(void **state)
{
    fixture x;
    begin(&x, 10.0, true);
    sample(&x, 0.0, 3.0, 0.0);
    figures_fill(x.f, x.values);
    for (figure_id id = 0; id < FIGURE_STOPPED_COUNT; id++)
        assert_true(isnan(x.values[figure_at(&x.s, id, 0)]) ==
                    (id != FIGURE_OFFERED && id != FIGURE_ADMITTED && id != FIGURE_DISCARDED &&
                     id != FIGURE_ENTERED && id != FIGURE_LEFT));
    end(&x);
}

// 4 parts leave in the 2 s before the warm-up ends, 6 in the 3 s after it: 2 parts/s.
static void throughput_leaves_out_the_warm_up(void **state)
{
    fixture x;
    begin(&x, 2.0, true);
    sample(&x, 0.0, 10.0, 0.0);
    sample(&x, 2.0, 6.0, 4.0);
    sample(&x, 4.0, 1.0, 9.0);
    sample(&x, 5.0, 0.0, 10.0);
    assert_near(value(&x, FIGURE_THROUGHPUT, 0), 7200.0, 1e-9);
    assert_near(value(&x, FIGURE_DRAINED_AT, 0), 5.0, 0.0);
    end(&x);
}

// Of 20 parts none leaves for 2 s, one leaves each second until 12 s, and one until 22 s. Of the 11 that left, 10 % have at
// 3.1 s and 90 % at 11.9 s. After a warm-up of 4 s 9 leave, of which 10 % have at 4.9 s and 90 % at 13 s.
static void throughput_without_feeds_is_that_of_the_middle_of_the_parts(void **state)
{
    for (int has_warmup = 0; has_warmup < 2; has_warmup++) {
        fixture x;
        begin_with(&x, has_warmup ? 4.0 : 0.0, true, 0);
        for (int t = 0; t <= 22; t++) {
            const double left = t < 2 ? 0.0 : t < 12 ? t - 2.0 : 10.0 + 0.1 * (t - 12.0);
            sample(&x, t, 20.0 - left, 0.5 * left);
        }
        const double t10 = has_warmup ? 4.9 : 3.1, t90 = has_warmup ? 13.0 : 11.9;
        const double parts = has_warmup ? 7.2 : 8.8;
        assert_near(value(&x, FIGURE_SUSTAINED, 0), 3600.0 * parts / (t90 - t10), 1e-9);
        end(&x);
    }
}

static void throughput_with_feeds_is_sustained(void **state)
{
    fixture x;
    begin(&x, 1.0, false);
    sample(&x, 0.0, 3.0, 0.0);
    sample(&x, 1.0, 3.0, 2.0);
    sample(&x, 5.0, 3.0, 9.0);
    assert_near(value(&x, FIGURE_SUSTAINED, 0), value(&x, FIGURE_THROUGHPUT, 0), 0.0);
    end(&x);
}

static void where_nothing_passes_throughput_is_0(void **state)
{
    fixture x;
    begin_with(&x, 0.0, true, 0);
    sample(&x, 0.0, 3.0, 0.0);
    assert_true(isnan(value(&x, FIGURE_SUSTAINED, 0)));
    sample(&x, 1.0, 3.0, 0.0);
    assert_near(value(&x, FIGURE_SUSTAINED, 0), 0.0, 0.0);
    assert_near(value(&x, FIGURE_THROUGHPUT, 0), 0.0, 0.0);
    end(&x);
}

// 3 parts at the start, of which 2 leave while 5 enter; the warm-up of 10 s does not matter.
static void parts_are_counted_from_the_start(void **state)
{
    fixture x;
    begin(&x, 10.0, false);
    sample(&x, 0.0, 3.0, 0.0);
    sample(&x, 1.0, 6.0, 2.0);
    assert_near(value(&x, FIGURE_ENTERED, 0), 8.0, 0.0);
    assert_near(value(&x, FIGURE_LEFT, 0), 2.0, 0.0);
    end(&x);
}

// 1 part leaves in each of 20 s: the error is 0, and the throughput steady at 20 s.
static void a_constant_throughput_is_steady_after_32_batches(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    for (int k = 0; k <= 20; k++)
        sample(&x, k, 20.0, k);
    assert_true(figures_is_steady(x.f));
    assert_near(value(&x, FIGURE_STEADY_AT, 0), 8.0, 0.0);
    assert_true(isnan(value(&x, FIGURE_THROUGHPUT_ERROR, 0)));
    end(&x);
}

// After the warm-up leave parts of 1, 2, 3 and 10 s; one before it does not count.
static void residence_is_that_of_each_part_that_left(void **state)
{
    fixture x;
    begin(&x, 1.0, true);
    sample(&x, 0.0, 5.0, 0.0);
    figures_exit(x.f, 100.0, 1.0);
    sample(&x, 1.0, 4.0, 1.0);
    figures_exit(x.f, 1.0, 1.0);
    figures_exit(x.f, 2.0, 1.0);
    figures_exit(x.f, 3.0, 1.0);
    figures_exit(x.f, 10.0, 1.0);
    assert_near(value(&x, FIGURE_RESIDENCE_MEAN, 0), 4.0, 1e-14);
    assert_near(value(&x, FIGURE_RESIDENCE_P50, 0), 2.0, 2.0 / 256.0);
    assert_near(value(&x, FIGURE_RESIDENCE_P90, 0), 10.0, 10.0 / 256.0);
    assert_near(value(&x, FIGURE_RESIDENCE_P95, 0), 10.0, 10.0 / 256.0);
    assert_near(value(&x, FIGURE_RESIDENCE_P99, 0), 10.0, 10.0 / 256.0);
    end(&x);
}

// At the end of the warm-up one part has been inside for 4 s. After it parts of 1, 3 and 5 s leave, the last one being that one,
// and two of 2 and 4 s are inside still: of 4 parts that came later S falls to 3/4 at 1 s and, one of 2 being left, to 3/8 at
// 3 s; at 5 s, where the first one is the only one, to 0. The mean is 1 + 2 3/4 + 2 3/8.
static void parts_that_are_inside_stay_longer_than_their_age(void **state)
{
    static const figures_cargo at_first[] = { { { 0.1, 0.3 }, 0.4, 0.4, 1.0, 4.0 } };
    static const figures_cargo at_last[] = { { { 0.1, 0.3 }, 0.4, 0.4, 1.0, 2.0 },
                                             { { 0.2, 0.3 }, 0.4, 0.4, 1.0, 4.0 } };
    fixture x;
    begin(&x, 1.0, true);
    sample(&x, 0.0, 1.0, 0.0);
    figures_add_cargo(x.f, &at_first[0], NULL);
    sample(&x, 1.0, 1.0, 0.0);
    figures_exit(x.f, 1.0, 1.0);
    figures_exit(x.f, 3.0, 1.0);
    figures_exit(x.f, 5.0, 1.0);
    figures_add_cargo(x.f, &at_last[0], NULL);
    figures_add_cargo(x.f, &at_last[1], NULL);
    sample(&x, 6.0, 2.0, 3.0);
    assert_near(value(&x, FIGURE_RESIDENCE_MEAN, 0), 3.25, 0.02);
    assert_near(value(&x, FIGURE_RESIDENCE_P50, 0), 3.0, 3.0 / 256.0);
    assert_near(value(&x, FIGURE_RESIDENCE_P90, 0), 5.0, 5.0 / 256.0);
    // Nothing is known of when 90 % will have left where more than a tenth are inside for longer than all that left.
    for (size_t k = 0; k < 4; k++)
        figures_add_cargo(x.f, &(figures_cargo){ { 0.1, 0.3 }, 0.4, 0.4, 1.0, 5.5 }, NULL);
    sample(&x, 7.0, 4.0, 3.0);
    assert_true(isnan(value(&x, FIGURE_RESIDENCE_P90, 0)));
    end(&x);
}

// 10 parts of the start leave evenly from 1 s to 3 s: uniform from 1 s to 3 s.
static void residence_of_a_density_is_the_distance_of_the_curves(void **state)
{
    fixture x;
    begin_with(&x, 0.0, false, 0);
    sample(&x, 0.0, 10.0, 0.0);
    sample(&x, 1.0, 10.0, 0.0);
    sample(&x, 3.0, 0.0, 10.0);
    assert_near(value(&x, FIGURE_RESIDENCE_MEAN, 0), 2.0, 1e-12);
    assert_near(value(&x, FIGURE_RESIDENCE_P90, 0), 2.8, 1e-9);
    end(&x);
}

// Halves of parts leave after 1 s and after 3 s. Once all have left that were seen there is no age; a tenth of a part
// says nothing of residence.
static void residence_of_a_density_that_is_fed_is_what_exits_tell(void **state)
{
    fixture x;
    begin(&x, 0.0, false);
    sample(&x, 0.0, 0.0, 0.0);
    figures_exit(x.f, 1.0, 0.1);
    assert_true(isnan(value(&x, FIGURE_RESIDENCE_MEAN, 0)));
    figures_exit(x.f, 1.0, 0.4);
    figures_exit(x.f, 3.0, 0.5);
    sample(&x, 4.0, 0.0, 1.0);
    assert_near(value(&x, FIGURE_RESIDENCE_MEAN, 0), 2.0, 1e-14);
    assert_near(value(&x, FIGURE_RESIDENCE_P90, 0), 3.0, 3.0 / 256.0);
    // What is inside, half a part for 5 s, stays longer than all of them.
    figures_forget_ages(x.f);
    figures_add_age(x.f, 5.0, 0.5);
    assert_true(value(&x, FIGURE_RESIDENCE_MEAN, 0) > 2.9);
    assert_near(value(&x, FIGURE_RESIDENCE_P50, 0), 3.0, 3.0 / 256.0);
    assert_true(isnan(value(&x, FIGURE_RESIDENCE_P99, 0)));
    end(&x);
}

// 233640 parts/h by sums and products of doubles.
static void figures_have_the_digits_that_they_have(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    sample(&x, 0.0, 649.0, 0.0);
    sample(&x, 10.0 + 1e-15 * 3.0, 0.0, 649.0 * (1.0 + 2e-16));
    assert_true(value(&x, FIGURE_THROUGHPUT, 0) == 233640.0);
    end(&x);
    // What left is a difference of sums that are 649.
    begin(&x, 0.0, false);
    sample(&x, 0.0, 649.0, 0.0);
    sample(&x, 3600.0, 649.0, 649.0 * 2e-16);
    assert_true(value(&x, FIGURE_THROUGHPUT, 0) == 0.0);
    end(&x);
}

// Exits at 1 s and at 9 s with cargo inside: from 1 s to 9 s nothing leaves, 8 s >= 5 s. Then 4 s without an exit are none.
static void a_jam_is_a_long_time_without_an_exit(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    sample(&x, 0.0, 10.0, 0.0);
    for (int t = 1; t <= 8; t++)
        sample(&x, t, 9.0, 1.0);
    assert_near(value(&x, FIGURE_JAM_COUNT, 0), 1.0, 0.0);
    assert_near(value(&x, FIGURE_JAM_TOTAL, 0), 7.0, 0.0); // it goes on
    sample(&x, 9.0, 8.0, 2.0);
    for (int t = 10; t <= 13; t++)
        sample(&x, t, 8.0, 2.0);
    assert_near(value(&x, FIGURE_JAM_COUNT, 0), 1.0, 0.0);
    assert_near(value(&x, FIGURE_JAM_FIRST, 0), 1.0, 0.0);
    assert_near(value(&x, FIGURE_JAM_TOTAL, 0), 8.0, 0.0);
    end(&x);
}

// A density loses a tenth of a part a second: a part has left every 10 s, so a jam of 5 s begins at once.
static void less_than_a_part_is_no_exit(void **state)
{
    fixture x;
    begin(&x, 0.0, false);
    for (int t = 0; t <= 9; t++)
        sample(&x, t, 5.0 - 0.1 * t, 0.1 * t);
    assert_near(value(&x, FIGURE_JAM_COUNT, 0), 1.0, 0.0);
    sample(&x, 10.0, 4.0, 1.0);
    assert_near(value(&x, FIGURE_JAM_TOTAL, 0), 10.0, 0.0);
    end(&x);
}

// A part a minute crosses in 20 s: nothing leaves for 40 s, and nothing is queued. Then one stands at the end from 80 s to 100 s.
static void where_nothing_is_queued_there_is_no_jam_and_no_queue(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    for (int t = 0; t <= 120; t++) {
        const bool is_inside = t % 60 < 20 || (t >= 80 && t < 100);
        const bool is_held = t >= 80 && t < 100;
        const figures_cargo one = {
            { is_held ? 0.99 : 0.05 * (t % 60), 0.3 }, is_held ? 0.0 : 0.05, 0.05, 1.0, 0.0
        };
        if (is_inside)
            figures_add_cargo(x.f, &one, NULL);
        sample(&x, t, is_inside, t < 20 ? 0.0 : t < 100 ? 1.0 : 2.0);
        if (t == 79) {
            assert_near(value(&x, FIGURE_JAM_COUNT, 0), 0.0, 0.0);
            assert_near(value(&x, FIGURE_QUEUE_END, 0), 0.0, 0.0);
            assert_near(value(&x, FIGURE_STATE_FREE, 0), 1.0, 0.0);
        }
    }
    assert_near(value(&x, FIGURE_JAM_COUNT, 0), 1.0, 0.0);
    assert_near(value(&x, FIGURE_JAM_TOTAL, 0), 21.0, 0.0); // from the sample at 79 s
    assert_near(value(&x, FIGURE_QUEUE_END, 0), 0.024, 1e-12);
    assert_true(value(&x, FIGURE_STATE_BLOCKED, 0) > 0.0);
    end(&x);
}

// 100 parts of a density are queued evenly from x = 0.5 to 0.9, where a plate ends, and 0.4 parts more from 0 to 0.5: these are its
// thin end. With 0.4 parts alone, 5 % of them at the far end, 0.025 m, are.
static void thin_ends_of_a_density_are_not_its_queue(void **state)
{
    static const vec2 plate[] = { { 0.9, 0.0 }, { 0.9, 0.5 } };

    for (int is_thin = 0; is_thin < 2; is_thin++) {
        fixture x;
        begin(&x, 0.0, false);
        figures_destroy(x.f);
        helper_scene_add_obstacle(&x.s, plate, 2, SCENE_SEALED);
        assert_int_equal(figures_create(&x.s, false, &x.f, NULL), BF_OK);
        for (int k = 0; k < 500; k++)
            figures_add_cargo(x.f, &(figures_cargo){ { 1e-3 * k, 0.3 }, 0.0, 0.4, 0.4 / 500, 0.0 },
                              NULL);
        for (int k = 0; k < 400 && !is_thin; k++)
            figures_add_cargo(
                x.f, &(figures_cargo){ { 0.5 + 0.001 * k, 0.3 }, 0.0, 0.4, 0.25, 0.0 }, NULL);
        sample(&x, 0.0, 100.0, 0.0);
        assert_near(value(&x, FIGURE_QUEUE_END, 0), is_thin ? 0.875 : 0.4, 1.0 / 256.0);
        end(&x);
    }
}

static void an_empty_belt_is_no_jam(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    for (int t = 0; t <= 20; t++)
        sample(&x, t, 0.0, 0.0);
    assert_near(value(&x, FIGURE_JAM_COUNT, 0), 0.0, 0.0);
    assert_true(isnan(value(&x, FIGURE_JAM_FIRST, 0)));
    assert_near(value(&x, FIGURE_JAM_TOTAL, 0), 0.0, 0.0);
    end(&x);
}

// 0 to 8 parts in 2 s, then 8 for 1 s: a mean of (8 + 8)/3; the second counter has half of it.
static void content_is_a_mean_over_time(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    sample(&x, 0.0, 0.0, 0.0);
    sample(&x, 2.0, 8.0, 0.0);
    sample(&x, 3.0, 8.0, 0.0);
    assert_near(value(&x, FIGURE_CONTENT_MEAN, 0), 5.33333333333, 1e-14); // 16/3, 12 digits
    assert_near(value(&x, FIGURE_CONTENT_MAX, 0), 8.0, 0.0);
    assert_near(value(&x, FIGURE_CONTENT_MEAN, 1), 2.66666666667, 1e-14);
    assert_near(value(&x, FIGURE_CONTENT_MAX, 1), 4.0, 0.0);
    end(&x);
}

// Four parts at rest in time: one free and one queued in both counters, one blocked in the first alone, one on a belt that
// stands, which is blocked too.
static void states_go_by_the_speed_of_the_belt(void **state)
{
    static const figures_cargo cargo[] = { { { 0.1, 0.3 }, 0.33, 0.4, 1.0, 0.0 },
                                           { { 0.2, 0.3 }, 0.31, 0.4, 1.0, 0.0 },
                                           { { 0.7, 0.3 }, 0.019, 0.4, 1.0, 0.0 },
                                           { { 0.8, 0.3 }, 0.01, 0.0, 1.0, 0.0 } };
    fixture x;
    begin(&x, 0.0, true);
    for (int t = 0; t < 2; t++) {
        for (size_t k = 0; k < sizeof cargo / sizeof *cargo; k++)
            figures_add_cargo(x.f, &cargo[k], NULL);
        sample(&x, t, 4.0, 0.0);
    }
    assert_near(value(&x, FIGURE_STATE_FREE, 0), 0.25, 1e-15);
    assert_near(value(&x, FIGURE_STATE_QUEUED, 0), 0.25, 1e-15);
    assert_near(value(&x, FIGURE_STATE_BLOCKED, 0), 0.5, 1e-15);
    assert_near(value(&x, FIGURE_STATE_FREE, 1), 0.5, 1e-15);
    assert_near(value(&x, FIGURE_STATE_QUEUED, 1), 0.5, 1e-15);
    assert_near(value(&x, FIGURE_STATE_BLOCKED, 1), 0.0, 0.0);
    // Without a plate from x = 0.2 to 0.8 and a part's width.
    assert_near(value(&x, FIGURE_QUEUE_END, 0), 0.624, 1e-12);
    end(&x);
}

// A rail along the belt at y = 0.1 guides; the plate from (0.9, 0.1) to (0.7, 0.5) ends at x = 0.9, a gate stands
// at x = 0.3. A slow part at x = 0.45 is 0.45 m upstream of the plate's end, one at 0.25 is 0.05 m before the gate; a
// fast one at 0.1 does not count, and a slow one behind both is a queue of its own width.
static void a_queue_reaches_from_the_next_plate_to_its_last_slow_part(void **state)
{
    static const vec2 rail[] = { { 0.0, 0.1 }, { 1.0, 0.1 } },
                      plate[] = { { 0.9, 0.1 }, { 0.7, 0.5 } },
                      gate[] = { { 0.3, 0.1 }, { 0.3, 0.5 } };
    static const figures_cargo cargo[] = { { { 0.45, 0.3 }, 0.2, 0.4, 1.0, 0.0 },
                                           { { 0.25, 0.3 }, 0.2, 0.4, 1.0, 0.0 },
                                           { { 0.1, 0.3 }, 0.4, 0.4, 1.0, 0.0 },
                                           { { 0.95, 0.3 }, 0.0, 0.4, 1.0, 0.0 } };
    fixture x;
    begin(&x, 0.0, true);
    figures_destroy(x.f);
    helper_scene_add_obstacle(&x.s, rail, 2, SCENE_SEALED);
    helper_scene_add_obstacle(&x.s, plate, 2, SCENE_SEALED);
    helper_scene_add_obstacle(&x.s, gate, 2, SCENE_SEALED);
    assert_int_equal(figures_create(&x.s, true, &x.f, NULL), BF_OK);
    sample(&x, 0.0, 3.0, 0.0);
    assert_true(isnan(value(&x, FIGURE_QUEUE_END, 0))); // of cargo nothing was said
    for (size_t k = 0; k < sizeof cargo / sizeof *cargo; k++)
        figures_add_cargo(x.f, &cargo[k], NULL);
    sample(&x, 1.0, 3.0, 0.0);
    sample(&x, 2.0, 3.0, 0.0); // the queue has gone; the largest counts
    assert_near(value(&x, FIGURE_QUEUE_END, 0), 0.45, 1e-12);
    end(&x);
}

static void the_peak_leaves_out_the_warm_up(void **state)
{
    fixture x;
    begin(&x, 1.0, false);
    sample(&x, 0.0, 1.0, 0.0);
    figures_peak(x.f, 3.0);
    assert_true(isnan(value(&x, FIGURE_PEAK, 0)));
    sample(&x, 1.0, 1.0, 0.0);
    figures_peak(x.f, 1.25);
    figures_peak(x.f, 0.5);
    assert_near(value(&x, FIGURE_PEAK, 0), 1.25, 0.0);
    end(&x);
}

// Empty at 2 s, but a part waits; then one is inside again; empty for good from 5 s on.
static void drained_is_since_when_the_belt_is_empty(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    sample(&x, 0.0, 1.0, 0.0);
    sample_feed(&x, 2.0, 0.0, 1.0, (feed_balance){ .offered = 1.0, .waiting = 1.0 });
    assert_true(isnan(value(&x, FIGURE_DRAINED_AT, 0)));
    sample_feed(&x, 3.0, 1.0, 1.0, (feed_balance){ .offered = 1.0, .admitted = 1.0 });
    sample_feed(&x, 5.0, 0.0, 2.0, (feed_balance){ .offered = 1.0, .admitted = 1.0 });
    sample_feed(&x, 6.0, 0.0, 2.0, (feed_balance){ .offered = 1.0, .admitted = 1.0 });
    assert_near(value(&x, FIGURE_DRAINED_AT, 0), 5.0, 0.0);
    end(&x);
}

// The feed begins after 2 s.
static void a_belt_that_nothing_has_entered_is_not_drained(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    sample(&x, 0.0, 0.0, 0.0);
    assert_true(isnan(value(&x, FIGURE_DRAINED_AT, 0)));
    sample(&x, 3.0, 1.0, 0.0);
    sample(&x, 5.0, 0.0, 1.0);
    assert_near(value(&x, FIGURE_DRAINED_AT, 0), 5.0, 0.0);
    end(&x);
}

static void a_feed_has_its_balance_and_the_waits_of_its_parts(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    sample(&x, 0.0, 0.0, 0.0);
    figures_wait(x.f, 0, 0.0);
    figures_wait(x.f, 0, 2.0);
    sample_feed(&x, 1.0, 2.0, 0.0, (feed_balance){ 9.0, 2.0, 6.0, 1.0 });
    sample_feed(&x, 2.0, 2.0, 0.0, (feed_balance){ 9.0, 2.0, 3.0, 4.0 });
    assert_near(value(&x, FIGURE_OFFERED, 0), 9.0, 0.0);
    assert_near(value(&x, FIGURE_ADMITTED, 0), 2.0, 0.0);
    assert_near(value(&x, FIGURE_DISCARDED, 0), 4.0, 0.0);
    assert_near(value(&x, FIGURE_WAITING_MAX, 0), 6.0, 0.0);
    assert_near(value(&x, FIGURE_WAIT_MEAN, 0), 1.0, 0.0);
    assert_near(value(&x, FIGURE_WAIT_P95, 0), 2.0, 2.0 / 256.0);
    end(&x);
}

// 4 parts are offered in the first second. At 3 s one is dropped; from 3 s to 4 s three enter: the levels 1 to 4, due
// at u/4, enter at 3 + (u - 1)/3. Waits from 2.75 s to 3 s, uniformly.
static void waits_of_a_density_leave_out_what_is_dropped(void **state)
{
    fixture x;
    begin(&x, 0.0, false);
    sample(&x, 0.0, 0.0, 0.0);
    sample_feed(&x, 1.0, 0.0, 0.0, (feed_balance){ 4.0, 0.0, 4.0, 0.0 });
    sample_feed(&x, 3.0, 0.0, 0.0, (feed_balance){ 4.0, 0.0, 3.0, 1.0 });
    sample_feed(&x, 4.0, 3.0, 0.0, (feed_balance){ 4.0, 3.0, 0.0, 1.0 });
    assert_near(value(&x, FIGURE_WAIT_MEAN, 0), 2.875, 1e-12);
    assert_near(value(&x, FIGURE_WAIT_P95, 0), 2.75 + 0.95 * 0.25, 1e-12);
    end(&x);
}

// Interruptions in metres that the belt has moved: 0..0.1, 0.15..0.25, then 0.3..0.4 and 0.35..0.45 together, then
// 0.65..0.75. Gaps 0.05, 0.05 and 0.2 m; two of five parts are doubles.
static void an_eye_sees_gaps_and_doubles(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    sample(&x, 0.0, 0.0, 0.0);
    figures_eye_begin(x.f, 0, 0.0);
    figures_eye_end(x.f, 0, 0.1);
    figures_eye_begin(x.f, 0, 0.15);
    figures_eye_end(x.f, 0, 0.25);
    figures_eye_begin(x.f, 0, 0.3);
    figures_eye_begin(x.f, 0, 0.35);
    figures_eye_end(x.f, 0, 0.4);
    figures_eye_end(x.f, 0, 0.45);
    figures_eye_begin(x.f, 0, 0.65);
    figures_eye_end(x.f, 0, 0.75);
    assert_near(value(&x, FIGURE_GAP_MIN, 0), 0.05, 1e-15);
    assert_near(value(&x, FIGURE_GAP_P05, 0), 0.05, 0.05 / 256.0);
    assert_near(value(&x, FIGURE_GAP_MEAN, 0), 0.1, 1e-15);
    assert_near(value(&x, FIGURE_DOUBLES, 0), 0.4, 1e-15);
    end(&x);
}

// Three parts of which each overlaps with the next one are three doubles.
static void a_chain_of_parts_is_all_doubles(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    sample(&x, 0.0, 0.0, 0.0);
    figures_eye_begin(x.f, 0, 0.0);
    figures_eye_begin(x.f, 0, 0.05);
    figures_eye_end(x.f, 0, 0.1);
    figures_eye_begin(x.f, 0, 0.12);
    figures_eye_end(x.f, 0, 0.15);
    figures_eye_end(x.f, 0, 0.22);
    assert_near(value(&x, FIGURE_DOUBLES, 0), 1.0, 0.0);
    assert_true(isnan(value(&x, FIGURE_GAP_MEAN, 0)));
    end(&x);
}

// Blocked from 0.5 s to 2 s, of which 1 s is after the warm-up, from 3 s to 3.5 s, and from 4 s on.
static void an_eye_is_blocked_for_some_time_after_the_warm_up(void **state)
{
    fixture x;
    begin(&x, 1.0, true);
    figures_eye_state(x.f, 0, 0.5, true);
    sample(&x, 1.0, 1.0, 0.0);
    figures_eye_state(x.f, 0, 2.0, false);
    figures_eye_state(x.f, 0, 3.0, true);
    figures_eye_state(x.f, 0, 3.5, false);
    figures_eye_state(x.f, 0, 4.0, true);
    sample(&x, 6.0, 1.0, 0.0);
    assert_near(value(&x, FIGURE_BLOCKED_COUNT, 0), 3.0, 0.0);
    assert_near(value(&x, FIGURE_BLOCKED_TOTAL, 0), 3.5, 1e-14);
    assert_near(value(&x, FIGURE_BLOCKED_LONGEST, 0), 2.0, 1e-14);
    end(&x);
}

// Some samples and events of a run.
static void go_on(fixture *x, bool has_parts, int first, int last)
{
    for (int k = first; k < last; k++) {
        const figures_cargo cargo = { { 0.02 * k, 0.3 }, 0.01 * k, 0.4, 1.0, 0.0 };
        figures_add_cargo(x->f, &cargo, NULL);
        if (has_parts && x->s.n_feeds > 0) {
            figures_exit(x->f, 0.3 * k + 0.1, 1.0);
            figures_wait(x->f, 0, 0.01 * k);
        }
        if (has_parts) {
            figures_eye_begin(x->f, 0, 0.1 * k);
            figures_eye_end(x->f, 0, 0.1 * k + 0.03);
        }
        sample_feed(x, 0.7 * k, 20.0 + k % 5, k / 3.0,
                    (feed_balance){ 2.0 * k, 1.5 * k, 0.25 * k, 0.25 * k });
        figures_peak(x->f, 0.01 * k);
    }
}

static void take_over(const fixture *from, fixture *to)
{
    bf_buffer bytes = { 0 };
    checkpoint_writer w;
    checkpoint_reader r;

    checkpoint_begin(&w, &bytes, CHECKPOINT_RUN, 1);
    figures_save(from->f, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, bytes.bytes, bytes.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
    const checkpoint_reader payload = r;
    for (size_t n = 0; n < payload.n_left; n += 61) {
        r = (checkpoint_reader){ payload.at, n };
        assert_false(figures_load(to->f, &r));
    }
    r = payload;
    assert_true(figures_load(to->f, &r));
    assert_int_equal(r.n_left, 0);
    buffer_fini(&bytes);
}

static void a_checkpoint_goes_on_with_the_same_bits_in_both_models(void **state)
{
    for (size_t kind = 0; kind < 4; kind++) {
        const bool has_parts = kind % 2 == 1;
        const size_t n_feeds = kind / 2;
        fixture whole, before, after;
        begin_with(&whole, 5.0, has_parts, n_feeds);
        begin_with(&before, 5.0, has_parts, n_feeds);
        begin_with(&after, 5.0, has_parts, n_feeds);
        go_on(&whole, has_parts, 0, 40);
        go_on(&before, has_parts, 0, 17);
        take_over(&before, &after);
        go_on(&after, has_parts, 17, 40);
        figures_fill(whole.f, whole.values);
        figures_fill(after.f, after.values);
        assert_memory_equal(whole.values, after.values,
                            figure_values(&whole.s) * sizeof *whole.values);
        end(&whole);
        end(&before);
        end(&after);
    }
}

// The belt stands from 2 to 3 s, from 5 to 7 s and from 9 s on; the warm-up ends at 6 s. The second run is saved in the
// second stop.
static void stops_of_a_commanded_belt_are_those_of_its_curve(void **state)
{
    static double times[] = { 2.0, 3.0, 5.0, 7.0, 9.0 }, factors[] = { 0.0, 1.0, 0.0, 1.0, 0.0 };
    for (int is_saved = 0; is_saved < 2; is_saved++) {
        fixture x, other;
        belt_speeds speeds;
        begin_with(&x, 6.0, true, 0);
        begin_with(&other, 6.0, true, 0);
        assert_int_equal(figure_items(&x.s, FIGURE_OF_BELT), 0);
        figures_destroy(x.f);
        figures_destroy(other.f);
        helper_scene_schedule(&x.s.belts[0], 5, times, factors);
        helper_scene_schedule(&other.s.belts[0], 5, times, factors);
        assert_int_equal(figures_create(&x.s, true, &x.f, NULL), BF_OK);
        assert_int_equal(figures_create(&other.s, true, &other.f, NULL), BF_OK);
        assert_int_equal(belt_speeds_init(&speeds, x.s.n_belts, x.s.belts, NULL), BF_OK);
        assert_string_equal(figure_item_id(&x.s, FIGURE_OF_BELT, 0), x.s.belts[0].id);
        for (int t = 0; t <= 12; t++) {
            fixture *of = is_saved && t > 6 ? &other : &x;
            figures_belts(of->f, &speeds, t > 0 ? t - 0.3 : 0.0);
            figures_belts(of->f, &speeds, t);
            sample(of, t, 0.0, 0.0);
            if (t == 6 && is_saved)
                take_over(&x, &other);
        }
        fixture *last = is_saved ? &other : &x;
        assert_true(value(last, FIGURE_STOPPED_COUNT, 0) == 2.0);
        assert_true(value(last, FIGURE_STOPPED_TOTAL, 0) == 4.0);
        assert_true(value(last, FIGURE_STOPPED_LONGEST, 0) == 3.0);
        belt_speeds_fini(&speeds);
        end(&x);
        end(&other);
    }
}

static void the_values_of_items_follow_each_other(void **state)
{
    fixture x;
    begin(&x, 0.0, true);
    size_t n = 0;
    for (figure_scope scope = 0; scope < FIGURE_SCOPES; scope++)
        for (size_t item = 0; item < figure_items(&x.s, scope); item++)
            for (figure_id id = figure_first(scope); id < figure_first(scope + 1); id++)
                assert_int_equal(figure_at(&x.s, id, item), n++);
    assert_int_equal(n, figure_values(&x.s));
    end(&x);
}

// The JSON object of a word is written at once, so its members must be neighbours; and every word has a definition.
static void the_table_is_sorted_by_scope_and_word(void **state)
{
    for (figure_id id = 0; id < FIGURE_COUNT; id++) {
        const figure *f = &figure_table[id];
        assert_true(strlen(f->definition) > 8 && f->models != 0);
        assert_true(id >= figure_first(f->scope) && id < figure_first(f->scope + 1));
        for (figure_id before = figure_first(f->scope); before < id; before++) {
            const bool is_same = strcmp(figure_table[before].word, f->word) == 0;
            assert_true(!is_same || strcmp(figure_table[id - 1].word, f->word) == 0);
            assert_true(!is_same || strcmp(figure_table[before].part, f->part) != 0);
        }
    }
}

static void every_failed_allocation_is_reported(void **state)
{
    for (size_t kind = 0; kind < 4; kind++) {
        const bool has_parts = kind % 2 == 1;
        const size_t has_feed = kind / 2;
        fixture x;
        begin_with(&x, 0.0, true, has_feed);
        size_t n = 0, n_failed = 1;
        while (n_failed > 0) {
            figures *f = NULL;
            memory_plan_fault(++n, 0);
            const bf_status status = figures_create(&x.s, has_parts, &f, NULL);
            n_failed = memory_faults();
            memory_plan_fault(0, 0);
            assert_int_equal(status, n_failed > 0 ? BF_ENOMEM : BF_OK);
            figures_destroy(f);
        }
        assert_true(n > 3);
        end(&x);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_not_known_is_absent),
        cmocka_unit_test(throughput_leaves_out_the_warm_up),
        cmocka_unit_test(throughput_without_feeds_is_that_of_the_middle_of_the_parts),
        cmocka_unit_test(throughput_with_feeds_is_sustained),
        cmocka_unit_test(where_nothing_passes_throughput_is_0),
        cmocka_unit_test(parts_are_counted_from_the_start),
        cmocka_unit_test(a_constant_throughput_is_steady_after_32_batches),
        cmocka_unit_test(residence_is_that_of_each_part_that_left),
        cmocka_unit_test(parts_that_are_inside_stay_longer_than_their_age),
        cmocka_unit_test(an_eye_is_blocked_for_some_time_after_the_warm_up),
        cmocka_unit_test(residence_of_a_density_is_the_distance_of_the_curves),
        cmocka_unit_test(residence_of_a_density_that_is_fed_is_what_exits_tell),
        cmocka_unit_test(figures_have_the_digits_that_they_have),
        cmocka_unit_test(a_jam_is_a_long_time_without_an_exit),
        cmocka_unit_test(less_than_a_part_is_no_exit),
        cmocka_unit_test(where_nothing_is_queued_there_is_no_jam_and_no_queue),
        cmocka_unit_test(thin_ends_of_a_density_are_not_its_queue),
        cmocka_unit_test(an_empty_belt_is_no_jam),
        cmocka_unit_test(content_is_a_mean_over_time),
        cmocka_unit_test(states_go_by_the_speed_of_the_belt),
        cmocka_unit_test(a_queue_reaches_from_the_next_plate_to_its_last_slow_part),
        cmocka_unit_test(the_peak_leaves_out_the_warm_up),
        cmocka_unit_test(drained_is_since_when_the_belt_is_empty),
        cmocka_unit_test(a_belt_that_nothing_has_entered_is_not_drained),
        cmocka_unit_test(a_feed_has_its_balance_and_the_waits_of_its_parts),
        cmocka_unit_test(waits_of_a_density_leave_out_what_is_dropped),
        cmocka_unit_test(an_eye_sees_gaps_and_doubles),
        cmocka_unit_test(a_chain_of_parts_is_all_doubles),
        cmocka_unit_test(a_checkpoint_goes_on_with_the_same_bits_in_both_models),
        cmocka_unit_test(stops_of_a_commanded_belt_are_those_of_its_curve),
        cmocka_unit_test(the_values_of_items_follow_each_other),
        cmocka_unit_test(the_table_is_sorted_by_scope_and_word),
        cmocka_unit_test(every_failed_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
