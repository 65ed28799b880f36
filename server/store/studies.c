// Studies: accepted, found, listed, changed and removed. Their trials stand in trials.c.

#include "server/store/studies.h"

#include "server/store/idempotency.h"
#include "server/store/quotas.h"
#include "server/store/studies_priv.h"

#include "api/study/study_json.h"
#include "server/base/clock.h"
#include "server/base/run_id.h"

#include <stdio.h>

// Numbers that stand for nothing must not get any further; see row.c.
static bool is_possible(const store_study *row)
{
    return (unsigned)row->study.state < API_STUDY_STATES &&
           (unsigned)row->study.method < STUDY_METHODS &&
           (unsigned)row->study.model < RUN_MODEL_COUNT &&
           (unsigned)row->stop_request <= STORE_STOP_KILL;
}

static bf_status check_row(const store__query *q, void *of, bool is_whole, bf_error *err)
{
    const store_study *row = of;

    (void)q;
    if (!is_whole || !is_possible(row))
        return bf_fail(err, BF_ECORRUPT, "", "the row of the study %.40s is damaged",
                       row->study.id);
    return BF_OK;
}

// As STORE__STUDY_COLUMNS.
#define X(kind, column, member) COLUMN(kind, store_study, member),
static const store__column columns[] = { COLUMN(INTEGER, store_study, rowid),
                                         STORE__STUDY_LIST(X) };
#undef X

static const store__record record = RECORD(columns, store_study, check_row);

bf_status store__find_study(store__connection *c, const char *id, store_study *row, bf_error *err)
{
    bool has_row = false;

    BF_TRY(store__find(c, STORE__SQL_FIND_STUDY, &record, row, &has_row, err, TEXT(id)));
    if (!has_row)
        return bf_fail(err, BF_ENOTFOUND, "", "there is no study %.40s", id);
    return BF_OK;
}

// Finds a study that is not to be removed.
static bf_status find_visible(store__connection *c, const char *id, store_study *row, bf_error *err)
{
    BF_TRY(store__find_study(c, id, row, err));
    if (row->stop_request == STORE_STOP_KILL)
        return bf_fail(err, BF_ENOTFOUND, "", "there is no study %.40s", id);
    return BF_OK;
}

#define X(kind, column, member) kind(row->member),

static bf_status insert_study(store__connection *writer, store_study *row, bf_error *err)
{
    BF_TRY(store__exec(writer, STORE__SQL_INSERT_STUDY, err, STORE__STUDY_LIST(X)));
    row->rowid = sqlite3_last_insert_rowid(writer->db);
    return BF_OK;
}

bf_status store__save_study(store__connection *writer, store_study *row, bf_error *err)
{
    row->study.revision++;
    return store__exec(writer, STORE__SQL_UPDATE_STUDY, err, INTEGER(row->study.state),
                       STORE__STUDY_CHANGING(X) INTEGER(row->rowid));
}

#undef X

bf_status store__put_study_text(store__connection *writer, const store_study *row,
                                api_study_text kind, const bf_buffer *text, bf_error *err)
{
    return store__exec(writer, STORE__SQL_PUT_STUDY_TEXT, err, INTEGER(row->rowid), INTEGER(kind),
                       TEXT_OF(text->bytes, text->n));
}

bf_status store__move_study(store_study *row, api_study_state to, bf_error *err)
{
    api_study *about = &row->study;

    if (api_study_state_is_end(about->state))
        return bf_fail(err, BF_ECONFLICT, "", "the study has ended: it is %s",
                       api_study_state_word(about->state));
    about->state = to;
    if (to == API_STUDY_RUNNING && about->started_ms == 0)
        about->started_ms = clock_unix_ms();
    if (api_study_state_is_end(to))
        about->finished_ms = clock_unix_ms();
    if (api_study_state_is_end(to) && row->stop_request == STORE_STOP_CANCEL)
        row->stop_request = STORE_STOP_NONE;
    return BF_OK;
}

/// A study to be accepted, and what becomes of it.
typedef struct submit_context {
    const api_study_submission *submission;
    store *store; ///< for its limits
    store_study row;
} submit_context;

static bf_status check_count(store__connection *writer, store__sql sql, int64_t limit,
                             const char *what, bf_error *err)
{
    int64_t n = 0;

    BF_TRY(store__read_number(writer, sql, &n, err));
    if (n >= limit)
        return bf_fail(err, BF_EBUSY, "", "there are %lld studies%s, the limit is %lld",
                       (long long)n, what, (long long)limit);
    return BF_OK;
}

static bf_status accept(store__connection *writer, void *of, api_acceptance *accepted,
                        bf_error *err)
{
    submit_context *context = of;
    const api_study_submission *submission = context->submission;
    store_study *row = &context->row;

    BF_TRY(store__check_bytes(writer, context->store, row->study.owner, err));
    BF_TRY(store__check_studies(writer, context->store, row->study.owner, err));
    BF_TRY(check_count(writer, STORE__SQL_COUNT_OPEN_STUDIES, STORE_STUDIES_OPEN_MAX,
                       " that have not ended", err));
    BF_TRY(check_count(writer, STORE__SQL_COUNT_STUDIES, STORE_STUDIES_MAX, ": remove some first",
                       err));
    BF_TRY(insert_study(writer, row, err));
    BF_TRY(store__put_study_text(writer, row, API_STUDY_DOCUMENT, &submission->document, err));
    BF_TRY(store__put_study_text(writer, row, API_STUDY_COLUMNS, &submission->columns, err));
    accepted->revision = row->study.revision;
    return study_json_write(&row->study, &accepted->answer, err);
}

static void fill_row(const api_study_submission *submission, store_study *row)
{
    api_study *about = &row->study;

    snprintf(row->client, sizeof row->client, "%s", submission->sender.client);
    snprintf(about->owner, sizeof about->owner, "%s", submission->sender.owner);
    snprintf(about->name, sizeof about->name, "%s", submission->name);
    snprintf(about->line, sizeof about->line, "%s", submission->line);
    about->method = submission->method;
    about->model = submission->model;
    about->priority = submission->priority;
    about->trials_max = submission->trials_max;
    about->created_ms = clock_unix_ms();
    about->revision = 1;
}

bf_status store_submit_study(store *s, const api_study_submission *submission,
                             api_acceptance *ret_acceptance, bf_error *err)
{
    submit_context context = { .submission = submission, .store = s };
    const api_study *about = &context.row.study;

    BF_TRY(run_id_make(context.row.study.id, err));
    fill_row(submission, &context.row);
    const store__request request = { .route = "POST /v1/studies",
                                     .sender = &submission->sender,
                                     .id = about->id,
                                     .now_ms = about->created_ms };
    return store__accept(s, &request, accept, &context, ret_acceptance, err);
}

bf_status store_find_study(store *s, const char *id, api_study *ret_study, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    store_study row;

    bf_status status = find_visible(reader, id, &row, err);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        *ret_study = row.study;
    return status;
}

bf_status store_list_studies(store *s, const api_page_query *query, api_page *ret_page,
                             bf_error *err)
{
    static const store__listing studies = { "studies", &record, offsetof(store_study, study),
                                            sizeof(api_study), 6 };

    return store__list_page(&s->pool, STORE__SQL_LIST_STUDIES, &studies, query, ret_page, err);
}

static const store__sql works[] = {
    [STORE_STUDIES_RUNNING] = STORE__SQL_LIST_STUDIES_RUNNING,
    [STORE_STUDIES_QUEUED] = STORE__SQL_LIST_STUDIES_QUEUED,
    [STORE_STUDIES_TO_STOP] = STORE__SQL_LIST_STUDIES_TO_STOP,
};

bf_status store_list_work(store *s, store_studies which, size_t size, store_study *ret_studies,
                          size_t *ret_n, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    size_t n = 0;

    const bf_status status =
        store__list(reader, works[which], &record, ret_studies, size, &n, NULL, err, INTEGER(size));
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        *ret_n = n;
    return status;
}

/// A study to be changed.
typedef struct change_context {
    const char *id;
    uint64_t revision; ///< that it must have, or API_ANY_REVISION
    api_study_change change;
    const char *name, *line; ///< that it gets
    store_study row;
} change_context;

static bf_status find_changed(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;
    const api_study *about = &context->row.study;

    BF_TRY(find_visible(writer, context->id, &context->row, err));
    if (context->revision != API_ANY_REVISION && about->revision != context->revision)
        return bf_fail(err, BF_EINPUT, "", "the study has revision %llu, not %llu",
                       (unsigned long long)about->revision, (unsigned long long)context->revision);
    memcpy(operation->changed, about->id, API_ID_SIZE);
    return BF_OK;
}

static bf_status apply_change(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;
    store_study *row = &context->row;

    BF_TRY(find_changed(writer, operation, err));
    const api_study_state state = row->study.state;
    const bool is_stopping = row->stop_request != STORE_STOP_NONE;
    const bool is_paused = state == API_STUDY_PAUSED;
    if (api_study_state_is_end(state) || is_stopping)
        return bf_fail(err, BF_ECONFLICT, "", "the study %s: it is %s",
                       is_stopping ? "is being cancelled" : "has ended",
                       api_study_state_word(state));
    if (context->change == API_STUDY_PAUSE && is_paused)
        return bf_fail(err, BF_ECONFLICT, "", "the study is paused already");
    if (context->change == API_STUDY_RESUME && !is_paused)
        return bf_fail(err, BF_ECONFLICT, "", "the study is not paused: it is %s",
                       api_study_state_word(state));
    if (context->change == API_STUDY_CANCEL)
        row->stop_request = STORE_STOP_CANCEL;
    else
        row->study.state = context->change == API_STUDY_PAUSE ? API_STUDY_PAUSED : API_STUDY_QUEUED;
    return store__save_study(writer, row, err);
}

bf_status store_change_study(store *s, const char *id, uint64_t revision, api_study_change change,
                             api_study *ret_study, bf_error *err)
{
    change_context context = { .id = id, .revision = revision, .change = change };

    BF_TRY(store__write_freeing(s, apply_change, &context, err));
    *ret_study = context.row.study;
    return BF_OK;
}

static bf_status apply_annotate(store__connection *writer, store__operation *operation,
                                bf_error *err)
{
    change_context *context = operation->context;
    store_study *row = &context->row;

    BF_TRY(find_changed(writer, operation, err));
    snprintf(row->study.name, sizeof row->study.name, "%s", context->name);
    snprintf(row->study.line, sizeof row->study.line, "%s", context->line);
    BF_TRY(store__exec(writer, STORE__SQL_ANNOTATE_STUDY, err, TEXT(row->study.name),
                       TEXT(row->study.line), INTEGER(row->rowid)));
    return store__save_study(writer, row, err);
}

bf_status store_annotate_study(store *s, const char *id, uint64_t revision,
                               const api_annotations *annotations, api_study *ret_study,
                               bf_error *err)
{
    change_context context = {
        .id = id, .revision = revision, .name = annotations->name, .line = annotations->line
    };

    BF_TRY(store__write(s, apply_annotate, &context, err));
    *ret_study = context.row.study;
    return BF_OK;
}

static bf_status apply_remove(store__connection *writer, store__operation *operation, bf_error *err)
{
    change_context *context = operation->context;

    BF_TRY(find_changed(writer, operation, err));
    context->row.stop_request = STORE_STOP_KILL;
    return store__save_study(writer, &context->row, err);
}

bf_status store_remove_study(store *s, const char *id, uint64_t revision, bf_error *err)
{
    change_context context = { .id = id, .revision = revision };

    return store__write_freeing(s, apply_remove, &context, err);
}

bf_status store_read_study(store *s, const char *id, api_study_text which, bf_buffer *out,
                           bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    store_study row;
    bool has_row = false;

    bf_status status = store__find_study(reader, id, &row, err);
    if (status == BF_OK)
        status = store__find_bytes(reader, STORE__SQL_GET_STUDY_TEXT, out, &has_row, err,
                                   INTEGER(row.rowid), INTEGER(which));
    if (status == BF_OK && !has_row)
        status = bf_fail(err, BF_ECONFLICT, "", "no trial of the study has ended yet");
    store__release_reader(&s->pool, reader);
    return status;
}

bf_status store_find_old_study(store *s, int64_t before_ms, char ret_id[API_ID_SIZE], bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    bool has_row = false;
    store_study row;

    const bf_status status = store__find(reader, STORE__SQL_OLDEST_ENDED_STUDY, &record, &row,
                                         &has_row, err, INTEGER(before_ms));
    store__release_reader(&s->pool, reader);
    if (status == BF_OK && !has_row)
        return bf_fail(err, BF_ENOTFOUND, "", "no study ended so long ago");
    if (status == BF_OK)
        memcpy(ret_id, row.study.id, API_ID_SIZE);
    return status;
}
