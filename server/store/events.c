// Events: inserted by the operation that they report (I7), and read for several runs in the order of their
// ids. Events that are read are copied before they are passed on: the callback may call the store, and
// no reader waits for it.

#include "server/store/store_priv.h"
#include "server/store/texts.h"

#include "api/results/events.h"
#include "core/base/check.h"
#include "core/base/memory.h"

#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

bf_status store__insert_event(store__connection *writer, store__row *row, api_event_type type,
                              uint64_t item, const bf_buffer *data, bf_error *err)
{
    BF_TRY(store__exec(writer, STORE__SQL_INSERT_EVENT, err, INTEGER(row->rowid), INTEGER(type),
                       INTEGER(item), TEXT_OF(data->n > 0 ? data->bytes : "", data->n)));
    row->run.last_event = (uint64_t)sqlite3_last_insert_rowid(writer->db);
    row->n_bytes += data->n;
    return BF_OK;
}

bf_status store__emit_events(store__connection *writer, store__row *row, bf_error *err)
{
    bf_buffer data = { 0 };

    bf_status status = events_status(&row->run, &data, err);
    if (status == BF_OK)
        status = store__insert_event(writer, row, API_EVENT_STATUS, 0, &data, err);
    if (status == BF_OK && run_state_is_end(row->run.state)) {
        data.n = 0;
        status = events_end(&row->run, &data, err);
        if (status == BF_OK)
            status = store__insert_event(writer, row, API_EVENT_END, 0, &data, err);
    }
    buffer_fini(&data);
    return status == BF_OK ? store__save_row(writer, row, err) : status;
}

/// A batch of samples as it is stored.
typedef struct samples {
    size_t n;
    bf_buffer t;
    bf_buffer values;
    bf_buffer columns; ///< of the curve
} samples;

static bf_status get_samples(store__connection *reader, const store__row *row, uint64_t first,
                             samples *got, bf_error *err)
{
    store__query q =
        store__start(reader, STORE__SQL_GET_SAMPLES, INTEGER(row->results), INTEGER(first));
    bf_status status = BF_OK;
    const bool has_row = store__next(&q, &status, err);
    if (has_row) {
        got->n = (size_t)sqlite3_column_int64(q.statement, 0);
        status = store__column_bytes(&q, 1, &got->t, err);
    }
    if (status == BF_OK && has_row)
        status = store__column_bytes(&q, 2, &got->values, err);
    store__end(&q);
    return status == BF_OK
               ? store__get_text(reader, row->rowid, STORE__TEXT_COLUMNS, &got->columns, err)
               : status;
}

static bf_status describe_curve(store__connection *reader, const store__row *row, uint64_t first,
                                bf_buffer *out, bf_error *err)
{
    samples got = { 0 };

    bf_status status = get_samples(reader, row, first, &got, err);
    size_t n_columns = 1;
    for (size_t i = 0; i < got.columns.n; i++)
        n_columns += got.columns.bytes[i] == ',';
    frame_curve curve = {
        .first = first,
        .n = (uint32_t)got.n,
        .n_columns = (uint32_t)n_columns,
        .t = (const double *)(const void *)got.t.bytes,
        .values = (const double *)(const void *)got.values.bytes,
    };
    bool is_whole = got.n > 0 && got.t.n == got.n * sizeof(double) &&
                    got.values.n == got.n * n_columns * sizeof(double);
    if (status == BF_OK && !is_whole)
        status = bf_fail(err, BF_ECORRUPT, "", "the stored curve is damaged at sample %llu",
                         (unsigned long long)first);
    if (status == BF_OK)
        status = events_curve(row->run.id, &curve, got.columns.bytes, out, err);
    buffer_fini(&got.t);
    buffer_fini(&got.values);
    buffer_fini(&got.columns);
    return status;
}

static bf_status describe_snapshot(store__connection *reader, const store__row *row, uint64_t index,
                                   bf_buffer *out, bf_error *err)
{
    api_snapshot found;

    BF_TRY(store__find_snapshot(reader, row->results, index, &found, err));
    frame_snapshot about = {
        .index = index,
        .t = found.t,
        .peak = found.peak,
        .mass = found.mass,
        .n1 = (uint32_t)row->run.grid.n1,
        .n2 = (uint32_t)row->run.grid.n2,
    };
    return events_snapshot(row->run.id, &about, row->run.parts.n_values > 0, out, err);
}

static bf_status describe_change(store__connection *reader, const store__row *row, uint64_t index,
                                 bf_buffer *out, bf_error *err)
{
    bf_buffer data = { 0 };
    bool has_row = false;

    bf_status status = store__find_bytes(reader, STORE__SQL_GET_CHANGE, &data, &has_row, err,
                                         INTEGER(row->results), INTEGER(index));
    if (status == BF_OK)
        status = events_of_run(row->run.id, data.bytes, data.n, out, err);
    buffer_fini(&data);
    return status;
}

// The data of an event that stand in the results of its run.
static bf_status describe_event(store__connection *reader, const store__row *row,
                                api_event_type type, uint64_t item, bf_buffer *out, bf_error *err)
{
    if (type == API_EVENT_CURVE)
        return describe_curve(reader, row, item, out, err);
    return type == API_EVENT_SNAPSHOT ? describe_snapshot(reader, row, item, out, err)
                                      : describe_change(reader, row, item, out, err);
}

/// An event whose data stand in a buffer.
typedef struct copied_event {
    uint64_t id;
    api_event_type type;
    uint64_t snapshot;
    size_t which; ///< index of the run in the caller's list
    size_t at;    ///< where the data begin
    size_t n;     ///< bytes of data
} copied_event;

/// A merge of the events of several runs.
typedef struct event_merge {
    size_t n_runs;
    store__row *rows;                    ///< of the runs; number 0: there is none any more
    uint64_t heads[API_STREAM_RUNS_MAX]; ///< id of each run's next event; 0: none
    bf_buffer copied;                    ///< copied_event
    bf_buffer data;                      ///< of all of them
} event_merge;

static bf_status find_head(store__connection *reader, event_merge *merge, size_t which,
                           uint64_t after, bf_error *err)
{
    int64_t event = 0;

    BF_TRY(store__find_number(reader, STORE__SQL_NEXT_EVENT, &event, err,
                              INTEGER(merge->rows[which].rowid), INTEGER(after)));
    merge->heads[which] = (uint64_t)event;
    return BF_OK;
}

// Copies an event whose type, item and data are the columns from `first` on.
static bf_status copy_event(const store__query *q, int first, event_merge *merge, size_t which,
                            bf_error *err)
{
    copied_event copied = {
        .id = merge->heads[which],
        .type = (api_event_type)sqlite3_column_int(q->statement, first),
        .snapshot = (uint64_t)sqlite3_column_int64(q->statement, first + 1),
        .which = which,
        .at = merge->data.n,
    };

    if ((unsigned)copied.type >= API_EVENT_TYPE_COUNT)
        return bf_fail(err, BF_ECORRUPT, "", "event %llu is damaged",
                       (unsigned long long)copied.id);
    BF_TRY(store__column_bytes(q, first + 2, &merge->data, err));
    if (merge->data.n == copied.at)
        BF_TRY(describe_event(q->connection, &merge->rows[which], copied.type, copied.snapshot,
                              &merge->data, err));
    copied.n = merge->data.n - copied.at;
    // Each text keeps the terminating zero that append writes.
    if (buffer_append(&merge->data, "", 1) != BF_OK ||
        buffer_append(&merge->copied, &copied, sizeof copied) != BF_OK)
        return bf_fail_memory(err);
    return BF_OK;
}

static bf_status copy_head(store__connection *reader, event_merge *merge, size_t which,
                           bf_error *err)
{
    store__query q = store__start(reader, STORE__SQL_GET_EVENT, INTEGER(merge->heads[which]));
    bf_status status = BF_OK;
    const bool has_row = store__next(&q, &status, err);
    if (status == BF_OK)
        status = has_row ? copy_event(&q, 0, merge, which, err)
                         : bf_fail(err, BF_ECORRUPT, "", "an index of the store is damaged");
    store__end(&q);
    return status == BF_OK ? find_head(reader, merge, which, merge->heads[which], err) : status;
}

// The run whose next event is the oldest; n_runs if there are no more.
static size_t find_oldest(const event_merge *merge)
{
    size_t oldest = merge->n_runs;

    for (size_t i = 0; i < merge->n_runs; i++)
        if (merge->heads[i] != 0 &&
            (oldest == merge->n_runs || merge->heads[i] < merge->heads[oldest]))
            oldest = i;
    return oldest;
}

static bf_status begin_merge(store__connection *reader, const char (*runs)[API_ID_SIZE],
                             uint64_t after, event_merge *merge, bf_error *err)
{
    for (size_t i = 0; i < merge->n_runs; i++) {
        store__row *row = &merge->rows[i];
        bf_status found = store__find_row(reader, runs[i], row, err);
        if (found == BF_ENOTFOUND)
            continue;
        BF_TRY(found == BF_OK && row->run.last_event > after
                   ? find_head(reader, merge, i, after, err)
                   : found);
    }
    return BF_OK;
}

static bf_status copy_events(store__connection *reader, const char (*runs)[API_ID_SIZE],
                             uint64_t after, size_t limit_bytes, event_merge *merge, bf_error *err)
{
    bf_status status = begin_merge(reader, runs, after, merge, err);
    bool is_full = false;

    while (status == BF_OK && !is_full) {
        size_t which = find_oldest(merge);
        if (which == merge->n_runs)
            break;
        status = copy_head(reader, merge, which, err);
        is_full = merge->data.n >= limit_bytes;
    }
    return status;
}

static bf_status pass_events(const event_merge *merge, const char (*runs)[API_ID_SIZE],
                             api_event_fn *on_event, void *context, bf_error *err)
{
    const copied_event *copied = (const copied_event *)(const void *)merge->copied.bytes;
    size_t n = merge->copied.n / sizeof *copied;

    for (size_t i = 0; i < n; i++) {
        api_event event = {
            .id = copied[i].id,
            .type = copied[i].type,
            .snapshot = copied[i].snapshot,
            .n = copied[i].n,
            .data = merge->data.bytes + copied[i].at,
        };
        memcpy(event.run, runs[copied[i].which], sizeof event.run);
        BF_TRY(on_event(context, &event, err));
    }
    return BF_OK;
}

bf_status store_read_events(store *s, const char (*runs)[API_ID_SIZE], size_t n_runs,
                            uint64_t after, size_t limit_bytes, api_event_fn *on_event,
                            void *context, bf_error *err)
{
    event_merge merge = { .n_runs = n_runs };

    BF_CHECK(n_runs <= API_STREAM_RUNS_MAX);
    merge.rows = memory_alloc(n_runs, sizeof *merge.rows);
    if (merge.rows == NULL)
        return bf_fail_memory(err);
    store__connection *reader = store__acquire_reader(&s->pool);
    bf_status status = copy_events(reader, runs, after, limit_bytes, &merge, err);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        status = pass_events(&merge, runs, on_event, context, err);
    memory_free(merge.rows);
    buffer_fini(&merge.copied);
    buffer_fini(&merge.data);
    return status;
}

bf_status store_read_changes(store *s, const char *id, api_event_fn *on_event, void *context,
                             bf_error *err)
{
    char runs[1][API_ID_SIZE];
    store__connection *reader = store__acquire_reader(&s->pool);
    store__row row = { .rowid = 0 };
    event_merge merge = { .n_runs = 1, .rows = &row };

    snprintf(runs[0], sizeof runs[0], "%s", id);
    bf_status status = store__find_row(reader, id, &row, err);
    store__query q = store__start(reader, STORE__SQL_LIST_CHANGES, INTEGER(row.rowid));
    while (store__next(&q, &status, err)) {
        merge.heads[0] = (uint64_t)sqlite3_column_int64(q.statement, 0);
        status = copy_event(&q, 1, &merge, 0, err);
    }
    store__end(&q);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        status = pass_events(&merge, (const char(*)[API_ID_SIZE])runs, on_event, context, err);
    buffer_fini(&merge.copied);
    buffer_fini(&merge.data);
    return status;
}
