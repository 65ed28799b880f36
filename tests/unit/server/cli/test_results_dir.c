// Unit tests of the results directory. Expected files are what api/results/results.h writes for the frames.

#include "server/cli/results_dir.h"

#include "core/base/buffer.h"
#include "core/base/memory.h"
#include "server/base/file_io.h"
#include "tests/unit/helper_cmocka.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { PATH_SIZE = 256, N1 = 3, N2 = 2 };

static char root[] = "/tmp/beltflow-results-XXXXXX";

static int make_root(void **state)
{
    strcpy(root, "/tmp/beltflow-results-XXXXXX");
    return mkdtemp(root) == NULL;
}

static int remove_root(void **state)
{
    char command[PATH_SIZE];
    snprintf(command, sizeof command, "rm -rf '%s'", root);
    return system(command);
}

static const char *path_in_root(const char *name)
{
    static char path[PATH_SIZE];

    snprintf(path, sizeof path, "%s/%s", root, name);
    return path;
}

static bool has_file(const char *name)
{
    return access(path_in_root(name), F_OK) == 0;
}

// The text of a file below the root; the caller's to free.
static bf_buffer read_text(const char *name)
{
    bf_buffer text = { 0 };

    assert_int_equal(file_io_read(path_in_root(name), NULL, 1 << 20, &text, NULL), BF_OK);
    return text;
}

static void assert_text(const char *name, const char *expected)
{
    bf_buffer text = read_text(name);

    assert_string_equal(text.bytes, expected);
    buffer_fini(&text);
}

static size_t count_files(const char *name)
{
    size_t n = 0;
    DIR *directory = opendir(path_in_root(name));

    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;)
        n += entry->d_name[0] != '.';
    closedir(directory);
    return n;
}

static results_dir *open_results(const char *name)
{
    results_dir *d = NULL;
    bf_error err = { 0 };

    if (results_dir_open(path_in_root(name), "upstream,left_domain", &d, &err) != BF_OK)
        fail_msg("%s", err.text);
    return d;
}

static bf_status give_begin(results_dir *d)
{
    frame f = { .type = FRAME_BEGIN,
                .begin = { .n_columns = 2, .grid = { .n1 = N1, .n2 = N2, .d1 = 0.5, .d2 = 0.5 } } };

    return results_dir_take(d, &f, NULL);
}

// Sample `index`: t = index / 2, 8 parts upstream, `index` gone.
static bf_status give_sample(results_dir *d, uint64_t index, bf_error *err)
{
    const double t = (double)index / 2.0, values[] = { 8.0, (double)index };
    frame f = { .type = FRAME_CURVE,
                .curve = { .first = index, .n = 1, .n_columns = 2, .t = &t, .values = values } };

    return results_dir_take(d, &f, err);
}

static bf_status give_snapshot(results_dir *d, uint64_t index, bf_error *err)
{
    const float rho[N1 * N2] = { 0.0F, 0.25F, 0.5F, 0.75F, 1.0F, (float)index };
    frame f = { .type = FRAME_SNAPSHOT,
                .snapshot = { .index = index, .t = 1.0, .n1 = N1, .n2 = N2, .rho = rho } };

    return results_dir_take(d, &f, err);
}

// Two parts of six values; the second has left.
static bf_status give_parts(results_dir *d, uint64_t index, bf_error *err)
{
    const double rows[2 * FRAME_VALUES_PLANAR] = { 0.5, 0.25, 0.125, 1.0, 2.0, (double)index,
                                                   NAN, NAN,  NAN,   NAN, NAN, NAN };
    frame f = { .type = FRAME_PARTS,
                .parts = { .index = index,
                           .t = 1.0,
                           .n_parts = 2,
                           .n_values = FRAME_VALUES_PLANAR,
                           .rows = rows } };

    return results_dir_take(d, &f, err);
}

static bf_status give_begin_with_parts(results_dir *d)
{
    frame f = { .type = FRAME_BEGIN,
                .begin = { .n_columns = 2,
                           .n_parts = 2,
                           .n_values = FRAME_VALUES_PLANAR,
                           .grid = { .n1 = N1, .n2 = N2, .d1 = 0.5, .d2 = 0.5 } } };

    return results_dir_take(d, &f, NULL);
}

// A run of a model with parts: n snapshots, each followed by them.
static void write_run_with_parts(const char *name, uint64_t n)
{
    results_dir *d = open_results(name);

    assert_int_equal(give_begin_with_parts(d), BF_OK);
    for (uint64_t i = 0; i < n; i++) {
        assert_int_equal(give_snapshot(d, i, NULL), BF_OK);
        assert_int_equal(give_parts(d, i, NULL), BF_OK);
    }
    assert_int_equal(results_dir_finish(d, "{}", 2, NULL), BF_OK);
    results_dir_close(d);
}

// A whole run with n snapshots and two samples.
static void write_run(const char *name, uint64_t n, const char *summary)
{
    results_dir *d = open_results(name);

    assert_int_equal(results_dir_scenario(d, "{\"n\":1}", 7, NULL), BF_OK);
    assert_int_equal(give_begin(d), BF_OK);
    assert_int_equal(give_sample(d, 0, NULL), BF_OK);
    assert_int_equal(give_sample(d, 1, NULL), BF_OK);
    for (uint64_t i = 0; i < n; i++)
        assert_int_equal(give_snapshot(d, i, NULL), BF_OK);
    assert_int_equal(results_dir_finish(d, summary, summary == NULL ? 0 : strlen(summary), NULL),
                     BF_OK);
    results_dir_close(d);
}

static void a_finished_run_leaves_its_five_kinds_of_files(void **state)
{
    write_run("deep/er/out", 2, "{\"model\":\"macro\"}");
    assert_text("deep/er/out/curve.csv", "t_s,upstream,left_domain\n0,8,0\n0.5,8,1\n");
    assert_text("deep/er/out/summary.json", "{\"model\":\"macro\"}");
    assert_true(has_file("deep/er/out/snapshots.json"));
    assert_int_equal(count_files("deep/er/out/snapshots"), 2);
    assert_int_equal(count_files("deep/er/out"), 5);
    assert_text("deep/er/out/scenario.json", "{\"n\":1}");
    bf_buffer npy = read_text("deep/er/out/snapshots/000001.npy");
    float last;
    assert_memory_equal(npy.bytes, "\x93NUMPY", 6);
    memcpy(&last, npy.bytes + npy.n - sizeof last, sizeof last);
    assert_true(last == 1.0F); // its index, by give_snapshot()
    buffer_fini(&npy);
}

static void a_stopped_run_has_no_summary(void **state)
{
    write_run("out", 1, NULL);
    assert_true(has_file("out/curve.csv"));
    assert_true(has_file("out/snapshots.json"));
    assert_true(has_file("out/snapshots/000000.npy"));
    assert_false(has_file("out/summary.json"));
}

static void a_new_run_leaves_nothing_of_the_one_before(void **state)
{
    write_run("out", 5, "{}");
    int fd = open(path_in_root("out/snapshots"), O_RDONLY | O_DIRECTORY);
    assert_int_equal(file_io_replace(fd, "notes.npy", "x", 1, FILE_IO_LATER, NULL), BF_OK);
    close(fd);

    results_dir *d = open_results("out");
    assert_false(has_file("out/summary.json")); // from the first moment on: not complete
    assert_false(has_file("out/scenario.json"));
    results_dir_close(d);
    write_run("out", 2, "{}");
    assert_int_equal(count_files("out/snapshots"), 3); // two, and what is not a snapshot of ours
    assert_true(has_file("out/snapshots/notes.npy"));
}

static void parts_have_a_folder_of_their_own(void **state)
{
    write_run_with_parts("out", 3);
    assert_int_equal(count_files("out"), 5); // without a scenario, but with parts
    assert_int_equal(count_files("out/parts"), 3);
    bf_buffer npy = read_text("out/parts/000002.npy"), list = read_text("out/snapshots.json");
    double spin;
    assert_memory_equal(npy.bytes, "\x93NUMPY", 6);
    memcpy(&spin, npy.bytes + npy.n - (FRAME_VALUES_PLANAR + 1) * sizeof spin, sizeof spin);
    assert_true(spin == 2.0); // its index, by give_parts()
    assert_non_null(strstr(list.bytes, "\"parts\":{\"rows\":2,\"columns\":[\"x_m\","));
    assert_non_null(strstr(list.bytes, "\"parts_file\":\"parts/000002.npy\""));
    buffer_fini(&npy);
    buffer_fini(&list);
}

static void no_parts_of_an_earlier_run_are_left(void **state)
{
    write_run_with_parts("out", 5);
    write_run_with_parts("out", 2);
    assert_int_equal(count_files("out/parts"), 2);
    write_run("out", 2, "{}");
    assert_false(has_file("out/parts"));
    bf_buffer list = read_text("out/snapshots.json");
    assert_null(strstr(list.bytes, "parts"));
    buffer_fini(&list);
}

// Files of others are not removed, nor is the folder then.
static void files_of_others_among_the_parts_stay(void **state)
{
    write_run_with_parts("out", 2);
    int fd = open(path_in_root("out/parts"), O_RDONLY | O_DIRECTORY);
    assert_int_equal(file_io_replace(fd, "notes.txt", "x", 1, FILE_IO_LATER, NULL), BF_OK);
    close(fd);
    write_run("out", 1, "{}");
    assert_int_equal(count_files("out/parts"), 1);
    assert_true(has_file("out/parts/notes.txt"));
}

static void lines_can_be_read_while_the_run_goes_on(void **state)
{
    results_dir *d = open_results("out");
    assert_int_equal(give_begin(d), BF_OK);
    assert_int_equal(give_sample(d, 0, NULL), BF_OK);
    assert_text("out/curve.csv", "t_s,upstream,left_domain\n0,8,0\n");
    results_dir_close(d);
}

static void a_second_writer_is_refused(void **state)
{
    results_dir *second = NULL;
    bf_error err = { 0 };

    results_dir *first = open_results("out");
    assert_int_equal(results_dir_open(path_in_root("out"), "upstream,left_domain", &second, &err),
                     BF_ESYSTEM);
    assert_null(second);
    assert_non_null(strstr(err.text, "another program"));
    results_dir_close(first);
    results_dir_close(open_results("out"));
}

static void a_path_that_cannot_be_a_directory_is_an_error(void **state)
{
    static const char *const paths[] = { "", "/dev/null/out", "/proc/beltflow" };
    results_dir *d = NULL;

    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        bf_error err = { 0 };
        assert_int_equal(results_dir_open(paths[i], "a,left_domain", &d, &err), BF_ESYSTEM);
        assert_int_equal(err.code, BF_ESYSTEM);
        assert_null(d);
    }
}

// A limit on the size of files stands for a full disk. The header has 25 bytes and the first sample
// 6; the limit falls into the second sample's line.
static void a_full_disk_leaves_no_half_line_and_no_half_file(void **state)
{
    struct rlimit before, limit;
    bf_error err = { 0 };

    results_dir *d = open_results("out");
    assert_int_equal(give_begin(d), BF_OK);
    assert_int_equal(give_sample(d, 0, NULL), BF_OK);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    limit = before;
    limit.rlim_cur = 34;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    assert_int_equal(give_sample(d, 1, &err), BF_ESYSTEM);
    assert_int_equal(give_snapshot(d, 0, &err), BF_ESYSTEM);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_non_null(strstr(err.text, strerror(EFBIG)));
    assert_text("out/curve.csv", "t_s,upstream,left_domain\n0,8,0\n");
    assert_int_equal(count_files("out/snapshots"), 0);
    // When there is room again, the curve goes on where it stopped.
    assert_int_equal(give_sample(d, 1, NULL), BF_OK);
    assert_text("out/curve.csv", "t_s,upstream,left_domain\n0,8,0\n0.5,8,1\n");
    results_dir_close(d);
}

static bf_status write_short_run(results_dir **ret_d)
{
    bf_status status = results_dir_open(path_in_root("out"), "upstream,left_domain", ret_d, NULL);

    if (status == BF_OK)
        status = give_begin_with_parts(*ret_d);
    if (status == BF_OK)
        status = give_sample(*ret_d, 0, NULL);
    if (status == BF_OK)
        status = give_snapshot(*ret_d, 0, NULL);
    if (status == BF_OK)
        status = give_parts(*ret_d, 0, NULL);
    return status == BF_OK ? results_dir_finish(*ret_d, "{}", 2, NULL) : status;
}

static void without_memory_it_fails_and_frees_everything(void **state)
{
    bf_status status = BF_ENOMEM;

    for (size_t n = 1; status != BF_OK; n++) {
        results_dir *d = NULL;
        memory_plan_fault(n, 0);
        status = write_short_run(&d);
        assert_true(status == BF_OK || status == BF_ENOMEM);
        results_dir_close(d);
    }
    memory_plan_fault(0, 0);
    assert_text("out/summary.json", "{}");
}

int main(void)
{
#define TEST(function) cmocka_unit_test_setup_teardown(function, make_root, remove_root)
    const struct CMUnitTest tests[] = {
        TEST(a_finished_run_leaves_its_five_kinds_of_files),
        TEST(a_stopped_run_has_no_summary),
        TEST(a_new_run_leaves_nothing_of_the_one_before),
        TEST(parts_have_a_folder_of_their_own),
        TEST(no_parts_of_an_earlier_run_are_left),
        TEST(files_of_others_among_the_parts_stay),
        TEST(lines_can_be_read_while_the_run_goes_on),
        TEST(a_second_writer_is_refused),
        TEST(a_path_that_cannot_be_a_directory_is_an_error),
        TEST(a_full_disk_leaves_no_half_line_and_no_half_file),
        TEST(without_memory_it_fails_and_frees_everything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
