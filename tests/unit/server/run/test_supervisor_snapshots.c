// Tests of the supervisor, with a real store, against jobs that send snapshots in slices.

#include "tests/unit/server/helper_executor.h"
#include "tests/unit/server/helper_store.h"
#include "tests/unit/server/helper_supervisor.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

// Sanitizers take memory of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
enum { ROWS = 400, PEAK_KB = INT32_MAX };
#else
enum { ROWS = 4000, PEAK_KB = 40000 };
#endif

enum { COLUMNS = 5000, UNREAD_MAX = 1024 * 1024 };

static const char belt[] = "{\"duration_s\":1,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"
                           "\"cargo\":{},\"initial\":{\"positions_m\":[[0.5,0.3]]},"
                           "\"macro\":{\"cell_m\":0.02,\"step_s\":\"auto\"}}";

// A world whose supervisor has an executor of ours.
typedef struct fixture {
    helper_world *world;
    helper_executor *executor;
    helper_store file; // of the world, to look into
} fixture;

static int setup(void **state)
{
    static fixture f;
    void *world;

    assert_int_equal(helper_world_setup(&world), 0);
    f.world = world;
    f.executor = helper_executor_create();
    f.world->options.executor = helper_executor_base(f.executor);
    const int n =
        snprintf(f.file.directory, sizeof f.file.directory, "%.50s/store", f.world->directory);
    assert_true(n > 0 && n < 56);
    helper_supervise(f.world);
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    fixture *f = *state;
    void *world = f->world;

    int code = helper_world_teardown(&world);
    helper_executor_destroy(f->executor);
    return code;
}

// The job of the next run.
static api_run start_job(fixture *f, size_t index)
{
    const api_run record = helper_world_submit(f->world, belt);

    helper_executor_await(f->executor, index + 1);
    return record;
}

static long read_peak_kb(void)
{
    FILE *file = fopen("/proc/self/status", "re");
    char line[200];
    long kb = -1;

    assert_non_null(file);
    while (fgets(line, sizeof line, file) != NULL)
        (void)sscanf(line, "VmHWM: %ld", &kb);
    fclose(file);
    assert_true(kb > 0);
    return kb;
}

static void send_slice(helper_executor *e, size_t index, frame_slice slice)
{
    const frame f = { .type = FRAME_SLICE, .slice = slice };

    helper_executor_send(e, index, &f);
}

// As a pipe does that is full.
static void send_when_read(helper_executor *e, const frame_slice *slice)
{
    while (helper_executor_job(e, 0).n_unread > UNREAD_MAX)
        usleep(500);
    send_slice(e, 0, *slice);
}

// 20 million cells are 80 MB.
static void a_snapshot_of_any_size_takes_little_memory(void **state)
{
    static const char zeros[FRAME_SLICE_BYTES] = { 0 };
    const uint64_t n = (uint64_t)ROWS * COLUMNS * sizeof(float);
    const frame begin = { .type = FRAME_BEGIN,
                          .begin = { .n_columns = 2,
                                     .n_steps = 10,
                                     .grid = { .n1 = COLUMNS, .n2 = ROWS, .d1 = 1, .d2 = 1 } } };
    const frame end = { .type = FRAME_SNAPSHOT, .snapshot = { .n1 = COLUMNS, .n2 = ROWS } };
    bf_buffer bytes = { 0 };
    fixture *f = *state;
    api_array got;
    api_slices array;

    const api_run record = start_job(f, 0);
    const long before_kb = read_peak_kb();
    helper_executor_send(f->executor, 0, &begin);
    for (uint64_t at = 0; at < n; at += FRAME_SLICE_BYTES) {
        const uint64_t left = n - at;
        send_when_read(f->executor, &(frame_slice){ .of = FRAME_SNAPSHOT,
                                                    .at = at,
                                                    .n = left < sizeof zeros ? left : sizeof zeros,
                                                    .bytes = zeros });
    }
    assert_int_equal(frame_encode(&end, &bytes, NULL), BF_OK);
    helper_executor_send_bytes(f->executor, 0, bytes.bytes, bytes.n);
    buffer_fini(&bytes);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    assert_true(read_peak_kb() - before_kb < PEAK_KB);
    assert_int_equal(
        store_open_array(f->world->store, record.id, 0, API_ARRAY_DENSITY, &got, &array, NULL),
        BF_OK);
    assert_int_equal(array.n, n);
    api_slices_fini(&array);
}

// The belt of helper_executor_begin() has 32 bytes.
static void slices_that_do_not_follow_fail_their_run(void **state)
{
    static const float rho[16] = { 0 };
    static const frame_slice wrong[][2] = {
        { { .of = FRAME_SNAPSHOT, .at = 8, .n = 24, .bytes = rho } },
        { { .of = FRAME_SNAPSHOT, .n = 36, .bytes = rho } },
        { { .of = FRAME_SNAPSHOT, .n = 0, .bytes = rho } },
        { { .of = FRAME_PARTS, .n = 32, .bytes = rho } },
        { { .of = FRAME_CURVE, .n = 32, .bytes = rho } },
        { { .of = FRAME_SNAPSHOT, .n = 16, .bytes = rho },
          { .of = FRAME_SNAPSHOT, .at = 16, .n = 16, .bytes = rho } },
        { { .of = FRAME_SNAPSHOT, .n = 32, .bytes = rho },
          { .of = FRAME_SNAPSHOT, .n = 32, .bytes = rho } },
    };
    fixture *f = *state;

    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const api_run record = start_job(f, i);
        helper_executor_begin(f->executor, i);
        for (size_t k = 0; k < 2 && wrong[i][k].bytes != NULL; k++)
            send_slice(f->executor, i, wrong[i][k]);
        const bf_error error = helper_await_state(f->world, record.id, RUN_FAILED).error;
        assert_int_equal(error.code, BF_ECORRUPT);
        assert_non_null(strstr(error.text, "the solver sent "));
    }
    assert_int_equal(helper_store_sql(&f->file, "SELECT count(*) FROM chunks"), 0);
}

// Nothing else comes between the slices and their snapshot, which has the index of its slices and all of them.
static void a_snapshot_that_does_not_fit_its_slices_fails_its_run(void **state)
{
    static const float rho[8] = { 0 };
    static const double sample[2] = { 0 };
    static const frame_slice first = { .of = FRAME_SNAPSHOT, .n = 32, .bytes = rho };
    static const frame wrong[] = {
        { .type = FRAME_CURVE, .curve = { .n = 1, .n_columns = 2, .t = sample, .values = sample } },
        { .type = FRAME_SNAPSHOT, .snapshot = { .index = 1, .n1 = 4, .n2 = 2 } },
        { .type = FRAME_SNAPSHOT, .snapshot = { .n1 = 2, .n2 = 4 } },
        { .type = FRAME_SNAPSHOT, .snapshot = { .n1 = 4, .n2 = 2 } }, // without slices
    };
    bf_buffer bytes = { 0 };
    fixture *f = *state;

    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const api_run record = start_job(f, i);
        helper_executor_begin(f->executor, i);
        if (i < 3)
            send_slice(f->executor, i, first);
        bytes.n = 0;
        assert_int_equal(frame_encode(&wrong[i], &bytes, NULL), BF_OK);
        helper_executor_send_bytes(f->executor, i, bytes.bytes, bytes.n);
        const bf_error error = helper_await_state(f->world, record.id, RUN_FAILED).error;
        assert_int_equal(error.code, BF_ECORRUPT);
        assert_non_null(strstr(error.text, "the solver sent "));
    }
    buffer_fini(&bytes);
}

static void a_job_that_is_lost_between_slices_leaves_nothing(void **state)
{
    static const char count[] = "SELECT count(*) FROM chunks";
    static const float rho[8] = { 0 };
    fixture *f = *state;

    const api_run record = start_job(f, 0);
    helper_executor_begin(f->executor, 0);
    send_slice(f->executor, 0,
               (frame_slice){ .of = FRAME_SNAPSHOT, .n = sizeof rho, .bytes = rho });
    helper_await_sql(&f->file, count, 1);
    assert_int_equal(helper_find(f->world->store, record.id).n_snapshots, 0);
    helper_executor_lose(f->executor, 0);
    helper_await_sql(&f->file, count, 0);
    helper_executor_await(f->executor, 2);
    helper_executor_begin(f->executor, 1);
    helper_executor_snapshot(f->executor, 1, 0);
    helper_executor_finish(f->executor, 1, false);
    assert_int_equal(helper_await_state(f->world, record.id, RUN_SUCCEEDED).n_snapshots, 1);
}

// Density and parts come in batches of their own, and are one snapshot.
static void parts_may_come_in_a_later_batch_than_their_snapshot(void **state)
{
    static const double rows[2 * FRAME_VALUES_PLANAR] = { 0.5, 0.25 };
    static const float rho[8] = { 1.0F };
    const frame begin = { .type = FRAME_BEGIN,
                          .begin = { .n_columns = 2,
                                     .n_steps = 10,
                                     .n_parts = 2,
                                     .n_values = FRAME_VALUES_PLANAR,
                                     .grid = { .n1 = 4, .n2 = 2, .d1 = 1, .d2 = 1 } } };
    const frame snapshot = { .type = FRAME_SNAPSHOT, .snapshot = { .n1 = 4, .n2 = 2, .rho = rho } };
    const frame parts = { .type = FRAME_PARTS,
                          .parts = {
                              .n_parts = 2, .n_values = FRAME_VALUES_PLANAR, .rows = rows } };
    api_array got;
    bf_buffer out = { 0 };
    fixture *f = *state;

    const api_run record = start_job(f, 0);
    helper_executor_send(f->executor, 0, &begin);
    helper_executor_send(f->executor, 0, &snapshot);
    helper_await_sql(&f->file, "SELECT count(*) FROM chunks WHERE kind = 0", 1);
    assert_int_equal(helper_find(f->world->store, record.id).n_snapshots, 0);
    helper_executor_send(f->executor, 0, &parts);
    helper_executor_finish(f->executor, 0, false);
    assert_int_equal(helper_await_state(f->world, record.id, RUN_SUCCEEDED).n_snapshots, 1);
    assert_int_equal(
        store_read_array(f->world->store, record.id, 0, API_ARRAY_PARTS, &got, &out, NULL), BF_OK);
    assert_int_equal(out.n, sizeof rows);
    assert_memory_equal(out.bytes, rows, sizeof rows);
    buffer_fini(&out);
}

int main(void)
{
#define TEST(function) cmocka_unit_test_setup_teardown(function, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_snapshot_of_any_size_takes_little_memory), // the first: a peak stays
        TEST(slices_that_do_not_follow_fail_their_run),
        TEST(a_snapshot_that_does_not_fit_its_slices_fails_its_run),
        TEST(a_job_that_is_lost_between_slices_leaves_nothing),
        TEST(parts_may_come_in_a_later_batch_than_their_snapshot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
