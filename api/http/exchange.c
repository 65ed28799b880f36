// Dispatch: path and method to a route, query and Accept checked against it, failures to problems.

#include "api/http/exchange.h"

#include "api/http/exchange_priv.h"
#include "api/http/precondition.h"
#include "core/base/check.h"
#include "core/base/digest.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// A request that asks for no format that there is will be refused, which is no work.
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

void api_response_header(api_response *response, const char *name, const char *format, ...)
{
    va_list args;

    BF_CHECK(response->n_headers < API_HEADERS_MAX);
    api_header *header = &response->headers[response->n_headers++];
    header->name = name;
    va_start(args, format);
    int n = vsnprintf(header->value, sizeof header->value, format, args);
    va_end(args);
    BF_CHECK(n >= 0 && (size_t)n < sizeof header->value);
}

void api_response_fini(api_response *response)
{
    if (response == NULL)
        return;
    buffer_fini(&response->body);
    if (response->source.next_chunk != NULL)
        response->source.destroy(response->source.state);
    *response = (api_response){ 0 };
}

__attribute__((format(printf, 5, 0))) static bf_status refuse_with(exchange *x, int http_status,
                                                                   const char *pointer,
                                                                   bf_error *err,
                                                                   const char *format, va_list args)
{
    char text[BF_TEXT_SIZE];

    vsnprintf(text, sizeof text, format, args);
    x->refusal = http_status;
    return bf_fail(err, BF_EINPUT, pointer, "%s", text);
}

bf_status exchange__refuse(exchange *x, int http_status, bf_error *err, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    bf_status status = refuse_with(x, http_status, "", err, format, args);
    va_end(args);
    return status;
}

bf_status exchange__refuse_at(exchange *x, int http_status, const char *pointer, bf_error *err,
                              const char *format, ...)
{
    va_list args;

    va_start(args, format);
    bf_status status = refuse_with(x, http_status, pointer, err, format, args);
    va_end(args);
    return status;
}

const char *exchange__header(const exchange *x, const char *name)
{
    return x->request->header(x->request->header_context, name);
}

bf_status exchange__find_run(const exchange *x, api_run *ret_run, bf_error *err)
{
    const char *id = x->params.values[0];

    BF_CHECK(x->params.n > 0);
    if (!exchange__is_id(id))
        return bf_fail(err, BF_ENOTFOUND, "", "there is no run '%s'", id);
    return x->services->find(x->services->context, id, ret_run, err);
}

void exchange__let_keep(exchange *x)
{
    api_response_header(x->response, "Cache-Control", "private, max-age=31536000, immutable");
}

bf_status exchange__find_snapshot(const exchange *x, const api_run *of, uint64_t *ret_index,
                                  bf_error *err)
{
    const char *number = x->params.values[1];
    uint64_t index = 0;

    BF_CHECK(x->params.n > 1);
    if (query_read_number(number, &index) != 0 || index >= of->n_snapshots)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no snapshot '%s'; it has %" PRIu64,
                       number, of->n_snapshots);
    *ret_index = index;
    return BF_OK;
}

void exchange__name_snapshot(exchange *x, uint64_t index)
{
    api_response_header(x->response, "Content-Disposition", "inline; filename=\"%06" PRIu64 ".%s\"",
                        index, x->media->word);
}

// Sets ETag, and the status if the client has this state. ret_form is the tag that it knows it by.
static bool tag_state(exchange *x, const char *tag, char *ret_form)
{
    const char *known = exchange__header(x, "If-None-Match");
    bool is_known =
        known != NULL &&
        precondition_is_known(known, tag, exchange__header(x, "Accept-Encoding"), ret_form);

    api_response_header(x->response, "ETag", "\"%s\"", tag);
    if (is_known)
        x->response->status = 304;
    return is_known;
}

static void write_tag(char *tag, const char *format, va_list args)
{
    int n = vsnprintf(tag, EXCHANGE_ETAG_SIZE, format, args);

    BF_CHECK(n >= 0 && n < EXCHANGE_ETAG_SIZE);
}

bool exchange__is_known(exchange *x, const char *format, ...)
{
    char tag[EXCHANGE_ETAG_SIZE], form[CODING_TAG_SIZE];
    va_list args;

    va_start(args, format);
    write_tag(tag, format, args);
    va_end(args);
    return tag_state(x, tag, form);
}

bool exchange__is_unchanged(exchange *x, const char *format, ...)
{
    char tag[EXCHANGE_ETAG_SIZE], form[CODING_TAG_SIZE], quoted[CODING_TAG_SIZE + 2];
    va_list args;

    va_start(args, format);
    write_tag(tag, format, args);
    va_end(args);
    if (!tag_state(x, tag, form))
        return false;
    snprintf(quoted, sizeof quoted, "\"%s\"", form);
    api_response_set(x->response, "ETag", quoted);
    return true;
}

void exchange__let_revalidate(exchange *x)
{
    api_response_header(x->response, "Cache-Control", "private, no-cache");
}

bf_status exchange__check_match(exchange *x, const api_run *record, uint64_t *ret_revision,
                                bf_error *err)
{
    const char *wanted = exchange__header(x, "If-Match");
    char tag[EXCHANGE_ETAG_SIZE];

    snprintf(tag, sizeof tag, "r%" PRIu64, record->revision);
    if (wanted == NULL || precondition_holds(wanted, tag)) {
        *ret_revision = wanted == NULL ? API_ANY_REVISION : record->revision;
        return BF_OK;
    }
    return exchange__refuse(x, 412, err,
                            "the run is not in the state that If-Match names: it is \"%s\"", tag);
}

static bf_status find_route(exchange *x, bf_error *err)
{
    const api_request *request = x->request;
    char allow[ROUTES_ALLOW_SIZE];

    if (strlen(request->path) >= API_PATH_MAX || strlen(request->query) >= API_PATH_MAX - 1)
        return exchange__refuse(x, 414, err, "path and query may have %d bytes each",
                                API_PATH_MAX - 2);
    x->route = routes_find(request->method, request->path, &x->params);
    if (x->route != NULL)
        return BF_OK;
    if (!routes_allow(request->path, allow))
        return bf_fail(err, BF_ENOTFOUND, "", "there is nothing at this path");
    return exchange__refuse(x, 405, err, "this path knows: %s", allow);
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
        status = query_allow(&x->query, x->route->query, err);
    if (status == BF_OK)
        status = choose_media(x, err);
    if (status == BF_OK)
        status = x->route->handle(x, err);
    return status;
}

// An answer that may be kept but has no entity tag yet gets one of its bytes.
static void tag_by_bytes(exchange *x)
{
    api_response *response = x->response;
    const char *caching = api_response_find(response, "Cache-Control");

    if (response->status != 200 || response->source.is_stream || x->route->method[0] != 'G' ||
        caching == NULL || api_response_find(response, "ETag") != NULL)
        return;
    uint64_t digest = digest_add(DIGEST_START, response->body.bytes, response->body.n);
    (void)exchange__is_known(x, "%016" PRIx64, digest);
}

// What every answer that is not a problem carries.
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

// A document that is at fault is understood but cannot be processed, unless it is none at all.
static int refusal_status(const exchange *x, bf_status code)
{
    if (x->refusal != 0)
        return x->refusal;
    if ((code == BF_EINPUT || code == BF_ELIMIT) && x->faults.n > 0)
        return x->faults.items[0].pointer[0] == '\0' ? 400 : 422;
    return problem__status(code);
}

static void refuse(exchange *x, bf_status code, const bf_error *error)
{
    int status = refusal_status(x, code);
    char allow[ROUTES_ALLOW_SIZE];

    problem__write(x->response, status, x->request->path, error, &x->faults);
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
