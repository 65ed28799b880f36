// Unit tests of the store: studies, their trials, and whose run is next. I1 ... I17 are the invariants of
// server/store/store.h.

#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_store.h"

#include "server/store/backup.h"
#include "server/store/store_priv.h"
#include "server/store/studies.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fill(bf_buffer *buffer, const char *text)
{
    assert_int_equal(buffer_append(buffer, text, strlen(text)), BF_OK);
}

static bf_status try_submit(store *s, const char *owner, int priority, const char *key,
                            const char *body, api_acceptance *ret_accepted)
{
    api_study_submission submission = { .method = STUDY_GRID,
                                        .model = RUN_MACRO,
                                        .priority = priority,
                                        .trials_max = 9,
                                        .sender.body = body };

    snprintf(submission.name, sizeof submission.name, "which angle");
    snprintf(submission.sender.owner, sizeof submission.sender.owner, "%s", owner);
    snprintf(submission.sender.key, sizeof submission.sender.key, "%s", key);
    submission.sender.n_body = strlen(body);
    fill(&submission.document, "{\"base\":{}}");
    fill(&submission.columns, "[]");
    *ret_accepted = (api_acceptance){ .revision = 0 };
    bf_status status = store_submit_study(s, &submission, ret_accepted, NULL);
    buffer_fini(&submission.document);
    buffer_fini(&submission.columns);
    buffer_fini(&ret_accepted->answer);
    return status;
}

static api_study submit_study(store *s, const char *owner, int priority)
{
    api_acceptance accepted;
    api_study found;

    assert_int_equal(try_submit(s, owner, priority, "", "", &accepted), BF_OK);
    assert_int_equal(store_find_study(s, accepted.id, &found, NULL), BF_OK);
    return found;
}

static bf_status move(store *s, const char *id, api_study_state to)
{
    api_study after;

    return store_step_study(s, &(store_study_step){ .id = id, .state = to }, &after, NULL);
}

static api_study start_study(store *s, const char *owner, int priority)
{
    api_study found = submit_study(s, owner, priority);

    assert_int_equal(move(s, found.id, API_STUDY_RUNNING), BF_OK);
    return found;
}

// Begin n trials from number `from` on, with these scenarios.
static bf_status begin_scenarios(store *s, const api_study *of, uint64_t from, size_t n,
                                 const char *const *texts, char (*ret_runs)[API_ID_SIZE])
{
    api_submission submissions[8] = { { .model = RUN_MACRO } };
    store_trial_begin begins[8] = { { .submission = NULL } };
    store_study_step step = {
        .id = of->id, .n_begins = n, .begins = begins, .state = API_STUDY_STATES
    };
    api_study after;

    assert_in_range(n, 1, 8);
    for (size_t k = 0; k < n; k++) {
        fill(&submissions[k].scenario, texts[k]);
        fill(&submissions[k].identity, texts[k]);
        fill(&submissions[k].columns, "upstream,left_domain");
        snprintf(submissions[k].sender.owner, sizeof submissions[k].sender.owner, "%s", of->owner);
        begins[k] = (store_trial_begin){ .trial = { .number = from + k,
                                                    .point = from + k,
                                                    .model = RUN_MACRO,
                                                    .n_parameters = 1,
                                                    .parameters = { (double)(from + k) } },
                                         .submission = &submissions[k] };
    }
    bf_status status = store_step_study(s, &step, &after, NULL);
    for (size_t k = 0; k < n; k++) {
        if (ret_runs != NULL)
            memcpy(ret_runs[k], begins[k].trial.run, API_ID_SIZE);
        buffer_fini(&submissions[k].scenario);
        buffer_fini(&submissions[k].identity);
        buffer_fini(&submissions[k].columns);
    }
    return status;
}

// The same, whose scenarios follow from their numbers.
static bf_status begin_trials(store *s, const api_study *of, uint64_t from, size_t n,
                              char (*ret_runs)[API_ID_SIZE])
{
    const char *pointers[8];
    char texts[8][32];

    for (size_t k = 0; k < n; k++) {
        snprintf(texts[k], sizeof texts[k], "{\"duration_s\":%d}", (int)(from + k));
        pointers[k] = texts[k];
    }
    return begin_scenarios(s, of, from, n, pointers, ret_runs);
}

static bf_status end_trial(store *s, const api_study *of, uint64_t number, api_trial_state state)
{
    const api_trial end = {
        .number = number, .state = state, .n_values = 2, .values = { 0.1 * (double)number, NAN }
    };
    const store_study_step step = {
        .id = of->id, .n_ends = 1, .ends = &end, .state = API_STUDY_STATES
    };
    api_study after;

    return store_step_study(s, &step, &after, NULL);
}

// Trials as they are read.
typedef struct reading {
    size_t n;
    api_trial trials[16];
} reading;

static bf_status take(void *context, const api_trial *trial, bf_error *err)
{
    reading *r = context;

    r->trials[r->n++] = *trial;
    return BF_OK;
}

static reading read_trials(store *s, const api_study *of, api_trial_order order, uint64_t from)
{
    const api_trial_query query = { .order = order, .from = from, .limit = 16 };
    reading r = { .n = 0 };

    assert_int_equal(store_read_trials(s, of->id, &query, take, &r, NULL), BF_OK);
    return r;
}

static api_study find_study(store *s, const char *id)
{
    api_study found;

    assert_int_equal(store_find_study(s, id, &found, NULL), BF_OK);
    return found;
}

static void a_study_is_there_with_its_texts_after_a_restart(void **state)
{
    helper_store *h = *state;
    bf_buffer text = { 0 };

    const api_study before = submit_study(h->store, "alice", 3);
    helper_store_close(h);
    helper_store_open(h);
    const api_study after = find_study(h->store, before.id);
    assert_string_equal(after.name, "which angle");
    assert_string_equal(after.owner, "alice");
    assert_int_equal(after.state, API_STUDY_QUEUED);
    assert_int_equal(after.priority, 3);
    assert_int_equal(after.trials_max, 9);
    assert_int_equal(after.revision, 1);
    assert_int_equal(store_read_study(h->store, before.id, API_STUDY_DOCUMENT, &text, NULL), BF_OK);
    assert_string_equal(text.bytes, "{\"base\":{}}");
    assert_int_equal(store_read_study(h->store, before.id, API_STUDY_BEST, &text, NULL),
                     BF_ECONFLICT);
    buffer_fini(&text);
}

// I11
static void a_key_makes_one_study(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_acceptance first, second;
    api_page list;

    assert_int_equal(try_submit(s, "", 0, "k", "one", &first), BF_OK);
    assert_int_equal(try_submit(s, "", 0, "k", "one", &second), BF_OK);
    assert_true(second.is_replay);
    assert_string_equal(first.id, second.id);
    assert_int_equal(try_submit(s, "", 0, "k", "two", &second), BF_EINPUT);
    assert_int_equal(
        store_list_studies(s, &(api_page_query){ .state = -1, .limit = 9 }, &list, NULL), BF_OK);
    assert_int_equal(list.n, 1);
    // A run may have the same key: it is another route's.
    api_submission submission = {
        .model = RUN_MACRO, .sender.key = "k", .sender.body = "one", .sender.n_body = 3
    };
    fill(&submission.columns, "upstream,left_domain");
    helper_accept(s, &submission);
    buffer_fini(&submission.columns);
}

static void studies_are_listed_newest_first_by_state_and_owner(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study a = submit_study(s, "alice", 0), b = submit_study(s, "bob", 0),
                    c = start_study(s, "alice", 0);
    api_page list;
    api_page_query query = { .state = -1, .limit = 2 };

    assert_int_equal(store_list_studies(s, &query, &list, NULL), BF_OK);
    assert_int_equal(list.n, 2);
    assert_true(list.has_more);
    assert_string_equal(list.studies[0].id, c.id);
    memcpy(query.before, list.studies[1].id, sizeof query.before);
    assert_int_equal(store_list_studies(s, &query, &list, NULL), BF_OK);
    assert_int_equal(list.n, 1);
    assert_string_equal(list.studies[0].id, a.id);
    query = (api_page_query){ .state = API_STUDY_QUEUED, .owner = "bob", .limit = 2 };
    assert_int_equal(store_list_studies(s, &query, &list, NULL), BF_OK);
    assert_int_equal(list.n, 1);
    assert_string_equal(list.studies[0].id, b.id);
}

static void trials_are_read_by_number_by_end_and_as_far_as_they_are_open(void **state)
{
    helper_store *h = *state;
    store *s = h->store;
    const api_study of = start_study(s, "", 0);

    assert_int_equal(begin_trials(s, &of, 0, 3, NULL), BF_OK);
    const api_run first = helper_claim(s);
    assert_string_equal(first.study, of.id);
    reading all = read_trials(s, &of, API_TRIALS_BY_NUMBER, 0);
    assert_int_equal(all.n, 3);
    assert_int_equal(all.trials[0].state, API_TRIAL_RUNNING);
    assert_int_equal(all.trials[1].state, API_TRIAL_QUEUED);
    assert_string_equal(all.trials[0].run, first.id);
    assert_true(all.trials[2].parameters[0] == 2.0);
    assert_int_equal(end_trial(s, &of, 2, API_TRIAL_FAILED), BF_OK);
    assert_int_equal(end_trial(s, &of, 0, API_TRIAL_SUCCEEDED), BF_OK);
    // One that has ended ends no further time.
    assert_int_equal(end_trial(s, &of, 2, API_TRIAL_SUCCEEDED), BF_OK);
    reading ended = read_trials(s, &of, API_TRIALS_BY_END, 1);
    assert_int_equal(ended.n, 2);
    assert_int_equal(ended.trials[0].number, 2);
    assert_int_equal(ended.trials[0].state, API_TRIAL_FAILED);
    assert_int_equal(ended.trials[1].number, 0);
    assert_int_equal(ended.trials[1].ended, 2);
    assert_true(isnan(ended.trials[1].values[1]));
    assert_int_equal(read_trials(s, &of, API_TRIALS_BY_END, 2).n, 1);
    reading open = read_trials(s, &of, API_TRIALS_OPEN, 0);
    assert_int_equal(open.n, 1);
    assert_int_equal(open.trials[0].number, 1);
    const api_study after = find_study(s, of.id);
    assert_int_equal(after.n_trials, 3);
    assert_int_equal(after.n_ended[API_TRIAL_SUCCEEDED], 1);
    assert_int_equal(after.n_ended[API_TRIAL_FAILED], 1);
    helper_store_verify(h);
}

static void a_page_of_trials_has_a_limit(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study of = start_study(s, "", 0);
    api_trial_query query = { .limit = API_TRIALS_PAGE_MAX + 1 };
    reading r = { .n = 0 };

    assert_int_equal(store_read_trials(s, of.id, &query, take, &r, NULL), BF_ELIMIT);
    query.limit = API_TRIALS_PAGE_MAX;
    assert_int_equal(store_read_trials(s, of.id, &query, take, &r, NULL), BF_OK);
}

// I17
static void trials_with_a_gap_are_refused(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study of = start_study(s, "", 0);

    assert_int_equal(begin_trials(s, &of, 1, 1, NULL), BF_ECORRUPT);
    assert_int_equal(begin_trials(s, &of, 0, 2, NULL), BF_OK);
    assert_int_equal(begin_trials(s, &of, 1, 2, NULL), BF_ECORRUPT);
    assert_int_equal(find_study(s, of.id).n_trials, 2);
}

static void the_same_trial_of_another_study_has_its_results_at_once(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study a = start_study(s, "", 0), b = start_study(s, "", 0);
    char runs[1][API_ID_SIZE];
    api_run after;

    assert_int_equal(begin_trials(s, &a, 0, 1, NULL), BF_OK);
    const api_run solved = helper_claim(s);
    const store_ending ending = { .run_id = solved.id, .state = RUN_SUCCEEDED };
    assert_int_equal(store_finish(s, &ending, &after, NULL), BF_OK);
    assert_int_equal(begin_trials(s, &b, 0, 1, runs), BF_OK);
    const api_run reused = helper_find(s, runs[0]);
    assert_int_equal(reused.state, RUN_SUCCEEDED);
    assert_true(reused.is_cached);
    // The results of a trial have no snapshots, so a run by itself is solved.
    api_submission submission = { .model = RUN_MACRO };
    fill(&submission.scenario, "{\"duration_s\":0}");
    fill(&submission.identity, "{\"duration_s\":0}");
    fill(&submission.columns, "upstream,left_domain");
    assert_int_equal(helper_accept(s, &submission).state, RUN_QUEUED);
    buffer_fini(&submission.scenario);
    buffer_fini(&submission.identity);
    buffer_fini(&submission.columns);
}

// A scenario of some hundred kilobytes, in which a trial has its angle.
static bf_buffer make_large(int angle)
{
    bf_buffer text = { 0 };

    assert_int_equal(buffer_printf(&text, "{\"angle_deg\":%d,\"positions_m\":[", angle), BF_OK);
    for (int k = 0; k < 20000; k++)
        assert_int_equal(buffer_printf(&text, "[%.4f,%.4f],", sin(k), cos(7.0 * k)), BF_OK);
    assert_int_equal(buffer_printf(&text, "[0,0]],\"substream\":%d}", angle), BF_OK);
    return text;
}

static int64_t bytes_of(const helper_store *h, const char *id, const char *table)
{
    char sql[320];

    snprintf(
        sql, sizeof sql,
        "SELECT coalesce(sum(length(CAST(data AS BLOB))), 0) FROM %s JOIN runs ON run = number "
        "WHERE id = '%s' AND kind < 2",
        table, id);
    return helper_store_sql(h, sql);
}

// End the next trial with a summary that has its scenario, and compare both with what is read.
static void check_texts(const helper_store *h, const char *id, const bf_buffer *scenario)
{
    const api_run claimed = helper_claim(h->store);
    bf_buffer summary = { 0 }, read = { 0 };
    api_run after;

    assert_string_equal(claimed.id, id);
    assert_int_equal(buffer_printf(&summary, "{\"steps\":9,\"scenario\":%s}", scenario->bytes),
                     BF_OK);
    const store_ending ending = {
        .run_id = id, .state = RUN_SUCCEEDED, .summary = summary.bytes, .n_summary = summary.n
    };
    assert_int_equal(store_finish(h->store, &ending, &after, NULL), BF_OK);
    assert_int_equal(store_read_text(h->store, id, API_TEXT_SCENARIO, &read, NULL), BF_OK);
    assert_string_equal(read.bytes, scenario->bytes);
    read.n = 0;
    assert_int_equal(store_read_text(h->store, id, API_TEXT_SUMMARY, &read, NULL), BF_OK);
    assert_string_equal(read.bytes, summary.bytes);
    buffer_fini(&summary);
    buffer_fini(&read);
}

// Each trial had its scenario, and its summary had it once more.
static void a_trial_takes_the_room_of_what_it_differs_in(void **state)
{
    helper_store *h = *state;
    char runs[3][API_ID_SIZE];
    bf_buffer texts[3];
    const char *pointers[3];

    for (int k = 0; k < 3; k++) {
        texts[k] = make_large(30 + k);
        pointers[k] = texts[k].bytes;
    }
    const api_study of = start_study(h->store, "", 0);
    assert_int_equal(begin_scenarios(h->store, &of, 0, 3, pointers, runs), BF_OK);
    for (int k = 0; k < 3; k++) {
        check_texts(h, runs[k], &texts[k]);
        assert_int_equal(bytes_of(h, runs[k], "texts"), 0);
        assert_in_range(bytes_of(h, runs[k], "text_deltas"), 1, 500);
    }
    helper_store_verify(h);
    for (int k = 0; k < 3; k++)
        buffer_fini(&texts[k]);
}

static void a_run_by_itself_comes_before_trials(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study of = start_study(s, "", 100);
    store_job job = { 0 };

    assert_int_equal(begin_trials(s, &of, 0, 2, NULL), BF_OK);
    const api_run single = helper_submit(s, "", -100);
    assert_string_equal(helper_claim(s).id, single.id);
    assert_int_equal(store_claim(s, false, &job, NULL), BF_ENOTFOUND);
    assert_string_equal(helper_claim(s).study, of.id);
}

// The studies of the next trials, as the letters of their names in `of`.
static void expect_turns(store *s, const api_study *of, const char *letters)
{
    for (; *letters != '\0'; letters++)
        assert_string_equal(helper_claim(s).study, of[*letters - 'a'].id);
}

static void studies_take_turns_and_so_do_their_owners(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study of[] = { start_study(s, "alice", 0), start_study(s, "alice", 0),
                             start_study(s, "bob", 0), start_study(s, "bob", 1) };

    for (size_t k = 0; k < 3; k++)
        assert_int_equal(begin_trials(s, &of[k], 0, 4, NULL), BF_OK);
    assert_int_equal(begin_trials(s, &of[3], 0, 1, NULL), BF_OK);
    // The one with the higher priority, and then alice, as bob was served last.
    expect_turns(s, of,
                 "dacbc"
                 "acbc");
}

static void what_is_paused_begins_no_trial_until_it_goes_on(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study of = start_study(s, "", 0);
    store_study work[4];
    store_job job = { 0 };
    api_study after;
    size_t n = 0;

    assert_int_equal(begin_trials(s, &of, 0, 2, NULL), BF_OK);
    assert_int_equal(store_change_study(s, of.id, 1, API_STUDY_PAUSE, &after, NULL), BF_EINPUT);
    assert_int_equal(store_change_study(s, of.id, API_ANY_REVISION, API_STUDY_RESUME, &after, NULL),
                     BF_ECONFLICT);
    assert_int_equal(store_change_study(s, of.id, API_ANY_REVISION, API_STUDY_PAUSE, &after, NULL),
                     BF_OK);
    assert_int_equal(after.state, API_STUDY_PAUSED);
    assert_int_equal(store_claim(s, true, &job, NULL), BF_ENOTFOUND);
    assert_int_equal(begin_trials(s, &of, 2, 1, NULL), BF_ECONFLICT);
    assert_int_equal(end_trial(s, &of, 1, API_TRIAL_SUCCEEDED), BF_OK);
    assert_int_equal(store_change_study(s, of.id, API_ANY_REVISION, API_STUDY_RESUME, &after, NULL),
                     BF_OK);
    assert_int_equal(store_list_work(s, STORE_STUDIES_QUEUED, 4, work, &n, NULL), BF_OK);
    assert_int_equal(n, 1);
    assert_int_equal(move(s, of.id, API_STUDY_RUNNING), BF_OK);
    assert_string_equal(helper_claim(s).study, of.id);
}

static void a_trial_that_gets_a_line_is_no_version_of_it(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study of = start_study(s, "", 0);
    const api_annotations to = { .line = "hall 2" };
    char runs[1][API_ID_SIZE];
    api_run record;

    assert_int_equal(begin_trials(s, &of, 0, 1, runs), BF_OK);
    assert_int_equal(store_annotate(s, runs[0], API_ANY_REVISION, &to, &record, NULL), BF_OK);
    assert_string_equal(record.line, "hall 2");
    assert_int_equal(record.line_version, 0);
}

static void what_is_to_be_cancelled_begins_no_trial_and_ends_once(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study of = start_study(s, "", 0);
    store_study work[4];
    store_job job = { 0 };
    api_study after;
    size_t n = 0;

    assert_int_equal(begin_trials(s, &of, 0, 2, NULL), BF_OK);
    assert_int_equal(store_change_study(s, of.id, API_ANY_REVISION, API_STUDY_CANCEL, &after, NULL),
                     BF_OK);
    assert_int_equal(after.state, API_STUDY_RUNNING);
    assert_int_equal(store_change_study(s, of.id, API_ANY_REVISION, API_STUDY_PAUSE, &after, NULL),
                     BF_ECONFLICT);
    assert_int_equal(store_claim(s, true, &job, NULL), BF_ENOTFOUND);
    assert_int_equal(store_list_work(s, STORE_STUDIES_TO_STOP, 4, work, &n, NULL), BF_OK);
    assert_int_equal(n, 1);
    assert_int_equal(work[0].stop_request, STORE_STOP_CANCEL);
    assert_int_equal(end_trial(s, &of, 0, API_TRIAL_CANCELLED), BF_OK);
    assert_int_equal(end_trial(s, &of, 1, API_TRIAL_CANCELLED), BF_OK);
    assert_int_equal(move(s, of.id, API_STUDY_CANCELLED), BF_OK);
    assert_int_equal(move(s, of.id, API_STUDY_RUNNING), BF_ECONFLICT);
    assert_true(find_study(s, of.id).finished_ms > 0);
    assert_int_equal(store_list_work(s, STORE_STUDIES_TO_STOP, 4, work, &n, NULL), BF_OK);
    assert_int_equal(n, 0);
}

static void an_owner_has_so_many_studies_that_have_not_ended(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_acceptance accepted;

    store_set_quotas(s, &(store_quotas){ .n_studies = 2 });
    (void)submit_study(s, "alice", 0);
    const api_study first = start_study(s, "alice", 0);
    assert_int_equal(try_submit(s, "alice", 0, "", "", &accepted), BF_ECONFLICT);
    (void)submit_study(s, "bob", 0);
    for (int k = 0; k < 3; k++)
        (void)submit_study(s, "", 0);
    assert_int_equal(move(s, first.id, API_STUDY_SUCCEEDED), BF_OK);
    (void)submit_study(s, "alice", 0);
}

// Copies of the one study that is stored, until there are n.
static void multiply_studies(helper_store *h, int n)
{
    char sql[400];

    helper_store_close(h);
    snprintf(sql, sizeof sql,
             "WITH RECURSIVE k (i) AS (SELECT 2 UNION ALL SELECT i + 1 FROM k WHERE i < %d) "
             "INSERT INTO studies (id, state, method, model, priority, name, owner, client, "
             "created_ms, trials_max, finished_ms) SELECT 'copy ' || i, state, method, model, "
             "priority, name, owner, client, created_ms, trials_max, finished_ms FROM studies, k",
             n);
    helper_store_sql(h, sql);
    helper_store_open(h);
}

static void there_is_a_limit_to_studies_that_have_not_ended(void **state)
{
    helper_store *h = *state;
    const api_study first = submit_study(h->store, "alice", 0);
    api_acceptance accepted;

    multiply_studies(h, STORE_STUDIES_OPEN_MAX - 1);
    (void)submit_study(h->store, "bob", 0);
    assert_int_equal(try_submit(h->store, "bob", 0, "", "", &accepted), BF_EBUSY);
    assert_int_equal(move(h->store, first.id, API_STUDY_RUNNING), BF_OK);
    assert_int_equal(try_submit(h->store, "bob", 0, "", "", &accepted), BF_EBUSY);
    assert_int_equal(move(h->store, first.id, API_STUDY_SUCCEEDED), BF_OK);
    (void)submit_study(h->store, "bob", 0);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM studies WHERE finished_ms = 0"),
                     1000);
}

static void there_is_a_limit_to_studies(void **state)
{
    helper_store *h = *state;
    const api_study first = start_study(h->store, "alice", 0);
    api_acceptance accepted;

    assert_int_equal(move(h->store, first.id, API_STUDY_SUCCEEDED), BF_OK);
    multiply_studies(h, STORE_STUDIES_MAX - 1);
    (void)submit_study(h->store, "bob", 0);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM studies"), 10000);
    assert_int_equal(try_submit(h->store, "bob", 0, "", "", &accepted), BF_EBUSY);
    assert_int_equal(store_remove_study(h->store, first.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(store_forget_study(h->store, first.id, NULL), BF_OK);
    (void)submit_study(h->store, "bob", 0);
}

static void a_study_is_suspect_when_one_of_its_trials_is(void **state)
{
    static const store_retention none = { 0 };
    store *s = ((helper_store *)*state)->store;
    const api_study of = start_study(s, "", 0), other = start_study(s, "", 0);
    char runs[2][API_ID_SIZE];

    assert_int_equal(begin_trials(s, &of, 0, 2, runs), BF_OK);
    const uint64_t revision = find_study(s, of.id).revision;
    for (int k = 0; k < 2; k++) {
        store_begin_suspecting(s, runs[k], 0);
        store_set_retention(s, &none); // a turn, now
        HELPER_AWAIT(helper_find(s, runs[k]).is_suspect);
    }
    assert_true(find_study(s, of.id).is_suspect);
    assert_int_equal(find_study(s, of.id).revision, revision + 1);
    assert_false(find_study(s, other.id).is_suspect);
    // Also after it goes on.
    assert_int_equal(end_trial(s, &of, 0, API_TRIAL_FAILED), BF_OK);
    assert_true(find_study(s, of.id).is_suspect);
}

// Workers are started for what may be claimed, not for what waits until somebody goes on with its study.
static void trials_of_a_study_that_rests_are_not_claimable(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study of = start_study(s, "", 0);
    api_study after;
    store_stats stats = { .n_claimable = 0 };

    assert_int_equal(begin_trials(s, &of, 0, 2, NULL), BF_OK);
    (void)helper_submit(s, "", 0);
    HELPER_AWAIT((store_read_stats(s, &stats), stats.n_claimable == 3));
    assert_int_equal(store_change_study(s, of.id, API_ANY_REVISION, API_STUDY_PAUSE, &after, NULL),
                     BF_OK);
    HELPER_AWAIT((store_read_stats(s, &stats), stats.n_claimable == 1));
    assert_int_equal(stats.n_runs[RUN_QUEUED], 3);
}

// I9
static void a_study_goes_with_all_it_has_when_its_runs_have_gone(void **state)
{
    helper_store *h = *state;
    store *s = h->store;
    const api_study of = start_study(s, "", 0);
    api_study found;
    bool has_runs = true;

    assert_int_equal(begin_trials(s, &of, 0, 2, NULL), BF_OK);
    assert_int_equal(store_forget_study(s, of.id, NULL), BF_ECONFLICT);
    assert_int_equal(store_remove_study(s, of.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(store_find_study(s, of.id, &found, NULL), BF_ENOTFOUND);
    assert_int_equal(store_remove_study(s, of.id, API_ANY_REVISION, NULL), BF_ENOTFOUND);
    assert_int_equal(store_forget_study(s, of.id, NULL), BF_ECONFLICT);
    const double n_commits = helper_read_metric("\nbeltflow_store_commit_operations_count ");
    assert_int_equal(store_remove_runs_of_study(s, of.id, &has_runs, NULL), BF_OK);
    assert_true(has_runs);
    assert_true(helper_read_metric("\nbeltflow_store_commit_operations_count ") == n_commits + 1);
    assert_int_equal(store_remove_runs_of_study(s, of.id, &has_runs, NULL), BF_OK);
    assert_false(has_runs);
    assert_int_equal(store_forget_study(s, of.id, NULL), BF_OK);
    helper_store_verify(h);
    helper_store_close(h);
    assert_int_equal(helper_store_sql(h, "SELECT (SELECT count(*) FROM studies) + (SELECT count(*) "
                                         "FROM trials) + (SELECT count(*) FROM study_texts) + "
                                         "(SELECT count(*) FROM runs)"),
                     0);
    helper_store_open(h);
}

static void a_row_that_no_study_or_trial_can_have_is_damage(void **state)
{
    static const char *const of_studies[] = { "id = id || '0'", "method = 99", "model = 9",
                                              "stop_request = 3" };
    static const char *const of_trials[] = { "model = 9", "parameters = x'00'",
                                             "vals = zeroblob(8000)" };
    helper_store *h = *state;
    const api_study of = start_study(h->store, "", 0);
    const api_trial_query query = { .order = API_TRIALS_BY_NUMBER, .limit = 1 };
    reading r = { .n = 0 };
    char sql[160], id[API_ID_SIZE + 1];
    api_study found = { .n_trials = 77 };

    assert_int_equal(begin_trials(h->store, &of, 0, 1, NULL), BF_OK);
    for (size_t k = 0; k < sizeof of_trials / sizeof *of_trials; k++) {
        snprintf(sql, sizeof sql, "UPDATE trials SET %s", of_trials[k]);
        helper_store_sql(h, sql);
        assert_int_equal(store_read_trials(h->store, of.id, &query, take, &r, NULL), BF_ECORRUPT);
        helper_store_sql(h, "UPDATE trials SET model = 0, parameters = x'', vals = x''");
    }
    assert_int_equal(store_read_trials(h->store, of.id, &query, take, &r, NULL), BF_OK);
    assert_int_equal(r.n, 1);
    for (size_t k = 0; k < sizeof of_studies / sizeof *of_studies; k++) {
        snprintf(sql, sizeof sql, "UPDATE studies SET %s", of_studies[k]);
        helper_store_sql(h, sql);
        snprintf(id, sizeof id, "%s%s", of.id, k == 0 ? "0" : "");
        assert_int_equal(store_find_study(h->store, id, &found, NULL), BF_ECORRUPT);
        snprintf(sql, sizeof sql,
                 "UPDATE studies SET id = '%s', method = 0, model = 0, stop_request = 0", of.id);
        helper_store_sql(h, sql);
    }
    assert_int_equal(found.n_trials, 77);
    assert_int_equal(store_find_study(h->store, of.id, &found, NULL), BF_OK);
}

// The id of a trial that is too long would be cut to that of another run.
static void damage_in_a_study_removes_no_other_run(void **state)
{
    helper_store *h = *state;
    const api_study of = start_study(h->store, "", 0);
    const api_run single = helper_submit(h->store, "", 0);
    char sql[160], ids[2][API_ID_SIZE];
    api_run found;
    bool has_runs = true, has_more = true;
    size_t n = 77;

    assert_int_equal(begin_trials(h->store, &of, 0, 1, NULL), BF_OK);
    assert_int_equal(store_remove_study(h->store, of.id, API_ANY_REVISION, NULL), BF_OK);
    snprintf(sql, sizeof sql, "UPDATE runs SET id = '%s0' WHERE parent = '%s'", single.id, of.id);
    helper_store_sql(h, sql);
    assert_int_equal(store_remove_runs_of_study(h->store, of.id, &has_runs, NULL), BF_ECORRUPT);
    assert_int_equal(store_find(h->store, single.id, &found, NULL), BF_OK);
    store__connection *reader = store__acquire_reader(&h->store->pool);
    assert_int_equal(store__list(reader, STORE__SQL_LIST_RUNS_OF_STUDY, &store__id_record, ids, 2,
                                 &n, &has_more, NULL, TEXT(of.id), INTEGER(2)),
                     BF_ECORRUPT);
    store__release_reader(&h->store->pool, reader);
    assert_true(n == 77 && has_more);
}

static void lists_of_runs_have_trials_only_where_they_are_asked_for(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_study of = start_study(s, "", 0);
    const api_run single = helper_submit(s, "", 0);
    api_list_query query = { .state = -1, .model = -1, .limit = 9 };
    api_run_list *list = calloc(1, sizeof *list);

    assert_int_equal(begin_trials(s, &of, 0, 3, NULL), BF_OK);
    assert_int_equal(store_list(s, &query, list, NULL), BF_OK);
    assert_int_equal(list->n, 1);
    assert_string_equal(list->runs[0].id, single.id);
    query.state = RUN_QUEUED;
    assert_int_equal(store_list(s, &query, list, NULL), BF_OK);
    assert_int_equal(list->n, 1);
    memcpy(query.study, of.id, sizeof query.study);
    assert_int_equal(store_list(s, &query, list, NULL), BF_OK);
    assert_int_equal(list->n, 3);
    free(list);
}

// A study's runs, which it lets wait a few at a time, are none of the queue that clients fill.
static void trials_take_no_room_in_the_queue(void **state)
{
    helper_store *h = *state;
    const api_study of = start_study(h->store, "alice", 0);
    api_quotas quotas;

    store_set_queue_limit(h->store, 1);
    assert_int_equal(begin_trials(h->store, &of, 0, 8, NULL), BF_OK);
    assert_int_equal(store_read_quotas(h->store, "alice", &quotas, NULL), BF_OK);
    assert_int_equal(quotas.waiting.used, 0);
    helper_submit(h->store, "", 0);
}

// I17: the value that the study is to be told would be lost.
static void retention_leaves_runs_of_trials_that_are_open(void **state)
{
    helper_store *h = *state;
    const api_study of = start_study(h->store, "", 0);

    assert_int_equal(begin_trials(h->store, &of, 0, 2, NULL), BF_OK);
    const api_run ended = helper_claim(h->store), open = helper_claim(h->store);
    helper_finish(h->store, ended.id, RUN_SUCCEEDED);
    helper_finish(h->store, open.id, RUN_SUCCEEDED);
    assert_int_equal(end_trial(h->store, &of, 0, API_TRIAL_SUCCEEDED), BF_OK);
    store_set_retention(h->store, &(store_retention){ .n_bytes = 1 });
    helper_await_sql(h, "SELECT count(*) FROM runs", 1);
    assert_string_equal(helper_find(h->store, open.id).id, open.id);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)
    const struct CMUnitTest tests[] = {
        CASE(a_study_is_there_with_its_texts_after_a_restart),
        CASE(a_key_makes_one_study),
        CASE(studies_are_listed_newest_first_by_state_and_owner),
        CASE(trials_are_read_by_number_by_end_and_as_far_as_they_are_open),
        CASE(a_page_of_trials_has_a_limit),
        CASE(trials_with_a_gap_are_refused),
        CASE(the_same_trial_of_another_study_has_its_results_at_once),
        CASE(a_trial_takes_the_room_of_what_it_differs_in),
        CASE(a_run_by_itself_comes_before_trials),
        CASE(studies_take_turns_and_so_do_their_owners),
        CASE(what_is_paused_begins_no_trial_until_it_goes_on),
        CASE(a_trial_that_gets_a_line_is_no_version_of_it),
        CASE(what_is_to_be_cancelled_begins_no_trial_and_ends_once),
        CASE(an_owner_has_so_many_studies_that_have_not_ended),
        CASE(there_is_a_limit_to_studies_that_have_not_ended),
        CASE(there_is_a_limit_to_studies),
        CASE(a_study_is_suspect_when_one_of_its_trials_is),
        CASE(trials_of_a_study_that_rests_are_not_claimable),
        CASE(a_study_goes_with_all_it_has_when_its_runs_have_gone),
        CASE(a_row_that_no_study_or_trial_can_have_is_damage),
        CASE(damage_in_a_study_removes_no_other_run),
        CASE(lists_of_runs_have_trials_only_where_they_are_asked_for),
        CASE(trials_take_no_room_in_the_queue),
        CASE(retention_leaves_runs_of_trials_that_are_open),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
