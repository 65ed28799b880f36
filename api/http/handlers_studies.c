// Studies: accept, list, show, annotate, pause, resume, cancel, remove.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/json/text.h"
#include "api/results/annotations_json.h"
#include "api/study/study_json.h"
#include "api/study/study_submission.h"
#include "core/base/memory.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static bf_status read_submission(exchange *x, api_study_submission *ret_submission, bf_error *err)
{
    json_in_texts texts = handlers__texts(x, STUDY_SUBMISSION_TEXTS_MAX);

    bf_status status = study_submission_read(exchange__body(x), x->request->n_body, &texts,
                                             ret_submission, &x->faults, err);
    if (status != BF_OK)
        return status;
    status = access_check_priority(x, ret_submission->priority, err);
    if (status != BF_OK)
        study_submission_fini(ret_submission);
    return status;
}

// Nothing that can fail follows the submission; see the one of runs.
static bf_status submit(exchange *x, const api_study_submission *submission, bf_error *err)
{
    api_acceptance accepted = { 0 };

    bf_status status = x->services->submit_study(x->services->service, submission, &accepted, err);
    if (status != BF_OK) {
        handlers__note_refusal(x, status, &accepted);
        return status;
    }
    if (accepted.is_replay)
        api_response_header(x->response, "Idempotent-Replayed", "true");
    x->response->body = accepted.answer;
    handlers__answer_head(x, "/v1/studies", accepted.id, accepted.revision);
    return BF_OK;
}

bf_status handlers__submit_study(exchange *x, api_study_submission *submission, bf_error *err)
{
    const bf_status status =
        handlers__read_sender(x, x->request->body, x->request->n_body, &submission->sender, err);
    return status == BF_OK ? submit(x, submission, err) : status;
}

bf_status handlers_studies_submit(exchange *x, bf_error *err)
{
    api_study_submission submission = { .name = "" };

    bf_status status = read_submission(x, &submission, err);
    if (status == BF_OK)
        status = handlers__submit_study(x, &submission, err);
    study_submission_fini(&submission);
    return status;
}

bf_status handlers_studies_list(exchange *x, bf_error *err)
{
    const exchange_page page = exchange__page(x);
    const char *state = exchange__text(x, "status"), *line = exchange__text(x, "line");
    api_study_query wanted = { .state = -1, .limit = page.limit };

    bf_status status = access_list_owner_asked(x, wanted.owner, err);
    if (status != BF_OK)
        return status;
    snprintf(wanted.before, sizeof wanted.before, "%s", page.cursor);
    if (state != NULL)
        wanted.state = (int)text_find_word(api_study_state_words, API_STUDY_STATES, state);
    if (line != NULL)
        snprintf(wanted.line, sizeof wanted.line, "%s", line);
    api_study_list *list = memory_alloc(1, sizeof *list);
    if (list == NULL)
        return bf_fail_memory(err);
    status = x->services->list_studies(x->services->store, &wanted, list, err);
    if (status == BF_OK && list->has_more && list->n > 0)
        memcpy(list->next_cursor, list->items[list->n - 1].id, sizeof list->next_cursor);
    if (status == BF_OK)
        status = exchange__send_page(x, &page, list->next_cursor, &study_json_list, list, err);
    memory_free(list);
    return status;
}

bf_status handlers_studies_show(exchange *x, bf_error *err)
{
    api_study about;

    bf_status status = exchange__find_study(x, &about, err);
    if (status != BF_OK)
        return status;
    exchange__cache_revalidate(x);
    (void)exchange__match_etag(x, "r%" PRIu64, about.revision);
    return study_json_write(&about, &x->response->body, err);
}

// Changes besides those of api_study_change.
enum { REMOVE = API_STUDY_CHANGES, ANNOTATE };

// The study keeps what the patch does not name, as of the revision that it was found with.
static bf_status annotate(exchange *x, api_study *about, bf_error *err)
{
    api_annotations annotations = { .name = "" };

    memcpy(annotations.name, about->name, sizeof about->name);
    memcpy(annotations.line, about->line, sizeof annotations.line);
    bf_status status =
        annotations_json_read(exchange__body(x), x->request->n_body, &annotations_json_study,
                              &annotations, &x->faults, err);
    return status == BF_OK ? x->services->annotate_study(x->services->store, about->id,
                                                         about->revision, &annotations, about, err)
                           : status;
}

// Compares If-Match with the study as it is found, and the change compares the revision again; where another change came
// between, the study is looked at anew.
static bf_status change_study(exchange *x, int change, api_study *ret_study, bf_error *err)
{
    const api_services *services = x->services;
    api_study about;
    bf_status status;

    do {
        uint64_t revision = API_ANY_REVISION;
        status = exchange__find_study(x, &about, err);
        if (status == BF_OK)
            status = exchange__check_match(x, about.revision, &revision, err);
        if (status != BF_OK)
            return status;
        if (change == ANNOTATE)
            status = annotate(x, &about, err);
        else if (change == REMOVE)
            status = services->remove_study(services->service, about.id, revision, err);
        else
            status = services->change_study(services->service, about.id, revision,
                                            (api_study_change)change, &about, err);
    } while (status == BF_EINPUT && x->faults.n == 0);
    if (status == BF_OK)
        *ret_study = about;
    return status;
}

static bf_status answer_change(exchange *x, api_study_change change, bf_error *err)
{
    api_study about;

    bf_status status = change_study(x, change, &about, err);
    if (status != BF_OK)
        return status;
    const bool is_done = change == API_STUDY_CANCEL  ? api_study_state_is_end(about.state)
                         : change == API_STUDY_PAUSE ? about.state == API_STUDY_PAUSED
                                                     : true;
    x->response->status = is_done ? 200 : 202;
    return study_json_write(&about, &x->response->body, err);
}

bf_status handlers_studies_pause(exchange *x, bf_error *err)
{
    return answer_change(x, API_STUDY_PAUSE, err);
}

bf_status handlers_studies_resume(exchange *x, bf_error *err)
{
    return answer_change(x, API_STUDY_RESUME, err);
}

bf_status handlers_studies_cancel(exchange *x, bf_error *err)
{
    return answer_change(x, API_STUDY_CANCEL, err);
}

bf_status handlers_studies_remove(exchange *x, bf_error *err)
{
    api_study about;

    bf_status status = change_study(x, REMOVE, &about, err);
    if (status == BF_OK)
        x->response->status = 204;
    return status;
}

bf_status handlers_studies_annotate(exchange *x, bf_error *err)
{
    api_study about;

    bf_status status = change_study(x, ANNOTATE, &about, err);
    if (status == BF_OK)
        api_response_header(x->response, "ETag", "\"r%" PRIu64 "\"", about.revision);
    return status == BF_OK ? study_json_write(&about, &x->response->body, err) : status;
}
