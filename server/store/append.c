#include "server/store/finish.h"
#include "server/store/quotas.h"
#include "server/store/texts.h"

#include "api/results/events.h"
#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/metrics.h"

#include <math.h>
#include <string.h>

/// A batch on its way into the store.
struct store__appending {
    const store_batch *batch;
    bf_buffer *compressed; ///< two for each item, empty but for snapshots; one for the checkpoint
    store__row row;
    bf_buffer columns;  ///< of the curve; empty until it is needed
    size_t n_columns;   ///< of them
    bool has_changes;   ///< the next one is known
    uint64_t n_changes; ///< changes of the run that are stored
    size_t n_bytes;     ///< of what was stored for the results, not counted there yet
};

/// The operation of store_begin_append(); freed by finish_append().
typedef struct append_operation {
    store__operation operation;
    store__appending *appending;
    store_appended *appended; ///< called at the end
    void *appended_context;
} append_operation;

// Which of the compressed ones: grid and parts of item i, and the checkpoint.
static bf_buffer *compressed_grid(const store__appending *context, size_t i)
{
    return &context->compressed[2 * i];
}

static bf_buffer *compressed_parts(const store__appending *context, size_t i)
{
    return &context->compressed[2 * i + 1];
}

static bf_buffer *compressed_checkpoint(const store__appending *context)
{
    return &context->compressed[2 * context->batch->n];
}

static bf_status pack_item(const store__appending *context, size_t i, store__packer *packer,
                           bf_error *err)
{
    const store_item *item = &context->batch->items[i];

    if (item->type != API_EVENT_SNAPSHOT)
        return BF_OK;
    if (item->rho.n > 0)
        BF_TRY(store__pack(packer, item->rho.bytes, item->rho.n, compressed_grid(context, i), err));
    if (item->parts.n > 0)
        BF_TRY(store__pack(packer, item->parts.bytes, item->parts.n, compressed_parts(context, i),
                           err));
    return BF_OK;
}

bf_status store__pack_batch(const store__appending *context, bf_error *err)
{
    const store_batch *batch = context->batch;
    bool has_arrays = batch->checkpoint != NULL;
    bf_status status = BF_OK;

    for (size_t i = 0; i < batch->n; i++)
        has_arrays = has_arrays || batch->items[i].type == API_EVENT_SNAPSHOT;
    if (!has_arrays)
        return BF_OK;
    store__packer *packer = store__packer_create();
    if (packer == NULL)
        return bf_fail_memory(err);
    for (size_t i = 0; i < batch->n && status == BF_OK; i++)
        status = pack_item(context, i, packer, err);
    if (status == BF_OK && batch->checkpoint != NULL)
        status = store__pack(packer, batch->checkpoint, batch->n_checkpoint,
                             compressed_checkpoint(context), err);
    store__packer_destroy(packer);
    return status;
}

static bf_status note_sizes(store__row *row, const bf_grid *grid, const api_parts *parts,
                            bf_error *err)
{
    if (grid == NULL)
        return BF_OK;
    if (row->run.n_snapshots > 0 &&
        (parts->n_parts != row->run.parts.n_parts || parts->n_values != row->run.parts.n_values))
        return bf_fail(err, BF_ECORRUPT, "", "the run's parts changed from %llu x %u to %llu x %u",
                       (unsigned long long)row->run.parts.n_parts, row->run.parts.n_values,
                       (unsigned long long)parts->n_parts, parts->n_values);
    if (row->run.n_snapshots > 0 && (grid->n1 != row->run.grid.n1 || grid->n2 != row->run.grid.n2))
        return bf_fail(err, BF_ECORRUPT, "",
                       "the run's grid changed from %zu x %zu to %zu x %zu cells", row->run.grid.n1,
                       row->run.grid.n2, grid->n1, grid->n2);
    row->run.grid = *grid;
    row->run.parts = *parts;
    return BF_OK;
}

// An item that is stored in part has an event of the rest only.
static bf_status emit_rest(store__connection *writer, store__appending *context,
                           const frame_curve *rest, bf_error *err)
{
    bf_buffer data = { 0 };

    bf_status status = events_curve(context->row.run.id, rest, context->columns.bytes, &data, err);
    if (status == BF_OK)
        status =
            store__insert_event(writer, &context->row, API_EVENT_CURVE, rest->first, &data, err);
    buffer_fini(&data);
    return status;
}

static bf_status append_curve(store__connection *writer, store__appending *context,
                              const store_item *item, bf_error *err)
{
    api_run *record = &context->row.run;

    if (context->columns.n == 0) {
        BF_TRY(store__get_text(writer, context->row.rowid, STORE__TEXT_COLUMNS, &context->columns,
                               err));
        context->n_columns = api_count_columns(&context->columns);
    }
    const size_t n_columns = context->n_columns;
    if (item->t.n != item->n * sizeof(double) ||
        item->values.n != item->n * n_columns * sizeof(double))
        return bf_fail(err, BF_ECORRUPT, "", "%zu samples of %zu columns came as %zu and %zu bytes",
                       item->n, n_columns, item->t.n, item->values.n);
    if (item->first > record->n_samples)
        return bf_fail(err, BF_ECORRUPT, "",
                       "the curve has a gap: sample %llu came after %llu samples",
                       (unsigned long long)item->first, (unsigned long long)record->n_samples);

    const uint64_t n_known = record->n_samples - item->first;
    if (n_known >= item->n)
        return BF_OK;
    const frame_curve rest = {
        .first = record->n_samples,
        .n = (uint32_t)(item->n - n_known),
        .n_columns = (uint32_t)n_columns,
        .t = (const double *)(const void *)item->t.bytes + n_known,
        .values = (const double *)(const void *)item->values.bytes + n_known * n_columns,
    };
    BF_TRY(store__exec(writer, STORE__SQL_INSERT_SAMPLES, err, INTEGER(context->row.results),
                       INTEGER(rest.first), INTEGER(rest.n), BLOB(rest.t, rest.n * sizeof(double)),
                       BLOB(rest.values, rest.n * n_columns * sizeof(double))));
    record->n_samples += rest.n;
    context->n_bytes += rest.n * (n_columns + 1) * sizeof(double);
    if (n_known > 0 && item->event.n > 0)
        return emit_rest(writer, context, &rest, err);
    return store__insert_event(writer, &context->row, API_EVENT_CURVE, rest.first, &item->event,
                               err);
}

static bf_status append_change(store__connection *writer, store__appending *context,
                               const store_item *item, bf_error *err)
{
    static const bf_buffer none = { 0 }; // the data stand in the results
    int64_t n = 0;

    if (!context->has_changes) {
        BF_TRY(store__find_number(writer, STORE__SQL_COUNT_CHANGES, &n, err,
                                  INTEGER(context->row.rowid)));
        context->n_changes = (uint64_t)n;
        context->has_changes = true;
    }
    if (item->first < context->n_changes)
        return BF_OK;
    if (item->first > context->n_changes)
        return bf_fail(err, BF_ECORRUPT, "",
                       "the changes of photo eyes and drives have a gap: number %llu "
                       "came after %llu",
                       (unsigned long long)item->first, (unsigned long long)context->n_changes);
    BF_TRY(store__exec(writer, STORE__SQL_INSERT_CHANGE, err, INTEGER(context->row.results),
                       INTEGER(item->first), TEXT_OF(item->event.bytes, item->event.n)));
    context->n_changes++;
    context->n_bytes += item->event.n;
    return store__insert_event(writer, &context->row, item->type, item->first, &none, err);
}

static bf_status append_item(store__connection *writer, store__appending *context, size_t i,
                             bf_error *err)
{
    const store_item *item = &context->batch->items[i];
    store__row *row = &context->row;

    if (item->type == API_EVENT_CURVE)
        return append_curve(writer, context, item, err);
    if (item->type == API_EVENT_SNAPSHOT)
        return store__append_snapshot(writer, row, item, compressed_grid(context, i),
                                      compressed_parts(context, i), &context->n_bytes, err);
    if (item->type >= API_EVENT_EYE)
        return append_change(writer, context, item, err);
    BF_CHECK(item->type == API_EVENT_FIGURES || item->type == API_EVENT_PROGRESS);
    if (item->type == API_EVENT_FIGURES) {
        memcpy(row->run.figures, item->run_figures, sizeof row->run.figures);
        BF_TRY(store__put_text(writer, row->rowid, STORE__TEXT_FIGURES, item->figures.bytes,
                               item->figures.n, err));
    }
    return store__insert_event(writer, row, item->type, 0, &item->event, err);
}

static bool is_hidden(const store_item *item)
{
    return item->type == API_EVENT_SNAPSHOT && item->is_open;
}

// True if nobody can see what the batch brings, so that the run stays as it is.
static bool brings_nothing_visible(const store_batch *batch)
{
    bool is_nothing = batch->n > 0 && batch->checkpoint == NULL;

    for (size_t i = 0; i < batch->n; i++)
        is_nothing = is_nothing && is_hidden(&batch->items[i]);
    return is_nothing;
}

bf_status store__apply_batch(store__connection *writer, store__appending *context, store__row *row,
                             bf_error *err)
{
    const store_batch *batch = context->batch;
    const store__row before = *row;

    context->row = *row;
    context->n_bytes = 0;
    context->has_changes = false;
    BF_TRY(note_sizes(&context->row, batch->grid, &batch->parts, err));
    BF_TRY(store__note_sender(writer, row, batch->token, err));
    for (size_t i = 0; i < batch->n; i++)
        BF_TRY(append_item(writer, context, i, err));
    if (context->n_bytes > 0)
        BF_TRY(store__exec(writer, STORE__SQL_GROW_RESULTS, err, INTEGER(context->row.results),
                           INTEGER(context->n_bytes)));
    // The checkpoint comes in the same transaction as all that came before it (I5).
    if (batch->checkpoint != NULL) {
        context->row.checkpoint_step = batch->step;
        BF_TRY(store__delete_chunks(writer, context->row.results, STORE__BLOB_CHECKPOINT, 0, err));
        BF_TRY(store__insert_chunks(writer, context->row.results, STORE__BLOB_CHECKPOINT, 0, 0,
                                    compressed_checkpoint(context), err));
    }
    *row = context->row;
    if (brings_nothing_visible(batch))
        return BF_OK;
    if (isfinite(batch->progress))
        row->run.progress = fmin(fmax(batch->progress, 0.0), 1.0);
    if (isfinite(batch->wall_s))
        row->wall_s = batch->wall_s;
    row->run.eta_s = batch->eta_s;
    // Attempts count since one brought the run further than any before.
    if (row->run.n_samples > before.run.n_samples ||
        row->run.n_snapshots > before.run.n_snapshots ||
        row->checkpoint_step > before.checkpoint_step)
        row->attempts = row->hand_backs = 0;
    return store__charge(writer, row, batch->cpu_s, err);
}

static bf_status apply_append(store__connection *writer, store__operation *operation, bf_error *err)
{
    const append_operation *o = operation->context;
    const store_batch *batch = o->appending->batch;
    store__row row;

    BF_TRY(store__find_row(writer, batch->run_id, &row, err));
    BF_TRY(store__check_running(&row, err));
    BF_TRY(store__apply_batch(writer, o->appending, &row, err));
    if (brings_nothing_visible(batch))
        return BF_OK;
    memcpy(operation->changed, row.run.id, API_ID_SIZE);
    return store__save_row(writer, &row, err);
}

// Compressing takes longer than writing, so it is done on the preparing thread.
static bf_status prepare_append(store__operation *operation, bf_error *err)
{
    const append_operation *o = operation->context;

    return store__pack_batch(o->appending, err);
}

static void finish_append(store__operation *operation)
{
    append_operation *o = operation->context;

    store__appending_destroy(o->appending, operation->status);
    // From here on the batch is its owner's again.
    o->appended(o->appended_context, operation->status, &operation->error);
    memory_free(o);
}

store__appending *store__appending_create(const store_batch *batch)
{
    store__appending *context = memory_alloc(1, sizeof *context);
    bf_buffer *compressed = memory_alloc(2 * batch->n + 1, sizeof *compressed);

    if (context == NULL || compressed == NULL) {
        memory_free(context);
        memory_free(compressed);
        return NULL;
    }
    *context = (store__appending){ .batch = batch, .compressed = compressed };
    return context;
}

void store__appending_destroy(store__appending *context, bf_status status)
{
    const store_batch *batch = context->batch;

    for (size_t i = 0; i < batch->n && status == BF_OK; i++)
        metrics_add(METRICS_FRAMES, batch->items[i].type, !is_hidden(&batch->items[i]));
    for (size_t i = 0; i <= 2 * batch->n; i++)
        buffer_fini(&context->compressed[i]);
    memory_free(context->compressed);
    buffer_fini(&context->columns);
    memory_free(context);
}

bf_status store_begin_append(store *s, const store_batch *batch, store_appended *appended,
                             void *appended_context, bf_error *err)
{
    append_operation *o = memory_alloc(1, sizeof *o);
    store__appending *appending = o == NULL ? NULL : store__appending_create(batch);

    if (appending == NULL) {
        memory_free(o);
        return bf_fail_memory(err);
    }
    *o = (append_operation){ .operation = { .apply = apply_append,
                                            .prepare = prepare_append,
                                            .finish = finish_append,
                                            .context = o },
                             .appending = appending,
                             .appended = appended,
                             .appended_context = appended_context };
    store__begin_write(s, &o->operation);
    return BF_OK;
}
