// Accepting runs. In one transaction: the first answer to the key is looked for; without one, known
// results; without them, there is a new run to be solved, if the quotas of client and owner and then the queue
// have room; and the answer is stored under the key.

#include "server/store/submit.h"
#include "server/store/idempotency.h"
#include "server/store/lines.h"
#include "server/store/quotas.h"
#include "server/store/store_priv.h"
#include "server/store/texts.h"

#include "api/results/results.h"
#include "api/results/run_json.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/metrics.h"
#include "server/base/run_id.h"

#include <inttypes.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

/// A submission, and what becomes of it.
typedef struct submit_context {
    const api_submission *submission;
    store *store;                             ///< for its limits
    unsigned char digest[STORE__DIGEST_SIZE]; ///< of what is to be solved
    store__row row;                           ///< of the new run
} submit_context;

// The client's runs that wait are counted by an index that has no others.
static bf_status check_quota(store__connection *writer, const char *client, size_t quota,
                             bf_error *err)
{
    int64_t n = 0;

    if (quota == 0 || client[0] == '\0')
        return BF_OK;
    BF_TRY(store__find_number(writer, STORE__SQL_COUNT_QUEUED_OF, &n, err, TEXT(client)));
    if ((size_t)n >= quota) {
        metrics_add(METRICS_QUOTA_REFUSALS, METRICS_QUOTA_CLIENT, 1);
        return bf_fail(err, BF_ELIMIT, "",
                       "%" PRId64 " runs of %s wait already, its share of the queue", n, client);
    }
    return BF_OK;
}

// A long queue is counted only where it may be full: counting takes as long as the queue is.
static bf_status enter_queue(store__connection *writer, size_t limit, bf_error *err)
{
    int64_t n = 0;

    if (writer->queued_at_most >= limit) {
        BF_TRY(store__read_number(writer, STORE__SQL_COUNT_QUEUED, &n, err));
        writer->queued_at_most = (size_t)n;
    }
    if (writer->queued_at_most >= limit)
        return bf_fail(err, BF_EBUSY, "", "the queue is full: %zu runs wait, the limit is %zu",
                       writer->queued_at_most, limit);
    writer->queued_at_most++;
    return BF_OK;
}

// Insert a run that will be solved, whose row is filled in but for its results.
static bf_status insert_new(store__connection *writer, const api_submission *submission,
                            const unsigned char digest[STORE__DIGEST_SIZE], store__row *row,
                            bf_error *err)
{
    const bf_buffer *scenario = &submission->scenario, *columns = &submission->columns;
    uint64_t n_bytes = 0;

    row->run.state = RUN_QUEUED;
    BF_TRY(store__insert_results(writer, submission->identity.n > 0 ? digest : NULL, row, err));
    BF_TRY(store__insert_row(writer, row, err));
    BF_TRY(store__put_run_text(writer, row, STORE__TEXT_SCENARIO, scenario->bytes, scenario->n,
                               &n_bytes, err));
    BF_TRY(
        store__put_text(writer, row->rowid, STORE__TEXT_COLUMNS, columns->bytes, columns->n, err));
    row->n_bytes = n_bytes;
    return store__emit_events(writer, row, err);
}

static bf_status accept_new(store__connection *writer, submit_context *context,
                            unsigned *retry_after_s, bf_error *err)
{
    store__row *row = &context->row;

    BF_TRY(check_quota(writer, row->client, context->store->client_quota, err));
    BF_TRY(store__check_owner(writer, context->store, row->run.owner, retry_after_s, err));
    BF_TRY(enter_queue(writer, context->store->queue_limit, err));
    return insert_new(writer, context->submission, context->digest, row, err);
}

// The summary of a solved run becomes the new one's.
static bf_status adapt_summary(store__connection *writer, const store__row *solved,
                               const bf_buffer *scenario, bf_buffer *out, bf_error *err)
{
    bf_buffer text = { 0 };

    if (!solved->run.has_summary)
        return BF_OK;
    bf_status status = store__get_run_text(writer, solved, STORE__TEXT_SUMMARY, &text, err);
    if (status == BF_OK)
        status = results_summary_cached(text.bytes, text.n, scenario->bytes, scenario->n, out, err);
    buffer_fini(&text);
    return status;
}

// False with BF_OK: there are no stored results, or they are damaged.
static bf_status accept_solved(store__connection *writer, const api_submission *submission,
                               const unsigned char digest[STORE__DIGEST_SIZE], store__row *row,
                               bool *ret_is_solved, bf_error *err)
{
    bf_buffer summary = { 0 };
    const int64_t since_ns = clock_thread_cpu_ns();
    bool is_solved = false;
    store__row solved;

    if (submission->is_fresh || submission->identity.n == 0)
        return BF_OK;
    bf_status status = store__find_solved(writer, digest, &solved, &is_solved, err);
    if (status != BF_OK || !is_solved)
        return status;
    status = adapt_summary(writer, &solved, &submission->scenario, &summary, err);
    if (status == BF_ECORRUPT) {
        log_event(LOG_LEVEL_WARN, "summary_damaged", "run=%s", solved.run.id);
        return BF_OK;
    }
    if (status == BF_OK)
        status = store__reuse_results(writer, &solved, &submission->scenario, &summary, row, err);
    buffer_fini(&summary);
    if (status == BF_OK)
        status = store__charge_owner(writer, row->run.owner,
                                     1e-9 * (double)(clock_thread_cpu_ns() - since_ns), err);
    *ret_is_solved = status == BF_OK;
    return status;
}

static bf_status accept(store__connection *writer, void *of, api_acceptance *accepted,
                        bf_error *err)
{
    submit_context *context = of;
    const api_run *record = &context->row.run;
    bool is_solved = false;

    BF_TRY(store__check_bytes(writer, context->store, record->owner, err));
    BF_TRY(store__number_version(writer, &context->row, &context->submission->identity, err));
    BF_TRY(accept_solved(writer, context->submission, context->digest, &context->row, &is_solved,
                         err));
    if (!is_solved)
        BF_TRY(accept_new(writer, context, &accepted->retry_after_s, err));
    accepted->revision = record->revision;
    return run_json_write(record, &accepted->answer, err);
}

// The results of a trial have no snapshots, so they are not those of a run by itself.
static void digest_work(const api_submission *submission, bool is_trial,
                        unsigned char ret_digest[STORE__DIGEST_SIZE])
{
    const char *model = run_model_words[submission->model];
    crypto_hash_sha256_state s;

    (void)crypto_hash_sha256_init(&s);
    if (is_trial)
        (void)crypto_hash_sha256_update(&s, (const unsigned char *)"trial", sizeof "trial");
    // The word's terminator parts it from the document.
    (void)crypto_hash_sha256_update(&s, (const unsigned char *)model, strlen(model) + 1);
    (void)crypto_hash_sha256_update(&s, (const unsigned char *)submission->identity.bytes,
                                    submission->identity.n);
    (void)crypto_hash_sha256_final(&s, ret_digest);
}

static void fill_row(const api_submission *submission, store__row *row)
{
    api_run *record = &row->run;

    snprintf(row->client, sizeof row->client, "%s", submission->sender.client);
    snprintf(record->owner, sizeof record->owner, "%s", submission->sender.owner);
    record->model = submission->model;
    record->priority = submission->priority;
    snprintf(record->label, sizeof record->label, "%s", submission->label);
    snprintf(record->line, sizeof record->line, "%s", submission->line);
    snprintf(record->name, sizeof record->name, "%s", submission->name);
    snprintf(record->closure, sizeof record->closure, "%s", submission->closure);
    record->created_ms = clock_unix_ms();
    record->eta_s = record->predicted_s = NAN;
}

bf_status store_submit(store *s, const api_submission *submission, api_acceptance *ret_acceptance,
                       bf_error *err)
{
    submit_context context = { .submission = submission, .store = s };
    const api_run *record = &context.row.run;

    BF_TRY(run_id_make(context.row.run.id, err));
    fill_row(submission, &context.row);
    digest_work(submission, false, context.digest);
    const store__request request = { .route = "POST /v1/runs",
                                     .sender = &submission->sender,
                                     .id = record->id,
                                     .now_ms = record->created_ms };
    return store__accept(s, &request, accept, &context, ret_acceptance, err);
}

bf_status store__submit_trial(store__connection *writer, const api_submission *submission,
                              const char *study_id, char ret_run[API_ID_SIZE], bf_error *err)
{
    unsigned char digest[STORE__DIGEST_SIZE];
    store__row row = { .rowid = 0 };
    bool is_solved = false;

    BF_TRY(run_id_make(row.run.id, err));
    fill_row(submission, &row);
    memcpy(row.run.study, study_id, API_ID_SIZE);
    digest_work(submission, true, digest);
    BF_TRY(accept_solved(writer, submission, digest, &row, &is_solved, err));
    if (!is_solved)
        BF_TRY(insert_new(writer, submission, digest, &row, err));
    memcpy(ret_run, row.run.id, API_ID_SIZE);
    return BF_OK;
}
