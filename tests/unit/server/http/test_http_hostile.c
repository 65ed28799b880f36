// Tests of the HTTP transport against requests that are malformed, too long or too slow.

#include "server/http/http.h"

#include "server/base/clock.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define HOST  "Host: a\r\n"
#define CLOSE "Connection: close\r\n"

// The connection must be closed, so what follows a bad request is never taken for a request.
static void a_bad_request_is_refused_and_its_connection_closed(void **state)
{
#define NEXT "GET /livez HTTP/1.1\r\n" HOST "\r\n"
    static const struct {
        size_t n;
        const char *bytes;
        int status;
    } cases[] = {
#define BYTES(text) sizeof text - 1, text
        { BYTES("GET /livez HTTP/1.1\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST HOST "\r\n" NEXT), 400 },
        { BYTES("POST /livez HTTP/1.1\r\n" HOST
                "Content-Length: 0\r\nContent-Length: 0\r\n\r\n" NEXT),
          400 },
        { BYTES("POST /livez HTTP/1.1\r\n" HOST
                "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n" NEXT),
          400 },
        { BYTES("POST /livez HTTP/1.0\r\n" HOST "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n" NEXT),
          400 },
        { BYTES("POST /livez HTTP/1.1\r\n" HOST
                "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n" NEXT),
          400 },
        { BYTES("POST /livez HTTP/1.1\r\n" HOST
                "Transfer-Encoding: gzip, chunked\r\n\r\n0\r\n\r\n" NEXT),
          501 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "X y: z\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "X : z\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "X: \a\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "X: a\0b\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "X\0Y: a\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez\0 HTTP/1.1\r\n" HOST "\r\n" NEXT), 400 },
        { BYTES("GET /livez%00 HTTP/1.1\r\n" HOST "\r\n" NEXT), 400 },
        { BYTES("GET /%zz HTTP/1.1\r\n" HOST "\r\n" NEXT), 400 },
        { BYTES("GET livez HTTP/1.1\r\n" HOST "\r\n" NEXT), 400 },
        { BYTES("GET * HTTP/1.1\r\n" HOST "\r\n" NEXT), 400 },
        { BYTES("DELETE / HTTP/1.1\r\n" HOST "Sec-Fetch-Site: cross-site\r\n\r\n" NEXT), 403 },
        { BYTES("G@T /livez HTTP/1.1\r\n" HOST "\r\n" NEXT), 400 },
        { BYTES("GET\0X /livez HTTP/1.1\r\n" HOST "\r\n" NEXT), 400 },
        { BYTES("NEVERHEARDOFSUCHAMETHODINMYWHOLELIFE /livez HTTP/1.1\r\n" HOST "\r\n" NEXT), 501 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "X: a\0b\r\nY: c\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "X: a\r\n b\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n Host: a\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\nHost: a\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "X: a\nY: b\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "X: a\rY: b\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "\n" NEXT), 400 },
        { BYTES("GET /li vez HTTP/1.1\r\n" HOST "\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST "no colon\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez HTTP/1.1\r\n" HOST ": nameless\r\n\r\n" NEXT), 400 },
        { BYTES("GET /livez\r\n" HOST "\r\n" NEXT), 400 },
        { BYTES("POST /livez HTTP/1.1\r\n" HOST "Content-Length: -1\r\n\r\n" NEXT), 400 },
        { BYTES("POST /livez HTTP/1.1\r\n" HOST "Content-Length: 1,1\r\n\r\n" NEXT), 400 },
        { BYTES("POST /livez HTTP/1.1\r\n" HOST "Content-Length: +1\r\n\r\n" NEXT), 400 },
        { BYTES("POST /livez HTTP/1.1\r\n" HOST "Transfer-Encoding: chunked\r\n\r\nxyz\r\n" NEXT),
          400 },
        { BYTES("GET /livez HTTP/3.0\r\n" HOST "\r\n" NEXT), 505 },
#undef BYTES
    };

    server = fake_serve(&server_services, NULL);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bf_buffer answer = { 0 };
        int fd = client_connect(http_port(server));
        assert_true(client_send_bytes(fd, cases[i].bytes, cases[i].n));
        bool is_closed = client_read_all(fd, &answer, HELPER_PATIENCE_MS);
        const char *second = answer.n == 0 ? NULL : strstr(answer.bytes + 1, "HTTP/1.1 ");
        if (!is_closed || client_status(&answer) != cases[i].status || second != NULL)
            print_error("case %zu: closed %d, answer: %s\n", i, is_closed,
                        answer.n == 0 ? "none" : answer.bytes);
        assert_true(is_closed);
        assert_int_equal(client_status(&answer), cases[i].status);
        assert_null(second);
        assert_int_equal(close(fd), 0);
        buffer_fini(&answer);
    }
    assert_int_equal(
        client_ask(http_port(server), "GET /livez HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL), 200);
}

// What a page of another origin makes a browser send: each header alone tells it, and a program sends none of them. Whatever
// is let through finds that this path cannot be posted to.
static void a_change_that_another_page_asks_for_is_refused(void **state)
{
#define POSTED(headers) "POST /livez HTTP/1.1\r\n" CLOSE headers "Content-Length: 0\r\n\r\n"
    static const struct {
        const char *request;
        int status;
    } cases[] = {
        { POSTED(HOST), 405 },
        { POSTED(HOST "Sec-Fetch-Site: same-origin\r\n"), 405 },
        { POSTED(HOST "Origin: http://a\r\n"), 405 },
        { POSTED("Host: a:8080\r\nOrigin: http://a:8080\r\n"), 405 },
        // Sec-Fetch-Site
        { POSTED(HOST "Sec-Fetch-Site: cross-site\r\n"), 403 },
        { POSTED(HOST "Sec-Fetch-Site: same-site\r\n"), 403 },
        { POSTED(HOST "Origin: http://a\r\nSec-Fetch-Site: same-site\r\n"), 403 },
        // Origin, from a browser without Sec-Fetch-Site
        { POSTED(HOST "Origin: http://evil.example\r\n"), 403 },
        { POSTED(HOST "Origin: null\r\n"), 403 },
        { POSTED("Host: a:8080\r\nOrigin: http://a:9000\r\n"), 403 },
        { POSTED("Host: a:8080\r\nOrigin: http://a\r\n"), 403 },
        // Host, where the name of the page was made to lead here
        { POSTED("Host: evil.example\r\n"), 421 },
        { POSTED("Host: evil.example\r\nOrigin: http://evil.example\r\n"), 421 },
        { POSTED("Host: evil.example\r\nSec-Fetch-Site: same-origin\r\n"), 421 },
        { "POST /livez HTTP/1.0\r\nOrigin: http://a\r\n\r\n", 403 },
    };
#undef POSTED

    server = fake_serve(&server_services, NULL);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const int status = client_ask(http_port(server), cases[i].request, NULL);
        if (status != cases[i].status)
            print_error("%s", cases[i].request);
        assert_int_equal(status, cases[i].status);
    }
}

static void long_headers_are_fine(void **state)
{
    bf_buffer request = { 0 };

    server = fake_serve(&server_services, NULL);
    assert_int_equal(buffer_printf(&request, "GET /livez?a=%01000d HTTP/1.1\r\n" HOST CLOSE, 0),
                     BF_OK);
    for (int i = 0; i < 80; i++)
        assert_int_equal(buffer_printf(&request, "Header-%d: %0200d\r\n", i, 0), BF_OK);
    assert_int_equal(buffer_append(&request, "\r\n", 2), BF_OK);
    assert_int_equal(client_ask(http_port(server), request.bytes, NULL), 400);
    request.bytes[strlen("GET /livez")] = '/';
    assert_int_equal(client_ask(http_port(server), request.bytes, NULL), 404);
    buffer_fini(&request);
}

// Sends a header with n fields of n_value bytes each; returns the status.
static int ask_with_fields(int n, int n_value)
{
    bf_buffer request = { 0 };

    assert_int_equal(buffer_printf(&request, "GET /livez HTTP/1.1\r\n" HOST CLOSE), BF_OK);
    for (int i = 0; i < n; i++)
        assert_int_equal(buffer_printf(&request, "X: %0*d\r\n", n_value, 0), BF_OK);
    assert_int_equal(buffer_append(&request, "\r\n", 2), BF_OK);
    int status = client_ask(http_port(server), request.bytes, NULL);
    buffer_fini(&request);
    return status;
}

static void too_large_a_header_is_refused(void **state)
{
    server = fake_serve(&server_services, NULL);
    assert_int_equal(ask_with_fields(1, 31000), 200);
    assert_int_equal(ask_with_fields(1, 33000), 431);
    assert_int_equal(ask_with_fields(400, 1), 200);
    assert_int_equal(ask_with_fields(800, 1), 431);
}

static void too_long_a_target_is_refused(void **state)
{
    bf_buffer request = { 0 };

    server = fake_serve(&server_services, NULL);
    assert_int_equal(buffer_printf(&request, "GET /%05000d HTTP/1.1\r\n" HOST "\r\n", 0), BF_OK);
    assert_int_equal(client_ask(http_port(server), request.bytes, NULL), 414);
    buffer_fini(&request);
    assert_int_equal(buffer_printf(&request, "GET /%090000d HTTP/1.1\r\n" HOST "\r\n", 0), BF_OK);
    assert_in_range(client_ask(http_port(server), request.bytes, NULL), 400, 499);
    buffer_fini(&request);
}

static void shorten_deadlines(http_options *options)
{
    options->header_deadline_ms = 400;
    options->body_deadline_ms = 400;
}

// Sends head, then a byte every 50 ms, until the server closes; returns ms until then. Without shorter deadlines that is
// later than it waits here.
static int64_t drip(unsigned port, const char *head, char byte)
{
    int64_t start_ms = clock_monotonic_ms();
    bf_buffer answer = { 0 };
    int fd = client_connect(port);

    assert_true(client_send(fd, head));
    while (!client_read_all(fd, &answer, 50)) {
        if (!client_send_bytes(fd, &byte, 1))
            break;
        assert_true(clock_monotonic_ms() - start_ms < 10000);
    }
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
    return clock_monotonic_ms() - start_ms;
}

static void a_client_that_drips_its_header_is_cut_off(void **state)
{
    server = fake_serve(&server_services, shorten_deadlines);
    assert_true(drip(http_port(server), "GET /livez HTTP/1.1\r\nX: ", 'x') >= 350);
}

static void a_client_that_drips_its_body_is_cut_off(void **state)
{
    server = fake_serve(&server_services, shorten_deadlines);
    assert_true(drip(http_port(server),
                     "POST /livez HTTP/1.1\r\n" HOST "Content-Length: 90000\r\n\r\n", ' ') >= 350);
}

static void sixteen_connections(http_options *options)
{
    options->connection_limit = 16;
    options->n_threads = 1;
    options->header_deadline_ms = options->body_deadline_ms = 10 * HELPER_PATIENCE_MS;
}

// Each of these would hold a connection until its deadline.
static void clients_that_send_a_little_and_hang_up_hold_no_connection(void **state)
{
    static const char *const beginnings[] = {
        "GET /livez HT",
        "POST /v1/runs HTTP/1.1\r\n" HOST "Content-Length: 1000\r\n\r\nabc",
        "POST /v1/runs HTTP/1.1\r\n" HOST "Transfer-Encoding: chunked\r\n\r\n5\r\nab",
    };
    int64_t start_ms = clock_monotonic_ms();
    int status = 503;

    server = fake_serve(&server_services, sixteen_connections);
    for (int i = 0; i < 60; i++) {
        int fd = client_connect(http_port(server));
        (void)client_send(fd, beginnings[i % 3]);
        assert_int_equal(close(fd), 0);
    }
    while (status != 200 && clock_monotonic_ms() - start_ms < HELPER_PATIENCE_MS)
        status = client_ask(http_port(server), "GET /version HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL);
    assert_int_equal(status, 200);
}

// Sockets that say nothing take every place, and go on coming; their deadline is far away.
static void a_crowd_that_says_nothing_does_not_shut_others_out(void **state)
{
    enum { CROWD = 40 };
    int fds[CROWD];

    server = fake_serve(&server_services, sixteen_connections);
    for (int i = 0; i < CROWD; i++)
        fds[i] = client_connect(http_port(server));
    for (int i = 0; i < 5; i++)
        assert_int_equal(
            client_ask(http_port(server), "GET /livez HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL), 200);
    for (int i = 0; i < CROWD; i++)
        assert_int_equal(close(fds[i]), 0);
}

// A connection with a request is not closed to make room.
static void a_request_that_is_handled_outlives_the_crowd(void **state)
{
    enum { CROWD = 40 };
    bf_buffer rest = { 0 }, answer = { 0 };
    int fds[CROWD];

    server = fake_serve(&server_services, sixteen_connections);
    fake_hold(&server_services, FAKE_HELD_LIST);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, "GET /v1/runs HTTP/1.1\r\n" HOST "\r\n"));
    assert_true(fake_wait_for_held(&server_services, 1));
    for (int i = 0; i < CROWD; i++)
        fds[i] = client_connect(http_port(server));
    assert_int_equal(
        client_ask(http_port(server), "GET /livez HTTP/1.1\r\n" HOST CLOSE "\r\n", NULL), 200);
    fake_hold(&server_services, FAKE_HELD_NONE);
    assert_true(client_read_response(fd, &rest, true, &answer));
    assert_int_equal(client_status(&answer), 200);
    for (int i = 0; i < CROWD; i++)
        assert_int_equal(close(fds[i]), 0);
    assert_int_equal(close(fd), 0);
    buffer_fini(&rest);
    buffer_fini(&answer);
}

static void deadlines_do_not_hit_a_request_that_is_being_handled(void **state)
{
    bf_buffer rest = { 0 }, answer = { 0 };

    server = fake_serve(&server_services, shorten_deadlines);
    fake_hold(&server_services, FAKE_HELD_LIST);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, "GET /v1/runs HTTP/1.1\r\n" HOST "\r\n"));
    assert_false(client_read_until(fd, &rest, "\r\n\r\n", 1000));
    fake_hold(&server_services, FAKE_HELD_NONE);
    assert_true(client_read_response(fd, &rest, true, &answer));
    assert_int_equal(client_status(&answer), 200);
    assert_int_equal(close(fd), 0);
    buffer_fini(&rest);
    buffer_fini(&answer);
}

static void a_body_that_is_announced_too_long_is_refused_at_once(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = client_connect(http_port(server));
    assert_true(
        client_send(fd, "POST /v1/runs HTTP/1.1\r\n" HOST "Content-Length: 1073741824\r\n\r\n"));
    assert_true(client_read_until(fd, &answer, "\r\n\r\n", HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), 413);
    assert_int_equal(close(fd), 0);
    assert_int_equal(client_ask(http_port(server),
                                "POST /v1/runs HTTP/1.1\r\n" HOST
                                "Content-Length: 99999999999999999999999\r\n\r\n",
                                NULL),
                     413);
    buffer_fini(&answer);
}

// A client that first sends everything and then reads must find the refusal, not a reset.
static void a_client_that_sends_its_long_body_anyway_reads_the_refusal(void **state)
{
    enum { N = 3000000 };
    char *body = calloc(1, N);

    assert_non_null(body);
    server = fake_serve(&server_services, NULL);
    for (int i = 0; i < 10; i++) {
        bf_buffer answer = { 0 };
        int fd = client_connect(http_port(server));
        assert_true(
            client_send(fd, "POST /v1/runs HTTP/1.1\r\n" HOST "Content-Length: 3000000\r\n\r\n"));
        assert_true(client_send_bytes(fd, body, N));
        assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
        assert_int_equal(client_status(&answer), 413);
        assert_int_equal(close(fd), 0);
        buffer_fini(&answer);
    }
    free(body);
}

static void a_chunked_body_is_refused_when_it_becomes_too_long(void **state)
{
    char chunk[10008] = "2710\r\n";
    bf_buffer answer = { 0 };

    memset(chunk + 6, ' ', 10000);
    memcpy(chunk + 10006, "\r\n", 2);
    server = fake_serve(&server_services, NULL);
    int fd = client_connect(http_port(server));
    assert_true(
        client_send(fd, "POST /v1/runs HTTP/1.1\r\n" HOST "Transfer-Encoding: chunked\r\n\r\n"));
    for (int i = 0; i < 11; i++)
        assert_true(client_send_bytes(fd, chunk, sizeof chunk));
    assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), 413);
    server_assert_holds(&answer, "application/problem+json");
    server_assert_holds(&answer, "\r\nConnection: close\r\n");
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

static void a_body_may_be_as_long_as_the_limit(void **state)
{
    bf_buffer request = { 0 }, answer = { 0 };

    server = fake_serve(&server_services, NULL);
    assert_int_equal(buffer_printf(&request,
                                   "POST /v1/validate HTTP/1.1\r\n" HOST CLOSE
                                   "Content-Type: application/json\r\n"
                                   "Content-Length: 100000\r\n\r\n%100000s",
                                   "{,}"),
                     BF_OK);
    assert_int_equal(client_ask(http_port(server), request.bytes, &answer), 400);
    server_assert_holds(&answer, "application/problem+json");
    buffer_fini(&request);
    buffer_fini(&answer);
}

static void a_client_that_expects_a_100_gets_it_or_the_refusal(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, "POST /v1/validate HTTP/1.1\r\n" HOST CLOSE
                                "Content-Type: application/json\r\n"
                                "Content-Length: 3\r\nExpect: 100-continue\r\n\r\n"));
    assert_true(client_read_until(fd, &answer, "\r\n\r\n", HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), 100);
    assert_true(client_send(fd, "{,}"));
    answer.n = 0;
    assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), 400);
    assert_int_equal(close(fd), 0);
    assert_int_equal(client_ask(http_port(server),
                                "POST /v1/validate HTTP/1.1\r\n" HOST "Content-Length: 200000\r\n"
                                "Expect: 100-continue\r\n\r\n",
                                NULL),
                     413);
    buffer_fini(&answer);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)
    const struct CMUnitTest tests[] = {
        CASE(a_bad_request_is_refused_and_its_connection_closed),
        CASE(a_change_that_another_page_asks_for_is_refused),
        CASE(long_headers_are_fine),
        CASE(too_large_a_header_is_refused),
        CASE(too_long_a_target_is_refused),
        CASE(a_client_that_drips_its_header_is_cut_off),
        CASE(a_client_that_drips_its_body_is_cut_off),
        CASE(clients_that_send_a_little_and_hang_up_hold_no_connection),
        CASE(a_crowd_that_says_nothing_does_not_shut_others_out),
        CASE(a_request_that_is_handled_outlives_the_crowd),
        CASE(deadlines_do_not_hit_a_request_that_is_being_handled),
        CASE(a_body_that_is_announced_too_long_is_refused_at_once),
        CASE(a_client_that_sends_its_long_body_anyway_reads_the_refusal),
        CASE(a_chunked_body_is_refused_when_it_becomes_too_long),
        CASE(a_body_may_be_as_long_as_the_limit),
        CASE(a_client_that_expects_a_100_gets_it_or_the_refusal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
