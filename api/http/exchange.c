// Dispatch: path and method to a route, query and Accept checked against its row, failures to problems.

#include "api/http/exchange.h"

#include "api/http/http_priv.h"
#include "api/http/problem.h"
#include "core/base/check.h"
#include "core/base/digest.h"

#include <inttypes.h>
#include <string.h>

// A request for a format that does not exist will be refused, which is not work.
api_cost api_request_cost(const api_request *request)
{
    const route *found = routes_find(request->method, request->path, NULL);
    const media *chosen = NULL;
    query q = { 0 };

    if (found == NULL)
        return API_COST_NONE;
    bool can_be_work =
        found->text_cost > found->cost && query_parse(request->query, &q, NULL) == BF_OK &&
        media_choose(found->formats, query_value(&q, "format"),
                     request->header(request->header_context, "Accept"), &chosen, NULL) == BF_OK;
    bool is_text = can_be_work && (chosen->format == MEDIA_JSON || chosen->format == MEDIA_CSV);
    return is_text ? found->text_cost : found->cost;
}

bool api_route_exists(const char *path)
{
    char allow[ROUTES_ALLOW_SIZE];

    return routes_allow(path, allow);
}

static bf_status find_route(exchange *x, bf_error *err)
{
    const api_request *request = x->request;
    char allow[ROUTES_ALLOW_SIZE];

    if (strlen(request->path) >= API_PATH_MAX || strlen(request->query) >= API_PATH_MAX - 1)
        return exchange__refuse(x, 414, "", err, "path and query may have %d bytes each",
                                API_PATH_MAX - 2);
    x->route = routes_find(request->method, request->path, &x->params);
    if (x->route != NULL)
        return BF_OK;
    if (!routes_allow(request->path, allow))
        return bf_fail(err, BF_ENOTFOUND, "", "there is nothing at this path");
    return exchange__refuse(x, 405, "", err, "this path knows: %s", allow);
}

static bf_status choose_media(exchange *x, bf_error *err)
{
    const char *word = query_value(&x->query, "format");
    bf_status status =
        media_choose(x->route->formats, word, exchange__header(x, "Accept"), &x->media, err);

    if (status != BF_OK && word == NULL)
        x->refusal = 406;
    return status;
}

static bf_status dispatch(exchange *x, bf_error *err)
{
    bf_status status = find_route(x, err);

    if (status == BF_OK)
        status = query_parse(x->request->query, &x->query, err);
    if (status == BF_OK)
        status = query_check(&x->query, x->route->params, err);
    if (status == BF_OK)
        status = choose_media(x, err);
    if (status == BF_OK)
        status = x->route->handle(x, err);
    return status;
}

// A cacheable answer without an entity tag gets a digest of its bytes as one.
static void tag_by_bytes(exchange *x)
{
    api_response *response = x->response;
    const char *caching = api_response_find(response, "Cache-Control");

    if (response->status != 200 || response->source.is_stream || x->route->method[0] != 'G' ||
        caching == NULL || api_response_find(response, "ETag") != NULL)
        return;
    uint64_t digest = digest_add(DIGEST_START, response->body.bytes, response->body.n);
    (void)exchange__match_etag(x, "%016" PRIx64, digest);
}

// Completes an answer that is not a problem document.
static void complete(exchange *x)
{
    api_response *response = x->response;

    if (response->status == 0)
        response->status = 200;
    tag_by_bytes(x);
    bool has_body = response->status != 204 && response->status != 304;
    if (has_body || response->body.n > 0)
        api_response_header(response, "Content-Type", "%s", x->media->content_type);
    if (api_response_find(response, "Cache-Control") == NULL)
        api_response_header(response, "Cache-Control", "no-store");
}

// Text that is not JSON or CSV is a 400; a document that can be parsed but is at fault, a 422.
static int refusal_status(const exchange *x, bf_status code)
{
    if (x->refusal != 0)
        return x->refusal;
    if ((code == BF_EINPUT || code == BF_ELIMIT) && x->faults.n > 0)
        return x->faults.items[0].pointer[0] == '\0' ? 400 : 422;
    return problem_status(code);
}

static void refuse(exchange *x, bf_status code, const bf_error *error)
{
    int status = refusal_status(x, code);
    char allow[ROUTES_ALLOW_SIZE];

    problem_write(x->response, status, x->request->path, error, &x->faults);
    if (status == 405 && routes_allow(x->request->path, allow))
        api_response_header(x->response, "Allow", "%s", allow);
    if (status == 415)
        api_response_header(x->response, "Accept", "%s", x->accepts);
}

static void vary(exchange *x)
{
    if (x->route != NULL && strchr(x->route->formats, ' ') != NULL)
        api_response_vary(x->response, "Accept");
}

// OPTIONS of a path that exists, or of the service as a whole ("*"). False: it is neither.
static bool answer_options(const api_request *request, api_response *response)
{
    char allow[ROUTES_ALLOW_SIZE];
    bool is_whole = strcmp(request->path, "*") == 0;

    if (strcmp(request->method, "OPTIONS") != 0 ||
        (!is_whole && !routes_allow(request->path, allow)))
        return false;
    response->status = 204;
    if (!is_whole)
        api_response_header(response, "Allow", "%s", allow);
    return true;
}

void api_handle(const api_services *services, const api_request *request, api_response *response)
{
    exchange x = { .services = services, .request = request, .response = response };
    bf_error error = { 0 };

    *response = (api_response){ 0 };
    if (!answer_options(request, response)) {
        bf_status status = dispatch(&x, &error);
        if (status == BF_OK)
            complete(&x);
        else
            refuse(&x, status, &error);
        vary(&x);
    }
    response->route = x.route == NULL ? NULL : x.route->path;
    api_response_header(response, "X-Content-Type-Options", "nosniff");
}

bool api_long_poll_is_over(const api_services *services, const api_long_poll *poll)
{
    api_run record;

    if (services->find(services->context, poll->run, &record, NULL) != BF_OK)
        return true;
    return run_state_is_end(record.state) ||
           (poll->is_for_change && record.revision != poll->revision);
}

void api_handle_again(const api_services *services, const api_request *request,
                      api_response *response)
{
    const api_long_poll polled = response->long_poll;
    api_request again = *request;
    api_response late;

    again.polled = &polled;
    response->long_poll.seconds = 0;
    api_handle(services, &again, &late);
    // A run that was accepted has been accepted, even if it is gone by now or cannot be read.
    bool is_worse = response->status == 201 && late.status != 201;
    api_response *unused = is_worse ? &late : response;
    api_response_fini(unused);
    if (!is_worse)
        *response = late;
}
