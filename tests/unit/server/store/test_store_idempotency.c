// Unit tests of the store: answers to idempotency keys. I1 ... I15 are the invariants of
// server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "core/base/memory.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum { N_THREADS = 8, N_TRIES = 40 };

// A submission of nothing but a key and a body. The caller's buffers are none.
static api_submission with_key(const char *key, const char *body)
{
    api_submission submission = { .model = RUN_MACRO,
                                  .sender.body = body,
                                  .sender.n_body = strlen(body) };

    snprintf(submission.sender.key, sizeof submission.sender.key, "%s", key);
    return submission;
}

static api_acceptance accept(store *s, const char *key, const char *body)
{
    api_submission submission = with_key(key, body);
    api_acceptance accepted = { 0 };
    bf_error err = { 0 };

    if (store_submit(s, &submission, &accepted, &err) != BF_OK)
        fail_msg("%s", err.text);
    return accepted;
}

// I11: for each owner.
static void a_key_is_its_owners(void **state)
{
    helper_store *h = *state;
    api_submission submission = with_key("one", "{}");
    api_acceptance accepted[4] = { { .revision = 0 } };
    static const char *const owners[] = { "alice", "bob", "alice", "" };

    for (size_t i = 0; i < 4; i++) {
        snprintf(submission.sender.owner, sizeof submission.sender.owner, "%s", owners[i]);
        assert_int_equal(store_submit(h->store, &submission, &accepted[i], NULL), BF_OK);
        assert_int_equal(accepted[i].is_replay, i == 2);
        assert_string_equal(helper_find(h->store, accepted[i].id).owner, owners[i]);
        buffer_fini(&accepted[i].answer);
    }
    assert_string_equal(accepted[2].id, accepted[0].id);
    assert_string_not_equal(accepted[1].id, accepted[0].id);
    assert_string_not_equal(accepted[3].id, accepted[0].id);
}

static bf_status refuse(store *s, const char *key, const char *body, bf_error *err)
{
    api_submission submission = with_key(key, body);
    api_acceptance accepted = { .revision = 77 };

    bf_status status = store_submit(s, &submission, &accepted, err);
    assert_int_equal(accepted.revision, 77);
    assert_null(accepted.answer.bytes);
    return status;
}

static void expect_replay(store *s, const char *key, const char *body, const api_acceptance *first)
{
    api_acceptance again = accept(s, key, body);

    assert_true(again.is_replay);
    assert_string_equal(again.id, first->id);
    assert_int_equal(again.revision, first->revision);
    assert_int_equal(again.answer.n, first->answer.n);
    assert_string_equal(again.answer.bytes, first->answer.bytes);
    buffer_fini(&again.answer);
}

// I11, whatever became of the run, also after the store was opened again.
static void the_first_answer_comes_again_and_no_second_run(void **state)
{
    helper_store *h = *state;
    api_acceptance first = accept(h->store, "key", "body");

    assert_false(first.is_replay);
    assert_non_null(strstr(first.answer.bytes, "\"status\":\"queued\""));
    assert_non_null(strstr(first.answer.bytes, first.id));
    expect_replay(h->store, "key", "body", &first);
    helper_claim(h->store);
    expect_replay(h->store, "key", "body", &first);
    helper_finish(h->store, first.id, RUN_SUCCEEDED);
    helper_store_close(h);
    helper_store_open(h);
    expect_replay(h->store, "key", "body", &first);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), 1);
    buffer_fini(&first.answer);
}

// The first answer is about what was done, not about what is there.
static void a_removed_run_is_not_made_again(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_acceptance first = accept(s, "key", "body");

    assert_int_equal(store_remove(s, first.id, API_ANY_REVISION, NULL), BF_OK);
    expect_replay(s, "key", "body", &first);
    assert_int_equal(helper_store_sql(*state, "SELECT count(*) FROM runs"), 0);
    buffer_fini(&first.answer);
}

static void another_body_is_refused_and_changes_nothing(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_acceptance first = accept(s, "key", "body");
    bf_error err = { 0 };

    assert_int_equal(refuse(s, "key", "Body", &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "another body"));
    assert_int_equal(refuse(s, "key", "", &err), BF_EINPUT);
    assert_int_equal(refuse(s, "key", "body ", &err), BF_EINPUT);
    expect_replay(s, "key", "body", &first);
    buffer_fini(&first.answer);
}

static void other_keys_and_none_make_runs_of_their_own(void **state)
{
    static const char *const keys[] = { "key", "Key", "key ", "", "" };
    store *s = ((helper_store *)*state)->store;

    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        api_acceptance made = accept(s, keys[i], "body");
        assert_false(made.is_replay);
        buffer_fini(&made.answer);
    }
    assert_int_equal(helper_store_sql(*state, "SELECT count(*) FROM runs"), 5);
    assert_int_equal(helper_store_sql(*state, "SELECT count(*) FROM answers"), 3);
}

// What was refused was not done, so the key is as good as new.
static void a_refusal_is_no_answer(void **state)
{
    helper_store *h = *state;
    store_options options = { .directory = h->directory, .queue_limit = 1 };

    helper_store_close(h);
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
    helper_submit(h->store, "", 0);
    assert_int_equal(refuse(h->store, "key", "body", NULL), BF_EBUSY);
    helper_claim(h->store);
    api_acceptance made = accept(h->store, "key", "another body");
    assert_false(made.is_replay);
    buffer_fini(&made.answer);
}

static void an_answer_is_stored_for_its_time(void **state)
{
    helper_store *h = *state;
    store_options options = { .directory = h->directory,
                              .queue_limit = 9,
                              .idempotency_ms = 3600000 };
    api_acceptance old = accept(h->store, "old", "body");
    api_acceptance young = accept(h->store, "young", "body");

    helper_store_close(h);
    helper_store_sql(h, "UPDATE answers SET at_ms = at_ms - 3601000 WHERE key = 'old'");
    helper_store_sql(h, "UPDATE answers SET at_ms = at_ms - 3590000 WHERE key = 'young'");
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
    expect_replay(h->store, "young", "body", &young);
    api_acceptance made = accept(h->store, "old", "body");
    assert_false(made.is_replay);
    assert_string_not_equal(made.id, old.id);
    buffer_fini(&old.answer);
    buffer_fini(&young.answer);
    buffer_fini(&made.answer);
}

static void of_too_many_answers_the_oldest_go(void **state)
{
    helper_store *h = *state;

    helper_store_close(h);
    // Another owner's answer, which is older than all of these, stays.
    helper_store_sql(h, "INSERT INTO answers (route, key, digest, id, revision, at_ms, data) "
                        "VALUES ('POST /v1/runs bob', 'his', x'00', '', 1, 9e15, '')");
    helper_store_sql(h,
                     "WITH RECURSIVE number (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM number "
                     "WHERE i < 100003) INSERT INTO answers (route, key, digest, id, revision, "
                     "at_ms, data) SELECT 'POST /v1/runs', i, x'00', '', 1, 9e15, '' FROM number");
    helper_store_open(h);
    api_acceptance made = accept(h->store, "key", "body");
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM answers"), 100001);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM answers WHERE key = 'his'"), 1);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM answers WHERE key = 'key'"), 1);
    assert_int_equal(helper_store_sql(h, "SELECT min(CAST(key AS INTEGER)) FROM answers "
                                         "WHERE key NOT IN ('key', 'his')"),
                     5);
    buffer_fini(&made.answer);
}

/// Data common to the threads of a test.
typedef struct shared {
    store *store;
    atomic_int n_new, n_replays, n_conflicts, n_others;
} shared;

static void *submit_all(void *context)
{
    shared *sh = context;

    for (int i = 0; i < N_TRIES; i++) {
        char key[16];
        snprintf(key, sizeof key, "key %d", i);
        api_submission submission = with_key(key, "body");
        api_acceptance accepted = { 0 };
        bf_status status = store_submit(sh->store, &submission, &accepted, NULL);
        atomic_fetch_add(status == BF_ECONFLICT ? &sh->n_conflicts
                         : status != BF_OK      ? &sh->n_others
                         : accepted.is_replay   ? &sh->n_replays
                                                : &sh->n_new,
                         1);
        buffer_fini(&accepted.answer);
    }
    return NULL;
}

// I11 where many come at once: exactly one of them makes the run.
static void many_at_once_make_one_run(void **state)
{
    shared sh = { .store = ((helper_store *)*state)->store };
    pthread_t threads[N_THREADS];

    for (int i = 0; i < N_THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, submit_all, &sh), 0);
    for (int i = 0; i < N_THREADS; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    assert_int_equal(atomic_load(&sh.n_new), N_TRIES);
    assert_int_equal(atomic_load(&sh.n_others), 0);
    assert_int_equal(atomic_load(&sh.n_replays) + atomic_load(&sh.n_conflicts),
                     (N_THREADS - 1) * N_TRIES);
    assert_int_equal(helper_store_sql(*state, "SELECT count(*) FROM runs"), N_TRIES);
}

// I11: neither the run nor the answer, or both.
static void without_memory_neither_run_nor_answer_is_stored(void **state)
{
    helper_store *h = *state;
    api_submission submission = with_key("key", "body");

    for (size_t n = 1;; n++) {
        api_acceptance accepted = { 0 };
        memory_plan_fault(n, 0);
        bf_status status = store_submit(h->store, &submission, &accepted, NULL);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        int64_t n_runs = helper_store_sql(h, "SELECT count(*) FROM runs");
        assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM answers"), n_runs);
        assert_int_equal(n_runs, status == BF_OK);
        buffer_fini(&accepted.answer);
        if (n_faults == 0) {
            assert_int_equal(status, BF_OK);
            break;
        }
        assert_int_equal(status, BF_ENOMEM);
    }
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(the_first_answer_comes_again_and_no_second_run),
        STORE_TEST(a_key_is_its_owners),
        STORE_TEST(a_removed_run_is_not_made_again),
        STORE_TEST(another_body_is_refused_and_changes_nothing),
        STORE_TEST(other_keys_and_none_make_runs_of_their_own),
        STORE_TEST(a_refusal_is_no_answer),
        STORE_TEST(an_answer_is_stored_for_its_time),
        STORE_TEST(of_too_many_answers_the_oldest_go),
        STORE_TEST(many_at_once_make_one_run),
        STORE_TEST(without_memory_neither_run_nor_answer_is_stored),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
