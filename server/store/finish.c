// How a run that was running ends or goes back to the queue. What it sent last is stored in the same transaction.

#include "server/store/finish.h"
#include "server/store/quotas.h"
#include "server/store/texts.h"

#include <inttypes.h>
#include <string.h>

/// An end, and what became of it.
typedef struct finish_context {
    const store_ending *ending;
    uint64_t attempts_max;  ///< see store_options
    store__appending *last; ///< of ending->last; NULL: nothing
    store__row row;
} finish_context;

bf_status store__check_running(const store__row *row, bf_error *err)
{
    return row->run.state == RUN_RUNNING
               ? BF_OK
               : bf_fail(err, BF_ECONFLICT, "", "the run is %s, not running",
                         run_state_word(row->run.state));
}

static bf_status check_whole(const store__row *row, const store_ending *ending, bf_error *err)
{
    const frame_end *whole = ending->state == RUN_SUCCEEDED ? ending->whole : NULL;

    if (whole == NULL ||
        (row->run.n_samples == whole->n_samples &&
         (ending->is_without_snapshots || row->run.n_snapshots == whole->n_snapshots)))
        return BF_OK;
    return bf_fail(err, BF_ECORRUPT, "",
                   "the run ended with %" PRIu64 " samples and %" PRIu64 " snapshots, of which "
                   "%" PRIu64 " and %" PRIu64 " came",
                   whole->n_samples, whole->n_snapshots, row->run.n_samples, row->run.n_snapshots);
}

static const char *reason_of(const store_ending *ending)
{
    return ending->error.code == BF_OK ? "nobody knows why" : ending->error.text;
}

// A run that goes back to the queue counts its attempt. False: it was the last.
static bool may_go_back(const finish_context *context, store__row *row)
{
    const store_ending *ending = context->ending;

    switch (ending->attempt) {
    case STORE_ATTEMPT_FAILED:
        if (context->attempts_max == 0 || row->attempts < context->attempts_max)
            return true;
        (void)bf_fail(&row->run.error, BF_ELIMIT, "",
                      "%" PRIu64 " attempts at this run failed, one after the other, the limit "
                      "(run_attempts); the last one: %.300s",
                      row->attempts, reason_of(ending));
        return false;
    case STORE_ATTEMPT_HAND_BACK:
        row->attempts -= row->attempts > 0;
        if (++row->hand_backs < STORE_HAND_BACKS_MAX)
            return true;
        (void)bf_fail(&row->run.error, BF_ELIMIT, "",
                      "workers gave this run back %" PRIu64 " times, one after the other; the last "
                      "one: %.300s",
                      row->hand_backs, reason_of(ending));
        return false;
    default:
        row->attempts -= row->attempts > 0;
        return true;
    }
}

static bf_status apply_finish(store__connection *writer, store__operation *operation, bf_error *err)
{
    finish_context *context = operation->context;
    const store_ending *ending = context->ending;
    store__row *row = &context->row;

    BF_TRY(store__find_row(writer, ending->run_id, row, err));
    BF_TRY(store__check_running(row, err));
    if (context->last != NULL)
        BF_TRY(store__apply_batch(writer, context->last, row, err));
    BF_TRY(check_whole(row, ending, err));
    memcpy(operation->changed, row->run.id, API_ID_SIZE);
    const bool is_last = ending->state == RUN_QUEUED && !may_go_back(context, row);
    if (ending->state == RUN_FAILED)
        row->run.error = ending->error;
    BF_TRY(store__charge(writer, row, ending->cpu_s, err));
    if (ending->summary != NULL) {
        row->run.has_summary = true;
        BF_TRY(store__put_run_text(writer, row, STORE__TEXT_SUMMARY, ending->summary,
                                   ending->n_summary, &row->n_bytes, err));
    }
    return store__transition(writer, row, is_last ? RUN_FAILED : ending->state, err);
}

static bf_status prepare_last(finish_context *context, bf_error *err)
{
    if (context->ending->last == NULL)
        return BF_OK;
    context->last = store__appending_create(context->ending->last);
    return context->last == NULL ? bf_fail_memory(err) : store__pack_batch(context->last, err);
}

// The end, and behind it in the same commit the claim of the next run, if there is room for what that sends.
static void write_and_claim(store *s, store__operation *end, store_next *next)
{
    store__claiming claiming = { .store = s, .with_trials = next->with_trials };
    store__operation operations[] = { *end, { .apply = store__apply_next, .context = &claiming } };

    next->status = store__check_room(s, &next->error);
    store__write_group(s, operations, next->status == BF_OK ? 2 : 1);
    *end = operations[0];
    if (next->status != BF_OK)
        return;
    next->status = operations[1].status;
    next->error = operations[1].error;
    if (next->status == BF_OK)
        next->job = claiming.job;
    else
        store_job_fini(&claiming.job);
}

bf_status store_finish(store *s, const store_ending *ending, api_run *ret_run, bf_error *err)
{
    finish_context context = { .ending = ending, .attempts_max = s->attempts_max };

    bf_status status = prepare_last(&context, err);
    if (status == BF_OK) {
        store__operation end = { .apply = apply_finish,
                                 .context = &context,
                                 .may_use_reserve = true };
        if (context.ending->next != NULL)
            write_and_claim(s, &end, context.ending->next);
        else
            store__write_group(s, &end, 1);
        if (end.status != BF_OK && err != NULL)
            *err = end.error;
        status = end.status;
    }
    if (context.last != NULL)
        store__appending_destroy(context.last, status);
    if (status == BF_OK)
        *ret_run = context.row.run;
    return status;
}
