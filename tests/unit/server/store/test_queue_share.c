// The share of the queue that one client may fill.

#include "server/store/queue_share.h"

#include "core/base/memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

enum { SHARE = 3, QUEUE = 10 };

static queue_share *share;
static unsigned n_submitted, n_started; // runs are started in the order of their submission

static int set_up(void **state)
{
    (void)state;
    n_submitted = n_started = 0;
    return queue_share_create(SHARE, QUEUE, &share, NULL) == BF_OK ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    share = queue_share_destroy(share);
    return 0;
}

static bool is_queued(void *context, const char *run_id)
{
    unsigned number = 0;

    (void)context;
    assert_int_equal(sscanf(run_id, "run-%u", &number), 1);
    return number >= n_started;
}

static bf_status submit(const char *client)
{
    char id[API_ID_SIZE];
    bf_error err = { 0 };
    bf_status status = queue_share_take(share, client, is_queued, NULL, &err);

    if (status != BF_OK)
        return status;
    (void)snprintf(id, sizeof id, "run-%u", n_submitted++);
    queue_share_settle(share, client, id);
    return BF_OK;
}

static void a_client_fills_its_share_and_no_more(void **state)
{
    bf_error err = { 0 };

    (void)state;
    for (int i = 0; i < SHARE; i++)
        assert_int_equal(submit("a"), BF_OK);
    assert_int_equal(queue_share_take(share, "a", is_queued, NULL, &err), BF_ELIMIT);
    assert_string_equal(err.text, "3 runs of a wait already, its share of the queue");
    assert_int_equal(submit("b"), BF_OK);
    n_started = 1;
    assert_int_equal(submit("a"), BF_OK);
    assert_int_equal(submit("a"), BF_ELIMIT);
}

static void a_run_that_was_not_accepted_counts_no_more(void **state)
{
    (void)state;
    for (int i = 0; i < 2 * SHARE; i++) {
        assert_int_equal(queue_share_take(share, "a", is_queued, NULL, NULL), BF_OK);
        queue_share_settle(share, "a", NULL);
    }
    for (int i = 0; i < SHARE; i++)
        assert_int_equal(submit("a"), BF_OK);
}

// A place that was taken counts while the run is still on its way to the store.
static void runs_on_their_way_count(void **state)
{
    (void)state;
    for (int i = 0; i < SHARE; i++)
        assert_int_equal(queue_share_take(share, "a", is_queued, NULL, NULL), BF_OK);
    assert_int_equal(submit("a"), BF_ELIMIT);
    for (int i = 0; i < SHARE; i++)
        queue_share_settle(share, "a", i == 0 ? NULL : "run-9");
    assert_int_equal(submit("a"), BF_OK);
    assert_int_equal(submit("a"), BF_ELIMIT);
}

static void the_book_stays_small_whoever_submits(void **state)
{
    (void)state;
    for (unsigned i = 0; i < 10000; i++) {
        char client[16];
        (void)snprintf(client, sizeof client, "client-%u", i);
        assert_int_equal(submit(client), BF_OK);
        n_started = n_submitted < QUEUE ? 0 : n_submitted - QUEUE;
    }
}

static void without_memory_no_place_is_taken(void **state)
{
    queue_share *none = NULL;

    (void)state;
    memory_plan_fault(1, 1);
    assert_int_equal(queue_share_take(share, "a", is_queued, NULL, NULL), BF_ENOMEM);
    assert_int_equal(queue_share_create(1, 1, &none, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_null(none);
    assert_null(queue_share_destroy(NULL));
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        CASE(a_client_fills_its_share_and_no_more),
        CASE(a_run_that_was_not_accepted_counts_no_more),
        CASE(runs_on_their_way_count),
        CASE(the_book_stays_small_whoever_submits),
        CASE(without_memory_no_place_is_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
