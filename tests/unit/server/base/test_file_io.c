// Unit tests of reading and replacing whole files.

#include "server/base/file_io.h"

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char root[] = "/tmp/beltflow-files-XXXXXX";
static char path[64];
static int directory = -1;

static int make_root(void **state)
{
    strcpy(root, "/tmp/beltflow-files-XXXXXX");
    if (mkdtemp(root) == NULL)
        return -1;
    snprintf(path, sizeof path, "%s/name", root);
    directory = open(root, O_RDONLY | O_DIRECTORY);
    return directory < 0;
}

static int remove_root(void **state)
{
    unlink(path);
    close(directory);
    return rmdir(root); // fails if anything else was left
}

static void assert_holds(const char *text)
{
    bf_buffer bytes = { 0 };

    assert_int_equal(file_io_read(path, NULL, 100, &bytes, NULL), BF_OK);
    assert_string_equal(bytes.bytes, text);
    buffer_fini(&bytes);
}

static void a_file_is_replaced_as_a_whole(void **state)
{
    assert_int_equal(file_io_replace(directory, "name", "first", 5, FILE_IO_NOW, NULL), BF_OK);
    assert_holds("first");
    assert_int_equal(file_io_replace(directory, "name", "2", 1, FILE_IO_LATER, NULL), BF_OK);
    assert_holds("2");
}

static void a_name_that_cannot_be_written_is_an_error(void **state)
{
    bf_error err = { 0 };

    assert_int_equal(file_io_replace(directory, "no/name", "x", 1, FILE_IO_NOW, &err), BF_ESYSTEM);
    assert_int_equal(err.code, BF_ESYSTEM);
    assert_int_equal(file_io_replace(-1, "name", "x", 1, FILE_IO_NOW, &err), BF_ESYSTEM);
}

static void a_directory_stands_for_a_file_in_it(void **state)
{
    bf_buffer bytes = { 0 };

    assert_int_equal(file_io_replace(directory, "name", "in it", 5, FILE_IO_LATER, NULL), BF_OK);
    assert_int_equal(file_io_read(root, "name", 100, &bytes, NULL), BF_OK);
    assert_string_equal(bytes.bytes, "in it");
    assert_int_equal(file_io_read(root, "other", 100, &bytes, NULL), BF_EINPUT);
    assert_int_equal(file_io_read(root, NULL, 100, &bytes, NULL), BF_EINPUT);
    buffer_fini(&bytes);
}

// What was in the buffer stays, and nothing is added to it.
static void reading_stops_at_its_limit(void **state)
{
    bf_buffer bytes = { 0 };
    bf_error err = { 0 };

    assert_int_equal(file_io_replace(directory, "name", "12345", 5, FILE_IO_LATER, NULL), BF_OK);
    assert_int_equal(buffer_append(&bytes, "0", 1), BF_OK);
    assert_int_equal(file_io_read(path, NULL, 4, &bytes, &err), BF_ELIMIT);
    assert_int_equal(bytes.n, 1);
    assert_non_null(strstr(err.text, "limit of 4 bytes"));
    assert_int_equal(file_io_read("/dev/zero", NULL, 1 << 20, &bytes, &err), BF_ELIMIT);
    assert_int_equal(bytes.n, 1);
    assert_int_equal(file_io_read(path, NULL, 5, &bytes, NULL), BF_OK);
    assert_string_equal(bytes.bytes, "012345");
    buffer_fini(&bytes);
}

static void without_memory_nothing_is_read(void **state)
{
    bf_buffer bytes = { 0 };

    assert_int_equal(file_io_replace(directory, "name", "x", 1, FILE_IO_LATER, NULL), BF_OK);
    memory_plan_fault(1, 1);
    assert_int_equal(file_io_read(path, NULL, 100, &bytes, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_int_equal(bytes.n, 0);
    buffer_fini(&bytes);
}

int main(void)
{
#define TEST(function) cmocka_unit_test_setup_teardown(function, make_root, remove_root)
    const struct CMUnitTest tests[] = {
        TEST(a_file_is_replaced_as_a_whole),       TEST(a_name_that_cannot_be_written_is_an_error),
        TEST(a_directory_stands_for_a_file_in_it), TEST(reading_stops_at_its_limit),
        TEST(without_memory_nothing_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
