// Tests that scenarios which are checked do not keep other requests, the watchdog and the stop waiting.

#include "server/http/http_priv.h"

#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { N_SUBMISSIONS = 3 };

static void one_request_thread(http_options *options)
{
    options->n_request_threads = 1;
}

static int submit(void)
{
    static const char body[] =
        "{\"scenario\":{\"duration_s\":1,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.5]},\"cargo\":{},"
        "\"initial\":{\"positions_m\":[[0.2,0.2]]}}}";
    char request[512];
    int fd = client_connect(http_port(server));

    (void)snprintf(request, sizeof request,
                   "POST /v1/runs HTTP/1.1\r\nHost: a\r\nConnection: close\r\n"
                   "Content-Type: application/json\r\nContent-Length: %zu\r\n\r\n%s",
                   strlen(body), body);
    assert_true(client_send(fd, request));
    return fd;
}

// The thread that may check scenarios is busy, and others wait for it.
static void keep_busy(int fds[N_SUBMISSIONS])
{
    server = fake_serve(&server_services, one_request_thread);
    fake_hold(&server_services, FAKE_HELD_SUBMIT);
    for (int i = 0; i < N_SUBMISSIONS; i++)
        fds[i] = submit();
    assert_true(fake_wait_for_held(&server_services, 1));
}

static void assert_answered(int fd, int status)
{
    bf_buffer answer = { 0 };

    assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), status);
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

static void assert_runs_are_listed(void)
{
    assert_int_equal(client_ask(http_port(server),
                                "GET /v1/runs HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n",
                                NULL),
                     200);
}

static void other_requests_are_answered_while_scenarios_are_checked(void **state)
{
    int fds[N_SUBMISSIONS];

    keep_busy(fds);
    assert_runs_are_listed();
    fake_hold(&server_services, FAKE_HELD_NONE);
    for (int i = 0; i < N_SUBMISSIONS; i++)
        assert_answered(fds[i], 201);
}

static void *stop(void *unused)
{
    server = http_stop(server);
    return NULL;
}

static void scenarios_that_wait_are_refused_when_the_server_stops(void **state)
{
    bf_buffer answers[N_SUBMISSIONS] = { 0 };
    int fds[N_SUBMISSIONS], n_accepted = 0, n_refused = 0;
    pthread_t stopper;

    keep_busy(fds);
    // All have arrived when a later request was answered on their way.
    assert_runs_are_listed();
    assert_int_equal(usleep(300000), 0);
    assert_int_equal(pthread_create(&stopper, NULL, stop, NULL), 0);
    HELPER_AWAIT(atomic_load(&server->is_ending));
    assert_int_equal(usleep(300000), 0);
    fake_hold(&server_services, FAKE_HELD_NONE);
    for (int i = 0; i < N_SUBMISSIONS; i++) {
        assert_true(client_read_all(fds[i], &answers[i], HELPER_PATIENCE_MS));
        n_accepted += client_status(&answers[i]) == 201;
        n_refused += client_status(&answers[i]) == 503;
        assert_int_equal(close(fds[i]), 0);
        buffer_fini(&answers[i]);
    }
    assert_int_equal(pthread_join(stopper, NULL), 0);
    assert_int_equal(n_accepted, 1);
    assert_int_equal(n_refused, N_SUBMISSIONS - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(other_requests_are_answered_while_scenarios_are_checked,
                                        server_set_up, server_tear_down),
        cmocka_unit_test_setup_teardown(scenarios_that_wait_are_refused_when_the_server_stops,
                                        server_set_up, server_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
