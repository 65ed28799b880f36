// Lists of runs in other orders than that of creation, searches, and totals.

#include "tests/unit/server/helper_store.h"

#include "api/scenario/condition.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The runs of this test, in the order of their creation. An empty `figures` is a run without key figures.
static const struct {
    const char *name, *label;
    int model, state;
    const char *figures;
} runs[] = {
    { "Belt at 60 degrees", "hall 1", 0, 2, "{'throughput_per_h':300.5,'residence_s':{'p95':4}}" },
    { "belt at 45 degrees", "", 1, 2, "{'throughput_per_h':100,'residence_s':{'p95':2.5}}" },
    { "Belt at 75 degrees", "Hall 2", 0, 0, "" },
    { "a feeder", "", 1, 3, "{'residence_s':{'p95':2.5}}" },
    { "Belt at 60 degrees", "hall 1", 0, 2, "{'throughput_per_h':300.5}" },
};
enum { N_RUNS = sizeof runs / sizeof *runs };

// A UUID whose last digit is the index.
static void make_id(size_t index, char ret_id[API_ID_SIZE])
{
    (void)snprintf(ret_id, API_ID_SIZE, "00000000-0000-7000-8000-00000000000%zu", index);
}

static void fill(helper_store *h)
{
    char sql[800], figures[200], id[API_ID_SIZE];

    helper_store_close(h);
    for (size_t i = 0; i < N_RUNS; i++) {
        (void)snprintf(figures, sizeof figures, "%s", runs[i].figures);
        for (char *c = figures; *c != '\0'; c++)
            *c = *c == '\'' ? '"' : *c;
        make_id(i, id);
        (void)snprintf(sql, sizeof sql,
                       "INSERT INTO runs (id, state, model, priority, label, name, created_ms, "
                       "finished_ms, figures) VALUES ('%s', %d, %d, 0, '%s', '%s', %zu, %zu, '%s')",
                       id, runs[i].state, runs[i].model, runs[i].label, runs[i].name, i + 1,
                       runs[i].state >= 2 ? 100 - i : 0, figures);
        helper_store_sql(h, sql);
    }
    helper_store_open(h);
}

static void list_page(store *s, api_list_query *query, char *ret_order, api_run_list *list)
{
    bf_error err = { 0 };

    if (store_list(s, query, list, &err) != BF_OK)
        fail_msg("%s", err.text);
    for (size_t i = 0; i < list->n; i++)
        strncat(ret_order, list->runs[i].id + API_ID_SIZE - 2, 1);
    if (list->n == 0)
        return;
    memcpy(query->before, list->runs[list->n - 1].id, API_ID_SIZE);
    memcpy(query->before_key, list->last_key, API_SORT_KEY_SIZE);
}

// The indices of the runs in the order of a list, page by page of so many.
static void assert_order(store *s, api_list_query query, size_t limit, const char *expected)
{
    api_run_list *list = calloc(1, sizeof *list);
    char order[N_RUNS + 2] = "";

    assert_non_null(list);
    query.state = query.state == 0 ? -1 : query.state;
    query.model = -1;
    query.limit = limit;
    do {
        assert_true(strlen(order) <= N_RUNS);
        list_page(s, &query, order, list);
    } while (list->has_more);
    assert_string_equal(order, expected);
    free(list);
}

// Whatever the pages, every run comes once and in order.
static void assert_sorted(store *s, api_sort sort, const char *expected)
{
    for (size_t limit = 1; limit <= N_RUNS; limit++)
        assert_order(s, (api_list_query){ .sort = sort }, limit, expected);
}

static void runs_are_sorted_by_their_texts_in_pages(void **state)
{
    helper_store *h = *state;

    fill(h);
    assert_sorted(h->store, (api_sort){ .by = API_SORT_NAME, .is_rising = true }, "31402");
    assert_sorted(h->store, (api_sort){ .by = API_SORT_NAME }, "24013");
    // Runs without a label are last either way, the newest of them first.
    assert_sorted(h->store, (api_sort){ .by = API_SORT_LABEL, .is_rising = true }, "40231");
    assert_sorted(h->store, (api_sort){ .by = API_SORT_LABEL }, "24031");
}

static void runs_are_sorted_by_what_they_are(void **state)
{
    helper_store *h = *state;

    fill(h);
    assert_sorted(h->store, (api_sort){ .by = API_SORT_CREATED }, "43210");
    assert_sorted(h->store, (api_sort){ .by = API_SORT_CREATED, .is_rising = true }, "01234");
    assert_sorted(h->store, (api_sort){ .by = API_SORT_MODEL, .is_rising = true }, "42031");
    assert_sorted(h->store, (api_sort){ .by = API_SORT_STATUS }, "34102");
    // The first one ended last; the third has not ended.
    assert_sorted(h->store, (api_sort){ .by = API_SORT_FINISHED }, "01342");
}

static void runs_are_sorted_by_key_figures(void **state)
{
    helper_store *h = *state;

    fill(h);
    assert_sorted(h->store, (api_sort){ .by = API_SORT_FIGURE, .figure = "throughput_per_h" },
                  "40132");
    assert_sorted(
        h->store,
        (api_sort){ .by = API_SORT_FIGURE, .is_rising = true, .figure = "residence_s.p95" },
        "31042");
}

// A run that was removed between two pages neither hides nor repeats another.
static void a_cursor_outlives_its_run(void **state)
{
    helper_store *h = *state;
    api_list_query query = {
        .state = -1, .model = -1, .limit = 2, .sort = { .by = API_SORT_NAME, .is_rising = true }
    };
    api_run_list *list = calloc(1, sizeof *list);
    char order[N_RUNS + 2] = "", id[API_ID_SIZE];

    assert_non_null(list);
    fill(h);
    list_page(h->store, &query, order, list);
    make_id(1, id);
    assert_int_equal(store_remove(h->store, id, API_ANY_REVISION, NULL), BF_OK);
    query.limit = N_RUNS;
    list_page(h->store, &query, order, list);
    assert_string_equal(order, "31402");
    free(list);
}

static void a_search_finds_names_and_labels(void **state)
{
    helper_store *h = *state;

    fill(h);
    assert_order(h->store, (api_list_query){ .search = "belt at" }, 2, "4210");
    assert_order(h->store, (api_list_query){ .search = "hall" }, 2, "420");
    assert_order(h->store, (api_list_query){ .search = "60" }, 1, "40");
    assert_order(h->store, (api_list_query){ .search = "%" }, 2, "");
    assert_order(h->store,
                 (api_list_query){ .search = "belt", .sort = { API_SORT_NAME, true, "" } }, 2,
                 "1402");
    assert_order(h->store, (api_list_query){ .search = "belt", .state = RUN_SUCCEEDED }, 2, "410");
}

static uint64_t count(store *s, api_list_query query)
{
    api_run_list *list = calloc(1, sizeof *list);

    assert_non_null(list);
    query.model = -1;
    query.state = query.state == 0 ? -1 : query.state;
    query.limit = 1;
    query.counts = true;
    assert_int_equal(store_list(s, &query, list, NULL), BF_OK);
    assert_true(list->has_total);
    const uint64_t total = list->total;
    free(list);
    return total;
}

static void totals_count_all_pages(void **state)
{
    helper_store *h = *state;
    api_list_query behind = { .search = "belt" };

    fill(h);
    assert_int_equal(count(h->store, (api_list_query){ .limit = 1 }), N_RUNS);
    assert_int_equal(count(h->store, (api_list_query){ .search = "belt" }), 4);
    assert_int_equal(count(h->store, (api_list_query){ .label = "hall 1" }), 2);
    assert_int_equal(count(h->store, (api_list_query){ .state = RUN_FAILED }), 1);
    make_id(2, behind.before);
    assert_int_equal(count(h->store, behind), 4);
}

// One run more than is looked at, and only the oldest has the name.
static void only_the_newest_runs_are_looked_at(void **state)
{
    helper_store *h = *state;

    helper_store_close(h);
    helper_store_sql(h, "WITH RECURSIVE number (i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM number "
                        "WHERE i < 50000) INSERT INTO runs (id, state, model, priority, label, "
                        "name, created_ms) SELECT printf('%036d', i), 2, 0, 0, '', "
                        "CASE i WHEN 0 THEN 'old' WHEN 1 THEN 'less old' ELSE '' END, i "
                        "FROM number");
    helper_store_open(h);
    assert_int_equal(count(h->store, (api_list_query){ .limit = 1 }), API_LIST_NEWEST);
    assert_int_equal(count(h->store, (api_list_query){ .search = "old" }), 1);
    assert_order(h->store, (api_list_query){ .search = "old" }, 2, "1");
}

// Scenarios as texts of the runs of the test: duration_s is the index.
static void add_scenarios(helper_store *h)
{
    helper_store_close(h);
    helper_store_sql(h, "INSERT INTO texts (run, kind, data) SELECT number, 0, "
                        "printf('{\"duration_s\":%d}', number - 1) FROM runs");
    helper_store_open(h);
}

static api_list_query where(const char *text)
{
    api_list_query query = { 0 };

    assert_int_equal(condition_list_read(text, &query.conditions, NULL), BF_OK);
    return query;
}

static void conditions_find_scenarios_and_key_figures(void **state)
{
    helper_store *h = *state;
    api_list_query failed = where("duration_s>0"), by_name = where("duration_s>=1");

    fill(h);
    assert_order(h->store, where("duration_s>0"), 2, ""); // these have no scenario
    add_scenarios(h);
    assert_order(h->store, where("duration_s>1"), 2, "432");
    assert_order(h->store, where("throughput_per_h>200"), 1, "40");
    assert_order(h->store, where("residence_s/p95=2.5,duration_s<2"), 2, "1");
    assert_int_equal(count(h->store, where("duration_s<=3")), 4);
    failed.state = RUN_FAILED;
    assert_order(h->store, failed, 2, "3");
    by_name.sort = (api_sort){ .by = API_SORT_NAME, .is_rising = true };
    assert_order(h->store, by_name, 2, "3142");
}

static void only_the_newest_scenarios_are_read(void **state)
{
    helper_store *h = *state;

    helper_store_close(h);
    helper_store_sql(h, "WITH RECURSIVE number (i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM number "
                        "WHERE i < 10000) INSERT INTO runs (id, state, model, priority, label, "
                        "name, created_ms) SELECT printf('%036d', i), 2, 0, 0, '', '', i "
                        "FROM number");
    helper_store_open(h);
    add_scenarios(h);
    assert_int_equal(count(h->store, where("duration_s>=0")), API_LIST_DOCUMENTS);
    assert_order(h->store, where("duration_s<2"), 2, "1");
}

// An id that is too long would be cut to that of another run.
static void a_row_that_no_run_can_have_is_damage(void **state)
{
    static const char *const changes[] = { "id = id || '0'", "model = 9", "stop_request = 3" };
    static api_run_list list;
    helper_store *h = *state;
    const api_list_query all = { .state = -1, .model = -1, .limit = 10 };
    char sql[100];

    for (size_t k = 0; k < sizeof changes / sizeof *changes; k++) {
        const api_run record = helper_submit(h->store, "", 0);
        assert_int_equal(store_list(h->store, &all, &list, NULL), BF_OK);
        snprintf(sql, sizeof sql, "UPDATE runs SET %s", changes[k]);
        helper_store_sql(h, sql);
        assert_int_equal(store_list(h->store, &all, &list, NULL), BF_ECORRUPT);
        snprintf(sql, sizeof sql, "UPDATE runs SET id = '%s', model = 0, stop_request = 0",
                 record.id);
        helper_store_sql(h, sql);
        assert_int_equal(store_remove(h->store, record.id, API_ANY_REVISION, NULL), BF_OK);
    }
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(runs_are_sorted_by_their_texts_in_pages),
        STORE_TEST(runs_are_sorted_by_what_they_are),
        STORE_TEST(runs_are_sorted_by_key_figures),
        STORE_TEST(a_cursor_outlives_its_run),
        STORE_TEST(a_search_finds_names_and_labels),
        STORE_TEST(totals_count_all_pages),
        STORE_TEST(only_the_newest_runs_are_looked_at),
        STORE_TEST(conditions_find_scenarios_and_key_figures),
        STORE_TEST(only_the_newest_scenarios_are_read),
        STORE_TEST(a_row_that_no_run_can_have_is_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
