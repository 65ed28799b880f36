// Unit tests of the digest. Its values are not specified, only that different inputs have different digests.

#include "core/base/digest.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

enum { N = 100 };

static void equal_bytes_have_equal_digests_wherever_they_lie(void **state)
{
    unsigned char bytes[N + 8];

    for (size_t shift = 0; shift < 8; shift++) {
        for (size_t k = 0; k < N; k++)
            bytes[shift + k] = (unsigned char)(7 * k);
        static uint64_t first;
        uint64_t digest = digest_add(DIGEST_START, bytes + shift, N);
        first = shift == 0 ? digest : first;
        assert_true(digest == first);
    }
}

static void every_flipped_bit_changes_the_digest(void **state)
{
    unsigned char bytes[N];
    uint64_t seen[8 * N];

    memset(bytes, 0x5a, sizeof bytes);
    uint64_t whole = digest_add(DIGEST_START, bytes, N);
    for (size_t k = 0; k < sizeof seen / sizeof *seen; k++) {
        bytes[k / 8] ^= (unsigned char)(1U << k % 8);
        seen[k] = digest_add(DIGEST_START, bytes, N);
        bytes[k / 8] ^= (unsigned char)(1U << k % 8);
        assert_true(seen[k] != whole);
        for (size_t m = 0; m < k; m++)
            assert_true(seen[k] != seen[m]);
    }
}

static void a_torn_end_and_added_zeros_change_the_digest(void **state)
{
    unsigned char zeros[N] = { 0 };
    uint64_t seen[N];

    for (size_t n = 0; n < N; n++) {
        seen[n] = digest_add(DIGEST_START, zeros, n);
        for (size_t m = 0; m < n; m++)
            assert_true(seen[n] != seen[m]);
    }
}

static void swapped_words_change_the_digest(void **state)
{
    uint64_t words[2] = { 1, 2 }, swapped[2] = { 2, 1 };

    assert_true(digest_add(DIGEST_START, words, sizeof words) !=
                digest_add(DIGEST_START, swapped, sizeof swapped));
}

static void the_cuts_between_additions_count(void **state)
{
    uint64_t once = digest_add(DIGEST_START, "abcdefghijkl", 12);
    uint64_t twice = digest_add(digest_add(DIGEST_START, "abcd", 4), "efghijkl", 8);
    assert_true(once != twice);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_bytes_have_equal_digests_wherever_they_lie),
        cmocka_unit_test(every_flipped_bit_changes_the_digest),
        cmocka_unit_test(a_torn_end_and_added_zeros_change_the_digest),
        cmocka_unit_test(swapped_words_change_the_digest),
        cmocka_unit_test(the_cuts_between_additions_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
