#include "api/http/access.h"

#include "api/http/http_priv.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static bool starts_with(const char *text, const char *start)
{
    return strncmp(text, start, strlen(start)) == 0;
}

// Whether all that a route answers belongs to runs or studies that the request names, and it changes nothing.
static bool reads_named(const route *r)
{
    return strcmp(r->method, "GET") == 0 &&
           (starts_with(r->path, "/v1/runs/{id}") || starts_with(r->path, "/v1/studies/{id}") ||
            strcmp(r->path, "/v1/events") == 0);
}

int access_decide(const route *r, api_credential credential, unsigned scopes)
{
    if (r->scope == API_SCOPE_NONE || credential == API_CREDENTIAL_UNUSED)
        return 0;
    if (credential != API_CREDENTIAL_VALID)
        return 401;
    if ((scopes & API_SCOPE_GRANTED) != 0 && reads_named(r))
        return 0;
    return api_access_includes(scopes, r->scope) ? 0 : 403;
}

// The token of `Authorization: Bearer TOKEN`; NULL: the request has none.
static const char *find_token(const exchange *x)
{
    static const char scheme[] = "Bearer ";
    const char *value = exchange__header(x, "Authorization");

    if (value == NULL || strncasecmp(value, scheme, sizeof scheme - 1) != 0)
        return NULL;
    value += sizeof scheme - 1;
    return value + strspn(value, " ");
}

bool access_takes_ticket(const route *r)
{
    return r->scope != API_SCOPE_NONE && strcmp(r->method, "GET") == 0;
}

static api_credential identify_ticket(exchange *x, const char *ticket)
{
    const api_services *services = x->services;
    uint64_t token = 0;

    api_credential credential = services->read_ticket(services->service, ticket, &token);
    return credential == API_CREDENTIAL_VALID
               ? services->identify_by_id(services->service, token, &x->who)
               : credential;
}

// A request that waited for a run is still its sender's when its ticket has expired meanwhile.
static api_credential identify(exchange *x, const char *ticket)
{
    const api_services *services = x->services;

    if (x->request->token != 0)
        return services->identify_by_id(services->service, x->request->token, &x->who);
    api_credential credential = services->identify(services->service, find_token(x), &x->who);
    return credential == API_CREDENTIAL_MISSING && ticket != NULL ? identify_ticket(x, ticket)
                                                                  : credential;
}

static const char *explain(api_credential credential)
{
    switch (credential) {
    case API_CREDENTIAL_EXPIRED:
        return "the access token or ticket has expired";
    case API_CREDENTIAL_REVOKED:
        return "the access token was revoked";
    case API_CREDENTIAL_UNKNOWN:
        return "this is no access token or ticket of this service";
    case API_CREDENTIAL_MISSING:
    case API_CREDENTIAL_UNUSED:
    case API_CREDENTIAL_VALID:
        break;
    }
    return "this needs an access token, sent as Authorization: Bearer TOKEN";
}

static bf_status refuse_scope(exchange *x, api_scope lacked, const char *pointer, bf_error *err)
{
    x->lacked = lacked;
    return exchange__refuse(x, 403, pointer, err, "the access token lacks the scope %s",
                            api_access_word(lacked));
}

bf_status access_check(exchange *x, bf_error *err)
{
    const char *ticket = access_takes_ticket(x->route) ? query_take(&x->query, "ticket") : NULL;

    if (x->services->identify == NULL)
        return BF_OK;
    x->credential = identify(x, ticket);
    int status = access_decide(x->route, x->credential, x->who.scopes);
    if (status == 401)
        return exchange__refuse(x, 401, "", err, "%s", explain(x->credential));
    return status == 403 ? refuse_scope(x, x->route->scope, "", err) : BF_OK;
}

bf_status access_check_priority(exchange *x, int priority, bf_error *err)
{
    if (priority <= 0 || x->credential == API_CREDENTIAL_UNUSED ||
        api_access_includes(x->who.scopes, API_SCOPE_PRIORITY))
        return BF_OK;
    return refuse_scope(x, API_SCOPE_PRIORITY, "/priority", err);
}

const char *access_list_owner(const exchange *x)
{
    bool sees_all = x->credential == API_CREDENTIAL_UNUSED ||
                    api_access_includes(x->who.scopes, API_SCOPE_ADMIN);

    return sees_all ? "" : x->who.owner;
}

bf_status access_list_owner_asked(exchange *x, char *ret_owner, bf_error *err)
{
    const char *only = access_list_owner(x), *asked = exchange__text(x, "owner");

    if (asked == NULL)
        asked = only;
    if (only[0] != '\0' && strcmp(asked, only) != 0)
        return exchange__refuse(
            x, 403, "", err, "query parameter 'owner': this token lists only what is %s's", only);
    snprintf(ret_owner, API_OWNER_SIZE, "%s", asked);
    return BF_OK;
}

// Whether the sender may see what somebody owns.
static bool may_see(const exchange *x, const char *owner)
{
    const char *only = access_list_owner(x);

    return only[0] == '\0' || strcmp(only, owner) == 0;
}

static bool is_granted(const exchange *x)
{
    return x->credential == API_CREDENTIAL_VALID && (x->who.scopes & API_SCOPE_GRANTED) != 0;
}

// Whether the sender's token is for this resource.
static bool reads_resource(const exchange *x, const char *collection, const char *id)
{
    return starts_with(x->who.resource, collection) &&
           strcmp(x->who.resource + strlen(collection), id) == 0;
}

bf_status access_find_run(const exchange *x, const char *id, api_run *ret_run, bf_error *err)
{
    BF_TRY(x->services->find(x->services->service, id, ret_run, err));
    const bool may = is_granted(x) ? reads_resource(x, "/v1/runs/", ret_run->id) ||
                                         reads_resource(x, "/v1/studies/", ret_run->study)
                                   : may_see(x, ret_run->owner);
    return may ? BF_OK : bf_fail(err, BF_ENOTFOUND, "", "there is no run %.40s", id);
}

bf_status access_find_study(const exchange *x, const char *id, api_study *ret_study, bf_error *err)
{
    BF_TRY(x->services->find_study(x->services->store, id, ret_study, err));
    const bool may = is_granted(x) ? reads_resource(x, "/v1/studies/", ret_study->id)
                                   : may_see(x, ret_study->owner);
    return may ? BF_OK : bf_fail(err, BF_ENOTFOUND, "", "there is no study %.40s", id);
}

bf_status access_find_measurement(const exchange *x, const char *id,
                                  api_measurement *ret_measurement, bf_error *err)
{
    BF_TRY(x->services->find_measurement(x->services->store, id, ret_measurement, err));
    if (is_granted(x) || !may_see(x, ret_measurement->owner))
        return bf_fail(err, BF_ENOTFOUND, "", "there is no measurement %.40s", id);
    return BF_OK;
}

void access_challenge(exchange *x, int status)
{
    if (status == 401)
        api_response_header(x->response, "WWW-Authenticate", "Bearer realm=\"beltflow\"%s",
                            x->credential == API_CREDENTIAL_MISSING ? ""
                                                                    : ", error=\"invalid_token\"");
    else if (status == 403 && x->lacked != API_SCOPE_NONE)
        api_response_header(x->response, "WWW-Authenticate",
                            "Bearer realm=\"beltflow\", error=\"insufficient_scope\", scope=\"%s\"",
                            api_access_word(x->lacked));
}
