// Unit tests of the random generator. The first numbers are those of the authors' reference code.

#include "core/base/random.h"
#include "tests/unit/helper_cmocka.h"

static void splitmix_and_xoshiro_give_the_published_sequences(void **state)
{
    bf_random random;

    // splitmix64 from 1234567, the test vector that is in wide use.
    random_init(&random, 1234567);
    assert_true(random.state[0] == UINT64_C(6457827717110365317));
    assert_true(random.state[1] == UINT64_C(3203168211198807973));
    // xoshiro256** from the state 1, 2, 3, 4: by hand, rotl(2 * 5, 7) * 9 = 1280 * 9; then state[1]
    // is 0, hence 0; then state[1] is 2^18 + 1 shifted as in the next line.
    random = (bf_random){ { 1, 2, 3, 4 } };
    assert_true(random_bits(&random) == 11520);
    assert_true(random_bits(&random) == 0);
    assert_true(random_bits(&random) == 1509978240);
    assert_true(random_bits(&random) == 1215971899390074240);
}

static void numbers_are_uniform_between_0_and_1(void **state)
{
    enum { N = 100000, BINS = 10 };
    int counts[BINS] = { 0 };
    bf_random random;

    random_init(&random, 0);
    for (int k = 0; k < N; k++) {
        double x = random_unit(&random);
        assert_true(x >= 0.0 && x < 1.0);
        counts[(int)(x * BINS)]++;
    }
    // A bin has N/BINS with standard deviation sqrt(0.09 N) = 95; five of them are allowed.
    for (int b = 0; b < BINS; b++)
        assert_in_range(counts[b], N / BINS - 475, N / BINS + 475);
}

static void different_seeds_give_different_sequences(void **state)
{
    bf_random a, b;

    random_init(&a, 1);
    random_init(&b, 2);
    assert_true(random_bits(&a) != random_bits(&b));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(splitmix_and_xoshiro_give_the_published_sequences),
        cmocka_unit_test(numbers_are_uniform_between_0_and_1),
        cmocka_unit_test(different_seeds_give_different_sequences),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
