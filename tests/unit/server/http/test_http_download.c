// Tests of bodies that are made while they are sent: whole, no faster than their client, given up
// with it, and no obstacle to stopping.

#include "server/http/http.h"

#include "api/results/results_archive.h"
#include "server/base/clock.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define HOST     "Host: a\r\n"
#define RESULTS  "/v1/runs/" FAKE_RUN "/results.zip"
#define DOWNLOAD "GET " RESULTS " HTTP/1.1\r\n" HOST "\r\n"

enum { SNAPSHOT_BYTES = FAKE_CELLS * 4, FEW = 6, MANY = 160 };

static void serve(uint64_t n_snapshots, void (*change)(http_options *options))
{
    fake_append(&server_services, true);
    server_services.n_snapshots = n_snapshots;
    server = fake_serve(&server_services, change);
}

static unsigned reads_so_far(void)
{
    lock_acquire(&server_services.lock);
    unsigned n = server_services.n_reads;
    lock_release(&server_services.lock);
    return n;
}

static void wait_until_quiet(void)
{
    unsigned before = 0, now = 1;

    while (before != now) {
        before = now;
        (void)usleep(100000);
        now = reads_so_far();
    }
}

// What the body must be: the same archive, made here.
static bf_buffer make_archive(void)
{
    api_services services = fake_services(&server_services);
    bf_buffer whole = { 0 };
    body_state where = BODY_MORE;
    body_source body;
    api_run of;

    assert_int_equal(services.find(services.service, FAKE_RUN, &of, NULL), BF_OK);
    assert_int_equal(results_archive_open(&of, RESULTS_ARCHIVE_PLAIN, &services, &body, NULL),
                     BF_OK);
    while (where == BODY_MORE)
        assert_int_equal(body.next_chunk(body.state, &services, SIZE_MAX, &whole, &where, NULL),
                         BF_OK);
    body.destroy(body.state);
    return whole;
}

// The body of a chunked answer that is whole: takes the chunks' sizes out.
static bf_buffer join_chunks(const bf_buffer *answer)
{
    const char *at = strstr(answer->bytes, "\r\n\r\n");
    const char *end = answer->bytes + answer->n;
    bf_buffer body = { 0 };

    assert_non_null(at);
    at += 4;
    for (;;) {
        char *line_end = NULL;
        size_t n = strtoul(at, &line_end, 16);
        assert_memory_equal(line_end, "\r\n", 2);
        at = line_end + 2;
        assert_true((size_t)(end - at) >= n + 2);
        if (n == 0)
            return body;
        assert_int_equal(buffer_append(&body, at, n), BF_OK);
        at += n + 2;
    }
}

static bool is_whole(const bf_buffer *answer)
{
    return answer->n > 7 && memcmp(answer->bytes + answer->n - 7, "\r\n0\r\n\r\n", 7) == 0;
}

// Reads to the last chunk, or to the end of the connection.
static bool read_whole(int fd, bf_buffer *answer)
{
    char bytes[65536];
    ssize_t n;

    while (!is_whole(answer) && (n = recv(fd, bytes, sizeof bytes, 0)) > 0)
        assert_int_equal(buffer_append(answer, bytes, (size_t)n), BF_OK);
    return is_whole(answer);
}

static int begin_download(void)
{
    int fd = client_connect(http_port(server));

    assert_true(client_send(fd, DOWNLOAD));
    return fd;
}

static void assert_body(const bf_buffer *answer, const bf_buffer *expected)
{
    bf_buffer body = join_chunks(answer);

    assert_int_equal(body.n, expected->n);
    assert_memory_equal(body.bytes, expected->bytes, body.n);
    buffer_fini(&body);
}

static void a_download_is_the_archive_and_leaves_the_connection_open(void **state)
{
    bf_buffer answer = { 0 };

    serve(FEW, NULL);
    bf_buffer expected = make_archive();
    assert_true(expected.n > FEW * SNAPSHOT_BYTES);
    int fd = begin_download();
    assert_true(read_whole(fd, &answer));
    assert_int_equal(client_status(&answer), 200);
    server_assert_holds(&answer, "\r\nContent-Type: application/zip\r\n");
    assert_body(&answer, &expected);
    answer.n = 0;
    assert_true(client_send(fd, DOWNLOAD));
    assert_true(read_whole(fd, &answer));
    assert_body(&answer, &expected);
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
    buffer_fini(&expected);
}

// An HTTP/1.0 client knows no chunks: the end of the connection is that of the body.
static void a_download_ends_the_connection_of_an_old_client(void **state)
{
    bf_buffer answer = { 0 };

    serve(FEW, NULL);
    bf_buffer expected = make_archive();
    int fd = client_connect(http_port(server));
    assert_true(client_send(fd, "GET " RESULTS " HTTP/1.0\r\n" HOST "\r\n"));
    assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
    const char *body = strstr(answer.bytes, "\r\n\r\n") + 4;
    assert_int_equal(answer.bytes + answer.n - body, expected.n);
    assert_memory_equal(body, expected.bytes, expected.n);
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
    buffer_fini(&expected);
}

// 40 MB for a client that reads nothing: what was read of the store is what sockets hold (some MB
// here), a piece, and a snapshot.
static void nothing_is_made_ahead_of_a_slow_client(void **state)
{
    bf_buffer answer = { 0 };

    serve(MANY, NULL);
    int fd = begin_download();
    assert_true(client_read_until(fd, &answer, "PK", HELPER_PATIENCE_MS));
    wait_until_quiet();
    assert_true(reads_so_far() < MANY / 2);
    assert_true(read_whole(fd, &answer));
    assert_int_equal(reads_so_far(), MANY);
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

static void head_of_a_download_makes_nothing(void **state)
{
    bf_buffer answer = { 0 };

    serve(FEW, NULL);
    assert_int_equal(
        client_ask(http_port(server), "HEAD " RESULTS " HTTP/1.1\r\n" HOST "\r\n", &answer), 200);
    server_assert_holds(&answer, "\r\nContent-Type: application/zip");
    assert_null(strstr(answer.bytes, "Content-Length"));
    assert_memory_equal(answer.bytes + answer.n - 4, "\r\n\r\n", 4);
    assert_int_equal(reads_so_far(), 0);
    buffer_fini(&answer);
}

// Without the last chunk the client knows that this is not the end.
static void a_download_that_the_store_fails_is_torn_off(void **state)
{
    bf_buffer answer = { 0 };

    serve(MANY, NULL);
    int fd = begin_download();
    assert_true(client_read_until(fd, &answer, "PK", HELPER_PATIENCE_MS));
    lock_acquire(&server_services.lock);
    server_services.is_broken = true;
    lock_release(&server_services.lock);
    assert_false(read_whole(fd, &answer));
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

static void allow_one(http_options *options)
{
    options->download_limit = 1;
}

static void one_too_many_is_refused_until_another_client_leaves(void **state)
{
    int64_t deadline_ms = clock_monotonic_ms() + HELPER_PATIENCE_MS;
    bf_buffer answer = { 0 };
    int status;

    serve(MANY, allow_one);
    int first = begin_download();
    assert_true(client_read_until(first, &answer, "PK", HELPER_PATIENCE_MS));
    answer.n = 0;
    int second = begin_download();
    assert_true(client_read_until(second, &answer, "\r\n\r\n", HELPER_PATIENCE_MS));
    assert_int_equal(client_status(&answer), 503);
    server_assert_holds(&answer, "\r\nRetry-After: ");
    assert_int_equal(close(second), 0);
    assert_int_equal(close(first), 0);
    do {
        answer.n = 0;
        second = begin_download();
        assert_true(client_read_until(second, &answer, "\r\n\r\n", HELPER_PATIENCE_MS));
        status = client_status(&answer);
        assert_int_equal(close(second), 0);
    } while (status == 503 && clock_monotonic_ms() < deadline_ms);
    assert_int_equal(status, 200);
    buffer_fini(&answer);
}

static void allow_eight(http_options *options)
{
    options->download_limit = 8;
    options->trusted_proxies = "127.0.0.1";
}

static int begin_download_for(const char *client)
{
    char text[200];
    int fd = client_connect(http_port(server));

    snprintf(text, sizeof text,
             "GET /v1/runs/" FAKE_RUN "/results.zip HTTP/1.1\r\n" HOST
             "X-Forwarded-For: %s\r\n\r\n",
             client);
    assert_true(client_send(fd, text));
    return fd;
}

// The third of one client, whose first two are not read to their ends, is refused; another client begins one.
static void slow_readers_of_one_client_leave_downloads_to_others(void **state)
{
    static const struct {
        const char *client;
        int status;
    } asked[] = { { "198.51.100.1", 200 },
                  { "198.51.100.1", 200 },
                  { "198.51.100.1", 503 },
                  { "198.51.100.2", 200 } };
    bf_buffer answer = { 0 };
    int fds[4];

    serve(MANY, allow_eight);
    for (size_t k = 0; k < 4; k++) {
        answer.n = 0;
        fds[k] = begin_download_for(asked[k].client);
        assert_true(client_read_until(fds[k], &answer, "\r\n\r\n", HELPER_PATIENCE_MS));
        assert_int_equal(client_status(&answer), asked[k].status);
    }
    for (size_t k = 0; k < 4; k++)
        assert_int_equal(close(fds[k]), 0);
    buffer_fini(&answer);
}

// Two request threads and many downloads: each piece takes its turn.
static void two_request_threads(http_options *options)
{
    options->n_request_threads = 2;
}

// One of many clients, on a thread of its own, where nothing is asserted.
typedef struct client {
    pthread_t thread;
    bf_buffer answer;
    bool is_served;
} client;

static void *download_one(void *context)
{
    client *c = context;
    int fd = begin_download();

    c->is_served = read_whole(fd, &c->answer);
    (void)close(fd);
    return NULL;
}

static void many_downloads_share_few_threads(void **state)
{
    enum { N = 8 };
    client clients[N] = { { .is_served = false } };

    serve(FEW, two_request_threads);
    bf_buffer expected = make_archive();
    for (int i = 0; i < N; i++)
        assert_int_equal(pthread_create(&clients[i].thread, NULL, download_one, &clients[i]), 0);
    for (int i = 0; i < N; i++) {
        assert_int_equal(pthread_join(clients[i].thread, NULL), 0);
        assert_true(clients[i].is_served);
        assert_body(&clients[i].answer, &expected);
        buffer_fini(&clients[i].answer);
    }
    buffer_fini(&expected);
}

// Some wait for their clients, some for a thread; those that stop get no last chunk.
static void stopping_tears_downloads_off(void **state)
{
    enum { N = 8 };
    int fds[N];

    serve(MANY, two_request_threads);
    for (int i = 0; i < N; i++)
        fds[i] = begin_download();
    for (int i = 0; i < N; i += 2) {
        bf_buffer answer = { 0 };
        assert_true(client_read_until(fds[i], &answer, "PK", HELPER_PATIENCE_MS));
        buffer_fini(&answer);
    }
    int64_t start_ms = clock_monotonic_ms();
    server = http_stop(server);
    assert_true(clock_monotonic_ms() - start_ms < 10000);
    for (int i = 0; i < N; i++) {
        bf_buffer answer = { 0 };
        assert_false(read_whole(fds[i], &answer));
        assert_int_equal(close(fds[i]), 0);
        buffer_fini(&answer);
    }
}

#define SERVER_TEST(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        SERVER_TEST(a_download_is_the_archive_and_leaves_the_connection_open),
        SERVER_TEST(a_download_ends_the_connection_of_an_old_client),
        SERVER_TEST(nothing_is_made_ahead_of_a_slow_client),
        SERVER_TEST(head_of_a_download_makes_nothing),
        SERVER_TEST(a_download_that_the_store_fails_is_torn_off),
        SERVER_TEST(one_too_many_is_refused_until_another_client_leaves),
        SERVER_TEST(slow_readers_of_one_client_leave_downloads_to_others),
        SERVER_TEST(many_downloads_share_few_threads),
        SERVER_TEST(stopping_tears_downloads_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
