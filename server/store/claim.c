// Claiming in two steps: read the next run with all it needs, then make it running if it still
// waits. All that can fail or takes long (reading, unpacking a checkpoint) comes before the change.

#include "server/store/store_priv.h"

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

static bf_status find_next(store__connection *reader, store__row *ret_row, bf_error *err)
{
    bool has_row = false;

    bf_status status =
        store__find_first(reader, STORE__SQL_NEXT_QUEUED, NULL, ret_row, &has_row, err);
    if (status == BF_OK && !has_row)
        return bf_fail(err, BF_ENOTFOUND, "", "no run is queued");
    return status;
}

static bf_status read_texts(store__connection *reader, const store__row *row, store_job *job,
                            bf_error *err)
{
    job->run = row->run;
    job->wall_s = row->wall_s;
    bf_status status =
        store__get_text(reader, row->rowid, STORE__TEXT_SCENARIO, &job->scenario, err);
    return status != BF_OK
               ? status
               : store__get_text(reader, row->rowid, STORE__TEXT_COLUMNS, &job->columns, err);
}

static bf_status read_next(store__connection *reader, store_job *job, bf_buffer *compressed,
                           bf_error *err)
{
    store__row row;

    bf_status status = find_next(reader, &row, err);
    if (status == BF_OK)
        status = read_texts(reader, &row, job, err);
    if (status != BF_OK)
        return status;
    job->step = row.checkpoint_step;
    return store__get_chunks(reader, row.results, STORE__BLOB_CHECKPOINT, 0, compressed, err);
}

// A damaged checkpoint costs the run its progress, not the queue behind it its turn: the run starts
// again from t = 0.
static bf_status unpack_checkpoint(const bf_buffer *compressed, store_job *job, bf_error *err)
{
    bf_status status = store__unpack(compressed, &job->checkpoint, err);

    if (status != BF_ECORRUPT)
        return status;
    log_event(LOG_LEVEL_WARN, "checkpoint_damaged", "run=%s", job->run.id);
    job->step = 0;
    return BF_OK;
}

static bf_status peek_next(store *s, store_job *job, bf_error *err)
{
    store__connection *reader = NULL;
    bf_buffer compressed = { 0 };

    bf_status status = store__acquire_reader(&s->pool, &reader, err);
    if (status != BF_OK)
        return status;
    status = read_next(reader, job, &compressed, err);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK && compressed.n > 0)
        status = unpack_checkpoint(&compressed, job, err);
    buffer_fini(&compressed);
    return status;
}

static bf_status apply_claim(store__connection *writer, store__operation *operation, bf_error *err)
{
    store_job *job = operation->context;
    store__row row;

    bf_status status = store__find_row(writer, job->run.id, &row, err);
    if (status == BF_OK)
        status = store__transition(writer, &row, RUN_RUNNING, err);
    if (status != BF_OK)
        return status;
    job->run = row.run;
    memcpy(operation->changed, row.run.id, API_ID_SIZE);
    return BF_OK;
}

bf_status store_claim(store *s, store_job *ret_job, bf_error *err)
{
    store_job job = { 0 };
    bf_status status = BF_OK;
    bool has_lost = false; // the run was taken, cancelled or removed in between

    do {
        store_job_fini(&job);
        status = peek_next(s, &job, err);
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

    store__query q = store__begin(writer, STORE__SQL_SET_EXTERNAL_ID);
    store__bind_text(&q, context->id, strlen(context->id));
    store__bind_text(&q, context->external_id, strlen(context->external_id));
    bf_status status = store__run(&q, err);
    if (status == BF_OK && sqlite3_changes(writer->db) == 0)
        return bf_fail(err, BF_ECONFLICT, "", "the run is not running");
    return status;
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
    store__connection *reader = NULL;
    store__row row = { .rowid = 0 };
    bool has_row = true;
    size_t n = 0;

    bf_status status = store__acquire_reader(&s->pool, &reader, err);
    if (status != BF_OK)
        return status;
    while (status == BF_OK && n < size) {
        status =
            store__find_first(reader, STORE__SQL_NEXT_RUNNING, row.run.id, &row, &has_row, err);
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
    store__connection *reader = NULL;
    store_job job = { 0 };
    store__row row;

    bf_status status = store__acquire_reader(&s->pool, &reader, err);
    if (status != BF_OK)
        return status;
    status = store__find_row(reader, id, &row, err);
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
