// Unit tests of the store: what owners may use, and whose run is next. I1 ... I16 are the invariants of
// server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "server/base/clock.h"
#include "server/store/backup.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bf_status try_submit(store *s, const char *owner, int priority, api_acceptance *ret_accepted,
                            bf_error *err)
{
    api_submission submission = { .model = RUN_MACRO, .priority = priority };

    snprintf(submission.sender.owner, sizeof submission.sender.owner, "%s", owner);
    assert_int_equal(buffer_append(&submission.columns, "upstream,left_domain", 20), BF_OK);
    *ret_accepted = (api_acceptance){ .revision = 0 };
    bf_status status = store_submit(s, &submission, ret_accepted, err);
    buffer_fini(&submission.columns);
    buffer_fini(&ret_accepted->answer);
    return status;
}

static bf_status submit(store *s, const char *owner, int priority)
{
    api_acceptance accepted;

    return try_submit(s, owner, priority, &accepted, NULL);
}

static api_quotas quotas_of(store *s, const char *owner)
{
    api_quotas quotas;

    assert_int_equal(store_read_quotas(s, owner, &quotas, NULL), BF_OK);
    return quotas;
}

// The owners of the next runs, as their first letters; '-' for nobody's.
static void expect_claims(store *s, const char *owners)
{
    for (; *owners != '\0'; owners++) {
        api_run record = helper_claim(s);
        assert_int_equal(record.owner[0] == '\0' ? '-' : record.owner[0], *owners);
    }
}

static void owners_take_turns(void **state)
{
    store *s = ((helper_store *)*state)->store;

    for (int i = 0; i < 5; i++)
        assert_int_equal(submit(s, "alice", 0), BF_OK);
    expect_claims(s, "aa");
    assert_int_equal(submit(s, "bob", 0), BF_OK);
    assert_int_equal(submit(s, "", 0), BF_OK);
    assert_int_equal(submit(s, "", 0), BF_OK);
    expect_claims(s, "b-a-a");
    // Who was served longest ago comes first, also after a while without runs.
    assert_int_equal(submit(s, "bob", 0), BF_OK);
    expect_claims(s, "ba");
    assert_int_equal(store_claim(s, true, &(store_job){ .step = 0 }, NULL), BF_ENOTFOUND);
}

static void a_higher_priority_comes_before_turns(void **state)
{
    store *s = ((helper_store *)*state)->store;

    assert_int_equal(submit(s, "bob", 0), BF_OK);
    assert_int_equal(submit(s, "alice", -1), BF_OK);
    assert_int_equal(submit(s, "alice", 1), BF_OK);
    assert_int_equal(submit(s, "alice", 1), BF_OK);
    assert_int_equal(submit(s, "bob", 1), BF_OK);
    expect_claims(s, "aba"
                     "ba");
}

static void turns_are_known_after_a_restart(void **state)
{
    helper_store *h = *state;

    for (int i = 0; i < 2; i++) {
        assert_int_equal(submit(h->store, "alice", 0), BF_OK);
        assert_int_equal(submit(h->store, "bob", 0), BF_OK);
    }
    api_run record = helper_claim(h->store);
    assert_string_equal(record.owner, "alice");
    helper_finish(h->store, record.id, RUN_SUCCEEDED);
    helper_store_close(h);
    helper_store_open(h);
    expect_claims(h->store, "bab");
}

static void an_owner_has_so_many_runs_that_wait(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const store_quotas quotas = { .n_waiting = 2 };
    api_acceptance accepted;
    bf_error err = { 0 };

    store_set_quotas(s, &quotas);
    for (int i = 0; i < 2; i++)
        assert_int_equal(submit(s, "alice", 0), BF_OK);
    assert_int_equal(try_submit(s, "alice", 0, &accepted, &err), BF_ELIMIT);
    assert_string_equal(err.text, "2 runs of alice wait, of 2 allowed (owner_queue)");
    assert_int_equal(quotas_of(s, "alice").waiting.used, 2);
    assert_int_equal(quotas_of(s, "alice").waiting.allowed, 2);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(submit(s, "", 0), BF_OK);
        assert_int_equal(submit(s, i == 0 ? "bob" : "carol", 0), BF_OK);
    }
    expect_claims(s, "a");
    assert_int_equal(submit(s, "alice", 0), BF_OK);
}

// A run of an owner that has used CPU seconds so far, by a batch and by its end.
static void use(store *s, const char *owner, double batch_s, double end_s)
{
    assert_int_equal(submit(s, owner, 100), BF_OK);
    api_run record = helper_claim(s);
    store_batch batch = { .run_id = record.id, .eta_s = NAN, .cpu_s = batch_s };
    store_ending ending = { .run_id = record.id, .state = RUN_SUCCEEDED, .cpu_s = end_s };
    assert_string_equal(record.owner, owner);
    assert_int_equal(helper_store_append(s, &batch, NULL), BF_OK);
    assert_int_equal(store_finish(s, &ending, &record, NULL), BF_OK);
}

static void move_use_by_hours(helper_store *h, int hours)
{
    char sql[80];

    snprintf(sql, sizeof sql, "UPDATE cpu_sums SET hour = hour + %d", hours);
    helper_store_close(h);
    helper_store_sql(h, sql);
    helper_store_open(h);
}

// What a run has used is charged once, whether batches, its end or both tell it; a run that ends without telling is charged
// for its batches. I16.
static void cpu_time_is_charged_once(void **state)
{
    store *s = ((helper_store *)*state)->store;

    use(s, "alice", 4.0, 10.0);
    assert_int_equal(quotas_of(s, "alice").cpu_s.used, 10);
    use(s, "alice", 5.0, 0.0);
    assert_int_equal(quotas_of(s, "alice").cpu_s.used, 15);
    use(s, "bob", 0.0, (double)NAN);
    assert_int_equal(quotas_of(s, "bob").cpu_s.used, 0);
    assert_int_equal(quotas_of(s, "nobody").cpu_s.used, 0);
}

// A sum that no integer holds is the largest use that there is, and not the smallest.
static void cpu_time_without_measure_is_a_full_quota(void **state)
{
    store *s = ((helper_store *)*state)->store;

    use(s, "alice", 0.0, 1e300);
    store_set_quotas(s, &(store_quotas){ .cpu_s = 60 });
    assert_int_equal(quotas_of(s, "alice").cpu_s.used, UINT64_C(1) << 63);
    assert_int_equal(submit(s, "alice", 0), BF_ELIMIT);
    assert_int_equal(submit(s, "bob", 0), BF_OK);
}

static void cpu_time_of_all_attempts_is_charged_over_a_restart(void **state)
{
    helper_store *h = *state;
    store_job job = { .step = 0 };

    assert_int_equal(submit(h->store, "alice", 0), BF_OK);
    store_batch batch = { .eta_s = NAN, .cpu_s = 7.0 };
    api_run record = helper_claim(h->store);
    batch.run_id = record.id;
    assert_int_equal(helper_store_append(h->store, &batch, NULL), BF_OK);
    helper_store_close(h);
    helper_store_open(h);
    assert_int_equal(quotas_of(h->store, "alice").cpu_s.used, 7);
    assert_int_equal(store_claim(h->store, true, &job, NULL), BF_OK);
    assert_true(job.cpu_s == 7.0);
    store_ending ending = { .run_id = record.id, .state = RUN_FAILED, .cpu_s = job.cpu_s + 2.0 };
    assert_int_equal(store_finish(h->store, &ending, &record, NULL), BF_OK);
    store_job_fini(&job);
    assert_int_equal(quotas_of(h->store, "alice").cpu_s.used, 9);
}

static void who_has_used_the_cpu_time_waits_while_others_overtake(void **state)
{
    helper_store *h = *state;
    const store_quotas quotas = { .cpu_s = 60 };
    api_acceptance accepted;
    store_job job = { .step = 0 };
    bf_error err = { 0 };

    store_set_quotas(h->store, &quotas);
    assert_int_equal(submit(h->store, "alice", 50), BF_OK);
    use(h->store, "alice", 0.0, 60.0);
    assert_int_equal(submit(h->store, "bob", -50), BF_OK);
    expect_claims(h->store, "b");
    assert_int_equal(store_claim(h->store, true, &job, NULL), BF_ELIMIT);
    assert_int_equal(try_submit(h->store, "alice", 0, &accepted, &err), BF_ELIMIT);
    assert_string_equal(err.text, "runs of alice have used 60 CPU seconds in 24 hours, of 60 "
                                  "allowed (owner_cpu_s)");
    // The hour in which it was used leaves the window 24 hours after its begin.
    assert_true(accepted.retry_after_s > 23 * 3600 && accepted.retry_after_s <= 24 * 3600);
    int64_t left_ms = quotas_of(h->store, "alice").cpu_s.release_ms - clock_unix_ms();
    assert_true(left_ms > 23 * 3600000LL && left_ms <= 24 * 3600000LL);
    store_set_quotas(h->store, &(store_quotas){ .cpu_s = 61 });
    expect_claims(h->store, "a");
}

static void cpu_time_is_given_back_by_the_hour(void **state)
{
    helper_store *h = *state;
    const store_quotas quotas = { .cpu_s = 60 };
    api_acceptance accepted;

    use(h->store, "alice", 0.0, 40.0);
    move_use_by_hours(h, -22);
    use(h->store, "alice", 0.0, 20.0);
    store_set_quotas(h->store, &quotas);
    assert_int_equal(quotas_of(h->store, "alice").cpu_s.used, 60);
    assert_int_equal(try_submit(h->store, "alice", 0, &accepted, NULL), BF_ELIMIT);
    assert_true(accepted.retry_after_s > 3600 && accepted.retry_after_s <= 2 * 3600);
    move_use_by_hours(h, -2);
    store_set_quotas(h->store, &quotas);
    assert_int_equal(quotas_of(h->store, "alice").cpu_s.used, 20);
    assert_int_equal(submit(h->store, "alice", 0), BF_OK);
    // A clock that was set back leaves sums of later hours, which do not count.
    move_use_by_hours(h, 100);
    assert_int_equal(quotas_of(h->store, "alice").cpu_s.used, 0);
}

// A run with a snapshot.
static api_run solve(store *s, const char *owner)
{
    assert_int_equal(submit(s, owner, 0), BF_OK);
    api_run record = helper_claim(s);
    helper_append_snapshot(s, record.id, 0);
    helper_append_samples(s, record.id, 0, 10);
    return helper_finish(s, record.id, RUN_SUCCEEDED);
}

static void results_count_until_they_are_removed(void **state)
{
    helper_store *h = *state;
    store *s = h->store;
    api_acceptance accepted;
    bf_error err = { 0 };

    api_run first = solve(s, "alice");
    uint64_t one = quotas_of(s, "alice").bytes.used;
    // The noise of a snapshot cannot be compressed: two of three bytes of each cell at least.
    assert_true(one > 2 * HELPER_N1 * HELPER_N2);
    solve(s, "alice");
    uint64_t two = quotas_of(s, "alice").bytes.used;
    assert_true(two > one + one / 2);
    assert_int_equal(quotas_of(s, "bob").bytes.used, 0);
    store_set_quotas(s, &(store_quotas){ .n_bytes = two });
    assert_int_equal(try_submit(s, "alice", 0, &accepted, &err), BF_ENOSPACE);
    assert_non_null(strstr(err.text, "allowed (owner_bytes)"));
    assert_int_equal(submit(s, "bob", 0), BF_OK);
    assert_int_equal(store_remove(s, first.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(quotas_of(s, "alice").bytes.used, two - one);
    assert_int_equal(submit(s, "alice", 0), BF_OK);
    helper_store_verify(h);
}

static void runs_wait_until_there_are_bytes_left(void **state)
{
    store *s = ((helper_store *)*state)->store;

    api_run first = solve(s, "alice");
    assert_int_equal(submit(s, "alice", 0), BF_OK);
    store_set_quotas(s, &(store_quotas){ .n_bytes = 100000 });
    assert_int_equal(store_claim(s, true, &(store_job){ .step = 0 }, NULL), BF_ELIMIT);
    assert_int_equal(store_remove(s, first.id, API_ANY_REVISION, NULL), BF_OK);
    expect_claims(s, "a");
}

// Submit what has one result whoever submits it.
static bf_status try_named(store *s, const char *owner, api_run *ret_run)
{
    api_submission submission = { .model = RUN_MACRO };
    api_acceptance accepted = { .revision = 0 };

    snprintf(submission.sender.owner, sizeof submission.sender.owner, "%s", owner);
    assert_int_equal(buffer_append(&submission.identity, "same", 4), BF_OK);
    assert_int_equal(buffer_append(&submission.columns, "upstream,left_domain", 20), BF_OK);
    bf_status status = store_submit(s, &submission, &accepted, NULL);
    if (status == BF_OK)
        *ret_run = helper_find(s, accepted.id);
    buffer_fini(&submission.identity);
    buffer_fini(&submission.columns);
    buffer_fini(&accepted.answer);
    return status;
}

static void accept_named(store *s, const char *owner, api_run *ret_run)
{
    assert_int_equal(try_named(s, owner, ret_run), BF_OK);
}

// alice's run of it, which has a snapshot.
static void solve_named(store *s, api_run *ret_run)
{
    accept_named(s, "alice", ret_run);
    helper_claim(s);
    helper_append_snapshot(s, ret_run->id, 0);
    const store_ending ending = { .run_id = ret_run->id, .state = RUN_SUCCEEDED };
    assert_int_equal(store_finish(s, &ending, ret_run, NULL), BF_OK);
}

// Each owner that has runs with a set of results has its bytes, once, until the last of these runs is removed. I10, I16.
static void shared_results_count_once_for_each_owner(void **state)
{
    helper_store *h = *state;
    store *s = h->store;
    api_run first, again, others;

    solve_named(s, &first);
    uint64_t one = quotas_of(s, "alice").bytes.used;
    accept_named(s, "alice", &again);
    assert_true(again.is_cached);
    uint64_t both = quotas_of(s, "alice").bytes.used;
    assert_true(both > one && both < one + 10000);
    accept_named(s, "bob", &others);
    assert_true(others.is_cached);
    uint64_t bobs = quotas_of(s, "bob").bytes.used;
    assert_true(bobs > 2 * HELPER_N1 * HELPER_N2 && bobs <= one);
    assert_int_equal(store_remove(s, first.id, API_ANY_REVISION, NULL), BF_OK);
    assert_true(quotas_of(s, "alice").bytes.used > 2 * HELPER_N1 * HELPER_N2);
    helper_store_verify(h);
    assert_int_equal(store_remove(s, again.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(quotas_of(s, "alice").bytes.used, 0);
    assert_int_equal(quotas_of(s, "bob").bytes.used, bobs);
    assert_int_equal(store_remove(s, others.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(quotas_of(s, "bob").bytes.used, 0);
}

// I16: an answer from earlier results is no way past the quotas: its bytes count, and so does the time to make it.
static void cached_answers_count_for_their_owner(void **state)
{
    helper_store *h = *state;
    store *s = h->store;
    api_run first, again;

    solve_named(s, &first);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM cpu_sums WHERE owner = 'bob'"), 0);
    accept_named(s, "bob", &again);
    assert_true(again.is_cached);
    assert_int_equal(helper_store_sql(h, "SELECT cpu_s > 0 FROM cpu_sums WHERE owner = 'bob'"), 1);
    store_set_quotas(s, &(store_quotas){ .n_bytes = quotas_of(s, "bob").bytes.used });
    assert_int_equal(try_named(s, "bob", &again), BF_ENOSPACE);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs WHERE owner = 'bob'"), 1);
    store_set_quotas(s, &(store_quotas){ .n_bytes = quotas_of(s, "bob").bytes.used + 1 });
    accept_named(s, "bob", &again);
    assert_true(again.is_cached);
}

static void what_nobody_uses_any_more_is_forgotten(void **state)
{
    helper_store *h = *state;

    use(h->store, "alice", 0.0, 10.0);
    api_run record = solve(h->store, "bob");
    assert_int_equal(store_remove(h->store, record.id, API_ANY_REVISION, NULL), BF_OK);
    move_use_by_hours(h, -24); // opening looks for what is to be removed
    helper_await_sql(h, "SELECT count(*) FROM cpu_sums", 0);
    helper_await_sql(h, "SELECT count(*) FROM owners", 1);
    helper_store_verify(h);
}

static bf_status add_measurement(store *s, const char *owner, api_measurement *ret_added)
{
    static const double samples[] = { 0.0, 1.0, 2.0 };
    api_measurement about = { .counter = "gate", .t_end = 2.0 };
    api_curve curve = { .n = 3, .n_columns = 1 };

    snprintf(about.owner, sizeof about.owner, "%s", owner);
    assert_int_equal(buffer_append(&curve.t, samples, sizeof samples), BF_OK);
    assert_int_equal(buffer_append(&curve.values, samples, sizeof samples), BF_OK);
    bf_status status = store_add_measurement(s, &about, &curve, &(bf_buffer){ 0 }, ret_added, NULL);
    api_curve_fini(&curve);
    return status;
}

// I16: what one keeps is counted for him, and uses up nothing of another.
static void measurements_are_their_owners(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_measurement first, added;

    store_set_quotas(s, &(store_quotas){ .n_measurements = 2, .n_bytes = 10000 });
    assert_int_equal(add_measurement(s, "alice", &first), BF_OK);
    assert_int_equal(add_measurement(s, "alice", &added), BF_OK);
    assert_int_equal(quotas_of(s, "alice").bytes.used, 2 * 48);
    assert_int_equal(add_measurement(s, "alice", &added), BF_ECONFLICT);
    assert_int_equal(add_measurement(s, "bob", &added), BF_OK);
    for (int k = 0; k < 3; k++)
        assert_int_equal(add_measurement(s, "", &added), BF_OK);
    assert_int_equal(store_remove_measurement(s, first.id, NULL), BF_OK);
    assert_int_equal(quotas_of(s, "alice").bytes.used, 48);
    store_set_quotas(s, &(store_quotas){ .n_measurements = 2, .n_bytes = 48 });
    assert_int_equal(add_measurement(s, "alice", &added), BF_ENOSPACE);
    assert_int_equal(submit(s, "alice", 0), BF_ENOSPACE);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)
    const struct CMUnitTest tests[] = {
        CASE(owners_take_turns),
        CASE(measurements_are_their_owners),
        CASE(a_higher_priority_comes_before_turns),
        CASE(turns_are_known_after_a_restart),
        CASE(an_owner_has_so_many_runs_that_wait),
        CASE(cpu_time_is_charged_once),
        CASE(cpu_time_without_measure_is_a_full_quota),
        CASE(cpu_time_of_all_attempts_is_charged_over_a_restart),
        CASE(who_has_used_the_cpu_time_waits_while_others_overtake),
        CASE(cpu_time_is_given_back_by_the_hour),
        CASE(results_count_until_they_are_removed),
        CASE(runs_wait_until_there_are_bytes_left),
        CASE(shared_results_count_once_for_each_owner),
        CASE(cached_answers_count_for_their_owner),
        CASE(what_nobody_uses_any_more_is_forgotten),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
