// Tests of the HTTP transport by a real server on a free port, with services that are made up and
// requests that are written byte by byte.

#include "server/http/http.h"

#include "core/base/memory.h"
#include "server/base/metrics.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define HOST  "Host: a\r\n"
#define CLOSE "Connection: close\r\n"

static void an_answer_carries_the_standard_headers(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    assert_int_equal(
        client_ask(http_port(server), "GET /livez HTTP/1.1\r\n" HOST CLOSE "\r\n", &answer), 200);
    server_assert_holds(&answer, "\r\nX-Content-Type-Options: nosniff\r\n");
    server_assert_holds(&answer, "\r\nCache-Control: no-store\r\n");
    server_assert_holds(&answer, "\r\nCross-Origin-Resource-Policy: same-origin\r\n");
    assert_int_equal(
        client_ask(http_port(server), "GET /nothing HTTP/1.1\r\n" HOST CLOSE "\r\n", &answer), 404);
    server_assert_holds(&answer, "\r\nContent-Type: application/problem+json\r\n");
    server_assert_holds(&answer, "\r\nX-Content-Type-Options: nosniff\r\n");
    buffer_fini(&answer);
}

// RFC 9110, 8.6: the length of a 304 is that of the 200.
static void a_304_leaves_the_connection_open(void **state)
{
#define SCENARIO "GET /v1/runs/" FAKE_RUN "/scenario HTTP/1.1\r\n" HOST
    bf_buffer rest = { 0 }, answer = { 0 };
    char again[512];

    server = fake_serve(&server_services, NULL);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, SCENARIO "\r\n"));
    assert_true(client_read_response(fd, &rest, true, &answer));
    server_assert_holds(&answer, "\r\nContent-Length: 2\r\n");
    (void)snprintf(again, sizeof again, SCENARIO "If-None-Match: \"%s-scenario\"\r\n\r\n",
                   FAKE_RUN);
    for (int i = 0; i < 2; i++) {
        assert_true(client_send(fd, again));
        assert_true(client_read_response(fd, &rest, true, &answer));
        assert_int_equal(client_status(&answer), 304);
        server_assert_holds(&answer, "\r\nContent-Length: 2\r\n");
        assert_null(strstr(answer.bytes, "\r\nConnection: close\r\n"));
    }
    assert_int_equal(close(fd), 0);
    buffer_fini(&rest);
    buffer_fini(&answer);
#undef SCENARIO
}

static void head_is_answered_without_a_body(void **state)
{
    bf_buffer get = { 0 }, head = { 0 };

    server = fake_serve(&server_services, NULL);
    assert_int_equal(
        client_ask(http_port(server), "GET /livez HTTP/1.1\r\n" HOST CLOSE "\r\n", &get), 200);
    assert_int_equal(
        client_ask(http_port(server), "HEAD /livez HTTP/1.1\r\n" HOST CLOSE "\r\n", &head), 200);
    assert_memory_equal(head.bytes + head.n - 4, "\r\n\r\n", 4);
    const char *length = strstr(get.bytes, "Content-Length:");
    assert_non_null(length);
    char line[64] = { 0 };
    memcpy(line, length, strcspn(length, "\r"));
    server_assert_holds(&head, line);
    buffer_fini(&get);
    buffer_fini(&head);
}

static void a_connection_serves_one_request_after_the_other(void **state)
{
    bf_buffer rest = { 0 }, answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = client_connect(http_port(server));
    for (int i = 0; i < 50; i++) {
        bool is_head = i % 5 == 4;
        const char *request = is_head      ? "HEAD /livez HTTP/1.1\r\n" HOST "\r\n"
                              : i % 2 == 0 ? "GET /livez HTTP/1.1\r\n" HOST "\r\n"
                                           : "GET /v1/runs HTTP/1.1\r\n" HOST "\r\n";
        assert_true(client_send(fd, request));
        assert_true(client_read_response(fd, &rest, !is_head, &answer));
        assert_int_equal(client_status(&answer), 200);
    }
    assert_int_equal(rest.n, 0);
    assert_int_equal(close(fd), 0);
    buffer_fini(&rest);
    buffer_fini(&answer);
}

static void requests_sent_at_once_are_answered_in_order(void **state)
{
    static const char requests[] =
        "GET /livez HTTP/1.1\r\n" HOST "\r\n"
        "GET /v1/runs HTTP/1.1\r\n" HOST "\r\n"
        "GET /nothing HTTP/1.1\r\n" HOST "\r\n"
        "POST /v1/validate HTTP/1.1\r\n" HOST
        "Content-Type: application/json\r\nContent-Length: 3\r\n\r\n{,}"
        "POST /livez HTTP/1.1\r\n" HOST "Transfer-Encoding: chunked\r\n\r\n2\r\nab\r\n0\r\n\r\n"
        "GET /livez HTTP/1.1\r\n" HOST CLOSE "\r\n";
    static const int statuses[] = { 200, 200, 404, 400, 405, 200 };
    bf_buffer rest = { 0 }, answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, requests));
    for (size_t i = 0; i < sizeof statuses / sizeof *statuses; i++) {
        assert_true(client_read_response(fd, &rest, true, &answer));
        assert_int_equal(client_status(&answer), statuses[i]);
    }
    assert_true(client_read_all(fd, &rest, HELPER_PATIENCE_MS));
    assert_int_equal(rest.n, 0);
    assert_int_equal(close(fd), 0);
    buffer_fini(&rest);
    buffer_fini(&answer);
}

static void one_request_thread(http_options *options)
{
    options->n_request_threads = 1;
}

// One thread handles, sixteen requests wait, the rest get 503 with Retry-After.
static void what_the_queue_of_requests_cannot_take_is_refused(void **state)
{
    enum { N = 30, TAKEN = 17 };
    int fds[N], n_refused = 0, n_answered = 0;

    server = fake_serve(&server_services, one_request_thread);
    fake_hold(&server_services, FAKE_HELD_LIST);
    for (int i = 0; i < N; i++) {
        fds[i] = client_connect(http_port(server));
        assert_true(client_send(fds[i], "GET /v1/runs HTTP/1.1\r\n" HOST CLOSE "\r\n"));
        lock_acquire(&server_services.lock);
        bool has_begun = server_services.n_waiting > 0;
        lock_release(&server_services.lock);
        for (int k = 0; i == 0 && !has_begun && k < 500; k++) {
            assert_int_equal(usleep(10000), 0);
            lock_acquire(&server_services.lock);
            has_begun = server_services.n_waiting > 0;
            lock_release(&server_services.lock);
        }
        assert_true(has_begun);
    }
    for (int i = 0; i < N; i++) {
        bf_buffer answer = { 0 };
        if (client_read_all(fds[i], &answer, i == 0 ? 500 : 0)) {
            assert_int_equal(client_status(&answer), 503);
            server_assert_holds(&answer, "\r\nRetry-After: ");
            assert_int_equal(close(fds[i]), 0);
            fds[i] = -1;
            n_refused++;
        }
        buffer_fini(&answer);
    }
    fake_hold(&server_services, FAKE_HELD_NONE);
    for (int i = 0; i < N; i++) {
        bf_buffer answer = { 0 };
        if (fds[i] < 0)
            continue;
        assert_true(client_read_all(fds[i], &answer, HELPER_PATIENCE_MS));
        assert_int_equal(client_status(&answer), 200);
        assert_int_equal(close(fds[i]), 0);
        buffer_fini(&answer);
        n_answered++;
    }
    assert_int_equal(n_answered, TAKEN);
    assert_int_equal(n_refused, N - TAKEN);
}

// Whether runs can be accepted is asked of a service whose request threads are all taken for long.
static void readiness_does_not_wait_behind_long_requests(void **state)
{
    enum { N_REQUEST_THREADS = 4, N = 3 * N_REQUEST_THREADS };
    int fds[N];

    server = fake_serve(&server_services, NULL);
    fake_hold(&server_services, FAKE_HELD_LIST);
    for (int i = 0; i < N; i++) {
        fds[i] = client_connect(http_port(server));
        assert_true(client_send(fds[i], "GET /v1/runs HTTP/1.1\r\n" HOST CLOSE "\r\n"));
    }
    assert_true(fake_wait_for_held(&server_services, N_REQUEST_THREADS));
    assert_int_equal(
        client_ask(http_port(server), "GET /readyz HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL), 200);
    assert_int_equal(
        client_ask(http_port(server), "GET /version HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL), 200);
    fake_hold(&server_services, FAKE_HELD_NONE);
    for (int i = 0; i < N; i++)
        assert_int_equal(close(fds[i]), 0);
}

static void *release_later(void *context)
{
    (void)usleep(200000);
    fake_hold(context, FAKE_HELD_NONE);
    return NULL;
}

// One thread reads, one handles.
static void one_thread_each(http_options *options)
{
    options->n_threads = 1;
    options->n_request_threads = 1;
}

static void requests_under_way_are_answered_when_the_server_stops(void **state)
{
    enum { N = 8 };
    const int64_t n_before = metrics_value(METRICS_REQUESTS_NOW, 0);
    pthread_t releaser;
    int fds[N];

    server = fake_serve(&server_services, one_thread_each);
    fake_hold(&server_services, FAKE_HELD_LIST);
    for (int i = 0; i < N; i++) {
        fds[i] = client_connect(http_port(server));
        assert_true(client_send(fds[i], "GET /v1/runs HTTP/1.1\r\n" HOST "\r\n"));
    }
    HELPER_AWAIT(metrics_value(METRICS_REQUESTS_NOW, 0) == n_before + N);
    // The thread that has counted the last request puts it into the queue before it answers this one: it is the only one that reads.
    assert_int_equal(
        client_ask(http_port(server), "GET /livez HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL), 200);
    assert_int_equal(pthread_create(&releaser, NULL, release_later, &server_services), 0);
    server = http_stop(server);
    assert_int_equal(pthread_join(releaser, NULL), 0);
    for (int i = 0; i < N; i++) {
        bf_buffer answer = { 0 };
        assert_true(client_read_all(fds[i], &answer, HELPER_PATIENCE_MS));
        assert_int_equal(client_status(&answer), 200);
        assert_int_equal(close(fds[i]), 0);
        buffer_fini(&answer);
    }
}

static void sixteen_connections(http_options *options)
{
    options->connection_limit = 16;
    options->n_threads = 1;
}

// Of 16 connections 2 are for health only.
static void the_last_connections_are_for_the_health_of_the_daemon(void **state)
{
    int fds[14];

    server = fake_serve(&server_services, sixteen_connections);
    for (int i = 0; i < 14; i++)
        fds[i] = client_connect(http_port(server));
    assert_int_equal(
        client_ask(http_port(server), "GET /version HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL), 503);
    assert_int_equal(
        client_ask(http_port(server), "GET /livez HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL), 200);
    for (int i = 0; i < 14; i++)
        assert_int_equal(close(fds[i]), 0);
}

static void three_per_address(http_options *options)
{
    options->per_address_limit = 3;
    options->n_threads = 1;
    options->listen = "0.0.0.0:0";
    options->plaintext = "open";
}

// An address of this machine by which a client is none of its own. False: there is none.
static bool find_outside(struct in_addr *ret_address)
{
    struct ifaddrs *all = NULL;
    bool is_found = false;

    assert_int_equal(getifaddrs(&all), 0);
    for (const struct ifaddrs *one = all; one != NULL && !is_found; one = one->ifa_next) {
        if (one->ifa_addr == NULL || one->ifa_addr->sa_family != AF_INET)
            continue;
        *ret_address = ((const struct sockaddr_in *)(const void *)one->ifa_addr)->sin_addr;
        is_found = ntohl(ret_address->s_addr) >> 24 != IN_LOOPBACKNET;
    }
    freeifaddrs(all);
    return is_found;
}

static void one_client_gets_no_more_than_its_share(void **state)
{
    bf_buffer answer = { 0 };
    struct in_addr outside = { 0 };
    int fds[4];

    if (!find_outside(&outside))
        skip();
    server = fake_serve(&server_services, three_per_address);
    for (int i = 0; i < 4; i++)
        fds[i] = client_connect_to(outside, http_port(server));
    (void)client_send(fds[3], "GET /livez HTTP/1.1\r\n" HOST "\r\n");
    assert_true(client_read_all(fds[3], &answer, HELPER_PATIENCE_MS));
    assert_int_equal(answer.n, 0);
    assert_true(client_send(fds[2], "GET /livez HTTP/1.1\r\n" HOST CLOSE "\r\n"));
    assert_true(client_read_all(fds[2], &answer, HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), 200);
    for (int i = 0; i < 4; i++)
        assert_int_equal(close(fds[i]), 0);
    buffer_fini(&answer);
}

static void connections_of_this_machine_are_not_limited(void **state)
{
    int fds[4];

    server = fake_serve(&server_services, three_per_address);
    for (int i = 0; i < 4; i++)
        fds[i] = client_connect(http_port(server));
    for (int i = 0; i < 4; i++) {
        bf_buffer answer = { 0 };
        assert_true(client_send(fds[i], "GET /livez HTTP/1.1\r\n" HOST CLOSE "\r\n"));
        assert_true(client_read_all(fds[i], &answer, HELPER_PATIENCE_MS));
        assert_int_equal(client_status(&answer), 200);
        assert_int_equal(close(fds[i]), 0);
        buffer_fini(&answer);
    }
}

static void a_taken_port_is_named(void **state)
{
    const api_services table = fake_services(&server_services);
    char address[32], expected[128];
    http *second = NULL;
    bf_error err = { 0 };

    server = fake_serve(&server_services, NULL);
    (void)snprintf(address, sizeof address, "127.0.0.1:%u", http_port(server));
    (void)snprintf(expected, sizeof expected, "port %u of 127.0.0.1 is taken by another program",
                   http_port(server));
    const http_options options = { .listen = address,
                                   .services = &table,
                                   .n_threads = 1,
                                   .n_request_threads = 1,
                                   .connection_limit = 10 };
    assert_int_equal(http_start(&options, &second, &err), BF_ESYSTEM);
    assert_string_equal(err.text, expected);
    assert_null(second);
}

static void what_is_no_address_is_refused(void **state)
{
    static const char *const cases[] = { "",           "8080",        ":8080",     "127.0.0.1",
                                         "127.0.0.1:", "127.0.0.1:x", "::1:8080",  "[]:1",
                                         "a:65536",    "a:-1",        "a:8080:1 ", "a:999999" };
    const api_services table = fake_services(&server_services);

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const http_options options = { .listen = cases[i],
                                       .services = &table,
                                       .n_threads = 1,
                                       .n_request_threads = 1,
                                       .connection_limit = 10 };
        bf_error err = { 0 };
        http *h = NULL;
        assert_int_equal(http_start(&options, &h, &err), BF_EINPUT);
        assert_null(h);
    }
}

static void a_server_without_memory_does_not_start(void **state)
{
    const api_services table = fake_services(&server_services);
    const http_options options = { .listen = "127.0.0.1:0",
                                   .services = &table,
                                   .n_threads = 1,
                                   .n_request_threads = 2,
                                   .connection_limit = 10 };
    bf_status status = BF_ENOMEM;

    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = http_start(&options, &server, NULL);
        bool has_struck = memory_faults() > 0;
        memory_plan_fault(0, 0);
        assert_int_equal(status, has_struck ? BF_ENOMEM : BF_OK);
        assert_int_equal(server == NULL, has_struck);
    }
}

static void a_server_that_was_never_asked_stops(void **state)
{
    assert_null(http_stop(NULL));
    for (int i = 0; i < 10; i++) {
        server = fake_serve(&server_services, NULL);
        server = http_stop(server);
    }
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)
    const struct CMUnitTest tests[] = {
        CASE(an_answer_carries_the_standard_headers),
        CASE(a_304_leaves_the_connection_open),
        CASE(head_is_answered_without_a_body),
        CASE(a_connection_serves_one_request_after_the_other),
        CASE(requests_sent_at_once_are_answered_in_order),
        CASE(what_the_queue_of_requests_cannot_take_is_refused),
        CASE(readiness_does_not_wait_behind_long_requests),
        CASE(requests_under_way_are_answered_when_the_server_stops),
        CASE(the_last_connections_are_for_the_health_of_the_daemon),
        CASE(one_client_gets_no_more_than_its_share),
        CASE(connections_of_this_machine_are_not_limited),
        CASE(a_taken_port_is_named),
        CASE(what_is_no_address_is_refused),
        CASE(a_server_without_memory_does_not_start),
        CASE(a_server_that_was_never_asked_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
