#include "server/daemon/service.h"

#include "api/openapi/openapi.h"
#include "server/base/clock.h"
#include "server/base/metrics.h"
#include "server/daemon/grants.h"
#include "server/daemon/owner_figures.h"

#include <math.h>
#include <string.h>

enum { REMOVE_MS = 60000 }; // for a run that is running to end

// A request that waits for a commit of a run; on its caller's stack.
struct service_waiter {
    const char *run_id;
    bool is_notified;
    LIST_ENTRY(service_waiter) entry;
};

static bf_status refuse_draining(bf_error *err)
{
    return bf_fail(err, BF_EBUSY, "", "the daemon is stopping");
}

static api_credential identify(service *s, const char *token, api_identity *ret_who)
{
    return tokens_identify(s->tokens, token, ret_who);
}

static api_credential identify_by_id(service *s, uint64_t token, api_identity *ret_who)
{
    return tokens_identify_by_id(s->tokens, token, ret_who);
}

static void make_ticket(service *s, uint64_t token, api_ticket *ret_ticket)
{
    tickets_make(&s->tickets, token, clock_monotonic_ms(), ret_ticket);
}

static api_credential read_ticket(service *s, const char *ticket, uint64_t *ret_token)
{
    return tickets_read(&s->tickets, ticket, clock_monotonic_ms(), ret_token);
}

static bf_status add_grant(service *s, uint32_t expires_in_s, api_grant *grant, bf_error *err)
{
    return grants_add(s->tokens, expires_in_s, grant, err);
}

static bf_status list_grants(service *s, const char *owner, api_grant_list *ret_list, bf_error *err)
{
    return grants_list(s->tokens, owner, ret_list, err);
}

static bf_status revoke_grant(service *s, const char *owner, uint64_t id, bf_error *err)
{
    return grants_revoke(s->tokens, owner, id, err);
}

static bf_status submit(service *s, const api_submission *submission,
                        api_acceptance *ret_acceptance, bf_error *err)
{
    if (atomic_load(&s->is_draining))
        return refuse_draining(err);
    BF_TRY(store_submit(s->store, submission, ret_acceptance, err));
    supervisor_wake(s->supervisor);
    return BF_OK;
}

// Trials are short, and their study says how it goes.
static void add_prediction(service *s, api_run *record)
{
    if (record->state == RUN_QUEUED && record->study[0] == '\0')
        record->predicted_s = predictor_seconds(s->predictor, record->id, "");
}

static bf_status find(service *s, const char *id, api_run *ret_run, bf_error *err)
{
    const uint64_t n_commits = store_count_commits(s->store);

    if (!run_cache_look(&s->found, id, n_commits, ret_run)) {
        BF_TRY(store_find(s->store, id, ret_run, err));
        run_cache_remember(&s->found, n_commits, ret_run);
    }
    add_prediction(s, ret_run);
    return BF_OK;
}

static bool holds(service *s, const char *id)
{
    return run_cache_look(&s->found, id, store_count_commits(s->store), NULL);
}

static bf_status list(service *s, const api_list_query *query, api_run_list *ret_list,
                      bf_error *err)
{
    BF_TRY(store_list(s->store, query, ret_list, err));
    for (size_t k = 0; k < ret_list->n; k++)
        add_prediction(s, &ret_list->runs[k]);
    return BF_OK;
}

// Wait until a commit has changed the run. False: the deadline has come.
static bool await_commit(service *s, service_waiter *w, int64_t deadline_ms)
{
    lock_acquire(&s->lock);
    while (!w->is_notified && lock_wait(&s->committed, &s->lock, deadline_ms))
        ;
    bool is_notified = w->is_notified;
    w->is_notified = false;
    lock_release(&s->lock);
    return is_notified;
}

// The first attempt requests that a running run stop; it is removed once it has stopped. Only that attempt
// compares the revision, because the run's end, caused by this request, changes it.
static bf_status remove_run(service *s, const char *id, uint64_t revision, bf_error *err)
{
    service_waiter waiter = { .run_id = id };
    int64_t deadline_ms = clock_monotonic_ms() + REMOVE_MS;
    bf_status status;

    lock_acquire(&s->lock);
    LIST_INSERT_HEAD(&s->waiters, &waiter, entry);
    lock_release(&s->lock);
    do {
        status = store_remove(s->store, id, revision, err);
        revision = API_ANY_REVISION;
    } while (status == BF_ECONFLICT && await_commit(s, &waiter, deadline_ms));
    lock_acquire(&s->lock);
    LIST_REMOVE(&waiter, entry);
    lock_release(&s->lock);
    if (status == BF_OK)
        supervisor_wake(s->supervisor); // the owner has room again for runs that were held back
    if (status != BF_ECONFLICT)
        return status;
    return bf_fail(err, BF_EBUSY, "", "run %s cannot be removed at the moment", id);
}

static bf_status submit_study(service *s, const api_study_submission *submission,
                              api_acceptance *ret_acceptance, bf_error *err)
{
    if (atomic_load(&s->is_draining))
        return refuse_draining(err);
    BF_TRY(store_submit_study(s->store, submission, ret_acceptance, err));
    studies_wake(s->studies);
    return BF_OK;
}

static bf_status change_study(service *s, const char *id, uint64_t revision,
                              api_study_change change, api_study *ret_study, bf_error *err)
{
    BF_TRY(store_change_study(s->store, id, revision, change, ret_study, err));
    studies_wake(s->studies);
    return BF_OK;
}

static bf_status remove_study(service *s, const char *id, uint64_t revision, bf_error *err)
{
    BF_TRY(store_remove_study(s->store, id, revision, err));
    studies_wake(s->studies);
    return BF_OK;
}

static bool read_speed(service *s, prediction_speed *ret_speed)
{
    return predictor_speed(s->predictor, ret_speed);
}

static bf_status ready(service *s, bf_error *err)
{
    if (atomic_load(&s->is_draining))
        return refuse_draining(err);
    BF_TRY(store_ready(s->store, err));
    return supervisor_ready(s->supervisor, err);
}

static bf_status write_metrics(service *s, bool with_owners, bf_buffer *out, bf_error *err)
{
    store_stats stats;
    store_read_stats(s->store, &stats);
    int64_t oldest_ms = stats.oldest_queued_ms;
    int64_t age_ms = oldest_ms == 0 ? 0 : clock_unix_ms() - oldest_ms;
    for (size_t state = 0; state < RUN_STATE_COUNT; state++)
        metrics_set(METRICS_RUNS, state, (int64_t)stats.n_runs[state]);
    metrics_set(METRICS_QUEUE_LENGTH, 0, (int64_t)stats.n_runs[RUN_QUEUED]);
    const double queue_s = predictor_queue_seconds(s->predictor, stats.n_runs[RUN_QUEUED]);
    metrics_set(METRICS_QUEUE_PREDICTED, 0, isfinite(queue_s) ? (int64_t)(1e9 * queue_s) : 0);
    metrics_set(METRICS_QUEUE_AGE, 0, age_ms > 0 ? age_ms * 1000000 : 0);
    metrics_set(METRICS_STORE_SIZE, 0, (int64_t)stats.file_bytes);
    metrics_set(METRICS_STORE_LOG_SIZE, 0, (int64_t)stats.log_bytes);
    metrics_set(METRICS_STORE_DISK, 0, (int64_t)stats.free_bytes);
    metrics_read_process();
    bf_status status = metrics_write(out, err);
    return status == BF_OK && with_owners ? owner_figures_write(s->tokens, s->store, out, err)
                                          : status;
}

api_services service_table(service *s)
{
    return (api_services){ .store = s->store,
                           .service = s,
                           .identify = identify,
                           .identify_by_id = identify_by_id,
                           .make_ticket = make_ticket,
                           .read_ticket = read_ticket,
                           .add_grant = add_grant,
                           .list_grants = list_grants,
                           .revoke_grant = revoke_grant,
                           .submit = submit,
                           .read_quotas = store_read_quotas,
                           .find = find,
                           .holds = holds,
                           .list = list,
                           .list_lines = store_list_lines,
                           .cancel = store_cancel,
                           .annotate = store_annotate,
                           .remove = remove_run,
                           .read_text = store_read_text,
                           .read_curve = store_read_curve,
                           .list_snapshots = store_list_snapshots,
                           .read_array = store_read_array,
                           .open_array = store_open_array,
                           .read_slice = store_read_slice,
                           .read_events = store_read_events,
                           .read_changes = store_read_changes,
                           .add_measurement = store_add_measurement,
                           .find_measurement = store_find_measurement,
                           .list_measurements = store_list_measurements,
                           .read_measurement = store_read_measurement,
                           .read_measurement_csv = store_read_measurement_csv,
                           .remove_measurement = store_remove_measurement,
                           .submit_study = submit_study,
                           .find_study = store_find_study,
                           .list_studies = store_list_studies,
                           .change_study = change_study,
                           .annotate_study = store_annotate_study,
                           .remove_study = remove_study,
                           .read_study = store_read_study,
                           .read_trials = store_read_trials,
                           .leases = s->leases,
                           .read_speed = read_speed,
                           .ready = ready,
                           .metrics = write_metrics,
                           .write_openapi = openapi_write };
}

void service_drain(service *s)
{
    atomic_store(&s->is_draining, true);
}

void service_init(service *s)
{
    lock_init(&s->lock);
    lock_condition_init(&s->committed);
    run_cache_init(&s->found);
}

void service_fini(service *s)
{
    run_cache_fini(&s->found);
    lock_condition_fini(&s->committed);
    lock_fini(&s->lock);
}

void service_notify(service *s, const char *run_id)
{
    service_waiter *w;

    lock_acquire(&s->lock);
    LIST_FOREACH(w, &s->waiters, entry)
        if (strcmp(w->run_id, run_id) == 0)
            w->is_notified = true;
    lock_wake_all(&s->committed);
    lock_release(&s->lock);
}
