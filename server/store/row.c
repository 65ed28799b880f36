#include "server/store/share_priv.h"

#include "api/results/events.h"
#include "server/base/clock.h"

#include <math.h>
#include <sqlite3.h>
#include <string.h>

// Codes are stored by their words, so that the list of codes may grow anywhere.
static bf_status find_code(const char *word)
{
    for (int code = BF_OK + 1; code < BF_STATUS_COUNT; code++)
        if (strcmp(word, bf_status_word((bf_status)code)) == 0)
            return (bf_status)code;
    return BF_OK;
}

static void read_error(const store__query *q, int column, bf_error *ret_error)
{
    char word[32];

    store__column_text(q, column, word, sizeof word);
    ret_error->code = find_code(word);
    store__column_text(q, column + 1, ret_error->pointer, sizeof ret_error->pointer);
    store__column_text(q, column + 2, ret_error->text, sizeof ret_error->text);
}

static void read_grid(sqlite3_stmt *statement, int column, bf_grid *ret_grid)
{
    ret_grid->n1 = (size_t)sqlite3_column_int64(statement, column);
    ret_grid->n2 = (size_t)sqlite3_column_int64(statement, column + 1);
    ret_grid->lower1 = sqlite3_column_double(statement, column + 2);
    ret_grid->lower2 = sqlite3_column_double(statement, column + 3);
    ret_grid->d1 = sqlite3_column_double(statement, column + 4);
    ret_grid->d2 = sqlite3_column_double(statement, column + 5);
}

void store__read_row(const store__query *q, store__row *ret_row)
{
    sqlite3_stmt *statement = q->statement;
    store__row row = { .number = sqlite3_column_int64(statement, 0) };

    store__column_text(q, 1, row.run.id, sizeof row.run.id);
    row.run.state = (run_state)sqlite3_column_int(statement, 2);
    row.run.model = (run_model)sqlite3_column_int(statement, 3);
    row.run.priority = sqlite3_column_int(statement, 4);
    store__column_text(q, 5, row.run.label, sizeof row.run.label);
    store__column_text(q, 6, row.run.name, sizeof row.run.name);
    row.run.revision = (uint64_t)sqlite3_column_int64(statement, 7);
    row.run.progress = sqlite3_column_double(statement, 8);
    row.run.created_ms = sqlite3_column_int64(statement, 9);
    row.run.started_ms = sqlite3_column_int64(statement, 10);
    row.run.finished_ms = sqlite3_column_int64(statement, 11);
    row.run.eta_s = store__column_real(q, 12);
    row.wall_s = sqlite3_column_double(statement, 13);
    row.run.n_samples = (uint64_t)sqlite3_column_int64(statement, 14);
    row.run.n_snapshots = (uint64_t)sqlite3_column_int64(statement, 15);
    row.run.last_event = (uint64_t)sqlite3_column_int64(statement, 16);
    row.run.has_summary = sqlite3_column_int(statement, 17) != 0;
    read_error(q, 18, &row.run.error);
    row.checkpoint_step = (uint64_t)sqlite3_column_int64(statement, 21);
    read_grid(statement, 22, &row.grid);
    row.parts.n_parts = (uint64_t)sqlite3_column_int64(statement, 28);
    row.parts.n_values = (uint32_t)sqlite3_column_int64(statement, 29);
    row.results = sqlite3_column_int64(statement, 30);
    row.run.is_cached = sqlite3_column_int(statement, 31) != 0;
    *ret_row = row;
}

bf_status store__find_first(store__connection *c, store__sql sql, store__row *ret_row,
                            bool *ret_has_row, bf_error *err)
{
    store__query q = store__begin(c, sql);
    bf_status status = store__next(&q, ret_has_row, err);
    if (status == BF_OK && *ret_has_row)
        store__read_row(&q, ret_row);
    store__end(&q);
    return status;
}

bf_status store__find_row(store__connection *c, const char *id, store__row *ret_row, bf_error *err)
{
    bool has_row = false;

    store__query q = store__begin(c, STORE__SQL_FIND_RUN);
    store__bind_text(&q, id, strlen(id));
    bf_status status = store__next(&q, &has_row, err);
    if (status == BF_OK && has_row)
        store__read_row(&q, ret_row);
    store__end(&q);
    if (status == BF_OK && !has_row)
        return bf_fail(err, BF_ENOTFOUND, "", "there is no run %.40s", id);
    return status;
}

bf_status store__insert_row(store__connection *writer, store__row *row, bf_error *err)
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
    store__bind_integer(&q, row->results);
    store__bind_integer(&q, record->is_cached);
    bf_status status = store__run(&q, err);
    if (status == BF_OK)
        row->number = sqlite3_last_insert_rowid(writer->db);
    return status;
}

static void bind_error(store__query *q, const bf_error *error)
{
    const char *word = error->code == BF_OK ? "" : bf_status_word(error->code);

    store__bind_text(q, word, strlen(word));
    store__bind_text(q, error->pointer, strlen(error->pointer));
    store__bind_text(q, error->text, strlen(error->text));
}

static void bind_grid(store__query *q, const bf_grid *grid)
{
    store__bind_integer(q, (int64_t)grid->n1);
    store__bind_integer(q, (int64_t)grid->n2);
    store__bind_real(q, grid->lower1);
    store__bind_real(q, grid->lower2);
    store__bind_real(q, grid->d1);
    store__bind_real(q, grid->d2);
}

static bf_status update_row(store__connection *writer, const store__row *row, bf_error *err)
{
    const api_run *record = &row->run;

    store__query q = store__begin(writer, STORE__SQL_UPDATE_RUN);
    store__bind_integer(&q, row->number);
    store__bind_integer(&q, record->state);
    store__bind_integer(&q, (int64_t)record->revision);
    store__bind_real(&q, record->progress);
    store__bind_integer(&q, record->started_ms);
    store__bind_integer(&q, record->finished_ms);
    store__bind_real(&q, record->eta_s);
    store__bind_real(&q, row->wall_s);
    store__bind_integer(&q, (int64_t)record->n_samples);
    store__bind_integer(&q, (int64_t)record->n_snapshots);
    store__bind_integer(&q, (int64_t)record->last_event);
    store__bind_integer(&q, record->has_summary);
    bind_error(&q, &record->error);
    store__bind_integer(&q, (int64_t)row->checkpoint_step);
    bind_grid(&q, &row->grid);
    store__bind_integer(&q, (int64_t)row->parts.n_parts);
    store__bind_integer(&q, row->parts.n_values);
    return store__run(&q, err);
}

bf_status store__save_row(store__connection *writer, store__row *row, bf_error *err)
{
    row->run.revision++;
    return update_row(writer, row, err);
}

bf_status store__insert_event(store__connection *writer, store__row *row, api_event_type type,
                              uint64_t item, const bf_buffer *data, bf_error *err)
{
    store__query q = store__begin(writer, STORE__SQL_INSERT_EVENT);
    store__bind_integer(&q, row->number);
    store__bind_integer(&q, type);
    store__bind_integer(&q, (int64_t)item);
    store__bind_text(&q, data->bytes, data->n);
    bf_status status = store__run(&q, err);
    if (status == BF_OK)
        row->run.last_event = (uint64_t)sqlite3_last_insert_rowid(writer->db);
    return status;
}

bf_status store__tell_row(store__connection *writer, store__row *row, bf_error *err)
{
    bf_buffer data = { 0 };

    row->run.revision++;
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
    return status == BF_OK ? update_row(writer, row, err) : status;
}

static bf_status close_row(store__connection *writer, store__row *row, bf_error *err)
{
    row->run.finished_ms = clock_unix_ms();
    row->checkpoint_step = 0;
    bf_status status = store__delete_chunks(writer, row->results, STORE__BLOB_CHECKPOINT, 0, err);
    if (status != BF_OK || row->run.state != RUN_SUCCEEDED)
        return status;
    row->run.progress = 1.0;
    return store__mark_results(writer, row->results, STORE__RESULTS_COMPLETE, err);
}

bf_status store__move_row(store__connection *writer, store__row *row, run_state to, bf_error *err)
{
    bf_status status = BF_OK;

    if (!run_state_may_follow(row->run.state, to))
        return bf_fail(err, BF_ECONFLICT, "", "the run is %s and cannot become %s",
                       run_state_word(row->run.state), run_state_word(to));
    row->run.state = to;
    row->run.eta_s = NAN;
    if (to == RUN_RUNNING)
        row->run.started_ms = clock_unix_ms();
    if (to == RUN_QUEUED && writer->queued_at_most < SIZE_MAX)
        writer->queued_at_most++;
    if (run_state_is_end(to))
        status = close_row(writer, row, err);
    return status == BF_OK ? store__tell_row(writer, row, err) : status;
}
