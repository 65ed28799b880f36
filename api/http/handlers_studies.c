// Studies: accept, show.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/study/study_json.h"
#include "api/study/study_submission.h"

#include <inttypes.h>

bf_status handlers__submit_study(exchange *x, api_study_submission *submission, bf_error *err)
{
    api_acceptance accepted = { .revision = 0 };

    BF_TRY(
        handlers__read_sender(x, x->request->body, x->request->n_body, &submission->sender, err));
    const bf_status status =
        x->services->submit_study(x->services->service, submission, &accepted, err);
    return handlers__answer_submission(x, status, "/v1/studies", &accepted);
}

bf_status handlers_studies_submit(exchange *x, bf_error *err)
{
    json_in_texts texts = handlers__texts(x, STUDY_SUBMISSION_TEXTS_MAX);
    api_study_submission submission = { .name = "" };

    bf_status status = study_submission_read(exchange__body(x), x->request->n_body, &texts,
                                             &submission, &x->faults, err);
    if (status == BF_OK)
        status = access_check_priority(x, submission.priority, err);
    if (status == BF_OK)
        status = handlers__submit_study(x, &submission, err);
    study_submission_fini(&submission);
    return status;
}

bf_status handlers_studies_show(exchange *x, bf_error *err)
{
    const api_study *of = &x->named->study;

    exchange__cache_revalidate(x);
    (void)exchange__match_etag(x, "r%" PRIu64, of->revision);
    return study_json_write(of, &x->response->body, err);
}
