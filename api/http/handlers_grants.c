// Grants: make one of a run or study, list one's own, revoke one.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/json/number.h"
#include "api/results/grant_json.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// Make a grant of the resource with this path, which the sender may see.
static bf_status make(exchange *x, const char *collection, const char *id, bf_error *err)
{
    api_grant grant = { .id = 0 };
    grant_json_request asked;

    bf_status status =
        grant_json_read(exchange__body(x), x->request->n_body, &asked, &x->faults, err);
    if (status != BF_OK)
        return status;
    (void)snprintf(grant.resource, sizeof grant.resource, "%s%s", collection, id);
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

bf_status handlers_grants_of_run(exchange *x, bf_error *err)
{
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    return status == BF_OK ? make(x, "/v1/runs/", record.id, err) : status;
}

bf_status handlers_grants_of_study(exchange *x, bf_error *err)
{
    api_study record;

    bf_status status = exchange__find_study(x, &record, err);
    return status == BF_OK ? make(x, "/v1/studies/", record.id, err) : status;
}

bf_status handlers_grants_list(exchange *x, bf_error *err)
{
    api_grant_list list = { .n = 0 };

    bf_status status =
        x->services->list_grants(x->services->service, access_list_owner(x), &list, err);
    if (status == BF_OK)
        status = exchange__write(x, &grant_json_list_members, &list, err);
    api_grant_list_fini(&list);
    return status;
}

bf_status handlers_grants_revoke(exchange *x, bf_error *err)
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
