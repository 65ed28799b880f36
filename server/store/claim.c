// The transitions of runs that are asked for: claim, cancel, remove; and what the supervisor and others
// leave for each other of running runs.
//
// Claiming has two steps: read the next run with all it needs, then make it running if it still waits. All
// that can fail or takes long (reading, decompressing a checkpoint) comes before the change. A run without a checkpoint
// may be claimed in one step, in the commit in which another ends (store_finish()).

#include "server/store/finish.h"
#include "server/store/lines.h"
#include "server/store/quotas.h"
#include "server/store/studies.h"
#include "server/store/texts.h"
#include "server/store/turns.h"

#include "server/base/clock.h"
#include "server/base/log.h"

#include <sqlite3.h>
#include <string.h>

void store_job_fini(store_job *job)
{
    if (job == NULL)
        return;
    buffer_fini(&job->scenario);
    buffer_fini(&job->columns);
    buffer_fini(&job->checkpoint);
    *job = (store_job){ 0 };
}

static bf_status read_texts(store__connection *reader, const store__row *row, store_job *job,
                            bf_error *err)
{
    job->run = row->run;
    job->wall_s = row->wall_s;
    job->cpu_s = row->cpu_s;
    BF_TRY(store__get_run_text(reader, row, STORE__TEXT_SCENARIO, &job->scenario, err));
    return store__get_text(reader, row->rowid, STORE__TEXT_COLUMNS, &job->columns, err);
}

// A damaged checkpoint costs the run its progress, not the queue behind it its turn: the run starts
// again from t = 0.
static bf_status begin_again_if_damaged(bf_status status, store_job *job)
{
    if (status != BF_ECORRUPT)
        return status;
    log_event(LOG_LEVEL_WARN, "checkpoint_damaged", "run=%s", job->run.id);
    job->step = 0;
    return BF_OK;
}

static bf_status read_next(const store *s, store__connection *reader, bool with_trials,
                           store_job *job, bf_buffer *compressed, bf_error *err)
{
    store__row row;

    BF_TRY(store__find_next(reader, s, with_trials, &row, err));
    BF_TRY(read_texts(reader, &row, job, err));
    job->step = row.checkpoint_step;
    bf_status status =
        store__get_chunks(reader, row.results, STORE__BLOB_CHECKPOINT, 0, compressed, err);
    return begin_again_if_damaged(status, job);
}

static bf_status peek_next(store *s, bool with_trials, store_job *job, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    bf_buffer compressed = { 0 };

    bf_status status = read_next(s, reader, with_trials, job, &compressed, err);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK && compressed.n > 0)
        status = begin_again_if_damaged(store__unpack(&compressed, &job->checkpoint, err), job);
    buffer_fini(&compressed);
    return status;
}

static bf_status begin_run(store__connection *writer, store__operation *operation, store__row *row,
                           store_job *job, bf_error *err)
{
    row->attempts++;
    BF_TRY(store__check_study(writer, row, err));
    BF_TRY(store__transition(writer, row, RUN_RUNNING, err));
    BF_TRY(store__end_turn(writer, row, err));
    job->run = row->run;
    memcpy(operation->changed, row->run.id, API_ID_SIZE);
    return BF_OK;
}

static bf_status apply_claim(store__connection *writer, store__operation *operation, bf_error *err)
{
    store_job *job = operation->context;
    store__row row;

    BF_TRY(store__find_row(writer, job->run.id, &row, err));
    return begin_run(writer, operation, &row, job, err);
}

bf_status store__apply_next(store__connection *writer, store__operation *operation, bf_error *err)
{
    store__claiming *claiming = operation->context;
    store__row row;

    BF_TRY(store__find_next(writer, claiming->store, claiming->with_trials, &row, err));
    if (row.checkpoint_step != 0)
        return bf_fail(err, BF_ECONFLICT, "", "the checkpoint of the next run is to be read first");
    BF_TRY(read_texts(writer, &row, &claiming->job, err));
    return begin_run(writer, operation, &row, &claiming->job, err);
}

bf_status store_claim(store *s, bool with_trials, store_job *ret_job, bf_error *err)
{
    store_job job = { 0 };
    bf_status status = BF_OK;
    bool has_lost = false; // the run was taken, cancelled or removed in between

    do {
        store_job_fini(&job);
        status = peek_next(s, with_trials, &job, err);
        if (status == BF_OK)
            status = store__check_room(s, err);
        if (status != BF_OK)
            break;
        status = store__write(s, apply_claim, &job, err);
        has_lost = status == BF_ECONFLICT || status == BF_ENOTFOUND;
    } while (has_lost);
    if (status == BF_OK)
        *ret_job = job;
    else
        store_job_fini(&job);
    return status;
}

/// A running run whose job got an id.
typedef struct external_id_context {
    const char *id;
    const char *external_id;
} external_id_context;

static bf_status apply_external_id(store__connection *writer, store__operation *operation,
                                   bf_error *err)
{
    const external_id_context *context = operation->context;

    BF_TRY(store__exec(writer, STORE__SQL_SET_EXTERNAL_ID, err, TEXT(context->id),
                       TEXT(context->external_id)));
    if (sqlite3_changes(writer->db) == 0)
        return bf_fail(err, BF_ECONFLICT, "", "the run is not running");
    return BF_OK;
}

bf_status store_set_external_id(store *s, const char *id, const char *external_id, bf_error *err)
{
    external_id_context context = { .id = id, .external_id = external_id };

    if (strlen(external_id) >= STORE_EXTERNAL_ID_SIZE)
        return bf_fail(err, BF_ELIMIT, "", "an executor's id of a job has %d characters at most",
                       STORE_EXTERNAL_ID_SIZE - 1);
    return store__write(s, apply_external_id, &context, err);
}

bf_status store_list_running(store *s, size_t size, store_running *ret_runs, size_t *ret_n,
                             bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    store__row row = { .rowid = 0 };
    bool has_row = true;
    size_t n = 0;

    bf_status status = BF_OK;
    while (status == BF_OK && n < size) {
        status = store__find(reader, STORE__SQL_NEXT_RUNNING, &store__run_record, &row, &has_row,
                             err, TEXT(row.run.id));
        if (status != BF_OK || !has_row)
            break;
        ret_runs[n].stop_request = row.stop_request;
        memcpy(ret_runs[n].id, row.run.id, sizeof row.run.id);
        memcpy(ret_runs[n++].external_id, row.external_id, sizeof row.external_id);
    }
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        *ret_n = n;
    return status;
}

bf_status store_read_job(store *s, const char *id, store_job *ret_job, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    store_job job = { 0 };
    store__row row;

    bf_status status = store__find_row(reader, id, &row, err);
    if (status == BF_OK && row.run.state != RUN_RUNNING)
        status = bf_fail(err, BF_ECONFLICT, "", "the run is not running");
    if (status == BF_OK)
        status = read_texts(reader, &row, &job, err);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        *ret_job = job;
    else
        store_job_fini(&job);
    return status;
}

/// A change of one run, and what became of it.
typedef struct change_context {
    const char *id;
    uint64_t revision; ///< that the run must have, or API_ANY_REVISION
    store__row row;
} change_context;

static bf_status check_revision(const api_run *record, uint64_t expected, bf_error *err)
{
    if (expected == API_ANY_REVISION || record->revision == expected)
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "", "the run has revision %llu, not %llu",
                   (unsigned long long)record->revision, (unsigned long long)expected);
}

static bf_status find_changed(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;

    BF_TRY(store__find_row(writer, context->id, &context->row, err));
    BF_TRY(check_revision(&context->row.run, context->revision, err));
    memcpy(operation->changed, context->row.run.id, API_ID_SIZE);
    return BF_OK;
}

// Ask for a running run to be stopped, unless as much is asked already (I14).
static bf_status request_stop(store__connection *writer, store__operation *operation,
                              const store__row *row, store_stop how, bf_error *err)
{
    operation->changed[0] = '\0';
    if (row->stop_request >= how)
        return BF_OK;
    memcpy(operation->changed, row->run.id, API_ID_SIZE);
    operation->asks_stop = true;
    return store__exec(writer, STORE__SQL_REQUEST_STOP, err, INTEGER(row->rowid), INTEGER(how));
}

static bf_status apply_cancel(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;
    store__row *row = &context->row;

    BF_TRY(find_changed(writer, operation, err));
    if (row->run.state == RUN_RUNNING)
        return request_stop(writer, operation, row, STORE_STOP_CANCEL, err);
    if (run_state_is_end(row->run.state))
        return bf_fail(err, BF_ECONFLICT, "", "the run has ended: it is %s",
                       run_state_word(row->run.state));
    return store__transition(writer, row, RUN_CANCELLED, err);
}

/// Those of a run that are to be changed.
typedef struct annotate_context {
    change_context change; ///< comes first: find_changed() takes it
    const api_annotations *annotations;
} annotate_context;

// No event tells it: a run's events are bounded by its results, not by its clients.
static bf_status apply_annotate(store__connection *writer, store__operation *operation,
                                bf_error *err)
{
    const annotate_context *context = operation->context;
    const api_annotations *to = context->annotations;
    store__row *row = &((annotate_context *)operation->context)->change.row;

    BF_TRY(find_changed(writer, operation, err));
    memcpy(row->run.name, to->name, sizeof row->run.name);
    memcpy(row->run.label, to->label, sizeof row->run.label);
    if (strcmp(row->run.line, to->line) != 0) {
        memcpy(row->run.line, to->line, sizeof row->run.line);
        BF_TRY(store__renumber_version(writer, row, err));
    }
    memcpy(row->run.notes, to->notes, sizeof row->run.notes);
    row->run.is_starred = to->is_starred;
    BF_TRY(store__exec(writer, STORE__SQL_ANNOTATE_RUN, err, TEXT(to->name), TEXT(to->label),
                       TEXT(to->notes), INTEGER(to->is_starred), TEXT(row->run.line),
                       INTEGER(row->run.line_version), TEXT(row->line_scenario),
                       INTEGER(row->rowid)));
    return store__save_row(writer, row, err);
}

bf_status store_annotate(store *s, const char *id, uint64_t revision, const api_annotations *to,
                         api_run *ret_run, bf_error *err)
{
    annotate_context context = { .change = { .id = id, .revision = revision }, .annotations = to };

    BF_TRY(store__write(s, apply_annotate, &context, err));
    *ret_run = context.change.row.run;
    return BF_OK;
}

uint64_t store_count_commits(const store *s)
{
    return atomic_load(&s->writer.n_commits);
}

uint64_t store_count_stop_requests(const store *s)
{
    return atomic_load(&s->n_stop_requests);
}

bf_status store_cancel(store *s, const char *id, uint64_t revision, api_run *ret_run, bf_error *err)
{
    change_context context = { .id = id, .revision = revision };

    BF_TRY(store__write_freeing(s, apply_cancel, &context, err));
    *ret_run = context.row.run;
    return BF_OK;
}

/// A run to be removed, and then its results, step by step.
typedef struct remove_context {
    const char *id;
    uint64_t revision; ///< that the run must have, or API_ANY_REVISION
    int64_t results;
    bool is_running;            ///< and thus still there, but asked to stop
    bool is_over;               ///< nothing is left
    char owner[API_OWNER_SIZE]; ///< whose it was
    int64_t cpu_ns;             ///< CPU time that its removal took
} remove_context;

static bf_status apply_remove(store__connection *writer, store__operation *operation, bf_error *err)
{
    remove_context *context = operation->context;
    const int64_t since_ns = clock_thread_cpu_ns();
    store__row row;

    BF_TRY(store__find_row(writer, context->id, &row, err));
    BF_TRY(check_revision(&row.run, context->revision, err));
    context->is_running = row.run.state == RUN_RUNNING;
    if (context->is_running)
        return request_stop(writer, operation, &row, STORE_STOP_KILL, err);
    memcpy(operation->changed, row.run.id, API_ID_SIZE);
    memcpy(context->owner, row.run.owner, sizeof context->owner);
    context->results = row.results;
    bf_status status = store__remove_row(writer, &row, &context->is_over, err);
    context->cpu_ns = clock_thread_cpu_ns() - since_ns;
    return status;
}

static bf_status apply_collect(store__connection *writer, store__operation *operation,
                               bf_error *err)
{
    remove_context *context = operation->context;

    return store__collect_results(writer, context->results, &context->is_over, err);
}

bf_status store_remove(store *s, const char *id, uint64_t revision, bf_error *err)
{
    remove_context context = { .id = id, .revision = revision };

    bf_status status = store__write_freeing(s, apply_remove, &context, err);
    if (status == BF_OK && context.is_running)
        return bf_fail(err, BF_ECONFLICT, "", "the run is running: it has been asked to stop");
    // The first step removes the run. What a failure leaves is deleted by later collection.
    for (bf_status collected = status; collected == BF_OK && !context.is_over;)
        collected = store__write_freeing(s, apply_collect, &context, NULL);
    return status;
}

enum { REMOVALS_A_COMMIT = 32 };

/// Runs of one study that were removed in this transaction.
typedef struct removals {
    size_t n;
    const remove_context *contexts;
} removals;

static bf_status apply_charge_removals(store__connection *writer, store__operation *operation,
                                       bf_error *err)
{
    const removals *removed = operation->context;
    const char *owner = "";
    int64_t cpu_ns = 0;

    for (size_t k = 0; k < removed->n; k++) {
        cpu_ns += removed->contexts[k].cpu_ns;
        owner = removed->contexts[k].cpu_ns > 0 ? removed->contexts[k].owner : owner;
    }
    return cpu_ns > 0 ? store__charge_owner(writer, owner, 1e-9 * (double)cpu_ns, err) : BF_OK;
}

// Each run is an operation of its own, so that those who wait for it are told. The owner pays for what that takes.
bf_status store_remove_runs_of_study(store *s, const char *id, bool *ret_has_runs, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    char ids[REMOVALS_A_COMMIT][API_ID_SIZE];
    remove_context contexts[REMOVALS_A_COMMIT];
    store__operation operations[REMOVALS_A_COMMIT + 1];
    size_t n = 0;

    bf_status status =
        store__list(reader, STORE__SQL_LIST_RUNS_OF_STUDY, &store__id_record, ids,
                    REMOVALS_A_COMMIT, &n, NULL, err, TEXT(id), INTEGER(REMOVALS_A_COMMIT));
    store__release_reader(&s->pool, reader);
    if (status != BF_OK)
        return status;
    for (size_t k = 0; k < n; k++) {
        contexts[k] = (remove_context){ .id = ids[k], .revision = API_ANY_REVISION };
        operations[k] = (store__operation){ .apply = apply_remove,
                                            .context = &contexts[k],
                                            .may_use_reserve = true };
    }
    removals removed = { .n = n, .contexts = contexts };
    operations[n] = (store__operation){ .apply = apply_charge_removals,
                                        .context = &removed,
                                        .may_use_reserve = true };
    if (n > 0)
        store__write_group(s, operations, n + 1);
    for (size_t k = 0; k < n && status == BF_OK; k++) {
        status = operations[k].status == BF_ENOTFOUND ? BF_OK : operations[k].status;
        if (status != BF_OK && err != NULL)
            *err = operations[k].error;
    }
    *ret_has_runs = n > 0;
    return status;
}
