// The formats of results: what a reader of CSV, JSON and NumPy files finds in them.

#include "api/results/results.h"

#include "api/scenario/scenario.h"
#include "core/base/memory.h"
#include "tests/unit/api/helper_document.h"

#include <jansson.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double times[] = { 0.0, 0.1, 0.30000000000000004 };
static const double counts[] = { 192.0, 0.0, 191.5, 0.5, 1.0 / 3.0, 1e-300 };

static json_t *parse(const bf_buffer *b)
{
    json_t *root = json_loadb(b->bytes, b->n, JSON_REJECT_DUPLICATES, NULL);

    assert_non_null(root);
    return root;
}

static double number_at(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);

    assert_true(json_is_number(value));
    return json_number_value(value);
}

static void a_curve_is_lines_of_full_precision(void **unused)
{
    bf_buffer b = { 0 };

    (void)unused;
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

    (void)unused;
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
    static const char text[] =
        "\xef\xbb\xbft_s , count\r\n 0 , 5\r\n\r\n1e-1,+4.5e0 \r\n2,3,extra\n\n";
    bf_buffer t = { 0 };
    bf_buffer parts = { 0 };
    bf_buffer lines = { 0 };
    char name[SCENE_ID_SIZE];

    (void)unused;
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
        { "t_s,a,b\n0,1\n", "b", "/line/2", "column 3" },
        { "t_s,a\n0,1111111111111111111111111111111111111111111111111111111111111111111111\n", NULL,
          "/line/2", "" },
    };

    (void)unused;
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

    (void)unused;
    assert_int_equal(results_curve_json(&curve, &b, NULL), BF_OK);
    assert_string_equal(b.bytes, "{\"t_s\":[0,0.1,0.30000000000000004],"
                                 "\"upstream\":[192,191.5,0.3333333333333333],"
                                 "\"left_domain\":[0,0.5,1e-300]}");
    buffer_fini(&b);
    api_curve_fini(&curve);
}

// Read as NumPy's format says: magic, version 1.0, two bytes of length, a dictionary padded with
// blanks to a multiple of 64 and ended by a newline, then the numbers, little-endian.
static void a_grid_is_a_numpy_file(void **unused)
{
    const float rho[] = { 0.0F, 1.0F, -2.5F, 0.1F, 3e38F, 1e-45F };
    bf_buffer b = { 0 };

    (void)unused;
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

    (void)unused;
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

    (void)unused;
    assert_int_equal(results_snapshots_json(&list, NULL, &files, NULL), BF_OK);
    assert_string_equal(
        files.bytes,
        "{\"grid\":{\"origin_m\":[-0.5,0],\"cell_m\":[0.005,0.005],\"shape\":[120,200]},"
        "\"snapshots\":[{\"n\":0,\"t_s\":0,\"file\":\"snapshots/000000.npy\",\"peak\":1.25,"
        "\"mass\":192},{\"n\":12,\"t_s\":0.1,\"file\":\"snapshots/000012.npy\",\"peak\":1.5,"
        "\"mass\":191.5}]}");
    assert_int_equal(results_snapshots_json(&list, "x", &urls, NULL), BF_OK);
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

    (void)unused;
    list.parts = (api_parts){ .n_parts = 192, .n_values = FRAME_VALUES_PLANAR };
    assert_int_equal(results_snapshots_json(&list, NULL, &files, NULL), BF_OK);
    assert_non_null(strstr(files.bytes, "\"shape\":[120,200]},\"parts\":{\"rows\":192,\"columns\":["
                                        "\"x_m\",\"y_m\",\"heading_rad\",\"vx_m_s\",\"vy_m_s\","
                                        "\"spin_rad_s\"]},\"snapshots\":["));
    assert_non_null(strstr(files.bytes, "\"mass\":191.5,\"parts_file\":\"parts/000012.npy\"}]}"));
    list.parts.n_values = FRAME_VALUES_SPATIAL;
    assert_int_equal(results_snapshots_json(&list, "x", &urls, NULL), BF_OK);
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

    (void)unused;
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

    (void)unused;
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

    (void)unused;
    assert_int_equal(results_parts_npy(disk_rows, &three_parts, &b, NULL), BF_OK);
    assert_memory_equal(b.bytes, "\x93NUMPY\x01\x00", 8);
    assert_int_equal((b.n - sizeof disk_rows) % 64, 0);
    assert_non_null(strstr(b.bytes + 10, "'descr': '<f8', 'fortran_order': False, "
                                         "'shape': (3, 6)"));
    assert_memory_equal(b.bytes + b.n - sizeof disk_rows, disk_rows, sizeof disk_rows);
    buffer_fini(&b);
}

static bf_buffer resolved_document(const char *text)
{
    bf_buffer document = document_quote(text);
    bf_buffer resolved = { 0 };
    bf_faults faults = { 0 };
    scene s;

    assert_int_equal(scenario_read(document.bytes, document.n, &s, &faults, NULL), BF_OK);
    assert_int_equal(scenario_write(&s, &resolved, NULL), BF_OK);
    scene_fini(&s);
    buffer_fini(&document);
    return resolved;
}

static const frame_begin begin = { .model = RUN_MACRO, .dt = 0.00125, .duration = 1.0 };
static const frame_end end = { .n_steps = 800,
                               .t = 1.0,
                               .n_cells = 24000,
                               .parts_start = 192.0,
                               .parts_end = 100.5,
                               .peak = 1.25,
                               .digest = 0xabc };
static const results_timing timing = { .wall_s = 0.5, .n_threads = 2 };

// Of a run with one counter.
static const double known_figures[FIGURE_COUNT] = { 3600.0 };
static const key_figures figures = { .columns = "upstream,left_domain",
                                     .t = 1.0,
                                     .n = FIGURE_OFFERED + FIGURE_GAP_MIN - FIGURE_CONTENT_MEAN,
                                     .values = known_figures };

static json_t *summarise_scenario(const char *text, const frame_begin *b, const frame_end *e)
{
    bf_buffer scenario = resolved_document(text);
    bf_buffer out = { 0 };

    assert_int_equal(results_summary((run_model)b->model, scenario.bytes, scenario.n, b, e,
                                     &figures, &timing, &out, NULL),
                     BF_OK);
    json_t *root = parse(&out);
    json_t *document = json_loadb(scenario.bytes, scenario.n, 0, NULL);
    assert_true(json_equal(json_object_get(root, "scenario"), document));
    json_decref(document);
    buffer_fini(&out);
    buffer_fini(&scenario);
    return root;
}

static json_t *summarise(const frame_begin *b, const frame_end *e)
{
    return summarise_scenario("{" DOCUMENT_NEEDED "}", b, e);
}

static void a_summary_has_the_figures_of_the_run(void **unused)
{
    json_t *root = summarise(&begin, &end);

    (void)unused;
    assert_string_equal(json_string_value(json_object_get(root, "model")), "macro");
    assert_true(json_is_string(json_object_get(root, "solver_version")));
    assert_true(number_at(root, "steps") == 800);
    assert_true(number_at(root, "cells") == 24000);
    assert_true(number_at(root, "step_s") == 0.00125);
    assert_true(number_at(root, "duration_s") == 1.0);
    assert_true(number_at(root, "wall_time_s") == 0.5);
    assert_true(number_at(root, "cell_steps_per_s") == 800.0 * 24000.0 / 0.5);
    assert_true(number_at(root, "threads") == 2);
    assert_true(number_at(root, "parts_start") == 192.0);
    assert_true(number_at(root, "parts_end") == 100.5);
    assert_true(number_at(root, "parts_left") == 91.5);
    assert_true(number_at(root, "largest_density") == 1.25);
    // 1/(2 sqrt(3) r^2) of the default cylinder, r = 0.012 m: the paper's 2004 parts/m2.
    assert_true(number_at(root, "packing_density_per_m2") == 2004.0);
    assert_string_equal(json_string_value(json_object_get(root, "digest")), "0000000000000abc");
    assert_int_equal(json_array_size(json_object_get(root, "warnings")), 0);
    json_decref(root);
}

// dx/(2 (eps + |v|)) = 0.005/(2 (0.79 + 0.395)) = 2.11 ms bounds the positive step.
static void a_summary_warns(void **unused)
{
    frame_end dense = end;

    (void)unused;
    dense.peak = 1.41;
    dense.stopped = 1;
    json_t *root =
        summarise_scenario(DOCUMENT_WITH("'macro': {'step_s': 0.00212}"), &begin, &dense);
    const json_t *warnings = json_object_get(root, "warnings");
    assert_int_equal(json_array_size(warnings), 3);
    assert_true(json_is_true(json_object_get(root, "stopped")));
    assert_non_null(strstr(json_string_value(json_array_get(warnings, 0)), "stopped on request"));
    assert_non_null(strstr(json_string_value(json_array_get(warnings, 1)), "1.41"));
    assert_non_null(strstr(json_string_value(json_array_get(warnings, 2)), "0.00212"));
    json_decref(root);
}

// One part before a deflector: what holds of heaps does not hold of it. The warning is the item's own text.
static void a_summary_says_whether_the_model_was_compared_for_such_a_scenario(void **unused)
{
    static const char deflected[] =
        DOCUMENT_WITH("'obstacles': [{'from_m': [0.461325, 0], 'to_m': [0.75, 0.5]}]");
    json_t *root = summarise(&begin, &end);
    const json_t *compared = json_object_get(root, "validity");

    (void)unused;
    assert_true(json_is_true(json_object_get(compared, "compared")));
    assert_int_equal(json_array_size(json_object_get(compared, "outside")), 0);
    json_decref(root);
    root = summarise_scenario(deflected, &begin, &end);
    compared = json_object_get(root, "validity");
    assert_true(json_is_false(json_object_get(compared, "compared")));
    assert_int_equal(json_array_size(json_object_get(compared, "outside")), 1);
    const json_t *item = json_array_get(json_object_get(compared, "outside"), 0);
    assert_string_equal(json_string_value(json_object_get(item, "what")), "parts");
    assert_true(number_at(item, "value") == 1.0);
    assert_true(number_at(item, "min") > 1.0);
    assert_string_equal(json_string_value(json_object_get(item, "pointer")), "/initial");
    const json_t *warnings = json_object_get(root, "warnings");
    assert_int_equal(json_array_size(warnings), 1);
    assert_true(json_equal(json_array_get(warnings, 0), json_object_get(item, "detail")));
    json_decref(root);
}

static const frame_begin micro_begin = {
    .model = RUN_MICRO, .dt = 1e-5, .duration = 1.0, .n_parts = 192, .n_values = FRAME_VALUES_PLANAR
};
static const frame_end micro_end = { .n_steps = 100000,
                                     .t = 1.0,
                                     .n_cells = 24000,
                                     .parts_start = 192.0,
                                     .parts_end = 190.0,
                                     .n_parts_left = 2,
                                     .part_steps = 192.0 * 100000.0,
                                     .peak = 1.5,
                                     .n_contacts = 17,
                                     .kinetic_energy = 0.25,
                                     .largest_overlap = 0.0005,
                                     .overlap_share = 0.0625 };

static void parts_of_feeds_count_in_a_summary(void **unused)
{
    frame_begin fed = micro_begin;
    frame_end over = micro_end;

    (void)unused;
    fed.n_parts = 2;
    over.parts_start = 2.0;
    over.parts_entered = 40.0;
    over.parts_end = 3.0;
    over.part_steps = 5e6;
    json_t *root = summarise(&fed, &over);
    assert_true(number_at(root, "parts") == 42);
    assert_true(number_at(root, "particle_steps_per_s") == 1e7);
    json_decref(root);
}

static void a_microscopic_summary_counts_parts(void **unused)
{
    json_t *root = summarise(&micro_begin, &micro_end);

    (void)unused;
    assert_string_equal(json_string_value(json_object_get(root, "path")), "planar");
    assert_true(number_at(root, "parts") == 192);
    assert_true(number_at(root, "particle_steps_per_s") == 192.0 * 100000.0 / 0.5);
    assert_null(json_object_get(root, "cells"));
    assert_null(json_object_get(root, "cell_steps_per_s"));
    assert_true(number_at(root, "parts_left") == 2.0);
    assert_true(number_at(root, "largest_overlap_m") == 0.0005);
    assert_true(number_at(root, "largest_overlap_share") == 0.0625);
    assert_true(number_at(root, "contacts") == 17);
    assert_true(number_at(root, "kinetic_energy_j") == 0.25);
    assert_null(json_object_get(root, "validity"));
    json_decref(root);
}

// 6.25 % of a radius are more than 5 %; a density of 1.5 means nothing where parts are counted.
static void a_microscopic_summary_warns_of_soft_parts_only(void **unused)
{
    frame_end hard = micro_end;
    json_t *soft_root = summarise(&micro_begin, &micro_end);
    json_t *warnings = json_object_get(soft_root, "warnings");

    (void)unused;
    assert_int_equal(json_array_size(warnings), 1);
    assert_non_null(strstr(json_string_value(json_array_get(warnings, 0)), "6.25 % of a radius"));
    json_decref(soft_root);
    hard.overlap_share = 0.05;
    json_t *hard_root = summarise(&micro_begin, &hard);
    assert_int_equal(json_array_size(json_object_get(hard_root, "warnings")), 0);
    json_decref(hard_root);
}

static void a_damaged_scenario_gives_no_summary(void **unused)
{
    bf_buffer out = { 0 };
    bf_error err = { 0 };

    (void)unused;
    assert_int_equal(
        results_summary(RUN_MACRO, "{", 1, &begin, &end, &figures, &timing, &out, &err),
        BF_ECORRUPT);
    assert_int_equal(err.code, BF_ECORRUPT);
    assert_int_equal(out.n, 0);
    buffer_fini(&out);
}

// The second one has a name that looks like the member that is replaced.
static void a_cached_summary_differs_in_its_scenario_alone(void **unused)
{
    static const char *const documents[] = { "{'name': 'first', " DOCUMENT_NEEDED "}",
                                             "{'name': 'a\\',\\'scenario\\':{b', " DOCUMENT_NEEDED
                                             "}",
                                             "{" DOCUMENT_NEEDED "}" };
    bf_buffer summary = { 0 };

    (void)unused;
    for (size_t i = 0; i < sizeof documents / sizeof *documents; i++) {
        bf_buffer scenario = resolved_document(documents[i]), wanted = { 0 }, out = { 0 };
        assert_int_equal(results_summary(RUN_MACRO, scenario.bytes, scenario.n, &begin, &end,
                                         &figures, &timing, &wanted, NULL),
                         BF_OK);
        if (i > 0) {
            assert_int_equal(results_summary_cached(summary.bytes, summary.n, scenario.bytes,
                                                    scenario.n, &out, NULL),
                             BF_OK);
            json_t *root = parse(&out), *fresh = parse(&wanted);
            assert_true(json_is_true(json_object_get(root, "cached")));
            assert_int_equal(json_object_del(root, "cached"), 0);
            assert_true(json_equal(root, fresh));
            json_decref(root);
            json_decref(fresh);
        }
        buffer_fini(&summary);
        summary = i > 0 ? out : wanted;
        if (i > 0)
            buffer_fini(&wanted);
        buffer_fini(&scenario);
    }
    buffer_fini(&summary);
}

static void what_is_no_summary_is_not_made_a_cached_one(void **unused)
{
    bf_buffer out = { 0 };

    (void)unused;
    assert_int_equal(buffer_printf(&out, "before"), BF_OK);
    assert_int_equal(results_summary_cached("{\"steps\":1}", 11, "{}", 2, &out, NULL), BF_ECORRUPT);
    assert_int_equal(results_summary_cached("", 0, "{}", 2, &out, NULL), BF_ECORRUPT);
    memory_plan_fault(1, 1);
    bf_status status =
        results_summary_cached("{\"a\":1,\"scenario\":{}}", 21,
                               "{\"a longer one, for which there is no room\":1}", 46, &out, NULL);
    memory_plan_fault(0, 0);
    assert_int_equal(status, BF_ENOMEM);
    assert_string_equal(out.bytes, "before");
    buffer_fini(&out);
}

// Every function appends; what stood there before survives a failure.
static bf_status append_all(const api_curve *curve, const bf_buffer *scenario, bf_buffer *out,
                            size_t which)
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
        return results_snapshots_json(&list, NULL, out, NULL);
    case 5:
        return results_curve_csv(curve, out, NULL);
    case 6:
        return results_parts_npy(disk_rows, &three_parts, out, NULL);
    case 7:
        return results_parts_csv(disk_rows, &three_parts, out, NULL);
    case 8:
        return results_parts_json(disk_rows, &three_parts, &snapshot, out, NULL);
    default:
        return results_summary(RUN_MACRO, scenario->bytes, scenario->n, &begin, &end, &figures,
                               &timing, out, NULL);
    }
}

static void no_memory_leaves_what_was_there(void **unused)
{
    bf_buffer scenario = resolved_document("{" DOCUMENT_NEEDED "}");
    api_curve curve = make_curve();

    (void)unused;
    for (size_t which = 0; which < 10; which++) {
        bf_status status = BF_ENOMEM;
        for (size_t n = 1; status != BF_OK; n++) {
            bf_buffer out = { 0 };
            assert_int_equal(buffer_append(&out, "0123456789", 10), BF_OK);
            memory_plan_fault(n, 0);
            status = append_all(&curve, &scenario, &out, which);
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
    buffer_fini(&scenario);
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
        cmocka_unit_test(parts_of_feeds_count_in_a_summary),
        cmocka_unit_test(a_microscopic_summary_counts_parts),
        cmocka_unit_test(a_microscopic_summary_warns_of_soft_parts_only),
        cmocka_unit_test(a_summary_has_the_figures_of_the_run),
        cmocka_unit_test(a_summary_warns),
        cmocka_unit_test(a_summary_says_whether_the_model_was_compared_for_such_a_scenario),
        cmocka_unit_test(a_damaged_scenario_gives_no_summary),
        cmocka_unit_test(a_cached_summary_differs_in_its_scenario_alone),
        cmocka_unit_test(what_is_no_summary_is_not_made_a_cached_one),
        cmocka_unit_test(no_memory_leaves_what_was_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
