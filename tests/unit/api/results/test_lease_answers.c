// Tests of the worker's documents against the service's: what one side writes the other reads. Answers that no service
// gives are refused.

#include "api/results/lease_json.h"
#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

#define RUN "0190a0b0-0000-7000-8000-000000000001"

static void the_service_reads_a_worker(void **state)
{
    const api_worker worker = {
        .name = "node-1", .solver = "1.2", .cores = 4, .memory_bytes = UINT64_C(1) << 40
    };
    bf_buffer out = { .n = 0 };
    bf_faults faults = { .n = 0 };
    api_worker found = { .cores = 0 };

    assert_int_equal(lease_json_write_worker(&worker, &out, NULL), BF_OK);
    assert_int_equal(lease_json_read_worker(out.bytes, out.n, &found, &faults, NULL), BF_OK);
    assert_string_equal(found.name, worker.name);
    assert_string_equal(found.solver, worker.solver);
    assert_int_equal(found.cores, worker.cores);
    assert_int_equal(found.memory_bytes, worker.memory_bytes);
    buffer_fini(&out);
}

static void the_service_reads_a_renewal(void **state)
{
    api_job_report goes_on = { .job = 1, .run = RUN, .attempt = 1795411045651, .cpu_s = 0.25 };
    api_job_end ends[] = {
        { .report = { .job = 0, .run = RUN, .attempt = 7 },
          .cause = API_JOB_TIMED_OUT,
          .error = { .code = BF_ELIMIT, .text = "too long" },
          .n_bytes = 9 },
        { .report = { .job = 2, .run = RUN, .attempt = 8 },
          .cause = API_JOB_EXITED,
          .n_bytes = 10,
          .digest = "00000000000000ab" },
    };
    const api_renewal renewal = { .worker = "node-1",
                                  .solver = "1.2",
                                  .n_jobs = 1,
                                  .jobs = &goes_on,
                                  .n_ended = 2,
                                  .ended = ends };
    bf_buffer out = { .n = 0 };
    bf_faults faults = { .n = 0 };
    api_renewal found = { .n_jobs = 0 };

    assert_int_equal(lease_json_write_renewal(&renewal, &out, NULL), BF_OK);
    assert_int_equal(lease_json_read_renewal(out.bytes, out.n, &found, &faults, NULL), BF_OK);
    assert_int_equal(found.n_jobs, 1);
    assert_int_equal(found.jobs[0].attempt, goes_on.attempt);
    assert_true(found.jobs[0].cpu_s == 0.25);
    assert_int_equal(found.n_ended, 2);
    assert_int_equal(found.ended[0].cause, API_JOB_TIMED_OUT);
    assert_int_equal(found.ended[0].error.code, BF_ELIMIT);
    assert_string_equal(found.ended[0].digest, "");
    assert_int_equal(found.ended[1].error.code, BF_OK);
    assert_string_equal(found.ended[1].digest, ends[1].digest);
    api_renewal_fini(&found);
    buffer_fini(&out);
}

static void a_worker_reads_what_the_service_says(void **state)
{
    api_lease_job jobs[] = { { .job = 0,
                               .run = RUN,
                               .attempt = 1795411045651,
                               .model = RUN_MICRO,
                               .n_threads = 2,
                               .is_trial = true,
                               .predicted_s = NAN,
                               .n_bytes = 64 } };
    const api_lease lease = {
        .id = RUN, .retry_s = 3, .body_bytes = 262144, .n_jobs = 1, .jobs = jobs
    };
    api_job_state gone = { .job = 3, .next = 70, .stop = API_JOB_GONE };
    const api_job_states states = { .n = 1, .items = &gone };
    bf_buffer out = { .n = 0 };
    api_lease found = { .n_jobs = 0 };
    api_job_states found_states = { .n = 0 };

    assert_int_equal(lease_json_write(&lease, &out, NULL), BF_OK);
    assert_int_equal(lease_json_read(out.bytes, out.n, &found, NULL), BF_OK);
    assert_string_equal(found.id, RUN);
    assert_int_equal(found.retry_s, 3);
    assert_int_equal(found.body_bytes, 262144);
    assert_int_equal(found.n_jobs, 1);
    assert_int_equal(found.jobs[0].attempt, jobs[0].attempt);
    assert_int_equal(found.jobs[0].model, RUN_MICRO);
    assert_int_equal(found.jobs[0].n_threads, 2);
    assert_true(found.jobs[0].is_trial);
    assert_true(isnan(found.jobs[0].predicted_s));
    assert_int_equal(found.jobs[0].n_bytes, 64);
    api_lease_fini(&found);
    buffer_truncate(&out, 0);
    assert_int_equal(lease_json_write_states(&states, &out, NULL), BF_OK);
    assert_int_equal(lease_json_read_states(out.bytes, out.n, &found_states, NULL), BF_OK);
    assert_int_equal(found_states.n, 1);
    assert_int_equal(found_states.items[0].job, 3);
    assert_int_equal(found_states.items[0].next, 70);
    assert_int_equal(found_states.items[0].stop, API_JOB_GONE);
    memory_free(found_states.items);
    buffer_fini(&out);
}

#define JOB(threads, bytes)                                                                        \
    "{\"job\":0,\"run\":\"" RUN "\",\"attempt\":1,\"model\":\"micro\",\"threads\":" threads        \
    ",\"trial\":false,\"checkpoint_ms\":0,\"memory_bytes\":0,\"cpu_s\":0,\"step\":0,"              \
    "\"predicted_s\":null,\"bytes\":" bytes "}"
#define LEASE(id, retry, jobs)                                                                     \
    "{\"id\":" id ",\"renew_s\":10,\"expires_s\":60,\"retry_s\":" retry                            \
    ",\"body_bytes\":0,\"jobs\":[" jobs "],\"of_a_later_version\":{}}"

static void answers_that_cannot_be_are_refused(void **state)
{
    static const char good[] = LEASE("\"" RUN "\"", "1", JOB("1", "8"));
    static const char *const leases[] = {
        "",
        "[]",
        LEASE("null", "-1", ""),
        LEASE("null", "65536", ""),
        LEASE("null", "1", JOB("1", "8")),
        LEASE("\"../runs\"", "1", ""),
        LEASE("\"" RUN "\"", "1", "{\"job\":0}"),
        LEASE("\"" RUN "\"", "1", JOB("0", "8")),
        LEASE("\"" RUN "\"", "1", JOB("1", "9")),
        LEASE("\"" RUN "\"", "1", JOB("1", "8") "," JOB("1", "8")),
    };
    static const char unknown[] = "{\"jobs\":[{\"job\":0,\"next\":0,\"stop\":\"never\"}]}";
    static const char beyond[] = "{\"jobs\":[{\"job\":1024,\"next\":0,\"stop\":\"none\"}]}";
    api_lease lease;
    api_job_states states;

    assert_int_equal(lease_json_read(good, sizeof good - 1, &lease, NULL), BF_OK);
    api_lease_fini(&lease);
    for (size_t k = 0; k < sizeof leases / sizeof *leases; k++)
        assert_int_equal(lease_json_read(leases[k], strlen(leases[k]), &lease, NULL), BF_ECORRUPT);
    assert_int_equal(lease_json_read_states(unknown, strlen(unknown), &states, NULL), BF_ECORRUPT);
    assert_int_equal(lease_json_read_states(beyond, strlen(beyond), &states, NULL), BF_ECORRUPT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_service_reads_a_worker),
        cmocka_unit_test(the_service_reads_a_renewal),
        cmocka_unit_test(a_worker_reads_what_the_service_says),
        cmocka_unit_test(answers_that_cannot_be_are_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
