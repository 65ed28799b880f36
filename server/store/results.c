// Sets of results. A run that is solved has one of its own; a run whose results are known joins the
// set of the run that was solved before (I10). Samples, snapshots and chunks belong to sets; texts
// and events to runs.
//
// The curve and snapshot events of a run that joined a set are rows without data: what they say
// stands in the set, and only the run's id differs from what the other runs' events say. So are those of photo eyes and
// actions of all runs. Of key figures the last event is copied, with the other id.

#include "server/store/store_priv.h"
#include "server/store/texts.h"

#include "server/base/solver.h"

#include <sqlite3.h>
#include <string.h>

enum {
    COLLECT_CHUNKS = 64,      // that are deleted in one transaction
    REUSED_CHANGES_MAX = 5000 // of photo eyes and plates, which a run that is reused has copied
};

bf_status store__insert_results(store__connection *writer, const unsigned char *digest,
                                store__row *row, bf_error *err)
{
    char solver[SOLVER_NAME_SIZE];

    (void)solver_name(solver);
    BF_TRY(store__exec(writer, STORE__SQL_INSERT_RESULTS, err,
                       BLOB(digest, digest == NULL ? 0 : STORE__DIGEST_SIZE), TEXT(solver)));
    row->results = sqlite3_last_insert_rowid(writer->db);
    return BF_OK;
}

bf_status store__mark_results(store__connection *writer, int64_t results, store__results state,
                              bf_error *err)
{
    return store__exec(writer, STORE__SQL_MARK_RESULTS, err, INTEGER(results), INTEGER(state));
}

bf_status store__invalidate_results(store__connection *writer, bf_error *err)
{
    char solver[SOLVER_NAME_SIZE];

    (void)solver_name(solver);
    return store__exec(writer, STORE__SQL_INVALIDATE_RESULTS, err, TEXT(solver));
}

// Whether the results are so dear to copy that the same work is rather done again, at the cost of who asks.
static bf_status is_dear(store__connection *c, const store__row *solved, bool *ret_is_dear,
                         bf_error *err)
{
    int64_t n = 0;

    BF_TRY(store__find_number(c, STORE__SQL_COUNT_SOME_CHANGES, &n, err, INTEGER(solved->rowid),
                              INTEGER(REUSED_CHANGES_MAX + 1)));
    *ret_is_dear = n > REUSED_CHANGES_MAX;
    return BF_OK;
}

bf_status store__find_solved(store__connection *c, const unsigned char digest[STORE__DIGEST_SIZE],
                             store__row *row, bool *ret_is_solved, bf_error *err)
{
    char solver[SOLVER_NAME_SIZE];
    bool has_too_many = false;

    (void)solver_name(solver);
    bf_status status =
        store__find(c, STORE__SQL_FIND_SOLVED, &store__run_record, row, ret_is_solved, err,
                    BLOB(digest, STORE__DIGEST_SIZE), TEXT(solver));
    if (status == BF_OK && *ret_is_solved)
        status = is_dear(c, row, &has_too_many, err);
    *ret_is_solved = *ret_is_solved && !has_too_many;
    return status;
}

// Copies a text as it is.
static bf_status copy_text(store__connection *writer, int64_t from, int64_t to, store__text kind,
                           bf_error *err)
{
    bf_buffer text = { 0 };

    bf_status status = store__get_text(writer, from, kind, &text, err);
    if (status == BF_OK)
        status = store__put_text(writer, to, kind, text.bytes, text.n, err);
    buffer_fini(&text);
    return status;
}

static bf_status copy_texts(store__connection *writer, const store__row *solved,
                            const bf_buffer *scenario, const bf_buffer *summary, store__row *row,
                            bf_error *err)
{
    BF_TRY(copy_text(writer, solved->rowid, row->rowid, STORE__TEXT_COLUMNS, err));
    if (row->run.figures[0] != '\0')
        BF_TRY(copy_text(writer, solved->rowid, row->rowid, STORE__TEXT_FIGURES, err));
    BF_TRY(store__put_run_text(writer, row, STORE__TEXT_SCENARIO, scenario->bytes, scenario->n,
                               &row->n_bytes, err));
    if (row->run.has_summary)
        BF_TRY(store__put_run_text(writer, row, STORE__TEXT_SUMMARY, summary->bytes, summary->n,
                                   &row->n_bytes, err));
    return BF_OK;
}

static bf_status copy_events(store__connection *writer, const store__row *solved,
                             const store__row *row, bf_error *err)
{
    return store__exec(writer, STORE__SQL_COPY_EVENTS, err, INTEGER(row->rowid),
                       INTEGER(solved->rowid), TEXT(row->run.id), TEXT(solved->run.id));
}

bf_status store__reuse_results(store__connection *writer, const store__row *solved,
                               const bf_buffer *scenario, const bf_buffer *summary, store__row *row,
                               bf_error *err)
{
    int64_t n = 0; // bytes of the events

    row->results = solved->results;
    row->run.grid = solved->run.grid;
    row->run.parts = solved->run.parts;
    row->run.state = RUN_SUCCEEDED;
    row->run.is_cached = true;
    row->run.progress = 1.0;
    row->run.finished_ms = row->run.created_ms;
    row->run.n_samples = solved->run.n_samples;
    row->run.n_snapshots = solved->run.n_snapshots;
    row->run.has_summary = solved->run.has_summary;
    memcpy(row->run.figures, solved->run.figures, sizeof row->run.figures);
    BF_TRY(store__insert_row(writer, row, err));
    BF_TRY(copy_texts(writer, solved, scenario, summary, row, err));
    BF_TRY(copy_events(writer, solved, row, err));
    BF_TRY(store__find_number(writer, STORE__SQL_SUM_EVENTS, &n, err, INTEGER(row->rowid)));
    row->n_bytes += (uint64_t)n;
    return store__emit_events(writer, row, err);
}

static bf_status collect(store__connection *writer, int64_t results, bool *ret_is_over,
                         bf_error *err)
{
    BF_TRY(store__exec(writer, STORE__SQL_COLLECT_CHUNKS, err, INTEGER(results),
                       INTEGER(COLLECT_CHUNKS)));
    *ret_is_over = sqlite3_changes(writer->db) < COLLECT_CHUNKS;
    // Foreign keys delete with the set the samples and snapshots that refer to it (I9).
    return *ret_is_over ? store__exec(writer, STORE__SQL_DELETE_RESULTS, err, INTEGER(results))
                        : store__mark_results(writer, results, STORE__RESULTS_ORPHANED, err);
}

bf_status store__collect_results(store__connection *writer, int64_t results, bool *ret_is_over,
                                 bf_error *err)
{
    int64_t are_used = 0;

    BF_TRY(store__find_number(writer, STORE__SQL_ARE_USED, &are_used, err, INTEGER(results)));
    bool is_over = are_used != 0;
    if (!is_over)
        BF_TRY(collect(writer, results, &is_over, err));
    *ret_is_over = is_over;
    return BF_OK;
}

// Foreign keys delete with the row the texts and events that refer to it (I9).
bf_status store__remove_row(store__connection *writer, const store__row *row, bool *ret_is_over,
                            bf_error *err)
{
    BF_TRY(store__exec(writer, STORE__SQL_DELETE_RUN, err, INTEGER(row->rowid)));
    return store__collect_results(writer, row->results, ret_is_over, err);
}
