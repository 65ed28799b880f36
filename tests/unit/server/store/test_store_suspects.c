// Unit tests of the store: results that turn out to be wrong. I1 ... I17 are the invariants of server/store/store.h.

#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_store.h"

#include "server/base/clock.h"
#include "server/store/backup.h"

#include <stdio.h>
#include <string.h>

enum { LIAR = 7, HONEST = 8 }; // tokens

static api_run submit(store *s, const char *identity)
{
    api_submission submission = { .model = RUN_MACRO };

    assert_int_equal(buffer_printf(&submission.scenario, "{\"name\":\"%s\"}", identity), BF_OK);
    assert_int_equal(buffer_printf(&submission.columns, "upstream,left_domain"), BF_OK);
    assert_int_equal(buffer_printf(&submission.identity, "%s", identity), BF_OK);
    const api_run record = helper_accept(s, &submission);
    buffer_fini(&submission.scenario);
    buffer_fini(&submission.columns);
    buffer_fini(&submission.identity);
    return record;
}

static api_run begin(store *s, const char *identity)
{
    const api_run record = submit(s, identity);

    assert_string_equal(helper_claim(s).id, record.id);
    return record;
}

// The worker with this token sends a sample of a running run.
static void send(store *s, const char *id, uint64_t token)
{
    store_item item;
    const store_batch batch = { .run_id = id, .n = 1, .items = &item, .token = token };

    helper_curve_item(id, helper_find(s, id).n_samples, 1, &item);
    assert_int_equal(helper_store_append(s, &batch, NULL), BF_OK);
    helper_item_fini(&item);
}

static api_run succeed(store *s, const char *id)
{
    static const char summary[] = "{\"steps\":1,\"warnings\":[],\"scenario\":{}}";
    const store_ending ending = {
        .run_id = id, .state = RUN_SUCCEEDED, .summary = summary, .n_summary = sizeof summary - 1
    };
    api_run record;

    assert_int_equal(store_finish(s, &ending, &record, NULL), BF_OK);
    return record;
}

static api_run solve(store *s, const char *identity, uint64_t token)
{
    const api_run record = begin(s, identity);

    send(s, record.id, token);
    return succeed(s, record.id);
}

static bool is_suspect(store *s, const api_run *record)
{
    return helper_find(s, record->id).is_suspect;
}

static void await_suspect(store *s, const api_run *record)
{
    static const store_retention none = { 0 };

    store_set_retention(s, &none); // a turn, now
    HELPER_AWAIT(is_suspect(s, record));
}

static void close_and_verify(helper_store *h)
{
    helper_store_close(h);
    helper_store_verify(h);
}

// Also what another run has of it, what several workers sent, and what was under way.
static void what_a_distrusted_token_sent_is_marked_and_solved_again(void **state)
{
    helper_store *h = *state;
    const api_run of_liar = solve(h->store, "a", LIAR);
    const api_run cached = submit(h->store, "a");
    const api_run of_other = solve(h->store, "b", HONEST);
    const api_run of_both = begin(h->store, "c");
    const api_run silent = begin(h->store, "d");

    assert_true(cached.is_cached);
    send(h->store, of_both.id, LIAR);
    send(h->store, of_both.id, HONEST);
    const uint64_t revision = helper_find(h->store, of_liar.id).revision;
    store_begin_suspecting(h->store, NULL, LIAR);
    await_suspect(h->store, &of_liar);
    await_suspect(h->store, &cached);
    await_suspect(h->store, &of_both);
    assert_int_equal(helper_find(h->store, of_liar.id).revision, revision + 1);
    // It had this one, and sends it afterwards.
    assert_false(is_suspect(h->store, &silent));
    send(h->store, silent.id, LIAR);
    succeed(h->store, silent.id);
    await_suspect(h->store, &silent);
    assert_true(succeed(h->store, of_both.id).is_suspect);
    static const char *const works[] = { "a", "c", "d" };
    for (size_t k = 0; k < sizeof works / sizeof *works; k++) {
        const api_run again = solve(h->store, works[k], HONEST);
        assert_false(again.is_cached || again.is_suspect);
        assert_true(submit(h->store, works[k]).is_cached);
    }
    assert_true(submit(h->store, "b").is_cached);
    assert_false(is_suspect(h->store, &of_other));
    close_and_verify(h);
    helper_store_open(h);
    assert_true(is_suspect(h->store, &cached));
}

static void what_a_token_sends_later_counts_again(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_run before = solve(s, "a", LIAR);

    store_begin_suspecting(s, NULL, LIAR);
    await_suspect(s, &before);
    const int64_t at_ms = clock_unix_ms();
    HELPER_AWAIT(clock_unix_ms() > at_ms);
    const api_run after = solve(s, "a", LIAR);
    const api_run last = solve(s, "b", HONEST);
    // The turn that marks this one goes through tokens in their order.
    store_begin_suspecting(s, NULL, HONEST);
    await_suspect(s, &last);
    assert_false(is_suspect(s, &after));
    assert_true(submit(s, "a").is_cached);
}

// Of a run that is not over as well: others were faster.
static void the_results_of_one_run_are_suspect(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_run other = solve(s, "a", HONEST);
    const api_run disputed = solve(s, "b", HONEST);
    const api_run cached = submit(s, "b");
    const api_run running = begin(s, "c");

    store_begin_suspecting(s, "0190a0b0-0000-7000-8000-00000000000a", 0); // was removed
    store_begin_suspecting(s, disputed.id, 0);
    store_begin_suspecting(s, running.id, 0);
    await_suspect(s, &disputed);
    await_suspect(s, &cached);
    await_suspect(s, &running);
    assert_false(is_suspect(s, &other));
    succeed(s, running.id);
    assert_false(submit(s, "b").is_cached);
    assert_false(submit(s, "c").is_cached);
    assert_true(submit(s, "a").is_cached);
}

static void marking_goes_on_after_a_restart(void **state)
{
    helper_store *h = *state;
    const api_run first = solve(h->store, "a", LIAR);
    const api_run second = solve(h->store, "b", LIAR);

    helper_store_close(h);
    helper_store_sql(h,
                     "INSERT INTO distrusted (token, at_ms) SELECT 7, max(started_ms) FROM runs");
    helper_store_open(h);
    await_suspect(h->store, &first);
    await_suspect(h->store, &second);
    // What is removed meanwhile leaves nothing behind.
    assert_int_equal(store_remove(h->store, first.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(store_remove(h->store, second.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM senders"), 0);
    close_and_verify(h);
}

#define TEST(function)                                                                             \
    cmocka_unit_test_setup_teardown(function, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(what_a_distrusted_token_sent_is_marked_and_solved_again),
        TEST(what_a_token_sends_later_counts_again),
        TEST(the_results_of_one_run_are_suspect),
        TEST(marking_goes_on_after_a_restart),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
