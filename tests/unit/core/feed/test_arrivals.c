// Unit tests of arrivals: Lambda, its inverse, and when and what each part is.

#include "core/feed/arrivals.h"

#include "core/base/memory.h"
#include "core/feed/capacity.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

// A feed of one kind with a rate; its arrays are borrowed.
static scene_feed make_feed(double rate)
{
    scene_feed f;

    scene_feed_init(&f);
    strcpy(f.id, "feed-1");
    f.demand = SCENE_DEMAND_RATE;
    f.rate = rate;
    f.n_cargo = 1;
    f.cargo[0] = (scene_feed_kind){ 0, 1.0 };
    return f;
}

static void set_profile(scene_feed *f, size_t n, double *times, double *values, double repeat)
{
    f->demand = SCENE_DEMAND_PROFILE;
    f->profile = (scene_series){ n, times, n, values, repeat };
}

static feed_arrivals *make(const scene_feed *f)
{
    feed_arrivals *a = NULL;

    assert_int_equal(feed_arrivals_create(f, 0, &a, NULL), BF_OK);
    return a;
}

static void a_constant_rate_counts_from_start_to_end(void **state)
{
    scene_feed f = make_feed(4.0);
    f.start = 2.0;
    f.end = 5.0;
    feed_arrivals *a = make(&f);
    assert_true(feed_arrivals_until(a, 1.0) == 0.0 && feed_arrivals_until(a, 2.0) == 0.0);
    assert_near(feed_arrivals_until(a, 2.5), 2.0, 1e-15);
    assert_near(feed_arrivals_until(a, 5.0), 12.0, 1e-15);
    assert_true(feed_arrivals_until(a, 9.0) == feed_arrivals_until(a, INFINITY));
    assert_near(feed_arrivals_time(a, 12.0), 5.0, 1e-15);
    assert_true(feed_arrivals_time(a, 12.001) == INFINITY);
    assert_true(feed_arrivals_largest_rate(a) == 4.0);
    feed_arrivals_destroy(a);
    f.end = INFINITY;
    f.count = 7.0;
    a = make(&f);
    assert_true(feed_arrivals_until(a, 100.0) == 7.0 && feed_arrivals_until(a, INFINITY) == 7.0);
    feed_arrivals_destroy(a);
}

// 2 parts/s until 1 s, rising to 6 at 3 s, where it stays: Lambda(1) = 2, Lambda(3) = 2 + 8, then 6 a second. In
// between Lambda(2) = 2 + (2 + 4)/2.
static void a_profile_is_the_integral_of_its_pieces(void **state)
{
    double times[] = { 1.0, 3.0 }, values[] = { 2.0, 6.0 };
    scene_feed f = make_feed(NAN);
    set_profile(&f, 2, times, values, INFINITY);
    f.start = 10.0;
    feed_arrivals *a = make(&f);
    const double level[][2] = {
        { 10.5, 1.0 }, { 11.0, 2.0 }, { 12.0, 5.0 }, { 13.0, 10.0 }, { 15.0, 22.0 }
    };
    for (size_t k = 0; k < 5; k++) {
        assert_near(feed_arrivals_until(a, level[k][0]), level[k][1], 1e-14);
        assert_near(feed_arrivals_time(a, level[k][1]), level[k][0], 1e-14);
    }
    assert_true(feed_arrivals_largest_rate(a) == 6.0);
    feed_arrivals_destroy(a);
}

// 3 parts in the first second, none in the second one, falling from 2 to 0 in the third: 4 parts in 3 s, and again
// from 4 s on (constant 0 until then).
static void a_profile_repeats_and_pauses(void **state)
{
    double times[] = { 0.0, 1.0, 1.0 + 1e-12, 2.0 - 1e-12, 2.0, 3.0 };
    double values[] = { 3.0, 3.0, 0.0, 0.0, 2.0, 0.0 };
    scene_feed f = make_feed(NAN);
    set_profile(&f, 6, times, values, 4.0);
    feed_arrivals *a = make(&f);
    assert_near(feed_arrivals_until(a, 1.5), 3.0, 1e-11);
    assert_near(feed_arrivals_until(a, 4.0), 4.0, 1e-11);
    assert_near(feed_arrivals_until(a, 4e6 + 2.5), 4e6 + 3.75, 1e-5);
    // The first time: at the end of the part with a rate, not of the pause.
    assert_near(feed_arrivals_time(a, 3.0), 1.0, 1e-6);
    assert_near(feed_arrivals_time(a, 3.75), 2.5, 1e-11);
    assert_near(feed_arrivals_time(a, feed_arrivals_until(a, 4.0)), 3.0, 1e-6);
    assert_near(feed_arrivals_time(a, 4e6 + 1.5), 4e6 + 0.5, 1e-5);
    assert_true(feed_arrivals_until(a, INFINITY) == INFINITY);
    feed_arrivals_destroy(a);
}

// Ten a second, due at 0.05 s and each tenth of a second after it; and batches of 5 of four a second from 0.3 s on, due where
// 2.5 and 7.5 parts are reached: at 0.925 and 2.175 s. The density has 14 parts of both.
static void parts_of_all_feeds_are_counted_as_they_are_drawn(void **state)
{
    scene_feed feeds[] = { make_feed(10.0), make_feed(4.0) };
    const scene s = { .n_feeds = 2, .feeds = feeds };
    double parts = 0.0;

    feeds[1].arrivals = SCENE_ARRIVALS_BATCH;
    feeds[1].batch_size = 5;
    feeds[1].start = 0.3;
    assert_int_equal(feed_drawn(&s, 0.5, 1.5, &parts, NULL), BF_OK);
    assert_true(parts == 15.0);
    assert_int_equal(feed_offered(&s, 0.5, 1.5, &parts, NULL), BF_OK);
    assert_near(parts, 14.0, 1e-12);
}

static void a_profile_that_ends_with_nothing_is_finite(void **state)
{
    double times[] = { 0.0, 2.0 }, values[] = { 5.0, 0.0 };
    scene_feed f = make_feed(NAN);
    set_profile(&f, 2, times, values, INFINITY);
    feed_arrivals *a = make(&f);
    assert_near(feed_arrivals_until(a, INFINITY), 5.0, 1e-15);
    assert_true(feed_arrivals_time(a, 5.1) == INFINITY);
    // lambda = 5 - 2.5 t reaches half of the parts where (2 - t)^2 = 2.
    assert_near(feed_arrivals_time(a, 2.5), 2.0 - sqrt(2.0), 1e-14);
    feed_arrivals_destroy(a);
}

// Times of a random profile and back.
static void the_inverse_undoes_lambda(void **state)
{
    enum { N = 1000 };
    double times[N], values[N], t = 0.0;
    for (size_t k = 0; k < N; k++) {
        times[k] = t += 0.1 + (double)(k * 37 % 11) * 0.05;
        values[k] = 0.5 + (double)(k * k % 17);
    }
    scene_feed f = make_feed(NAN);
    set_profile(&f, N, times, values, t + 3.0);
    f.start = 1.5;
    feed_arrivals *a = make(&f);
    for (double at = 1.6; at < 5000.0; at += 0.77) {
        const double back = feed_arrivals_time(a, feed_arrivals_until(a, at));
        assert_near(back, at, 1e-11 * at);
    }
    feed_arrivals_destroy(a);
}

static void check_times(const scene_feed *f, const double *expected, size_t n)
{
    feed_arrivals *a = make(f);
    feed_cursor c = feed_arrivals_first(a);

    for (size_t k = 0; k < n; k++) {
        assert_int_equal(c.number, k + 1);
        assert_near(c.due, expected[k], 1e-14 * expected[k]);
        feed_arrivals_next(a, &c);
    }
    assert_true(c.due == INFINITY);
    feed_arrivals_destroy(a);
}

// 4 a second from 1 s on: where Lambda is 1/2, 3/2, 5/2, until 2 s. Batches of three: where it is 3/2 and 9/2.
static void regular_and_batch_arrivals_are_at_halves(void **state)
{
    scene_feed f = make_feed(4.0);
    f.start = 1.0;
    f.end = 2.0;
    check_times(&f, (double[]){ 1.125, 1.375, 1.625, 1.875 }, 4);
    f.arrivals = SCENE_ARRIVALS_BATCH;
    f.batch_size = 3;
    check_times(&f, (double[]){ 1.375, 1.375, 1.375 }, 3);
    f.end = INFINITY;
    f.count = 5.0;
    check_times(&f, (double[]){ 1.375, 1.375, 1.375, 2.125, 2.125 }, 5);
}

static void a_list_is_delivered_between_start_and_end(void **state)
{
    double times[] = { 0.0, 0.4, 0.4, 2.0, 3.0 }, places[] = { 0.1, NAN, 0.3, 0.4, 0.5 };
    uint32_t counts[] = { 1, 3, 1, 2, 1 }, kinds[] = { 3, 1, 0, 2, 0 };
    double headings[] = { NAN, 1.0, 2.0, 3.0, 4.0 };
    scene_feed f = make_feed(NAN);
    f.demand = SCENE_DEMAND_SCHEDULE;
    f.schedule = (scene_arrival_list){ 5, times, counts, kinds, places, headings };
    f.heading = 0.25;
    check_times(&f, (double[]){ 0.0, 0.4, 0.4, 0.4, 0.4, 2.0, 2.0, 3.0 }, 8);
    f.start = 0.4;
    f.end = 2.0;
    check_times(&f, (double[]){ 0.4, 0.4, 0.4, 0.4, 2.0, 2.0 }, 6);
    f.count = 4.0;
    check_times(&f, (double[]){ 0.4, 0.4, 0.4, 0.4 }, 4);
    f.count = INFINITY;
    feed_arrivals *a = make(&f);
    assert_true(feed_arrivals_until(a, 0.39) == 0.0 && feed_arrivals_until(a, 0.4) == 4.0);
    assert_true(feed_arrivals_until(a, INFINITY) == 6.0);
    assert_true(feed_arrivals_time(a, 4.0) == 0.4 && feed_arrivals_time(a, 4.5) == 2.0);
    assert_near(feed_arrivals_largest_rate(a), 3.0 / 1.6, 1e-15);
    feed_cursor c = feed_arrivals_first(a);
    for (size_t k = 0; k < 3; k++)
        feed_arrivals_next(a, &c);
    const feed_part fourth = feed_arrivals_part(a, &c);
    assert_true(fourth.kind == 0 && fourth.place == 0.3 && fourth.is_placed &&
                fourth.heading == 2.0);
    feed_arrivals_destroy(a);
    f.start = 0.0;
    a = make(&f);
    c = feed_arrivals_first(a);
    const feed_part first = feed_arrivals_part(a, &c);
    assert_true(first.kind == 3 && first.place == 0.1 && first.heading == 0.25);
    feed_arrivals_next(a, &c);
    const feed_part drawn = feed_arrivals_part(a, &c);
    assert_true(!drawn.is_placed && drawn.place > 0.0 && drawn.place < 1.0);
    feed_arrivals_destroy(a);
}

static void an_empty_list_delivers_nothing(void **state)
{
    double times[] = { 5.0 };
    scene_feed f = make_feed(NAN);
    f.demand = SCENE_DEMAND_SCHEDULE;
    f.schedule = (scene_arrival_list){ .n = 1, .times = times };
    f.end = 4.0;
    feed_arrivals *a = make(&f);
    assert_true(feed_arrivals_first(a).due == INFINITY);
    assert_true(feed_arrivals_until(a, 9.0) == 0.0 && feed_arrivals_largest_rate(a) == 0.0);
    feed_arrivals_destroy(a);
}

// Counts of a Poisson feed in 10 s at 2 parts/s over 200 substreams, in classes of an expectation of at least 5. The
// statistic has a chi-square distribution of 9 degrees of freedom, of which 1 % is above 21.67 (Abramowitz and
// Stegun, table 26.8).
static void poisson_counts_pass_a_chi_square_test(void **state)
{
    enum { RUNS = 200, CLASSES = 10 };
    static const unsigned upper[CLASSES] = { 14, 16, 17, 18, 19, 20, 21, 23, 25, UINT32_MAX };
    double expected[CLASSES] = { 0.0 }, term = exp(-20.0), statistic = 0.0;
    size_t seen[CLASSES] = { 0 };
    scene_feed f = make_feed(2.0);
    f.arrivals = SCENE_ARRIVALS_POISSON;
    f.end = 10.0;
    for (uint64_t substream = 0; substream < RUNS; substream++) {
        feed_arrivals *a = NULL;
        assert_int_equal(feed_arrivals_create(&f, substream, &a, NULL), BF_OK);
        feed_cursor c = feed_arrivals_first(a);
        while (c.due < INFINITY)
            feed_arrivals_next(a, &c);
        size_t k = 0;
        while (c.number - 1 > upper[k])
            k++;
        seen[k]++;
        feed_arrivals_destroy(a);
    }
    for (unsigned n = 0, k = 0; n < 100; term *= 20.0 / ++n) {
        k += n > upper[k];
        expected[k] += RUNS * term;
    }
    for (size_t k = 0; k < CLASSES; k++) {
        assert_true(expected[k] >= 5.0);
        statistic +=
            ((double)seen[k] - expected[k]) * ((double)seen[k] - expected[k]) / expected[k];
    }
    assert_true(statistic < 21.67);
}

// A profile changes when parts arrive, and nothing else about them.
static void parts_of_equal_substream_are_equal(void **state)
{
    scene_feed f = make_feed(3.0), other;
    feed_cursor c[3];
    size_t n_differ = 0, n_second = 0;
    f.arrivals = SCENE_ARRIVALS_POISSON;
    f.has_random_heading = true;
    f.n_cargo = 2;
    f.cargo[1] = (scene_feed_kind){ 5, 3.0 };
    other = f;
    other.rate = 6.0;
    feed_arrivals *a[3] = { make(&f), make(&other), NULL };
    assert_int_equal(feed_arrivals_create(&f, 1, &a[2], NULL), BF_OK);
    for (size_t k = 0; k < 3; k++)
        c[k] = feed_arrivals_first(a[k]);
    for (size_t n = 0; n < 1000; n++) {
        const feed_part p = feed_arrivals_part(a[0], &c[0]), q = feed_arrivals_part(a[1], &c[1]),
                        r = feed_arrivals_part(a[2], &c[2]);
        assert_true(p.kind == q.kind && p.place == q.place && p.heading == q.heading);
        assert_near(p.due, 2.0 * q.due, 1e-13 * p.due);
        n_differ += p.place != r.place && p.heading != r.heading && p.due != r.due;
        n_second += p.kind == 5;
        for (size_t k = 0; k < 3; k++)
            feed_arrivals_next(a[k], &c[k]);
    }
    assert_int_equal(n_differ, 1000);
    // 750 are expected, with a standard deviation of sqrt(1000 3/16) = 13.7.
    assert_near((double)n_second, 750.0, 4.0 * 13.7);
    for (size_t k = 0; k < 3; k++)
        feed_arrivals_destroy(a[k]);
}

// Erlang gaps of shape 4 have a standard deviation of 1/2: so the part a million comes at 1e6 +- 4 x 500. A copy of
// the cursor goes on alike.
static void a_million_parts_arrive_in_order(void **state)
{
    enum { N = 1000000 };
    scene_feed f = make_feed(1.0);
    f.arrivals = SCENE_ARRIVALS_ERLANG;
    f.shape = 4;
    feed_arrivals *a = make(&f);
    feed_cursor c = feed_arrivals_first(a), copy = c;
    for (size_t k = 1; k < N; k++) {
        const double before = c.due;
        feed_arrivals_next(a, &c);
        assert_true(c.due > before);
        if (k == N / 2)
            copy = c;
    }
    assert_int_equal(c.number, N);
    assert_near(c.due, 1e6, 2000.0);
    for (size_t k = N / 2; k < N - 1; k++)
        feed_arrivals_next(a, &copy);
    assert_memory_equal(&copy, &c, sizeof c);
    feed_arrivals_destroy(a);
}

// A belt of 0.5 m/s, 0.6 m wide, half of it covered by a line, packed with 1000 parts/m2: 150 parts/s, and the width
// of one more part of 1/sqrt(1000) m. A line at 30 degrees to the belt is crossed at half the speed, one along it not
// at all: parts make room for each other one by one.
static void the_capacity_is_what_the_belt_carries_away(void **state)
{
    const double width = 1.0 / sqrt(1000.0);
    scene_feed f = make_feed(1.0);
    scene s;
    helper_scene_belt(&s, 1.0, 0.6, 0.01, NULL, 0);
    s.macro.packing = 1000.0;
    helper_scene_add_belt(&s, (vec2){ 0.5, 0.0 }, NULL, 0);
    helper_scene_resolve(&s);
    f.line[0] = (vec2){ 0.0, 0.1 };
    f.line[1] = (vec2){ 0.0, 0.4 };
    assert_near(feed_capacity(&s, &f), 1000.0 * 0.5 * (0.3 + width), 1e-9);
    f.line[1] = (vec2){ 0.3 * sqrt(0.75), 0.1 + 0.15 };
    assert_near(feed_capacity(&s, &f), 1000.0 * (0.25 * 0.3 + 0.5 * width), 1e-9);
    f.line[1] = (vec2){ 0.3, 0.1 };
    assert_near(feed_capacity(&s, &f), 1000.0 * 0.5 * width, 1e-9);
    f.line[1] = f.line[0];
    assert_near(feed_capacity(&s, &f), 1000.0 * 0.5 * width, 1e-9);
    helper_scene_schedule(s.belts, 2, (double[]){ 1.0, 2.0 }, (double[]){ 3.0, 0.0 });
    assert_near(feed_capacity(&s, &f), 1000.0 * 1.5 * width, 1e-9);
    scene_fini(&s);
}

static void out_of_memory_anywhere_is_an_error(void **state)
{
    double times[] = { 1.0 }, values[] = { 2.0 };
    scene_feed feeds[] = { make_feed(1.0), make_feed(NAN), make_feed(NAN) };
    set_profile(&feeds[1], 1, times, values, INFINITY);
    feeds[2].demand = SCENE_DEMAND_SCHEDULE;
    feeds[2].schedule = (scene_arrival_list){ .n = 1, .times = times };
    for (size_t k = 0; k < 3; k++) {
        bf_status status = BF_ENOMEM;
        feed_arrivals *a = NULL;
        for (size_t n = 1; status != BF_OK; n++) {
            memory_plan_fault(n, 0);
            status = feed_arrivals_create(&feeds[k], 0, &a, NULL);
            memory_plan_fault(0, 0);
            assert_true(status == BF_OK || (status == BF_ENOMEM && a == NULL));
        }
        feed_arrivals_destroy(a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_rate_counts_from_start_to_end),
        cmocka_unit_test(a_profile_is_the_integral_of_its_pieces),
        cmocka_unit_test(a_profile_repeats_and_pauses),
        cmocka_unit_test(parts_of_all_feeds_are_counted_as_they_are_drawn),
        cmocka_unit_test(a_profile_that_ends_with_nothing_is_finite),
        cmocka_unit_test(the_inverse_undoes_lambda),
        cmocka_unit_test(regular_and_batch_arrivals_are_at_halves),
        cmocka_unit_test(a_list_is_delivered_between_start_and_end),
        cmocka_unit_test(an_empty_list_delivers_nothing),
        cmocka_unit_test(poisson_counts_pass_a_chi_square_test),
        cmocka_unit_test(parts_of_equal_substream_are_equal),
        cmocka_unit_test(a_million_parts_arrive_in_order),
        cmocka_unit_test(the_capacity_is_what_the_belt_carries_away),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
