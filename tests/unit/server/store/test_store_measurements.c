// Unit tests of the store: measured curves. I1 ... I15 are the
// invariants of server/store/store.h.

#include "core/base/memory.h"
#include "server/store/store_priv.h"
#include "tests/unit/server/helper_store.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#define NO_ID "01234567-89ab-7cde-8f01-23456789abcd"

// A curve of n samples at 0, 0.1, ... that falls from n by one part each; api_curve_fini().
static api_curve make_curve(size_t n)
{
    api_curve curve = { .n = n, .n_columns = 1 };

    assert_int_equal(buffer_printf(&curve.columns, "gate"), BF_OK);
    for (size_t k = 0; k < n; k++) {
        double t = 0.1 * (double)k, count = (double)(n - k);
        assert_int_equal(buffer_append(&curve.t, &t, sizeof t), BF_OK);
        assert_int_equal(buffer_append(&curve.values, &count, sizeof count), BF_OK);
    }
    return curve;
}

static api_measurement describe(const char *label, const api_curve *curve)
{
    api_measurement about = { .counter = "gate", .t_end = 0.1 * (double)(curve->n - 1) };

    snprintf(about.label, sizeof about.label, "%s", label);
    return about;
}

static bf_status try_add(store *s, const char *label, size_t n, api_measurement *ret_added,
                         bf_error *err)
{
    api_curve curve = make_curve(n);
    api_measurement about = describe(label, &curve);

    bf_status status = store_add_measurement(s, &about, &curve, &(bf_buffer){ 0 }, ret_added, err);
    api_curve_fini(&curve);
    return status;
}

static api_measurement add(store *s, const char *label, size_t n)
{
    api_measurement added = { .n_samples = 0 };
    bf_error err = { 0 };

    if (try_add(s, label, n, &added, &err) != BF_OK)
        fail_msg("%s", err.text);
    return added;
}

static void assert_stored(store *s, const api_measurement *added)
{
    api_measurement found = { .n_samples = 0 };
    api_curve curve = { 0 };

    assert_int_equal(store_find_measurement(s, added->id, &found, NULL), BF_OK);
    assert_string_equal(found.id, added->id);
    assert_string_equal(found.label, added->label);
    assert_string_equal(found.counter, added->counter);
    assert_int_equal(found.created_ms, added->created_ms);
    assert_int_equal(found.n_samples, added->n_samples);
    assert_true(found.t_start == added->t_start && found.t_end == added->t_end);
    assert_int_equal(store_read_measurement(s, added->id, &curve, NULL), BF_OK);
    api_curve expected = make_curve((size_t)added->n_samples);
    assert_int_equal(curve.n, expected.n);
    assert_int_equal(curve.n_columns, 1);
    assert_string_equal(curve.columns.bytes, "gate");
    assert_int_equal(curve.t.n, expected.t.n);
    assert_memory_equal(curve.t.bytes, expected.t.bytes, expected.t.n);
    assert_int_equal(curve.values.n, expected.values.n);
    assert_memory_equal(curve.values.bytes, expected.values.bytes, expected.values.n);
    api_curve_fini(&curve);
    api_curve_fini(&expected);
}

// I1, I13
static void a_measurement_comes_back_bit_by_bit_after_a_restart(void **state)
{
    helper_store *h = *state;
    api_measurement small = add(h->store, "camera", 2);
    api_measurement large = add(h->store, "", API_MEASUREMENT_SAMPLES_MAX);

    assert_true(strcmp(small.id, large.id) < 0 && small.created_ms > 1700000000000);
    assert_stored(h->store, &small);
    helper_store_close(h);
    helper_store_open(h);
    assert_stored(h->store, &small);
    assert_stored(h->store, &large);
}

// I1, I13
static void a_text_for_feeds_comes_back_as_it_was(void **state)
{
    static const api_measured kinds[] = { API_MEASURED_PROFILE, API_MEASURED_SCHEDULE };
    static const char text[] = "t_s,count\r\n0,5\r\n1,4\r\n";
    helper_store *h = *state;
    api_measurement added[2], found;
    bf_buffer csv = { 0 }, read = { 0 };
    api_curve none = { 0 };

    assert_int_equal(buffer_append(&csv, text, sizeof text - 1), BF_OK);
    for (int k = 0; k < 2; k++) {
        const api_measurement about = {
            .kind = kinds[k], .label = "day", .n_samples = 2, .t_end = 1.0
        };
        assert_int_equal(store_add_measurement(h->store, &about, &none, &csv, &added[k], NULL),
                         BF_OK);
    }
    helper_store_close(h);
    helper_store_open(h);
    for (int k = 0; k < 2; k++) {
        assert_int_equal(store_find_measurement(h->store, added[k].id, &found, NULL), BF_OK);
        assert_int_equal(found.kind, kinds[k]);
        assert_int_equal(found.n_samples, 2);
        assert_true(found.t_start == 0.0 && found.t_end == 1.0);
        read.n = 0;
        assert_int_equal(store_read_measurement_csv(h->store, added[k].id, &read, NULL), BF_OK);
        assert_string_equal(read.bytes, text);
        assert_int_equal(store_remove_measurement(h->store, added[k].id, NULL), BF_OK);
        assert_int_equal(store_read_measurement_csv(h->store, added[k].id, &read, NULL),
                         BF_ENOTFOUND);
    }
    buffer_fini(&csv);
    buffer_fini(&read);
}

static void measurements_are_listed_newest_first(void **state)
{
    store *s = ((helper_store *)*state)->store;
    static api_page list;
    api_measurement all[5];
    api_page_query query = { .limit = 2 };

    for (int i = 0; i < 5; i++)
        all[i] = add(s, i % 2 == 0 ? "even" : "odd", 3);
    assert_int_equal(store_list_measurements(s, &query, &list, NULL), BF_OK);
    assert_true(list.n == 2 && list.has_more);
    assert_string_equal(list.measurements[0].id, all[4].id);
    assert_string_equal(list.measurements[1].id, all[3].id);
    assert_int_equal(list.measurements[1].n_samples, 3);
    memcpy(query.before, list.measurements[1].id, sizeof query.before);
    query.limit = 3;
    assert_int_equal(store_list_measurements(s, &query, &list, NULL), BF_OK);
    assert_true(list.n == 3 && !list.has_more);
    assert_string_equal(list.measurements[2].id, all[0].id);
    strcpy(query.label, "even");
    assert_int_equal(store_list_measurements(s, &query, &list, NULL), BF_OK);
    assert_true(list.n == 2 && !list.has_more);
    assert_string_equal(list.measurements[0].id, all[2].id);
    list.n = 77;
    query.limit = 0;
    assert_int_equal(store_list_measurements(s, &query, &list, NULL), BF_ELIMIT);
    query.limit = API_LIST_MAX + 1;
    assert_int_equal(store_list_measurements(s, &query, &list, NULL), BF_ELIMIT);
    assert_int_equal(list.n, 77);
}

static void a_removed_measurement_is_gone(void **state)
{
    helper_store *h = *state;
    api_measurement added = add(h->store, "", 3), kept = add(h->store, "", 4);
    api_measurement found = { .n_samples = 77 };
    api_curve curve = { .n = 77 };

    assert_int_equal(store_remove_measurement(h->store, added.id, NULL), BF_OK);
    assert_int_equal(store_remove_measurement(h->store, added.id, NULL), BF_ENOTFOUND);
    assert_int_equal(store_find_measurement(h->store, added.id, &found, NULL), BF_ENOTFOUND);
    assert_int_equal(store_read_measurement(h->store, NO_ID, &curve, NULL), BF_ENOTFOUND);
    assert_true(found.n_samples == 77 && curve.n == 77);
    assert_stored(h->store, &kept);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM measurements"), 1);
}

// I13: a run's end is not a measurement's.
static void removing_runs_leaves_measurements_alone(void **state)
{
    helper_store *h = *state;
    api_measurement added = add(h->store, "", 3);
    api_run record = helper_submit(h->store, "", 0);

    assert_int_equal(store_remove(h->store, record.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(store_remove(h->store, added.id, API_ANY_REVISION, NULL), BF_ENOTFOUND);
    assert_int_equal(store_remove_measurement(h->store, record.id, NULL), BF_ENOTFOUND);
    assert_stored(h->store, &added);
}

// I13
static void there_is_a_limit_to_measurements(void **state)
{
    helper_store *h = *state;
    api_measurement added = add(h->store, "", 2), refused = { .n_samples = 77 };
    bf_error err = { 0 };
    char fill[320];

    helper_store_close(h);
    snprintf(fill, sizeof fill,
             "WITH RECURSIVE k (i) AS (SELECT 2 UNION ALL SELECT i + 1 FROM k WHERE i < %d) "
             "INSERT INTO measurements SELECT 'copy ' || i, kind, label, counter, created_ms, n, "
             "t_start, t_end, t, counts, csv, owner FROM measurements, k",
             API_MEASUREMENTS_MAX);
    helper_store_sql(h, fill);
    helper_store_open(h);
    assert_int_equal(try_add(h->store, "", 2, &refused, &err), BF_ECONFLICT);
    assert_non_null(strstr(err.text, "the limit is 2000"));
    assert_int_equal(refused.n_samples, 77);
    assert_int_equal(store_remove_measurement(h->store, added.id, NULL), BF_OK);
    add(h->store, "", 2);
}

static void damage_is_noticed(void **state)
{
    helper_store *h = *state;
    api_measurement added = add(h->store, "", 3);
    api_curve curve = { .n = 77 };

    helper_store_close(h);
    helper_store_sql(h, "ALTER TABLE measurements RENAME TO damaged");
    helper_store_sql(h, "CREATE TABLE measurements AS SELECT id, kind, label, counter, created_ms, "
                        "n, t_start, t_end, t, x'00' AS counts, csv, owner FROM damaged");
    helper_store_open(h);
    assert_int_equal(store_read_measurement(h->store, added.id, &curve, NULL), BF_ECORRUPT);
    assert_int_equal(curve.n, 77);
}

// An id that is too long would be cut to that of another measurement.
static void a_row_that_no_measurement_can_have_is_damage(void **state)
{
    static const char *const changes[] = { "id = id || '0'", "id = substr(id, 2)", "kind = 9" };
    static api_page list;
    helper_store *h = *state;
    const api_page_query query = { .limit = 1 };
    api_measurement found = { .n_samples = 77 };
    char sql[100], id[API_ID_SIZE + 1];

    for (size_t k = 0; k < sizeof changes / sizeof *changes; k++) {
        const api_measurement added = add(h->store, "", 3);
        list.n = 77;
        snprintf(sql, sizeof sql, "UPDATE measurements SET %s", changes[k]);
        helper_store_sql(h, sql);
        snprintf(id, sizeof id, "%s%s", added.id + (k == 1), k == 0 ? "0" : "");
        assert_int_equal(store_list_measurements(h->store, &query, &list, NULL), BF_ECORRUPT);
        assert_int_equal(store_find_measurement(h->store, id, &found, NULL), BF_ECORRUPT);
        assert_true(list.n == 77 && found.n_samples == 77);
        helper_store_sql(h, "DELETE FROM measurements");
    }
}

/// A call of the store, and what must hold when it failed.
typedef bf_status attempt(store *s, const api_measurement *m, bf_error *err);

// Made beforehand: only the store's own allocations are to fail.
static api_curve prepared;

static bf_status attempt_add(store *s, const api_measurement *m, bf_error *err)
{
    api_measurement about = *m, added = { .n_samples = 77 };

    bf_status status = store_add_measurement(s, &about, &prepared, &(bf_buffer){ 0 }, &added, err);
    assert_int_equal(added.n_samples, status == BF_OK ? 3 : 77);
    return status;
}

static bf_status attempt_read(store *s, const api_measurement *m, bf_error *err)
{
    api_curve curve = { .n = 77 };

    bf_status status = store_read_measurement(s, m->id, &curve, err);
    assert_int_equal(curve.n, status == BF_OK ? 3 : 77);
    if (status == BF_OK)
        api_curve_fini(&curve);
    return status;
}

static bf_status attempt_list(store *s, const api_measurement *m, bf_error *err)
{
    static api_page list;
    api_page_query query = { .limit = 10 };

    list.n = 77;
    bf_status status = store_list_measurements(s, &query, &list, err);
    assert_true(status == BF_OK ? list.n >= 1 : list.n == 77);
    return status;
}

static bf_status attempt_remove(store *s, const api_measurement *m, bf_error *err)
{
    return store_remove_measurement(s, m->id, err);
}

// Let the n-th allocation fail, for n = 1, 2, ... until the call succeeds without a failure.
static void walk(attempt *call, store *s, const api_measurement *m)
{
    for (size_t n = 1;; n++) {
        bf_error err = { 0 };
        memory_plan_fault(n, 0);
        bf_status status = call(s, m, &err);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        if (n_faults == 0) {
            assert_int_equal(status, BF_OK);
            return;
        }
        assert_int_equal(status, BF_ENOMEM);
        assert_int_equal(err.code, BF_ENOMEM);
    }
}

// I13
static void without_memory_every_call_fails_and_changes_nothing(void **state)
{
    helper_store *h = *state;
    api_measurement added = add(h->store, "", 3);

    prepared = make_curve(3);
    walk(attempt_add, h->store, &added);
    api_curve_fini(&prepared);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM measurements"), 2);
    walk(attempt_read, h->store, &added);
    walk(attempt_list, h->store, &added);
    walk(attempt_remove, h->store, &added);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM measurements"), 1);
}

// I1, I13: the log may not grow by 1.6 MB, so that nothing of the large one is stored.
static void a_measurement_that_finds_no_room_is_not_there(void **state)
{
    helper_store *h = *state;
    api_measurement kept = add(h->store, "", 3), lost = { .n_samples = 77 };
    struct rlimit limit;
    bf_error err = { 0 };

    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    rlim_t before = limit.rlim_cur;
    limit.rlim_cur = 1000000;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    bf_status status = try_add(h->store, "", API_MEASUREMENT_SAMPLES_MAX, &lost, &err);
    limit.rlim_cur = before;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    assert_int_equal(status, BF_ESYSTEM);
    assert_int_equal(lost.n_samples, 77);
    helper_store_close(h);
    helper_store_open(h);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM measurements"), 1);
    assert_stored(h->store, &kept);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_measurement_comes_back_bit_by_bit_after_a_restart),
        STORE_TEST(a_text_for_feeds_comes_back_as_it_was),
        STORE_TEST(measurements_are_listed_newest_first),
        STORE_TEST(a_removed_measurement_is_gone),
        STORE_TEST(removing_runs_leaves_measurements_alone),
        STORE_TEST(there_is_a_limit_to_measurements),
        STORE_TEST(damage_is_noticed),
        STORE_TEST(a_row_that_no_measurement_can_have_is_damage),
        STORE_TEST(without_memory_every_call_fails_and_changes_nothing),
        STORE_TEST(a_measurement_that_finds_no_room_is_not_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
