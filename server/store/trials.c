// Trials of studies: a step of a study writes the ends of some and the begins of others in one transaction, so that who works
// on it goes on from any step. What is known of a trial's run stands in the run.

#include "server/store/quotas.h"
#include "server/store/studies_priv.h"
#include "server/store/submit.h"

#include "core/base/memory.h"

enum { TRIALS_A_STEP = 1000 }; // that are removed in one transaction

static uint64_t count_ended(const api_study *about)
{
    uint64_t n = 0;

    for (size_t state = 0; state < API_TRIAL_STATES; state++)
        n += about->n_ended[state];
    return n;
}

static bf_status end_trial(store__connection *writer, store_study *row, const api_trial *trial,
                           bf_error *err)
{
    bf_status status =
        store__exec(writer, STORE__SQL_END_TRIAL, err, INTEGER(row->rowid), INTEGER(trial->number),
                    INTEGER(trial->state), INTEGER(count_ended(&row->study) + 1),
                    BLOB(trial->values, trial->n_values * sizeof *trial->values),
                    CODE(trial->fault.code), TEXT(trial->fault.pointer), TEXT(trial->fault.text));

    if (status == BF_OK && sqlite3_changes(writer->db) == 1)
        row->study.n_ended[trial->state]++;
    return status;
}

static bf_status insert_trial(store__connection *writer, store_study *row, store_trial_begin *begin,
                              bf_error *err)
{
    api_trial *trial = &begin->trial;
    const bool has_ended = api_trial_state_is_end(trial->state);

    trial->ended = has_ended ? count_ended(&row->study) + 1 : 0;
#define X(kind, column, member) , kind(trial->member)
    bf_status status = store__exec(
        writer, STORE__SQL_INSERT_TRIAL, err, INTEGER(row->rowid),
        BLOB(trial->parameters, trial->n_parameters * sizeof *trial->parameters),
        BLOB(trial->values, trial->n_values * sizeof *trial->values) STORE__TRIAL_LIST(X));
#undef X
    if (status == BF_OK) {
        row->study.n_trials++;
        row->study.n_ended[trial->state] += has_ended;
    }
    return status;
}

static bf_status begin_trial(store__connection *writer, store_study *row, store_trial_begin *begin,
                             bf_error *err)
{
    if (begin->trial.number != row->study.n_trials)
        return bf_fail(err, BF_ECORRUPT, "", "a study's trials have a gap");
    begin->trial.run[0] = '\0';
    if (begin->submission != NULL)
        BF_TRY(
            store__submit_trial(writer, begin->submission, row->study.id, begin->trial.run, err));
    return insert_trial(writer, row, begin, err);
}

/// A step, and the study that it is of.
typedef struct step_context {
    store *store;
    const store_study_step *step;
    store_study row;
} step_context;

static bf_status write_trials(store__connection *writer, step_context *context, bf_error *err)
{
    const store_study_step *step = context->step;
    store_study *row = &context->row;

    for (size_t k = 0; k < step->n_ends; k++)
        BF_TRY(end_trial(writer, row, &step->ends[k], err));
    if (step->n_begins > 0)
        BF_TRY(store__check_room(context->store, err));
    for (size_t k = 0; k < step->n_begins; k++)
        BF_TRY(begin_trial(writer, row, &step->begins[k], err));
    return BF_OK;
}

static bf_status apply_step(store__connection *writer, store__operation *operation, bf_error *err)
{
    step_context *context = operation->context;
    const store_study_step *step = context->step;
    store_study *row = &context->row;

    BF_TRY(store__find_study(writer, step->id, row, err));
    const bool is_running =
        row->study.state == API_STUDY_RUNNING && row->stop_request == STORE_STOP_NONE;
    if (api_study_state_is_end(row->study.state) || (step->n_begins > 0 && !is_running))
        return bf_fail(err, BF_ECONFLICT, "", "the study is %s",
                       api_study_state_word(row->study.state));
    BF_TRY(write_trials(writer, context, err));
    if (step->best != NULL)
        BF_TRY(store__put_study_text(writer, row, API_STUDY_BEST, step->best, err));
    if (step->state < API_STUDY_STATES) {
        row->study.error = step->error;
        BF_TRY(store__move_study(row, step->state, err));
    }
    if (step->cpu_s > 0.0)
        BF_TRY(store__charge_owner(writer, row->study.owner, step->cpu_s, err));
    memcpy(operation->changed, row->study.id, API_ID_SIZE);
    return store__save_study(writer, row, err);
}

bf_status store_step_study(store *s, const store_study_step *step, api_study *ret_study,
                           bf_error *err)
{
    step_context context = { .store = s, .step = step };

    // Ends need no room of their own, begins have checked for theirs.
    BF_TRY(store__write_freeing(s, apply_step, &context, err));
    *ret_study = context.row.study;
    return BF_OK;
}

static bool read_doubles(const store__query *q, int column, double *ret_values, size_t size,
                         size_t *ret_n)
{
    const size_t n_bytes = (size_t)sqlite3_column_bytes(q->statement, column);
    const void *bytes = sqlite3_column_blob(q->statement, column);

    *ret_n = n_bytes / sizeof(double);
    if (n_bytes % sizeof(double) != 0 || *ret_n > size)
        return false;
    if (n_bytes > 0)
        memcpy(ret_values, bytes, n_bytes);
    return true;
}

#define X(kind, column, member) COLUMN(kind, api_trial, member),
static const store__column columns[] = { STORE__TRIAL_LIST(X) };
#undef X

// Of an open trial the state is that of its run: one that has ended will be told of soon.
static bf_status complete_trial(const store__query *q, void *of, bool is_whole, bf_error *err)
{
    enum { PARAMETERS = sizeof columns / sizeof *columns, VALUES, STATE_OF_RUN };
    api_trial *t = of;

    (void)is_whole; // a trial has no id of its own
    if ((unsigned)t->model >= RUN_MODEL_COUNT || (unsigned)t->state >= API_TRIAL_STATES ||
        !read_doubles(q, PARAMETERS, t->parameters, STUDY_PARAMETERS, &t->n_parameters) ||
        !read_doubles(q, VALUES, t->values, STUDY_VALUES, &t->n_values))
        return bf_fail(err, BF_ECORRUPT, "", "the stored trial %llu is damaged",
                       (unsigned long long)t->number);
    if (t->state == API_TRIAL_QUEUED &&
        sqlite3_column_int(q->statement, STATE_OF_RUN) != RUN_QUEUED)
        t->state = API_TRIAL_RUNNING;
    return BF_OK;
}

static const store__record record = RECORD(columns, api_trial, complete_trial);

static const store__sql orders[] = { [API_TRIALS_BY_NUMBER] = STORE__SQL_LIST_TRIALS,
                                     [API_TRIALS_BY_END] = STORE__SQL_LIST_ENDED_TRIALS,
                                     [API_TRIALS_OPEN] = STORE__SQL_LIST_OPEN_TRIALS };

bf_status store_read_trials(store *s, const char *id, const api_trial_query *query,
                            api_trial_fn *on_trial, void *context, bf_error *err)
{
    store_study row;
    size_t n = 0;

    if (query->limit < 1 || query->limit > API_TRIALS_PAGE_MAX)
        return bf_fail(err, BF_ELIMIT, "", "a page holds 1 to %d trials, not %zu",
                       API_TRIALS_PAGE_MAX, query->limit);
    api_trial *trials = memory_alloc(query->limit, sizeof *trials);
    if (trials == NULL)
        return bf_fail_memory(err);
    store__connection *reader = store__acquire_reader(&s->pool);
    bf_status status = store__find_study(reader, id, &row, err);
    if (status == BF_OK)
        status = store__list(reader, orders[query->order], &record, trials, query->limit, &n, NULL,
                             err, INTEGER(row.rowid), INTEGER(query->from), INTEGER(query->limit));
    store__release_reader(&s->pool, reader); // trials are given on without it
    for (size_t k = 0; k < n && status == BF_OK; k++)
        status = on_trial(context, &trials[k], err);
    memory_free(trials);
    return status;
}

/// A study that is removed step by step.
typedef struct forget_context {
    const char *id;
    bool is_over; ///< nothing is left
} forget_context;

static bf_status apply_forget(store__connection *writer, store__operation *operation, bf_error *err)
{
    forget_context *context = operation->context;
    bool has_run = false;
    store_study row;
    store__row left;

    BF_TRY(store__find_study(writer, context->id, &row, err));
    BF_TRY(store__find(writer, STORE__SQL_NEXT_RUN_OF_STUDY, &store__run_record, &left, &has_run,
                       err, TEXT(context->id)));
    if (has_run ||
        (row.stop_request != STORE_STOP_KILL && !api_study_state_is_end(row.study.state)))
        return bf_fail(err, BF_ECONFLICT, "", "the study is at work or has runs");
    memcpy(operation->changed, row.study.id, API_ID_SIZE);
    BF_TRY(store__exec(writer, STORE__SQL_DELETE_TRIALS, err, INTEGER(row.rowid),
                       INTEGER(TRIALS_A_STEP)));
    if (sqlite3_changes(writer->db) == TRIALS_A_STEP)
        return BF_OK;
    context->is_over = true;
    return store__exec(writer, STORE__SQL_DELETE_STUDY, err, INTEGER(row.rowid));
}

bf_status store_forget_study(store *s, const char *id, bf_error *err)
{
    forget_context context = { .id = id };

    while (!context.is_over)
        BF_TRY(store__write_freeing(s, apply_forget, &context, err));
    return BF_OK;
}
