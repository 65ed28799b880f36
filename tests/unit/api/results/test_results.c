// The formats of results but for the summary (test_summary.c): what a reader of CSV, JSON and NumPy files finds in them.

#include "api/results/results.h"

#include "api/scenario/scenario.h"
#include "core/base/memory.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double times[] = { 0.0, 0.1, 0.30000000000000004 };
static const double counts[] = { 192.0, 0.0, 191.5, 0.5, 1.0 / 3.0, 1e-300 };

static void a_curve_is_lines_of_full_precision(void **unused)
{
    bf_buffer b = { 0 };

    assert_int_equal(results_curve_csv_header("upstream,left_domain", &b, NULL), BF_OK);
    assert_int_equal(results_curve_csv_rows(times, counts, 3, 2, &b, NULL), BF_OK);
    assert_string_equal(b.bytes, "t_s,upstream,left_domain\n0,192,0\n0.1,191.5,0.5\n"
                                 "0.30000000000000004,0.3333333333333333,1e-300\n");
    assert_int_equal(b.n, strlen(b.bytes));
    buffer_fini(&b);
}

static void a_written_curve_reads_back_to_the_same_bits(void **unused)
{
    bf_buffer b = { 0 };
    bf_buffer t = { 0 };
    bf_buffer parts = { 0 };

    assert_int_equal(results_curve_csv_header("upstream,left_domain", &b, NULL), BF_OK);
    assert_int_equal(results_curve_csv_rows(times, counts, 3, 2, &b, NULL), BF_OK);
    assert_int_equal(results_read_curve_csv(b.bytes, b.n, "left_domain", &t, &parts, NULL, NULL),
                     BF_OK);
    assert_int_equal(t.n, sizeof times);
    assert_memory_equal(t.bytes, times, sizeof times);
    const double expected[] = { 0.0, 0.5, 1e-300 };
    assert_memory_equal(parts.bytes, expected, sizeof expected);
    buffer_fini(&t);
    buffer_fini(&parts);
    assert_int_equal(results_read_curve_csv(b.bytes, b.n, NULL, &t, &parts, NULL, NULL), BF_OK);
    const double first[] = { 192.0, 191.5, 1.0 / 3.0 };
    assert_memory_equal(parts.bytes, first, sizeof first);
    buffer_fini(&t);
    buffer_fini(&parts);
    buffer_fini(&b);
}

static void curves_of_others_are_read_too(void **unused)
{
    static const char text[] = "\xef\xbb\xbft_s , count\r\n 0 , 5\r\n\r\n1e-1,+4.5e0 \r\n2,3\n\n";
    bf_buffer t = { 0 };
    bf_buffer parts = { 0 };
    bf_buffer lines = { 0 };
    char name[SCENE_ID_SIZE];

    assert_int_equal(results_read_curve_column(text, strlen(text), name, NULL), BF_OK);
    assert_string_equal(name, "count");
    assert_int_equal(results_read_curve_csv(text, strlen(text), "count", &t, &parts, &lines, NULL),
                     BF_OK);
    const size_t expected_lines[] = { 2, 4, 5 };
    assert_int_equal(lines.n, sizeof expected_lines);
    assert_memory_equal(lines.bytes, expected_lines, sizeof expected_lines);
    buffer_fini(&lines);
    const double expected_t[] = { 0.0, 0.1, 2.0 };
    const double expected[] = { 5.0, 4.5, 3.0 };
    assert_int_equal(t.n, sizeof expected_t);
    assert_memory_equal(t.bytes, expected_t, sizeof expected_t);
    assert_memory_equal(parts.bytes, expected, sizeof expected);
    buffer_fini(&t);
    buffer_fini(&parts);
}

static void bad_curves_are_refused_with_their_line(void **unused)
{
    static const struct {
        const char *text;
        const char *id;
        const char *place;
        const char *said;
    } bad[] = {
        { "", NULL, "/line/1", "" },
        { "time,count\n0,1\n", NULL, "/line/1", "" },
        { "t_s\n0\n", NULL, "/line/1", "" },
        { "t_s,a\n0,1\n", "b", "/line/1", "t_s,b" },
        { "t_s,a\n0,1\n1,x\n", NULL, "/line/3", "" },
        { "t_s,a\n0,1\n\n1\n", NULL, "/line/4", "" },
        { "t_s,a\n,1\n", NULL, "/line/2", "the time" },
        { "t_s,a\n0,nan\n", NULL, "/line/2", "" },
        { "t_s,a\n0,1e999\n", NULL, "/line/2", "" },
        { "t_s,a\n0,0x10\n", NULL, "/line/2", "" },
        { "t_s,a,b\n0,1\n", "b", "/line/2", "has 2 fields, the header has 3" },
        { "t_s,a\n0,1\n1,2,3\n", "a", "/line/3", "has 3 fields, the header has 2" },
        { "t_s,a\n0,1,\n", NULL, "/line/2", "has 3 fields, the header has 2" },
        { "t_s,a\n0,1111111111111111111111111111111111111111111111111111111111111111111111\n", NULL,
          "/line/2", "" },
    };

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        bf_buffer t = { 0 };
        bf_buffer parts = { 0 };
        bf_buffer lines = { 0 };
        bf_error err = { 0 };
        assert_int_equal(buffer_append(&t, "12345678", 8), BF_OK);
        assert_int_equal(results_read_curve_csv(bad[k].text, strlen(bad[k].text), bad[k].id, &t,
                                                &parts, &lines, &err),
                         BF_EINPUT);
        assert_string_equal(err.pointer, bad[k].place);
        assert_int_equal(lines.n, 0);
        buffer_fini(&lines);
        assert_non_null(strstr(err.text, bad[k].said));
        assert_int_equal(t.n, 8);
        assert_int_equal(parts.n, 0);
        buffer_fini(&t);
        buffer_fini(&parts);
    }
}

static api_curve make_curve(void)
{
    api_curve curve = { .n = 3, .n_columns = 2 };

    assert_int_equal(buffer_append(&curve.columns, "upstream,left_domain", 20), BF_OK);
    assert_int_equal(buffer_append(&curve.t, times, sizeof times), BF_OK);
    assert_int_equal(buffer_append(&curve.values, counts, sizeof counts), BF_OK);
    return curve;
}

static void a_curve_is_columns_in_json(void **unused)
{
    api_curve curve = make_curve();
    bf_buffer b = { 0 };

    assert_int_equal(results_curve_json(&curve, &b, NULL), BF_OK);
    assert_string_equal(b.bytes, "{\"t_s\":[0,0.1,0.30000000000000004],"
                                 "\"columns\":{\"upstream\":[192,191.5,0.3333333333333333],"
                                 "\"left_domain\":[0,0.5,1e-300]}}");
    buffer_fini(&b);
    api_curve_fini(&curve);
}

// Read as NumPy's format says: magic, version 1.0, two bytes of length, a dictionary padded with
// blanks to a multiple of 64 and ended by a newline, then the numbers, little-endian.
static void a_grid_is_a_numpy_file(void **unused)
{
    const float rho[] = { 0.0F, 1.0F, -2.5F, 0.1F, 3e38F, 1e-45F };
    bf_buffer b = { 0 };

    assert_int_equal(results_npy(rho, 3, 2, &b, NULL), BF_OK);
    const unsigned char *bytes = (const unsigned char *)b.bytes;
    assert_memory_equal(bytes, "\x93NUMPY\x01\x00", 8);
    size_t length = bytes[8] + 256U * bytes[9];
    assert_int_equal((10 + length) % 64, 0);
    assert_int_equal(bytes[10 + length - 1], '\n');
    assert_non_null(
        strstr(b.bytes + 10, "'descr': '<f4', 'fortran_order': False, 'shape': (2, 3)"));
    assert_int_equal(b.n, 10 + length + sizeof rho);
    for (size_t k = 0; k < sizeof rho / sizeof *rho; k++) {
        const unsigned char *at = bytes + 10 + length + 4 * k;
        uint32_t bits =
            at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
        assert_memory_equal(&bits, &rho[k], sizeof bits);
    }
    buffer_fini(&b);
}

// NumPy itself, where it is installed.
static void numpy_reads_the_grid(void **unused)
{
    const float rho[] = { 0.0F, 1.0F, 2.0F, 3.0F, 4.0F, 5.5F };
    char path[] = "/tmp/beltflow-test-XXXXXX";
    char command[300];
    bf_buffer b = { 0 };

    if (system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0)
        skip();
    assert_int_equal(results_npy(rho, 3, 2, &b, NULL), BF_OK);
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    FILE *file = fdopen(fd, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(b.bytes, 1, b.n, file), b.n);
    fclose(file);
    snprintf(command, sizeof command,
             "/usr/bin/python3 -c 'import numpy,sys; a=numpy.load(\"%s\"); "
             "sys.exit(not (a.dtype==\"<f4\" and a.tolist()==[[0,1,2],[3,4,5.5]]))'",
             path);
    assert_int_equal(system(command), 0);
    remove(path);
    buffer_fini(&b);
}

// Two snapshots, borrowed: nothing to be freed.
static api_snapshot_list make_list(void)
{
    static api_snapshot items[] = { { 0, 0.0, 1.25, 192.0 }, { 12, 0.1, 1.5, 191.5 } };

    return (api_snapshot_list){
        .grid = { .n1 = 200, .n2 = 120, .lower1 = -0.5, .d1 = 0.005, .d2 = 0.005 },
        .n = 2,
        .items = { .bytes = (char *)items, .n = sizeof items },
    };
}

static void snapshots_are_listed_with_their_grid(void **unused)
{
    api_snapshot_list list = make_list();
    bf_buffer files = { 0 };
    bf_buffer urls = { 0 };

    assert_int_equal(results_snapshots_json(&list, NULL, NULL, &files, NULL), BF_OK);
    assert_string_equal(
        files.bytes,
        "{\"grid\":{\"origin_m\":[-0.5,0],\"cell_m\":[0.005,0.005],\"shape\":[120,200]},"
        "\"snapshots\":[{\"n\":0,\"t_s\":0,\"file\":\"snapshots/000000.npy\",\"peak\":1.25,"
        "\"mass\":192},{\"n\":12,\"t_s\":0.1,\"file\":\"snapshots/000012.npy\",\"peak\":1.5,"
        "\"mass\":191.5}]}");
    assert_int_equal(results_snapshots_json(&list, "x", NULL, &urls, NULL), BF_OK);
    assert_non_null(strstr(urls.bytes, "\"url\":\"/v1/runs/x/snapshots/12\""));
    assert_null(strstr(urls.bytes, "file"));
    assert_null(strstr(urls.bytes, "parts"));
    buffer_fini(&files);
    buffer_fini(&urls);
}

static void snapshots_with_parts_say_where_they_are_and_what_their_columns_mean(void **unused)
{
    api_snapshot_list list = make_list();
    bf_buffer files = { 0 };
    bf_buffer urls = { 0 };

    list.parts = (api_parts){ .n_parts = 192, .n_values = FRAME_VALUES_PLANAR };
    assert_int_equal(results_snapshots_json(&list, NULL, NULL, &files, NULL), BF_OK);
    assert_non_null(strstr(files.bytes, "\"shape\":[120,200]},\"parts\":{\"rows\":192,\"columns\":["
                                        "\"x_m\",\"y_m\",\"heading_rad\",\"vx_m_s\",\"vy_m_s\","
                                        "\"spin_rad_s\"]},\"snapshots\":["));
    assert_non_null(strstr(files.bytes, "\"mass\":191.5,\"parts_file\":\"parts/000012.npy\"}]}"));
    list.parts.n_values = FRAME_VALUES_SPATIAL;
    assert_int_equal(results_snapshots_json(&list, "x", NULL, &urls, NULL), BF_OK);
    assert_non_null(strstr(urls.bytes, "\"parts_url\":\"/v1/runs/x/parts/12\""));
    assert_non_null(strstr(urls.bytes, "[\"x_m\",\"y_m\",\"z_m\",\"q_w\",\"q_x\",\"q_y\",\"q_z\","
                                       "\"vx_m_s\",\"vy_m_s\",\"vz_m_s\",\"wx_rad_s\","
                                       "\"wy_rad_s\",\"wz_rad_s\"]"));
    buffer_fini(&files);
    buffer_fini(&urls);
}

// Part 1 has left the domain.
static const double disk_rows[3 * FRAME_VALUES_PLANAR] = {
    0.5, 0.25, 0.125, 1.0, 2.0, -0.0625, NAN, NAN, NAN, NAN, NAN, NAN, 0.1, 0.2, 0, 0, 0, 3,
};
static const api_parts three_parts = { .n_parts = 3, .n_values = FRAME_VALUES_PLANAR };

static void parts_are_lines_with_their_numbers(void **unused)
{
    bf_buffer b = { 0 };

    assert_int_equal(results_parts_csv(disk_rows, &three_parts, &b, NULL), BF_OK);
    assert_string_equal(b.bytes, "part,x_m,y_m,heading_rad,vx_m_s,vy_m_s,spin_rad_s\n"
                                 "0,0.5,0.25,0.125,1,2,-0.0625\n"
                                 "1,nan,nan,nan,nan,nan,nan\n"
                                 "2,0.1,0.2,0,0,0,3\n");
    buffer_fini(&b);
}

static void a_part_that_has_left_is_null_in_json(void **unused)
{
    const api_snapshot snapshot = { .index = 4, .t = 0.5 };
    bf_buffer b = { 0 };

    assert_int_equal(results_parts_json(disk_rows, &three_parts, &snapshot, &b, NULL), BF_OK);
    assert_string_equal(b.bytes,
                        "{\"n\":4,\"t_s\":0.5,\"columns\":[\"x_m\",\"y_m\",\"heading_rad\","
                        "\"vx_m_s\",\"vy_m_s\",\"spin_rad_s\"],\"parts\":[[0.5,0.25,0.125,1,2,"
                        "-0.0625],null,[0.1,0.2,0,0,0,3]]}");
    buffer_fini(&b);
}

// Magic, version, a header that ends at a multiple of 64, and the doubles as they are.
static void parts_are_a_numpy_file_of_doubles(void **unused)
{
    bf_buffer b = { 0 };

    assert_int_equal(results_parts_npy(disk_rows, &three_parts, &b, NULL), BF_OK);
    assert_memory_equal(b.bytes, "\x93NUMPY\x01\x00", 8);
    assert_int_equal((b.n - sizeof disk_rows) % 64, 0);
    assert_non_null(strstr(b.bytes + 10, "'descr': '<f8', 'fortran_order': False, "
                                         "'shape': (3, 6)"));
    assert_memory_equal(b.bytes + b.n - sizeof disk_rows, disk_rows, sizeof disk_rows);
    buffer_fini(&b);
}

// Every function appends; what stood there before survives a failure.
static bf_status append_all(const api_curve *curve, bf_buffer *out, size_t which)
{
    static const float rho[64];
    api_snapshot_list list = make_list();
    const api_snapshot snapshot = { 0 };

    list.parts = (api_parts){ .n_parts = 1, .n_values = FRAME_VALUES_PLANAR };

    switch (which) {
    case 0:
        return results_curve_csv_header("a,b", out, NULL);
    case 1:
        return results_curve_csv_rows(times, counts, 3, 2, out, NULL);
    case 2:
        return results_curve_json(curve, out, NULL);
    case 3:
        return results_npy(rho, 8, 8, out, NULL);
    case 4:
        return results_snapshots_json(&list, NULL, NULL, out, NULL);
    case 5:
        return results_curve_csv(curve, out, NULL);
    case 6:
        return results_parts_npy(disk_rows, &three_parts, out, NULL);
    case 7:
        return results_parts_csv(disk_rows, &three_parts, out, NULL);
    default:
        return results_parts_json(disk_rows, &three_parts, &snapshot, out, NULL);
    }
}

static void no_memory_leaves_what_was_there(void **unused)
{
    api_curve curve = make_curve();

    for (size_t which = 0; which < 9; which++) {
        bf_status status = BF_ENOMEM;
        for (size_t n = 1; status != BF_OK; n++) {
            bf_buffer out = { 0 };
            assert_int_equal(buffer_append(&out, "0123456789", 10), BF_OK);
            memory_plan_fault(n, 0);
            status = append_all(&curve, &out, which);
            memory_plan_fault(0, 0);
            if (status != BF_OK) {
                assert_int_equal(status, BF_ENOMEM);
                assert_int_equal(out.n, 10);
            }
            assert_memory_equal(out.bytes, "0123456789", 10);
            assert_true(n < 2000);
            buffer_fini(&out);
        }
    }
    api_curve_fini(&curve);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_curve_is_lines_of_full_precision),
        cmocka_unit_test(a_written_curve_reads_back_to_the_same_bits),
        cmocka_unit_test(curves_of_others_are_read_too),
        cmocka_unit_test(bad_curves_are_refused_with_their_line),
        cmocka_unit_test(a_curve_is_columns_in_json),
        cmocka_unit_test(a_grid_is_a_numpy_file),
        cmocka_unit_test(numpy_reads_the_grid),
        cmocka_unit_test(snapshots_are_listed_with_their_grid),
        cmocka_unit_test(snapshots_with_parts_say_where_they_are_and_what_their_columns_mean),
        cmocka_unit_test(parts_are_lines_with_their_numbers),
        cmocka_unit_test(a_part_that_has_left_is_null_in_json),
        cmocka_unit_test(parts_are_a_numpy_file_of_doubles),
        cmocka_unit_test(no_memory_leaves_what_was_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
