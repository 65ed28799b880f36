// Unit tests of sets of blocks.

#include "core/macro/active_blocks.h"
#include "tests/unit/helper_cmocka.h"

#include <stdlib.h>
#include <string.h>

enum { N_BLOCKS = 200, WORDS = 4 };

static void runs_cover_exactly_the_blocks_of_a_set(void **state)
{
    srand(5);
    for (int round = 0; round < 200; round++) {
        uint64_t set[WORDS] = { 0 }, seen[WORDS] = { 0 };
        block_span run;
        ptrdiff_t b = -1, last = -2;
        int density = 1 + rand() % 10;
        assert_int_equal(block_set_words(N_BLOCKS), WORDS);
        for (ptrdiff_t k = -1; k < N_BLOCKS; k++)
            if (rand() % 10 < density)
                block_set_add(set, k);
        while (block_set_next_run(set, WORDS, &b, &run)) {
            assert_true(run.first > last && run.first < run.last);
            assert_true(run.last >= 64 * WORDS - 1 ||
                        (set[(run.last + 1) / 64] >> (run.last + 1) % 64 & 1) == 0);
            for (ptrdiff_t k = run.first; k < run.last; k++)
                block_set_add(seen, k);
            last = run.last;
        }
        assert_memory_equal(set, seen, sizeof set);
    }
}

static void a_span_word_holds_the_blocks_of_the_span(void **state)
{
    for (ptrdiff_t first = -1; first < 140; first += 7)
        for (ptrdiff_t last = first; last < 160; last += 5) {
            uint64_t expected[WORDS] = { 0 };
            for (ptrdiff_t k = first; k < last; k++)
                block_set_add(expected, k);
            for (size_t w = 0; w < WORDS; w++)
                assert_true(block_set_span_word((block_span){ first, last }, w) == expected[w]);
        }
}

static void shifting_down_moves_every_block_to_its_western_neighbour(void **state)
{
    for (ptrdiff_t k = 0; k < N_BLOCKS; k++) {
        uint64_t set[WORDS] = { 0 }, expected[WORDS] = { 0 };
        block_set_add(set, k);
        block_set_add(expected, k - 1);
        for (size_t w = 0; w < WORDS; w++)
            assert_true(block_set_shifted_down(set, WORDS, w) == expected[w]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(runs_cover_exactly_the_blocks_of_a_set),
        cmocka_unit_test(a_span_word_holds_the_blocks_of_the_span),
        cmocka_unit_test(shifting_down_moves_every_block_to_its_western_neighbour),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
