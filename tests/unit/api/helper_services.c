#include "tests/unit/api/helper_services.h"

#include "api/openapi/openapi.h"
#include "core/base/memory.h"
#include "tests/unit/helper_slices.h"

#include "api/results/run_json.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static helper_run *lookup(helper_daemon *d, const char *id)
{
    for (size_t i = 0; i < d->n_runs; i++) {
        if (strcmp(d->runs[i].record.id, id) == 0)
            return &d->runs[i];
    }
    return NULL;
}

static bf_status no_run(bf_error *err)
{
    return bf_fail(err, BF_ENOTFOUND, "", "there is no such run");
}

static bf_status no_memory(bf_error *err)
{
    return bf_fail(err, BF_ENOMEM, "", "out of memory");
}

static bf_status do_submit(api_service *service, const api_submission *submission,
                           api_acceptance *ret_acceptance, bf_error *err)
{
    helper_daemon *d = (void *)service;

    if (d->refusal != BF_OK)
        return bf_fail(err, d->refusal, "", "the queue is full: 1000 runs wait");
    helper_run *item = helper_add_run(d, RUN_QUEUED);
    api_acceptance accepted = { .revision = item->record.revision, .is_replay = d->is_replay };
    item->record.model = submission->model;
    item->record.priority = submission->priority;
    memcpy(item->record.label, submission->label, sizeof item->record.label);
    memcpy(item->record.name, submission->name, sizeof item->record.name);
    memcpy(accepted.id, item->record.id, sizeof accepted.id);
    if (run_json_write(&item->record, &accepted.answer, err) != BF_OK) {
        buffer_fini(&accepted.answer);
        d->n_runs--;
        return BF_ENOMEM;
    }
    d->submitted = *submission;
    d->n_submitted++;
    *ret_acceptance = accepted;
    return BF_OK;
}

static bf_status do_find(api_service *service, const char *id, api_run *ret_run, bf_error *err)
{
    const helper_run *item = lookup((void *)service, id);

    if (item == NULL)
        return no_run(err);
    *ret_run = item->record;
    ret_run->grid = item->grid;
    ret_run->parts = item->parts;
    return BF_OK;
}

static bool fits(const api_run *record, const api_list_query *query)
{
    return record->id[0] != '\0' && (query->state < 0 || (int)record->state == query->state) &&
           (query->model < 0 || (int)record->model == query->model) &&
           (query->label[0] == '\0' || strcmp(record->label, query->label) == 0) &&
           strcmp(record->study, query->study) == 0 &&
           (query->before[0] == '\0' || strcmp(record->id, query->before) < 0);
}

static bf_status do_list(api_service *service, const api_list_query *query, api_run_list *ret_list,
                         bf_error *err)
{
    helper_daemon *d = (void *)service;

    d->last_query = *query;
    if (d->refusal != BF_OK)
        return bf_fail(err, d->refusal, "", "there is too much to read");
    ret_list->n = 0;
    ret_list->has_more = false;
    ret_list->has_total = query->counts;
    ret_list->total = query->counts ? d->n_runs : 0;
    (void)snprintf(ret_list->last_key, sizeof ret_list->last_key, "%s",
                   d->last_key == NULL ? "" : d->last_key);
    for (size_t i = d->n_runs; i-- > 0;) {
        if (!fits(&d->runs[i].record, query))
            continue;
        if (ret_list->n == query->limit) {
            ret_list->has_more = true;
            break;
        }
        ret_list->runs[ret_list->n++] = d->runs[i].record;
        memcpy(ret_list->last_id, d->runs[i].record.id, sizeof ret_list->last_id);
    }
    return BF_OK;
}

// A line for each run that has one.
static bf_status do_list_lines(api_store *store, const api_page_query *query, api_page *ret_page,
                               bf_error *err)
{
    const helper_daemon *d = (const void *)store;

    ret_page->n = 0;
    ret_page->has_more = false;
    for (size_t i = d->n_runs; i-- > 0 && !ret_page->has_more;) {
        const api_run *record = &d->runs[i].record;
        const bool is_behind = query->before[0] == '\0' || strcmp(record->id, query->before) < 0;
        if (record->line[0] == '\0' || !is_behind)
            continue;
        ret_page->has_more = ret_page->n == query->limit;
        if (ret_page->has_more)
            break;
        api_line *line = &ret_page->lines[ret_page->n++];
        *line = (api_line){ .n_versions = 1, .n_runs = 1, .used_ms = record->created_ms };
        memcpy(line->line, record->line, sizeof line->line);
        memcpy(line->newest_run, record->id, sizeof line->newest_run);
        memcpy(line->newest, record->id, sizeof line->newest);
    }
    return BF_OK;
}

// Another client is faster, if the test wants that: the run changes before its revision is compared.
static bf_status check_revision(helper_daemon *d, helper_run *item, uint64_t expected,
                                bf_error *err)
{
    if (d->n_changes_between > 0) {
        d->n_changes_between--;
        item->record.revision++;
    }
    if (expected == API_ANY_REVISION || expected == item->record.revision)
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "", "the run has another revision");
}

static bf_status do_cancel(api_store *store, const char *id, uint64_t revision, api_run *ret_run,
                           bf_error *err)
{
    helper_run *item = lookup((void *)store, id);

    if (item == NULL)
        return no_run(err);
    bf_status status = check_revision((void *)store, item, revision, err);
    if (status != BF_OK)
        return status;
    if (run_state_is_end(item->record.state))
        return bf_fail(err, BF_ECONFLICT, "", "the run has ended");
    if (item->record.state == RUN_QUEUED)
        item->record.state = RUN_CANCELLED;
    *ret_run = item->record;
    return BF_OK;
}

static bf_status do_annotate(api_store *store, const char *id, uint64_t revision,
                             const api_annotations *annotations, api_run *ret_run, bf_error *err)
{
    helper_run *item = lookup((void *)store, id);

    if (item == NULL)
        return no_run(err);
    bf_status status = check_revision((void *)store, item, revision, err);
    if (status != BF_OK)
        return status;
    memcpy(item->record.name, annotations->name, sizeof item->record.name);
    memcpy(item->record.label, annotations->label, sizeof item->record.label);
    memcpy(item->record.line, annotations->line, sizeof item->record.line);
    memcpy(item->record.notes, annotations->notes, sizeof item->record.notes);
    item->record.is_starred = annotations->is_starred;
    item->record.revision++;
    *ret_run = item->record;
    return BF_OK;
}

static bf_status do_remove(api_service *service, const char *id, uint64_t revision, bf_error *err)
{
    helper_daemon *d = (void *)service;
    helper_run *item = lookup(d, id);
    size_t kept = 0;

    if (item == NULL)
        return no_run(err);
    bf_status status = check_revision(d, item, revision, err);
    if (status != BF_OK)
        return status;
    for (size_t i = 0; i < d->n_events; i++) {
        if (strcmp(d->events[i].run, id) != 0)
            d->events[kept++] = d->events[i];
    }
    d->n_events = kept;
    item->record.id[0] = '\0';
    return BF_OK;
}

static bf_status do_read_text(api_store *store, const char *id, api_text which, bf_buffer *out,
                              bf_error *err)
{
    const helper_run *item = lookup((void *)store, id);

    if (item == NULL)
        return no_run(err);
    const char *const texts[] = { [API_TEXT_SCENARIO] = item->scenario != NULL
                                                            ? item->scenario
                                                            : "{\"duration_s\":6.0}",
                                  [API_TEXT_SUMMARY] = item->summary,
                                  [API_TEXT_FIGURES] = item->figures };
    const char *text = texts[which];
    if (text == NULL)
        return bf_fail(err, BF_ECONFLICT, "", "there is none yet");
    return buffer_append(out, text, strlen(text)) == BF_OK ? BF_OK : no_memory(err);
}

static bf_status do_read_curve(api_store *store, const char *id, uint64_t first, uint64_t n_most,
                               api_curve *ret_curve, bf_error *err)
{
    const helper_run *item = lookup((void *)store, id);
    api_curve curve = { 0 };

    if (item == NULL)
        return no_run(err);
    curve.n = (size_t)(item->record.n_samples - first);
    curve.n = curve.n < n_most ? curve.n : (size_t)n_most;
    curve.n_columns = item->n_columns;
    size_t n_values = curve.n * curve.n_columns;
    if (buffer_append(&curve.columns, item->columns, strlen(item->columns)) != BF_OK ||
        buffer_append(&curve.t, item->t + first, curve.n * sizeof(double)) != BF_OK ||
        buffer_append(&curve.values, item->values + first * curve.n_columns,
                      n_values * sizeof(double)) != BF_OK) {
        api_curve_fini(&curve);
        return no_memory(err);
    }
    *ret_curve = curve;
    return BF_OK;
}

static bf_status do_list_snapshots(api_store *store, const char *id, api_snapshot_list *ret_list,
                                   bf_error *err)
{
    const helper_run *item = lookup((void *)store, id);

    if (item == NULL)
        return no_run(err);
    api_snapshot_list list = { .grid = item->grid,
                               .parts = item->parts,
                               .n = (size_t)item->record.n_snapshots };
    if (buffer_append(&list.items, item->snapshots, list.n * sizeof *item->snapshots) != BF_OK)
        return no_memory(err);
    *ret_list = list;
    return BF_OK;
}

static bf_status do_read_array(api_store *store, const char *id, uint64_t index,
                               api_array_kind kind, api_array *ret_array, bf_buffer *out,
                               bf_error *err)
{
    const helper_run *item = lookup((void *)store, id);
    const size_t n = item == NULL ? 0 : (size_t)item->parts.n_parts * item->parts.n_values;
    const bool is_parts = kind == API_ARRAY_PARTS;

    if (item == NULL || index >= item->record.n_snapshots || (is_parts && n == 0))
        return bf_fail(err, BF_ENOTFOUND, "", "there is no such snapshot");
    if ((!is_parts && buffer_append(out, item->rho[index], sizeof item->rho[index]) != BF_OK) ||
        (is_parts && n <= HELPER_VALUES &&
         buffer_append(out, item->rows, n * sizeof *item->rows) != BF_OK))
        return no_memory(err);
    *ret_array = (api_array){ item->snapshots[index], item->grid, item->parts };
    return BF_OK;
}

static bf_status do_open_array(api_store *store, const char *id, uint64_t index,
                               api_array_kind kind, api_array *ret_array, api_slices *ret_slices,
                               bf_error *err)
{
    bf_buffer *bytes = memory_alloc(1, sizeof *bytes);

    if (bytes == NULL)
        return no_memory(err);
    return helper_slices_open(do_read_array(store, id, index, kind, ret_array, bytes, err), bytes,
                              ret_slices);
}

static bool follows(const char (*runs)[API_ID_SIZE], size_t n_runs, const char *id)
{
    for (size_t i = 0; i < n_runs; i++) {
        if (strcmp(runs[i], id) == 0)
            return true;
    }
    return false;
}

static bf_status do_read_events(api_store *store, const char (*runs)[API_ID_SIZE], size_t n_runs,
                                uint64_t after, size_t limit_bytes, api_event_fn *on_event,
                                void *context, bf_error *err)
{
    const helper_daemon *d = (void *)store;
    size_t given = 0;

    for (size_t i = 0; i < d->n_events && given < limit_bytes; i++) {
        if (d->events[i].id <= after || !follows(runs, n_runs, d->events[i].run))
            continue;
        bf_status status = on_event(context, &d->events[i], err);
        if (status != BF_OK)
            return status;
        given += d->events[i].n;
    }
    return BF_OK;
}

static bf_status do_read_changes(api_store *store, const char *id, api_event_fn *on_event,
                                 void *context, bf_error *err)
{
    const helper_daemon *d = (void *)store;
    bf_status status = BF_OK;

    for (size_t i = 0; i < d->n_events && status == BF_OK; i++) {
        const api_event *event = &d->events[i];
        if (strcmp(event->run, id) == 0 && event->type >= API_EVENT_EYE)
            status = on_event(context, event, err);
    }
    return status;
}

static bf_status do_metrics(api_service *service, bool with_owners, bf_buffer *out, bf_error *err)
{
    return buffer_printf(out, "beltflow_runs 0\n") == BF_OK ? BF_OK : no_memory(err);
}

static bool do_holds(api_service *service, const char *id)
{
    return false;
}

static bool do_read_speed(api_service *service, prediction_speed *ret_speed)
{
    return false;
}

static bf_status do_ready(api_service *service, bf_error *err)
{
    const helper_daemon *d = (void *)service;

    return d->refusal == BF_OK ? BF_OK : bf_fail(err, d->refusal, "", "the daemon is stopping");
}

// Nobody needs a ticket here, and gets one all the same.
static void make_ticket(api_service *service, uint64_t token, api_ticket *ret_ticket)
{
    assert_int_equal(token, 0);
    *ret_ticket = (api_ticket){ .text = "a-ticket", .expires_ms = 1767225600000 };
}

// Alice's quotas: runs without one, CPU time that is used up, bytes.
static bf_status do_read_quotas(api_store *store, const char *owner, api_quotas *ret_quotas,
                                bf_error *err)
{
    assert_string_equal(owner, "");
    *ret_quotas = (api_quotas){ .owner = "alice",
                                .waiting = { .used = 3 },
                                .cpu_s = { .used = 70, .allowed = 60, .release_ms = 1767225600000 },
                                .bytes = { .used = 4096, .allowed = 8192 } };
    return BF_OK;
}

// One grant, of number 7, made to count until 2026.
static bf_status add_grant(api_service *service, uint32_t expires_in_s, api_grant *grant,
                           bf_error *err)
{
    assert_int_equal(expires_in_s, 3600);
    grant->id = 7;
    grant->created_ms = 1767225600000 - 3600000;
    grant->expires_ms = 1767225600000;
    (void)snprintf(grant->token, sizeof grant->token, "a-token");
    return BF_OK;
}

static bf_status list_grants(api_service *service, const char *owner, api_grant_list *ret_list,
                             bf_error *err)
{
    assert_string_equal(owner, "");
    *ret_list = (api_grant_list){ .n = 1, .grants = memory_alloc(1, sizeof(api_grant)) };
    assert_non_null(ret_list->grants);
    ret_list->grants[0] =
        (api_grant){ .id = 7, .resource = "/v1/runs/1", .expires_ms = 1767225600000 };
    return BF_OK;
}

static bf_status revoke_grant(api_service *service, const char *owner, uint64_t id, bf_error *err)
{
    assert_string_equal(owner, "");
    return id == 7 ? BF_OK : bf_fail(err, BF_ENOTFOUND, "", "there is no grant");
}

api_services helper_services(helper_daemon *d)
{
    api_services services = { .store = (void *)d,
                              .service = (void *)d,
                              .make_ticket = make_ticket,
                              .add_grant = add_grant,
                              .list_grants = list_grants,
                              .revoke_grant = revoke_grant,
                              .submit = do_submit,
                              .read_quotas = do_read_quotas,
                              .find = do_find,
                              .list = do_list,
                              .list_lines = do_list_lines,
                              .cancel = do_cancel,
                              .annotate = do_annotate,
                              .remove = do_remove,
                              .read_text = do_read_text,
                              .read_curve = do_read_curve,
                              .list_snapshots = do_list_snapshots,
                              .read_array = do_read_array,
                              .open_array = do_open_array,
                              .read_slice = helper_slices_read,
                              .read_events = do_read_events,
                              .read_changes = do_read_changes,
                              .holds = do_holds,
                              .read_speed = do_read_speed,
                              .ready = do_ready,
                              .metrics = do_metrics,
                              .write_openapi = openapi_write };

    helper_serve_measurements(&services);
    helper_serve_studies(&services);
    return services;
}

helper_run *helper_add_run(helper_daemon *d, run_state state)
{
    assert_true(d->n_runs < HELPER_RUNS_MAX);
    helper_run *item = &d->runs[d->n_runs++];

    *item = (helper_run){ .columns = "upstream,left_domain",
                          .n_columns = 2,
                          .t = { 0.0, 0.1 },
                          .values = { 192.0, 0.0, 191.5, 0.5 },
                          .snapshots = { { 0, 0.0, 1.0, 6.0 }, { 1, 0.1, 0.5, 5.5 } },
                          .rho = { { 0, 1, 2, 3, 4, 5 }, { 0.5F, 1, 2, 3, 4, 5 } },
                          .grid = { .n1 = 3, .n2 = 2, .d1 = 0.5, .d2 = 0.25 } };
    item->record = (api_run){ .state = state,
                              .revision = d->n_runs,
                              .created_ms = 1769860800000 + 1000 * (int64_t)d->n_runs,
                              .eta_s = (double)NAN,
                              .predicted_s = (double)NAN,
                              .n_samples = 2,
                              .n_snapshots = 2 };
    snprintf(item->record.id, sizeof item->record.id, "0190a0b0-0000-7000-8000-%012zx", d->n_runs);
    return item;
}

uint64_t helper_add_event(helper_daemon *d, helper_run *of, api_event_type type, const char *data)
{
    assert_true(d->n_events < HELPER_EVENTS_MAX);
    uint64_t id = d->n_events == 0 ? 1 : d->events[d->n_events - 1].id + 1;
    api_event *event = &d->events[d->n_events++];

    *event = (api_event){ .id = id, .type = type, .n = strlen(data), .data = data };
    memcpy(event->run, of->record.id, sizeof event->run);
    of->record.last_event = id;
    of->record.revision++;
    return id;
}
