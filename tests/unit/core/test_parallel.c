// Unit tests of parallel loops.

#include "core/base/parallel.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

enum { ITEMS_MAX = 1000 };

static void count_item(void *context, size_t item)
{
    int *counts = context;
    counts[item]++;
}

static void every_item_is_done_once_for_any_number_of_threads(void **state)
{
    static const int n_threads[] = { -1, 0, 1, 2, 3, 7, 16 };
    static const size_t n_items[] = { 0, 1, 2, 5, ITEMS_MAX - 1 };

    (void)state;
    for (size_t t = 0; t < sizeof n_threads / sizeof *n_threads; t++) {
        for (size_t k = 0; k < sizeof n_items / sizeof *n_items; k++) {
            int counts[ITEMS_MAX] = { 0 };
            parallel_for(n_threads[t], n_items[k], count_item, counts);
            for (size_t m = 0; m < ITEMS_MAX; m++)
                assert_int_equal(counts[m], m < n_items[k]);
        }
    }
}

static void there_is_at_least_one_processor(void **state)
{
    (void)state;
    assert_true(parallel_processors() >= 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_item_is_done_once_for_any_number_of_threads),
        cmocka_unit_test(there_is_at_least_one_processor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
