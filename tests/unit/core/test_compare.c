// Unit tests of the comparison of curves.

#include "core/compare/compare.h"
#include "tests/unit/core/helper_scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const double t_coarse[] = { 0.0, 1.0, 2.0 };
static const double t_fine[] = { 0.0, 0.5, 1.0, 1.5, 2.0 };

static void a_curve_is_at_no_distance_from_itself(void **state)
{
    (void)state;
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
    (void)state;
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
    (void)state;
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
    (void)state;
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

static void curves_that_are_none_are_refused_by_name(void **state)
{
    (void)state;
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
        cmocka_unit_test(curves_that_are_none_are_refused_by_name),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
