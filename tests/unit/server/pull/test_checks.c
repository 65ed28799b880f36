// Runs that are solved twice: workers of three tokens deliver frames that are whole, and one of them has other results.

#include "core/base/buffer.h"
#include "core/base/memory.h"
#include "core/observe/frame.h"
#include "server/base/clock.h"
#include "server/base/metrics.h"
#include "server/base/solver.h"
#include "server/pull/pull_priv.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

#define RUN "0190a0b0-0000-7000-8000-00000000000a"

enum { SAMPLES = 4, COLUMNS = 2 };

typedef struct fixture {
    executor *executor;
    int n_disputed;      // times that the results of the run were called suspect
    int n_distrusted;    // times that those of a token were
    uint64_t distrusted; // the last one
    api_leases api;
    int64_t equal, unequal, faults; // metrics at the start
} fixture;

static void suspect(void *context, const char *run_id, uint64_t token)
{
    fixture *f = context;

    if (run_id != NULL)
        assert_string_equal(run_id, RUN);
    f->n_disputed += run_id != NULL;
    f->n_distrusted += token != 0;
    f->distrusted = token != 0 ? token : f->distrusted;
}

static int setup(void **state)
{
    static fixture f;

    f = (fixture){ .executor = NULL };
    assert_int_equal(pull_executor_create(&f.executor, NULL), BF_OK);
    pull_executor_set_check_every(f.executor, 1);
    pull_executor_set_suspecting(f.executor, suspect, &f);
    f.api = pull_executor_leases(f.executor);
    f.equal = metrics_value(METRICS_PULL_DUPLICATES, METRICS_MATCH_EQUAL);
    f.unequal = metrics_value(METRICS_PULL_DUPLICATES, METRICS_MATCH_UNEQUAL);
    f.faults = metrics_value(METRICS_PULL_FAULTS, 0);
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    fixture *f = *state;

    pull_executor_destroy(f->executor);
    return 0;
}

static void assert_found(const fixture *f, int64_t equal, int64_t unequal, int64_t faults)
{
    assert_int_equal(metrics_value(METRICS_PULL_DUPLICATES, METRICS_MATCH_EQUAL), f->equal + equal);
    assert_int_equal(metrics_value(METRICS_PULL_DUPLICATES, METRICS_MATCH_UNEQUAL),
                     f->unequal + unequal);
    assert_int_equal(metrics_value(METRICS_PULL_FAULTS, 0), f->faults + faults);
    // The run's results as soon as two differ, and all of a token as soon as two others agree.
    assert_int_equal(f->n_disputed, unequal);
    assert_int_equal(f->n_distrusted, faults);
}

static executor_job *start(fixture *f)
{
    bf_buffer scenario = { 0 };
    const bf_buffer none = { 0 };
    executor_job *job = NULL;

    assert_int_equal(buffer_printf(&scenario, "{}"), BF_OK);
    const executor_work work = {
        .run_id = RUN, .n_threads = 1, .scenario = &scenario, .checkpoint = &none
    };
    assert_int_equal(f->executor->functions->start(f->executor, &work, &job, NULL), BF_OK);
    buffer_fini(&scenario);
    return job;
}

static void append(bf_buffer *out, const frame *f)
{
    assert_int_equal(frame_encode(f, out, NULL), BF_OK);
}

// The frames of a run whose last sample has this value: n samples at a time, and with progress and checkpoints between
// them, as many as there are curves.
static void encode(bf_buffer *out, double last, uint32_t n)
{
    static const double t[SAMPLES] = { 0, 1, 2, 3 };
    const double values[SAMPLES * COLUMNS] = { 9, 0, 7, 2, 5, 4, 3, last };
    const char checkpoint[100] = "where it was";

    for (uint32_t k = 0; k < SAMPLES; k += n) {
        append(out, &(frame){ .type = FRAME_CURVE,
                              .curve = { .first = k,
                                         .n = n,
                                         .n_columns = COLUMNS,
                                         .t = t + k,
                                         .values = values + (size_t)k * COLUMNS } });
        append(out, &(frame){ .type = FRAME_PROGRESS, .progress = { .step = k, .n_steps = 9 } });
        append(out, &(frame){ .type = FRAME_CHECKPOINT,
                              .bytes = { .n = sizeof checkpoint, .bytes = checkpoint } });
    }
    append(out, &(frame){ .type = FRAME_END, .end = { .n_steps = 9, .n_samples = SAMPLES } });
}

static size_t lease(fixture *f, uint64_t token, api_lease *ret_lease)
{
    api_worker who = { .cores = 1, .token = token };

    (void)solver_name(who.solver);
    snprintf(who.name, sizeof who.name, "worker-%d", (int)token);
    *ret_lease = (api_lease){ .n_jobs = 0 };
    assert_int_equal(f->api.lease(f->api.context, &who, ret_lease, NULL), BF_OK);
    return ret_lease->n_jobs;
}

// A worker with this token solves what it gets, if it gets anything, and has this last sample. Bytes come a few at a time.
static bool solves(fixture *f, uint64_t token, double last, uint32_t n)
{
    enum { PIECE = 37 };
    bf_buffer frames = { 0 };
    api_job_states states;
    api_lease l;

    if (lease(f, token, &l) == 0)
        return false;
    encode(&frames, last, n);
    for (size_t at = 0; at < frames.n; at += PIECE) {
        const size_t left = frames.n - at;
        const api_lease_section section = { .offset = at,
                                            .n = left < PIECE ? left : PIECE,
                                            .bytes = frames.bytes + at };
        assert_int_equal(f->api.deliver(f->api.context, token, l.id, &section, 1, &states, NULL),
                         BF_OK);
        memory_free(states.items);
    }
    api_job_end end = { .cause = API_JOB_EXITED,
                        .n_bytes = frames.n,
                        .report = { .attempt = l.jobs[0].attempt } };
    api_renewal renewal = { .token = token, .n_ended = 1, .ended = &end };
    memcpy(end.report.run, l.jobs[0].run, sizeof end.report.run);
    (void)solver_name(renewal.solver);
    snprintf(renewal.worker, sizeof renewal.worker, "worker-%d", (int)token);
    assert_int_equal(f->api.renew(f->api.context, l.id, &renewal, &states, NULL), BF_OK);
    memory_free(states.items);
    api_lease_fini(&l);
    buffer_fini(&frames);
    f->executor->functions->update(f->executor);
    return true;
}

// Workers of so many tokens are there, and have nothing to do.
static void are_there(fixture *f, uint64_t n_tokens)
{
    for (uint64_t token = 1; token <= n_tokens; token++) {
        api_lease l;
        assert_int_equal(lease(f, token, &l), 0);
        api_lease_fini(&l);
    }
}

static void release(fixture *f, executor_job *job)
{
    f->executor->functions->release(f->executor, job);
}

static void another_token_solves_the_run_again(void **state)
{
    fixture *f = *state;

    are_there(f, 2);
    executor_job *job = start(f);
    assert_true(solves(f, 1, 6, 1));
    release(f, job); // the supervisor has its results, and knows nothing of the repetition
    assert_false(solves(f, 1, 6, 1));
    // The samples are the same, also where they come four at a time instead of one.
    assert_true(solves(f, 2, 6, SAMPLES));
    assert_found(f, 1, 0, 0);
    assert_false(solves(f, 2, 6, 1));
    assert_int_equal(pull_executor_count_cores(f->executor), 0);
}

static void of_three_the_one_that_differs_is_at_fault(void **state)
{
    fixture *f = *state;

    are_there(f, 3);
    for (int k = 0; k < PULL_FAULTS_MAX; k++) {
        executor_job *job = start(f);
        assert_true(solves(f, 1, 6.001, 1)); // this one lies
        release(f, job);
        assert_true(solves(f, 2, 6, 1));
        assert_found(f, k, k + 1, k);
        assert_false(solves(f, 1, 6, 1) || solves(f, 2, 6, 1));
        assert_true(solves(f, 3, 6, 2));
        assert_found(f, k + 1, k + 1, k + 1);
        assert_int_equal(f->distrusted, 1);
    }
    // It gets nothing for a while.
    executor_job *job = start(f);
    assert_false(solves(f, 1, 6, 1));
    assert_true(solves(f, 3, 6, 1));
    release(f, job);
}

static void of_two_that_differ_nobody_is_said_to_be_at_fault(void **state)
{
    fixture *f = *state;

    are_there(f, 2);
    executor_job *job = start(f);
    assert_true(solves(f, 1, 6, 1));
    assert_true(solves(f, 2, 5, 1));
    assert_found(f, 0, 1, 0);
    assert_int_equal(pull_executor_count_cores(f->executor), 0);
    release(f, job);
}

static void one_token_alone_solves_once(void **state)
{
    fixture *f = *state;

    are_there(f, 1);
    executor_job *job = start(f);
    assert_true(solves(f, 1, 6, 1));
    assert_int_equal(pull_executor_count_cores(f->executor), 0);
    assert_found(f, 0, 0, 0);
    release(f, job);
}

static void a_repetition_that_nobody_ends_is_given_up(void **state)
{
    fixture *f = *state;
    api_lease l;

    are_there(f, 2);
    executor_job *job = start(f);
    assert_true(solves(f, 1, 6, 1));
    release(f, job);
    assert_int_equal(lease(f, 2, &l), 1);
    pull_executor *e = pull__enter(f->executor);
    pull__drop_repetitions(e, clock_monotonic_ms());
    assert_false(TAILQ_EMPTY(&e->jobs));
    pull__drop_repetitions(e, clock_monotonic_ms() + 2 * PULL_OTHERS_FIRST_MS);
    assert_true(TAILQ_EMPTY(&e->jobs));
    lock_release(&e->lock);
    assert_int_equal(pull_executor_count_cores(f->executor), 0);
    assert_found(f, 0, 0, 0);
    api_lease_fini(&l);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(another_token_solves_the_run_again),
        TEST(of_three_the_one_that_differs_is_at_fault),
        TEST(of_two_that_differ_nobody_is_said_to_be_at_fault),
        TEST(one_token_alone_solves_once),
        TEST(a_repetition_that_nobody_ends_is_given_up),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
