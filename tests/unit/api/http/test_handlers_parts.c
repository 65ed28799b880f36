// The parts of microscopic runs over the API.

#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

#include <stdio.h>
#include <string.h>

// A run of two parts, of which the second has left the domain.
static helper_run *add_micro_run(void)
{
    static const double rows[HELPER_VALUES] = { 0.5, 0.25, 0.125, 1,   2,   3,
                                                NAN, NAN,  NAN,   NAN, NAN, NAN };
    helper_run *of = ask_add_run(RUN_RUNNING);

    of->record.model = RUN_MICRO;
    of->parts = (api_parts){ .n_parts = 2, .n_values = FRAME_VALUES_PLANAR };
    memcpy(of->rows, rows, sizeof rows);
    return of;
}

static void parts_are_a_numpy_file_that_never_changes(void **state)
{
    helper_run *of = add_micro_run();
    ask_get(RUN_1 "/parts/1", NULL, NULL, 200);
    ask_assert_header("Content-Type", "application/octet-stream");
    ask_assert_header("Cache-Control", "private, max-age=31536000, immutable");
    ask_assert_header("ETag", "\"" ID_1 "-parts-1-npy\"");
    assert_memory_equal(ask_response.body.bytes, "\x93NUMPY\x01\x00", 8);
    assert_memory_equal(ask_response.body.bytes + ask_response.body.n - sizeof of->rows, of->rows,
                        sizeof of->rows);
    ask_get(RUN_1 "/parts/1", NULL, "If-None-Match: \"" ID_1 "-parts-1-npy\"\n", 304);
    ask_get(RUN_1 "/parts/1", NULL, "If-None-Match: \"" ID_1 "-1-npy\"\n", 200);
}

static void parts_are_text_when_asked(void **state)
{
    add_micro_run();
    ask_get(RUN_1 "/parts/1", "format=csv", NULL, 200);
    assert_string_equal(ask_response.body.bytes,
                        "part,x_m,y_m,heading_rad,vx_m_s,vy_m_s,spin_rad_s\n"
                        "0,0.5,0.25,0.125,1,2,3\n1,nan,nan,nan,nan,nan,nan\n");
    ask_get(RUN_1 "/parts/1", NULL, "Accept: application/json\n", 200);
    assert_true(ask_body_has("\"t_s\":0.1,"));
    assert_true(ask_body_has("\"parts\":[[0.5,0.25,0.125,1,2,3],null]"));
}

static void parts_are_points_for_vtk(void **state)
{
    add_micro_run();
    ask_get(RUN_1 "/parts/1", NULL, "Accept: application/x-vtp\n", 200);
    ask_assert_header("Content-Type", "application/x-vtp");
    ask_assert_header("Content-Disposition", "inline; filename=\"000001.vtp\"");
    assert_true(ask_body_has("<Piece NumberOfPoints=\"1\""));
}

static void a_series_of_parts_is_for_runs_that_have_them(void **state)
{
    helper_run *of = add_micro_run();
    ask_get(RUN_1 "/parts.pvd", NULL, NULL, 200);
    ask_assert_header("Content-Type", "application/xml");
    assert_true(ask_body_has("<DataSet timestep=\"0.1\" part=\"0\" file=\"parts/000001.vtp\"/>"));
    ask_get(RUN_1 "/parts.pvd", NULL, "If-None-Match: \"r1-parts-pvd\"\n", 304);
    of->record.model = RUN_MACRO;
    ask_get(RUN_1 "/parts.pvd", NULL, NULL, 404);
    assert_true(ask_body_has("its model is macro"));
}

static void snapshots_lead_to_their_parts(void **state)
{
    add_micro_run();
    ask_get(RUN_1 "/snapshots", NULL, NULL, 200);
    json_t *root = helper_json(&ask_response);
    json_t *items = json_object_get(root, "snapshots");
    assert_string_equal(json_string_value(json_object_get(json_array_get(items, 1), "parts_url")),
                        RUN_1 "/parts/1");
    assert_int_equal(json_integer_value(json_object_get(json_object_get(root, "parts"), "rows")),
                     2);
    json_decref(root);
}

static void parts_that_do_not_exist_are_not_found(void **state)
{
    static const char *const numbers[] = { "2", "-1", "x", "1.0", "18446744073709551616" };
    char path[128];

    add_micro_run();
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        snprintf(path, sizeof path, RUN_1 "/parts/%s", numbers[i]);
        ask_get(path, NULL, NULL, 404);
    }
    ask_get(NO_RUN "/parts/0", NULL, NULL, 404);
    ask_add_run(RUN_RUNNING);
    ask_get("/v1/runs/" ID_2 "/parts/0", NULL, NULL, 404);
}

// A million parts in space are 13 million values: too many for text, not for NumPy.
static void too_many_parts_are_not_written_as_text(void **state)
{
    add_micro_run()->parts = (api_parts){ .n_parts = 1000000, .n_values = FRAME_VALUES_SPATIAL };
    ask_get(RUN_1 "/parts/1", "format=csv", NULL, 406);
    assert_true(ask_body_has("use npy"));
    ask_get(RUN_1 "/parts/1", "format=json", NULL, 406);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(parts_are_a_numpy_file_that_never_changes),
        ASK_TEST(parts_are_text_when_asked),
        ASK_TEST(parts_are_points_for_vtk),
        ASK_TEST(a_series_of_parts_is_for_runs_that_have_them),
        ASK_TEST(snapshots_lead_to_their_parts),
        ASK_TEST(parts_that_do_not_exist_are_not_found),
        ASK_TEST(too_many_parts_are_not_written_as_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
