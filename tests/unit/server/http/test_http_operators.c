// Tests of what operators need of the HTTP transport: metrics, signs of life, changes of settings.

#include "server/http/http.h"

#include "server/base/metrics.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define HOST  "Host: a\r\n"
#define CLOSE "Connection: close\r\n"

static int ask(const char *path, bf_buffer *answer)
{
    char request[256];

    (void)snprintf(request, sizeof request, "GET %s HTTP/1.1\r\n" HOST CLOSE "\r\n", path);
    return client_ask(http_port(server), request, answer);
}

static void metrics_are_text_of_prometheus_version(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    assert_int_equal(ask("/metrics", &answer), 200);
    server_assert_holds(&answer, "\r\nContent-Type: text/plain; version=0.0.4; charset=utf-8\r\n");
    server_assert_holds(&answer, "\n# TYPE beltflow_http_connections gauge\n");
    buffer_fini(&answer);
}

static void requests_are_counted_by_their_templates(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    assert_int_equal(ask("/v1/runs/" FAKE_RUN, NULL), 200);
    assert_int_equal(ask("/v1/nothing", NULL), 404);
    assert_int_equal(
        client_ask(http_port(server), "BREW /livez HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL), 405);
    // The client can have its answer before the count is made.
    HELPER_AWAIT(metrics_value(METRICS_REQUESTS_NOW, 0) == 0);
    assert_int_equal(ask("/metrics", &answer), 200);
    server_assert_holds(&answer, "{route=\"/v1/runs/{id}\",method=\"GET\",code=\"200\"} 1\n");
    server_assert_holds(&answer, "{route=\"none\",method=\"GET\",code=\"404\"} 1\n");
    server_assert_holds(&answer, "{route=\"none\",method=\"other\",code=\"405\"} 1\n");
    assert_null(strstr(answer.bytes, FAKE_RUN));
    buffer_fini(&answer);
}

static void sixteen_connections(http_options *options)
{
    options->connection_limit = 16;
    options->n_threads = 1;
}

// Idle connections that the server has accepted.
static void connect_crowd(int *fds, int n)
{
    for (int i = 0; i < n; i++)
        fds[i] = client_connect(http_port(server));
    HELPER_AWAIT(metrics_value(METRICS_CONNECTIONS, 0) == n);
}

// By event streams, which are not idle.
static void metrics_are_answered_when_all_connections_but_the_reserve_are_taken(void **state)
{
    enum { N = 14 };
    bf_buffer answer = { 0 };
    int fds[N];

    server = fake_serve(&server_services, sixteen_connections);
    for (int i = 0; i < N; i++) {
        bf_buffer head = { 0 };
        fds[i] = client_connect(http_port(server));
        assert_true(
            client_send(fds[i], "GET /v1/runs/" FAKE_RUN "/events HTTP/1.1\r\n" HOST "\r\n"));
        assert_true(client_read_until(fds[i], &head, "HTTP/1.1 200", HELPER_PATIENCE_MS));
        buffer_fini(&head);
    }
    assert_int_equal(ask("/metrics", &answer), 200);
    server_assert_holds(&answer, "\nbeltflow_http_connections 15\n");
    assert_int_equal(ask("/version", NULL), 503);
    for (int i = 0; i < N; i++)
        assert_int_equal(close(fds[i]), 0);
    buffer_fini(&answer);
}

static void three_threads(http_options *options)
{
    options->n_threads = 3;
    options->n_request_threads = 1;
}

// The time in between is for the threads that do not hang: they answer, and the one that hangs does not.
static void assert_no_sign_of_life(void)
{
    for (int i = 0; i < 2; i++) {
        assert_int_equal(usleep(300000), 0);
        assert_false(http_is_alive(server));
    }
}

static void a_server_that_works_gives_signs_of_life(void **state)
{
    server = fake_serve(&server_services, three_threads);
    assert_true(http_is_alive(server)); // was never asked before
    for (int i = 0; i < 5; i++)
        server_await_sign_of_life();
}

// A thread that is stopped with the connection of a probe still in its queue races with http_is_alive().
static void a_server_stops_after_its_last_probes_are_answered(void **state)
{
    for (int i = 0; i < 50; i++) {
        server = fake_serve(&server_services, three_threads);
        assert_true(http_is_alive(server)); // was never asked before
        server = http_stop(server);
    }
}

static void request_threads_that_all_hang_give_none(void **state)
{
    server = fake_serve(&server_services, three_threads);
    fake_hold(&server_services, FAKE_HELD_LIST);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, "GET /v1/runs HTTP/1.1\r\n" HOST "\r\n"));
    assert_true(fake_wait_for_held(&server_services, 1));
    assert_true(http_is_alive(server)); // was never asked before
    assert_no_sign_of_life();
    fake_hold(&server_services, FAKE_HELD_NONE);
    server_await_sign_of_life();
    assert_int_equal(close(fd), 0);
}

static api_services hanging;
static bool (*fake_holds)(api_service *service, const char *id);

// A thread that serves connections is made to hang by what it does itself, which must not, but does.
static bool hang_in_holds(api_service *service, const char *id)
{
    fake_hold(&server_services, FAKE_HELD_READY);
    (void)hanging.ready(service, NULL);
    return fake_holds(service, id);
}

static void hanging_connections(http_options *options)
{
    hanging = *options->services;
    fake_holds = hanging.holds;
    hanging.holds = hang_in_holds;
    options->services = &hanging;
    options->n_threads = 2;
}

static bf_status hang_in_metrics(api_service *service, bool with_owners, bf_buffer *out,
                                 bf_error *err)
{
    fake_hold(&server_services, FAKE_HELD_READY);
    return hanging.ready(service, err);
}

static void hanging_metrics(http_options *options)
{
    hanging = *options->services;
    hanging.metrics = hang_in_metrics;
    options->services = &hanging;
    options->n_threads = 1;
}

// Many figures take a while to be written, in which the only thread that serves connections answers others.
static void figures_do_not_hold_up_signs_of_life(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, hanging_metrics);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, "GET /metrics HTTP/1.1\r\n" HOST "\r\n"));
    assert_true(fake_wait_for_held(&server_services, 1));
    assert_int_equal(ask("/livez", &answer), 200);
    fake_hold(&server_services, FAKE_HELD_NONE);
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

static void one_thread_of_several_that_hangs_is_found(void **state)
{
    server = fake_serve(&server_services, hanging_connections);
    assert_true(http_is_alive(server)); // was never asked before
    server_await_sign_of_life();
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, "GET /v1/runs/" FAKE_RUN " HTTP/1.1\r\n" HOST "\r\n"));
    assert_true(fake_wait_for_held(&server_services, 1));
    (void)http_is_alive(server); // was asked before the trouble began
    assert_no_sign_of_life();
    fake_hold(&server_services, FAKE_HELD_NONE);
    server_await_sign_of_life();
    assert_int_equal(close(fd), 0);
}

static void while_all_connections_are_taken_nobody_is_thought_dead(void **state)
{
    enum { N = 16 };
    int fds[N];

    server = fake_serve(&server_services, sixteen_connections);
    connect_crowd(fds, N);
    for (int i = 0; i < 3; i++)
        server_await_sign_of_life();
    for (int i = 0; i < N; i++)
        assert_int_equal(close(fds[i]), 0);
}

static void limits_can_change_while_it_serves(void **state)
{
    static const char post[] = "POST /v1/validate HTTP/1.1\r\n" HOST CLOSE
                               "Content-Type: application/json\r\nContent-Length: 50\r\n\r\n"
                               "{,}                                               ";
    http_options options = { .stream_limit = 1,
                             .body_limit = 10,
                             .header_deadline_ms = 5000,
                             .body_deadline_ms = 5000,
                             .heartbeat_ms = 15000 };

    server = fake_serve(&server_services, NULL);
    assert_int_equal(client_ask(http_port(server), post, NULL), 400);
    assert_int_equal(http_reconfigure(server, &options, NULL), BF_OK);
    assert_int_equal(client_ask(http_port(server), post, NULL), 413);
    options.body_limit = 50;
    assert_int_equal(http_reconfigure(server, &options, NULL), BF_OK);
    assert_int_equal(client_ask(http_port(server), post, NULL), 400);
}

static void write_page(const char *folder, const char *text)
{
    char path[128];

    assert_int_equal(mkdir(folder, 0700), 0);
    (void)snprintf(path, sizeof path, "%s/index.html", folder);
    FILE *file = fopen(path, "we");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void the_page_can_be_exchanged_while_it_serves(void **state)
{
    char root[] = "/tmp/test_operators_XXXXXX", first[64], second[64], command[128];
    http_options options = { .body_limit = 10, .header_deadline_ms = 5000, .stream_limit = 1 };
    bf_buffer answer = { 0 };
    bf_error err = { 0 };

    assert_non_null(mkdtemp(root));
    (void)snprintf(first, sizeof first, "%s/first", root);
    (void)snprintf(second, sizeof second, "%s/second", root);
    write_page(first, "the first");
    write_page(second, "the second");
    server = fake_serve(&server_services, NULL);
    assert_int_equal(ask("/", &answer), 200);
    server_assert_holds(&answer, "To have the page");
    const char *folders[] = { first, second, first };
    for (int i = 0; i < 3; i++) {
        options.web_directory = folders[i];
        assert_int_equal(http_reconfigure(server, &options, NULL), BF_OK);
        assert_int_equal(ask("/", &answer), 200);
        server_assert_holds(&answer, i == 1 ? "the second" : "the first");
    }
    options.web_directory = "/nowhere";
    assert_int_equal(http_reconfigure(server, &options, &err), BF_ESYSTEM);
    assert_non_null(strstr(err.text, "/nowhere"));
    assert_int_equal(ask("/", &answer), 200);
    server_assert_holds(&answer, "the first");
    (void)snprintf(command, sizeof command, "rm -r %s", root);
    assert_int_equal(system(command), 0);
    buffer_fini(&answer);
}

static void an_address_is_checked_before_it_is_used(void **state)
{
    static const char *const bad[] = { "", "nowhere", "a:b", "1.2.3.4", "::1:80", "a:99999" };
    static const char *const good[] = { "127.0.0.1:0", "[::1]:8080", "localhost:80" };

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(http_check_address(bad[i], NULL), BF_EINPUT);
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        assert_int_equal(http_check_address(good[i], NULL), BF_OK);
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(metrics_are_text_of_prometheus_version),
        CASE(requests_are_counted_by_their_templates),
        CASE(metrics_are_answered_when_all_connections_but_the_reserve_are_taken),
        CASE(a_server_that_works_gives_signs_of_life),
        CASE(a_server_stops_after_its_last_probes_are_answered),
        CASE(request_threads_that_all_hang_give_none),
        CASE(figures_do_not_hold_up_signs_of_life),
        CASE(one_thread_of_several_that_hangs_is_found),
        CASE(while_all_connections_are_taken_nobody_is_thought_dead),
        CASE(limits_can_change_while_it_serves),
        CASE(the_page_can_be_exchanged_while_it_serves),
        CASE(an_address_is_checked_before_it_is_used),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
