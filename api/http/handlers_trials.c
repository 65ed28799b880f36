// What a study has: its document, its trials, what it found, its events; and a trial as a run of its own.

#include "api/http/http_priv.h"
#include "api/http/study_stream.h"
#include "api/http/trials_csv.h"
#include "api/json/number.h"
#include "api/scenario/scenario.h"
#include "api/scenario/submission.h"
#include "api/study/study_trial.h"

#include <inttypes.h>
#include <string.h>

bf_status handlers_trials_document(exchange *x, bf_error *err)
{
    const api_study *of = &x->named->study;

    // It never changes, but it may be removed.
    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "%s-document", of->id))
        return BF_OK;
    return x->services->read_study(x->services->store, of->id, API_STUDY_DOCUMENT,
                                   &x->response->body, err);
}

bf_status handlers_trials_best(exchange *x, bf_error *err)
{
    const api_study *of = &x->named->study;

    BF_TRY(x->services->read_study(x->services->store, of->id, API_STUDY_BEST, &x->response->body,
                                   err));
    exchange__cache_revalidate(x);
    return BF_OK;
}

static bf_status read_columns(const exchange *x, const char *id, study_columns *ret_columns,
                              bf_error *err)
{
    bf_buffer text = { 0 };

    bf_status status =
        x->services->read_study(x->services->store, id, API_STUDY_COLUMNS, &text, err);
    if (status == BF_OK)
        status = study_columns_read(text.bytes, text.n, ret_columns, err);
    buffer_fini(&text);
    return status;
}

// A page that is written.
typedef struct page {
    json_out w;
    const study_columns *columns;
} page;

static bf_status write_trial(void *context, const api_trial *trial, bf_error *err)
{
    page *p = context;
    const study_trial_item item = { .columns = p->columns, .trial = *trial };

    members_write(&p->w, &study_trial_members, &item);
    return json_out_status(&p->w, err);
}

static bf_status write_page(exchange *x, const api_study *about, const study_columns *columns,
                            bf_error *err)
{
    const api_trial_query wanted = { .order = API_TRIALS_BY_NUMBER,
                                     .from = exchange__whole(x, "from"),
                                     .limit = (size_t)exchange__whole(x, "limit") };
    page p = { .w = json_out_to(&x->response->body), .columns = columns };

    json_out_object(&p.w);
    json_out_key(&p.w, "trials");
    json_out_array(&p.w);
    bf_status status =
        x->services->read_trials(x->services->store, about->id, &wanted, write_trial, &p, err);
    json_out_array_end(&p.w);
    const bool has_more = wanted.from + wanted.limit < about->n_trials;
    json_out_key_bool(&p.w, "has_more", has_more);
    if (has_more)
        json_out_key_integer(&p.w, "next_from", (int64_t)(wanted.from + wanted.limit));
    json_out_object_end(&p.w);
    if (status != BF_OK)
        return status;
    if (has_more)
        api_response_header(x->response, "Link",
                            "</v1/studies/%s/trials?limit=%zu&from=%" PRIu64 ">; rel=\"next\"",
                            about->id, wanted.limit, wanted.from + wanted.limit);
    exchange__cache_revalidate(x);
    return json_out_status(&p.w, err);
}

bf_status handlers_trials_list(exchange *x, bf_error *err)
{
    study_columns columns;
    const api_study *of = &x->named->study;

    BF_TRY(read_columns(x, of->id, &columns, err));
    if (x->media->format != MEDIA_CSV)
        return write_page(x, of, &columns, err);
    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-csv", of->revision))
        return BF_OK;
    return trials_csv_open(of, &columns, &x->response->source, err);
}

bf_status handlers_trials_events(exchange *x, bf_error *err)
{
    study_stream stream = { .format = x->media->format == MEDIA_SSE ? STREAM_SSE : STREAM_NDJSON };
    const api_study *of = &x->named->study;

    BF_TRY(handlers__read_last_event(x, &stream.after, err));
    BF_TRY(read_columns(x, of->id, &stream.columns, err));
    if (!study_stream_begin(&stream, of)) {
        x->response->status = 204; // tells a browser not to reconnect
        return BF_OK;
    }
    api_response_header(x->response, "X-Accel-Buffering", "no");
    return study_stream_open(&stream, &x->response->source, err);
}

// ---- a trial as a run of its own

static bf_status on_trial(void *context, const api_trial *trial, bf_error *err)
{
    (void)err;
    *(api_trial *)context = *trial;
    return BF_OK;
}

static bf_status find_trial(exchange *x, api_trial *ret_trial, bf_error *err)
{
    const char *number = x->params.values[1];
    api_trial_query wanted = { .order = API_TRIALS_BY_NUMBER, .limit = 1 };
    const api_study *of = &x->named->study;

    if (!number_read_digits(number, 0, UINT64_MAX, &wanted.from) || wanted.from >= of->n_trials)
        return bf_fail(err, BF_ENOTFOUND, "", "the study has no trial '%s'; it has %" PRIu64,
                       number, of->n_trials);
    *ret_trial = (api_trial){ .number = wanted.from };
    return x->services->read_trials(x->services->store, of->id, &wanted, on_trial, ret_trial, err);
}

static bf_status read_scenario(exchange *x, const api_trial *trial, bf_buffer *out, bf_error *err)
{
    if (trial->run[0] == '\0')
        return bf_fail(err, BF_ECONFLICT, "", "the trial has no run%s",
                       trial->state == API_TRIAL_INFEASIBLE ? ": its scenario is not valid" : "");
    const bf_status status =
        x->services->read_text(x->services->store, trial->run, API_TEXT_SCENARIO, out, err);
    if (status == BF_ENOTFOUND)
        return bf_fail(err, BF_ECONFLICT, "", "the run of the trial was removed: %s", trial->run);
    return status;
}

static bf_status make_submission(exchange *x, const api_trial *trial,
                                 api_submission *ret_submission, bf_error *err)
{
    bf_buffer text = { 0 };
    scene made;

    bf_status status = read_scenario(x, trial, &text, err);
    if (status == BF_OK)
        status = scenario_read_resolved(text.bytes, text.n, &made, err);
    buffer_fini(&text);
    if (status != BF_OK)
        return status;
    status = submission_make(&made, trial->model, ret_submission, err);
    scene_fini(&made);
    return status;
}

bf_status handlers_trials_run(exchange *x, bf_error *err)
{
    const char *path = x->request->path;
    api_submission submission = { 0 };
    api_trial trial;

    if (x->request->polled != NULL)
        return handlers__answer_polled(x, err);
    bf_status status = find_trial(x, &trial, err);
    if (status == BF_OK)
        status = make_submission(x, &trial, &submission, err);
    // There is no body; another trial is another request.
    if (status == BF_OK)
        status = handlers__submit_run(x, &submission, path, strlen(path), err);
    submission_fini(&submission);
    return status;
}
