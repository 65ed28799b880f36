// The framing of requests (RFC 9112, 6 and 7.1): the pure function that follows it, and what the server makes of it.

#include "server/http/mhd/framing.h"

#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define HOST    "Host: a\r\n"
#define POST    "POST /livez HTTP/1.1\r\n" HOST
#define CHUNKED POST "Transfer-Encoding: chunked\r\n\r\n"
#define LAST    "GET /livez HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n"
#define NEXT    "GET /hidden HTTP/1.1\r\n" HOST "\r\n"

enum { BODY_LIMIT = 100000 }; // of the server that is tested

typedef struct message {
    size_t n;
    const char *bytes;
    int refusal; // 0: none
} message;

#define BYTES(text)    sizeof text - 1, text
#define BYTES_OF(text) text, sizeof text - 1

static const message good[] = {
    { BYTES(POST "\r\n"), 0 },
    { BYTES(POST "Content-Length: 0\r\n\r\n"), 0 },
    { BYTES(POST "content-length:\t 5\r\n\r\nhello"), 0 },
    { BYTES(POST "Content-Length: 6\r\n\r\n\n\r\n\r\n\r"), 0 },
    { BYTES("\r\n" POST "Content-Length: 2\r\nX: Transfer-Encoding: chunked\r\n\r\nab"), 0 },
    { BYTES(CHUNKED "0\r\n\r\n"), 0 },
    { BYTES(CHUNKED "2\r\nab\r\n0\r\n\r\n"), 0 },
    { BYTES(CHUNKED "002\r\n\r\n\r\nA\r\n0123456789\r\n00\r\n\r\n"), 0 },
    { BYTES(CHUNKED "b\r\n0\r\n\r\n0\r\n\r\nz\r\n0\r\n\r\n"), 0 },
    { BYTES(CHUNKED "1;a=b;c=\"d \xc3\xa9\"\r\nx\r\n0;last\r\n\r\n"), 0 },
    { BYTES(CHUNKED "1\r\nx\r\n0\r\nTrailer-1: a\tb\r\nB:\r\n\r\n"), 0 },
    { BYTES(POST "tRANSFER-eNCODING:CHUNKED\r\n\r\n1\r\nx\r\n0\r\n\r\n"), 0 },
    { BYTES(POST "Content-Length: 2 \r\n\r\nab"), 0 },
    { BYTES(POST "Content-Length:2\t \t\r\nX: \r\n\r\nab"), 0 },
    { BYTES(POST "Transfer-Encoding: chunked\t\r\n\r\n1\r\nx\r\n0\r\n\r\n"), 0 },
    { BYTES("POST /livez HTTP/1.1\r\nHost: a \r\nAccept:text/plain \r\nX: b\tc \r\n"
            "Content-Length: 3 \r\n\r\n \t "),
      0 },
};

static const message bad[] = {
    { BYTES(CHUNKED "2\nab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "2\rab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "2 \r\nab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED " 2\r\nab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "+2\r\nab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "0x2\r\nab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "-1\r\nab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "\r\nab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED ";a\r\n\r\n"), 400 },
    { BYTES(CHUNKED "2;a\nab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "2;a\rb\r\nab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "2;a\0b\r\nab\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "2\r\nabc\r\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "2\r\nab\n0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "2\r\nab\r0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "2\r\nab0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "2\r\nab\r\n0\n\r\n"), 400 },
    { BYTES(CHUNKED "2\r\nab\r\n0\r\n\n"), 400 },
    { BYTES(CHUNKED "2\r\nab\r\n0\r\n\rX"), 400 },
    { BYTES(CHUNKED "0\r\nNo colon\r\n\r\n"), 400 },
    { BYTES(CHUNKED "0\r\n: nameless\r\n\r\n"), 400 },
    { BYTES(CHUNKED "0\r\nA : b\r\n\r\n"), 400 },
    { BYTES(CHUNKED "0\r\nA: b\nC: d\r\n\r\n"), 400 },
    { BYTES(CHUNKED "0\r\nA: b\r\n c\r\n\r\n"), 400 },
    { BYTES(CHUNKED "0\r\nA: \0\r\n\r\n"), 400 },
    { BYTES(CHUNKED "FFFFFFFFFFFFFFFF\r\nab"), 413 },
    { BYTES(CHUNKED "10000000000000002\r\nab\r\n0\r\n\r\n"), 413 },
    { BYTES(CHUNKED "1\r\na\r\n186a0\r\nb"), 413 },
};

// Follows n bytes; what is left of them goes behind *left.
static void follow_bytes(http_framing *f, const char *bytes, size_t n, bf_buffer *left)
{
    char *at = buffer_reserve(left, f->n_held + n + 1);

    assert_non_null(at);
    memcpy(at + f->n_held, bytes, n);
    left->n += http_framing_follow(f, at, n);
}

static void follow(http_framing *f, const message *m, size_t cut)
{
    bf_buffer left = { 0 };

    follow_bytes(f, m->bytes, cut, &left);
    follow_bytes(f, m->bytes + cut, m->n - cut, &left);
    buffer_fini(&left);
}

static void a_good_message_ends_where_the_next_one_begins_however_it_is_cut(void **state)
{
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        for (size_t cut = 0; cut <= good[i].n; cut++) {
            http_framing f = { .body_limit = BODY_LIMIT };
            follow(&f, &good[i], cut);
            assert_int_equal(f.stage, HTTP_FRAMING_START);
            follow(&f, &good[i], cut);
            assert_int_equal(f.stage, HTTP_FRAMING_START);
            assert_int_equal(f.n_messages, 2);
            assert_int_equal(f.refusal, 0);
        }
    }
}

static void a_bad_message_is_refused_however_it_is_cut(void **state)
{
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        for (size_t cut = 0; cut <= bad[i].n; cut++) {
            http_framing f = { .body_limit = BODY_LIMIT };
            follow(&f, &good[1], 0);
            follow(&f, &bad[i], cut);
            assert_int_equal(f.stage, HTTP_FRAMING_ENDED);
            assert_int_equal(f.refusal, bad[i].refusal);
            assert_int_equal(f.n_messages, 2);
            assert_non_null(f.fault);
        }
    }
}

// What the guard refuses by the header alone is not followed, and no chunk behind it is judged.
static void nothing_behind_a_header_at_fault_is_followed(void **state)
{
    static const message cases[] = {
        { BYTES(POST "Content-Length: 1\r\nTransfer-Encoding: chunked\r\n\r\nzzz"), 0 },
        { BYTES(POST "Content-Length: 1\r\nContent-Length: 1\r\n\r\nzzz"), 0 },
        { BYTES(POST "Content-Length: +1\r\n\r\nzzz"), 0 },
        { BYTES(POST "Content-Length: 99999999999999999999999\r\n\r\nzzz"), 0 },
        { BYTES(POST "Content-Length:\r\n\r\nzzz"), 0 },
        { BYTES(POST "Content-Length: \t \r\n\r\nzzz"), 0 },
        { BYTES(POST "Content-Length: 1 1\r\n\r\nzzz"), 0 },
        { BYTES(POST "Content-Length: 1\r \r\n\r\nzzz"), 0 },
        { BYTES(POST "Transfer-Encoding: chun ked\r\n\r\nzzz"), 0 },
        { BYTES(POST "Transfer-Encoding: gzip, chunked\r\n\r\nzzz"), 0 },
        { BYTES(POST "A: b\n\nzzz"), 0 },
        { BYTES(POST "A\r\n\r\nzzz"), 0 },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        http_framing f = { .body_limit = BODY_LIMIT };
        follow(&f, &cases[i], 0);
        assert_int_equal(f.stage, HTTP_FRAMING_ENDED);
        assert_int_equal(f.refusal, 0);
    }
}

static void what_a_chunked_body_has_beside_its_chunks_is_limited(void **state)
{
    static const struct {
        const char *before, *after;
        size_t limit;
    } cases[] = {
        { CHUNKED, "1\r\nx\r\n0\r\n\r\n", HTTP_CHUNK_LINE_MAX - 3 },
        { CHUNKED "1;", "\r\nx\r\n0\r\n\r\n", HTTP_CHUNK_LINE_MAX - 4 },
        { CHUNKED "0\r\nA: ", "\r\n\r\n", HTTP_CHUNK_TRAILERS_MAX - 7 },
        { CHUNKED "0\r\n", ":\r\n\r\n", HTTP_CHUNK_TRAILERS_MAX - 5 },
    };
    char zeros[HTTP_CHUNK_TRAILERS_MAX];

    memset(zeros, '0', sizeof zeros);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        for (size_t over = 0; over < 2; over++) {
            http_framing f = { .body_limit = BODY_LIMIT };
            bf_buffer left = { 0 };
            follow_bytes(&f, cases[i].before, strlen(cases[i].before), &left);
            follow_bytes(&f, zeros, cases[i].limit + over, &left);
            follow_bytes(&f, cases[i].after, strlen(cases[i].after), &left);
            buffer_fini(&left);
            assert_int_equal(f.refusal, over == 0 ? 0 : 400);
            assert_int_equal(f.stage, over == 0 ? HTTP_FRAMING_START : HTTP_FRAMING_ENDED);
        }
    }
}

// RFC 9110, 5.5: white space around a value is no part of it, within it is.
static void white_space_behind_values_is_taken_out_however_it_is_cut(void **state)
{
    static const struct {
        const char *sent, *left;
    } cases[] = {
        { "A: b \r\nC: d\t \r\n\r\n", "A: b\r\nC: d\r\n\r\n" },
        { "A:  b \t c  \r\nC:\r\nD: \r\n\r\n", "A:  b \t c\r\nC:\r\nD: \r\n\r\n" },
        { "Content-Length: 3 \r\n\r\n \t GET / HTTP/1.1 \r\nA:b \r\n\r\n",
          "Content-Length: 3\r\n\r\n \t GET / HTTP/1.1 \r\nA:b\r\n\r\n" },
        { "Transfer-Encoding: chunked \r\n\r\n2;a= \r\n \t\r\n0\r\nA: b \r\n\r\n",
          "Transfer-Encoding: chunked\r\n\r\n2;a= \r\n \t\r\n0\r\nA: b \r\n\r\n" },
        { "A: b \n c \r\nD: e \r\n", "A: b\n c \r\nD: e \r\n" }, // the guard refuses the line's end
        { "A: b \r c \r\nD: e \r\n", "A: b\r c \r\nD: e \r\n" },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char sent[200];
        int n = snprintf(sent, sizeof sent, POST "%s", cases[i].sent);
        for (size_t cut = 0; cut <= (size_t)n; cut++) {
            http_framing f = { .body_limit = BODY_LIMIT };
            bf_buffer left = { 0 };
            follow_bytes(&f, sent, cut, &left);
            follow_bytes(&f, sent + cut, (size_t)n - cut, &left);
            left.bytes[left.n] = '\0';
            assert_string_equal(left.bytes + strlen(POST), cases[i].left);
            assert_int_equal(f.n_held, 0);
            buffer_fini(&left);
        }
    }
}

// What cannot be held back stays where it is; nothing within a value is lost.
static void long_white_space_is_left_in_its_place(void **state)
{
    enum { N = HTTP_FRAMING_SPACE_MAX };
    static const struct {
        int n_sent, n_left;
        const char *behind;
    } cases[] = {
        { N, 0, "\r\n" }, { N + 1, N, "\r\n" }, { N, N, "b\r\n" }, { N + 1, N + 1, "b\r\n" }
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        http_framing f = { .body_limit = BODY_LIMIT };
        bf_buffer left = { 0 };
        char sent[200], wanted[200];
        int n = snprintf(sent, sizeof sent, POST "X: a%*s%s", cases[i].n_sent, "", cases[i].behind);
        snprintf(wanted, sizeof wanted, POST "X: a%*s%s", cases[i].n_left, "", cases[i].behind);
        for (int k = 0; k < n; k++)
            follow_bytes(&f, sent + k, 1, &left);
        left.bytes[left.n] = '\0';
        assert_string_equal(left.bytes, wanted);
        buffer_fini(&left);
    }
}

static void what_is_held_back_can_be_released_in_parts(void **state)
{
    http_framing f = { .body_limit = BODY_LIMIT };
    bf_buffer left = { 0 };
    char released[8];

    follow_bytes(&f, BYTES_OF(POST "X: a \t "), &left);
    assert_int_equal(f.n_held, 3);
    assert_int_equal(http_framing_release(&f, released, 2), 2);
    assert_memory_equal(released, " \t", 2);
    assert_int_equal(http_framing_release(&f, released, 2), 1);
    assert_int_equal(http_framing_release(&f, released, 2), 0);
    follow_bytes(&f, BYTES_OF("\r\n\r\n"), &left);
    assert_int_equal(f.stage, HTTP_FRAMING_START);
    buffer_fini(&left);
}

// Sends a message in two pieces, then another one, and reads all that comes.
static void exchange(const message *m, size_t cut, const char *next, bf_buffer *answer)
{
    int fd = client_connect(http_port(server));

    assert_true(client_send_bytes(fd, m->bytes, cut));
    if (cut > 0)
        assert_int_equal(usleep(2000), 0); // so that the server receives them one by one
    (void)client_send_bytes(fd, m->bytes + cut, m->n - cut);
    (void)client_send(fd, next); // the server may have hung up
    bool is_closed = client_read_all(fd, answer, HELPER_PATIENCE_MS);
    if (!is_closed)
        print_error("not closed after %.*s\n", (int)m->n, m->bytes);
    assert_true(is_closed);
    assert_int_equal(close(fd), 0);
}

static size_t count(const bf_buffer *answer, const char *text)
{
    size_t n = 0;

    for (const char *at = answer->bytes; at != NULL && (at = strstr(at, text)) != NULL; at++)
        n++;
    return n;
}

static void the_server_refuses_a_bad_message_once_and_takes_nothing_behind_it(void **state)
{
    server = fake_serve(&server_services, NULL);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const size_t body = strlen(CHUNKED); // no header has a zero byte
        const size_t cuts[] = { 0, body, body + 1, bad[i].n - 1 };
        for (size_t k = 0; k < sizeof cuts / sizeof *cuts; k++) {
            bf_buffer answer = { 0 };
            exchange(&bad[i], cuts[k], NEXT, &answer);
            if (client_status(&answer) != bad[i].refusal)
                print_error("case %zu, cut at %zu: %s\n", i, cuts[k], answer.bytes);
            assert_int_equal(client_status(&answer), bad[i].refusal);
            assert_int_equal(count(&answer, "HTTP/1.1 "), 1);
            server_assert_holds(&answer, "application/problem+json");
            server_assert_holds(&answer, "\r\nConnection: close\r\n");
            buffer_fini(&answer);
        }
    }
}

static void the_server_answers_a_good_message_and_the_next_one(void **state)
{
    server = fake_serve(&server_services, NULL);
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        for (size_t cut = 0; cut < good[i].n; cut += 7) {
            bf_buffer answer = { 0 };
            exchange(&good[i], cut, LAST, &answer);
            if (client_status(&answer) != 405)
                print_error("case %zu, cut at %zu: %s\n", i, cut, answer.bytes);
            assert_int_equal(client_status(&answer), 405); // livez takes no POST
            assert_int_equal(count(&answer, "HTTP/1.1 405"), 1);
            assert_int_equal(count(&answer, "HTTP/1.1 200"), 1);
            buffer_fini(&answer);
        }
    }
}

static void a_fault_is_laid_on_the_request_that_has_it(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    exchange(&(message){ BYTES(POST "\r\n" CHUNKED "1\r\nx\r\n0\r\n\r\n" CHUNKED "2\nab" NEXT), 0 },
             0, "", &answer);
    assert_int_equal(count(&answer, "HTTP/1.1 405"), 2);
    assert_int_equal(count(&answer, "HTTP/1.1 400"), 1);
    assert_int_equal(count(&answer, "HTTP/1.1 "), 3);
    buffer_fini(&answer);
    exchange(&(message){ BYTES(LAST), 0 }, 0, "", &answer);
    assert_int_equal(client_status(&answer), 200);
    buffer_fini(&answer);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)
    const struct CMUnitTest tests[] = {
        CASE(a_good_message_ends_where_the_next_one_begins_however_it_is_cut),
        CASE(a_bad_message_is_refused_however_it_is_cut),
        CASE(nothing_behind_a_header_at_fault_is_followed),
        CASE(white_space_behind_values_is_taken_out_however_it_is_cut),
        CASE(long_white_space_is_left_in_its_place),
        CASE(what_is_held_back_can_be_released_in_parts),
        CASE(what_a_chunked_body_has_beside_its_chunks_is_limited),
        CASE(the_server_refuses_a_bad_message_once_and_takes_nothing_behind_it),
        CASE(the_server_answers_a_good_message_and_the_next_one),
        CASE(a_fault_is_laid_on_the_request_that_has_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
