// Stores of older versions: migrated with all their content, and their runs continue. The files
// are made by the texts that made them then. I1 ... I15 are the invariants of server/store/store.h.

#include "tests/unit/server/helper_golden.h"

#include "server/store/backup.h"
#include "server/store/store_priv.h"

#include <fcntl.h>
#include <float.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char run_a[] = "01900000-0000-7000-8000-00000000000a"; // has succeeded
static const char run_b[] = "01900000-0000-7000-8000-00000000000b"; // was running

// Rows that versions 1 and 2 have alike. Run a has two samples of two columns, run b has one; both have a snapshot of
// 2 x 1 cells; run b has a checkpoint of step 1, too. Events of samples tell the first one in their data only.
static const char rows[] =
    "INSERT INTO runs (number, id, state, model, priority, label, name, revision, created_ms,"
    "  finished_ms, n_samples, n_snapshots, last_event, has_summary, checkpoint_step, n1, n2, d1, "
    "d2)"
    "  VALUES (3, '01900000-0000-7000-8000-00000000000a', 2, 0, 5, 'old', 'a belt', 9, 1000, 2000,"
    "          2, 1, 12, 1, 0, 2, 1, 0.5, 0.5),"
    "         (8, '01900000-0000-7000-8000-00000000000b', 1, 0, 0, '', '', 4, 1500, 0,"
    "          1, 1, 22, 0, 1, 2, 1, 0.5, 0.5);"
    "INSERT INTO texts (run, kind, data) VALUES (3, 0, '{\"a\":1}'), (3, 1, '{\"steps\":7}'),"
    "  (3, 2, 'upstream,left_domain'), (8, 0, '{\"b\":1}'), (8, 2, 'upstream,left_domain');"
    "INSERT INTO samples (run, first, n, t, parts) VALUES (3, 0, 1, zeroblob(8), zeroblob(16)),"
    "  (3, 1, 1, zeroblob(8), zeroblob(16)),"
    "  (8, 0, 1, zeroblob(8), zeroblob(16));"
    "INSERT INTO snapshots (run, item, t, peak, mass) VALUES (3, 0, 0.0, 1.5, 2.0),"
    "  (8, 0, 0.0, 1.5, 2.0);"
    "INSERT INTO chunks (run, kind, item, part, data) VALUES (3, 0, 0, 0, ?1), (8, 0, 0, 0, ?1),"
    "  (8, 1, 0, 0, ?1);"
    "INSERT INTO events (id, run, type, snapshot, data) VALUES (9, 3, 2, 0, '{\"first\":0}'),"
    "  (10, 3, 2, 0, '{\"first\":1}'), (11, 3, 3, 0, '{\"n\":0}'), (12, 3, 4, 0, "
    "'{\"status\":\"succeeded\"}'),"
    "  (20, 8, 0, 0, '{\"status\":\"running\"}'), (21, 8, 2, 0, '{\"first\":0}'),"
    "  (22, 8, 3, 0, '{\"n\":0}');";

static const float cells[2] = { 0.25F, 1.0F };

static void execute(sqlite3 *db, const char *sql)
{
    char *error = NULL;

    if (sqlite3_exec(db, sql, NULL, NULL, &error) != SQLITE_OK)
        fail_msg("%s", error);
}

// Statement by statement, each with the packed cells as its parameter, if it has one.
static void insert_rows(sqlite3 *db)
{
    store__packer *packer = store__packer_create();
    bf_buffer packed = { 0 };
    const char *rest = rows;

    assert_non_null(packer);
    assert_int_equal(store__pack(packer, cells, sizeof cells, &packed, NULL), BF_OK);
    store__packer_destroy(packer);
    while (*rest != '\0') {
        sqlite3_stmt *statement = NULL;
        assert_int_equal(sqlite3_prepare_v2(db, rest, -1, &statement, &rest), SQLITE_OK);
        if (sqlite3_bind_parameter_count(statement) > 0)
            sqlite3_bind_blob(statement, 1, packed.bytes, (int)packed.n, SQLITE_STATIC);
        assert_int_equal(sqlite3_step(statement), SQLITE_DONE);
        sqlite3_finalize(statement);
    }
    buffer_fini(&packed);
}

// Replace the store's file by one of an older version.
static void make_old(helper_store *h, int version)
{
    char path[128], mark[100];
    sqlite3 *db = NULL;

    helper_store_close(h);
    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    execute(db, "PRAGMA journal_mode = WAL; PRAGMA foreign_keys = ON");
    // The rows are of versions 1 and 2; a later version has them as its migration made them.
    for (int i = 0; i < version; i++) {
        execute(db, store__migrations[i]);
        if (i == (version < 2 ? version : 2) - 1)
            insert_rows(db);
    }
    snprintf(mark, sizeof mark, "PRAGMA application_id = %d; PRAGMA user_version = %d", 0x42464c57,
             version);
    execute(db, mark);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static bf_status take_curve_event(void *context, const api_event *event, bf_error *err)
{
    bf_buffer *curves = context;

    return event->type == API_EVENT_CURVE ? buffer_printf(curves, "%s\n", event->data) : BF_OK;
}

// As the samples say, whatever stood in the events.
static void check_curve_events(store *s)
{
    char ids[1][API_ID_SIZE];
    bf_buffer curves = { 0 };

    snprintf(ids[0], sizeof ids[0], "%s", run_a);
    assert_int_equal(store_read_events(s, (const char(*)[API_ID_SIZE])ids, 1, 0, UINT16_MAX,
                                       take_curve_event, &curves, NULL),
                     BF_OK);
    assert_string_equal(curves.bytes,
                        "{\"run\":\"01900000-0000-7000-8000-00000000000a\",\"first\":0,\"t_s\":[0],"
                        "\"columns\":{\"upstream\":[0],\"left_domain\":[0]}}\n"
                        "{\"run\":\"01900000-0000-7000-8000-00000000000a\",\"first\":1,\"t_s\":[0],"
                        "\"columns\":{\"upstream\":[0],\"left_domain\":[0]}}\n");
    buffer_fini(&curves);
}

static void check_results(store *s, const char *id, size_t n_samples)
{
    api_curve curve = { 0 };
    api_array got;
    bf_buffer rho = { 0 };

    assert_int_equal(store_read_curve(s, id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    assert_int_equal(curve.n, n_samples);
    assert_int_equal(curve.n_columns, 2);
    api_curve_fini(&curve);
    assert_int_equal(store_read_array(s, id, 0, API_ARRAY_DENSITY, &got, &rho, NULL), BF_OK);
    assert_true(got.snapshot.peak == 1.5 && got.grid.n1 == 2 && got.grid.n2 == 1);
    assert_int_equal(rho.n, sizeof cells);
    assert_memory_equal(rho.bytes, cells, sizeof cells);
    buffer_fini(&rho);
}

static void check_soundness(const helper_store *h)
{
    assert_int_equal(helper_store_sql(h, "PRAGMA user_version"), store__version);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM pragma_integrity_check "
                                         "WHERE integrity_check <> 'ok'"),
                     0);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM pragma_foreign_key_check"), 0);
}

// I8 among others: what was running is queued.
static void an_older_store_is_brought_up_to_date_with_all_it_has(void **state)
{
    helper_store *h = *state;

    for (int version = 1; version < store__version; version++) {
        make_old(h, version);
        helper_store_open(h);
        check_soundness(h);
        api_run record = helper_find(h->store, run_a);
        assert_int_equal(record.state, RUN_SUCCEEDED);
        assert_int_equal(record.last_event, 12);
        assert_false(record.is_cached);
        assert_string_equal(record.owner, "");
        check_results(h->store, run_a, 2);
        check_results(h->store, run_b, 1);
        helper_events events = helper_read_events(h->store, run_a, 0);
        assert_int_equal(events.n, 4);
        buffer_fini(&events.data);
        check_curve_events(h->store);
        assert_int_equal(helper_find(h->store, run_b).state, RUN_QUEUED);
        // I6: the ids of events go on.
        assert_int_equal(helper_find(h->store, run_b).last_event, 23);
    }
}

// I4, I5: from t = 0, because its checkpoint is of an older format; what it sends again is known.
static void a_run_begins_again_in_a_store_that_was_brought_up_to_date(void **state)
{
    helper_store *h = *state;
    store_job job = { 0 };
    bf_grid grid = { .n1 = 2, .n2 = 1, .d1 = 0.5, .d2 = 0.5 };
    store_item item = { .type = API_EVENT_SNAPSHOT };

    make_old(h, 1);
    helper_store_open(h);
    assert_int_equal(store_claim(h->store, true, &job, NULL), BF_OK);
    assert_string_equal(job.run.id, run_b);
    assert_int_equal(job.step, 0);
    assert_int_equal(job.checkpoint.n, 0);
    store_job_fini(&job);
    uint64_t last_event = helper_find(h->store, run_b).last_event;
    assert_int_equal(buffer_append(&item.rho, cells, sizeof cells), BF_OK);
    assert_int_equal(buffer_append(&item.event, "{}", 2), BF_OK);
    store_batch batch = { .run_id = run_b, .n = 1, .items = &item, .grid = &grid };
    assert_int_equal(helper_store_append(h->store, &batch, NULL), BF_OK);
    assert_int_equal(helper_find(h->store, run_b).last_event, last_event);
    item.snapshot.index = 1;
    assert_int_equal(helper_store_append(h->store, &batch, NULL), BF_OK);
    assert_int_equal(helper_find(h->store, run_b).last_event, last_event + 1);
    helper_item_fini(&item);
    assert_int_equal(helper_finish(h->store, run_b, RUN_SUCCEEDED).n_snapshots, 2);
}

// A store from before marks was used with tokens if somebody owns something in it.
static void an_older_store_with_owners_needs_tokens(void **state)
{
    helper_store *h = *state;

    for (int k = 0; k < 2; k++) {
        bool needs = k == 0;
        make_old(h, 13);
        if (k == 1)
            helper_store_sql(h, "INSERT INTO owners (owner) VALUES ('alice')");
        helper_store_open(h);
        assert_int_equal(store_needs_tokens(h->store, &needs, NULL), BF_OK);
        assert_int_equal(needs, k == 1);
        assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM marks"), k);
    }
    assert_int_equal(store_need_tokens(h->store, NULL), BF_OK);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM marks"), 1);
}

// I9: what referred to runs and refers to results now goes with them.
static void a_run_of_an_older_store_is_removed_with_all_it_has(void **state)
{
    static const char *const counts[] = {
        "SELECT count(*) FROM runs",    "SELECT count(*) FROM results",
        "SELECT count(*) FROM samples", "SELECT count(*) FROM snapshots",
        "SELECT count(*) FROM chunks",  "SELECT count(*) FROM texts",
        "SELECT count(*) FROM events",
    };
    helper_store *h = *state;

    make_old(h, 2);
    helper_store_open(h);
    assert_int_equal(store_remove(h->store, run_a, API_ANY_REVISION, NULL), BF_OK);
    check_results(h->store, run_b, 1);
    assert_int_equal(store_remove(h->store, run_b, API_ANY_REVISION, NULL), BF_OK);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        assert_int_equal(helper_store_sql(h, counts[i]), 0);
    check_soundness(h);
}

// A migration that is interrupted has not happened.
static void a_store_that_cannot_be_brought_up_to_date_stays_as_it_was(void **state)
{
    helper_store *h = *state;
    store_options options = { .directory = h->directory, .queue_limit = 10 };
    bf_error err = { 0 };

    make_old(h, 2);
    helper_store_sql(h, "CREATE TABLE answers (number INTEGER)"); // in the way of the last step
    assert_int_equal(store_open(&options, &h->store, &err), BF_ESYSTEM);
    assert_null(h->store);
    assert_int_equal(helper_store_sql(h, "PRAGMA user_version"), 2);
    assert_int_equal(
        helper_store_sql(h, "SELECT count(*) FROM sqlite_schema WHERE name = 'results'"), 0);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM samples WHERE run = 3"), 2);
    helper_store_sql(h, "DROP TABLE answers");
    helper_store_open(h);
    check_results(h->store, run_a, 2);
}

static const char kept[] = "01a2013d-650d-7325-be90-1d7a80709949";
static const char shared[] = "01a2013d-651e-7426-ad80-85bb41edaa48";
static const char micro[] = "01a2013d-6521-7094-9b07-f6e0c5cf0b30";
static const char half_way[] = "01a2013d-6530-7683-91b8-009fb39ad828";
static const char cancelled[] = "01a2013d-890a-76ac-8725-5e69880cdc33";
static const char waits[] = "01a2013d-890d-77fa-b884-49ca28204d92";
static const char measured[] = "01a2013d-652f-7703-919e-c769fbaae2e1";

static double at(const bf_buffer *doubles, size_t i)
{
    return ((const double *)(const void *)doubles->bytes)[i];
}

// The numbers of what follows were read from the file with SQLite's own program and zstd.
static void check_curve(store *s, const char *id, double first_upstream, double last_upstream)
{
    api_curve curve = { 0 };

    assert_int_equal(store_read_curve(s, id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    assert_string_equal(curve.columns.bytes, "upstream,left_domain");
    assert_int_equal(curve.n, 6);
    assert_true(at(&curve.t, 0) == 0.0 && at(&curve.t, 5) == 0.1);
    assert_true(at(&curve.values, 0) == first_upstream && at(&curve.values, 10) == last_upstream);
    api_curve_fini(&curve);
}

// The largest of a snapshot's cells is its peak, to the accuracy of floats.
static void check_peaks(store *s, const char *id, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        bf_buffer rho = { 0 };
        api_array got;
        float peak = 0.0F;
        assert_int_equal(store_read_array(s, id, i, API_ARRAY_DENSITY, &got, &rho, NULL), BF_OK);
        const float *cell = (const float *)(const void *)rho.bytes;
        for (size_t k = 0; k < rho.n / sizeof *cell; k++)
            peak = fmaxf(peak, cell[k]);
        assert_true(fabs((double)peak - got.snapshot.peak) <= FLT_EPSILON * got.snapshot.peak);
        buffer_fini(&rho);
    }
}

static void check_part(store *s)
{
    bf_buffer rows_of_parts = { 0 };
    api_array got;

    assert_int_equal(store_read_array(s, micro, 2, API_ARRAY_PARTS, &got, &rows_of_parts, NULL),
                     BF_OK);
    assert_int_equal(got.parts.n_parts, 1);
    assert_int_equal(got.parts.n_values, 6);
    assert_true(at(&rows_of_parts, 1) == 0.06 && at(&rows_of_parts, 3) == 0.39459777928957507);
    buffer_fini(&rows_of_parts);
}

static void check_replay(store *s)
{
    api_submission submission = { .model = RUN_MACRO, .sender.key = "fixture" };
    api_acceptance accepted = { .revision = 0 };

    // The body is not known here; another one is refused because the key is.
    submission.sender.body = "{}";
    submission.sender.n_body = 2;
    assert_int_equal(store_submit(s, &submission, &accepted, NULL), BF_EINPUT);
}

static void check_half_way(helper_store *h)
{
    store_job job = { 0 };

    assert_int_equal(store_claim(h->store, true, &job, NULL), BF_OK);
    assert_string_equal(job.run.id, half_way);
    assert_int_equal(job.step, 0);
    assert_int_equal(job.checkpoint.n, 0);
    assert_int_equal(job.run.n_samples, 1);
    assert_int_equal(job.run.n_snapshots, 1);
    store_job_fini(&job);
}

// Runs that had no line get one; two of them have the same scenario.
static void check_lines(store *s)
{
    static const struct {
        const char *id;
        uint64_t version;
    } runs[] = { { kept, 1 }, { half_way, 2 }, { shared, 1 }, { micro, 1 } };
    const api_annotations to = { .line = "hall 2" };
    api_run record;

    for (size_t k = 0; k < sizeof runs / sizeof *runs; k++) {
        assert_int_equal(store_annotate(s, runs[k].id, API_ANY_REVISION, &to, &record, NULL),
                         BF_OK);
        assert_int_equal(record.line_version, runs[k].version);
    }
}

// I1, I3, I8, I13 over a change of the program.
static void a_store_of_version_4_is_there_with_all_it_had(void **state)
{
    helper_store *h = *state;
    api_measurement about;
    api_curve curve = { 0 };

    helper_golden_put(h, 4);
    // Its answers to idempotency keys are as old as the file is.
    const store_options options = { .directory = h->directory,
                                    .queue_limit = 100,
                                    .idempotency_ms = INT64_C(1) << 42 };
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
    check_soundness(h);
    helper_store_verify(h);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), 6);
    assert_int_equal(helper_find(h->store, kept).state, RUN_SUCCEEDED);
    assert_true(helper_find(h->store, shared).is_cached);
    assert_int_equal(helper_find(h->store, micro).model, RUN_MICRO);
    assert_int_equal(helper_find(h->store, half_way).state, RUN_QUEUED);
    assert_int_equal(helper_find(h->store, cancelled).state, RUN_CANCELLED);
    assert_int_equal(helper_find(h->store, waits).state, RUN_QUEUED);
    assert_string_equal(helper_find(h->store, kept).figures, "");
    check_curve(h->store, kept, 0.9973352459501292, 0.9970831667969885);
    check_curve(h->store, shared, 0.9973352459501292, 0.9970831667969885);
    check_curve(h->store, micro, 1.0, 1.0);
    check_peaks(h->store, kept, 3);
    check_peaks(h->store, shared, 3);
    check_peaks(h->store, half_way, 1);
    check_part(h->store);
    assert_int_equal(store_find_measurement(h->store, measured, &about, NULL), BF_OK);
    assert_string_equal(about.label, "camera");
    assert_int_equal(store_read_measurement(h->store, measured, &curve, NULL), BF_OK);
    assert_true(curve.n == 3 && at(&curve.values, 0) == 1.0 && at(&curve.values, 2) == 0.0);
    api_curve_fini(&curve);
    check_replay(h->store);
    check_lines(h->store);
    check_half_way(h);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(an_older_store_is_brought_up_to_date_with_all_it_has),
        STORE_TEST(a_run_begins_again_in_a_store_that_was_brought_up_to_date),
        STORE_TEST(a_store_of_version_4_is_there_with_all_it_had),
        STORE_TEST(an_older_store_with_owners_needs_tokens),
        STORE_TEST(a_run_of_an_older_store_is_removed_with_all_it_has),
        STORE_TEST(a_store_that_cannot_be_brought_up_to_date_stays_as_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
