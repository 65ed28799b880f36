// Runs: accept or validate a submission, list, show.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/http/negotiation.h"
#include "api/http/run_sort.h"
#include "api/json/text.h"
#include "api/results/run_json.h"
#include "api/scenario/condition.h"
#include "api/scenario/submission.h"
#include "api/study/study_replications.h"
#include "api/study/study_submission.h"
#include "core/base/memory.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static bf_status read_submission(exchange *x, api_submission *submission, bf_error *err)
{
    json_in_texts texts = handlers__texts(x, SUBMISSION_TEXTS_MAX);

    const bf_status status =
        submission_read(exchange__body(x), x->request->n_body, &texts, submission, &x->faults, err);
    return status == BF_OK ? access_check_priority(x, submission->priority, err) : status;
}

// Takes the run as it is now for the answer. False: it was removed or cannot be read, and *accepted is as before.
static bool take_present(exchange *x, const char *id, api_acceptance *accepted)
{
    bf_buffer answer = { 0 };
    api_run record;

    if (access_find_run(x, id, &record, NULL) != BF_OK ||
        run_json_write(&record, &answer, NULL) != BF_OK) {
        buffer_fini(&answer);
        return false;
    }
    buffer_fini(&accepted->answer);
    accepted->answer = answer;
    accepted->revision = record.revision;
    memcpy(accepted->id, record.id, sizeof accepted->id);
    exchange__prefer_long_poll(x, &record);
    return true;
}

bf_status handlers__answer_polled(exchange *x, bf_error *err)
{
    api_acceptance polled = { .revision = 0 };

    if (!take_present(x, x->request->polled->run, &polled))
        return bf_fail(err, BF_ENOTFOUND, "", "the run is gone");
    return handlers__answer_submission(x, BF_OK, "/v1/runs", &polled);
}

// A client that prefers to wait gets the run as it is now, even where the first answer is repeated. The order of the checks
// (key, then quotas, then queue) is the store's.
bf_status handlers__submit_run(exchange *x, api_submission *submission, const char *body, size_t n,
                               bf_error *err)
{
    api_acceptance accepted = { .revision = 0 };
    unsigned seconds = 0;

    BF_TRY(handlers__read_sender(x, body, n, &submission->sender, err));
    const bf_status status = x->services->submit(x->services->service, submission, &accepted, err);
    if (status == BF_OK && negotiation_read_wait(exchange__header(x, "Prefer"), &seconds))
        (void)take_present(x, accepted.id, &accepted);
    return handlers__answer_submission(x, status, "/v1/runs", &accepted);
}

bf_status handlers_runs_submit(exchange *x, bf_error *err)
{
    api_submission submission = { 0 };

    if (x->request->polled != NULL)
        return handlers__answer_polled(x, err);
    bf_status status = read_submission(x, &submission, err);
    if (status == BF_OK && submission.replications > 1) { // a study in place of the run
        api_study_submission replicated = { .name = "" };
        status = study_replications_make(&submission, &replicated, err);
        if (status == BF_OK)
            status = handlers__submit_study(x, &replicated, err);
        study_submission_fini(&replicated);
    } else if (status == BF_OK) {
        status = handlers__submit_run(x, &submission, x->request->body, x->request->n_body, err);
    }
    submission_fini(&submission);
    return status;
}

bf_status handlers_runs_validate(exchange *x, bf_error *err)
{
    enum { NUMBERS = 4 }; // of a part
    const uint64_t parts_max = exchange__whole(x, "parts");
    api_submission submission = { 0 };
    prediction_speed speed;

    bf_status status =
        exchange__reserve_whole(x, NUMBERS * parts_max, sizeof(double), "fewer parts", err);
    if (status == BF_OK)
        status = read_submission(x, &submission, err);
    if (status == BF_OK) {
        const bool has_speed = x->services->read_speed(x->services->service, &speed);
        status = submission_validation(&submission, has_speed ? &speed : NULL, parts_max,
                                       &x->response->body, err);
    }
    submission_fini(&submission);
    return status;
}

static api_list_query read_list_query(const exchange *x, const exchange_page *page)
{
    const char *state = exchange__text(x, "status");
    const char *model = exchange__text(x, "model");
    const char *parent = exchange__text(x, "study");
    const char *sort = exchange__text(x, "sort");
    const char *search = exchange__text(x, "search");
    const char *line = exchange__text(x, "line");
    const char *where = exchange__text(x, "where");
    api_list_query list = {
        .state = -1,
        .model = -1,
        .limit = page->limit,
        .counts = exchange__whole(x, "count") == 1,
        .from_ms = (int64_t)exchange__whole(x, "created_from"),
        .before_ms = (int64_t)exchange__whole(x, "created_before"),
        .is_starred = exchange__whole(x, "starred") == 1,
    };

    memcpy(list.label, page->label, sizeof list.label);
    snprintf(list.line, sizeof list.line, "%s", line == NULL ? "" : line);
    snprintf(list.search, sizeof list.search, "%s", search == NULL ? "" : search);
    for (char *c = list.search; *c != '\0'; c++) {
        if (*c >= 'A' && *c <= 'Z')
            *c = (char)(*c - 'A' + 'a'); // as the store compares
    }
    if (sort != NULL)
        (void)run_sort_read(sort, &list.sort);
    snprintf(list.study, sizeof list.study, "%s", parent != NULL ? parent : "");
    if (where != NULL && condition_list_read(where, &list.conditions, NULL) != BF_OK)
        list.conditions.n = 0; // routes__run_where has read it
    if (state != NULL)
        list.state = (int)text_find_word(run_state_words, RUN_STATE_COUNT, state);
    if (model != NULL)
        list.model = (int)text_find_word(run_model_words, RUN_MODEL_COUNT, model);
    return list;
}

bf_status handlers_runs_list(exchange *x, bf_error *err)
{
    const exchange_page page = exchange__page(x);
    api_list_query list_query = read_list_query(x, &page);

    BF_TRY(access_list_owner_asked(x, list_query.owner, err));
    if (page.cursor[0] != '\0' && !run_sort_read_cursor(page.cursor, &list_query))
        return exchange__refuse(x, 400, "", err,
                                "query parameter 'cursor' is of a list in another order");
    if (list_query.conditions.n > 0 && list_query.study[0] != '\0')
        return exchange__refuse(x, 400, "", err,
                                "query parameter 'where' is of runs that are nobody's trials: the "
                                "table of a study's trials has their parameters");
    api_run_list *list = memory_alloc(1, sizeof *list);
    if (list == NULL)
        return bf_fail_memory(err);
    bf_status status = x->services->list(x->services->service, &list_query, list, err);
    if (status == BF_OK && list->has_more)
        run_sort_write_cursor(list->last_id, list->last_key, list->next_cursor);
    if (status == BF_OK)
        status = exchange__send_page(x, &page, list->next_cursor, &run_json_list, list, err);
    memory_free(list);
    return status;
}

// With `wait`, a client that names a state by If-None-Match is answered when the run has another one,
// and any other client when the run has ended.
bf_status handlers_runs_show(exchange *x, bf_error *err)
{
    bool has_state = exchange__header(x, "If-None-Match") != NULL;
    unsigned seconds = (unsigned)exchange__whole(x, "wait");
    const api_run *of = &x->named->run;

    exchange__cache_revalidate(x);
    // What is predicted of a run that waits changes its representation, but not its revision.
    const char *predicted = isnan(of->predicted_s) ? "" : "p";
    if (exchange__match_etag(x, "r%" PRIu64 "%s", of->revision, predicted) || !has_state)
        exchange__long_poll(x, of, seconds, has_state);
    return run_json_write(of, &x->response->body, err);
}
