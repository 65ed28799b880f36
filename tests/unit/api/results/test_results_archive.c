// results.zip: every file that the run has, under the names and with the bytes of the command line,
// made piece by piece.

#include "api/results/results_archive.h"

#include "api/results/results.h"
#include "core/base/memory.h"
#include "tests/unit/api/helper_services.h"
#include "tests/unit/api/helper_unzip.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FINISHED_S = 1769860810 };

static helper_daemon a_daemon;

// A run of two parts that has ended; the second part has left the domain.
static helper_run *add_run(run_model model)
{
    static const double rows[HELPER_VALUES] = { 0.5, 0.25, 0.125, 1,   2,   3,
                                                NAN, NAN,  NAN,   NAN, NAN, NAN };

    a_daemon = (helper_daemon){ .n_runs = 0 };
    helper_run *of = helper_add_run(&a_daemon, RUN_SUCCEEDED);
    of->record.model = model;
    of->record.has_summary = true;
    of->record.finished_ms = FINISHED_S * INT64_C(1000) + 999;
    of->summary = "{\"stopped\":false}";
    if (model == RUN_MICRO)
        of->parts = (api_parts){ .n_parts = 2, .n_values = FRAME_VALUES_PLANAR };
    memcpy(of->rows, rows, sizeof rows);
    return of;
}

// Makes a body to its end; *ret_pieces (NULL: not required) counts them.
static bf_status make_all(const body_source *body, size_t limit_bytes, bf_buffer *out,
                          size_t *ret_pieces)
{
    api_services services = helper_services(&a_daemon);
    bf_status status = BF_OK;
    body_state where = BODY_MORE;
    size_t n = 0;

    while (status == BF_OK && where == BODY_MORE) {
        status = body->next_chunk(body->state, &services, limit_bytes, out, &where, NULL);
        n++;
    }
    if (ret_pieces != NULL)
        *ret_pieces = n;
    return status;
}

static bf_status make_archive(const helper_run *of, results_archive_kind kind, size_t limit_bytes,
                              bf_buffer *out)
{
    api_services services = helper_services(&a_daemon);
    body_source body = { .state = NULL };

    bf_status status = results_archive_open(&of->record, kind, &services, &body, NULL);
    if (status != BF_OK)
        return status;
    status = make_all(&body, limit_bytes, out, NULL);
    body.destroy(body.state);
    return status;
}

static void assert_names(const unzip_file *files, size_t n, const char *const *names)
{
    for (size_t i = 0; i < n; i++) {
        assert_non_null(names[i]);
        assert_string_equal(files[i].name, names[i]);
        assert_int_equal(files[i].mtime_s, FINISHED_S);
    }
    assert_null(names[n]);
}

static const bf_buffer *content_of(const unzip_file *files, size_t n, const char *name)
{
    for (size_t i = 0; i < n; i++) {
        if (strcmp(files[i].name, name) == 0)
            return &files[i].content;
    }
    fail_msg("no %s", name);
    return NULL;
}

static void assert_same(const bf_buffer *a, bf_buffer *b)
{
    assert_int_equal(a->n, b->n);
    assert_memory_equal(a->bytes, b->bytes, a->n);
    buffer_fini(b);
}

static void a_macroscopic_run_has_its_files(void **unused)
{
    static const char *const names[] = { "scenario.json",
                                         "curve.csv",
                                         "snapshots.json",
                                         "snapshots/000000.npy",
                                         "snapshots/000001.npy",
                                         "summary.json",
                                         NULL };
    unzip_file files[UNZIP_FILES_MAX];
    bf_buffer zip = { 0 }, expected = { 0 };
    helper_run *of = add_run(RUN_MACRO);

    assert_int_equal(make_archive(of, RESULTS_ARCHIVE_PLAIN, 65536, &zip), BF_OK);
    size_t n = unzip_all(&zip, files);
    assert_names(files, n, names);
    assert_string_equal(content_of(files, n, "scenario.json")->bytes, "{\"duration_s\":6.0}");
    assert_string_equal(content_of(files, n, "summary.json")->bytes, of->summary);
    assert_string_equal(content_of(files, n, "curve.csv")->bytes,
                        "t_s,upstream,left_domain\n0,192,0\n0.1,191.5,0.5\n");
    assert_non_null(
        strstr(content_of(files, n, "snapshots.json")->bytes, "\"file\":\"snapshots/000001.npy\""));
    assert_int_equal(results_npy(of->rho[1], 3, 2, &expected, NULL), BF_OK);
    assert_same(content_of(files, n, "snapshots/000001.npy"), &expected);
    unzip_fini(files, n);
    buffer_fini(&zip);
}

static void a_microscopic_run_has_its_parts_and_vtk_files_when_asked(void **unused)
{
    static const char *const names[] = { "scenario.json",
                                         "curve.csv",
                                         "snapshots.json",
                                         "snapshots/000000.npy",
                                         "snapshots/000001.npy",
                                         "parts/000000.npy",
                                         "parts/000001.npy",
                                         "snapshots.pvd",
                                         "snapshots/000000.vti",
                                         "snapshots/000001.vti",
                                         "parts.pvd",
                                         "parts/000000.vtp",
                                         "parts/000001.vtp",
                                         "summary.json",
                                         NULL };
    unzip_file files[UNZIP_FILES_MAX];
    bf_buffer zip = { 0 }, expected = { 0 };
    helper_run *of = add_run(RUN_MICRO);

    assert_int_equal(make_archive(of, RESULTS_ARCHIVE_VTK, 65536, &zip), BF_OK);
    size_t n = unzip_all(&zip, files);
    assert_names(files, n, names);
    assert_int_equal(results_parts_npy(of->rows, &of->parts, &expected, NULL), BF_OK);
    assert_same(content_of(files, n, "parts/000001.npy"), &expected);
    assert_int_equal(results_parts_vtp(of->rows, &of->parts, 0.1, &expected, NULL), BF_OK);
    assert_same(content_of(files, n, "parts/000001.vtp"), &expected);
    assert_int_equal(results_snapshot_vti(of->rho[1], &of->grid, 0.1, &expected, NULL), BF_OK);
    assert_same(content_of(files, n, "snapshots/000001.vti"), &expected);
    assert_non_null(
        strstr(content_of(files, n, "snapshots.pvd")->bytes, "file=\"snapshots/000001.vti\""));
    assert_non_null(strstr(content_of(files, n, "parts.pvd")->bytes, "file=\"parts/000001.vtp\""));
    unzip_fini(files, n);
    buffer_fini(&zip);
}

static void a_run_that_failed_has_what_it_left(void **unused)
{
    static const char *const names[] = { "scenario.json", "curve.csv", "snapshots.json", NULL };
    unzip_file files[UNZIP_FILES_MAX];
    helper_run *of = add_run(RUN_MACRO);
    bf_buffer zip = { 0 };

    of->record.state = RUN_FAILED;
    of->record.has_summary = false;
    of->record.n_snapshots = of->record.n_samples = 0;
    assert_int_equal(make_archive(of, RESULTS_ARCHIVE_VTK, 65536, &zip), BF_OK);
    size_t n = unzip_all(&zip, files);
    assert_int_equal(n, 4);
    assert_string_equal(files[3].name, "snapshots.pvd"); // empty, but one
    assert_names(files, 3, names);
    unzip_fini(files, n);
    buffer_fini(&zip);
}

// So that an entity tag can name them.
static void the_size_of_the_pieces_changes_no_byte(void **unused)
{
    bf_buffer whole = { 0 };
    helper_run *of = add_run(RUN_MICRO);

    assert_int_equal(make_archive(of, RESULTS_ARCHIVE_VTK, SIZE_MAX, &whole), BF_OK);
    for (size_t limit = 1; limit < 100000; limit = limit * 7 + 1) {
        bf_buffer zip = { 0 };
        assert_int_equal(make_archive(of, RESULTS_ARCHIVE_VTK, limit, &zip), BF_OK);
        assert_same(&whole, &zip);
    }
    buffer_fini(&whole);
}

static void pieces_are_no_longer_than_a_slice_beyond_the_limit(void **unused)
{
    enum { LIMIT = 1000, SLICE = 70000 };
    api_services services;
    helper_run *of = add_run(RUN_MACRO);
    body_source body = { .state = NULL };
    body_state where = BODY_MORE;

    of->record.n_snapshots = HELPER_SNAPSHOTS_MAX;
    for (size_t k = 0; k < HELPER_SNAPSHOTS_MAX; k++)
        of->snapshots[k].index = k;
    services = helper_services(&a_daemon);
    assert_int_equal(
        results_archive_open(&of->record, RESULTS_ARCHIVE_PLAIN, &services, &body, NULL), BF_OK);
    for (size_t n = 0; where == BODY_MORE; n++) {
        bf_buffer piece = { 0 };
        assert_int_equal(body.next_chunk(body.state, &services, LIMIT, &piece, &where, NULL),
                         BF_OK);
        assert_true(piece.n < LIMIT + SLICE);
        assert_true(n < 1000);
        buffer_fini(&piece);
    }
    body.destroy(body.state);
}

// An empty belt deflates to nothing: without an end of its turn one piece would read the whole run.
static void a_piece_reads_a_limited_part_of_the_run(void **unused)
{
    bf_buffer zip = { 0 };
    helper_run *of = add_run(RUN_MACRO);
    api_services services = helper_services(&a_daemon);
    body_source body = { .state = NULL };
    size_t n_pieces = 0;

    of->record.n_snapshots = HELPER_SNAPSHOTS_MAX;
    assert_int_equal(
        results_archive_open(&of->record, RESULTS_ARCHIVE_PLAIN, &services, &body, NULL), BF_OK);
    assert_int_equal(make_all(&body, SIZE_MAX, &zip, &n_pieces), BF_OK);
    assert_true(n_pieces > 5); // of 404 files, 64 of a turn
    body.destroy(body.state);
    buffer_fini(&zip);
}

static void a_run_that_is_removed_meanwhile_ends_in_a_failure(void **unused)
{
    bf_buffer zip = { 0 };
    helper_run *of = add_run(RUN_MACRO);
    api_services services = helper_services(&a_daemon);
    body_source body = { .state = NULL };
    body_state where = BODY_MORE;

    assert_int_equal(
        results_archive_open(&of->record, RESULTS_ARCHIVE_PLAIN, &services, &body, NULL), BF_OK);
    assert_int_equal(body.next_chunk(body.state, &services, 1, &zip, &where, NULL), BF_OK);
    assert_int_equal(services.remove(services.service, of->record.id, API_ANY_REVISION, NULL),
                     BF_OK);
    assert_int_equal(make_all(&body, 65536, &zip, NULL), BF_ENOTFOUND);
    body.destroy(body.state);
    buffer_fini(&zip);
}

static void a_client_may_leave_at_any_piece(void **unused)
{
    helper_run *of = add_run(RUN_MICRO);
    api_services services = helper_services(&a_daemon);

    for (size_t n_pieces = 0; n_pieces < 20; n_pieces++) {
        bf_buffer zip = { 0 };
        body_source body = { .state = NULL };
        body_state where = BODY_MORE;
        assert_int_equal(
            results_archive_open(&of->record, RESULTS_ARCHIVE_VTK, &services, &body, NULL), BF_OK);
        for (size_t i = 0; i < n_pieces && where == BODY_MORE; i++)
            assert_int_equal(body.next_chunk(body.state, &services, 1, &zip, &where, NULL), BF_OK);
        body.destroy(body.state);
        buffer_fini(&zip);
    }
}

static void no_memory_is_said(void **unused)
{
    helper_run *of = add_run(RUN_MICRO);
    bf_status status = BF_ENOMEM;
    size_t n = 0;

    while (status != BF_OK) {
        bf_buffer zip = { 0 };
        memory_plan_fault(++n, 0);
        status = make_archive(of, RESULTS_ARCHIVE_VTK, 65536, &zip);
        bool has_struck = memory_faults() > 0;
        memory_plan_fault(0, 0);
        assert_int_equal(status, has_struck ? BF_ENOMEM : BF_OK);
        buffer_fini(&zip);
        assert_true(n < 1000);
    }
    assert_true(n > 20);
}

enum { N_LONG = 11333, N_COLUMNS = 352 }; // with the times 4,000,549 numbers

// Samples k = 0, 1, ... at k seconds; all columns are k modulo 10.
static bf_status read_long_curve(api_store *store, const char *id, uint64_t first, uint64_t n_most,
                                 api_curve *ret_curve, bf_error *err)
{
    const uint64_t n = N_LONG - first < n_most ? N_LONG - first : n_most;
    api_curve curve = { .n = (size_t)n, .n_columns = N_COLUMNS };
    double values[N_COLUMNS];

    for (int c = 0; c < N_COLUMNS; c++)
        assert_int_equal(buffer_printf(&curve.columns, "%sc%d", c == 0 ? "" : ",", c), BF_OK);
    for (uint64_t k = first; k < first + n; k++) {
        const double t = (double)k;
        for (int c = 0; c < N_COLUMNS; c++)
            values[c] = (double)(k % 10);
        assert_int_equal(buffer_append(&curve.t, &t, sizeof t), BF_OK);
        assert_int_equal(buffer_append(&curve.values, values, sizeof values), BF_OK);
    }
    *ret_curve = curve;
    return BF_OK;
}

static void write_long_curve(bf_buffer *out)
{
    assert_int_equal(buffer_printf(out, "t_s"), BF_OK);
    for (int c = 0; c < N_COLUMNS; c++)
        assert_int_equal(buffer_printf(out, ",c%d", c), BF_OK);
    for (int k = 0; k < N_LONG; k++) {
        const char value[] = { ',', (char)('0' + k % 10) };
        assert_int_equal(buffer_printf(out, "\n%d", k), BF_OK);
        for (int c = 0; c < N_COLUMNS; c++)
            assert_int_equal(buffer_append(out, value, sizeof value), BF_OK);
    }
    assert_int_equal(buffer_append(out, "\n", 1), BF_OK);
}

// The archive holds some of the numbers at a time.
static void a_long_curve_is_made_piece_by_piece(void **unused)
{
    helper_run *of = add_run(RUN_MACRO);
    api_services services = helper_services(&a_daemon);
    bf_buffer archive = { 0 }, csv = { 0 };
    body_source body = { .state = NULL };
    body_state where = BODY_MORE;

    of->record.n_samples = N_LONG;
    services.read_curve = read_long_curve;
    assert_int_equal(
        results_archive_open(&of->record, RESULTS_ARCHIVE_PLAIN, &services, &body, NULL), BF_OK);
    assert_true(body.n_held < 1000000);
    while (where == BODY_MORE)
        assert_int_equal(body.next_chunk(body.state, &services, 1 << 20, &archive, &where, NULL),
                         BF_OK);
    body.destroy(body.state);
    write_long_curve(&csv);
    unzip_file files[UNZIP_FILES_MAX];
    size_t n = unzip_all(&archive, files);
    assert_same(content_of(files, n, "curve.csv"), &csv);
    unzip_fini(files, n);
    buffer_fini(&archive);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_long_curve_is_made_piece_by_piece),
        cmocka_unit_test(a_macroscopic_run_has_its_files),
        cmocka_unit_test(a_microscopic_run_has_its_parts_and_vtk_files_when_asked),
        cmocka_unit_test(a_run_that_failed_has_what_it_left),
        cmocka_unit_test(the_size_of_the_pieces_changes_no_byte),
        cmocka_unit_test(pieces_are_no_longer_than_a_slice_beyond_the_limit),
        cmocka_unit_test(a_piece_reads_a_limited_part_of_the_run),
        cmocka_unit_test(a_run_that_is_removed_meanwhile_ends_in_a_failure),
        cmocka_unit_test(a_client_may_leave_at_any_piece),
        cmocka_unit_test(no_memory_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
