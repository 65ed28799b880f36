// Unit tests of distributions at bounded memory.

#include "core/observe/quantiles.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static quantiles empty(void)
{
    quantiles q;

    assert_int_equal(quantiles_init(&q, NULL), BF_OK);
    return q;
}

static void nothing_has_neither_mean_nor_quantiles(void **state)
{
    quantiles q = empty();
    assert_true(isnan(quantiles_mean(&q)));
    assert_true(isnan(quantiles_at(&q, 0.5)));
    quantiles_fini(&q);
}

static void one_value_is_every_quantile_to_the_bit(void **state)
{
    quantiles q = empty();
    quantiles_add(&q, 12.345, 3.0);
    assert_true(quantiles_at(&q, 0.01) == 12.345);
    assert_true(quantiles_at(&q, 0.99) == 12.345);
    assert_near(quantiles_mean(&q), 12.345, 1e-14);
    quantiles_fini(&q);
}

// 1, 2, ..., 1000 s: the mean is 500.5, the quantile p is 1000 p.
static void quantiles_are_off_by_less_than_four_thousandths(void **state)
{
    static const double p[] = { 0.05, 0.5, 0.9, 0.95, 0.99 };
    quantiles q = empty();
    for (int k = 1; k <= 1000; k++)
        quantiles_add(&q, k, 1.0);
    assert_near(quantiles_mean(&q), 500.5, 1e-9);
    for (size_t k = 0; k < sizeof p / sizeof *p; k++)
        assert_near(quantiles_at(&q, p[k]), 1000.0 * p[k], 1000.0 * p[k] / 256.0 + 1.0);
    assert_near(q.min, 1.0, 0.0);
    assert_near(q.max, 1000.0, 0.0);
    quantiles_fini(&q);
}

// Nine parts at 1 s and one at 100 s: at most 90 % of the weight lies below 1.004 s.
static void weights_decide(void **state)
{
    quantiles q = empty();
    quantiles_add(&q, 1.0, 9.0);
    quantiles_add(&q, 100.0, 1.0);
    assert_near(quantiles_at(&q, 0.9), 1.0, 1.0 / 256.0);
    assert_near(quantiles_at(&q, 0.95), 100.0, 100.0 / 256.0);
    assert_near(quantiles_mean(&q), 10.9, 1e-14);
    quantiles_fini(&q);
}

// Uniform from 0.2 to 0.7, over two borders of octaves, in either direction: quantile p is 0.2 + p/2.
static void a_uniform_weight_has_the_quantiles_of_its_interval(void **state)
{
    quantiles q = empty();
    quantiles_add_uniform(&q, 0.2, 0.7, 3.0);
    quantiles_add_uniform(&q, 0.7, 0.2, 5.0);
    assert_near(q.weight, 8.0, 1e-14);
    assert_near(quantiles_mean(&q), 0.45, 1e-14);
    for (double p = 0.05; p < 1.0; p += 0.05)
        assert_near(quantiles_at(&q, p), 0.2 + 0.5 * p, 1e-12);
    quantiles_fini(&q);
}

static void a_uniform_weight_on_one_value_is_that_value(void **state)
{
    quantiles q = empty();
    quantiles_add_uniform(&q, 3.0, 3.0, 2.0);
    assert_near(quantiles_at(&q, 0.5), 3.0, 0.0);
    assert_near(q.weight, 2.0, 0.0);
    quantiles_fini(&q);
}

static void what_lies_outside_the_range_counts_with_its_extremes(void **state)
{
    quantiles q = empty();
    quantiles_add(&q, 0.0, 1.0);
    quantiles_add(&q, 1e30, 1.0);
    quantiles_add_uniform(&q, 0.0, 1e30, 2.0);
    assert_near(q.weight, 4.0, 0.0);
    assert_true(quantiles_at(&q, 0.1) >= 0.0 && quantiles_at(&q, 0.1) <= 0x1p-14);
    assert_true(quantiles_at(&q, 0.99) <= 1e30);
    quantiles_fini(&q);
}

static void a_checkpoint_brings_back_every_bit(void **state)
{
    bf_buffer bytes = { 0 };
    checkpoint_writer w;
    checkpoint_reader r;
    quantiles q = empty(), copy = empty();
    for (int k = 1; k < 100; k++)
        quantiles_add(&q, 0.37 * k, 1.0 / k);
    quantiles_add(&copy, 77.0, 1.0); // what was there goes
    checkpoint_begin(&w, &bytes, CHECKPOINT_RUN, 1);
    quantiles_save(&q, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, bytes.bytes, bytes.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
    assert_true(quantiles_load(&copy, &r));
    assert_int_equal(r.n_left, 0);
    assert_true(quantiles_mean(&q) == quantiles_mean(&copy));
    for (double p = 0.01; p < 1.0; p += 0.01)
        assert_true(quantiles_at(&q, p) == quantiles_at(&copy, p));
    buffer_fini(&bytes);
    quantiles_fini(&q);
    quantiles_fini(&copy);
}

static void no_memory_is_reported(void **state)
{
    quantiles q;
    bf_error err;
    memory_plan_fault(1, 0);
    assert_int_equal(quantiles_init(&q, &err), BF_ENOMEM);
    memory_plan_fault(0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_has_neither_mean_nor_quantiles),
        cmocka_unit_test(one_value_is_every_quantile_to_the_bit),
        cmocka_unit_test(quantiles_are_off_by_less_than_four_thousandths),
        cmocka_unit_test(weights_decide),
        cmocka_unit_test(a_uniform_weight_has_the_quantiles_of_its_interval),
        cmocka_unit_test(a_uniform_weight_on_one_value_is_that_value),
        cmocka_unit_test(what_lies_outside_the_range_counts_with_its_extremes),
        cmocka_unit_test(a_checkpoint_brings_back_every_bit),
        cmocka_unit_test(no_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
