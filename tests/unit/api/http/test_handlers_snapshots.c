// Density snapshots over the API, in all their formats, and as a series.

#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

#define FOREVER "private, max-age=31536000, immutable"

static void snapshots_are_listed_with_their_places(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/snapshots", NULL, NULL, 200);
    json_t *root = helper_json(&ask_response);
    json_t *items = json_object_get(root, "snapshots");
    assert_int_equal(json_array_size(items), 2);
    assert_string_equal(json_string_value(json_object_get(json_array_get(items, 1), "url")),
                        RUN_1 "/snapshots/1");
    json_decref(root);
}

// NumPy's format: magic, version 1.0, a header that ends at a multiple of 64, 6 floats.
static void a_snapshot_is_a_numpy_file_that_never_changes(void **state)
{
    static const char *const headers[] = { NULL, "Accept: */*\n",
                                           "Accept: application/octet-stream\n" };

    helper_run *of = ask_add_run(RUN_RUNNING);
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        ask_get(RUN_1 "/snapshots/1", NULL, headers[i], 200);
        ask_assert_header("Content-Type", "application/octet-stream");
        ask_assert_header("Cache-Control", "private, max-age=31536000, immutable");
        assert_memory_equal(ask_response.body.bytes, "\x93NUMPY\x01\x00", 8);
        assert_int_equal((ask_response.body.n - sizeof of->rho[1]) % 64, 0);
        assert_memory_equal(ask_response.body.bytes + ask_response.body.n - sizeof of->rho[1],
                            of->rho[1], sizeof of->rho[1]);
    }
    ask_get(RUN_1 "/snapshots/1", NULL, "Accept: application/x-npy\n", 200);
    ask_assert_header("Content-Type", "application/x-npy");
    ask_get(RUN_1 "/snapshots/1", NULL, "If-None-Match: \"" ID_1 "-1-npy\"\n", 304);
    ask_get(RUN_1 "/snapshots/0", NULL, "If-None-Match: \"" ID_1 "-1-npy\"\n", 200);
}

static void a_snapshot_is_json_when_asked(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/snapshots/1", "format=json", NULL, 200);
    assert_string_equal(ask_response.body.bytes,
                        "{\"n\":1,\"t_s\":0.1,\"peak\":0.5,\"mass\":5.5,\"origin_m\":[0,0],"
                        "\"cell_m\":[0.5,0.25],\"shape\":[2,3],"
                        "\"density\":[[0.5,1,2],[3,4,5]]}");
}

static void snapshots_that_do_not_exist_are_not_found(void **state)
{
    static const char *const numbers[] = { "2", "-1", "x", "1.0", "18446744073709551616", "0x0" };
    char path[128];

    ask_add_run(RUN_RUNNING);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        snprintf(path, sizeof path, RUN_1 "/snapshots/%s", numbers[i]);
        ask_get(path, NULL, NULL, 404);
    }
}

// Centres of the 3 x 2 cells of 0.5 m x 0.25 m.
static void a_snapshot_is_a_matrix_in_csv(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/snapshots/1", NULL, "Accept: text/csv\n", 200);
    ask_assert_header("Content-Type", "text/csv; charset=utf-8");
    ask_assert_header("Content-Disposition", "inline; filename=\"000001.csv\"");
    assert_string_equal(ask_response.body.bytes,
                        "y_m/x_m,0.25,0.75,1.25\n0.125,0.5,1,2\n0.375,3,4,5\n");
}

static void a_snapshot_is_an_image_for_vtk(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/snapshots/1", "format=vti", NULL, 200);
    ask_assert_header("Content-Type", "application/x-vti");
    ask_assert_header("Cache-Control", FOREVER);
    ask_assert_header("Content-Disposition", "inline; filename=\"000001.vti\"");
    ask_assert_header("ETag", "\"" ID_1 "-1-vti\"");
    assert_true(ask_body_has("Spacing=\"0.5 0.25 1\""));
}

// Width, as PNG has it behind its signature and the length and name of its first chunk.
static unsigned width_of_png(void)
{
    const unsigned char *at = (const unsigned char *)ask_response.body.bytes + 16;

    assert_memory_equal(ask_response.body.bytes, "\x89PNG\r\n\x1a\n", 8);
    return (unsigned)at[0] << 24 | (unsigned)at[1] << 16 | (unsigned)at[2] << 8 | at[3];
}

static void a_snapshot_is_a_picture_as_wide_as_asked(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/snapshots/1", "format=png", NULL, 200);
    ask_assert_header("Content-Type", "image/png");
    ask_assert_header("Cache-Control", FOREVER);
    assert_int_equal(width_of_png(), 999); // 333 pixels for each of three cells
    // What an <img> asks for.
    ask_get(RUN_1 "/snapshots/1", "width=60&colormap=grey&max=1.25",
            "Accept: image/avif,image/webp,image/png,image/svg+xml,image/*;q=0.8,*/*;q=0.5\n", 200);
    assert_int_equal(width_of_png(), 60);
    assert_memory_equal(ask_response.body.bytes + 37, "PLTE\xff\xff\xff\xfe", 8); // white first
}

static void the_tag_of_a_picture_tells_all_that_was_asked(void **state)
{
    static const char *const queries[] = {
        "format=png",          "format=png&width=60",     "format=png&colormap=grey",
        "format=png&max=1.25", "format=png&max=1.250001", "format=png&width=60&max=1.25",
        "format=npy",
    };
    enum { N = sizeof queries / sizeof *queries };
    char tags[N][API_HEADER_SIZE] = { "" };

    ask_add_run(RUN_RUNNING);
    for (size_t i = 0; i < N; i++) {
        char header[API_HEADER_SIZE + 20];
        ask_get(RUN_1 "/snapshots/1", queries[i], NULL, 200);
        const char *tag = helper_header(&ask_response, "ETag");
        snprintf(tags[i], sizeof tags[i], "%s", tag);
        snprintf(header, sizeof header, "If-None-Match: %s\n", tag);
        for (size_t k = 0; k < i; k++)
            assert_string_not_equal(tags[k], tags[i]);
        ask_get(RUN_1 "/snapshots/1", queries[i], header, 304);
    }
    ask_get(RUN_1 "/snapshots/1",
            "format=png&width=7000&colormap=cividis&max=0.0012345678901234567", NULL, 200);
}

static void what_a_picture_cannot_be_is_refused(void **state)
{
    static const struct {
        const char *query;
        const char *word;
    } bad[] = {
        { "format=png&width=0", "'width' must be a whole number from 1 to 8192" },
        { "format=png&width=8193", "'width' must be" },
        { "format=png&width=x", "'width' must be" },
        { "format=png&colormap=jet", "viridis cividis grey" },
        { "format=png&max=0", "'max' must be a number" },
        { "format=png&max=nan", "'max' must be a number" },
        { "format=npy&width=5", "'width' is for png, not for npy" },
        { "colormap=grey", "'colormap' is for png, not for npy" },
        { "format=csv&max=1", "'max' is for png, not for csv" },
    };

    ask_add_run(RUN_RUNNING);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ask_get(RUN_1 "/snapshots/1", bad[i].query, NULL, 400);
        if (!ask_body_has(bad[i].word))
            fail_msg("%s: %s", bad[i].query, ask_response.body.bytes);
    }
}

// Cells that are 1,000 times as wide as long: 8192 pixels in width need 16 million in height.
static void too_many_pixels_are_refused_with_the_limit(void **state)
{
    ask_add_run(RUN_RUNNING)->grid.d2 = 5000.0;
    ask_get(RUN_1 "/snapshots/1", "format=png&width=8192", NULL, 422);
    assert_true(ask_body_has("16777216 pixels, the limit"));
    ask_get(RUN_1 "/snapshots/1", "format=png", NULL, 200);
}

static void grids_too_large_for_text_are_refused_with_another_format(void **state)
{
    static const char *const formats[] = { "format=csv", "format=json" };

    ask_add_run(RUN_RUNNING)->grid.n1 = 4000001;
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        ask_get(RUN_1 "/snapshots/1", formats[i], NULL, 406);
        assert_true(ask_body_has("limit 4000000"));
        assert_true(ask_body_has("use npy"));
    }
}

static void a_series_leads_to_the_files_of_the_archive(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/snapshots.pvd", NULL, NULL, 200);
    ask_assert_header("Content-Type", "application/xml");
    ask_assert_header("Cache-Control", "private, no-cache");
    ask_assert_header("ETag", "\"r1-snapshots-pvd\"");
    assert_true(ask_body_has("<DataSet timestep=\"0.1\" part=\"0\" "
                             "file=\"snapshots/000001.vti\"/>"));
    ask_get(RUN_1 "/snapshots.pvd", NULL, "If-None-Match: \"r1-snapshots-pvd\"\n", 304);
    ask_get(RUN_1 "/snapshots", NULL, "If-None-Match: \"r1-snapshots-pvd\"\n", 200);
    ask_get(NO_RUN "/snapshots.pvd", NULL, NULL, 404);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(snapshots_are_listed_with_their_places),
        ASK_TEST(a_snapshot_is_a_numpy_file_that_never_changes),
        ASK_TEST(a_snapshot_is_json_when_asked),
        ASK_TEST(snapshots_that_do_not_exist_are_not_found),
        ASK_TEST(a_snapshot_is_a_matrix_in_csv),
        ASK_TEST(a_snapshot_is_an_image_for_vtk),
        ASK_TEST(a_snapshot_is_a_picture_as_wide_as_asked),
        ASK_TEST(the_tag_of_a_picture_tells_all_that_was_asked),
        ASK_TEST(what_a_picture_cannot_be_is_refused),
        ASK_TEST(too_many_pixels_are_refused_with_the_limit),
        ASK_TEST(grids_too_large_for_text_are_refused_with_another_format),
        ASK_TEST(a_series_leads_to_the_files_of_the_archive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
