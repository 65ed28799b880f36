// Clients that shut down their sending side when they have sent what they want: all of it is answered.

#include "server/http/http.h"

#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define HOST "Host: a\r\n"
#define RUN  "/v1/runs/" FAKE_RUN
#define LIST "GET /v1/runs HTTP/1.1\r\n" HOST "\r\n"
#define BODY                                                                                       \
    "{\"scenario\":{\"duration_s\":1,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},\"cargo\":{},"     \
    "\"initial\":{\"positions_m\":[[0.3,0.3]]}}}"

// A new connection on which a request was sent, and no more will be.
static int ask_and_shut(const char *request)
{
    int fd = client_connect(http_port(server));

    assert_true(client_send(fd, request));
    assert_int_equal(shutdown(fd, SHUT_WR), 0);
    return fd;
}

static unsigned count_answers(const bf_buffer *bytes, const char *start)
{
    const char *at = bytes->n == 0 ? NULL : bytes->bytes;
    unsigned n = 0;

    while (at != NULL && (at = strstr(at, start)) != NULL) {
        at++;
        n++;
    }
    return n;
}

static void one_epoll_thread(http_options *options)
{
    options->n_threads = 1;
}

// The end of what the client sends arrives while the request waits for the store. The idle connection is
// there because the library treats the one that has been idle for longest otherwise than all others.
static void requests_that_wait_for_the_store_are_answered(void **state)
{
    static const struct {
        const char *request;
        unsigned n_answers;
    } cases[] = {
        { LIST, 1 },
        { "GET /v1/runs HTTP/1.0\r\n\r\n", 1 },
        { "GET /v1/runs HTTP/1.0\r\nConnection: keep-alive\r\n\r\n", 1 },
        { LIST LIST LIST LIST, 4 },
    };

    server = fake_serve(&server_services, one_epoll_thread);
    int idle = client_connect(http_port(server));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bf_buffer answer = { 0 };
        fake_hold(&server_services, FAKE_HELD_LIST);
        int fd = ask_and_shut(cases[i].request);
        assert_true(fake_wait_for_held(&server_services, 1));
        fake_hold(&server_services, FAKE_HELD_NONE);
        assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
        assert_int_equal(count_answers(&answer, "HTTP/1.1 200 "), cases[i].n_answers);
        assert_int_equal(close(fd), 0);
        buffer_fini(&answer);
    }
    assert_int_equal(close(idle), 0);
}

static void bodies_are_taken_and_answered(void **state)
{
    static const char *const requests[] = {
        "POST /v1/runs HTTP/1.1\r\n" HOST "Content-Type: application/json\r\n"
        "Transfer-Encoding: chunked\r\n\r\n" /* 0x73 is the length of BODY */
        "73\r\n" BODY "\r\n0\r\n\r\n",
        "POST /v1/runs HTTP/1.1\r\n" HOST "Content-Type: application/json\r\n"
        "Content-Length: 115\r\n\r\n" BODY,
    };

    assert_int_equal(strlen(BODY), 0x73);
    server = fake_serve(&server_services, one_epoll_thread);
    int idle = client_connect(http_port(server));
    for (size_t i = 0; i < 40; i++) {
        bf_buffer answer = { 0 };
        int fd = ask_and_shut(requests[i % 2]);
        assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
        assert_int_equal(client_status(&answer), 201);
        assert_int_equal(close(fd), 0);
        buffer_fini(&answer);
    }
    assert_int_equal(close(idle), 0);
}

static void a_wait_for_a_run_is_answered(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = ask_and_shut("GET " RUN "?wait=60 HTTP/1.1\r\n" HOST "\r\n");
    assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), 200);
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

// The comment is what tells whether the client is gone, since its heartbeat is ten minutes away.
static void an_event_stream_goes_on(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = ask_and_shut("GET " RUN "/events HTTP/1.1\r\n" HOST "\r\n");
    assert_true(client_read_until(fd, &answer, "\r\n:\n\n", HELPER_PATIENCE_MS));
    server_append(false);
    assert_true(client_read_until(fd, &answer, "{\"k\":1}", HELPER_PATIENCE_MS));
    server_append(true);
    assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
    server_assert_holds(&answer, "{\"k\":2}");
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(requests_that_wait_for_the_store_are_answered),
        CASE(bodies_are_taken_and_answered),
        CASE(a_wait_for_a_run_is_answered),
        CASE(an_event_stream_goes_on),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
