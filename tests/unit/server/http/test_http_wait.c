// Answers that wait for a run: none sleeps too long, none holds a thread, all of them stop.

#include "server/http/http.h"

#include "server/base/clock.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define HOST  "Host: a\r\n"
#define CLOSE "Connection: close\r\n"
#define RUN   "/v1/runs/" FAKE_RUN
#define BODY                                                                                       \
    "{\"scenario\":{\"duration_s\":1,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},\"cargo\":{},"     \
    "\"initial\":{\"positions_m\":[[0.3,0.3]]}}}"

static unsigned count_finds(void)
{
    lock_acquire(&server_services.lock);
    unsigned n = server_services.n_finds;
    lock_release(&server_services.lock);
    return n;
}

// Sends a request that waits, on a new connection.
static int begin(const char *query, const char *headers)
{
    char request[512];
    int fd = client_connect(http_port(server));

    (void)snprintf(request, sizeof request, "GET " RUN "?%s HTTP/1.1\r\n" HOST "%s\r\n", query,
                   headers);
    assert_true(client_send(fd, request));
    return fd;
}

// Each request that waits looks twice before it sleeps: for its first answer, and once more.
static void wait_until_asleep(unsigned n_before, unsigned n_requests)
{
    HELPER_AWAIT(count_finds() - n_before >= 2 * n_requests);
}

// Begins n requests, a few at a time: the queue of the request threads is not long.
static void begin_many(int *fds, int n, const char *headers)
{
    enum { AT_ONCE = 50 };

    for (int i = 0; i < n; i += AT_ONCE) {
        unsigned n_before = count_finds();
        int k = i;
        for (; k < n && k < i + AT_ONCE; k++)
            fds[k] = begin("wait=60", headers);
        wait_until_asleep(n_before, (unsigned)(k - i));
    }
}

// Reads the answer and closes; its status.
static int end(int fd, bf_buffer *answer)
{
    bf_buffer rest = { 0 }, own = { 0 };
    bf_buffer *to = answer == NULL ? &own : answer;

    assert_true(client_read_response(fd, &rest, true, to));
    int status = client_status(to);
    assert_int_equal(close(fd), 0);
    buffer_fini(&rest);
    buffer_fini(&own);
    return status;
}

static bool is_silent(int fd)
{
    bf_buffer answer = { 0 };
    bool is_over = client_read_all(fd, &answer, 100);

    bool has_nothing = !is_over && answer.n == 0;
    buffer_fini(&answer);
    return has_nothing;
}

static void who_has_no_state_is_answered_at_the_end(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = begin("wait=60", "");
    wait_until_asleep(0, 1);
    server_append(false);
    assert_true(is_silent(fd));
    server_append(true);
    assert_int_equal(end(fd, &answer), 200);
    server_assert_holds(&answer, "\"status\":\"succeeded\"");
    server_assert_holds(&answer, "\r\nETag: \"r2\"\r\n");
    buffer_fini(&answer);
}

static void who_has_a_state_is_answered_at_the_next_one(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = begin("wait=60", "If-None-Match: \"r0\"\r\n");
    assert_true(is_silent(fd));
    http_notify(server, "ffffffff-89ab-7cde-8f01-23456789abcd");
    http_notify(server, FAKE_RUN); // nothing has changed
    assert_true(is_silent(fd));
    server_append(false);
    assert_int_equal(end(fd, &answer), 200);
    server_assert_holds(&answer, "\r\nETag: \"r1\"\r\n");
    buffer_fini(&answer);
}

static void who_has_waited_long_enough_gets_what_there_is(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int64_t start_ms = clock_monotonic_ms();
    int fd = begin("wait=1", "");
    int other = begin("wait=1", "If-None-Match: \"r0\"\r\n");
    assert_int_equal(end(fd, &answer), 200);
    server_assert_holds(&answer, "\"status\":\"running\"");
    assert_int_equal(end(other, &answer), 304);
    assert_true(clock_monotonic_ms() - start_ms >= 1000);
    buffer_fini(&answer);
}

static void a_connection_that_waited_serves_on(void **state)
{
    bf_buffer rest = { 0 }, answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = client_connect(http_port(server));
    for (int i = 0; i < 20; i++) {
        char request[256];
        unsigned n_finds = count_finds();
        (void)snprintf(request, sizeof request,
                       "GET " RUN "?wait=60 HTTP/1.1\r\n" HOST "If-None-Match: \"r%d\"\r\n\r\n", i);
        assert_true(client_send(fd, request));
        wait_until_asleep(n_finds, 1);
        server_append(false);
        assert_true(client_read_response(fd, &rest, true, &answer));
        assert_int_equal(client_status(&answer), 200);
    }
    assert_int_equal(close(fd), 0);
    buffer_fini(&rest);
    buffer_fini(&answer);
}

// Called by find() when it has its answer: the run ends between the last look and the sleep.
static void end_after_the_second_look(void)
{
    if (count_finds() == 2)
        server_append(true);
}

static void an_end_between_the_last_look_and_the_sleep_is_not_missed(void **state)
{
    server = fake_serve(&server_services, NULL);
    lock_acquire(&server_services.lock);
    server_services.after_look = end_after_the_second_look;
    lock_release(&server_services.lock);
    int64_t start_ms = clock_monotonic_ms();
    assert_int_equal(end(begin("wait=60", ""), NULL), 200);
    assert_true(clock_monotonic_ms() - start_ms < 50000); // it would have slept for a minute
}

// A run that commits all the time is looked at now and then only.
static void looks_at_a_busy_run_are_paced(void **state)
{
    server = fake_serve(&server_services, NULL);
    int fd = begin("wait=60", "");
    wait_until_asleep(0, 1);
    int64_t start_ms = clock_monotonic_ms();
    unsigned n_before = count_finds();
    for (int i = 0; i < 400; i++) {
        server_append(false);
        (void)usleep(500);
    }
    int64_t passed_ms = clock_monotonic_ms() - start_ms;
    assert_in_range(count_finds() - n_before, 2, (uintmax_t)passed_ms / 20 + 2);
    server_append(true);
    assert_int_equal(end(fd, NULL), 200);
}

enum { N_WAITS = 1000 };

static void a_thousand_waits(http_options *options)
{
    options->connection_limit = N_WAITS + 200;
    options->wait_limit = N_WAITS;
}

static void a_thousand_wait_without_a_thread_and_no_more(void **state)
{
    static int fds[N_WAITS];
    bf_buffer answer = { 0 };
    struct rlimit files;

    assert_int_equal(getrlimit(RLIMIT_NOFILE, &files), 0);
    files.rlim_cur = files.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &files), 0);
    server = fake_serve(&server_services, a_thousand_waits);
    begin_many(fds, N_WAITS, "");
    assert_int_equal(
        client_ask(http_port(server), "GET /readyz HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL), 200);
    assert_int_equal(client_ask(http_port(server),
                                "GET " RUN "?wait=60 HTTP/1.1\r\n" HOST CLOSE "\r\n", &answer),
                     503);
    server_assert_holds(&answer, "\r\nRetry-After: ");
    server_append(true);
    for (int i = 0; i < N_WAITS; i++)
        assert_int_equal(end(fds[i], NULL), 200);
    buffer_fini(&answer);
}

static void one_wait(http_options *options)
{
    options->wait_limit = 1;
}

// A submission is accepted whether or not it can wait for its run.
static void a_submission_waits_if_there_is_room(void **state)
{
    static const char format[] = "POST /v1/runs HTTP/1.1\r\n" HOST CLOSE
                                 "Content-Type: application/json\r\nPrefer: wait=60\r\n"
                                 "Content-Length: %zu\r\n\r\n" BODY;
    bf_buffer answer = { 0 };
    char request[1024];

    (void)snprintf(request, sizeof request, format, strlen(BODY));
    server = fake_serve(&server_services, one_wait);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, request));
    assert_true(is_silent(fd));
    assert_int_equal(client_ask(http_port(server), request, &answer), 201);
    assert_null(strstr(answer.bytes, "Preference-Applied"));
    server_assert_holds(&answer, "\"status\":\"running\"");
    server_append(true);
    assert_int_equal(end(fd, &answer), 201);
    server_assert_holds(&answer, "\r\nPreference-Applied: wait=60\r\n");
    server_assert_holds(&answer, "\r\nLocation: " RUN "\r\n");
    server_assert_holds(&answer, "\"status\":\"succeeded\"");
    buffer_fini(&answer);
}

// A client that left makes room for another although nothing happens to the run.
static void a_client_that_leaves_is_forgotten(void **state)
{
    server = fake_serve(&server_services, one_wait);
    for (int i = 0; i < 3; i++) {
        int64_t start_ms = clock_monotonic_ms();
        int fd = begin("wait=60", "");
        while (!is_silent(fd)) {
            assert_true(clock_monotonic_ms() - start_ms < HELPER_PATIENCE_MS);
            assert_int_equal(close(fd), 0);
            fd = begin("wait=60", "");
        }
        assert_int_equal(close(fd), 0);
    }
}

static void those_that_wait_are_answered_when_the_server_stops(void **state)
{
    enum { N = 100 };
    int fds[N], others[N];

    server = fake_serve(&server_services, NULL);
    begin_many(fds, N, "");
    begin_many(others, N, "If-None-Match: \"r0\"\r\n");
    int64_t start_ms = clock_monotonic_ms();
    server = http_stop(server);
    assert_true(clock_monotonic_ms() - start_ms < 50000); // not at the end of their wait
    for (int i = 0; i < N; i++) {
        assert_int_equal(end(fds[i], NULL), 200);
        assert_int_equal(end(others[i], NULL), 304);
    }
}

// Clients come and leave while the run changes and the server stops.
static void what_comes_leaves_and_stops_at_once_does_no_harm(void **state)
{
    enum { N = 30, ROUNDS = 8 };

    for (int round = 0; round < ROUNDS; round++) {
        server_writer writer;
        int fds[N];
        server = fake_serve(&server_services, NULL);
        server_writer_start(&writer);
        for (int i = 0; i < N; i++)
            fds[i] = begin("wait=60", i % 3 == 0 ? "If-None-Match: \"r0\"\r\n" : "");
        for (int i = 0; i < N; i += 2)
            assert_int_equal(close(fds[i]), 0);
        (void)usleep(20000U * (unsigned)round);
        server_writer_end(&writer);
        server = http_stop(server);
        for (int i = 1; i < N; i += 2)
            assert_int_equal(close(fds[i]), 0);
    }
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)
    const struct CMUnitTest tests[] = {
        CASE(who_has_no_state_is_answered_at_the_end),
        CASE(who_has_a_state_is_answered_at_the_next_one),
        CASE(who_has_waited_long_enough_gets_what_there_is),
        CASE(a_connection_that_waited_serves_on),
        CASE(an_end_between_the_last_look_and_the_sleep_is_not_missed),
        CASE(looks_at_a_busy_run_are_paced),
        CASE(a_thousand_wait_without_a_thread_and_no_more),
        CASE(a_submission_waits_if_there_is_room),
        CASE(a_client_that_leaves_is_forgotten),
        CASE(those_that_wait_are_answered_when_the_server_stops),
        CASE(what_comes_leaves_and_stops_at_once_does_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
