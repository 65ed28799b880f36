// One exchange: path and method to a route, query and Accept checked against its row, the handler, failures
// to problems; and what handlers read of the request and say in the response beside its body.

#include "api/http/exchange.h"

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/http/negotiation.h"
#include "api/http/problem.h"
#include "api/json/number.h"
#include "core/base/check.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

// A request for a format that does not exist will be refused, which is not work.
api_cost api_request_cost(const api_request *request)
{
    route_params params;
    const route *found = routes_find(request->method, request->path, &params);
    const media *chosen = NULL;
    query q = { 0 };

    if (found == NULL)
        return API_COST_NONE;
    bool can_be_work =
        found->text_cost > found->cost && query_parse(request->query, &q, NULL) == BF_OK &&
        negotiation_choose_media(routes_formats(found, &params), query_value(&q, "format"),
                                 request->header(request->header_context, "Accept"), &chosen,
                                 NULL) == BF_OK;
    bool is_text = can_be_work && (chosen->format == MEDIA_JSON || chosen->format == MEDIA_CSV);
    return is_text ? found->text_cost : found->cost;
}

// A long poll and what else a query may ask for is not looked at.
bool api_request_is_cached(const api_services *services, const api_request *request)
{
    route_params params;
    const route *found =
        request->query[0] != '\0' ? NULL : routes_find(request->method, request->path, &params);

    return found != NULL && found->handle == handlers_runs_show &&
           services->holds(services->service, params.values[0]);
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
    bf_status status = negotiation_choose_media(routes_formats(x->route, &x->params), word,
                                                exchange__header(x, "Accept"), &x->media, err);

    if (status != BF_OK && word == NULL)
        x->refusal = 406;
    return status;
}

// Some parameters are for some formats only; where the path says the format nothing else does. Those for formats of the body
// its handler checks, who knows which it has.
static bf_status check_format(const exchange *x, bf_error *err)
{
    const bool is_of_answer = routes_endings(x->route) == x->route->formats;

    for (const param *const *at = x->route->params; *at != NULL; at++) {
        const char *name = (*at)->name, *formats = (*at)->formats;
        if (strcmp((*at)->in, "query") != 0 || exchange__text(x, name) == NULL)
            continue;
        if ((*at)->kind == &param_format && x->params.format[0] != '\0')
            return bf_fail(err, BF_EINPUT, "", "the path says the format, and so not '%s'", name);
        if (is_of_answer && formats != NULL && !negotiation_has_format(formats, x->media->word))
            return bf_fail(err, BF_EINPUT, "", "query parameter '%s' is for %s, not for %s", name,
                           formats, x->media->word);
    }
    return BF_OK;
}

// A 415 refuses all but the formats of the route and of the path's ending, and content codings: with these types a page of
// another origin cannot post without a CORS preflight.
static bf_status check_body(exchange *x, bf_error *err)
{
    const route *r = x->route;
    const char *type = exchange__header(x, "Content-Type");
    const char *encoding = exchange__header(x, "Content-Encoding");
    const char *formats = r->body_formats;

    if (formats == NULL)
        formats = strcmp(r->method, "PATCH") == 0 ? "patch json" : "json";
    else if (routes_endings(r) == formats && x->params.format[0] != '\0')
        formats = x->params.format;
    x->body_media = negotiation_find_body(formats, type == NULL ? "" : type, x->accepts);
    if (type == NULL)
        return exchange__refuse(x, 415, "", err, "the body needs Content-Type: %s", x->accepts);
    if (x->body_media == NULL)
        return exchange__refuse(x, 415, "", err, "the body must be %s, not '%.64s'", x->accepts,
                                type);
    if (encoding != NULL && strcasecmp(encoding, "identity") != 0)
        return exchange__refuse(x, 415, "", err, "the body must not be encoded ('%.32s')",
                                encoding);
    return BF_OK;
}

// Whether the sender may use the route.
static bf_status admit(exchange *x, bf_error *err)
{
    BF_TRY(find_route(x, err));
    BF_TRY(query_parse(x->request->query, &x->query, err));
    return access_check(x, err);
}

// Finds the run or study that the path names, if it does. When a POST has waited, that was for a run that it does not name.
static bf_status find_named(const exchange *x, bf_error *err)
{
    static const char runs[] = "/v1/runs/{id}", studies[] = "/v1/studies/{id}";
    const char *path = x->route->path;

    x->named->is_study = strncmp(path, studies, sizeof studies - 1) == 0;
    if (!x->named->is_study && strncmp(path, runs, sizeof runs - 1) != 0)
        return BF_OK;
    const bool is_over = x->request->polled != NULL && strcmp(x->route->method, "POST") == 0;
    return is_over ? BF_OK : exchange__find_named(x, err);
}

static bf_status dispatch(exchange *x, bf_error *err)
{
    BF_TRY(admit(x, err));
    BF_TRY(query_check(&x->query, x->route->params, err));
    BF_TRY(choose_media(x, err));
    BF_TRY(check_format(x, err));
    if (x->route->body != NULL && x->request->polled == NULL)
        BF_TRY(check_body(x, err));
    BF_TRY(find_named(x, err));
    BF_TRY(x->route->handle(x, err));
    if (x->response->status == 0)
        x->response->status = 200;
    return exchange__check_state(x, err);
}

static void refuse(exchange *x, bf_status code, const bf_error *error)
{
    int status = x->refusal != 0 ? x->refusal : problem_status(code);
    char allow[ROUTES_ALLOW_SIZE];

    // Text that is not JSON or CSV is a 400; a document that can be parsed but is at fault, a 422.
    if (x->refusal == 0 && (code == BF_EINPUT || code == BF_ELIMIT) && x->faults.n > 0)
        status = x->faults.items[0].pointer[0] == '\0' ? 400 : 422;
    // Faults of numbers get the units of the document, which the core does not know: its angles are in radians.
    const member_table *table = x->route == NULL ? NULL : x->route->body;
    for (size_t k = 0; table != NULL && k < faults_kept(&x->faults); k++) {
        bf_error *fault = &x->faults.items[k];
        fault->unit = members_unit(table, fault->pointer);
        if (!fault->has_limit || fault->unit == NULL || strcmp(fault->unit, "deg") != 0)
            continue;
        fault->value = number_to_degrees(fault->value);
        fault->limit = number_to_degrees(fault->limit);
        snprintf(fault->text, sizeof fault->text, "must be %s %.9g, not %.9g",
                 fault->value < fault->limit ? "at least" : "at most", fault->limit, fault->value);
    }
    problem_write(x->response, status, x->request->path, error, &x->faults);
    if (status == 405 && routes_allow(x->request->path, allow))
        api_response_header(x->response, "Allow", "%s", allow);
    if (x->retry_after_s > 0) {
        char seconds[16];
        (void)snprintf(seconds, sizeof seconds, "%u", x->retry_after_s);
        api_response_set(x->response, "Retry-After", seconds);
    }
    access_challenge(x, status);
    if (status == 415)
        api_response_header(x->response, "Accept", "%s", x->accepts);
}

static void vary(exchange *x)
{
    if (x->route != NULL && strchr(routes_formats(x->route, &x->params), ' ') != NULL)
        api_response_vary(x->response, "Accept");
    if (x->credential != API_CREDENTIAL_UNUSED && x->route->scope != API_SCOPE_NONE)
        api_response_vary(x->response, "Authorization");
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

static exchange begin(const api_services *services, const api_request *request,
                      api_response *response)
{
    *response = (api_response){ 0 };
    return (exchange){ .services = services,
                       .request = request,
                       .response = response,
                       .faults = { .is_cancelled = request->is_cancelled } };
}

static void end(exchange *x)
{
    x->response->route = x->route == NULL ? NULL : x->route->path;
    x->response->who = x->who;
    api_response_header(x->response, "X-Content-Type-Options", "nosniff");
}

void api_handle(const api_services *services, const api_request *request, api_response *response)
{
    exchange x = begin(services, request, response);
    exchange_resource named;
    bf_error error = { 0 };

    x.named = &named;
    if (!answer_options(request, response)) {
        bf_status status = dispatch(&x, &error);
        if (status == BF_OK) {
            bool has_body = response->status != 204 && response->status != 304;
            if (has_body || response->body.n > 0)
                api_response_header(response, "Content-Type", "%s", x.media->content_type);
            if (api_response_find(response, "Cache-Control") == NULL)
                api_response_header(response, "Cache-Control", "no-store");
        } else {
            refuse(&x, status, &error);
        }
        vary(&x);
    }
    end(&x);
}

api_body api_admit_body(const api_services *services, const api_request *request,
                        api_response *response)
{
    exchange x = begin(services, request, response);
    bf_error error = { 0 };

    bf_status status = admit(&x, &error);
    if (x.refusal != 401 && x.refusal != 403)
        return x.route != NULL && x.route->body != NULL ? API_BODY_NEEDED : API_BODY_UNUSED;
    refuse(&x, status, &error);
    vary(&x);
    end(&x);
    return API_BODY_REFUSED;
}

bool api_long_poll_is_over(const api_services *services, const api_long_poll *poll)
{
    api_run record;

    if (services->find(services->service, poll->run, &record, NULL) != BF_OK)
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
    again.token = response->who.token;
    response->long_poll.seconds = 0;
    api_handle(services, &again, &late);
    // The run was accepted (201), even if it has been removed since or cannot be read.
    bool is_worse = response->status == 201 && late.status != 201;
    api_response *unused = is_worse ? &late : response;
    api_response_fini(unused);
    if (!is_worse)
        *response = late;
}

bf_status exchange__reserve(const exchange *x, double n, bf_error *err)
{
    const api_request *request = x->request;

    if (request->reserve == NULL || request->reserve(request->header_context, (uint64_t)n))
        return BF_OK;
    return bf_fail(err, BF_EBUSY, "", "answers to others take the memory that this one needs");
}

const char *exchange__body(const exchange *x)
{
    return x->request->body == NULL ? "" : x->request->body;
}

bf_status exchange__write(exchange *x, const member_table *table, const void *item, bf_error *err)
{
    json_out w = json_out_to(&x->response->body);

    members_write(&w, table, item);
    return json_out_status(&w, err);
}

bf_status exchange__find_named(const exchange *x, bf_error *err)
{
    exchange_resource *named = x->named;
    const char *id = x->params.values[0];

    BF_CHECK(x->params.n > 0);
    if (!param_is_id(id))
        return bf_fail(err, BF_ENOTFOUND, "", "there is no %s '%s'",
                       named->is_study ? "study" : "run", id);
    return named->is_study ? access_find_study(x, id, &named->study, err)
                           : access_find_run(x, id, &named->run, err);
}

const char *exchange__text(const exchange *x, const char *name)
{
    return query_value(&x->query, name);
}

uint64_t exchange__whole(const exchange *x, const char *name)
{
    param_value value = { .whole = 0 };

    (void)query_read(&x->query, x->route->params, name, &value);
    return value.whole;
}

double exchange__real(const exchange *x, const char *name)
{
    param_value value = { .real = 0.0 };

    BF_CHECK(query_read(&x->query, x->route->params, name, &value));
    return value.real;
}

size_t exchange__ids(const exchange *x, const char *name, char (*ret_ids)[API_ID_SIZE])
{
    param_value value;

    if (!query_read(&x->query, x->route->params, name, &value))
        return 0;
    memcpy(ret_ids, value.ids.items, value.ids.n * sizeof *ret_ids);
    return value.ids.n;
}

bf_status exchange__find_snapshot(const exchange *x, uint64_t *ret_index, bf_error *err)
{
    const api_run *of = &x->named->run;
    const char *number = x->params.values[1];
    uint64_t index = 0;

    BF_CHECK(x->params.n > 1);
    if (!number_read_digits(number, 0, UINT64_MAX, &index) || index >= of->n_snapshots)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no snapshot '%s'; it has %" PRIu64,
                       number, of->n_snapshots);
    *ret_index = index;
    return BF_OK;
}

void exchange__long_poll(exchange *x, const api_run *record, unsigned seconds, bool is_for_change)
{
    api_long_poll *wait = &x->response->long_poll;

    if (x->request->polled != NULL || seconds == 0 || run_state_is_end(record->state))
        return;
    *wait = (api_long_poll){ .seconds = seconds < API_WAIT_MAX_S ? seconds : API_WAIT_MAX_S,
                             .is_for_change = is_for_change,
                             .revision = record->revision };
    memcpy(wait->run, record->id, sizeof wait->run);
}

void exchange__prefer_long_poll(exchange *x, const api_run *record)
{
    unsigned seconds = 0;

    if (!negotiation_read_wait(exchange__header(x, "Prefer"), &seconds))
        return;
    api_response_header(x->response, "Preference-Applied", "wait=%u",
                        seconds < API_WAIT_MAX_S ? seconds : API_WAIT_MAX_S);
    exchange__long_poll(x, record, seconds, false);
}

const char *exchange__header(const exchange *x, const char *name)
{
    return x->request->header(x->request->header_context, name);
}

bf_status exchange__refuse(exchange *x, int http_status, const char *pointer, bf_error *err,
                           const char *format, ...)
{
    char text[BF_TEXT_SIZE];
    va_list args;

    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    x->refusal = http_status;
    return bf_fail(err, BF_EINPUT, pointer, "%s", text);
}

void exchange__name_snapshot(exchange *x, uint64_t index)
{
    api_response_header(x->response, "Content-Disposition", "inline; filename=\"%06" PRIu64 ".%s\"",
                        index, x->media->word);
}
