// Unit tests of memory with planned faults.

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <stdlib.h>
#include <string.h>

static void room_is_zeroed_and_aligned_to_cache_lines(void **state)
{
    for (size_t n = 0; n < 200; n++) {
        unsigned char *block = memory_alloc(n, 3);
        assert_non_null(block);
        assert_int_equal((uintptr_t)block % 64, 0);
        for (size_t k = 0; k < 3 * n; k++)
            assert_int_equal(block[k], 0);
        memset(block, 0xff, 3 * n);
        memory_free(block);
    }
}

static void a_size_that_overflows_is_no_memory(void **state)
{
    assert_null(memory_alloc(SIZE_MAX / 2 + 2, 2));
    assert_null(memory_alloc(SIZE_MAX, 1));
    assert_null(memory_alloc(1, SIZE_MAX - 10));
}

static void freeing_nothing_is_fine(void **state)
{
    memory_free(NULL);
}

static void reserved_memory_grows_by_a_quarter_and_retains_its_content(void **state)
{
    int *items = NULL;
    size_t capacity = 0, n_moves = 0;

    for (int k = 0; k < 1000; k++) {
        int *before = items;
        assert_int_equal(memory_reserve(&items, &capacity, (size_t)k + 1, sizeof *items), 0);
        n_moves += items != before;
        items[k] = k;
    }
    for (int k = 0; k < 1000; k++)
        assert_int_equal(items[k], k);
    // 16, 20, 25, 31, ... 828, 1035.
    assert_int_equal(n_moves, 20);
    assert_int_equal(capacity, 1035);
    memory_free(items);
}

static void a_failed_reservation_leaves_everything(void **state)
{
    char *items = NULL;
    size_t capacity = 0;

    assert_int_equal(memory_reserve(&items, &capacity, 5, 1), 0);
    char *before = items;
    items[4] = 'x';
    assert_int_equal(memory_reserve(&items, &capacity, SIZE_MAX, 1), -1);
    memory_plan_fault(1, 0);
    assert_int_equal(memory_reserve(&items, &capacity, 1000, 1), -1);
    memory_plan_fault(0, 0);
    assert_ptr_equal(items, before);
    assert_int_equal(capacity, 16);
    assert_int_equal(items[4], 'x');
    memory_free(items);
}

static void arrays_share_a_block_one_task_after_the_other(void **state)
{
    memory_block block = { 0 };
    double *a = NULL;
    char *b = NULL, *c = NULL;
    const memory_array first[] = { { &a, sizeof *a, 0, 3 }, { &b, 1, 0, 65 } };
    const memory_array second[] = { { &a, sizeof *a, 3, 3 }, { &c, 1, 0, 1000 } };
    const memory_array too_large[] = { { &a, sizeof *a, 3, SIZE_MAX / 2 } };

    assert_int_equal(memory_lay_out(&block, first, 2), 0);
    assert_int_equal((uintptr_t)b % 64, 0);
    assert_true(b - (char *)a >= 3 * (ptrdiff_t)sizeof *a);
    for (int k = 0; k < 3; k++)
        a[k] = k;
    memset(b, 1, 65);
    // The second task needs more room: what stays is copied.
    assert_int_equal(memory_lay_out(&block, second, 2), 0);
    memset(c, 2, 1000);
    assert_true(a[0] == 0.0 && a[1] == 1.0 && a[2] == 2.0);
    memory_plan_fault(1, 0);
    assert_int_equal(memory_lay_out(&block, too_large, 1), -1);
    memory_plan_fault(0, 0);
    assert_true(a[2] == 2.0);
    // Less room is that of before.
    const double *before = a;
    assert_int_equal(memory_lay_out(&block, first, 2), 0);
    assert_ptr_equal(a, before);
    memory_free(block.bytes);
}

/// Whether the next n allocations succeed, as a string of '+' and '-'.
static const char *try_allocations(size_t n)
{
    static char outcome[16];

    for (size_t k = 0; k < n; k++) {
        void *block = memory_alloc(1, 1);
        outcome[k] = block != NULL ? '+' : '-';
        memory_free(block);
    }
    outcome[n] = '\0';
    return outcome;
}

static void a_planned_fault_strikes_once_or_for_good(void **state)
{
    memory_plan_fault(3, 0);
    assert_string_equal(try_allocations(6), "++-+++");
    assert_int_equal(memory_faults(), 1);
    memory_plan_fault(3, 1);
    assert_string_equal(try_allocations(6), "++----");
    assert_int_equal(memory_faults(), 4);
    memory_plan_fault(0, 1);
    assert_string_equal(try_allocations(6), "++++++");
    assert_int_equal(memory_faults(), 0);
}

static void plain_memory_is_freed_as_malloc_gave_it(void **state)
{
    memory_plan_fault(2, 0);
    void *first = memory_alloc_plain(10);
    void *second = memory_alloc_plain(10);
    memory_plan_fault(0, 0);
    assert_non_null(first);
    assert_null(second);
    free(first);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(room_is_zeroed_and_aligned_to_cache_lines),
        cmocka_unit_test(a_size_that_overflows_is_no_memory),
        cmocka_unit_test(freeing_nothing_is_fine),
        cmocka_unit_test(reserved_memory_grows_by_a_quarter_and_retains_its_content),
        cmocka_unit_test(arrays_share_a_block_one_task_after_the_other),
        cmocka_unit_test(a_failed_reservation_leaves_everything),
        cmocka_unit_test(a_planned_fault_strikes_once_or_for_good),
        cmocka_unit_test(plain_memory_is_freed_as_malloc_gave_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
