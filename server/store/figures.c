#include "server/store/store_priv.h"

#include <sqlite3.h>
#include <stdio.h>
#include <sys/stat.h>

static bf_status count_states(store__connection *writer, store_figures *figures, bf_error *err)
{
    bool has_row = true;

    store__query q = store__begin(writer, STORE__SQL_COUNT_STATES);
    bf_status status = store__next(&q, &has_row, err);
    while (status == BF_OK && has_row) {
        int state = sqlite3_column_int(q.statement, 0);
        if (state >= 0 && state < RUN_STATE_COUNT)
            figures->n_runs[state] = (uint64_t)sqlite3_column_int64(q.statement, 1);
        status = store__next(&q, &has_row, err);
    }
    store__end(&q);
    return status;
}

static bf_status find_oldest(store__connection *writer, store_figures *figures, bf_error *err)
{
    bool has_row = false;

    store__query q = store__begin(writer, STORE__SQL_OLDEST_QUEUED);
    bf_status status = store__next(&q, &has_row, err);
    if (status == BF_OK && has_row)
        figures->oldest_queued_ms = sqlite3_column_int64(q.statement, 0);
    store__end(&q);
    return status;
}

// Opening the database's files would do harm, looking at them does none.
static uint64_t size_of(const char *path, const char *ending)
{
    char whole[STORE__PATH_SIZE + 8];
    struct stat found;

    (void)snprintf(whole, sizeof whole, "%s%s", path, ending);
    return stat(whole, &found) == 0 ? (uint64_t)found.st_size : 0;
}

bf_status store__count(store *s, store_figures *ret_figures, bf_error *err)
{
    store_figures figures = { .file_bytes = size_of(s->path, ""),
                              .log_bytes = size_of(s->path, "-wal") };

    bf_status status = count_states(&s->writer, &figures, err);
    if (status == BF_OK)
        status = find_oldest(&s->writer, &figures, err);
    if (status == BF_OK)
        *ret_figures = figures;
    return status;
}

void store_read_figures(store *s, store_figures *ret_figures)
{
    lock_take(&s->lock);
    *ret_figures = s->tally.figures;
    lock_give(&s->lock);
}

void store_set_queue_limit(store *s, size_t limit)
{
    s->queue_limit = limit;
}

void store_set_client_quota(store *s, size_t quota)
{
    s->client_quota = quota;
}

bool store_is_alive(store *s)
{
    bool is_alive = !pulse_is_asked(&s->tally.pulse);

    lock_take(&s->lock);
    pulse_ask(&s->tally.pulse);
    lock_wake_all(&s->writing.filled);
    lock_give(&s->lock);
    return is_alive;
}
