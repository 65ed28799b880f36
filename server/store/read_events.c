// Reading events of several runs in the order of their ids. They are copied before they are given
// away: whoever takes them may ask the store for more, and no reader waits for him.

#include "server/store/share_priv.h"

#include "core/base/check.h"
#include "core/base/memory.h"

#include <sqlite3.h>
#include <string.h>

/// An event whose data stand in a buffer.
typedef struct kept_event {
    uint64_t id;
    api_event_type type;
    uint64_t snapshot;
    size_t which; ///< index of the run in the caller's list
    size_t at;    ///< where the data begin
    size_t n;     ///< bytes of data
} kept_event;

/// A merge of the events of several runs.
typedef struct event_merge {
    size_t n_runs;
    store__row *rows;                    ///< of the runs; number 0: there is none any more
    uint64_t heads[API_STREAM_RUNS_MAX]; ///< id of each run's next event; 0: none
    bf_buffer kept;                      ///< kept_event
    bf_buffer data;                      ///< of all of them
} event_merge;

static bf_status find_head(store__connection *reader, event_merge *merge, size_t which,
                           uint64_t after, bf_error *err)
{
    bool has_row = false;

    store__query q = store__begin(reader, STORE__SQL_NEXT_EVENT);
    store__bind_integer(&q, merge->rows[which].number);
    store__bind_integer(&q, (int64_t)after);
    bf_status status = store__next(&q, &has_row, err);
    if (status == BF_OK)
        merge->heads[which] = has_row ? (uint64_t)sqlite3_column_int64(q.statement, 0) : 0;
    store__end(&q);
    return status;
}

static bf_status keep_row(const store__query *q, event_merge *merge, size_t which, bf_error *err)
{
    kept_event kept = {
        .id = merge->heads[which],
        .type = (api_event_type)sqlite3_column_int(q->statement, 0),
        .snapshot = (uint64_t)sqlite3_column_int64(q->statement, 1),
        .which = which,
        .at = merge->data.n,
    };

    bf_status status = store__column_bytes(q, 2, &merge->data, err);
    if (status == BF_OK && merge->data.n == kept.at)
        status = store__tell_shared(q->connection, &merge->rows[which], kept.type, kept.snapshot,
                                    &merge->data, err);
    if (status != BF_OK)
        return status;
    kept.n = merge->data.n - kept.at;
    // Each text keeps the terminating zero that append gives it.
    if (buffer_append(&merge->data, "", 1) != BF_OK ||
        buffer_append(&merge->kept, &kept, sizeof kept) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    return BF_OK;
}

static bf_status keep_head(store__connection *reader, event_merge *merge, size_t which,
                           bf_error *err)
{
    bool has_row = false;

    store__query q = store__begin(reader, STORE__SQL_GET_EVENT);
    store__bind_integer(&q, (int64_t)merge->heads[which]);
    bf_status status = store__next(&q, &has_row, err);
    if (status == BF_OK)
        status = has_row ? keep_row(&q, merge, which, err)
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
    bf_status status = BF_OK;

    for (size_t i = 0; i < merge->n_runs && status == BF_OK; i++) {
        store__row *row = &merge->rows[i];
        bf_status found = store__find_row(reader, runs[i], row, err);
        if (found == BF_ENOTFOUND)
            continue;
        status = found == BF_OK && row->run.last_event > after
                     ? find_head(reader, merge, i, after, err)
                     : found;
    }
    return status;
}

static bf_status keep_events(store__connection *reader, const char (*runs)[API_ID_SIZE],
                             uint64_t after, size_t limit_bytes, event_merge *merge, bf_error *err)
{
    bf_status status = begin_merge(reader, runs, after, merge, err);
    bool is_full = false;

    while (status == BF_OK && !is_full) {
        size_t which = find_oldest(merge);
        if (which == merge->n_runs)
            break;
        status = keep_head(reader, merge, which, err);
        is_full = merge->data.n >= limit_bytes;
    }
    return status;
}

static bf_status give_events(const event_merge *merge, const char (*runs)[API_ID_SIZE],
                             api_event_fn *take, void *take_context, bf_error *err)
{
    const kept_event *kept = (const kept_event *)(const void *)merge->kept.bytes;
    size_t n = merge->kept.n / sizeof *kept;
    bf_status status = BF_OK;

    for (size_t i = 0; i < n && status == BF_OK; i++) {
        api_event event = {
            .id = kept[i].id,
            .type = kept[i].type,
            .snapshot = kept[i].snapshot,
            .n = kept[i].n,
            .data = merge->data.bytes + kept[i].at,
        };
        memcpy(event.run, runs[kept[i].which], sizeof event.run);
        status = take(take_context, &event, err);
    }
    return status;
}

bf_status store_read_events(store *s, const char (*runs)[API_ID_SIZE], size_t n_runs,
                            uint64_t after, size_t limit_bytes, api_event_fn *take,
                            void *take_context, bf_error *err)
{
    store__connection *reader = NULL;
    event_merge merge = { .n_runs = n_runs };

    BF_CHECK(n_runs <= API_STREAM_RUNS_MAX);
    merge.rows = memory_alloc(n_runs, sizeof *merge.rows);
    if (merge.rows == NULL)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    bf_status status = store__take_reader(s, &reader, err);
    if (status == BF_OK) {
        status = keep_events(reader, runs, after, limit_bytes, &merge, err);
        store__give_reader(s, reader);
    }
    if (status == BF_OK)
        status = give_events(&merge, runs, take, take_context, err);
    memory_free(merge.rows);
    buffer_fini(&merge.kept);
    buffer_fini(&merge.data);
    return status;
}
