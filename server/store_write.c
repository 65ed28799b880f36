#include "server/store_priv.h"

#include "server/clock.h"
#include "server/run_id.h"

#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

/// A run to be inserted, and what became of it.
typedef struct submit_context {
    const api_submission *submission;
    size_t queue_limit;
    store__row row;
} submit_context;

static bf_status check_queue(store__connection *writer, size_t limit, bf_error *err)
{
    bool has_row = false;
    int64_t n_queued = 0;

    store__query q = store__begin(writer, STORE__SQL_COUNT_QUEUED);
    bf_status status = store__next(&q, &has_row, err);
    if (status == BF_OK)
        n_queued = sqlite3_column_int64(q.statement, 0);
    store__end(&q);
    if (status == BF_OK && (uint64_t)n_queued >= limit)
        return bf_fail(err, BF_EBUSY, "", "the queue is full: %lld runs wait, the limit is %zu",
                       (long long)n_queued, limit);
    return status;
}

static bf_status insert_row(store__connection *writer, store__row *row, bf_error *err)
{
    const api_run *record = &row->run;

    store__query q = store__begin(writer, STORE__SQL_INSERT_RUN);
    store__bind_text(&q, record->id, strlen(record->id));
    store__bind_integer(&q, record->state);
    store__bind_integer(&q, record->model);
    store__bind_integer(&q, record->priority);
    store__bind_text(&q, record->label, strlen(record->label));
    store__bind_text(&q, record->name, strlen(record->name));
    store__bind_integer(&q, record->created_ms);
    bf_status status = store__run(&q, err);
    if (status == BF_OK)
        row->number = sqlite3_last_insert_rowid(writer->db);
    return status;
}

static bf_status apply_submit(store__connection *writer, store__operation *operation, bf_error *err)
{
    submit_context *context = operation->context;
    const bf_buffer *scenario = &context->submission->scenario;
    const bf_buffer *columns = &context->submission->columns;
    store__row *row = &context->row;

    bf_status status = check_queue(writer, context->queue_limit, err);
    if (status == BF_OK)
        status = insert_row(writer, row, err);
    if (status == BF_OK)
        status = store__put_text(writer, row->number, STORE__TEXT_SCENARIO, scenario->bytes,
                                 scenario->n, err);
    if (status == BF_OK)
        status = store__put_text(writer, row->number, STORE__TEXT_COLUMNS, columns->bytes,
                                 columns->n, err);
    if (status == BF_OK)
        status = store__tell_row(writer, row, err);
    memcpy(operation->changed, row->run.id, API_ID_SIZE);
    return status;
}

bf_status store_submit(store *s, const api_submission *submission, api_run *ret_run, bf_error *err)
{
    submit_context context = { .submission = submission, .queue_limit = s->queue_limit };
    api_run *record = &context.row.run;

    bf_status status = run_id_make(record->id, err);
    if (status != BF_OK)
        return status;
    record->state = RUN_QUEUED;
    record->model = submission->model;
    record->priority = submission->priority;
    snprintf(record->label, sizeof record->label, "%s", submission->label);
    snprintf(record->name, sizeof record->name, "%s", submission->name);
    record->created_ms = clock_unix_ms();
    record->eta_s = NAN;
    status = store__write(s, apply_submit, &context, err);
    if (status == BF_OK)
        *ret_run = *record;
    return status;
}

/// A change of one run, and what became of it.
typedef struct change_context {
    const char *id;
    const store_ending *ending; ///< of store_finish()
    store__row row;
} change_context;

static bf_status find_changed(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;

    bf_status status = store__find_row(writer, context->id, &context->row, err);
    if (status == BF_OK)
        memcpy(operation->changed, context->row.run.id, API_ID_SIZE);
    return status;
}

static bf_status put_summary(store__connection *writer, const store_ending *ending, store__row *row,
                             bf_error *err)
{
    if (ending->summary == NULL)
        return BF_OK;
    row->run.has_summary = true;
    return store__put_text(writer, row->number, STORE__TEXT_SUMMARY, ending->summary,
                           ending->n_summary, err);
}

static bf_status apply_finish(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;
    store__row *row = &context->row;

    bf_status status = find_changed(writer, operation, err);
    if (status != BF_OK)
        return status;
    if (row->run.state != RUN_RUNNING)
        return bf_fail(err, BF_ECONFLICT, "", "the run is %s, not running",
                       run_state_word(row->run.state));
    if (context->ending->state == RUN_FAILED)
        row->run.error = context->ending->error;
    status = put_summary(writer, context->ending, row, err);
    return status == BF_OK ? store__move_row(writer, row, context->ending->state, err) : status;
}

bf_status store_finish(store *s, const store_ending *ending, api_run *ret_run, bf_error *err)
{
    change_context context = { .id = ending->run_id, .ending = ending };

    bf_status status = store__write(s, apply_finish, &context, err);
    if (status == BF_OK)
        *ret_run = context.row.run;
    return status;
}

static bf_status apply_cancel(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;
    store__row *row = &context->row;

    bf_status status = find_changed(writer, operation, err);
    if (status != BF_OK)
        return status;
    if (row->run.state == RUN_RUNNING) {
        operation->changed[0] = '\0';
        return BF_OK;
    }
    if (run_state_is_end(row->run.state))
        return bf_fail(err, BF_ECONFLICT, "", "the run has ended: it is %s",
                       run_state_word(row->run.state));
    return store__move_row(writer, row, RUN_CANCELLED, err);
}

bf_status store_cancel(store *s, const char *id, api_run *ret_run, bf_error *err)
{
    change_context context = { .id = id };

    bf_status status = store__write(s, apply_cancel, &context, err);
    if (status == BF_OK)
        *ret_run = context.row.run;
    return status;
}

// Foreign keys delete with the row all that refers to it (I9).
static bf_status apply_remove(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;

    bf_status status = find_changed(writer, operation, err);
    if (status != BF_OK)
        return status;
    if (context->row.run.state == RUN_RUNNING)
        return bf_fail(err, BF_ECONFLICT, "", "the run is running: cancel it first");
    store__query q = store__begin(writer, STORE__SQL_DELETE_RUN);
    store__bind_integer(&q, context->row.number);
    return store__run(&q, err);
}

bf_status store_remove(store *s, const char *id, bf_error *err)
{
    change_context context = { .id = id };

    return store__write(s, apply_remove, &context, err);
}
