// Unit tests of curves in bounded memory.

#include "core/observe/thinned.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

// Samples at t = first .. end - 1 of the curve 3 t.
static void add(thinned *c, int first, int end)
{
    for (int k = first; k < end; k++)
        thinned_add(c, k, 3.0 * k);
}

static void check(const compare_curve *curve, size_t n, double every, double last)
{
    assert_int_equal(curve->n, n);
    for (size_t k = 0; k < n; k++) {
        const double t = k + 1 < n ? every * (double)k : last;
        assert_near(curve->t[k], t, 0.0);
        assert_near(curve->parts[k], 3.0 * t, 0.0);
    }
}

static void all_stay_while_they_are_few(void **state)
{
    thinned c;
    assert_int_equal(thinned_init(&c, NULL), BF_OK);
    assert_int_equal(thinned_curve(&c).n, 0);
    add(&c, 0, THINNED_SAMPLES);
    const compare_curve curve = thinned_curve(&c);
    check(&curve, THINNED_SAMPLES, 1.0, THINNED_SAMPLES - 1);
    thinned_fini(&c);
}

// One too many: 0, 2, ... 4094 and the newest. The next one is the last, until 4098 stays.
static void of_more_every_second_and_the_last_stay(void **state)
{
    thinned c;
    assert_int_equal(thinned_init(&c, NULL), BF_OK);
    for (int n = THINNED_SAMPLES + 1; n < THINNED_SAMPLES + 5; n++) {
        add(&c, n == THINNED_SAMPLES + 1 ? 0 : n - 1, n);
        const compare_curve curve = thinned_curve(&c);
        check(&curve, (size_t)n / 2 + 1, 2.0, n - 1);
    }
    thinned_fini(&c);
}

// 100,000 samples: every 32nd, of 0, 32 ... 99,968, and the last.
static void a_long_curve_is_even(void **state)
{
    thinned c;
    assert_int_equal(thinned_init(&c, NULL), BF_OK);
    add(&c, 0, 100000);
    const compare_curve curve = thinned_curve(&c);
    check(&curve, 3126, 32.0, 99999);
    thinned_fini(&c);
}

static void a_checkpoint_of_any_length_goes_on_alike(void **state)
{
    static const int lengths[] = { 0, 1, 4095, 4096, 4097, 4098, 9001 };

    for (size_t k = 0; k < sizeof lengths / sizeof *lengths; k++) {
        bf_buffer bytes = { 0 };
        checkpoint_writer w;
        checkpoint_reader r;
        thinned whole, loaded;
        assert_int_equal(thinned_init(&whole, NULL), BF_OK);
        assert_int_equal(thinned_init(&loaded, NULL), BF_OK);
        add(&whole, 0, lengths[k]);
        checkpoint_begin(&w, &bytes, CHECKPOINT_RUN, 1);
        thinned_save(&whole, &w);
        assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
        assert_int_equal(checkpoint_open(&r, bytes.bytes, bytes.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
        assert_true(thinned_load(&loaded, &r));
        assert_int_equal(r.n_left, 0);
        add(&whole, lengths[k], 20000);
        add(&loaded, lengths[k], 20000);
        const compare_curve a = thinned_curve(&whole), b = thinned_curve(&loaded);
        assert_int_equal(a.n, b.n);
        assert_memory_equal(a.t, b.t, a.n * sizeof *a.t);
        assert_memory_equal(a.parts, b.parts, a.n * sizeof *a.parts);
        thinned_fini(&whole);
        thinned_fini(&loaded);
        buffer_fini(&bytes);
    }
}

// Whatever a damaged count says, as many samples as that would leave are missing.
static void a_count_without_its_samples_is_refused(void **state)
{
    static const uint64_t counts[] = { 1, 5, THINNED_SAMPLES + 1, UINT64_MAX };

    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        bf_buffer bytes = { 0 };
        checkpoint_writer w;
        checkpoint_reader r;
        thinned c;
        assert_int_equal(thinned_init(&c, NULL), BF_OK);
        checkpoint_begin(&w, &bytes, CHECKPOINT_RUN, 1);
        checkpoint_write(&w, &counts[k], sizeof counts[k]);
        assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
        assert_int_equal(checkpoint_open(&r, bytes.bytes, bytes.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
        assert_false(thinned_load(&c, &r));
        thinned_fini(&c);
        buffer_fini(&bytes);
    }
}

static void no_memory_is_reported(void **state)
{
    thinned c;
    memory_plan_fault(1, 0);
    assert_int_equal(thinned_init(&c, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_stay_while_they_are_few),
        cmocka_unit_test(of_more_every_second_and_the_last_stay),
        cmocka_unit_test(a_long_curve_is_even),
        cmocka_unit_test(a_checkpoint_of_any_length_goes_on_alike),
        cmocka_unit_test(a_count_without_its_samples_is_refused),
        cmocka_unit_test(no_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
