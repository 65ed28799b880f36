// Unit tests of the draws of feeds.

#include "core/base/draws.h"

#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

// The first three are the known answers of the authors' Random123 (kat_vectors, philox4x64 10); the last one is from
// numpy.random.Philox (which adds one to its counter first). All four were compared with numpy 2.
static void philox_gives_the_known_answers(void **state)
{
    static const uint64_t all = UINT64_MAX;
    static const struct {
        uint64_t counter[4], key[2], words[4];
    } cases[] = {
        { { 0, 0, 0, 0 },
          { 0, 0 },
          { 0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b, 0x7e68b68aec7ba23b } },
        { { all, all, all, all },
          { all, all },
          { 0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0 } },
        { { 0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89 },
          { 0x452821e638d01377, 0xbe5466cf34e90c6c },
          { 0xa528f45403e61d95, 0x38c72dbd566e9788, 0xa5a1610e72fd18b5, 0x57bd43b5e52b7fe6 } },
        { { 7, 0x123456789abcdef, 1000000, 2 },
          { 1, 0 },
          { 0x05d8aecd1e010d95, 0x88212faa2bb45f25, 0xed1db893c1999768, 0x957d7808939f0a04 } },
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        uint64_t words[4];
        draws_philox(cases[k].counter, cases[k].key, words);
        assert_memory_equal(words, cases[k].words, sizeof words);
    }
}

// Draw 5 of part 9 for a kind is the second word of the counter (1 + 2^56, 9, feed, substream).
static void a_draw_is_the_word_of_its_own_counter(void **state)
{
    const draws from = { .seed = 11, .substream = 3, .source = 77 };
    const uint64_t counter[4] = { 1 | UINT64_C(1) << 56, 9, 77, 3 }, key[2] = { 11, 0 };
    uint64_t words[4];
    draws_philox(counter, key, words);
    assert_true(draws_unit(&from, 9, DRAWS_KIND, 5) == (double)(words[1] >> 11 | 1) * 0x1p-53);
}

// n uniform draws: their mean is 1/2 with a standard deviation of sqrt(1/12/n), their mean square 1/3 with sqrt(4/45/n).
static void units_are_inside_and_uniform(void **state)
{
    enum { N = 100000 };
    const draws from = { .seed = 1 };
    double sum = 0.0, squares = 0.0;
    for (uint64_t k = 0; k < N; k++) {
        const double u = draws_unit(&from, k, DRAWS_PLACE, k % 11);
        assert_true(u > 0.0 && u < 1.0);
        sum += u;
        squares += u * u;
    }
    assert_near(sum / N, 0.5, 4.0 * sqrt(1.0 / 12.0 / N));
    assert_near(squares / N, 1.0 / 3.0, 4.0 * sqrt(4.0 / 45.0 / N));
}

// An Erlang variate of mean 1 and shape k has the variance 1/k and, with the same words, is the mean of k exponential
// ones.
static void gaps_have_the_moments_of_erlang(void **state)
{
    enum { N = 100000 };
    const draws from = { .seed = 5, .source = 1 };
    static const uint32_t shapes[] = { 1, 2, 7 };
    for (size_t i = 0; i < 3; i++) {
        double sum = 0.0, squares = 0.0;
        for (uint64_t k = 0; k < N; k++) {
            const double gap = draws_gap(&from, k, shapes[i]);
            assert_true(gap > 0.0);
            sum += gap;
            squares += (gap - 1.0) * (gap - 1.0);
        }
        const double variance = 1.0 / shapes[i];
        assert_near(sum / N, 1.0, 4.0 * sqrt(variance / N));
        // The fourth central moment is 3 variance^2 + 6 variance^3.
        assert_near(squares / N, variance,
                    4.0 * sqrt((2.0 + 6.0 * variance) * variance * variance / N));
    }
    double words = 0.0;
    for (uint64_t k = 0; k < 7; k++)
        words -= log(draws_unit(&from, 42, DRAWS_GAP, k));
    assert_near(draws_gap(&from, 42, 7), words / 7.0, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(philox_gives_the_known_answers),
        cmocka_unit_test(a_draw_is_the_word_of_its_own_counter),
        cmocka_unit_test(units_are_inside_and_uniform),
        cmocka_unit_test(gaps_have_the_moments_of_erlang),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
