// ZIP archives as streams.

#include "api/results/zip_out.h"

#include "core/base/memory.h"
#include "tests/unit/api/helper_unzip.h"
#include "tests/unit/helper_cmocka.h"

#include <stdbool.h>
#include <string.h>

enum { LARGE = 300000, MTIME_S = 1769860800 };

static char large[LARGE];

// Numbers of a linear congruence: nothing that deflates.
static int fill_large(void **unused)
{
    uint32_t x = 1;

    for (size_t i = 0; i < LARGE; i++) {
        x = x * 1664525 + 1013904223;
        large[i] = (char)(x >> 24);
    }
    return 0;
}

static bf_status write_archive(bf_buffer *out)
{
    zip_out *z = NULL;

    bf_status status = zip_out_create(MTIME_S, &z, NULL);
    if (status == BF_OK)
        status = zip_out_file(z, "folder/small.txt", 5, out, NULL);
    if (status == BF_OK)
        status = zip_out_bytes(z, "he", 2, out, NULL);
    if (status == BF_OK)
        status = zip_out_bytes(z, "llo", 3, out, NULL);
    if (status == BF_OK)
        status = zip_out_file(z, "empty", 0, out, NULL);
    if (status == BF_OK)
        status = zip_out_file(z, "large.bin", LARGE, out, NULL);
    if (status == BF_OK)
        status = zip_out_bytes(z, large, LARGE, out, NULL);
    if (status == BF_OK)
        status = zip_out_finish(z, out, NULL);
    zip_out_destroy(z);
    return status;
}

static void an_archive_holds_its_files(void **unused)
{
    unzip_file files[UNZIP_FILES_MAX];
    bf_buffer out = { 0 };

    assert_int_equal(write_archive(&out), BF_OK);
    size_t n = unzip_all(&out, files);
    assert_int_equal(n, 3);
    assert_string_equal(files[0].name, "folder/small.txt");
    assert_string_equal(files[0].content.bytes, "hello");
    assert_string_equal(files[1].name, "empty");
    assert_int_equal(files[1].content.n, 0);
    assert_int_equal(files[2].content.n, LARGE);
    assert_memory_equal(files[2].content.bytes, large, LARGE);
    for (size_t i = 0; i < n; i++)
        assert_int_equal(files[i].mtime_s, MTIME_S);
    unzip_fini(files, n);
    buffer_fini(&out);
}

// Input is output before the end, except what the compressor buffers.
static void bytes_come_out_while_a_file_goes_in(void **unused)
{
    bf_buffer out = { 0 };
    zip_out *z = NULL;

    assert_int_equal(zip_out_create(MTIME_S, &z, NULL), BF_OK);
    assert_int_equal(zip_out_file(z, "a", LARGE, &out, NULL), BF_OK);
    assert_true(out.n > 0); // the file's header
    assert_int_equal(zip_out_bytes(z, large, LARGE / 2, &out, NULL), BF_OK);
    assert_true(out.n + 100000 > LARGE / 2);
    zip_out_destroy(z);
    buffer_fini(&out);
}

static void an_archive_can_be_given_up_at_any_point(void **unused)
{
    bf_buffer out = { 0 };
    zip_out *z = NULL;

    assert_null(zip_out_destroy(NULL));
    assert_int_equal(zip_out_create(MTIME_S, &z, NULL), BF_OK);
    assert_null(zip_out_destroy(z));
    assert_int_equal(zip_out_create(MTIME_S, &z, NULL), BF_OK);
    assert_int_equal(zip_out_file(z, "a", 10, &out, NULL), BF_OK);
    assert_int_equal(zip_out_bytes(z, "0123", 4, &out, NULL), BF_OK);
    size_t n = out.n;
    assert_null(zip_out_destroy(z));
    assert_int_equal(out.n, n);
    buffer_fini(&out);
}

static void no_memory_is_said(void **unused)
{
    bf_status status = BF_ENOMEM;
    size_t n = 0;

    while (status != BF_OK) {
        bf_buffer out = { 0 };
        memory_plan_fault(++n, 0);
        status = write_archive(&out);
        bool has_struck = memory_faults() > 0;
        memory_plan_fault(0, 0);
        assert_int_equal(status, has_struck ? BF_ENOMEM : BF_OK);
        buffer_fini(&out);
        assert_true(n < 100);
    }
    assert_true(n > 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_archive_holds_its_files),
        cmocka_unit_test(bytes_come_out_while_a_file_goes_in),
        cmocka_unit_test(an_archive_can_be_given_up_at_any_point),
        cmocka_unit_test(no_memory_is_said),
    };
    return cmocka_run_group_tests(tests, fill_large, NULL);
}
