// What submissions of runs and of studies have in common: the key, the sender, what they name, refusals.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/http/negotiation.h"
#include "api/results/measurement.h"
#include "api/study/study_submission.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static bf_status append_curve(const exchange *x, const char *id, bf_buffer *out, bf_error *err)
{
    api_curve curve = { 0 };
    json_out w = json_out_to(out);

    BF_TRY(x->services->read_measurement(x->services->store, id, &curve, err));
    json_out_object(&w);
    json_out_key(&w, "t_s");
    json_out_numbers(&w, (const double *)(const void *)curve.t.bytes, curve.n, 1);
    json_out_key(&w, "count");
    json_out_numbers(&w, (const double *)(const void *)curve.values.bytes, curve.n, 1);
    json_out_object_end(&w);
    api_curve_fini(&curve);
    return json_out_status(&w, err);
}

// What a feed's profile or schedule, or a curve of a study, names.
static bf_status read_text(const void *context, const char *id, const char *kind, bf_buffer *out,
                           bf_error *err)
{
    const exchange *x = context;
    const api_services *services = x->services;
    bf_status status = BF_ENOTFOUND;
    api_measurement about;

    if (param_is_id(id))
        status = access_find_measurement(x, id, &about, err);
    if (status == BF_OK && strcmp(api_measured_words[about.kind], kind) != 0)
        return bf_fail(err, BF_EINPUT, "", "the measurement %s is a %s, not a %s", id,
                       api_measured_words[about.kind], kind);
    if (status == BF_OK)
        status = strcmp(kind, study_submission_curve) == 0
                     ? append_curve(x, id, out, err)
                     : services->read_measurement_csv(services->store, id, out, err);
    // It may have been removed meanwhile.
    if (status == BF_ENOTFOUND)
        return bf_fail(err, BF_EINPUT, "", "there is no measurement '%.64s'", id);
    return status;
}

json_in_texts handlers__texts(const exchange *x, size_t n)
{
    return (json_in_texts){ .context = x, .read = read_text, .n_left = n };
}

bf_status handlers__read_sender(const exchange *x, const char *body, size_t n,
                                api_sender *ret_sender, bf_error *err)
{
    api_sender sender = { .body = body, .n_body = n };

    memcpy(sender.owner, x->who.owner, sizeof sender.owner);
    if (x->request->client != NULL)
        snprintf(sender.client, sizeof sender.client, "%s", x->request->client);
    BF_TRY(negotiation_read_key(exchange__header(x, "Idempotency-Key"), sender.key, err));
    *ret_sender = sender;
    return BF_OK;
}

// Nothing that can fail follows a submission, so that nothing that was accepted is answered with a failure.
bf_status handlers__answer_submission(exchange *x, bf_status status, const char *path,
                                      api_acceptance *accepted)
{
    if (status == BF_EINPUT)
        x->refusal = 422; // the key was used with another body
    if (status == BF_ELIMIT) {
        x->refusal = 429;
        x->retry_after_s = accepted->retry_after_s;
    }
    if (status != BF_OK)
        return status;
    if (accepted->is_replay)
        api_response_header(x->response, "Idempotent-Replayed", "true");
    x->response->status = 201;
    x->response->body = accepted->answer;
    api_response_header(x->response, "Location", "%s/%s", path, accepted->id);
    api_response_header(x->response, "ETag", "\"r%" PRIu64 "\"", accepted->revision);
    return BF_OK;
}
