// Unit tests of the comparison of curves.

#include "core/compare/compare.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static const double t_coarse[] = { 0.0, 1.0, 2.0 };
static const double t_fine[] = { 0.0, 0.5, 1.0, 1.5, 2.0 };

static void a_curve_is_at_no_distance_from_itself(void **state)
{
    static const double parts[] = { 192.0, 100.0, 1.0 };
    const compare_curve c = { 3, t_coarse, parts };
    compare_measures m;
    assert_int_equal(compare_curves(&c, &c, &m, NULL), BF_OK);
    assert_near(m.l1, 0.0, 0.0);
    assert_near(m.l2, 0.0, 0.0);
    assert_near(m.largest, 0.0, 0.0);
    assert_near(m.drain_time_a, 2.0, 0.0); // 1 <= 1 % of 192
    assert_near(m.rate_a, 95.5, 1e-12);    // (192 - 1) / 2
}

// The same line sampled twice as finely is the same curve.
static void curves_are_read_linearly_between_their_samples(void **state)
{
    static const double coarse[] = { 10.0, 6.0, 2.0 }, fine[] = { 10.0, 8.0, 6.0, 4.0, 2.0 };
    const compare_curve a = { 3, t_coarse, coarse }, b = { 5, t_fine, fine };
    compare_measures m;
    assert_int_equal(compare_curves(&a, &b, &m, NULL), BF_OK);
    assert_near(m.l1, 0.0, 1e-15);
    assert_near(m.largest, 0.0, 1e-15);
}

// a - b goes from 2 to -2 on [0, 2]: mean |gap| 1, mean square 4/3, largest 2 at the start.
static void a_crossing_counts_on_both_its_sides(void **state)
{
    static const double ends[] = { 0.0, 2.0 }, falling[] = { 2.0, -2.0 }, zero[] = { 0.0, 0.0 };
    const compare_curve a = { 2, ends, falling }, b = { 2, ends, zero };
    compare_measures m;
    assert_int_equal(compare_curves(&a, &b, &m, NULL), BF_OK);
    assert_near(m.l1, 1.0, 1e-15);
    assert_near(m.l2, sqrt(4.0 / 3.0), 1e-15);
    assert_near(m.largest, 2.0, 0.0);
    assert_near(m.largest_at, 0.0, 0.0);
    assert_near(m.drain_time_b, 0.0, 0.0); // an empty belt has drained
}

// Curves on [0, 2] and [1, 3] meet on [1, 2], where the gap is 5 throughout.
static void only_the_common_interval_counts(void **state)
{
    static const double ta[] = { 0.0, 2.0 }, tb[] = { 1.0, 3.0 };
    static const double a_parts[] = { 5.0, 5.0 }, b_parts[] = { 0.0, 0.0 };
    const compare_curve a = { 2, ta, a_parts }, b = { 2, tb, b_parts };
    compare_measures m;
    assert_int_equal(compare_curves(&a, &b, &m, NULL), BF_OK);
    assert_near(m.t_start, 1.0, 0.0);
    assert_near(m.t_end, 2.0, 0.0);
    assert_near(m.l1, 5.0, 1e-15);
    assert_near(m.l2, 5.0, 1e-15);
    assert_true(isnan(m.drain_time_a));
}

// 100 parts leave on [1, 3] at 50 parts/s, with nothing before and after: 10 % are gone at 1.2 s, 90 %
// at 2.8 s. Seen through [1, 2] alone 50 parts leave, at the same rate.
static void throughput_is_taken_from_ten_to_ninety_percent_of_what_left(void **state)
{
    static const double t[] = { 0.0, 1.0, 3.0, 6.0 }, parts[] = { 120.0, 120.0, 20.0, 20.0 };
    static const double flat_t[] = { 1.0, 2.0 }, flat[] = { 7.0, 7.0 };
    const compare_curve c = { 4, t, parts }, still = { 2, flat_t, flat };
    compare_figures f;
    compare_measures m;
    assert_int_equal(compare_figures_of(&c, &f, NULL), BF_OK);
    assert_near(f.t_start, 0.0, 0.0);
    assert_near(f.t_end, 6.0, 0.0);
    assert_near(f.parts_start, 120.0, 0.0);
    assert_near(f.parts_end, 20.0, 0.0);
    assert_near(f.t10, 1.2, 1e-15);
    assert_near(f.t90, 2.8, 1e-15);
    assert_near(f.throughput, 50.0, 1e-12);
    assert_true(isnan(f.drain_time));
    assert_int_equal(compare_curves(&c, &still, &m, NULL), BF_OK);
    assert_near(m.throughput_a, 50.0, 1e-12);
    assert_true(isnan(m.throughput_b) && isnan(m.throughput_gap) && isnan(m.drain_gap));
}

// A ramp of 1 part/s on [0, 10], a rush of 40 parts/s on [10, 12], a trickle of 1 part/s on [12, 22]:
// the first and last 10 of 100 parts are cut off, so that the rush alone counts, sample by sample
// or not, and so it does for a counter that fills instead.
static void the_ramp_and_the_tail_do_not_count(void **state)
{
    static const double t[] = { 0.0, 10.0, 12.0, 22.0 }, out[] = { 100.0, 90.0, 10.0, 0.0 };
    static const double in[] = { 0.0, 10.0, 90.0, 100.0 };
    static double fine_t[221], fine[221];
    const compare_curve coarse = { 4, t, out }, filling = { 4, t, in };
    const compare_curve many = { 221, fine_t, fine };
    compare_figures f;
    for (int k = 0; k <= 220; k++) {
        fine_t[k] = 0.1 * k;
        fine[k] = k < 100 ? 100.0 - 0.1 * k : k < 120 ? 90.0 - 4.0 * (k - 100) : 22.0 - 0.1 * k;
    }
    const compare_curve *const all[] = { &coarse, &filling, &many };
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        assert_int_equal(compare_figures_of(all[k], &f, NULL), BF_OK);
        assert_near(f.t10, 10.0, 1e-9);
        assert_near(f.t90, 12.0, 1e-9);
        assert_near(f.throughput, 40.0, 1e-9);
    }
}

// Curves with the same shape, b 1 s later and twice as slow: drained 2 s later.
static void gaps_of_figures_are_b_minus_a(void **state)
{
    static const double ta[] = { 0.0, 1.0, 4.0 }, tb[] = { 0.0, 1.0, 3.0, 4.0 };
    static const double pa[] = { 10.0, 0.0, 0.0 }, pb[] = { 10.0, 10.0, 0.0, 0.0 };
    const compare_curve a = { 3, ta, pa }, b = { 4, tb, pb };
    compare_measures m;
    assert_int_equal(compare_curves(&a, &b, &m, NULL), BF_OK);
    assert_near(m.drain_gap, 2.0, 0.0);
    assert_near(m.throughput_a, 10.0, 1e-12);
    assert_near(m.throughput_b, 5.0, 1e-12);
    assert_near(m.throughput_gap, -5.0, 1e-12);
}

// What rises from nothing was empty at its start, which is no drain.
static void a_curve_that_rises_never_drains(void **state)
{
    static const double rising[] = { 0.0, 5.0, 9.0 }, falling[] = { 9.0, 5.0, 0.0 };
    const compare_curve a = { 3, t_coarse, rising }, b = { 3, t_coarse, falling };
    compare_figures f;
    compare_measures m;
    assert_int_equal(compare_figures_of(&a, &f, NULL), BF_OK);
    assert_true(isnan(f.drain_time));
    assert_int_equal(compare_curves(&a, &b, &m, NULL), BF_OK);
    assert_true(isnan(m.drain_time_a) && isnan(m.drain_gap));
    assert_near(m.drain_time_b, 2.0, 0.0);
}

static void a_content_has_gaps_but_no_outflow(void **state)
{
    static const double parts[] = { 10.0, 5.0, 0.0 }, fewer[] = { 8.0, 5.0, 0.0 };
    const compare_curve a = { 3, t_coarse, parts }, b = { 3, t_coarse, fewer };
    compare_figures f;
    compare_measures m, same;
    assert_int_equal(compare_figures_of(&a, &f, NULL), BF_OK);
    compare_figures_of_content(&f);
    assert_true(isnan(f.drain_time) && isnan(f.t10) && isnan(f.t90) && isnan(f.throughput));
    assert_near(f.parts_start, 10.0, 0.0);
    assert_int_equal(compare_curves(&a, &b, &m, NULL), BF_OK);
    same = m;
    compare_measures_of_content(&same, false, false);
    assert_near(same.drain_gap, m.drain_gap, 0.0);
    assert_near(same.throughput_gap, m.throughput_gap, 0.0);
    compare_measures_of_content(&m, false, true);
    assert_near(m.throughput_a, 5.0, 1e-12);
    assert_near(m.rate_a, 5.0, 1e-12);
    assert_true(isnan(m.drain_time_b) && isnan(m.rate_b) && isnan(m.throughput_b));
    assert_true(isnan(m.drain_gap) && isnan(m.throughput_gap));
    assert_near(m.largest, 2.0, 0.0);
    compare_measures_of_content(&m, true, false);
    assert_true(isnan(m.drain_time_a) && isnan(m.rate_a) && isnan(m.throughput_a));
}

static void a_single_sample_has_figures_but_no_throughput(void **state)
{
    static const double t[] = { 2.0 }, parts[] = { 5.0 };
    const compare_curve c = { 1, t, parts }, none = { 0, t, parts };
    compare_figures f = { .t_start = -1.0 };
    bf_error err;
    assert_int_equal(compare_figures_of(&none, &f, &err), BF_EINPUT);
    assert_near(f.t_start, -1.0, 0.0);
    assert_int_equal(compare_figures_of(&c, &f, NULL), BF_OK);
    assert_near(f.t_end, 2.0, 0.0);
    assert_true(isnan(f.throughput) && isnan(f.t10) && isnan(f.t90));
}

static void curves_that_are_none_are_refused_by_name(void **state)
{
    static const double good[] = { 3.0, 2.0, 1.0 }, late[] = { 5.0, 6.0, 7.0 };
    static const double stuck[] = { 0.0, 1.0, 1.0 }, broken[] = { 3.0, NAN, 1.0 };
    const compare_curve fine = { 3, t_coarse, good };
    const compare_curve bad[] = { { 0, t_coarse, good },
                                  { 3, stuck, good },
                                  { 3, t_coarse, broken } };
    compare_measures m = { .l1 = -1.0 };
    bf_error err;
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        assert_int_equal(compare_curves(&bad[k], &fine, &m, &err), BF_EINPUT);
        assert_string_equal(err.pointer, "/a");
        assert_int_equal(compare_curves(&fine, &bad[k], &m, &err), BF_EINPUT);
        assert_string_equal(err.pointer, "/b");
    }
    const compare_curve elsewhere = { 3, late, good };
    assert_int_equal(compare_curves(&fine, &elsewhere, &m, &err), BF_EINPUT);
    assert_near(m.l1, -1.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_curve_is_at_no_distance_from_itself),
        cmocka_unit_test(curves_are_read_linearly_between_their_samples),
        cmocka_unit_test(a_crossing_counts_on_both_its_sides),
        cmocka_unit_test(only_the_common_interval_counts),
        cmocka_unit_test(throughput_is_taken_from_ten_to_ninety_percent_of_what_left),
        cmocka_unit_test(the_ramp_and_the_tail_do_not_count),
        cmocka_unit_test(gaps_of_figures_are_b_minus_a),
        cmocka_unit_test(a_curve_that_rises_never_drains),
        cmocka_unit_test(a_content_has_gaps_but_no_outflow),
        cmocka_unit_test(a_single_sample_has_figures_but_no_throughput),
        cmocka_unit_test(curves_that_are_none_are_refused_by_name),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
