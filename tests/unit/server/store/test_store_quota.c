// Unit tests of the store: the quota of the queue that one client may fill, and its place in the order of a
// submission. I1 ... I15 are the invariants of server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "core/base/memory.h"

#include <stdio.h>
#include <string.h>

enum { QUOTA = 3, QUEUE = 10 };

static int set_up(void **state)
{
    int failed = helper_store_setup(state);
    helper_store *h = *state;

    if (failed == 0) {
        store_set_client_quota(h->store, QUOTA);
        store_set_queue_limit(h->store, QUEUE);
    }
    return failed;
}

static bf_status submit(store *s, const char *client, const char *key, bf_error *err)
{
    api_submission submission = { .model = RUN_MACRO, .sender.body = "", .sender.n_body = 0 };
    api_acceptance accepted = { .revision = 0 };

    snprintf(submission.sender.client, sizeof submission.sender.client, "%s", client);
    snprintf(submission.sender.key, sizeof submission.sender.key, "%s", key);
    bf_status status = store_submit(s, &submission, &accepted, err);
    buffer_fini(&accepted.answer);
    return status;
}

static void fill_quota(store *s, const char *client)
{
    for (int i = 0; i < QUOTA; i++)
        assert_int_equal(submit(s, client, "", NULL), BF_OK);
}

static void a_client_fills_its_quota_and_no_more(void **state)
{
    store *s = ((helper_store *)*state)->store;
    bf_error err = { 0 };

    fill_quota(s, "a");
    assert_int_equal(submit(s, "a", "", &err), BF_ELIMIT);
    assert_string_equal(err.text, "3 runs of a wait already, its share of the queue");
    assert_int_equal(submit(s, "b", "", NULL), BF_OK);
    helper_claim(s);
    assert_int_equal(submit(s, "a", "", NULL), BF_OK);
    assert_int_equal(submit(s, "a", "", NULL), BF_ELIMIT);
}

static void who_has_no_name_has_no_quota(void **state)
{
    store *s = ((helper_store *)*state)->store;

    for (int i = 0; i < QUEUE; i++)
        assert_int_equal(submit(s, "", "", NULL), BF_OK);
    assert_int_equal(submit(s, "", "", NULL), BF_EBUSY);
}

// The quota comes before the queue: a client that has used it up gets that refusal, also when the queue is full.
static void the_quota_comes_before_the_queue(void **state)
{
    store *s = ((helper_store *)*state)->store;

    fill_quota(s, "a");
    for (int i = QUOTA; i < QUEUE; i++)
        assert_int_equal(submit(s, "", "", NULL), BF_OK);
    assert_int_equal(submit(s, "b", "", NULL), BF_EBUSY);
    assert_int_equal(submit(s, "a", "", NULL), BF_ELIMIT);
}

// I11: the key comes before the quota and the queue, and a replay takes no place.
static void a_replay_gets_its_answer_though_all_is_full(void **state)
{
    helper_store *h = *state;
    store *s = h->store;

    assert_int_equal(submit(s, "a", "key", NULL), BF_OK);
    for (int i = 0; i < 2 * QUEUE; i++)
        assert_int_equal(submit(s, "a", "key", NULL), BF_OK);
    assert_int_equal(submit(s, "a", "", NULL), BF_OK);
    assert_int_equal(submit(s, "a", "", NULL), BF_OK);
    assert_int_equal(submit(s, "a", "", NULL), BF_ELIMIT);
    assert_int_equal(submit(s, "a", "key", NULL), BF_OK);
    for (int i = QUOTA; i < QUEUE; i++)
        assert_int_equal(submit(s, "", "", NULL), BF_OK);
    assert_int_equal(submit(s, "a", "key", NULL), BF_OK);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), QUEUE);
}

static void what_was_refused_takes_no_place(void **state)
{
    store *s = ((helper_store *)*state)->store;

    store_set_queue_limit(s, 1);
    assert_int_equal(submit(s, "", "", NULL), BF_OK);
    for (int i = 0; i < QUEUE; i++)
        assert_int_equal(submit(s, "a", "", NULL), BF_EBUSY);
    store_set_queue_limit(s, QUEUE);
    fill_quota(s, "a");
}

static void the_quota_can_be_changed_at_any_time(void **state)
{
    store *s = ((helper_store *)*state)->store;

    fill_quota(s, "a");
    store_set_client_quota(s, QUOTA + 1);
    assert_int_equal(submit(s, "a", "", NULL), BF_OK);
    assert_int_equal(submit(s, "a", "", NULL), BF_ELIMIT);
    store_set_client_quota(s, 1);
    assert_int_equal(submit(s, "a", "", NULL), BF_ELIMIT);
    store_set_client_quota(s, 0);
    assert_int_equal(submit(s, "a", "", NULL), BF_OK);
}

static void who_submitted_is_known_after_a_restart(void **state)
{
    helper_store *h = *state;

    fill_quota(h->store, "a");
    helper_claim(h->store);
    helper_store_close(h);
    helper_store_open(h); // queues again what was running
    store_set_client_quota(h->store, QUOTA);
    assert_int_equal(submit(h->store, "a", "", NULL), BF_ELIMIT);
}

// What cannot be counted is refused, and not taken for nothing.
static void without_memory_nobody_gets_past_the_quota(void **state)
{
    helper_store *h = *state;
    size_t n_faults = 1;

    fill_quota(h->store, "a");
    for (size_t n = 1; n_faults > 0; n++) {
        memory_plan_fault(n, 0);
        bf_status status = submit(h->store, "a", "", NULL);
        n_faults = memory_faults();
        memory_plan_fault(0, 0);
        assert_int_equal(status, n_faults > 0 ? BF_ENOMEM : BF_ELIMIT);
    }
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), QUOTA);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, set_up, helper_store_teardown)
    const struct CMUnitTest tests[] = {
        CASE(a_client_fills_its_quota_and_no_more),
        CASE(who_has_no_name_has_no_quota),
        CASE(the_quota_comes_before_the_queue),
        CASE(a_replay_gets_its_answer_though_all_is_full),
        CASE(what_was_refused_takes_no_place),
        CASE(the_quota_can_be_changed_at_any_time),
        CASE(who_submitted_is_known_after_a_restart),
        CASE(without_memory_nobody_gets_past_the_quota),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
