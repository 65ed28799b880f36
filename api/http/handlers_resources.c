// What runs and studies have alike: changes with one loop over If-Match, and grants to read one of them.

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

// A run or a study.
typedef struct resource {
    bool is_study;
    union {
        api_run run;
        api_study study;
    };
} resource;

static uint64_t revision_of(const resource *r)
{
    return r->is_study ? r->study.revision : r->run.revision;
}

static bool has_ended(const resource *r)
{
    return r->is_study ? api_study_state_is_end(r->study.state) : run_state_is_end(r->run.state);
}

// Finds the one that the path names.
static bf_status find(const exchange *x, resource *ret_resource, bf_error *err)
{
    static const char studies[] = "/v1/studies/";

    ret_resource->is_study = strncmp(x->route->path, studies, sizeof studies - 1) == 0;
    return ret_resource->is_study ? exchange__find_study(x, &ret_resource->study, err)
                                  : exchange__find_run(x, &ret_resource->run, err);
}

// A change of a resource, which it updates; of API_ANY_REVISION, or of the one that the resource must still have.
typedef bf_status change_fn(exchange *x, uint64_t revision, resource *r, bf_error *err);

// If-Match is compared with the resource as it is found, and the revision that it was found with again by the change
// itself. Where another change came between, the resource is looked at anew.
static bf_status change(exchange *x, change_fn *change_it, resource *ret_resource, bf_error *err)
{
    bf_status status;

    do {
        uint64_t revision = API_ANY_REVISION;
        status = find(x, ret_resource, err);
        if (status == BF_OK)
            status = exchange__check_match(x, revision_of(ret_resource), &revision, err);
        if (status != BF_OK)
            return status;
        status = change_it(x, revision, ret_resource, err);
    } while (status == BF_EINPUT && x->faults.n == 0);
    return status;
}

static bf_status answer_change(exchange *x, change_fn *change_it, bf_error *err)
{
    resource r;

    const bf_status status = change(x, change_it, &r, err);
    if (status != BF_OK)
        return status;
    return r.is_study ? study_json_write(&r.study, &x->response->body, err)
                      : run_json_write(&r.run, &x->response->body, err);
}

// The resource keeps what the patch does not name, as of the revision that it was found with.
static bf_status annotate(exchange *x, uint64_t revision, resource *r, bf_error *err)
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
    bf_status status =
        annotations_json_read(exchange__body(x), x->request->n_body, table, &to, &x->faults, err);
    if (status == BF_OK)
        status = r->is_study ? services->annotate_study(services->store, r->study.id,
                                                        r->study.revision, &to, &r->study, err)
                             : services->annotate(services->store, r->run.id, r->run.revision, &to,
                                                  &r->run, err);
    if (status == BF_OK)
        api_response_header(x->response, "ETag", "\"r%" PRIu64 "\"", revision_of(r));
    return status;
}

static bf_status change_study(exchange *x, uint64_t revision, api_study_change how, resource *r,
                              bf_error *err)
{
    return x->services->change_study(x->services->service, r->study.id, revision, how, &r->study,
                                     err);
}

static bf_status cancel(exchange *x, uint64_t revision, resource *r, bf_error *err)
{
    const bf_status status =
        r->is_study ? change_study(x, revision, API_STUDY_CANCEL, r, err)
                    : x->services->cancel(x->services->store, r->run.id, revision, &r->run, err);
    if (status == BF_OK)
        x->response->status = has_ended(r) ? 200 : 202;
    return status;
}

static bf_status pause_study(exchange *x, uint64_t revision, resource *r, bf_error *err)
{
    const bf_status status = change_study(x, revision, API_STUDY_PAUSE, r, err);
    if (status == BF_OK)
        x->response->status = r->study.state == API_STUDY_PAUSED ? 200 : 202;
    return status;
}

static bf_status resume_study(exchange *x, uint64_t revision, resource *r, bf_error *err)
{
    return change_study(x, revision, API_STUDY_RESUME, r, err);
}

static bf_status remove_it(exchange *x, uint64_t revision, resource *r, bf_error *err)
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
    resource r;

    const bf_status status = change(x, remove_it, &r, err);
    if (status == BF_OK)
        x->response->status = 204;
    return status;
}

bf_status handlers_resources_grant(exchange *x, bf_error *err)
{
    api_grant grant = { .id = 0 };
    grant_json_request asked;
    resource r;

    bf_status status = find(x, &r, err);
    if (status == BF_OK)
        status = grant_json_read(exchange__body(x), x->request->n_body, &asked, &x->faults, err);
    if (status != BF_OK)
        return status;
    (void)snprintf(grant.resource, sizeof grant.resource, "%s%s",
                   r.is_study ? "/v1/studies/" : "/v1/runs/", r.is_study ? r.study.id : r.run.id);
    memcpy(grant.owner, x->who.owner, sizeof grant.owner);
    status = x->services->add_grant(x->services->service, asked.expires_in_s, &grant, err);
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
    bf_status status =
        x->services->revoke_grant(x->services->service, access_list_owner(x), id, err);
    if (status == BF_OK)
        x->response->status = 204;
    return status;
}
