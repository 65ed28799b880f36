// Unit tests of a store that grows old: a day of runs that come, are streamed and expire, and clocks that jump. The
// system's clock is the test's.

#include "tests/unit/helper_amount.h"
#include "tests/unit/server/helper_store.h"

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/store/backup.h"
#include "tests/unit/helper_cmocka.h"

#include <dlfcn.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum {
    RUNS_PER_HOUR = 60,
    HOURS = HELPER_AMOUNT(24, 8),
    HOURS_OF_GROWTH = 4, // after which nothing grows any more
    RUNS_KEPT = 100,
    SAMPLES = 50,
    LOG_BYTES = 16777216, // journal_size_limit of the store's writer
};

static const int64_t minute_ms = 60000, day_ms = 86400000;

// ------------------------------------------------------------------------ the clock

static _Atomic int64_t ahead_ms; // of the system's clock

// This takes the place of the C library's; waits are by the monotonic clock, which goes on as it does.
int clock_gettime(clockid_t clock, struct timespec *ret_now)
{
    static int (*_Atomic next)(clockid_t, struct timespec *);
    int (*call)(clockid_t, struct timespec *) = atomic_load(&next);

    if (call == NULL) {
        void *const function = dlsym(RTLD_NEXT, "clock_gettime");
        memcpy(&call, &function, sizeof call);
        atomic_store(&next, call);
    }
    const int result = call(clock, ret_now);
    if (clock == CLOCK_REALTIME)
        ret_now->tv_sec += atomic_load(&ahead_ms) / 1000;
    return result;
}

// This takes the place of the C library's: no power is lost here.
int fdatasync(int fd)
{
    (void)fd;
    return 0;
}

// ------------------------------------------------------------------------ a day

static void open_keeping(helper_store *h, uint64_t n_runs)
{
    const store_options options = { .directory = h->directory,
                                    .queue_limit = 100,
                                    .retention = { .n_runs = n_runs },
                                    .retention_interval_ms = 1 };
    bf_error err = { 0 };

    if (h->store != NULL)
        helper_store_close(h);
    if (store_open(&options, &h->store, &err) != BF_OK)
        fail_msg("%s", err.text);
}

static bf_status count_event(void *context, const api_event *event, bf_error *err)
{
    ++*(size_t *)context;
    return BF_OK;
}

// Read the events behind `after`, as a stream does. Returns how many there are.
static size_t stream(store *s, const char *id, uint64_t after)
{
    char ids[1][API_ID_SIZE];
    size_t n = 0;

    memcpy(ids[0], id, API_ID_SIZE);
    assert_int_equal(store_read_events(s, (const char(*)[API_ID_SIZE])ids, 1, after, SIZE_MAX,
                                       count_event, &n, NULL),
                     BF_OK);
    return n;
}

static api_run live(store *s)
{
    const api_run record = helper_start(s);

    helper_append_samples(s, record.id, 0, SAMPLES);
    const uint64_t seen = helper_find(s, record.id).last_event;
    helper_append_samples(s, record.id, SAMPLES, SAMPLES);
    assert_int_equal(stream(s, record.id, seen), 1);
    return helper_finish(s, record.id, RUN_SUCCEEDED);
}

static int64_t size_of(const helper_store *h, const char *suffix)
{
    char path[128];
    struct stat info;

    (void)snprintf(path, sizeof path, "%s/beltflow.db%s", h->directory, suffix);
    assert_int_equal(stat(path, &info), 0);
    return info.st_size;
}

static void assert_is_sound(helper_store *h)
{
    helper_store_close(h);
    helper_store_verify(h);
}

// File and heap are as large at the end of the day as they were in the morning; a tenth is for the moment at which they
// are looked at, 1 MiB for what the allocator and SQLite's page cache keep.
static void a_day_of_runs_leaves_nothing_behind(void **state)
{
    helper_store *h = *state;
    int64_t file = 0, log = 0;
    size_t heap = 0;

    open_keeping(h, RUNS_KEPT);
    for (int hour = 0; hour < HOURS; hour++) {
        for (int i = 0; i < RUNS_PER_HOUR; i++) {
            (void)live(h->store);
            (void)atomic_fetch_add(&ahead_ms, minute_ms);
        }
        const int n_runs = (hour + 1) * RUNS_PER_HOUR;
        helper_await_sql(h, "SELECT count(*) FROM runs", n_runs < RUNS_KEPT ? n_runs : RUNS_KEPT);
        if (hour != HOURS_OF_GROWTH)
            continue;
        file = size_of(h, "");
        log = size_of(h, "-wal");
        heap = mallinfo2().uordblks;
    }
    print_message(
        "after %d and %d hours: file %ld and %ld, log %ld and %ld, heap %zu and %zu bytes\n",
        HOURS_OF_GROWTH + 1, HOURS, (long)file, (long)size_of(h, ""), (long)log,
        (long)size_of(h, "-wal"), heap, mallinfo2().uordblks);
    assert_true(size_of(h, "") <= file + file / 10);
    assert_true(size_of(h, "-wal") <= LOG_BYTES);
    assert_true(mallinfo2().uordblks <= heap + (1 << 20));
    assert_is_sound(h);
}

// ------------------------------------------------------------------------ clocks that jump

static size_t list_ids(store *s, char ids[][API_ID_SIZE])
{
    static api_run_list list;
    const api_list_query query = { .state = -1, .model = -1, .limit = 10 };

    assert_int_equal(store_list(s, &query, &list, NULL), BF_OK);
    for (size_t i = 0; i < list.n; i++)
        memcpy(ids[i], list.runs[i].id, API_ID_SIZE);
    return list.n;
}

// The order of runs and events is that in which they came, whatever the clock said.
static void runs_keep_their_order_when_the_clock_jumps(void **state)
{
    static const int64_t jumps_days[] = { 0, -1, 3650, -7300 };
    enum { N = sizeof jumps_days / sizeof *jumps_days };
    char listed[10][API_ID_SIZE];
    helper_store *h = *state;
    api_run runs[N];

    for (size_t i = 0; i < N; i++) {
        (void)atomic_fetch_add(&ahead_ms, jumps_days[i] * day_ms);
        runs[i] = helper_submit(h->store, "", 0);
    }
    for (int reopened = 0; reopened < 2; reopened++) {
        assert_int_equal(list_ids(h->store, listed), N);
        for (size_t i = 0; i < N; i++)
            assert_string_equal(listed[N - 1 - i], runs[i].id);
        helper_store_close(h);
        helper_store_open(h);
    }
    for (size_t i = 0; i < N; i++) {
        assert_string_equal(helper_claim(h->store).id, runs[i].id);
        helper_append_samples(h->store, runs[i].id, 0, 1);
        (void)atomic_fetch_sub(&ahead_ms, day_ms);
        assert_int_equal(helper_finish(h->store, runs[i].id, RUN_SUCCEEDED).state, RUN_SUCCEEDED);
        assert_true(stream(h->store, runs[i].id, 0) > 0);
    }
    assert_is_sound(h);
}

// A limit of age removes what the clock says is old: nothing when it jumps back, all when it jumps far ahead.
static void age_is_by_the_clock_as_it_is(void **state)
{
    const store_retention a_day = { .age_ms = day_ms };
    char listed[10][API_ID_SIZE];
    helper_store *h = *state;

    open_keeping(h, 0);
    (void)live(h->store);
    (void)atomic_fetch_sub(&ahead_ms, 10 * day_ms);
    store_set_retention(h->store, &a_day);
    (void)live(h->store);
    usleep(50000); // many turns of 1 ms
    assert_int_equal(list_ids(h->store, listed), 2);
    (void)atomic_fetch_add(&ahead_ms, 20 * day_ms);
    helper_await_sql(h, "SELECT count(*) FROM runs", 0);
    assert_is_sound(h);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_day_of_runs_leaves_nothing_behind),
        STORE_TEST(runs_keep_their_order_when_the_clock_jumps),
        STORE_TEST(age_is_by_the_clock_as_it_is),
    };
    log_set_level(LOG_LEVEL_ERROR);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
