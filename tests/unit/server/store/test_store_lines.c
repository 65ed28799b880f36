// Lines: which runs belong to one, and the numbers of its scenarios.

#include "tests/unit/server/helper_store.h"

#include "api/scenario/submission.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char body[] =
    "{\"scenario\": {\"name\": \"%s\", \"duration_s\": %s, \"domain\": {\"x_m\": [0, 0.24], "
    "\"y_m\": [0, 0.12]}, \"cargo\": {\"shape\": {\"type\": \"cylinder\", \"radius_m\": 0.012, "
    "\"height_m\": 0.008}}, \"initial\": {\"positions_m\": [[0.06, 0.06]]}}, \"model\": \"%s\", "
    "\"line\": \"%s\"}";

// A run of an owner; only its name, duration, model and line differ from others.
static api_run submit(store *s, const char *owner, const char *line, const char *name,
                      const char *duration_s, const char *model)
{
    api_submission submission;
    char json[600];
    bf_faults faults = { 0 };
    bf_error err = { 0 };

    int n = snprintf(json, sizeof json, body, name, duration_s, model, line);
    if (submission_read(json, (size_t)n, NULL, &submission, &faults, &err) != BF_OK)
        fail_msg("%s", err.text);
    snprintf(submission.sender.owner, sizeof submission.sender.owner, "%s", owner);
    const api_run record = helper_accept(s, &submission);
    submission_fini(&submission);
    return record;
}

static void scenarios_of_a_line_are_numbered_in_the_order_of_their_first_use(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = submit(s, "", "hall 2", "as built", "6", "macro");

    assert_string_equal(record.line, "hall 2");
    assert_int_equal(record.line_version, 1);
    assert_int_equal(submit(s, "", "hall 2", "longer", "7", "macro").line_version, 2);
    // Neither the name nor the model makes another scenario.
    assert_int_equal(submit(s, "", "hall 2", "again", "6", "micro").line_version, 1);
    assert_int_equal(submit(s, "", "hall 2", "shorter", "5", "micro").line_version, 3);
    assert_int_equal(submit(s, "", "hall 3", "as built", "5", "macro").line_version, 1);
    assert_int_equal(submit(s, "ada", "hall 2", "hers", "5", "macro").line_version, 1);
    record = submit(s, "", "", "alone", "6", "macro");
    assert_string_equal(record.line, "");
    assert_int_equal(record.line_version, 0);
}

static void the_number_of_a_scenario_is_kept_while_a_run_has_it(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_run first = submit(s, "", "hall 2", "as built", "6", "macro");

    (void)submit(s, "", "hall 2", "longer", "7", "macro");
    assert_int_equal(store_remove(s, first.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(submit(s, "", "hall 2", "longer", "7", "micro").line_version, 2);
    assert_int_equal(submit(s, "", "hall 2", "as built", "6", "macro").line_version, 3);
}

static void a_run_that_changes_its_line_is_numbered_there(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_annotations to = { .name = "a belt", .line = "hall 2" };
    const api_run moved = submit(s, "", "", "alone", "7", "macro");
    api_run record;

    (void)submit(s, "", "hall 2", "as built", "6", "macro");
    assert_int_equal(store_annotate(s, moved.id, moved.revision, &to, &record, NULL), BF_OK);
    assert_string_equal(record.line, "hall 2");
    assert_int_equal(record.line_version, 2);
    assert_int_equal(helper_find(s, moved.id).line_version, 2);
    assert_int_equal(submit(s, "", "hall 2", "the same", "7", "micro").line_version, 2);
    // What leaves the line as it is leaves the number, too.
    snprintf(to.notes, sizeof to.notes, "as measured");
    assert_int_equal(store_annotate(s, moved.id, API_ANY_REVISION, &to, &record, NULL), BF_OK);
    assert_int_equal(record.line_version, 2);
    to.line[0] = '\0';
    assert_int_equal(store_annotate(s, moved.id, API_ANY_REVISION, &to, &record, NULL), BF_OK);
    assert_string_equal(record.line, "");
    assert_int_equal(record.line_version, 0);
}

static void assert_listed(store *s, api_list_query query, const char *const *names, size_t n)
{
    api_run_list *list = calloc(1, sizeof *list);

    assert_non_null(list);
    query.state = query.model = -1;
    query.limit = API_LIST_MAX;
    query.counts = true;
    assert_int_equal(store_list(s, &query, list, NULL), BF_OK);
    assert_int_equal(list->n, n);
    assert_int_equal(list->total, n);
    for (size_t k = 0; k < n; k++)
        assert_string_equal(list->runs[k].name, names[k]);
    free(list);
}

static void runs_are_listed_and_found_by_their_line(void **state)
{
    static const char *const of_hall_2[] = { "c", "a" }, *const sorted[] = { "a", "c" },
                             *const of_hall[] = { "c", "b", "a" };
    store *s = ((helper_store *)*state)->store;

    (void)submit(s, "", "hall 2", "a", "6", "macro");
    (void)submit(s, "", "hall 3", "b", "6", "macro");
    (void)submit(s, "", "hall 2", "c", "6", "micro");
    assert_listed(s, (api_list_query){ .line = "hall 2" }, of_hall_2, 2);
    assert_listed(s, (api_list_query){ .line = "hall" }, NULL, 0);
    assert_listed(s, (api_list_query){ .search = "hall" }, of_hall, 3);
    assert_listed(
        s, (api_list_query){ .line = "hall 2", .sort = { .by = API_SORT_NAME, .is_rising = true } },
        sorted, 2);
}

static void assert_line(const api_line *line, const char *owner, const char *name,
                        size_t n_versions, size_t n_runs)
{
    assert_string_equal(line->owner, owner);
    assert_string_equal(line->line, name);
    assert_int_equal(line->n_versions, n_versions);
    assert_int_equal(line->n_runs, n_runs);
    assert_int_equal(line->n_studies, 0);
    assert_string_equal(line->newest, line->newest_run);
}

static void lines_are_listed_by_their_newest_run(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_page *list = calloc(1, sizeof *list);
    api_page_query query = { .limit = 2 };

    assert_non_null(list);
    (void)submit(s, "", "hall 2", "a", "6", "macro");
    (void)submit(s, "", "", "of none", "6", "macro");
    (void)submit(s, "ada", "hall 2", "hers", "6", "macro");
    (void)submit(s, "", "hall 3", "b", "6", "macro");
    const api_run newest = submit(s, "", "hall 2", "c", "7", "micro");
    assert_int_equal(store_list_lines(s, &query, list, NULL), BF_OK);
    assert_int_equal(list->n, 2);
    assert_true(list->has_more);
    assert_line(&list->lines[0], "", "hall 2", 2, 2);
    assert_string_equal(list->lines[0].newest_run, newest.id);
    assert_int_equal(list->lines[0].used_ms, newest.created_ms);
    assert_line(&list->lines[1], "", "hall 3", 1, 1);
    memcpy(query.before, list->lines[1].newest, sizeof query.before);
    assert_int_equal(store_list_lines(s, &query, list, NULL), BF_OK);
    assert_int_equal(list->n, 1);
    assert_false(list->has_more);
    assert_line(&list->lines[0], "ada", "hall 2", 1, 1);

    query = (api_page_query){ .owner = "ada", .limit = 2 };
    assert_int_equal(store_list_lines(s, &query, list, NULL), BF_OK);
    assert_int_equal(list->n, 1);
    assert_line(&list->lines[0], "ada", "hall 2", 1, 1);
    free(list);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(scenarios_of_a_line_are_numbered_in_the_order_of_their_first_use),
        STORE_TEST(the_number_of_a_scenario_is_kept_while_a_run_has_it),
        STORE_TEST(a_run_that_changes_its_line_is_numbered_there),
        STORE_TEST(runs_are_listed_and_found_by_their_line),
        STORE_TEST(lines_are_listed_by_their_newest_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
