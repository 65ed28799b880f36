#include "server/store/store_priv.h"

#include "server/base/clock.h"

#include <math.h>
#include <sqlite3.h>

// Pages of an old store have no sums, and another program may have written a row. A number that stands for nothing, and
// an id by which the run is not found again, must not get any further.
static bool is_possible(const store__row *row)
{
    return (unsigned)row->run.state < RUN_STATE_COUNT &&
           (unsigned)row->run.model < RUN_MODEL_COUNT &&
           (unsigned)row->stop_request <= STORE_STOP_KILL && row->run.finished_ms >= 0;
}

static bf_status check_row(const store__query *q, void *of, bool is_whole, bf_error *err)
{
    store__row *row = of;

    (void)q;
    row->run.predicted_s = (double)NAN;
    if (!is_whole || !is_possible(row))
        return bf_fail(err, BF_ECORRUPT, "", "the row of the run %.40s is damaged", row->run.id);
    return BF_OK;
}

#define X(kind, column, member) COLUMN(kind, store__row, member),
static const store__column columns[] = { COLUMN(INTEGER, store__row, rowid), STORE__RUN_LIST(X) };
#undef X

const store__record store__run_record = RECORD(columns, store__row, check_row);

bf_status store__find_row(store__connection *c, const char *id, store__row *row, bf_error *err)
{
    bool has_row = false;

    BF_TRY(store__find(c, STORE__SQL_FIND_RUN, &store__run_record, row, &has_row, err, TEXT(id)));
    if (!has_row)
        return bf_fail(err, BF_ENOTFOUND, "", "there is no run %.40s", id);
    return BF_OK;
}

#define X(kind, column, member) kind(row->member),

bf_status store__insert_row(store__connection *writer, store__row *row, bf_error *err)
{
    BF_TRY(store__exec(writer, STORE__SQL_INSERT_RUN, err, STORE__RUN_LIST(X)));
    row->rowid = sqlite3_last_insert_rowid(writer->db);
    return BF_OK;
}

bf_status store__save_row(store__connection *writer, store__row *row, bf_error *err)
{
    row->run.revision++;
    return store__exec(writer, STORE__SQL_UPDATE_RUN, err, INTEGER(row->run.revision),
                       STORE__RUN_CHANGING(X) INTEGER(row->rowid));
}

#undef X

static bf_status close_row(store__connection *writer, store__row *row, bf_error *err)
{
    row->run.finished_ms = clock_unix_ms();
    row->checkpoint_step = 0;
    bf_status status = store__delete_chunks(writer, row->results, STORE__BLOB_CHECKPOINT, 0, err);
    if (status != BF_OK || row->run.state != RUN_SUCCEEDED)
        return status;
    row->run.progress = 1.0;
    return store__mark_results(
        writer, row->results,
        row->run.is_suspect ? STORE__RESULTS_SUSPECT : STORE__RESULTS_COMPLETE, err);
}

bf_status store__transition(store__connection *writer, store__row *row, run_state to, bf_error *err)
{
    const bool was_running = row->run.state == RUN_RUNNING;

    if (to == RUN_QUEUED && row->stop_request != STORE_STOP_NONE)
        to = RUN_CANCELLED; // I14
    if (!run_state_may_follow(row->run.state, to))
        return bf_fail(err, BF_ECONFLICT, "", "the run is %s and cannot become %s",
                       run_state_word(row->run.state), run_state_word(to));
    row->run.state = to;
    row->run.eta_s = NAN;
    row->stop_request = STORE_STOP_NONE;
    row->external_id[0] = '\0';
    if (to == RUN_RUNNING)
        row->run.started_ms = clock_unix_ms();
    if (to == RUN_QUEUED && writer->queued_at_most < SIZE_MAX)
        writer->queued_at_most++;
    if (was_running)
        BF_TRY(store__delete_open_snapshots(writer, row->results, row->run.n_snapshots, err));
    if (run_state_is_end(to))
        BF_TRY(close_row(writer, row, err));
    BF_TRY(store__exec(writer, STORE__SQL_MOVE_RUN, err, INTEGER(row->run.state),
                       INTEGER(row->run.finished_ms), INTEGER(row->rowid)));
    return store__emit_events(writer, row, err);
}
