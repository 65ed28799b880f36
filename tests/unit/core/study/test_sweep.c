// Unit tests of sweeps and of the sequences and variates that they are made of.

#include "core/study/sweep.h"

#include "core/base/draws.h"
#include "core/study/sobol.h"
#include "core/study/variates.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <stdlib.h>

// The first eight in two dimensions are in every textbook; points 5 and 13 in all dimensions are scipy 1.10's
// (stats.qmc.Sobol without scrambling), in sixteenths.
static void sobols_points_are_the_published_ones(void **state)
{
    static const unsigned first[8][2] = { { 0, 0 }, { 4, 4 }, { 6, 2 }, { 2, 6 },
                                          { 3, 3 }, { 7, 7 }, { 5, 1 }, { 1, 5 } };
    static const unsigned fifth[SOBOL_DIMENSIONS] = { 14, 14, 2,  6, 14, 10, 14, 6, 6, 2,
                                                      6,  14, 14, 2, 14, 6,  14, 6, 6, 10 };
    static const unsigned thirteenth[SOBOL_DIMENSIONS] = { 13, 11, 13, 1,  7, 15, 9, 9,  9, 7,
                                                           13, 15, 1,  13, 3, 9,  3, 11, 9, 15 };
    for (uint64_t k = 0; k < 8; k++)
        for (unsigned d = 0; d < 2; d++)
            assert_int_equal(sobol_coordinate(k, d), first[k][d] << 29);
    for (unsigned d = 0; d < SOBOL_DIMENSIONS; d++) {
        assert_int_equal(sobol_coordinate(5, d), fifth[d] << 28);
        assert_int_equal(sobol_coordinate(13, d), thirteenth[d] << 28);
    }
}

// True if n = 2^k numbers in units of 2^-32 lie one in each of n equal intervals.
static bool is_stratified(const uint32_t *x, size_t n)
{
    bool *is_taken = calloc(n, sizeof *is_taken);
    bool is_even = true;

    for (size_t i = 0; i < n; i++) {
        const size_t stratum = (size_t)((uint64_t)x[i] * n >> 32);
        is_even = is_even && !is_taken[stratum];
        is_taken[stratum] = true;
    }
    free(is_taken);
    return is_even;
}

static void each_block_of_sobols_points_is_even_in_all_dimensions(void **state)
{
    enum { N = 1024 };
    uint32_t x[N];
    for (unsigned d = 0; d < SOBOL_DIMENSIONS; d++) {
        for (size_t i = 0; i < N; i++)
            x[i] = sobol_coordinate(5 * N + i, d);
        assert_true(is_stratified(x, N));
    }
}

static void a_shift_keeps_sobols_points_even_and_depends_on_the_seed(void **state)
{
    enum { N = 64, D = 3 };
    double points[N][D], other[D];
    uint32_t x[N];
    for (size_t i = 0; i < N; i++)
        sweep_sobol(7, i, D, points[i]);
    for (size_t d = 0; d < D; d++) {
        for (size_t i = 0; i < N; i++)
            x[i] = (uint32_t)(points[i][d] * 0x1p32);
        assert_true(is_stratified(x, N));
    }
    sweep_sobol(8, 0, D, other);
    assert_true(other[0] != points[0][0] && other[1] != points[0][1]);
}

static void a_latin_hypercube_has_a_point_in_each_stratum(void **state)
{
    enum { N = 37, D = 4 };
    double points[N * D];
    sweep_lhs(3, N, D, points);
    size_t n_in_order = 0;
    for (size_t d = 0; d < D; d++) {
        bool is_taken[N] = { false };
        for (size_t i = 0; i < N; i++) {
            const size_t stratum = (size_t)(points[i * D + d] * N);
            assert_true(stratum < N && !is_taken[stratum]);
            is_taken[stratum] = true;
            n_in_order += stratum == i;
        }
    }
    // A random permutation leaves one in its place, on average; four leave four with a deviation of 2.
    assert_true(n_in_order < 4 + 5 * 2);
}

static void a_grid_counts_its_last_parameter_fastest(void **state)
{
    static const size_t steps[] = { 2, 1, 3 };
    static const double expected[6][3] = { { 0, 0.5, 0 }, { 0, 0.5, 0.5 }, { 0, 0.5, 1 },
                                           { 1, 0.5, 0 }, { 1, 0.5, 0.5 }, { 1, 0.5, 1 } };
    static const size_t huge[] = { 1000000000, 1000000000, 1000000000 };
    double point[3];
    assert_int_equal(sweep_grid_points(steps, 3), 6);
    assert_true(sweep_grid_points(huge, 3) == SIZE_MAX);
    for (size_t k = 0; k < 6; k++) {
        sweep_grid(steps, 3, k, point);
        for (size_t d = 0; d < 3; d++)
            assert_true(point[d] == expected[k][d]);
    }
}

// The words of the generator under the key (seed, 1), and Box and Muller's transform of the first two.
static void variates_are_words_of_their_counter(void **state)
{
    const variates_key key = { .seed = 5, .purpose = VARIATES_STEP, .set = 3, .item = 2 };
    const uint64_t counter[4] = { 9, 2, 3, VARIATES_STEP }, cipher_key[2] = { 5, 1 };
    uint64_t words[4];
    draws_philox(counter, cipher_key, words);
    const double u = (double)(words[0] >> 11 | 1) * 0x1p-53;
    const double v = (double)(words[1] >> 11 | 1) * 0x1p-53;
    assert_true(variates_bits(&key, 9) == words[0]);
    assert_true(variates_unit(&key, 9) == u);
    assert_near(variates_normal(&key, 9), sqrt(-2.0 * log(u)) * cos(2.0 * M_PI * v), 1e-14);
}

// 10,000 normal variates: mean 0 with a deviation of 0.01, mean square 1 with sqrt(2/10,000).
static void normal_variates_have_mean_0_and_variance_1(void **state)
{
    enum { N = 10000 };
    const variates_key key = { .seed = 1, .purpose = VARIATES_STEP };
    double sum = 0.0, squares = 0.0;
    for (uint64_t k = 0; k < N; k++) {
        const double z = variates_normal(&key, k);
        sum += z;
        squares += z * z;
    }
    assert_near(sum / N, 0.0, 4 * 0.01);
    assert_near(squares / N, 1.0, 4 * 0.01414);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sobols_points_are_the_published_ones),
        cmocka_unit_test(each_block_of_sobols_points_is_even_in_all_dimensions),
        cmocka_unit_test(a_shift_keeps_sobols_points_even_and_depends_on_the_seed),
        cmocka_unit_test(a_latin_hypercube_has_a_point_in_each_stratum),
        cmocka_unit_test(a_grid_counts_its_last_parameter_fastest),
        cmocka_unit_test(variates_are_words_of_their_counter),
        cmocka_unit_test(normal_variates_have_mean_0_and_variance_1),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
