// Unit tests of the store: lists and events. I1 ... I15 are the invariants of server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "server/store/conditions.h"
#include "server/store/sql.h"

#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N_MANY = 10000, N_EVENTS_MAX = 100 };

static api_run_list *list_runs(store *s, const api_list_query *query)
{
    api_run_list *list = calloc(1, sizeof *list);
    bf_error err = { 0 };

    assert_non_null(list);
    if (store_list(s, query, list, &err) != BF_OK)
        fail_msg("%s", err.text);
    return list;
}

static void a_list_goes_from_the_newest_to_the_oldest_in_pages(void **state)
{
    store *s = ((helper_store *)*state)->store;
    char ids[5][API_ID_SIZE];
    api_list_query query = { .state = -1, .model = -1, .limit = 2 };

    for (int i = 0; i < 5; i++)
        memcpy(ids[i], helper_submit(s, "", 0).id, API_ID_SIZE);
    for (int left = 5; left > 0; left -= 2) {
        api_run_list *list = list_runs(s, &query);
        assert_int_equal(list->n, left > 1 ? 2 : 1);
        assert_int_equal(list->has_more, left > 2);
        for (size_t i = 0; i < list->n; i++)
            assert_string_equal(list->runs[i].id, ids[left - 1 - (int)i]);
        memcpy(query.before, list->runs[list->n - 1].id, API_ID_SIZE);
        free(list);
    }
    api_run_list *list = list_runs(s, &query);
    assert_int_equal(list->n, 0);
    assert_false(list->has_more);
    free(list);
}

static size_t count_listed(store *s, const api_list_query *query)
{
    api_run_list *list = list_runs(s, query);
    size_t n = list->n;
    free(list);
    return n;
}

static size_t count_runs(store *s, int state, int model, const char *label)
{
    api_list_query query = { .state = state, .model = model, .limit = API_LIST_MAX };

    snprintf(query.label, sizeof query.label, "%s", label);
    return count_listed(s, &query);
}

static void a_list_can_be_narrowed(void **state)
{
    store *s = ((helper_store *)*state)->store;

    helper_submit(s, "red", 1);
    helper_submit(s, "red", 0);
    helper_submit(s, "blue", 0);
    helper_claim(s); // the first red one
    assert_int_equal(count_runs(s, -1, -1, ""), 3);
    assert_int_equal(count_runs(s, RUN_QUEUED, -1, ""), 2);
    assert_int_equal(count_runs(s, RUN_RUNNING, -1, ""), 1);
    assert_int_equal(count_runs(s, RUN_FAILED, -1, ""), 0);
    assert_int_equal(count_runs(s, -1, -1, "red"), 2);
    assert_int_equal(count_runs(s, RUN_QUEUED, -1, "red"), 1);
    assert_int_equal(count_runs(s, RUN_QUEUED, RUN_MACRO, "red"), 1);
    assert_int_equal(count_runs(s, -1, RUN_MICRO, ""), 0);
    assert_int_equal(count_runs(s, RUN_RUNNING, RUN_MICRO, ""), 0);
    assert_int_equal(count_runs(s, -1, -1, "re"), 0);
}

static void submit_for(store *s, const char *owner, const char *label)
{
    api_submission submission = { .model = RUN_MACRO };

    snprintf(submission.sender.owner, sizeof submission.sender.owner, "%s", owner);
    snprintf(submission.label, sizeof submission.label, "%s", label);
    assert_string_equal(helper_accept(s, &submission).owner, owner);
}

static size_t count_runs_of(store *s, const char *owner, int state, const char *label)
{
    api_list_query query = { .state = state, .model = -1, .limit = API_LIST_MAX };

    snprintf(query.owner, sizeof query.owner, "%s", owner);
    snprintf(query.label, sizeof query.label, "%s", label);
    return count_listed(s, &query);
}

static void a_list_can_be_narrowed_to_an_owner(void **state)
{
    store *s = ((helper_store *)*state)->store;

    submit_for(s, "alice", "red");
    submit_for(s, "bob", "red");
    submit_for(s, "alice", "blue");
    submit_for(s, "", "red");
    helper_claim(s); // alice's first
    assert_int_equal(count_runs_of(s, "", -1, ""), 4);
    assert_int_equal(count_runs_of(s, "alice", -1, ""), 2);
    assert_int_equal(count_runs_of(s, "alice", -1, "red"), 1);
    assert_int_equal(count_runs_of(s, "alice", RUN_QUEUED, ""), 1);
    assert_int_equal(count_runs_of(s, "alice", RUN_QUEUED, "red"), 0);
    assert_int_equal(count_runs_of(s, "bob", -1, ""), 1);
    assert_int_equal(count_runs_of(s, "ali", -1, ""), 0);
}

static void a_page_has_a_limit(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_list_query query = { .state = -1, .model = -1, .limit = API_LIST_MAX + 1 };
    static api_run_list list;

    list.n = 77;
    assert_int_equal(store_list(s, &query, &list, NULL), BF_ELIMIT);
    query.limit = 0;
    assert_int_equal(store_list(s, &query, &list, NULL), BF_ELIMIT);
    assert_int_equal(list.n, 77);
}

/// Events that a test took.
typedef struct taken {
    store *store;      ///< asked again in between, if not NULL
    bf_status answer;  ///< of take, once n reaches n_before
    size_t n_before;   ///< events that are taken before it
    size_t n;          ///< events
    api_event *events; ///< N_EVENTS_MAX of them, without data
    uint64_t after;    ///< each must be greater than the one before
} taken;

static bf_status take(void *context, const api_event *event, bf_error *err)
{
    taken *t = context;

    assert_true(event->id > t->after && t->n < N_EVENTS_MAX);
    t->after = event->id;
    t->events[t->n++] = *event;
    if (t->store != NULL)
        assert_string_equal(helper_find(t->store, event->run).id, event->run);
    if (t->answer != BF_OK && t->n > t->n_before)
        return bf_fail(err, t->answer, "", "enough");
    return BF_OK;
}

static void copy_ids(const api_run *runs, size_t n, char (*ret_ids)[API_ID_SIZE])
{
    for (size_t i = 0; i < n; i++)
        memcpy(ret_ids[i], runs[i].id, API_ID_SIZE);
}

static void events_of_several_runs_come_in_one_order(void **state)
{
    store *s = ((helper_store *)*state)->store;
    char ids[3][API_ID_SIZE];
    api_run runs[3];
    api_event events[N_EVENTS_MAX];
    taken t = { .events = events, .store = s };

    for (int i = 0; i < 3; i++)
        runs[i] = helper_start(s);
    copy_ids(runs, 3, ids);
    for (uint64_t first = 0; first < 4; first++)
        for (int i = 0; i < 2; i++)
            helper_append_samples(s, ids[i], first, 1);
    helper_append_snapshot(s, ids[1], 0);
    // Two of the three: each has the events queued, running and four samples; one a snapshot, too.
    assert_int_equal(
        store_read_events(s, (const char(*)[API_ID_SIZE])ids, 2, 0, SIZE_MAX, take, &t, NULL),
        BF_OK);
    assert_int_equal(t.n, 2 * 6 + 1);
    for (size_t i = 0; i < t.n; i++)
        assert_true(strcmp(events[i].run, ids[0]) == 0 || strcmp(events[i].run, ids[1]) == 0);
    assert_int_equal(events[t.n - 1].type, API_EVENT_SNAPSHOT);
    assert_int_equal(events[t.n - 1].snapshot, 0);
    assert_int_equal(t.after, helper_find(s, ids[1]).last_event);

    // Behind any of them come the others.
    size_t n_all = t.n;
    for (size_t i = 0; i < n_all; i++) {
        api_event rest[N_EVENTS_MAX];
        taken u = { .events = rest, .after = events[i].id };
        assert_int_equal(store_read_events(s, (const char(*)[API_ID_SIZE])ids, 2, events[i].id,
                                           SIZE_MAX, take, &u, NULL),
                         BF_OK);
        assert_int_equal(u.n, n_all - 1 - i);
    }
}

static void events_are_limited_by_their_bytes_but_one_always_comes(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_event events[N_EVENTS_MAX];
    char ids[1][API_ID_SIZE];
    api_run record = helper_start(s);
    taken t = { .events = events };

    copy_ids(&record, 1, ids);
    for (size_t i = 0; i < 2; i++)
        assert_int_equal(
            store_read_events(s, (const char(*)[API_ID_SIZE])ids, 1, t.after, 1, take, &t, NULL),
            BF_OK);
    assert_int_equal(t.n, 2);
    assert_int_equal(
        store_read_events(s, (const char(*)[API_ID_SIZE])ids, 1, t.after, 1, take, &t, NULL),
        BF_OK);
    assert_int_equal(t.n, 2);
    taken u = { .events = events };
    size_t limit = events[0].n + 2;
    assert_int_equal(
        store_read_events(s, (const char(*)[API_ID_SIZE])ids, 1, 0, limit, take, &u, NULL), BF_OK);
    assert_int_equal(u.n, 2);
}

static void a_refusal_to_take_an_event_is_passed_on(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_event events[N_EVENTS_MAX];
    char ids[1][API_ID_SIZE];
    api_run record = helper_start(s);
    taken t = { .events = events, .answer = BF_EBUSY };
    bf_error err = { 0 };

    copy_ids(&record, 1, ids);
    assert_int_equal(
        store_read_events(s, (const char(*)[API_ID_SIZE])ids, 1, 0, SIZE_MAX, take, &t, &err),
        BF_EBUSY);
    assert_int_equal(t.n, 1);
    assert_string_equal(err.text, "enough");
}

static void a_removed_run_has_no_events(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_event events[N_EVENTS_MAX];
    char ids[2][API_ID_SIZE];
    api_run runs[2] = { helper_submit(s, "", 0), helper_submit(s, "", 0) };
    taken t = { .events = events };

    copy_ids(runs, 2, ids);
    assert_int_equal(store_remove(s, ids[0], API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(
        store_read_events(s, (const char(*)[API_ID_SIZE])ids, 2, 0, SIZE_MAX, take, &t, NULL),
        BF_OK);
    assert_int_equal(t.n, 1);
    assert_string_equal(events[0].run, ids[1]);
}

static void many_runs_are_listed_page_by_page(void **state)
{
    helper_store *h = *state;
    api_list_query query = { .state = -1, .model = -1, .limit = API_LIST_MAX };
    size_t n = 0;
    bool has_more = true;

    helper_store_close(h);
    helper_store_sql(h, "WITH RECURSIVE number (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM number "
                        "WHERE i < 10000) INSERT INTO runs (id, state, model, priority, label, "
                        "name, created_ms) SELECT printf('%036d', i), 2, 0, 0, 'many', '', i "
                        "FROM number");
    helper_store_open(h);
    while (has_more) {
        api_run_list *list = list_runs(h->store, &query);
        for (size_t i = 0; i < list->n; i++)
            assert_int_equal(strtol(list->runs[i].id, NULL, 10), N_MANY - (long)(n + i));
        n += list->n;
        has_more = list->has_more;
        memcpy(query.before, list->runs[list->n - 1].id, API_ID_SIZE);
        free(list);
    }
    assert_int_equal(n, N_MANY);
}

// Ids as run_id.h makes them of 1 to 6 ms. From 2 to before 5 there are three, by each index and order, and on pages.
static void runs_are_listed_by_the_time_of_their_acceptance(void **state)
{
    static const api_list_query queries[] = {
        { .state = -1, .model = -1 },
        { .state = RUN_SUCCEEDED, .model = -1 },
        { .state = -1, .model = -1, .label = "many" },
        { .state = -1, .model = 0, .owner = "ada" },
        { .state = -1, .model = -1, .search = "any" },
        { .state = -1, .model = -1, .is_starred = true },
        { .state = -1, .model = -1, .sort = { .by = API_SORT_NAME, .is_rising = true } },
    };
    helper_store *h = *state;

    helper_store_close(h);
    helper_store_sql(h, "WITH RECURSIVE number (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM number "
                        "WHERE i < 6) INSERT INTO runs (id, state, model, priority, label, name, "
                        "created_ms, owner, starred) SELECT printf("
                        "'00000000-%04x-7000-8000-000000000000', i), 2, 0, 0, 'many', 'run', i, "
                        "'ada', 1 FROM number");
    helper_store_open(h);
    for (size_t k = 0; k < sizeof queries / sizeof *queries; k++) {
        api_list_query query = queries[k];
        query.from_ms = 2;
        query.before_ms = 5;
        query.counts = true;
        query.limit = 2;
        api_run_list *list = list_runs(h->store, &query);
        assert_int_equal(list->n, 2);
        assert_int_equal(list->runs[0].created_ms, 4);
        assert_true(list->has_more);
        assert_int_equal(list->total, 3);
        memcpy(query.before, list->last_id, API_ID_SIZE);
        memcpy(query.before_key, list->last_key, sizeof query.before_key);
        free(list);
        list = list_runs(h->store, &query);
        assert_int_equal(list->n, 1);
        assert_int_equal(list->runs[0].created_ms, 2);
        assert_false(list->has_more);
        free(list);
    }
}

// A filter that hardly any run has looks at a bounded number of runs for a page; what is older has pages of its own.
static void a_filter_looks_at_a_bounded_number_of_runs(void **state)
{
    helper_store *h = *state;
    api_list_query query = { .state = -1, .model = 1, .limit = API_LIST_MAX };
    char sql[400];

    helper_store_close(h);
    snprintf(
        sql, sizeof sql,
        "WITH RECURSIVE number (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM number WHERE "
        "i < %d) INSERT INTO runs (id, state, model, priority, label, name, created_ms, owner) "
        "SELECT printf('%%036d', i), 2, i = 2, 0, '', '', i, 'ada' FROM number",
        API_LIST_LOOKS + 2);
    helper_store_sql(h, sql);
    helper_store_open(h);
    for (int k = 0; k < 2; k++) {
        query.before[0] = '\0';
        api_run_list *list = list_runs(h->store, &query);
        assert_int_equal(list->n, 0);
        assert_true(list->has_more);
        assert_int_equal(strtol(list->last_id, NULL, 10), 3);
        memcpy(query.before, list->last_id, API_ID_SIZE);
        free(list);
        list = list_runs(h->store, &query);
        assert_int_equal(list->n, 1);
        assert_false(list->has_more);
        free(list);
        snprintf(query.owner, sizeof query.owner, "ada"); // the same by another index
        query.state = RUN_SUCCEEDED;
    }
}

// A step of a query's plan that looks at every row of a table, or sorts. What a query in brackets found is no table.
static bool is_slow(const char *step)
{
    if (strncmp(step, "SCAN (subquery", 14) == 0)
        return false;
    return strstr(step, "TEMP B-TREE") != NULL ||
           (strncmp(step, "SCAN ", 5) == 0 && strstr(step, "USING") == NULL);
}

static void no_statement_scans_a_table_or_sorts(void **state)
{
    static const char *const texts[] = {
#define X(name, text) text,
        STORE__SQL_LIST(X)
#undef X
    };
    helper_store *h = *state;
    char path[128], sql[4000];
    sqlite3 *db = NULL;

    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    assert_int_equal(sqlite3_open_v2(path, &db, SQLITE_OPEN_READONLY, NULL), SQLITE_OK);
    assert_int_equal(store__add_conditions(db), SQLITE_OK);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        sqlite3_stmt *statement = NULL;
        assert_true(snprintf(sql, sizeof sql, "EXPLAIN QUERY PLAN %s", texts[i]) < (int)sizeof sql);
        // Tokens are in another database, of at most TOKENS_MAX rows.
        if (strstr(texts[i], "tokens") != NULL)
            continue;
        // Pages by keys are sorted, of a bounded number of runs.
        if (strstr(texts[i], "sort_key") != NULL)
            continue;
        // Of owners there are no more than tokens, and of studies that have not ended STORE_STUDIES_OPEN_MAX at most.
        if (strstr(texts[i], "GROUP BY owner") != NULL ||
            strstr(texts[i], "FROM owners WHERE EXISTS") ||
            strstr(texts[i], "AND stop_request = 0 ORDER BY priority DESC, (SELECT"))
            continue;
        // Only statements that read or change tables have a plan.
        if (strchr(texts[i], '(') == NULL && strstr(texts[i], "WHERE") == NULL)
            continue;
        assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &statement, NULL), SQLITE_OK);
        while (sqlite3_step(statement) == SQLITE_ROW) {
            const char *step = (const char *)sqlite3_column_text(statement, 3);
            if (is_slow(step))
                fail_msg("%s: %s", texts[i], step);
        }
        sqlite3_finalize(statement);
    }
    sqlite3_close(db);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_list_goes_from_the_newest_to_the_oldest_in_pages),
        STORE_TEST(a_list_can_be_narrowed),
        STORE_TEST(a_list_can_be_narrowed_to_an_owner),
        STORE_TEST(a_page_has_a_limit),
        STORE_TEST(events_of_several_runs_come_in_one_order),
        STORE_TEST(events_are_limited_by_their_bytes_but_one_always_comes),
        STORE_TEST(a_refusal_to_take_an_event_is_passed_on),
        STORE_TEST(a_removed_run_has_no_events),
        STORE_TEST(many_runs_are_listed_page_by_page),
        STORE_TEST(runs_are_listed_by_the_time_of_their_acceptance),
        STORE_TEST(a_filter_looks_at_a_bounded_number_of_runs),
        STORE_TEST(no_statement_scans_a_table_or_sorts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
