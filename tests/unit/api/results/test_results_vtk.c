// Files for VTK and ParaView: headers as their readers want them, and the bytes behind.

#include "api/results/results.h"

#include "tests/unit/api/helper_appender.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bf_grid grid = {
    .n1 = 3, .n2 = 2, .lower1 = -0.5, .lower2 = 0.25, .d1 = 0.1, .d2 = 0.2
};
static const float rho[] = { 0.0F, 0.5F, 1.0F, 1.5F, 2.0F, 0.25F };

// Three parts: x, y, heading, vx, vy, spin. The second has left.
static const double disk_rows[] = {
    1, 2, 3, 4, 5, 6, NAN, NAN, NAN, NAN, NAN, NAN, 7, 8, 9, 10, 11, 12,
};
static const api_parts planar = { .n_parts = 3, .n_values = FRAME_VALUES_PLANAR };

// One part: position, quaternion, velocity, spin.
static const double body_rows[] = { 1, 2, 3, 0.5, 0.25, 0.125, 0.75, 4, 5, 6, 7, 8, 9 };
static const api_parts spatial = { .n_parts = 1, .n_values = FRAME_VALUES_SPATIAL };

// The bytes behind the underscore that the offsets count from.
static const char *data_of(const bf_buffer *file)
{
    static const char start[] = "<AppendedData encoding=\"raw\">\n_";
    const char *at = strstr(file->bytes, start);

    assert_non_null(at);
    return at + sizeof start - 1;
}

// The block of the array that a header names: its length is checked.
static const char *block_of(const bf_buffer *file, const char *name, uint64_t n_bytes)
{
    char text[64];
    uint64_t length;

    snprintf(text, sizeof text, "Name=\"%s\"", name);
    const char *at = strstr(file->bytes, text);
    assert_non_null(at);
    at = strstr(at, "offset=\"");
    assert_non_null(at);
    const char *block = data_of(file) + strtoull(at + 8, NULL, 10);
    memcpy(&length, block, sizeof length);
    assert_int_equal(length, n_bytes);
    return block + sizeof length;
}

static void assert_has(const bf_buffer *file, const char *text)
{
    if (strstr(file->bytes, text) == NULL)
        fail_msg("no %s in %s", text, file->bytes);
}

static void assert_ends(const bf_buffer *file)
{
    static const char end[] = "\n</AppendedData>\n</VTKFile>\n";

    assert_memory_equal(file->bytes + file->n - sizeof end + 1, end, sizeof end - 1);
}

static void a_snapshot_is_an_image_of_cells(void **unused)
{
    bf_buffer file = { 0 };

    assert_int_equal(results_snapshot_vti(rho, &grid, 0.1, &file, NULL), BF_OK);
    assert_has(&file, "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                      "header_type=\"UInt64\">");
    assert_has(&file, "WholeExtent=\"0 3 0 2 0 0\" Origin=\"-0.5 0.25 0\" Spacing=\"0.1 0.2 1\"");
    assert_has(&file, "Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">0.1</DataArray>");
    assert_has(&file, "<Piece Extent=\"0 3 0 2 0 0\">\n<CellData Scalars=\"density\">");
    assert_memory_equal(block_of(&file, "density", sizeof rho), rho, sizeof rho);
    assert_ptr_equal(block_of(&file, "density", sizeof rho) + sizeof rho,
                     file.bytes + file.n - strlen("\n</AppendedData>\n</VTKFile>\n"));
    assert_ends(&file);
    buffer_fini(&file);
}

static void disk_parts_are_points_in_the_plane(void **unused)
{
    bf_buffer file = { 0 };
    static const double position[] = { 1, 2, 0, 7, 8, 0 }, velocity[] = { 4, 5, 0, 10, 11, 0 };
    static const double heading[] = { 3, 9 }, spin[] = { 6, 12 };
    static const int32_t part[] = { 0, 2 }, from_0[] = { 0, 1 }, from_1[] = { 1, 2 };

    assert_int_equal(results_parts_vtp(disk_rows, &planar, 2.5, &file, NULL), BF_OK);
    assert_has(&file, "<VTKFile type=\"PolyData\"");
    assert_has(&file, "<Piece NumberOfPoints=\"2\" NumberOfVerts=\"2\"");
    assert_has(&file, ">2.5</DataArray>");
    assert_memory_equal(block_of(&file, "position_m", 48), position, 48);
    assert_memory_equal(block_of(&file, "velocity_m_s", 48), velocity, 48);
    assert_memory_equal(block_of(&file, "heading_rad", 16), heading, 16);
    assert_memory_equal(block_of(&file, "spin_rad_s", 16), spin, 16);
    assert_memory_equal(block_of(&file, "part", 8), part, 8);
    assert_memory_equal(block_of(&file, "connectivity", 8), from_0, 8);
    assert_memory_equal(block_of(&file, "offsets", 8), from_1, 8);
    assert_ends(&file);
    buffer_fini(&file);
}

static void body_parts_have_their_quaternion(void **unused)
{
    bf_buffer file = { 0 };

    assert_int_equal(results_parts_vtp(body_rows, &spatial, 0.0, &file, NULL), BF_OK);
    assert_has(&file, "Name=\"quaternion_wxyz\" NumberOfComponents=\"4\"");
    assert_memory_equal(block_of(&file, "position_m", 24), &body_rows[0], 24);
    assert_memory_equal(block_of(&file, "quaternion_wxyz", 32), &body_rows[3], 32);
    assert_memory_equal(block_of(&file, "velocity_m_s", 24), &body_rows[7], 24);
    assert_memory_equal(block_of(&file, "spin_rad_s", 24), &body_rows[10], 24);
    buffer_fini(&file);
}

static void when_all_parts_have_left_there_are_no_points(void **unused)
{
    const api_parts one = { .n_parts = 1, .n_values = FRAME_VALUES_PLANAR };
    bf_buffer file = { 0 };

    assert_int_equal(results_parts_vtp(disk_rows + 6, &one, 0.0, &file, NULL), BF_OK);
    assert_has(&file, "<Piece NumberOfPoints=\"0\" NumberOfVerts=\"0\"");
    (void)block_of(&file, "position_m", 0);
    assert_ends(&file);
    buffer_fini(&file);
}

static api_snapshot_list make_list(void)
{
    static api_snapshot items[] = { { .index = 0, .t = 0.0 }, { .index = 1234567, .t = 0.1 } };

    return (api_snapshot_list){ .n = 2, .items = { .bytes = (char *)items, .n = sizeof items } };
}

static void a_series_names_the_files_with_their_times(void **unused)
{
    api_snapshot_list list = make_list();
    bf_buffer file = { 0 };

    assert_int_equal(results_series_pvd(&list, RESULTS_FILES_PARTS_VTK, &file, NULL), BF_OK);
    assert_string_equal(file.bytes,
                        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
                        "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<Collection>\n"
                        "<DataSet timestep=\"0\" part=\"0\" file=\"parts/000000.vtp\"/>\n"
                        "<DataSet timestep=\"0.1\" part=\"0\" file=\"parts/1234567.vtp\"/>\n"
                        "</Collection>\n</VTKFile>\n");
    buffer_fini(&file);
}

static bf_status append_vti(bf_buffer *out)
{
    return results_snapshot_vti(rho, &grid, 0.1, out, NULL);
}

static bf_status append_vtp(bf_buffer *out)
{
    return results_parts_vtp(disk_rows, &planar, 2.5, out, NULL);
}

static bf_status append_pvd(bf_buffer *out)
{
    api_snapshot_list list = make_list();

    return results_series_pvd(&list, RESULTS_FILES_SNAPSHOT_VTK, out, NULL);
}

static void no_memory_leaves_what_was_there(void **unused)
{
    appender_survives_no_memory(append_vti);
    appender_survives_no_memory(append_vtp);
    appender_survives_no_memory(append_pvd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_snapshot_is_an_image_of_cells),
        cmocka_unit_test(disk_parts_are_points_in_the_plane),
        cmocka_unit_test(body_parts_have_their_quaternion),
        cmocka_unit_test(when_all_parts_have_left_there_are_no_points),
        cmocka_unit_test(a_series_names_the_files_with_their_times),
        cmocka_unit_test(no_memory_leaves_what_was_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
