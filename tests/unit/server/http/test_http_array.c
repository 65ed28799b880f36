// Tests of arrays that are sent piece by piece: their bytes, ranges, lengths and entity tags are those of an answer that
// is there as a whole.

#include "server/http/http.h"

#include "tests/unit/server/helper_server.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define TARGET "/v1/runs/" FAKE_RUN "/snapshots/0"

enum { HEAD_BYTES = 128, N_BYTES = HEAD_BYTES + FAKE_CELLS * 4, PIECE = 131072 };

static void serve(void)
{
    server_services.n_snapshots = 1;
    server = fake_serve(&server_services, NULL);
}

// Ask on a connection of its own. more: header lines.
static int ask(const char *method, const char *more, bf_buffer *answer)
{
    char request[512];

    (void)snprintf(request, sizeof request,
                   "%s " TARGET " HTTP/1.1\r\nHost: a\r\nConnection: close\r\n%s\r\n", method,
                   more);
    return client_ask(http_port(server), request, answer);
}

static const char *body_of(const bf_buffer *answer, size_t *ret_n)
{
    const char *end = strstr(answer->bytes, "\r\n\r\n");

    assert_non_null(end);
    *ret_n = answer->n - (size_t)(end + 4 - answer->bytes);
    return end + 4;
}

// The numbers that the fake service makes for snapshot 0.
static void assert_whole(const char *body, size_t n)
{
    uint32_t x = 0;

    assert_int_equal(n, N_BYTES);
    assert_memory_equal(body, "\x93NUMPY", 6);
    for (size_t i = 0; i < FAKE_CELLS; i++) {
        x = x * 1664525 + 1013904223;
        assert_memory_equal(body + HEAD_BYTES + i * sizeof x, &x, sizeof x);
    }
}

static void a_large_array_comes_whole_with_its_length(void **state)
{
    bf_buffer answer = { 0 };
    char length[64];
    size_t n = 0;

    serve();
    assert_int_equal(ask("GET", "", &answer), 200);
    (void)snprintf(length, sizeof length, "\r\nContent-Length: %d\r\n", N_BYTES);
    server_assert_holds(&answer, length);
    server_assert_holds(&answer, "\r\nAccept-Ranges: bytes\r\n");
    const char *body = body_of(&answer, &n);
    assert_whole(body, n);
    answer.n = 0;
    assert_int_equal(ask("HEAD", "", &answer), 200);
    server_assert_holds(&answer, length);
    (void)body_of(&answer, &n);
    assert_int_equal(n, 0);
    buffer_fini(&answer);
}

static void ranges_are_parts_of_the_whole(void **state)
{
    static const struct {
        size_t first, last;
    } ranges[] = { { 0, 0 },
                   { 0, N_BYTES - 1 },
                   { HEAD_BYTES - 1, HEAD_BYTES + 1 },
                   { HEAD_BYTES + PIECE - 3, HEAD_BYTES + PIECE + 2 },
                   { PIECE + 1, N_BYTES - 2 },
                   { N_BYTES - 1, N_BYTES - 1 } };
    bf_buffer whole = { 0 }, part = { 0 };
    size_t n_whole = 0, n = 0;

    serve();
    assert_int_equal(ask("GET", "", &whole), 200);
    const char *all = body_of(&whole, &n_whole);
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
        char range[64], told[96];
        (void)snprintf(range, sizeof range, "Range: bytes=%zu-%zu\r\n", ranges[i].first,
                       ranges[i].last);
        (void)snprintf(told, sizeof told, "\r\nContent-Range: bytes %zu-%zu/%d\r\n",
                       ranges[i].first, ranges[i].last, N_BYTES);
        part.n = 0;
        assert_int_equal(ask("GET", range, &part), 206);
        server_assert_holds(&part, told);
        const char *body = body_of(&part, &n);
        assert_int_equal(n, ranges[i].last - ranges[i].first + 1);
        assert_memory_equal(body, all + ranges[i].first, n);
    }
    part.n = 0;
    assert_int_equal(ask("GET", "Range: bytes=9999999-\r\n", &part), 416);
    buffer_fini(&whole);
    buffer_fini(&part);
}

static void an_array_that_the_client_has_is_not_sent_again(void **state)
{
    bf_buffer answer = { 0 };
    char tag[128] = "", header[192], length[64];

    serve();
    assert_int_equal(ask("GET", "", &answer), 200);
    assert_int_equal(sscanf(strstr(answer.bytes, "\r\nETag: "), "\r\nETag: %127s", tag), 1);
    (void)snprintf(header, sizeof header, "If-None-Match: %s\r\n", tag);
    answer.n = 0;
    assert_int_equal(ask("GET", header, &answer), 304);
    (void)snprintf(length, sizeof length, "\r\nContent-Length: %d\r\n", N_BYTES);
    server_assert_holds(&answer, length);
    buffer_fini(&answer);
}

// A client that does not take the bytes as they are gets them encoded.
static void a_client_may_want_no_bytes_as_they_are(void **state)
{
    bf_buffer answer = { 0 };

    serve();
    assert_int_equal(ask("GET", "Accept-Encoding: gzip, identity;q=0\r\n", &answer), 200);
    server_assert_holds(&answer, "\r\nContent-Encoding: gzip\r\n");
    buffer_fini(&answer);
}

static void what_cannot_be_opened_is_a_problem(void **state)
{
    bf_buffer answer = { 0 };

    serve();
    lock_acquire(&server_services.lock);
    server_services.is_broken = true;
    lock_release(&server_services.lock);
    assert_int_equal(ask("GET", "", &answer), 500);
    buffer_fini(&answer);
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(a_large_array_comes_whole_with_its_length),
        CASE(ranges_are_parts_of_the_whole),
        CASE(an_array_that_the_client_has_is_not_sent_again),
        CASE(a_client_may_want_no_bytes_as_they_are),
        CASE(what_cannot_be_opened_is_a_problem),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
