// Whose run is next. Runs by themselves come before trials of studies, so a study of any size delays none of them.

#include "server/store/turns.h"

#include "server/store/quotas.h"
#include "server/store/studies_priv.h"

#include <stdlib.h>
#include <string.h>

/// A run that waits, the next one of its owner.
typedef struct candidate {
    store__row row;
    int64_t turn; ///< when its owner was served last
} candidate;

static bool comes_before(const candidate *a, const candidate *b)
{
    if (a->row.run.priority != b->row.run.priority)
        return a->row.run.priority > b->row.run.priority;
    if (a->turn != b->turn)
        return a->turn < b->turn;
    return strcmp(a->row.run.id, b->row.run.id) < 0;
}

// Take what waits into account. Quotas are read only of what would be next.
static bf_status consider(store__connection *reader, const store *s, candidate *c, candidate *best,
                          bool *has_best, bf_error *err)
{
    bool is_over = false;

    bf_status status =
        store__find_number(reader, STORE__SQL_GET_TURN, &c->turn, err, TEXT(c->row.run.owner));
    if (status != BF_OK || (*has_best && !comes_before(c, best)))
        return status;
    status = store__is_held(reader, s, c->row.run.owner, &is_over, err);
    if (status != BF_OK || is_over)
        return status;
    *best = *c;
    *has_best = true;
    return BF_OK;
}

static bf_status find_single(store__connection *reader, const store *s, store__row *ret_row,
                             bf_error *err)
{
    candidate c = { .turn = 0 }, best;
    bool has_row = false, has_best = false, has_any = false;

    // No name comes before nobody's.
    BF_TRY(store__find(reader, STORE__SQL_NEXT_QUEUED_OWNED, &store__run_record, &c.row, &has_row,
                       err, TEXT("")));
    if (!has_row)
        BF_TRY(store__find(reader, STORE__SQL_NEXT_QUEUED_BEHIND, &store__run_record, &c.row,
                           &has_row, err, TEXT("")));
    while (has_row) {
        has_any = true;
        BF_TRY(consider(reader, s, &c, &best, &has_best, err));
        BF_TRY(store__find(reader, STORE__SQL_NEXT_QUEUED_BEHIND, &store__run_record, &c.row,
                           &has_row, err, TEXT(c.row.run.owner)));
    }
    if (has_best)
        *ret_row = best.row;
    else if (has_any)
        return bf_fail(err, BF_ELIMIT, "", "all runs that wait are beyond their owners' quotas");
    else
        return bf_fail(err, BF_ENOTFOUND, "", "no run is queued");
    return BF_OK;
}

/// A study that is running.
typedef struct running {
    char id[API_ID_SIZE];
    int64_t priority;
    int64_t owners_turn; ///< when a trial of its owner began last
    int64_t turn;        ///< when one of its own did
} running;

static const store__column running_columns[] = {
    COLUMN(TEXT, running, id),
    COLUMN(INTEGER, running, priority),
    COLUMN(INTEGER, running, owners_turn),
    COLUMN(INTEGER, running, turn),
};
static const store__record running_record = RECORD(running_columns, running, NULL);

static int compare_turns(const void *a, const void *b)
{
    const running *x = a, *y = b;

    if (x->priority != y->priority)
        return x->priority > y->priority ? -1 : 1;
    if (x->owners_turn != y->owners_turn)
        return x->owners_turn < y->owners_turn ? -1 : 1;
    return (x->turn > y->turn) - (x->turn < y->turn);
}

// The first trial of a study that waits, if its owner may have it solved.
static bf_status find_trial_of(store__connection *reader, const store *s, const running *r,
                               store__row *ret_row, bool *ret_has_row, bool *ret_is_held,
                               bf_error *err)
{
    bf_status status = store__find(reader, STORE__SQL_NEXT_WAITING_TRIAL, &store__run_record,
                                   ret_row, ret_has_row, err, TEXT(r->id));

    if (status != BF_OK || !*ret_has_row)
        return status;
    return store__is_held(reader, s, ret_row->run.owner, ret_is_held, err);
}

static bf_status find_trial(store__connection *reader, const store *s, store__row *ret_row,
                            bf_error *err)
{
    running all[STORE_STUDIES_RUNNING_MAX];
    bool has_row = false, is_held = false, has_held = false;
    size_t n = 0;

    bf_status status =
        store__list(reader, STORE__SQL_LIST_STUDY_TURNS, &running_record, all,
                    STORE_STUDIES_RUNNING_MAX, &n, NULL, err, INTEGER(STORE_STUDIES_RUNNING_MAX));
    if (n > 1)
        qsort(all, n, sizeof *all, compare_turns);
    for (size_t k = 0; k < n && status == BF_OK; k++) {
        status = find_trial_of(reader, s, &all[k], ret_row, &has_row, &is_held, err);
        if (status == BF_OK && has_row && !is_held)
            return BF_OK;
        has_held = has_held || has_row;
    }
    if (status != BF_OK)
        return status;
    if (has_held)
        return bf_fail(err, BF_ELIMIT, "", "all trials that wait are beyond their owners' quotas");
    return bf_fail(err, BF_ENOTFOUND, "", "no trial is queued");
}

bf_status store__find_next(store__connection *reader, const store *s, bool with_trials,
                           store__row *ret_row, bf_error *err)
{
    bf_status status = find_single(reader, s, ret_row, err);

    if (!with_trials || (status != BF_ENOTFOUND && status != BF_ELIMIT))
        return status;
    const bf_status of_trials = find_trial(reader, s, ret_row, err);
    return of_trials == BF_ENOTFOUND ? status : of_trials;
}

bf_status store__end_turn(store__connection *writer, const store__row *row, bf_error *err)
{
    const bool is_trial = row->run.study[0] != '\0';
    const char *whose = is_trial ? row->run.study : row->run.owner;

    return store__exec(writer, is_trial ? STORE__SQL_END_STUDY_TURN : STORE__SQL_END_TURN, err,
                       TEXT(whose));
}

bf_status store__check_study(store__connection *writer, const store__row *row, bf_error *err)
{
    store_study found;

    if (row->run.study[0] == '\0')
        return BF_OK;
    BF_TRY(store__find_study(writer, row->run.study, &found, err));
    if (found.study.state != API_STUDY_RUNNING || found.stop_request != STORE_STOP_NONE)
        return bf_fail(err, BF_ECONFLICT, "", "the study of the trial is not running");
    return BF_OK;
}
