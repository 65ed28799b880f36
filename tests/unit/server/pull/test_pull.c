// Tests of the executor of workers that pull: a worker is a few calls of the services, the supervisor a few of the
// executor. No sockets, no threads, no solver.

#include "core/base/memory.h"
#include "core/observe/frame.h"
#include "server/base/clock.h"
#include "server/base/metrics.h"
#include "server/base/solver.h"
#include "server/pull/pull_priv.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

#define RUN_A "0190a0b0-0000-7000-8000-00000000000a"
#define RUN_B "0190a0b0-0000-7000-8000-00000000000b"
#define RUN_C "0190a0b0-0000-7000-8000-00000000000c"

typedef struct fixture {
    executor *executor;
    api_leases api;
    api_job_states states; // of the last answer
} fixture;

static int setup(void **state)
{
    static fixture f;

    f = (fixture){ .states = { .n = 0 } };
    assert_int_equal(pull_executor_create(&f.executor, NULL), BF_OK);
    f.api = pull_executor_leases(f.executor);
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    fixture *f = *state;

    memory_free(f->states.items);
    pull_executor_destroy(f->executor);
    return 0;
}

static executor_job *start(fixture *f, const char *run_id, bool is_trial)
{
    bf_buffer scenario = { 0 };
    const bf_buffer none = { 0 };
    executor_job *job = NULL;

    assert_int_equal(buffer_printf(&scenario, "{\"of\":\"%s\"}", run_id), BF_OK);
    const executor_work work = { .run_id = run_id,
                                 .n_threads = 1,
                                 .is_trial = is_trial,
                                 .scenario = &scenario,
                                 .checkpoint = &none,
                                 .limits = { .checkpoint_ms = 1000 } };
    assert_int_equal(f->executor->functions->start(f->executor, &work, &job, NULL), BF_OK);
    buffer_fini(&scenario);
    return job;
}

static void release(fixture *f, executor_job *job)
{
    f->executor->functions->release(f->executor, job);
}

static api_worker worker_of(const char *name, uint32_t cores)
{
    api_worker who = { .cores = cores };

    (void)solver_name(who.solver);
    snprintf(who.name, sizeof who.name, "%s", name);
    return who;
}

static api_lease lease(fixture *f, const char *name, uint32_t cores)
{
    const api_worker who = worker_of(name, cores);
    api_lease made = { .n_jobs = 0 };

    assert_int_equal(f->api.lease(f->api.context, &who, &made, NULL), BF_OK);
    return made;
}

static api_job_state state_of(const fixture *f, uint32_t number)
{
    for (size_t k = 0; k < f->states.n; k++)
        if (f->states.items[k].job == number)
            return f->states.items[k];
    fail_msg("nothing is said of job %u", number);
    return (api_job_state){ .job = 0 };
}

static void deliver(fixture *f, const char *id, uint32_t number, uint64_t offset, const char *text,
                    size_t n)
{
    const api_lease_section section = { .job = number, .offset = offset, .n = n, .bytes = text };

    memory_free(f->states.items);
    f->states.items = NULL;
    assert_int_equal(f->api.deliver(f->api.context, 0, id, &section, 1, &f->states, NULL), BF_OK);
}

static api_job_report report_of(const api_lease_job *job)
{
    api_job_report report = { .job = job->job, .attempt = job->attempt };

    memcpy(report.run, job->run, sizeof report.run);
    return report;
}

// A worker that has this one job says that it goes on, or how it ended.
static void renew(fixture *f, const char *id, const char *name, const api_lease_job *job,
                  const api_job_end *end)
{
    api_job_report report = report_of(job);
    api_job_end ended = end == NULL ? (api_job_end){ .n_bytes = 0 } : *end;
    api_renewal renewal = {
        .n_jobs = end == NULL, .jobs = &report, .n_ended = end != NULL, .ended = &ended
    };

    ended.report = report;
    (void)solver_name(renewal.solver);
    snprintf(renewal.worker, sizeof renewal.worker, "%s", name);
    memory_free(f->states.items);
    f->states.items = NULL;
    assert_int_equal(f->api.renew(f->api.context, id, &renewal, &f->states, NULL), BF_OK);
}

// What the supervisor gets of a job in one call, as text.
static executor_state poll_job(fixture *f, executor_job *job, char *ret_text, size_t size)
{
    executor_end end;
    size_t n;

    executor_state state =
        f->executor->functions->poll(f->executor, job, ret_text, size - 1, &n, &end);
    ret_text[n] = '\0';
    return state;
}

static executor_state state_of_job(fixture *f, executor_job *job)
{
    char text[8];

    return poll_job(f, job, text, sizeof text);
}

static void bytes_come_through_in_order(void **state)
{
    fixture *f = *state;
    char text[16];

    executor_job *job = start(f, RUN_A, false);
    assert_int_equal(state_of_job(f, job), EXECUTOR_WAITING);
    api_lease l = lease(f, "one", 2);
    assert_int_equal(l.n_jobs, 1);
    assert_string_equal(l.jobs[0].run, RUN_A);
    bf_buffer input = { 0 };
    assert_int_equal(f->api.read_jobs(f->api.context, 0, l.id, &input, NULL), BF_OK);
    assert_int_equal(input.n, l.jobs[0].n_bytes);
    frame decoded;
    size_t used;
    assert_int_equal(frame_decode(input.bytes, input.n, &decoded, &used, NULL), BF_OK);
    assert_int_equal(decoded.type, FRAME_JOB);
    buffer_fini(&input);
    deliver(f, l.id, 0, 0, "abc", 3);
    assert_int_equal(state_of(f, 0).next, 3);
    deliver(f, l.id, 0, 5, "xx", 2); // a gap
    assert_int_equal(state_of(f, 0).next, 3);
    deliver(f, l.id, 0, 1, "bcde", 4); // again, and what is new
    assert_int_equal(state_of(f, 0).next, 5);
    assert_int_equal(poll_job(f, job, text, sizeof text), EXECUTOR_RUNNING);
    assert_string_equal(text, "abcde");
    assert_int_equal(f->api.read_jobs(f->api.context, 0, l.id, &input, NULL), BF_ECONFLICT);
    const api_job_end end = { .cause = API_JOB_EXITED, .n_bytes = 6 };
    renew(f, l.id, "one", &l.jobs[0], &end); // one byte is missing
    assert_int_equal(state_of(f, 0).next, 5);
    assert_int_equal(state_of_job(f, job), EXECUTOR_RUNNING);
    deliver(f, l.id, 0, 5, "f", 1);
    renew(f, l.id, "one", &l.jobs[0], &end);
    assert_int_equal(state_of(f, 0).next, 6);
    assert_int_equal(poll_job(f, job, text, sizeof text), EXECUTOR_RUNNING);
    assert_string_equal(text, "f");
    assert_int_equal(state_of_job(f, job), EXECUTOR_ENDED);
    release(f, job);
    api_lease_fini(&l);
}

static void a_full_job_takes_no_more(void **state)
{
    fixture *f = *state;
    const size_t n = PULL_JOB_BYTES_MAX - 10;
    char *bytes = memory_alloc(n, 1);
    char text[32];

    executor_job *job = start(f, RUN_A, false);
    api_lease l = lease(f, "one", 1);
    deliver(f, l.id, 0, 0, bytes, n);
    deliver(f, l.id, 0, n, bytes, 100);
    assert_int_equal(state_of(f, 0).next, PULL_JOB_BYTES_MAX);
    (void)poll_job(f, job, text, 6);
    deliver(f, l.id, 0, PULL_JOB_BYTES_MAX, bytes, 100);
    assert_int_equal(state_of(f, 0).next, PULL_JOB_BYTES_MAX + 5);
    release(f, job);
    memory_free(bytes);
    api_lease_fini(&l);
}

// Once the supervisor takes something there is room again, for any job.
static void all_jobs_together_have_a_limit(void **state)
{
    enum { N = PULL_BYTES_MAX / PULL_JOB_BYTES_MAX };
    fixture *f = *state;
    char *bytes = memory_alloc(PULL_JOB_BYTES_MAX, 1);
    executor_job *jobs[N + 1];
    char text[8];

    for (size_t k = 0; k <= N; k++)
        jobs[k] = start(f, RUN_A, false);
    api_lease l = lease(f, "one", N + 1);
    assert_int_equal(l.n_jobs, N + 1);
    for (uint32_t k = 0; k < N; k++)
        deliver(f, l.id, k, 0, bytes, PULL_JOB_BYTES_MAX);
    assert_int_equal(state_of(f, N - 1).next, PULL_JOB_BYTES_MAX);
    deliver(f, l.id, N, 0, bytes, 100);
    assert_int_equal(state_of(f, N).next, 0);
    (void)poll_job(f, jobs[0], text, sizeof text);
    deliver(f, l.id, N, 0, bytes, 100);
    assert_int_equal(state_of(f, N).next, sizeof text - 1);
    release(f, jobs[1]);
    deliver(f, l.id, N, 0, bytes, 100);
    assert_int_equal(state_of(f, N).next, 100);
    for (size_t k = 0; k <= N; k++)
        if (k != 1)
            release(f, jobs[k]);
    memory_free(bytes);
    api_lease_fini(&l);
}

static void a_batch_has_runs_first_then_trials(void **state)
{
    fixture *f = *state;
    executor_job *jobs[20];
    size_t n = 0;

    for (; n < 12; n++)
        jobs[n] = start(f, RUN_B, true);
    jobs[n++] = start(f, RUN_A, false);
    api_lease l = lease(f, "one", 2);
    assert_int_equal(l.n_jobs, 1 + PULL_TRIALS_A_CORE);
    assert_string_equal(l.jobs[0].run, RUN_A);
    assert_true(l.jobs[1].is_trial);
    api_lease other = lease(f, "two", 1);
    assert_int_equal(other.n_jobs, PULL_TRIALS_A_CORE);
    assert_int_not_equal(other.jobs[0].attempt, l.jobs[1].attempt);
    while (n > 0)
        release(f, jobs[--n]);
    api_lease_fini(&l);
    api_lease_fini(&other);
}

static void there_is_room_for_what_workers_take(void **state)
{
    fixture *f = *state;
    const executor_functions *functions = f->executor->functions;

    assert_false(functions->has_room(f->executor, false));
    api_lease none = lease(f, "one", 1);
    assert_string_equal(none.id, "");
    assert_in_range(none.retry_s, 1, API_LEASE_EXPIRES_S);
    assert_true(functions->has_room(f->executor, false));
    executor_job *job = start(f, RUN_A, false);
    assert_false(functions->has_room(f->executor, false));
    assert_true(functions->has_room(f->executor, true));
    release(f, job);
    assert_true(functions->has_room(f->executor, false));
}

static void who_is_silent_loses_jobs(void **state)
{
    fixture *f = *state;
    const int64_t lost = metrics_value(METRICS_PULL_LOST, 0);

    executor_job *job = start(f, RUN_A, false);
    api_lease l = lease(f, "one", 1);
    deliver(f, l.id, 0, 0, "a", 1);
    char text[8];
    (void)poll_job(f, job, text, sizeof text);
    pull_executor *e = pull__enter(f->executor);
    const int64_t seen_ms = e->leases[0]->seen_ms;
    pull__expire(e, seen_ms + API_LEASE_EXPIRES_S * 1000 - 1);
    assert_int_equal(e->n_leases, 1);
    pull__expire(e, seen_ms + API_LEASE_EXPIRES_S * 1000);
    assert_int_equal(e->n_leases, 0);
    assert_int_equal(e->n_workers, 0);
    lock_release(&e->lock);
    assert_int_equal(state_of_job(f, job), EXECUTOR_LOST);
    assert_int_equal(metrics_value(METRICS_PULL_LOST, 0), lost + 1);
    renew(f, l.id, "one", &l.jobs[0], NULL);
    assert_int_equal(state_of(f, 0).stop, API_JOB_GONE);
    release(f, job);
    api_lease_fini(&l);
}

static void who_leaves_or_forgets_loses_jobs(void **state)
{
    fixture *f = *state;

    executor_job *left = start(f, RUN_A, false);
    api_lease l = lease(f, "one", 1);
    assert_int_equal(f->api.leave(f->api.context, 0, l.id, NULL), BF_OK);
    assert_int_equal(f->api.leave(f->api.context, 0, l.id, NULL), BF_ENOTFOUND);
    assert_int_equal(state_of_job(f, left), EXECUTOR_ENDED); // it had not begun
    assert_false(f->executor->functions->has_room(f->executor, false));
    api_lease_fini(&l);
    executor_job *kept = start(f, RUN_B, false), *forgotten = start(f, RUN_C, false);
    l = lease(f, "one", 2);
    assert_int_equal(l.n_jobs, 2);
    renew(f, l.id, "one", &l.jobs[0], NULL);
    assert_int_equal(state_of_job(f, kept), EXECUTOR_WAITING);
    assert_int_equal(state_of_job(f, forgotten), EXECUTOR_ENDED);
    deliver(f, l.id, 0, 0, "abc", 3);
    assert_int_equal(f->api.leave(f->api.context, 0, l.id, NULL), BF_OK);
    char text[8];
    (void)poll_job(f, kept, text, sizeof text);
    assert_int_equal(state_of_job(f, kept), EXECUTOR_LOST);
    release(f, left);
    release(f, kept);
    release(f, forgotten);
    api_lease_fini(&l);
}

static void a_stop_reaches_the_worker(void **state)
{
    fixture *f = *state;
    const executor_functions *functions = f->executor->functions;

    executor_job *waiting = start(f, RUN_B, false);
    functions->stop(f->executor, waiting, EXECUTOR_STOP_GRACEFUL);
    assert_int_equal(state_of_job(f, waiting), EXECUTOR_ENDED);
    executor_job *job = start(f, RUN_A, false);
    api_lease l = lease(f, "one", 1);
    functions->stop(f->executor, job, EXECUTOR_STOP_GRACEFUL);
    deliver(f, l.id, 0, 0, "abc", 3);
    assert_int_equal(state_of(f, 0).stop, API_JOB_SAVE);
    functions->stop(f->executor, job, EXECUTOR_STOP_NOW);
    assert_int_equal(state_of_job(f, job), EXECUTOR_ENDED);
    deliver(f, l.id, 0, 3, "def", 3);
    assert_int_equal(state_of(f, 0).stop, API_JOB_GONE);
    release(f, waiting);
    release(f, job);
    api_lease_fini(&l);
}

static void another_version_is_refused(void **state)
{
    fixture *f = *state;
    api_worker who = worker_of("one", 1);
    api_lease made;
    bf_error err = { 0 };

    snprintf(who.solver, sizeof who.solver, "0.0.0-other");
    assert_int_equal(f->api.lease(f->api.context, &who, &made, &err), BF_ECONFLICT);
    assert_non_null(strstr(err.text, "0.0.0-other"));
    assert_non_null(strstr(err.text, BELTFLOW_VERSION));
    snprintf(who.solver, sizeof who.solver, "%s/%d", BELTFLOW_VERSION, RUN_VERSION - 1);
    assert_int_equal(f->api.lease(f->api.context, &who, &made, NULL), BF_ECONFLICT);
    snprintf(who.solver, sizeof who.solver, "%s", BELTFLOW_VERSION);
    assert_int_equal(f->api.lease(f->api.context, &who, &made, NULL), BF_ECONFLICT);
}

static void a_worker_at_fault_gets_nothing_for_a_while(void **state)
{
    fixture *f = *state;
    bf_error why = { 0 };

    (void)bf_fail(&why, BF_ECORRUPT, "", "a frame is damaged");
    for (int k = 0; k < PULL_FAULTS_MAX; k++) {
        executor_job *job = start(f, RUN_A, false);
        api_lease l = lease(f, "liar", 1);
        assert_int_equal(l.n_jobs, 1);
        assert_true(f->executor->functions->attribute_fault(f->executor, job, &why));
        release(f, job);
        api_lease_fini(&l);
    }
    executor_job *job = start(f, RUN_A, false);
    api_lease none = lease(f, "liar", 1);
    assert_int_equal(none.n_jobs, 0);
    api_lease l = lease(f, "other", 1);
    assert_int_equal(l.n_jobs, 1);
    release(f, job);
    api_lease_fini(&l);
}

static void assert_leases(fixture *f, const char *name, uint64_t token, size_t n)
{
    api_worker who = worker_of(name, 1);
    api_lease made = { .n_jobs = 0 };

    who.token = token;
    assert_int_equal(f->api.lease(f->api.context, &who, &made, NULL), BF_OK);
    assert_int_equal(made.n_jobs, n);
    api_lease_fini(&made);
}

// An attempt at a run of which this worker says that it fails.
static bool fails_at(fixture *f, const char *name, uint64_t token, const char *text)
{
    bf_error why = { 0 };

    (void)bf_fail(&why, BF_EINPUT, "", "%s", text);
    executor_job *job = start(f, RUN_A, false);
    assert_leases(f, name, token, 1);
    const bool counts = f->executor->functions->confirm(f->executor, job, &why);
    release(f, job);
    return counts;
}

static void a_failure_counts_when_another_attempt_has_the_same(void **state)
{
    fixture *f = *state;

    assert_false(fails_at(f, "one", 1, "parts overlap"));
    assert_false(
        fails_at(f, "one", 1, "no memory")); // there is nobody else, but it says another thing
    assert_true(fails_at(f, "one", 1, "parts overlap"));
}

static void who_failed_at_a_run_gets_it_after_others(void **state)
{
    fixture *f = *state;

    assert_false(fails_at(f, "one", 1, "parts overlap"));
    executor_job *job = start(f, RUN_A, false);
    executor_job *other_run = start(f, RUN_B, false);
    assert_leases(f, "two", 1, 1); // of the same token: there is no other
    release(f, job);
    release(f, other_run);
    job = start(f, RUN_A, false);
    assert_leases(f, "one", 1, 0); // "two" is there
    release(f, job);
    other_run = start(f, RUN_B, false);
    assert_leases(f, "three", 2, 1);
    release(f, other_run);
    job = start(f, RUN_A, false);
    assert_leases(f, "two", 1, 0); // now another token is
    job->started_ms -= PULL_OTHERS_FIRST_MS;
    assert_leases(f, "one", 1, 1); // nobody came
    release(f, job);
}

static void who_said_that_a_run_fails_is_at_fault_when_it_succeeds(void **state)
{
    fixture *f = *state;

    for (int k = 0; k < PULL_FAULTS_MAX; k++) {
        assert_false(fails_at(f, "liar", 1, "parts overlap"));
        executor_job *job = start(f, RUN_A, false);
        assert_leases(f, "honest", 2, 1);
        assert_true(f->executor->functions->confirm(f->executor, job, NULL));
        release(f, job);
    }
    executor_job *job = start(f, RUN_B, false);
    assert_leases(f, "liar", 1, 0);
    assert_leases(f, "honest", 2, 1);
    release(f, job);
}

// The daemon after this one knows the job by its name, and its worker by the lease that it renews.
static void a_job_goes_on_after_a_restart(void **state)
{
    fixture *f = *state;
    char id[EXECUTOR_ID_SIZE], text[8];
    executor *next = NULL;
    executor_job *again = NULL;

    executor_job *job = start(f, RUN_A, false);
    api_lease l = lease(f, "one", 1);
    snprintf(id, sizeof id, "%s", f->executor->functions->external_id(job));
    release(f, job);
    assert_int_equal(pull_executor_create(&next, NULL), BF_OK);
    pull_executor_destroy(f->executor);
    f->executor = next;
    f->api = pull_executor_leases(next);
    assert_int_equal(next->functions->attach(next, "pull:x", &again, NULL), BF_ENOTFOUND);
    assert_int_equal(next->functions->attach(next, id, &again, NULL), BF_OK);
    assert_int_equal(state_of_job(f, again), EXECUTOR_WAITING);
    renew(f, l.id, "one", &l.jobs[0], NULL);
    assert_int_equal(state_of(f, 0).next, 0);
    assert_int_equal(state_of(f, 0).stop, API_JOB_GO_ON);
    deliver(f, l.id, 0, 0, "abc", 3);
    assert_int_equal(poll_job(f, again, text, sizeof text), EXECUTOR_RUNNING);
    assert_string_equal(text, "abc");
    release(f, again);
    api_lease_fini(&l);
}

static void a_job_nobody_comes_back_for_is_lost(void **state)
{
    fixture *f = *state;
    executor_job *job = NULL;

    assert_int_equal(f->executor->functions->attach(f->executor, "pull:" RUN_A ":7", &job, NULL),
                     BF_OK);
    pull_executor *e = pull__enter(f->executor);
    pull__expire(e, job->until_ms - 1);
    assert_int_equal(job->place, PULL_AWAITED);
    pull__expire(e, job->until_ms);
    lock_release(&e->lock);
    assert_int_equal(state_of_job(f, job), EXECUTOR_LOST);
    release(f, job);
}

static void assert_duplicates(int64_t equal, int64_t unequal)
{
    assert_int_equal(metrics_value(METRICS_PULL_DUPLICATES, METRICS_MATCH_EQUAL), equal);
    assert_int_equal(metrics_value(METRICS_PULL_DUPLICATES, METRICS_MATCH_UNEQUAL), unequal);
}

static void ends_that_come_twice_are_compared(void **state)
{
    fixture *f = *state;
    const int64_t equal = metrics_value(METRICS_PULL_DUPLICATES, METRICS_MATCH_EQUAL);
    const int64_t unequal = metrics_value(METRICS_PULL_DUPLICATES, METRICS_MATCH_UNEQUAL);
    api_job_end end = { .cause = API_JOB_EXITED, .digest = "00000000000000aa" };

    executor_job *first = start(f, RUN_A, false);
    api_lease late = lease(f, "late", 1);
    pull_executor *e = pull__enter(f->executor);
    pull__lose_lease(e, e->leases[0], "silent");
    lock_release(&e->lock);
    executor_job *second = start(f, RUN_A, false);
    api_lease l = lease(f, "second", 1);
    renew(f, l.id, "second", &l.jobs[0], &end);
    renew(f, l.id, "second", &l.jobs[0], &end); // the same end once more is none of another
    assert_duplicates(equal, unequal);
    renew(f, late.id, "late", &late.jobs[0], &end);
    assert_duplicates(equal + 1, unequal);
    snprintf(end.digest, sizeof end.digest, "00000000000000ab");
    renew(f, late.id, "late", &late.jobs[0], &end);
    assert_duplicates(equal + 1, unequal + 1);
    release(f, first);
    release(f, second);
    api_lease_fini(&late);
    api_lease_fini(&l);
}

// A worker that renews a lease but never begins does not hold the run for ever.
static void what_is_leased_and_not_begun_comes_back(void **state)
{
    fixture *f = *state;
    executor_job *held = start(f, RUN_A, false), *solved = start(f, RUN_B, false);
    executor_job *trial = start(f, RUN_C, true);
    api_lease l = lease(f, "one", 3);
    executor_end end;
    char text[8];
    size_t n;

    assert_int_equal(l.n_jobs, 3);
    deliver(f, l.id, 1, 0, "a", 1);
    (void)poll_job(f, solved, text, sizeof text);
    pull_executor *e = pull__enter(f->executor);
    const int64_t now_ms = held->leased_ms + PULL_BEGIN_MS;
    e->leases[0]->seen_ms = now_ms; // renewed all the time
    pull__expire(e, now_ms - 1);
    assert_int_equal(held->place, PULL_LEASED);
    pull__expire(e, now_ms);
    assert_int_equal(held->place, PULL_ENDED);
    assert_int_equal(solved->place, PULL_LEASED);
    assert_int_equal(trial->place, PULL_LEASED);
    assert_int_equal(e->workers[0].n_faults, 1);
    e->leases[0]->seen_ms += PULL_BEGIN_TRIAL_MS;
    pull__expire(e, trial->leased_ms + PULL_BEGIN_TRIAL_MS);
    assert_int_equal(trial->place, PULL_ENDED);
    assert_int_equal(solved->place, PULL_LEASED);
    lock_release(&e->lock);
    assert_int_equal(f->executor->functions->poll(f->executor, held, text, sizeof text, &n, &end),
                     EXECUTOR_ENDED);
    assert_int_equal(end.cause, API_JOB_STOPPED);
    release(f, held);
    release(f, solved);
    release(f, trial);
    api_lease_fini(&l);
}

// Whoever says more CPU time than there was does not use up what an owner may use.
static void no_more_cpu_time_is_believed_than_has_passed(void **state)
{
    fixture *f = *state;
    executor_job *job = start(f, RUN_A, false);
    api_lease l = lease(f, "liar", 1);
    api_job_report report = report_of(&l.jobs[0]);
    api_renewal renewal = { .n_jobs = 1, .jobs = &report };

    (void)solver_name(renewal.solver);
    snprintf(renewal.worker, sizeof renewal.worker, "liar");
    for (int k = 0; k < 2; k++) {
        report.cpu_s = k == 0 ? 1e15 : 1e300;
        assert_int_equal(f->api.renew(f->api.context, l.id, &renewal, &f->states, NULL), BF_OK);
        memory_free(f->states.items);
        f->states.items = NULL;
        const double used_s = f->executor->functions->cpu_s(f->executor, job);
        const int64_t passed_ms = clock_monotonic_ms() - job->leased_ms;
        assert_true(used_s > 0.0 && used_s <= 1.0 + 1e-3 * (double)passed_ms);
    }
    release(f, job);
    api_lease_fini(&l);
}

// The same of a job that the daemon before this one leased: its attempt says when, ten seconds ago. Its end is believed no more
// than it itself.
static void no_more_cpu_time_is_believed_of_a_job_that_goes_on_after_a_restart(void **state)
{
    fixture *f = *state;
    const uint64_t attempt = (uint64_t)clock_unix_ms() - 10000;
    api_job_report report = { .job = 0, .run = RUN_A, .attempt = attempt, .cpu_s = 5.0 };
    api_job_end end = { .cause = API_JOB_EXITED };
    api_renewal renewal = { .worker = "liar", .n_jobs = 1, .jobs = &report, .ended = &end };
    char id[EXECUTOR_ID_SIZE];
    executor_job *job = NULL;

    (void)solver_name(renewal.solver);
    snprintf(id, sizeof id, "pull:" RUN_A ":%llu", (unsigned long long)attempt);
    assert_int_equal(f->executor->functions->attach(f->executor, id, &job, NULL), BF_OK);
    for (int k = 0; k < 3; k++) {
        assert_int_equal(f->api.renew(f->api.context, RUN_B, &renewal, &f->states, NULL), BF_OK);
        memory_free(f->states.items);
        f->states.items = NULL;
        const double used_s = f->executor->functions->cpu_s(f->executor, job);
        const int64_t passed_ms = clock_unix_ms() - (int64_t)attempt;
        assert_true(k == 0 ? used_s == 5.0 : used_s >= 5.0);
        assert_true(used_s <= API_WORKER_CORES * (1.0 + 1e-3 * (double)passed_ms));
        report.cpu_s = 1e300;
        end.report = report;
        renewal.n_jobs = k == 0; // at last it has ended
        renewal.n_ended = k == 1;
    }
    assert_int_equal(state_of_job(f, job), EXECUTOR_ENDED);
    release(f, job);
}

static void the_memory_of_runs_adds_up(void **state)
{
    enum { GIB = 1 << 30 };
    fixture *f = *state;
    executor_job *jobs[8];
    api_worker who = worker_of("small", 8);
    api_lease first = { .n_jobs = 0 }, second = { .n_jobs = 0 };

    for (size_t k = 0; k < 8; k++) {
        jobs[k] = start(f, RUN_A, false);
        jobs[k]->about.memory_bytes = UINT64_C(8) * GIB;
    }
    who.memory_bytes = GIB; // one all the same: most use less than they may
    assert_int_equal(f->api.lease(f->api.context, &who, &first, NULL), BF_OK);
    assert_int_equal(first.n_jobs, 1);
    who.memory_bytes = UINT64_C(24) * GIB;
    assert_int_equal(f->api.lease(f->api.context, &who, &second, NULL), BF_OK);
    assert_int_equal(second.n_jobs, 2);
    api_lease_fini(&first);
    api_lease_fini(&second);
    for (size_t k = 0; k < 8; k++)
        release(f, jobs[k]);
}

// Two tokens, workers of the same name: neither touches what is the other's.
static void a_worker_is_its_token_and_its_name(void **state)
{
    fixture *f = *state;
    api_worker mine = worker_of("one", 1), theirs = worker_of("one", 1);
    api_lease l = { .n_jobs = 0 }, other = { .n_jobs = 0 };
    api_worker_list list = { .n = 0 };
    bf_buffer input = { 0 };
    bf_error why = { 0 };

    (void)bf_fail(&why, BF_ECORRUPT, "", "a frame is damaged");
    mine.token = 1;
    theirs.token = 2;
    executor_job *job = start(f, RUN_A, false);
    assert_int_equal(f->api.lease(f->api.context, &mine, &l, NULL), BF_OK);
    assert_int_equal(f->api.lease(f->api.context, &theirs, &other, NULL), BF_OK);
    assert_int_equal(other.n_jobs, 0);
    assert_int_equal(f->api.read_jobs(f->api.context, 2, l.id, &input, NULL), BF_ENOTFOUND);
    assert_int_equal(f->api.leave(f->api.context, 2, l.id, NULL), BF_ENOTFOUND);
    assert_int_equal(f->api.list(f->api.context, 2, &list, NULL), BF_OK);
    assert_int_equal(list.n, 1);
    assert_int_equal(list.workers[0].n_leases, 0);
    api_worker_list_fini(&list);
    assert_int_equal(f->api.read_jobs(f->api.context, 1, l.id, &input, NULL), BF_OK);
    buffer_fini(&input);
    for (int k = 0; k < PULL_FAULTS_MAX; k++)
        assert_true(f->executor->functions->attribute_fault(f->executor, job, &why)); // of token 1
    executor_job *next = start(f, RUN_B, false);
    assert_int_equal(f->api.lease(f->api.context, &theirs, &other, NULL), BF_OK);
    assert_int_equal(other.n_jobs, 1);
    release(f, job);
    release(f, next);
    api_lease_fini(&l);
    api_lease_fini(&other);
}

static void workers_are_listed(void **state)
{
    fixture *f = *state;
    api_worker_list list = { .n = 0 };

    executor_job *job = start(f, RUN_A, false);
    api_lease l = lease(f, "one", 3);
    (void)lease(f, "idle", 1);
    assert_int_equal(f->api.list(f->api.context, API_ANY_TOKEN, &list, NULL), BF_OK);
    assert_int_equal(list.n, 2);
    assert_string_equal(list.workers[0].about.name, "one");
    assert_int_equal(list.workers[0].n_leases, 1);
    assert_string_equal(list.workers[0].leases[0].id, l.id);
    assert_int_equal(list.workers[1].n_leases, 0);
    api_worker_list_fini(&list);
    release(f, job);
    api_lease_fini(&l);
}

int main(void)
{
#define TEST(function) cmocka_unit_test_setup_teardown(function, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(bytes_come_through_in_order),
        TEST(a_full_job_takes_no_more),
        TEST(all_jobs_together_have_a_limit),
        TEST(a_batch_has_runs_first_then_trials),
        TEST(there_is_room_for_what_workers_take),
        TEST(who_is_silent_loses_jobs),
        TEST(who_leaves_or_forgets_loses_jobs),
        TEST(a_stop_reaches_the_worker),
        TEST(another_version_is_refused),
        TEST(a_worker_at_fault_gets_nothing_for_a_while),
        TEST(a_failure_counts_when_another_attempt_has_the_same),
        TEST(who_failed_at_a_run_gets_it_after_others),
        TEST(who_said_that_a_run_fails_is_at_fault_when_it_succeeds),
        TEST(a_job_goes_on_after_a_restart),
        TEST(a_job_nobody_comes_back_for_is_lost),
        TEST(ends_that_come_twice_are_compared),
        TEST(workers_are_listed),
        TEST(what_is_leased_and_not_begun_comes_back),
        TEST(no_more_cpu_time_is_believed_than_has_passed),
        TEST(no_more_cpu_time_is_believed_of_a_job_that_goes_on_after_a_restart),
        TEST(the_memory_of_runs_adds_up),
        TEST(a_worker_is_its_token_and_its_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
