// Unit tests of the envelope of checkpoints.

#include "core/base/checkpoint.h"
#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <stdlib.h>
#include <string.h>

enum { DEFINITION = 77, ENVELOPE_BYTES = 40 };

// A count, 0 at first and rewritten as 3, and three numbers.
static bf_buffer write_numbers(void)
{
    const uint64_t none = 0, three = 3, numbers[] = { 5, 6, 7 };
    bf_buffer out = { 0 };
    checkpoint_writer w;

    assert_int_equal(buffer_append(&out, "before", 6), BF_OK);
    checkpoint_begin(&w, &out, CHECKPOINT_MACRO, DEFINITION);
    const size_t at = checkpoint_at(&w);
    checkpoint_write(&w, &none, sizeof none);
    assert_int_equal(checkpoint_at(&w), at + sizeof none);
    checkpoint_write(&w, numbers, sizeof numbers);
    checkpoint_rewrite(&w, at, &three, sizeof three);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    buffer_drop(&out, 6);
    return out;
}

static bf_status open_numbers(checkpoint_reader *r, const char *bytes, size_t n)
{
    bf_error err = { .code = BF_OK };

    return checkpoint_open(r, bytes, n, CHECKPOINT_MACRO, DEFINITION, &err);
}

static void what_was_written_is_read(void **state)
{
    bf_buffer saved = write_numbers();
    checkpoint_reader r;
    uint64_t n = 0, number = 0;

    assert_int_equal(saved.n, ENVELOPE_BYTES + 4 * sizeof(uint64_t));
    assert_int_equal(open_numbers(&r, saved.bytes, saved.n), BF_OK);
    assert_true(checkpoint_read(&r, &n, sizeof n));
    assert_int_equal(n, 3);
    const char *items = checkpoint_read_items(&r, n, sizeof number);
    assert_non_null(items);
    memcpy(&number, items + 2 * sizeof number, sizeof number);
    assert_int_equal(number, 7);
    assert_int_equal(r.n_left, 0);
    buffer_fini(&saved);
}

static void nothing_is_read_beyond_the_end(void **state)
{
    bf_buffer saved = write_numbers();
    checkpoint_reader r;
    char five[33] = { 0 };

    assert_int_equal(open_numbers(&r, saved.bytes, saved.n), BF_OK);
    assert_false(checkpoint_read(&r, five, 33));
    assert_null(checkpoint_read_items(&r, UINT64_MAX / 4, 8)); // 8 times that overflows
    assert_int_equal(r.n_left, 32);
    buffer_fini(&saved);
}

static void every_damage_is_found(void **state)
{
    bf_buffer saved = write_numbers();
    checkpoint_reader r;

    for (size_t k = 0; k < saved.n; k++) {
        saved.bytes[k] ^= 1;
        assert_int_equal(open_numbers(&r, saved.bytes, saved.n), BF_ECORRUPT);
        saved.bytes[k] ^= 1;
        assert_int_equal(open_numbers(&r, saved.bytes, k), BF_ECORRUPT);
    }
    buffer_fini(&saved);
}

static void another_kind_or_definition_is_refused(void **state)
{
    bf_buffer saved = write_numbers();
    checkpoint_reader r;

    assert_int_equal(checkpoint_open(&r, saved.bytes, saved.n, CHECKPOINT_RUN, DEFINITION, NULL),
                     BF_ECORRUPT);
    assert_int_equal(
        checkpoint_open(&r, saved.bytes, saved.n, CHECKPOINT_MACRO, DEFINITION + 1, NULL),
        BF_ECORRUPT);
    buffer_fini(&saved);
}

static void without_memory_the_buffer_is_as_before(void **state)
{
    bf_buffer out = { 0 };
    checkpoint_writer w;
    static char large[4096];

    assert_int_equal(buffer_append(&out, "before", 6), BF_OK);
    checkpoint_begin(&w, &out, CHECKPOINT_MACRO, DEFINITION);
    memory_plan_fault(1, 0);
    checkpoint_write(&w, large, sizeof large);
    memory_plan_fault(0, 0);
    checkpoint_write(&w, large, 1);
    assert_int_equal(checkpoint_end(&w, NULL), BF_ENOMEM);
    assert_int_equal(out.n, 6);
    buffer_fini(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_written_is_read),
        cmocka_unit_test(nothing_is_read_beyond_the_end),
        cmocka_unit_test(every_damage_is_found),
        cmocka_unit_test(another_kind_or_definition_is_refused),
        cmocka_unit_test(without_memory_the_buffer_is_as_before),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
