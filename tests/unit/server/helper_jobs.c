#include "tests/unit/server/helper_jobs.h"

#include <stdio.h>
#include <string.h>

const char helper_jobs_belt[] = "{\"duration_s\":1,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"
                                "\"cargo\":{},\"initial\":{\"positions_m\":[[0.5,0.3]]},"
                                "\"macro\":{\"cell_m\":0.02,\"step_s\":\"auto\"}}";

int helper_jobs_setup(void **state)
{
    static helper_jobs f;
    void *world;

    assert_int_equal(helper_world_setup(&world), 0);
    f.world = world;
    f.executor = helper_executor_create();
    f.world->options.executor = helper_executor_base(f.executor);
    // So that tests of unresponsive jobs are short.
    f.world->options.stop_grace_ms = 50;
    f.world->options.lost_ms = 50;
    *state = &f;
    return 0;
}

int helper_jobs_teardown(void **state)
{
    helper_jobs *f = *state;
    void *world = f->world;

    int code = helper_world_teardown(&world);
    helper_executor_destroy(f->executor);
    return code;
}

api_run helper_jobs_start(helper_jobs *f)
{
    helper_supervise(f->world);
    api_run record = helper_world_submit(f->world, helper_jobs_belt);
    helper_executor_await(f->executor, 1);
    return helper_await_state(f->world, record.id, RUN_RUNNING);
}

// Samples of an event follow those of the one before.
static bf_status count_samples(void *context, const api_event *event, bf_error *err)
{
    uint64_t *n = context;
    unsigned long long first = 0, count = 0;

    if (event->type != API_EVENT_CURVE)
        return BF_OK;
    const char *at = strstr(event->data, "\"first\":");
    assert_non_null(at);
    assert_int_equal(sscanf(at, "\"first\":%llu", &first), 1);
    at = strstr(event->data, "\"t_s\":[");
    assert_non_null(at);
    for (at += strlen("\"t_s\":"); *at != ']'; at++)
        count += *at == '[' || *at == ',';
    assert_int_equal(first, *n);
    *n += count;
    return BF_OK;
}

void helper_jobs_assert_data(helper_world *w, const char *id, uint64_t n, uint64_t n_snapshots)
{
    api_curve curve = { 0 };
    bf_buffer rho = { 0 };
    api_array got;
    uint64_t n_published = 0;

    assert_int_equal(store_read_curve(w->store, id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    assert_int_equal(curve.t.n, n * sizeof(double));
    for (uint64_t i = 0; i < n; i++) {
        const double *values = (const double *)(const void *)curve.values.bytes + 2 * i;
        assert_true(((const double *)(const void *)curve.t.bytes)[i] == (double)i / 100);
        assert_true(values[0] == (double)i && values[1] == 0.5 * (double)i);
    }
    api_curve_fini(&curve);
    assert_int_equal(store_read_events(w->store, (const char(*)[API_ID_SIZE])id, 1, 0, SIZE_MAX,
                                       count_samples, &n_published, NULL),
                     BF_OK);
    assert_int_equal(n_published, n);
    for (uint64_t i = 0; i < n_snapshots; i++) {
        rho.n = 0;
        assert_int_equal(store_read_array(w->store, id, i, API_ARRAY_DENSITY, &got, &rho, NULL),
                         BF_OK);
        assert_true(((const float *)(const void *)rho.bytes)[7] == (float)i);
    }
    assert_int_equal(
        store_read_array(w->store, id, n_snapshots, API_ARRAY_DENSITY, &got, &rho, NULL),
        BF_ENOTFOUND);
    buffer_fini(&rho);
}
