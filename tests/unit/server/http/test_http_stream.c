// Tests of event streams over HTTP: no event is lost, no wake-up is missed, all of them stop.

#include "server/http/http.h"

#include "server/base/clock.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_server.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define HOST   "Host: a\r\n"
#define EVENTS "/v1/runs/" FAKE_RUN "/events"
#define STREAM "GET " EVENTS " HTTP/1.1\r\n" HOST "\r\n"
#define LIVEZ  "GET /livez HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n"
#define LIST   "GET /v1/runs HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n"

// Opens a stream and waits for its first bytes.
static int open_stream(bf_buffer *answer)
{
    int fd = client_connect(http_port(server));

    assert_true(client_send(fd, STREAM));
    assert_true(client_read_until(fd, answer, "retry: 3000\n\n", HELPER_PATIENCE_MS));
    assert_int_equal(client_status(answer), 200);
    return fd;
}

static unsigned count_reads(void)
{
    lock_acquire(&server_services.lock);
    unsigned n = server_services.n_reads;
    lock_release(&server_services.lock);
    return n;
}

// Each stream reads twice before it sleeps: its first events, and once more, lest one came meanwhile.
static void wait_until_asleep(unsigned n_before, unsigned n_streams)
{
    HELPER_AWAIT(count_reads() - n_before >= 2 * n_streams);
}

static void a_stream_tells_what_happens_when_it_happens(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = open_stream(&answer);
    assert_non_null(strstr(answer.bytes, "\r\nContent-Type: text/event-stream"));
    assert_non_null(strstr(answer.bytes, "\r\nCache-Control: no-store\r\n"));
    assert_non_null(strstr(answer.bytes, "\r\nX-Accel-Buffering: no\r\n"));
    assert_non_null(strstr(answer.bytes, "\r\nX-Content-Type-Options: nosniff\r\n"));
    for (int k = 1; k <= 20; k++) {
        char event[64];
        if (k % 4 == 0)
            (void)usleep(50000); // in which it falls asleep
        server_append(k == 20);
        (void)snprintf(event, sizeof event, "id: %d\nevent: %s\ndata: {\"k\":%d}\n\n", k,
                       k == 20 ? "end" : "progress", k);
        assert_true(client_read_until(fd, &answer, event, HELPER_PATIENCE_MS));
    }
    assert_true(client_read_until(fd, &answer, "\r\n0\r\n\r\n", HELPER_PATIENCE_MS));
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

// The body of a GET has no known length, so Content-Length: 0 would be wrong.
static void head_of_a_stream_has_its_headers_and_no_length(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    assert_int_equal(
        client_ask(http_port(server), "HEAD " EVENTS " HTTP/1.1\r\n" HOST "\r\n", &answer), 200);
    server_assert_holds(&answer, "\r\nContent-Type: text/event-stream");
    assert_null(strstr(answer.bytes, "Content-Length"));
    assert_memory_equal(answer.bytes + answer.n - 4, "\r\n\r\n", 4);
    assert_ptr_equal(strstr(answer.bytes, "\r\n\r\n"), answer.bytes + answer.n - 4);
    buffer_fini(&answer);
}

// Without the last chunk the client knows that this is not the end.
static void a_stream_that_the_store_fails_is_torn_off(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = open_stream(&answer);
    lock_acquire(&server_services.lock);
    server_services.is_broken = true;
    lock_release(&server_services.lock);
    server_append(false);
    assert_true(client_read_all(fd, &answer, HELPER_PATIENCE_MS));
    assert_null(strstr(answer.bytes, "\r\n0\r\n\r\n"));
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

static void a_notice_of_another_run_wakes_nobody(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = open_stream(&answer);
    wait_until_asleep(0, 1);
    for (int i = 0; i < 100; i++)
        http_notify(server, "ffffffff-89ab-7cde-8f01-23456789abcd");
    (void)usleep(100000); // in which it could read
    assert_int_equal(count_reads(), 2);
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

enum { N_EVENTS = HELPER_AMOUNT(20000, 4000), N_WRITERS = 2, N_READERS = 6 };

// Appends its share of the log, at moments that fall before, into and after the readers' reading.
static void *write_log(void *context)
{
    unsigned seed = *(const unsigned *)context;

    for (int k = 0; k < N_EVENTS / N_WRITERS; k++) {
        server_append(false);
        int pause = rand_r(&seed) % 64;
        if (pause == 0)
            (void)usleep(100);
        else if (pause < 8)
            (void)nanosleep(&(struct timespec){ .tv_nsec = pause * 1000 }, NULL);
    }
    return NULL;
}

// Reads a stream to its end (HTTP/1.0: no chunks) and checks that every event is there, once.
static void *read_log(void *context)
{
    const char *at;
    bf_buffer answer = { 0 };
    long n = 0;
    int fd = *(const int *)context;

    if (client_read_until(fd, &answer, "event: end\n", HELPER_PATIENCE_MS) &&
        client_read_all(fd, &answer, HELPER_PATIENCE_MS)) {
        at = strstr(answer.bytes, "\r\n\r\n");
        while (at != NULL && (at = strstr(at, "\nid: ")) != NULL) {
            long id = strtol(at + 5, NULL, 10);
            if (id != n + 1)
                break;
            n = id;
            at++;
        }
    }
    buffer_fini(&answer);
    return n == N_EVENTS + 1 ? context : NULL;
}

// A lost wake-up would leave a reader asleep with events before it: there is no heartbeat here.
static void a_stream_that_is_notified_at_any_moment_misses_nothing(void **state)
{
    pthread_t writers[N_WRITERS], readers[N_READERS];
    unsigned seeds[N_WRITERS] = { 1, 2 };
    int fds[N_READERS], n_good = 0;
    void *good;

    server = fake_serve(&server_services, NULL);
    for (int i = 0; i < N_READERS; i++) {
        fds[i] = client_connect(http_port(server));
        assert_true(client_send(fds[i], "GET " EVENTS " HTTP/1.0\r\n\r\n"));
        assert_int_equal(pthread_create(&readers[i], NULL, read_log, &fds[i]), 0);
    }
    for (int i = 0; i < N_WRITERS; i++)
        assert_int_equal(pthread_create(&writers[i], NULL, write_log, &seeds[i]), 0);
    for (int i = 0; i < N_WRITERS; i++)
        assert_int_equal(pthread_join(writers[i], NULL), 0);
    server_append(true);
    for (int i = 0; i < N_READERS; i++) {
        assert_int_equal(pthread_join(readers[i], &good), 0);
        n_good += good != NULL;
        assert_int_equal(close(fds[i]), 0);
    }
    assert_int_equal(n_good, N_READERS);
}

enum { N_LATE = HELPER_AMOUNT(1000, 200) };

// Appends an event at the worst moment: the reader has looked at the store, has found nothing new,
// and is about to sleep.
static void append_late(void)
{
    lock_acquire(&server_services.lock);
    uint64_t n = server_services.n_events;
    lock_release(&server_services.lock);
    if (n <= N_LATE)
        server_append(n == N_LATE);
}

static void an_event_between_the_last_look_and_the_sleep_is_not_missed(void **state)
{
    bf_buffer answer = { 0 };
    char event[64];

    server = fake_serve(&server_services, NULL);
    int fd = open_stream(&answer);
    wait_until_asleep(0, 1);
    lock_acquire(&server_services.lock);
    server_services.after_look = append_late;
    lock_release(&server_services.lock);
    server_append(false);
    (void)snprintf(event, sizeof event, "event: end\ndata: {\"k\":%d}\n\n", N_LATE + 1);
    assert_true(client_read_until(fd, &answer, event, HELPER_PATIENCE_MS));
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

// After each event all readers are asleep, so each round needs every wake-up.
static void a_stream_that_sleeps_is_woken_every_time(void **state)
{
    enum { ROUNDS = HELPER_AMOUNT(2000, 400) };
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, NULL);
    int fd = open_stream(&answer);
    for (int k = 1; k <= ROUNDS; k++) {
        char event[64];
        server_append(false);
        (void)snprintf(event, sizeof event, "data: {\"k\":%d}\n\n", k);
        answer.n = 0;
        assert_true(client_read_until(fd, &answer, event, HELPER_PATIENCE_MS));
    }
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

static void slow_heart(http_options *options)
{
    options->heartbeat_ms = 10 * HELPER_PATIENCE_MS;
}

// Those that are not woken sleep until their heartbeat.
static void two_hundred_sleeping_streams_stop_at_once(void **state)
{
    enum { N = 200 };
    int fds[N];

    server = fake_serve(&server_services, slow_heart);
    for (int i = 0; i < N; i++) {
        bf_buffer answer = { 0 };
        fds[i] = open_stream(&answer);
        buffer_fini(&answer);
    }
    wait_until_asleep(0, N);
    int64_t start_ms = clock_monotonic_ms();
    server = http_stop(server);
    assert_true(clock_monotonic_ms() - start_ms < HELPER_PATIENCE_MS);
    for (int i = 0; i < N; i++) {
        bf_buffer answer = { 0 };
        assert_true(client_read_all(fds[i], &answer, HELPER_PATIENCE_MS));
        assert_int_equal(answer.n, 5);
        assert_memory_equal(answer.bytes, "0\r\n\r\n", 5);
        assert_int_equal(close(fds[i]), 0);
        buffer_fini(&answer);
    }
}

// The server is stopped while its streams are written, woken and put to sleep; the notices must end
// before, as the daemon sees to.
static void streams_under_way_stop_too(void **state)
{
    enum { N = 20, ROUNDS = 10 };

    for (int round = 0; round < ROUNDS; round++) {
        server_writer writer;
        int fds[N];
        server = fake_serve(&server_services, NULL);
        for (int i = 0; i < N; i++) {
            fds[i] = client_connect(http_port(server));
            assert_true(client_send(fds[i], STREAM));
        }
        server_writer_start(&writer);
        (void)usleep(1000U * (unsigned)(round * 5));
        server_writer_end(&writer);
        server = http_stop(server);
        for (int i = 0; i < N; i++)
            assert_int_equal(close(fds[i]), 0);
    }
}

static void one_stream(http_options *options)
{
    options->stream_limit = 1;
}

static void beyond_the_limit_a_stream_is_refused(void **state)
{
    bf_buffer answer = { 0 }, refusal = { 0 };

    server = fake_serve(&server_services, one_stream);
    int fd = open_stream(&answer);
    assert_int_equal(client_ask(http_port(server),
                                "GET " EVENTS " HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n",
                                &refusal),
                     503);
    assert_non_null(strstr(refusal.bytes, "\r\nRetry-After: "));
    assert_non_null(strstr(refusal.bytes, "application/problem+json"));
    assert_int_equal(client_ask(http_port(server),
                                "HEAD " EVENTS " HTTP/1.1\r\n" HOST "Connection: close\r\n\r\n",
                                &refusal),
                     200);
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
    buffer_fini(&refusal);
}

// A client that left makes room for another although nothing happens on the stream.
static void a_client_that_leaves_is_noticed(void **state)
{
    server = fake_serve(&server_services, one_stream);
    for (int i = 0; i < 3; i++) {
        bf_buffer answer = { 0 };
        int64_t start_ms = clock_monotonic_ms();
        int status = 503;
        while (status == 503 && clock_monotonic_ms() - start_ms < HELPER_PATIENCE_MS) {
            const unsigned n_before = count_reads();
            int fd = client_connect(http_port(server));
            assert_true(client_send(fd, STREAM));
            answer.n = 0;
            assert_true(client_read_until(fd, &answer, "\r\n\r\n", HELPER_PATIENCE_MS));
            status = client_status(&answer);
            if (status == 200)
                wait_until_asleep(n_before, 1);
            assert_int_equal(close(fd), 0);
        }
        assert_int_equal(status, 200);
        buffer_fini(&answer);
    }
}

static void quick_heart(http_options *options)
{
    options->heartbeat_ms = 200;
}

static void an_idle_stream_has_a_heartbeat(void **state)
{
    bf_buffer answer = { 0 };

    server = fake_serve(&server_services, quick_heart);
    int64_t start_ms = clock_monotonic_ms();
    int fd = open_stream(&answer);
    for (int i = 0; i < 3; i++) {
        answer.n = 0;
        assert_true(client_read_until(fd, &answer, "\r\n:\n\n\r\n", HELPER_PATIENCE_MS));
    }
    assert_true(clock_monotonic_ms() - start_ms >= 550);
    server_append(false);
    assert_true(client_read_until(fd, &answer, "data: {\"k\":1}\n\n", HELPER_PATIENCE_MS));
    assert_int_equal(close(fd), 0);
    buffer_fini(&answer);
}

// A client that does not read holds one batch and no more: the log may grow without it.
static void a_client_that_does_not_read_disturbs_nobody(void **state)
{
    enum { N = 200000 };
    bf_buffer lazy = { 0 }, answer = { 0 };
    char event[64];

    server = fake_serve(&server_services, NULL);
    int lazy_fd = open_stream(&lazy);
    int fd = open_stream(&answer);
    lock_acquire(&server_services.lock);
    server_services.n_events = N;
    lock_release(&server_services.lock);
    http_notify(server, FAKE_RUN);
    (void)snprintf(event, sizeof event, "data: {\"k\":%d}\n\n", N);
    assert_true(client_read_until(fd, &answer, event, HELPER_PATIENCE_MS));
    server_append(false);
    (void)snprintf(event, sizeof event, "data: {\"k\":%d}\n\n", N + 1);
    answer.n = 0;
    assert_true(client_read_until(fd, &answer, event, HELPER_PATIENCE_MS));
    assert_true(client_read_until(lazy_fd, &lazy, event, HELPER_PATIENCE_MS));
    assert_int_equal(close(fd), 0);
    assert_int_equal(close(lazy_fd), 0);
    buffer_fini(&answer);
    buffer_fini(&lazy);
}

// More streams than there are threads read a store that does not answer; connections are served by two
// threads, which must not be among those that wait.
static void a_store_that_stalls_stops_streams_and_nothing_else(void **state)
{
    enum { N = 20, N_REQUEST_THREADS = 4 };
    int fds[N];

    server = fake_serve(&server_services, NULL);
    fake_hold(&server_services, FAKE_HELD_EVENTS);
    for (int i = 0; i < N; i++) {
        fds[i] = client_connect(http_port(server));
        assert_true(client_send(fds[i], STREAM));
    }
    assert_true(fake_wait_for_held(&server_services, 1));
    for (int i = 0; i < 3; i++) {
        server_await_sign_of_life();
        for (int k = 0; k < 4; k++) { // of each thread that serves connections
            assert_int_equal(client_ask(http_port(server), LIVEZ, NULL), 200);
            assert_int_equal(client_ask(http_port(server), LIST, NULL), 200);
        }
    }
    fake_hold(&server_services, FAKE_HELD_NONE);
    server_append(true);
    for (int i = 0; i < N; i++) {
        bf_buffer answer = { 0 };
        assert_true(client_read_until(fds[i], &answer, "event: end\n", HELPER_PATIENCE_MS));
        assert_int_equal(close(fds[i]), 0);
        buffer_fini(&answer);
    }
}

// Long requests hold all request threads that they may; events are sent nevertheless.
static void long_requests_do_not_delay_streams(void **state)
{
    enum { N_REQUEST_THREADS = 4, N = 2 * N_REQUEST_THREADS };
    bf_buffer answer = { 0 };
    int fds[N];

    server = fake_serve(&server_services, NULL);
    int fd = open_stream(&answer);
    fake_hold(&server_services, FAKE_HELD_LIST);
    for (int i = 0; i < N; i++) {
        fds[i] = client_connect(http_port(server));
        assert_true(client_send(fds[i], LIST));
    }
    assert_true(fake_wait_for_held(&server_services, N_REQUEST_THREADS));
    server_append(false);
    assert_true(client_read_until(fd, &answer, "data: {\"k\":1}\n\n", HELPER_PATIENCE_MS));
    assert_int_equal(close(fd), 0);
    fake_hold(&server_services, FAKE_HELD_NONE);
    for (int i = 0; i < N; i++)
        assert_int_equal(close(fds[i]), 0);
    buffer_fini(&answer);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, server_set_up, server_tear_down)
    const struct CMUnitTest tests[] = {
        CASE(a_stream_tells_what_happens_when_it_happens),
        CASE(head_of_a_stream_has_its_headers_and_no_length),
        CASE(a_stream_that_the_store_fails_is_torn_off),
        CASE(a_notice_of_another_run_wakes_nobody),
        CASE(a_stream_that_is_notified_at_any_moment_misses_nothing),
        CASE(an_event_between_the_last_look_and_the_sleep_is_not_missed),
        CASE(a_stream_that_sleeps_is_woken_every_time),
        CASE(two_hundred_sleeping_streams_stop_at_once),
        CASE(streams_under_way_stop_too),
        CASE(beyond_the_limit_a_stream_is_refused),
        CASE(a_client_that_leaves_is_noticed),
        CASE(an_idle_stream_has_a_heartbeat),
        CASE(a_client_that_does_not_read_disturbs_nobody),
        CASE(a_store_that_stalls_stops_streams_and_nothing_else),
        CASE(long_requests_do_not_delay_streams),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
