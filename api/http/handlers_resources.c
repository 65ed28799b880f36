// Changes of runs and studies, with one loop over If-Match, and grants to read one of them.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/json/number.h"
#include "api/results/annotations_json.h"
#include "api/results/grant_json.h"
#include "api/results/run_json.h"
#include "api/study/study_json.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static uint64_t revision_of(const exchange_resource *r)
{
    return r->is_study ? r->study.revision : r->run.revision;
}

static bool has_ended(const exchange_resource *r)
{
    return r->is_study ? api_study_state_is_end(r->study.state) : run_state_is_end(r->run.state);
}

// Changes the resource that the path names and updates it: of API_ANY_REVISION, or of the one that it must still have.
typedef bf_status change_fn(exchange *x, uint64_t revision, exchange_resource *r, bf_error *err);

// If-Match is compared with the resource as it is found, and the revision that it was found with again by the change
// itself. Where another change came between, the resource is looked at anew.
static bf_status change(exchange *x, change_fn *change_it, bf_error *err)
{
    bf_status status;

    do {
        uint64_t revision = API_ANY_REVISION;
        BF_TRY(exchange__check_match(x, revision_of(x->named), &revision, err));
        status = change_it(x, revision, x->named, err);
        if (status != BF_EINPUT || x->faults.n > 0)
            return status;
        status = exchange__find_named(x, err);
    } while (status == BF_OK);
    return status;
}

static bf_status answer_change(exchange *x, change_fn *change_it, bf_error *err)
{
    const exchange_resource *r = x->named;

    BF_TRY(change(x, change_it, err));
    return r->is_study ? study_json_write(&r->study, &x->response->body, err)
                       : run_json_write(&r->run, &x->response->body, err);
}

// The resource keeps what the patch does not name, as of the revision that it was found with.
static bf_status annotate(exchange *x, uint64_t revision, exchange_resource *r, bf_error *err)
{
    const member_table *table = r->is_study ? &annotations_json_study : &annotations_json_run;
    const api_services *services = x->services;
    api_annotations to = { .name = "" };

    (void)revision;
    if (r->is_study) {
        memcpy(to.name, r->study.name, sizeof r->study.name);
        memcpy(to.line, r->study.line, sizeof to.line);
    } else {
        memcpy(to.name, r->run.name, sizeof to.name);
        memcpy(to.label, r->run.label, sizeof to.label);
        memcpy(to.line, r->run.line, sizeof to.line);
        memcpy(to.notes, r->run.notes, sizeof to.notes);
        to.is_starred = r->run.is_starred;
    }
    BF_TRY(
        annotations_json_read(exchange__body(x), x->request->n_body, table, &to, &x->faults, err));
    if (r->is_study)
        BF_TRY(services->annotate_study(services->store, r->study.id, r->study.revision, &to,
                                        &r->study, err));
    else
        BF_TRY(services->annotate(services->store, r->run.id, r->run.revision, &to, &r->run, err));
    api_response_header(x->response, "ETag", "\"r%" PRIu64 "\"", revision_of(r));
    return BF_OK;
}

static bf_status change_study(exchange *x, uint64_t revision, api_study_change how,
                              exchange_resource *r, bf_error *err)
{
    return x->services->change_study(x->services->service, r->study.id, revision, how, &r->study,
                                     err);
}

static bf_status cancel(exchange *x, uint64_t revision, exchange_resource *r, bf_error *err)
{
    const bf_status status =
        r->is_study ? change_study(x, revision, API_STUDY_CANCEL, r, err)
                    : x->services->cancel(x->services->store, r->run.id, revision, &r->run, err);
    if (status == BF_OK)
        x->response->status = has_ended(r) ? 200 : 202;
    return status;
}

static bf_status pause_study(exchange *x, uint64_t revision, exchange_resource *r, bf_error *err)
{
    BF_TRY(change_study(x, revision, API_STUDY_PAUSE, r, err));
    x->response->status = r->study.state == API_STUDY_PAUSED ? 200 : 202;
    return BF_OK;
}

static bf_status resume_study(exchange *x, uint64_t revision, exchange_resource *r, bf_error *err)
{
    return change_study(x, revision, API_STUDY_RESUME, r, err);
}

static bf_status remove_it(exchange *x, uint64_t revision, exchange_resource *r, bf_error *err)
{
    const api_services *services = x->services;

    return r->is_study ? services->remove_study(services->service, r->study.id, revision, err)
                       : services->remove(services->service, r->run.id, revision, err);
}

bf_status handlers_resources_annotate(exchange *x, bf_error *err)
{
    return answer_change(x, annotate, err);
}

bf_status handlers_resources_cancel(exchange *x, bf_error *err)
{
    return answer_change(x, cancel, err);
}

bf_status handlers_resources_pause(exchange *x, bf_error *err)
{
    return answer_change(x, pause_study, err);
}

bf_status handlers_resources_resume(exchange *x, bf_error *err)
{
    return answer_change(x, resume_study, err);
}

bf_status handlers_resources_remove(exchange *x, bf_error *err)
{
    BF_TRY(change(x, remove_it, err));
    x->response->status = 204;
    return BF_OK;
}

bf_status handlers_resources_grant(exchange *x, bf_error *err)
{
    api_grant grant = { .id = 0 };
    grant_json_request asked;
    const exchange_resource *r = x->named;

    BF_TRY(grant_json_read(exchange__body(x), x->request->n_body, &asked, &x->faults, err));
    (void)snprintf(grant.resource, sizeof grant.resource, "%s%s",
                   r->is_study ? "/v1/studies/" : "/v1/runs/",
                   r->is_study ? r->study.id : r->run.id);
    memcpy(grant.owner, x->who.owner, sizeof grant.owner);
    const bf_status status =
        x->services->add_grant(x->services->service, asked.expires_in_s, &grant, err);
    if (status == BF_ELIMIT)
        x->refusal = 429;
    if (status != BF_OK)
        return status;
    x->response->status = 201;
    api_response_header(x->response, "Location", "/v1/grants/%" PRIu64, grant.id);
    return exchange__write(x, &grant_json_members, &grant, err);
}

bf_status handlers_resources_list_grants(exchange *x, bf_error *err)
{
    api_grant_list list = { .n = 0 };

    bf_status status =
        x->services->list_grants(x->services->service, access_list_owner(x), &list, err);
    if (status == BF_OK)
        status = exchange__write(x, &grant_json_list_members, &list, err);
    api_grant_list_fini(&list);
    return status;
}

bf_status handlers_resources_revoke_grant(exchange *x, bf_error *err)
{
    uint64_t id = 0;

    if (!number_read_digits(x->params.values[0], 1, INT64_MAX, &id))
        return bf_fail(err, BF_ENOTFOUND, "", "there is no grant '%s'", x->params.values[0]);
    BF_TRY(x->services->revoke_grant(x->services->service, access_list_owner(x), id, err));
    x->response->status = 204;
    return BF_OK;
}
