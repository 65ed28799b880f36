// Unit tests of growing runs of bytes.

#include "core/base/buffer.h"

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static void appended_bytes_stand_in_order_and_end_in_zero(void **state)
{
    bf_buffer b = { 0 };

    assert_int_equal(buffer_append(&b, "ab", 2), BF_OK);
    assert_int_equal(buffer_append(&b, NULL, 0), BF_OK);
    assert_int_equal(buffer_append(&b, "c\0d", 3), BF_OK);
    assert_int_equal(b.n, 5);
    assert_memory_equal(b.bytes, "abc\0d", 6);
    buffer_fini(&b);
    assert_null(b.bytes);
    assert_int_equal(b.n, 0);
}

static void formatted_text_of_any_length_is_appended(void **state)
{
    bf_buffer b = { 0 };

    assert_int_equal(buffer_printf(&b, "%d-", 7), BF_OK);
    assert_int_equal(buffer_printf(&b, "%5000d", 1), BF_OK);
    assert_int_equal(b.n, 5002);
    assert_int_equal(strlen(b.bytes), 5002);
    assert_memory_equal(b.bytes, "7- ", 3);
    assert_int_equal(b.bytes[5001], '1');
    buffer_fini(&b);
}

static void reserved_room_lies_behind_what_is_there(void **state)
{
    bf_buffer b = { 0 };

    assert_int_equal(buffer_append(&b, "ab", 2), BF_OK);
    char *end = buffer_reserve(&b, 1000);
    assert_ptr_equal(end, b.bytes + 2);
    memset(end, 'x', 1000);
    b.n += 1000;
    assert_memory_equal(b.bytes, "abxx", 4);
    buffer_fini(&b);
}

static void dropped_bytes_are_gone_from_the_front(void **state)
{
    bf_buffer b = { 0 };

    buffer_drop(&b, 0);
    assert_int_equal(buffer_append(&b, "abcdef", 6), BF_OK);
    buffer_drop(&b, 2);
    assert_string_equal(b.bytes, "cdef");
    buffer_drop(&b, 4);
    assert_int_equal(b.n, 0);
    assert_string_equal(b.bytes, "");
    buffer_fini(&b);
}

static void truncated_bytes_are_gone_from_the_end(void **state)
{
    bf_buffer b = { 0 };

    buffer_truncate(&b, 0);
    assert_null(b.bytes);
    assert_int_equal(buffer_append(&b, "abcdef", 6), BF_OK);
    buffer_truncate(&b, 6);
    buffer_truncate(&b, 2);
    assert_int_equal(b.n, 2);
    assert_string_equal(b.bytes, "ab");
    buffer_fini(&b);
}

static void without_memory_the_buffer_is_as_before(void **state)
{
    bf_buffer b = { 0 };
    char many[100] = { 0 };

    assert_int_equal(buffer_append(&b, "ab", 2), BF_OK);
    memory_plan_fault(1, 1);
    assert_int_equal(buffer_append(&b, many, sizeof many), BF_ENOMEM);
    assert_int_equal(buffer_printf(&b, "%100d", 1), BF_ENOMEM);
    assert_null(buffer_reserve(&b, 100));
    memory_plan_fault(0, 0);
    assert_null(buffer_reserve(&b, SIZE_MAX));
    assert_null(buffer_reserve(&b, SIZE_MAX - 2));
    assert_int_equal(b.n, 2);
    assert_string_equal(b.bytes, "ab");
    buffer_fini(&b);
    buffer_fini(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(appended_bytes_stand_in_order_and_end_in_zero),
        cmocka_unit_test(formatted_text_of_any_length_is_appended),
        cmocka_unit_test(reserved_room_lies_behind_what_is_there),
        cmocka_unit_test(dropped_bytes_are_gone_from_the_front),
        cmocka_unit_test(truncated_bytes_are_gone_from_the_end),
        cmocka_unit_test(without_memory_the_buffer_is_as_before),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
