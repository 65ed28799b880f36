// Unit tests of the store: what comes with the end of a run in one commit. I1 ... I16 are the invariants of
// server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static double count_commits(void)
{
    return helper_read_metric("\nbeltflow_store_commit_operations_count ");
}

static void what_a_run_sent_last_is_stored_with_its_end(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s), after;
    store_item items[2];
    const bf_grid grid = helper_grid();
    const store_batch last = {
        .run_id = record.id, .n = 2, .items = items, .eta_s = NAN, .wall_s = 2.5, .grid = &grid
    };
    const store_ending ending = { .run_id = record.id, .state = RUN_SUCCEEDED, .last = &last };
    api_curve curve = { 0 };
    api_array got;
    bf_buffer rho = { 0 };

    helper_append_samples(s, record.id, 0, 2);
    helper_curve_item(record.id, 2, 3, &items[0]);
    helper_snapshot_item(record.id, 0, &items[1]);
    const double n_commits = count_commits();
    assert_int_equal(store_finish(s, &ending, &after, NULL), BF_OK);
    assert_true(count_commits() == n_commits + 1);
    assert_int_equal(after.state, RUN_SUCCEEDED);
    assert_int_equal(after.n_samples, 5);
    assert_int_equal(store_read_curve(s, record.id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    assert_true(helper_curve_is(&curve, 0, 5));
    assert_int_equal(store_read_array(s, record.id, 0, API_ARRAY_DENSITY, &got, &rho, NULL), BF_OK);
    assert_true(helper_snapshot_is(&rho, 0));
    // Two samples, the rest, the snapshot, the status and the end.
    helper_events events = helper_read_events(s, record.id, record.last_event);
    assert_int_equal(events.n, 5);
    assert_int_equal(events.type, API_EVENT_END);
    buffer_fini(&events.data);
    buffer_fini(&rho);
    api_curve_fini(&curve);
    helper_item_fini(&items[0]);
    helper_item_fini(&items[1]);
}

// I4
static void an_end_whose_last_samples_have_a_gap_changes_nothing(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s), after;
    store_item item;
    const store_batch last = { .run_id = record.id, .n = 1, .items = &item, .eta_s = NAN };
    const store_ending ending = { .run_id = record.id, .state = RUN_SUCCEEDED, .last = &last };

    helper_curve_item(record.id, 1, 1, &item);
    assert_int_equal(store_finish(s, &ending, &after, NULL), BF_ECORRUPT);
    after = helper_find(s, record.id);
    assert_int_equal(after.state, RUN_RUNNING);
    assert_int_equal(after.revision, record.revision);
    helper_item_fini(&item);
}

static void the_next_run_is_claimed_in_the_commit_of_an_end(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run first = helper_start(s), second = helper_submit(s, "", 0), after;
    store_next next = { .status = BF_ECONFLICT };
    const store_ending ending = { .run_id = first.id, .state = RUN_SUCCEEDED, .next = &next };
    bf_buffer scenario = { 0 };

    const double n_commits = count_commits();
    assert_int_equal(store_finish(s, &ending, &after, NULL), BF_OK);
    assert_true(count_commits() == n_commits + 1);
    assert_int_equal(next.status, BF_OK);
    assert_string_equal(next.job.run.id, second.id);
    assert_int_equal(next.job.run.state, RUN_RUNNING);
    assert_int_equal(store_read_text(s, second.id, API_TEXT_SCENARIO, &scenario, NULL), BF_OK);
    assert_int_equal(next.job.scenario.n, scenario.n);
    assert_memory_equal(next.job.scenario.bytes, scenario.bytes, scenario.n);
    assert_memory_equal(next.job.columns.bytes, "upstream,left_domain", 20);
    assert_int_equal(helper_find(s, second.id).state, RUN_RUNNING);
    store_job_fini(&next.job);
    buffer_fini(&scenario);
}

// Each of the two succeeds or fails alone.
static void an_end_and_the_claim_with_it_fail_alone(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run first = helper_start(s), after;
    store_next next = { .status = BF_ECONFLICT };
    const store_ending ending = { .run_id = first.id, .state = RUN_SUCCEEDED, .next = &next };

    assert_int_equal(store_finish(s, &ending, &after, NULL), BF_OK);
    assert_int_equal(next.status, BF_ENOTFOUND);
    api_run second = helper_submit(s, "", 0);
    assert_int_equal(store_finish(s, &ending, &after, NULL), BF_ECONFLICT);
    assert_int_equal(next.status, BF_OK);
    assert_string_equal(next.job.run.id, second.id);
    store_job_fini(&next.job);
}

// A checkpoint is read before its run is claimed, not in the transaction.
static void a_run_with_a_checkpoint_is_not_claimed_with_an_end(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run first = helper_start(s), second = helper_start(s), after;
    const store_batch checkpoint = {
        .run_id = second.id, .eta_s = NAN, .step = 7, .checkpoint = "seven", .n_checkpoint = 5
    };
    store_next next = { .status = BF_OK };
    const store_ending ending = { .run_id = first.id, .state = RUN_SUCCEEDED, .next = &next };

    assert_int_equal(helper_store_append(s, &checkpoint, NULL), BF_OK);
    helper_finish(s, second.id, RUN_QUEUED);
    assert_int_equal(store_finish(s, &ending, &after, NULL), BF_OK);
    assert_int_equal(next.status, BF_ECONFLICT);
    assert_int_equal(helper_find(s, second.id).state, RUN_QUEUED);
}

// The CPU time that is charged with the end counts for the claim behind it.
static void a_claim_with_an_end_sees_what_that_has_used(void **state)
{
    helper_store *h = *state;
    const store_options options = { .directory = h->directory,
                                    .queue_limit = 10,
                                    .quotas = { .cpu_s = 60 } };
    api_submission submission = { .model = RUN_MACRO, .sender.owner = "alice" };
    store_next next = { .status = BF_OK };
    api_run after;

    helper_store_close(h);
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
    assert_int_equal(buffer_append(&submission.columns, "upstream,left_domain", 20), BF_OK);
    api_run first = helper_accept(h->store, &submission), second;
    second = helper_accept(h->store, &submission);
    assert_string_equal(helper_claim(h->store).id, first.id);
    const store_ending ending = {
        .run_id = first.id, .state = RUN_SUCCEEDED, .cpu_s = 61.0, .next = &next
    };
    assert_int_equal(store_finish(h->store, &ending, &after, NULL), BF_OK);
    assert_int_equal(next.status, BF_ELIMIT);
    assert_int_equal(helper_find(h->store, second.id).state, RUN_QUEUED);
    buffer_fini(&submission.columns);
}

int main(void)
{
#define STORE_TEST(function)                                                                       \
    cmocka_unit_test_setup_teardown(function, helper_store_setup, helper_store_teardown)
    const struct CMUnitTest tests[] = {
        STORE_TEST(what_a_run_sent_last_is_stored_with_its_end),
        STORE_TEST(an_end_whose_last_samples_have_a_gap_changes_nothing),
        STORE_TEST(the_next_run_is_claimed_in_the_commit_of_an_end),
        STORE_TEST(an_end_and_the_claim_with_it_fail_alone),
        STORE_TEST(a_run_with_a_checkpoint_is_not_claimed_with_an_end),
        STORE_TEST(a_claim_with_an_end_sees_what_that_has_used),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
