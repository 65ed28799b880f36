#include "server/daemon/service.h"

#include "server/base/clock.h"
#include "server/base/metrics.h"

#include <time.h>

// Between the moment when the store has made a run running and the supervisor knows its child, and
// again when it ends, the two see it differently. Such a request is tried again for a while.
enum { RETRY_MS = 20, RETRIES = 100 };

static void pause_before_retry(void)
{
    const struct timespec pause = { .tv_nsec = RETRY_MS * 1000000L };
    (void)nanosleep(&pause, NULL);
}

static bf_status refuse_draining(bf_error *err)
{
    return bf_fail(err, BF_EBUSY, "", "the daemon is stopping");
}

static bf_status submit(void *context, const api_submission *submission,
                        api_acceptance *ret_acceptance, bf_error *err)
{
    service *s = context;

    if (atomic_load(&s->is_draining))
        return refuse_draining(err);
    bf_status status = store_submit(s->store, submission, ret_acceptance, err);
    if (status == BF_OK)
        supervisor_wake(s->supervisor);
    return status;
}

static bf_status find(void *context, const char *id, api_run *ret_run, bf_error *err)
{
    return store_find(((service *)context)->store, id, ret_run, err);
}

static bf_status list(void *context, const api_list_query *query, api_run_list *ret_list,
                      bf_error *err)
{
    return store_list(((service *)context)->store, query, ret_list, err);
}

// The revision is compared when the run is first found; what this call itself changes is no reason to refuse.
static bf_status cancel(void *context, const char *id, uint64_t revision, api_run *ret_run,
                        bf_error *err)
{
    service *s = context;
    api_run found;

    for (int i = 0; i < RETRIES; i++) {
        bf_status status = store_cancel(s->store, id, revision, &found, err);
        if (status == BF_OK && found.state == RUN_RUNNING)
            status = supervisor_cancel(s->supervisor, id, NULL);
        else if (status != BF_OK)
            return status;
        if (status == BF_OK) {
            *ret_run = found;
            return BF_OK;
        }
        revision = API_ANY_REVISION;
        pause_before_retry();
    }
    return bf_fail(err, BF_EBUSY, "", "run %s cannot be stopped at the moment", id);
}

static bf_status remove_run(void *context, const char *id, uint64_t revision, bf_error *err)
{
    service *s = context;

    for (int i = 0; i < RETRIES; i++) {
        bf_status status = store_remove(s->store, id, revision, err);
        if (status != BF_ECONFLICT)
            return status;
        revision = API_ANY_REVISION;
        status = supervisor_kill(s->supervisor, id, err);
        if (status != BF_OK)
            return status;
        if (i > 0)
            pause_before_retry();
    }
    return bf_fail(err, BF_EBUSY, "", "run %s cannot be removed at the moment", id);
}

static bf_status read_text(void *context, const char *id, api_text which, bf_buffer *out,
                           bf_error *err)
{
    return store_read_text(((service *)context)->store, id, which, out, err);
}

static bf_status read_curve(void *context, const char *id, uint64_t first, api_curve *ret_curve,
                            bf_error *err)
{
    return store_read_curve(((service *)context)->store, id, first, ret_curve, err);
}

static bf_status list_snapshots(void *context, const char *id, api_snapshot_list *ret_list,
                                bf_error *err)
{
    return store_list_snapshots(((service *)context)->store, id, ret_list, err);
}

static bf_status read_snapshot(void *context, const char *id, uint64_t index,
                               api_snapshot *ret_snapshot, bf_grid *ret_grid, bf_buffer *out,
                               bf_error *err)
{
    return store_read_snapshot(((service *)context)->store, id, index, ret_snapshot, ret_grid, out,
                               err);
}

static bf_status read_parts(void *context, const char *id, uint64_t index,
                            api_snapshot *ret_snapshot, api_parts *ret_parts, bf_buffer *out,
                            bf_error *err)
{
    return store_read_parts(((service *)context)->store, id, index, ret_snapshot, ret_parts, out,
                            err);
}

static bf_status read_events(void *context, const char (*runs)[API_ID_SIZE], size_t n_runs,
                             uint64_t after, size_t limit_bytes, api_event_take *take,
                             void *take_context, bf_error *err)
{
    return store_read_events(((service *)context)->store, runs, n_runs, after, limit_bytes, take,
                             take_context, err);
}

static bf_status add_measurement(void *context, const api_measurement *measurement,
                                 const api_curve *curve, api_measurement *ret_measurement,
                                 bf_error *err)
{
    return store_add_measurement(((service *)context)->store, measurement, curve, ret_measurement,
                                 err);
}

static bf_status find_measurement(void *context, const char *id, api_measurement *ret_measurement,
                                  bf_error *err)
{
    return store_find_measurement(((service *)context)->store, id, ret_measurement, err);
}

static bf_status list_measurements(void *context, const api_measurement_query *query,
                                   api_measurement_list *ret_list, bf_error *err)
{
    return store_list_measurements(((service *)context)->store, query, ret_list, err);
}

static bf_status read_measurement(void *context, const char *id, api_curve *ret_curve,
                                  bf_error *err)
{
    return store_read_measurement(((service *)context)->store, id, ret_curve, err);
}

static bf_status remove_measurement(void *context, const char *id, bf_error *err)
{
    return store_remove_measurement(((service *)context)->store, id, err);
}

static bf_status ready(void *context, bf_error *err)
{
    service *s = context;

    if (atomic_load(&s->is_draining))
        return refuse_draining(err);
    return store_ready(s->store, err);
}

static void read_figures(service *s)
{
    store_figures figures;

    store_read_figures(s->store, &figures);
    int64_t oldest_ms = figures.oldest_queued_ms;
    int64_t age_ms = oldest_ms == 0 ? 0 : clock_unix_ms() - oldest_ms;
    for (size_t state = 0; state < RUN_STATE_COUNT; state++)
        metrics_set(METRICS_RUNS, state, (int64_t)figures.n_runs[state]);
    metrics_set(METRICS_QUEUE_LENGTH, 0, (int64_t)figures.n_runs[RUN_QUEUED]);
    metrics_set(METRICS_QUEUE_AGE, 0, age_ms > 0 ? age_ms * 1000000 : 0);
    metrics_set(METRICS_STORE_SIZE, 0, (int64_t)figures.file_bytes);
    metrics_set(METRICS_STORE_LOG_SIZE, 0, (int64_t)figures.log_bytes);
}

static bf_status write_metrics(void *context, bf_buffer *out, bf_error *err)
{
    read_figures(context);
    metrics_read_process();
    return metrics_write(out, err);
}

api_services service_table(service *s)
{
    return (api_services){ .context = s,
                           .submit = submit,
                           .find = find,
                           .list = list,
                           .cancel = cancel,
                           .remove = remove_run,
                           .read_text = read_text,
                           .read_curve = read_curve,
                           .list_snapshots = list_snapshots,
                           .read_snapshot = read_snapshot,
                           .read_parts = read_parts,
                           .read_events = read_events,
                           .add_measurement = add_measurement,
                           .find_measurement = find_measurement,
                           .list_measurements = list_measurements,
                           .read_measurement = read_measurement,
                           .remove_measurement = remove_measurement,
                           .ready = ready,
                           .metrics = write_metrics };
}

void service_drain(service *s)
{
    atomic_store(&s->is_draining, true);
}
