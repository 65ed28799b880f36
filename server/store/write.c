#include "server/store/store_priv.h"

#include <string.h>

/// A change of one run, and what became of it.
typedef struct change_context {
    const char *id;
    uint64_t revision;          ///< that the run must have, or API_ANY_REVISION
    const store_ending *ending; ///< of store_finish()
    store__row row;
} change_context;

static bf_status check_revision(const api_run *record, uint64_t expected, bf_error *err)
{
    if (expected == API_ANY_REVISION || record->revision == expected)
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "", "the run has revision %llu, not %llu",
                   (unsigned long long)record->revision, (unsigned long long)expected);
}

static bf_status find_changed(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;

    bf_status status = store__find_row(writer, context->id, &context->row, err);
    if (status == BF_OK)
        status = check_revision(&context->row.run, context->revision, err);
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
    return store__put_text(writer, row->rowid, STORE__TEXT_SUMMARY, ending->summary,
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
    return status == BF_OK ? store__transition(writer, row, context->ending->state, err) : status;
}

bf_status store_finish(store *s, const store_ending *ending, api_run *ret_run, bf_error *err)
{
    change_context context = { .id = ending->run_id, .ending = ending };

    bf_status status = store__write(s, apply_finish, &context, err);
    if (status == BF_OK)
        *ret_run = context.row.run;
    return status;
}

// Ask for a running run to be stopped, unless as much is asked already (I14).
static bf_status request_stop(store__connection *writer, store__operation *operation,
                              const store__row *row, store_stop how, bf_error *err)
{
    operation->changed[0] = '\0';
    if (row->stop_request >= how)
        return BF_OK;
    memcpy(operation->changed, row->run.id, API_ID_SIZE);
    store__query q = store__begin(writer, STORE__SQL_REQUEST_STOP);
    store__bind_integer(&q, row->rowid);
    store__bind_integer(&q, how);
    return store__run(&q, err);
}

static bf_status apply_cancel(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;
    store__row *row = &context->row;

    bf_status status = find_changed(writer, operation, err);
    if (status != BF_OK)
        return status;
    if (row->run.state == RUN_RUNNING)
        return request_stop(writer, operation, row, STORE_STOP_CANCEL, err);
    if (run_state_is_end(row->run.state))
        return bf_fail(err, BF_ECONFLICT, "", "the run has ended: it is %s",
                       run_state_word(row->run.state));
    return store__transition(writer, row, RUN_CANCELLED, err);
}

bf_status store_cancel(store *s, const char *id, uint64_t revision, api_run *ret_run, bf_error *err)
{
    change_context context = { .id = id, .revision = revision };

    bf_status status = store__write(s, apply_cancel, &context, err);
    if (status == BF_OK)
        *ret_run = context.row.run;
    return status;
}

/// A run to be removed, and then its results, step by step.
typedef struct remove_context {
    const char *id;
    uint64_t revision; ///< that the run must have, or API_ANY_REVISION
    int64_t results;
    bool is_running; ///< and thus still there, but asked to stop
    bool is_over;    ///< nothing is left
} remove_context;

static bf_status apply_remove(store__connection *writer, store__operation *operation, bf_error *err)
{
    remove_context *context = operation->context;
    store__row row;

    bf_status status = store__find_row(writer, context->id, &row, err);
    if (status == BF_OK)
        status = check_revision(&row.run, context->revision, err);
    if (status != BF_OK)
        return status;
    context->is_running = row.run.state == RUN_RUNNING;
    if (context->is_running)
        return request_stop(writer, operation, &row, STORE_STOP_KILL, err);
    memcpy(operation->changed, row.run.id, API_ID_SIZE);
    context->results = row.results;
    return store__remove_row(writer, &row, &context->is_over, err);
}

static bf_status apply_collect(store__connection *writer, store__operation *operation,
                               bf_error *err)
{
    remove_context *context = operation->context;

    return store__collect_results(writer, context->results, &context->is_over, err);
}

bf_status store_remove(store *s, const char *id, uint64_t revision, bf_error *err)
{
    remove_context context = { .id = id, .revision = revision };

    bf_status status = store__write(s, apply_remove, &context, err);
    if (status == BF_OK && context.is_running)
        return bf_fail(err, BF_ECONFLICT, "", "the run is running: it has been asked to stop");
    // The run is gone with the first step. What a failure leaves over is deleted in time.
    for (bf_status collected = status; collected == BF_OK && !context.is_over;)
        collected = store__write(s, apply_collect, &context, NULL);
    return status;
}
