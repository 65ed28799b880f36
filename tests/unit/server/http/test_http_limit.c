// Buckets of tokens: sixty requests a minute are one a second.

#include "server/http/limit.h"

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <pthread.h>
#include <string.h>

enum { REQUESTS = 60, WORK = 6 };

static http_limit *limit;

static http_limit *create(uint64_t requests, uint64_t work, size_t n_clients)
{
    const uint64_t quotas[HTTP_LIMIT_COUNT] = { requests, work };
    http_limit *made = NULL;

    assert_int_equal(http_limit_create(quotas, n_clients, &made, NULL), BF_OK);
    return made;
}

static int set_up(void **state)
{
    limit = create(REQUESTS, WORK, 8);
    return 0;
}

static int tear_down(void **state)
{
    limit = http_limit_destroy(limit);
    return 0;
}

static http_limit_verdict take(unsigned who, bool creates_work, int64_t now_ms)
{
    uint8_t key[HTTP_LIMIT_KEY_SIZE] = { 0 };

    memcpy(key, &who, sizeof who);
    return http_limit_take(limit, key, creates_work, now_ms);
}

// Takes until refused; returns how many were let through.
static unsigned drain(unsigned who, bool creates_work, int64_t now_ms)
{
    unsigned n = 0;

    while (!take(who, creates_work, now_ms).is_refused)
        n++;
    return n;
}

static void a_quota_can_be_used_at_once_and_comes_back_evenly(void **state)
{
    assert_int_equal(drain(1, false, 1000), REQUESTS);
    http_limit_verdict verdict = take(1, false, 1000);
    assert_true(verdict.is_refused);
    assert_int_equal(verdict.retry_after_s, 1);
    assert_true(take(1, false, 1999).is_refused);
    assert_false(take(1, false, 2000).is_refused);
    assert_true(take(1, false, 2000).is_refused);
    assert_int_equal(drain(1, false, 12000), 10);
    assert_int_equal(drain(1, false, 1000000), REQUESTS); // never more than the quota
}

static void work_has_a_smaller_quota_and_counts_as_a_request_too(void **state)
{
    assert_int_equal(drain(1, true, 0), WORK);
    http_limit_verdict verdict = take(1, true, 0);
    assert_int_equal(verdict.retry_after_s, 10);
    assert_int_equal(verdict.left[HTTP_LIMIT_WORK], 0);
    assert_int_equal(verdict.left[HTTP_LIMIT_REQUESTS], REQUESTS - WORK); // a refusal takes none
    assert_int_equal(verdict.reset_s[HTTP_LIMIT_WORK], 60);
    assert_int_equal(drain(1, false, 0), REQUESTS - WORK);
}

static void charge(unsigned who, bool creates_work, int64_t before_ms, int64_t after_ms)
{
    uint8_t key[HTTP_LIMIT_KEY_SIZE] = { 0 };

    memcpy(key, &who, sizeof who);
    http_limit_charge(limit, key, creates_work, 1000000 * before_ms, 1000000 * after_ms, 0);
}

// A token of requests is good for 10 ms, one of work for 100 ms: a second takes 99 and 9 beyond it.
static void cpu_time_counts_like_requests(void **state)
{
    assert_false(take(1, true, 0).is_refused);
    charge(1, true, 0, 1000);
    assert_int_equal(take(1, false, 0).retry_after_s, 1 + 99 - (REQUESTS - 1));
    assert_int_equal(take(1, true, 0).retry_after_s, 10 * (1 + 9 - (WORK - 1)));
    assert_true(take(1, false, 40999).is_refused);
    assert_false(take(1, false, 41000).is_refused);
    assert_int_equal(drain(2, true, 0), WORK); // others have nothing to do with it
}

static void what_a_token_is_good_for_costs_nothing_and_pieces_add_up(void **state)
{
    assert_int_equal(take(1, false, 0).left[HTTP_LIMIT_REQUESTS], REQUESTS - 1);
    charge(1, false, 0, 10);
    assert_int_equal(take(1, false, 0).left[HTTP_LIMIT_REQUESTS], REQUESTS - 2);
    charge(1, false, 0, 15);
    charge(1, false, 15, 30);
    assert_int_equal(take(1, false, 0).left[HTTP_LIMIT_REQUESTS], REQUESTS - 2 - 2 - 1);
    assert_int_equal(take(1, true, 0).left[HTTP_LIMIT_WORK], WORK - 1); // it was no work
}

static void a_debt_is_paid_within_a_minute(void **state)
{
    assert_false(take(1, false, 0).is_refused);
    charge(1, false, 0, 3600000);
    charge(1, false, 3600000, INT64_MAX / 1000000);
    assert_int_equal(take(1, false, 0).retry_after_s, HTTP_LIMIT_WINDOW_S + 1);
}

static void clients_do_not_disturb_each_other(void **state)
{
    assert_int_equal(drain(1, false, 0), REQUESTS);
    assert_int_equal(drain(2, false, 0), REQUESTS);
    assert_true(take(1, false, 0).is_refused);
}

// Eight clients have room: the ninth takes the place of the one that has not come for longest.
static void the_table_forgets_who_has_not_come_for_longest(void **state)
{
    for (unsigned who = 0; who < 8; who++)
        assert_int_equal(drain(who, false, 0), REQUESTS);
    assert_true(take(0, false, 0).is_refused); // 1 is the oldest now
    assert_int_equal(drain(8, false, 0), REQUESTS);
    assert_true(take(0, false, 0).is_refused);
    for (unsigned who = 2; who < 9; who++)
        assert_true(take(who, false, 0).is_refused);
    assert_false(take(1, false, 0).is_refused);
}

static void a_stream_of_new_clients_keeps_the_table_whole(void **state)
{
    for (unsigned who = 0; who < 100000; who++)
        assert_false(take(who * 2654435761U, who % 3 == 0, who).is_refused);
    assert_int_equal(drain(99999 * 2654435761U, false, 100000), REQUESTS - 1);
}

static void no_quota_is_no_limit(void **state)
{
    api_response response = { 0 };

    limit = http_limit_destroy(limit);
    limit = create(0, 0, 2);
    for (int i = 0; i < 10000; i++)
        assert_false(take(1, true, 0).is_refused);
    http_limit_verdict verdict = take(1, true, 0);
    http_limit_write_headers(&verdict, &response);
    assert_int_equal(response.n_headers, 0);
}

static void clients_are_told_policy_and_state(void **state)
{
    api_response response = { 0 };

    http_limit_verdict verdict = take(1, true, 0);
    http_limit_write_headers(&verdict, &response);
    assert_string_equal(api_response_find(&response, "RateLimit-Policy"),
                        "\"requests\";q=60;w=60, \"work\";q=6;w=60");
    assert_string_equal(api_response_find(&response, "RateLimit"),
                        "\"requests\";r=59;t=1, \"work\";r=5;t=10");
    assert_null(api_response_find(&response, "Retry-After"));
    (void)drain(1, true, 0);
    verdict = take(1, true, 0);
    http_limit_write_headers(&verdict, &response);
    assert_string_equal(api_response_find(&response, "Retry-After"), "10");
    verdict = take(1, false, 0);
    response = (api_response){ 0 };
    http_limit_write_headers(&verdict, &response);
    assert_string_equal(api_response_find(&response, "RateLimit-Policy"), "\"requests\";q=60;w=60");
}

static void *ask_often(void *context)
{
    unsigned *n_taken = context;

    for (unsigned i = 0; i < 1000; i++)
        *n_taken += !take(i % 2, false, 0).is_refused;
    return NULL;
}

static void threads_share_one_quota(void **state)
{
    pthread_t threads[4];
    unsigned n_taken[4] = { 0 };

    for (int i = 0; i < 4; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, ask_often, &n_taken[i]), 0);
    for (int i = 0; i < 4; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    assert_int_equal(n_taken[0] + n_taken[1] + n_taken[2] + n_taken[3], 2 * REQUESTS);
}

static void without_memory_there_is_no_table(void **state)
{
    const uint64_t quotas[HTTP_LIMIT_COUNT] = { 1, 1 };
    http_limit *none = NULL;

    for (size_t n = 1; n <= 3; n++) {
        memory_plan_fault(n, 0);
        assert_int_equal(http_limit_create(quotas, 4, &none, NULL), BF_ENOMEM);
        memory_plan_fault(0, 0);
        assert_null(none);
    }
    assert_null(http_limit_destroy(NULL));
}

static void other_quotas_count_at_once_and_the_same_ones_change_nothing(void **state)
{
    const uint64_t same[HTTP_LIMIT_COUNT] = { REQUESTS, WORK }, fewer[HTTP_LIMIT_COUNT] = { 5, 0 };

    assert_int_equal(drain(1, false, 0), REQUESTS);
    http_limit_change(limit, same);
    assert_int_equal(drain(1, false, 0), 0);
    http_limit_change(limit, fewer);
    assert_int_equal(drain(1, true, 0), 5);
    assert_int_equal(take(1, true, 0).quotas[HTTP_LIMIT_WORK], 0);
    for (unsigned who = 2; who < 20; who++)
        assert_int_equal(drain(who, false, 0), 5);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        CASE(other_quotas_count_at_once_and_the_same_ones_change_nothing),
        CASE(a_quota_can_be_used_at_once_and_comes_back_evenly),
        CASE(work_has_a_smaller_quota_and_counts_as_a_request_too),
        CASE(cpu_time_counts_like_requests),
        CASE(what_a_token_is_good_for_costs_nothing_and_pieces_add_up),
        CASE(a_debt_is_paid_within_a_minute),
        CASE(clients_do_not_disturb_each_other),
        CASE(the_table_forgets_who_has_not_come_for_longest),
        CASE(a_stream_of_new_clients_keeps_the_table_whole),
        CASE(no_quota_is_no_limit),
        CASE(clients_are_told_policy_and_state),
        CASE(threads_share_one_quota),
        CASE(without_memory_there_is_no_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
