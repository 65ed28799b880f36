// Tests of what workers send: documents of leases, and sections of frames. Answers are checked by stories, against the
// document of the API.

#include "api/results/lease_json.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

#define RUN  "0190a0b0-0000-7000-8000-000000000001"
#define JOB  "\"run\":\"" RUN "\",\"attempt\":7,\"cpu_s\":0.5"
#define NAME "\"worker\":\"node-1\",\"solver\":\"1\""

static bf_status read_worker(const char *json, api_worker *ret_worker)
{
    bf_faults faults = { .n = 0 };

    return lease_json_read_worker(json, strlen(json), ret_worker, &faults, NULL);
}

static bf_status read_renewal(const char *json, api_renewal *ret_renewal)
{
    bf_faults faults = { .n = 0 };

    return lease_json_read_renewal(json, strlen(json), ret_renewal, &faults, NULL);
}

static void a_worker_describes_itself(void **state)
{
    api_worker worker;

    assert_int_equal(read_worker("{" NAME ",\"cores\":4,\"memory_bytes\":1000}", &worker), BF_OK);
    assert_string_equal(worker.name, "node-1");
    assert_int_equal(worker.cores, 4);
    assert_int_equal(worker.memory_bytes, 1000);
    assert_int_not_equal(read_worker("{" NAME ",\"cores\":0,\"memory_bytes\":1}", &worker), BF_OK);
    assert_int_not_equal(read_worker("{" NAME ",\"cores\":1025,\"memory_bytes\":1}", &worker),
                         BF_OK);
    assert_int_not_equal(
        read_worker("{\"worker\":\"a b\",\"solver\":\"1\",\"cores\":1,\"memory_bytes\":1}",
                    &worker),
        BF_OK);
}

static void a_renewal_has_jobs_and_ends(void **state)
{
    api_renewal renewal = { .n_jobs = 0 };

    assert_int_equal(read_renewal("{" NAME ",\"jobs\":[{\"job\":3," JOB "}],"
                                  "\"ended\":[{\"job\":0," JOB ",\"cause\":\"timed_out\","
                                  "\"error\":{\"code\":\"limit\",\"text\":\"too long\"},"
                                  "\"bytes\":9,\"digest\":null}]}",
                                  &renewal),
                     BF_OK);
    assert_int_equal(renewal.n_jobs, 1);
    assert_int_equal(renewal.jobs[0].job, 3);
    assert_string_equal(renewal.jobs[0].run, RUN);
    assert_int_equal(renewal.n_ended, 1);
    assert_int_equal(renewal.ended[0].report.attempt, 7);
    assert_int_equal(renewal.ended[0].cause, API_JOB_TIMED_OUT);
    assert_int_equal(renewal.ended[0].error.code, BF_ELIMIT);
    assert_int_equal(renewal.ended[0].n_bytes, 9);
    assert_string_equal(renewal.ended[0].digest, "");
    api_renewal_fini(&renewal);
    // A number that no lease has is the index of a list here.
    assert_int_not_equal(
        read_renewal("{" NAME ",\"jobs\":[{\"job\":1024," JOB "}],\"ended\":[]}", &renewal), BF_OK);
}

static void sections_are_whole_or_refused(void **state)
{
    static const char bytes[] = "\2\0\0\0\3\0\0\0\5\0\0\0\0\0\0\0abc"
                                "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0";
    static const char other[] = "\0\4\0\0\0\0\0\0\0\0\0\0\0\0\0\0"; // job 1024
    static api_lease_section sections[LEASE_SECTIONS_MAX];
    size_t n = 0;

    assert_int_equal(lease_json_read_sections(bytes, 35, sections, &n, NULL), BF_OK);
    assert_int_equal(n, 2);
    assert_int_equal(sections[0].job, 2);
    assert_int_equal(sections[0].offset, 5);
    assert_int_equal(sections[0].n, 3);
    assert_memory_equal(sections[0].bytes, "abc", 3);
    for (size_t k = 1; k < 35; k++)
        assert_int_equal(lease_json_read_sections(bytes, k, sections, &n, NULL),
                         k == 19 ? BF_OK : BF_EINPUT);
    assert_int_equal(lease_json_read_sections(other, 16, sections, &n, NULL), BF_EINPUT);
    static const char empty[16 * (LEASE_SECTIONS_MAX + 1)];
    assert_int_equal(lease_json_read_sections(empty, sizeof empty - 16, sections, &n, NULL), BF_OK);
    assert_int_equal(lease_json_read_sections(empty, sizeof empty, sections, &n, NULL), BF_EINPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_worker_describes_itself),
        cmocka_unit_test(a_renewal_has_jobs_and_ends),
        cmocka_unit_test(sections_are_whole_or_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
