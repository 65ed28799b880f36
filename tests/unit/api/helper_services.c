#include "tests/unit/api/helper_services.h"

#include "core/base/memory.h"
#include "tests/unit/helper_slices.h"

#include "api/results/run_json.h"

// cmocka.h wants these first.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

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

static bf_status do_submit(void *context, const api_submission *submission,
                           api_acceptance *ret_acceptance, bf_error *err)
{
    helper_daemon *d = context;

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

static bf_status do_find(void *context, const char *id, api_run *ret_run, bf_error *err)
{
    const helper_run *item = lookup(context, id);

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
           (query->before[0] == '\0' || strcmp(record->id, query->before) < 0);
}

static bf_status do_list(void *context, const api_list_query *query, api_run_list *ret_list,
                         bf_error *err)
{
    helper_daemon *d = context;

    (void)err;
    d->last_query = *query;
    ret_list->n = 0;
    ret_list->has_more = false;
    for (size_t i = d->n_runs; i-- > 0;) {
        if (!fits(&d->runs[i].record, query))
            continue;
        if (ret_list->n == query->limit) {
            ret_list->has_more = true;
            break;
        }
        ret_list->runs[ret_list->n++] = d->runs[i].record;
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

static bf_status do_cancel(void *context, const char *id, uint64_t revision, api_run *ret_run,
                           bf_error *err)
{
    helper_run *item = lookup(context, id);

    if (item == NULL)
        return no_run(err);
    bf_status status = check_revision(context, item, revision, err);
    if (status != BF_OK)
        return status;
    if (run_state_is_end(item->record.state))
        return bf_fail(err, BF_ECONFLICT, "", "the run has ended");
    if (item->record.state == RUN_QUEUED)
        item->record.state = RUN_CANCELLED;
    *ret_run = item->record;
    return BF_OK;
}

static bf_status do_remove(void *context, const char *id, uint64_t revision, bf_error *err)
{
    helper_daemon *d = context;
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

static bf_status do_read_text(void *context, const char *id, api_text which, bf_buffer *out,
                              bf_error *err)
{
    const helper_run *item = lookup(context, id);

    if (item == NULL)
        return no_run(err);
    const char *const texts[] = { [API_TEXT_SCENARIO] = "{\"duration_s\":6.0}",
                                  [API_TEXT_SUMMARY] = item->summary,
                                  [API_TEXT_FIGURES] = item->figures };
    const char *text = texts[which];
    if (text == NULL)
        return bf_fail(err, BF_ECONFLICT, "", "there is none yet");
    return buffer_append(out, text, strlen(text)) == BF_OK ? BF_OK : no_memory(err);
}

static bf_status do_read_curve(void *context, const char *id, uint64_t first, uint64_t n_most,
                               api_curve *ret_curve, bf_error *err)
{
    const helper_run *item = lookup(context, id);
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

static bf_status do_list_snapshots(void *context, const char *id, api_snapshot_list *ret_list,
                                   bf_error *err)
{
    const helper_run *item = lookup(context, id);

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

static bf_status do_read_snapshot(void *context, const char *id, uint64_t index,
                                  api_snapshot *ret_snapshot, bf_grid *ret_grid, bf_buffer *out,
                                  bf_error *err)
{
    const helper_run *item = lookup(context, id);

    if (item == NULL || index >= item->record.n_snapshots)
        return bf_fail(err, BF_ENOTFOUND, "", "there is no such snapshot");
    if (buffer_append(out, item->rho[index], sizeof item->rho[index]) != BF_OK)
        return no_memory(err);
    *ret_snapshot = item->snapshots[index];
    *ret_grid = item->grid;
    return BF_OK;
}

static bf_status do_read_parts(void *context, const char *id, uint64_t index,
                               api_snapshot *ret_snapshot, api_parts *ret_parts, bf_buffer *out,
                               bf_error *err)
{
    const helper_run *item = lookup(context, id);
    size_t n = item == NULL ? 0 : (size_t)item->parts.n_parts * item->parts.n_values;

    if (n == 0 || index >= item->record.n_snapshots)
        return bf_fail(err, BF_ENOTFOUND, "", "there are no such parts");
    if (n <= HELPER_VALUES && buffer_append(out, item->rows, n * sizeof *item->rows) != BF_OK)
        return no_memory(err);
    *ret_snapshot = item->snapshots[index];
    *ret_parts = item->parts;
    return BF_OK;
}

static bf_status do_open_snapshot(void *context, const char *id, uint64_t index,
                                  api_snapshot *ret_snapshot, bf_grid *ret_grid,
                                  api_slices *ret_slices, bf_error *err)
{
    bf_buffer *bytes = memory_alloc(1, sizeof *bytes);

    if (bytes == NULL)
        return no_memory(err);
    return helper_slices_open(
        do_read_snapshot(context, id, index, ret_snapshot, ret_grid, bytes, err), bytes,
        ret_slices);
}

static bf_status do_open_parts(void *context, const char *id, uint64_t index,
                               api_snapshot *ret_snapshot, api_parts *ret_parts,
                               api_slices *ret_slices, bf_error *err)
{
    bf_buffer *bytes = memory_alloc(1, sizeof *bytes);

    if (bytes == NULL)
        return no_memory(err);
    return helper_slices_open(
        do_read_parts(context, id, index, ret_snapshot, ret_parts, bytes, err), bytes, ret_slices);
}

static bool follows(const char (*runs)[API_ID_SIZE], size_t n_runs, const char *id)
{
    for (size_t i = 0; i < n_runs; i++) {
        if (strcmp(runs[i], id) == 0)
            return true;
    }
    return false;
}

static bf_status do_read_events(void *context, const char (*runs)[API_ID_SIZE], size_t n_runs,
                                uint64_t after, size_t limit_bytes, api_event_fn *take,
                                void *take_context, bf_error *err)
{
    const helper_daemon *d = context;
    size_t given = 0;

    for (size_t i = 0; i < d->n_events && given < limit_bytes; i++) {
        if (d->events[i].id <= after || !follows(runs, n_runs, d->events[i].run))
            continue;
        bf_status status = take(take_context, &d->events[i], err);
        if (status != BF_OK)
            return status;
        given += d->events[i].n;
    }
    return BF_OK;
}

static bf_status do_read_changes(void *context, const char *id, api_event_fn *take,
                                 void *take_context, bf_error *err)
{
    const helper_daemon *d = context;
    bf_status status = BF_OK;

    for (size_t i = 0; i < d->n_events && status == BF_OK; i++) {
        const api_event *event = &d->events[i];
        if (strcmp(event->run, id) == 0 &&
            (event->type == API_EVENT_EYE || event->type == API_EVENT_ACTION))
            status = take(take_context, event, err);
    }
    return status;
}

static helper_measurement *lookup_measurement(helper_daemon *d, const char *id)
{
    for (size_t i = 0; i < d->n_measurements; i++) {
        if (strcmp(d->measurements[i].about.id, id) == 0)
            return &d->measurements[i];
    }
    return NULL;
}

static bf_status no_measurement(bf_error *err)
{
    return bf_fail(err, BF_ENOTFOUND, "", "there is no such measurement");
}

static bf_status do_add_measurement(void *context, const api_measurement *measurement,
                                    const api_curve *curve, const bf_buffer *csv,
                                    api_measurement *ret_measurement, bf_error *err)
{
    helper_daemon *d = context;

    if (d->refusal != BF_OK)
        return bf_fail(err, d->refusal, "", "2000 measurements are stored");
    helper_measurement *item = helper_add_measurement(d, measurement->counter);
    if (measurement->kind == API_MEASURED_CURVE) {
        assert_int_equal(curve->n, measurement->n_samples);
        assert_int_equal(curve->n_columns, 1);
        assert_string_equal(curve->columns.bytes, measurement->counter);
    } else {
        assert_true(curve->n == 0 && csv->n < sizeof item->csv);
        memcpy(item->csv, csv->bytes, csv->n + 1);
    }
    item->about.kind = measurement->kind;
    memcpy(item->about.label, measurement->label, sizeof item->about.label);
    item->about.n_samples = measurement->n_samples;
    item->about.t_start = measurement->t_start;
    item->about.t_end = measurement->t_end;
    size_t n_kept = curve->n < 8 ? curve->n : 8;
    if (n_kept > 0) {
        memcpy(item->t, curve->t.bytes, n_kept * sizeof(double));
        memcpy(item->counts, curve->values.bytes, n_kept * sizeof(double));
    }
    *ret_measurement = item->about;
    return BF_OK;
}

static bf_status do_find_measurement(void *context, const char *id,
                                     api_measurement *ret_measurement, bf_error *err)
{
    const helper_measurement *item = lookup_measurement(context, id);

    if (item == NULL)
        return no_measurement(err);
    *ret_measurement = item->about;
    return BF_OK;
}

static bf_status do_list_measurements(void *context, const api_measurement_query *query,
                                      api_measurement_list *ret_list, bf_error *err)
{
    const helper_daemon *d = context;

    (void)err;
    ret_list->n = 0;
    ret_list->has_more = false;
    for (size_t i = d->n_measurements; i-- > 0 && !ret_list->has_more;) {
        const api_measurement *about = &d->measurements[i].about;
        bool fits = about->id[0] != '\0' &&
                    (query->label[0] == '\0' || strcmp(about->label, query->label) == 0) &&
                    (query->before[0] == '\0' || strcmp(about->id, query->before) < 0);
        if (fits && ret_list->n == query->limit)
            ret_list->has_more = true;
        else if (fits)
            ret_list->items[ret_list->n++] = *about;
    }
    return BF_OK;
}

static bf_status do_read_measurement(void *context, const char *id, api_curve *ret_curve,
                                     bf_error *err)
{
    const helper_measurement *item = lookup_measurement(context, id);
    api_curve curve = { .n_columns = 1 };

    if (item == NULL)
        return no_measurement(err);
    curve.n = (size_t)item->about.n_samples;
    if (buffer_printf(&curve.columns, "%s", item->about.counter) != BF_OK ||
        buffer_append(&curve.t, item->t, curve.n * sizeof(double)) != BF_OK ||
        buffer_append(&curve.values, item->counts, curve.n * sizeof(double)) != BF_OK) {
        api_curve_fini(&curve);
        return no_memory(err);
    }
    *ret_curve = curve;
    return BF_OK;
}

static bf_status do_read_measurement_csv(void *context, const char *id, bf_buffer *out,
                                         bf_error *err)
{
    helper_daemon *d = context;
    const helper_measurement *item = lookup_measurement(d, id);

    if (item == NULL)
        return no_measurement(err);
    if (d->refusal != BF_OK)
        return bf_fail(err, d->refusal, "", "the store failed");
    return buffer_append(out, item->csv, strlen(item->csv)) == BF_OK ? BF_OK : no_memory(err);
}

static bf_status do_remove_measurement(void *context, const char *id, bf_error *err)
{
    helper_measurement *item = lookup_measurement(context, id);

    if (item == NULL)
        return no_measurement(err);
    item->about.id[0] = '\0';
    return BF_OK;
}

static bf_status do_metrics(void *context, bf_buffer *out, bf_error *err)
{
    (void)context;
    return buffer_printf(out, "beltflow_runs 0\n") == BF_OK ? BF_OK : no_memory(err);
}

static bf_status do_ready(void *context, bf_error *err)
{
    const helper_daemon *d = context;

    return d->refusal == BF_OK ? BF_OK : bf_fail(err, d->refusal, "", "the daemon is stopping");
}

// Nobody needs a ticket here, and gets one all the same.
static void make_ticket(void *context, uint64_t token, api_ticket *ret_ticket)
{
    (void)context;
    assert_int_equal(token, 0);
    *ret_ticket = (api_ticket){ .text = "a-ticket", .expires_ms = 1767225600000 };
}

// Alice's quotas: runs without one, CPU time that is used up, bytes.
static bf_status do_read_quotas(void *context, const char *owner, api_quotas *ret_quotas,
                                bf_error *err)
{
    (void)context;
    (void)err;
    assert_string_equal(owner, "");
    *ret_quotas = (api_quotas){ .owner = "alice",
                                .waiting = { .used = 3 },
                                .cpu_s = { .used = 70, .allowed = 60, .release_ms = 1767225600000 },
                                .bytes = { .used = 4096, .allowed = 8192 } };
    return BF_OK;
}

api_services helper_services(helper_daemon *d)
{
    return (api_services){ .context = d,
                           .make_ticket = make_ticket,
                           .submit = do_submit,
                           .read_quotas = do_read_quotas,
                           .find = do_find,
                           .list = do_list,
                           .cancel = do_cancel,
                           .remove = do_remove,
                           .read_text = do_read_text,
                           .read_curve = do_read_curve,
                           .list_snapshots = do_list_snapshots,
                           .read_snapshot = do_read_snapshot,
                           .read_parts = do_read_parts,
                           .open_snapshot = do_open_snapshot,
                           .open_parts = do_open_parts,
                           .read_slice = helper_slices_read,
                           .read_events = do_read_events,
                           .read_changes = do_read_changes,
                           .add_measurement = do_add_measurement,
                           .find_measurement = do_find_measurement,
                           .list_measurements = do_list_measurements,
                           .read_measurement = do_read_measurement,
                           .read_measurement_csv = do_read_measurement_csv,
                           .remove_measurement = do_remove_measurement,
                           .ready = do_ready,
                           .metrics = do_metrics };
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
                              .n_samples = 2,
                              .n_snapshots = 2 };
    snprintf(item->record.id, sizeof item->record.id, "0190a0b0-0000-7000-8000-%012zx", d->n_runs);
    return item;
}

helper_measurement *helper_add_measurement(helper_daemon *d, const char *counter)
{
    assert_true(d->n_measurements < HELPER_MEASUREMENTS_MAX);
    helper_measurement *item = &d->measurements[d->n_measurements++];

    *item = (helper_measurement){ .t = { 0.0, 0.1 }, .counts = { 192.0, 191.0 } };
    item->about =
        (api_measurement){ .created_ms = 1769860800000 + 1000 * (int64_t)d->n_measurements,
                           .n_samples = 2,
                           .t_end = 0.1 };
    snprintf(item->about.id, sizeof item->about.id, "0190a0b0-0000-7000-9000-%012zx",
             d->n_measurements);
    snprintf(item->about.counter, sizeof item->about.counter, "%s", counter);
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

// Header lines with the values that were asked for last.
typedef struct header_lines {
    const char *lines;
    size_t n_asked;
    char values[4][256];
} header_lines;

static const char *find_header(void *context, const char *name)
{
    header_lines *h = context;
    size_t n = strlen(name);

    for (const char *line = h->lines; line != NULL && *line != '\0';
         line = strchr(line, '\n') + 1) {
        if (strncasecmp(line, name, n) != 0 || strncmp(line + n, ": ", 2) != 0)
            continue;
        char *value = h->values[h->n_asked++ % 4];
        snprintf(value, sizeof *h->values, "%.*s", (int)strcspn(line + n + 2, "\n"), line + n + 2);
        return value;
    }
    return NULL;
}

void helper_request(helper_daemon *d, const char *method, const char *path, const char *query,
                    const char *headers, const char *body, api_response *response)
{
    api_services services = helper_services(d);
    header_lines lines = { .lines = headers };
    api_request request = { .method = method,
                            .path = path,
                            .query = query == NULL ? "" : query,
                            .header = find_header,
                            .header_context = &lines,
                            .body = body,
                            .n_body = body == NULL ? 0 : strlen(body) };

    api_handle(&services, &request, response);
}

const char *helper_header(const api_response *response, const char *name)
{
    for (size_t i = 0; i < response->n_headers; i++) {
        if (strcasecmp(response->headers[i].name, name) == 0)
            return response->headers[i].value;
    }
    return NULL;
}

json_t *helper_json(const api_response *response)
{
    json_error_t error;

    assert_non_null(response->body.bytes);
    json_t *root =
        json_loadb(response->body.bytes, response->body.n, JSON_REJECT_DUPLICATES, &error);
    if (root == NULL)
        fail_msg("%s in %s", error.text, response->body.bytes);
    return root;
}
