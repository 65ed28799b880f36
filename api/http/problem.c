// Problem documents (RFC 9457): one table of HTTP statuses, one writer.

#include "api/http/exchange_priv.h"

#include "api/json/json_out.h"
#include "core/base/check.h"

#include <stdio.h>
#include <string.h>

enum { RETRY_AFTER_S = 5 }; // for what is full or stopping at the moment

static const problem__kind kinds[] = {
    { 400, "bad-request", "Bad Request" },
    { 403, "forbidden", "Forbidden" },
    { 404, "not-found", "Not Found" },
    { 405, "method-not-allowed", "Method Not Allowed" },
    { 406, "not-acceptable", "Not Acceptable" },
    { 408, "request-timeout", "Request Timeout" },
    { 409, "conflict", "Conflict" },
    { 411, "length-required", "Length Required" },
    { 412, "precondition-failed", "Precondition Failed" },
    { 413, "content-too-large", "Content Too Large" },
    { 414, "uri-too-long", "URI Too Long" },
    { 415, "unsupported-media-type", "Unsupported Media Type" },
    { 416, "range-not-satisfiable", "Range Not Satisfiable" },
    { 417, "expectation-failed", "Expectation Failed" },
    { 422, "bad-document", "Unprocessable Content" },
    { 429, "too-many-requests", "Too Many Requests" },
    { 431, "header-too-large", "Request Header Fields Too Large" },
    { 500, "internal-error", "Internal Server Error" },
    { 501, "not-implemented", "Not Implemented" },
    { 503, "unavailable", "Service Unavailable" },
    { 505, "http-version", "HTTP Version Not Supported" },
};

const problem__kind *problem__kinds(size_t *ret_n)
{
    *ret_n = sizeof kinds / sizeof *kinds;
    return kinds;
}

static size_t find_kind(int status)
{
    size_t i = 0;

    while (i < sizeof kinds / sizeof *kinds && kinds[i].status != status)
        i++;
    BF_CHECK(i < sizeof kinds / sizeof *kinds);
    return i;
}

int problem__status(bf_status code)
{
    switch (code) {
    case BF_EINPUT:
    case BF_ELIMIT:
        return 400;
    case BF_ENOTFOUND:
        return 404;
    case BF_ECONFLICT:
        return 409;
    case BF_ENOMEM:
    case BF_EBUSY:
        return 503;
    default:
        return 500;
    }
}

// A decoded path is made a URI reference again.
static void encode_path(const char *path, char *ret_text, size_t size)
{
    static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                "0123456789-._~/:@!$&'()*+,;=";
    size_t n = 0;

    for (; *path != '\0' && n + 4 <= size; path++) {
        if (strchr(plain, *path) != NULL)
            ret_text[n++] = *path;
        else
            n += (size_t)snprintf(ret_text + n, size - n, "%%%02X", (unsigned char)*path);
    }
    ret_text[n] = '\0';
}

static void write_item(json_out *w, const bf_error *item)
{
    json_out_object(w);
    json_out_key_string(w, "pointer", item->pointer);
    json_out_key_string(w, "detail", item->text);
    json_out_object_end(w);
}

static void write_errors(json_out *w, const bf_error *error, const bf_faults *faults)
{
    size_t n = faults == NULL ? 0 : faults_kept(faults);

    if (n == 0 && error->pointer[0] == '\0')
        return;
    json_out_key(w, "errors");
    json_out_array(w);
    if (n == 0)
        write_item(w, error);
    for (size_t i = 0; i < n; i++)
        write_item(w, &faults->items[i]);
    json_out_array_end(w);
}

static void write_detail(json_out *w, const bf_error *error, const bf_faults *faults)
{
    char text[BF_POINTER_SIZE + BF_TEXT_SIZE + 40];
    const char *gap = error->pointer[0] == '\0' ? "" : ": ";

    if (faults == NULL || faults->n < 2)
        snprintf(text, sizeof text, "%s%s%s", error->pointer, gap, error->text);
    else
        snprintf(text, sizeof text, "%s%s%s (and %zu more)", error->pointer, gap, error->text,
                 faults->n - 1);
    json_out_key_string(w, "detail", text);
}

void problem__write(api_response *response, int status, const char *instance, const bf_error *error,
                    const bf_faults *faults)
{
    size_t kind = find_kind(status);
    char text[API_PATH_MAX];

    api_response_fini(response);
    response->status = status;
    if (status == 429 || status == 503)
        api_response_header(response, "Retry-After", "%d", RETRY_AFTER_S);
    api_response_header(response, "Cache-Control", "no-store");
    json_out w = json_out_to(&response->body);
    json_out_object(&w);
    snprintf(text, sizeof text, "/problems/%s", kinds[kind].word);
    json_out_key_string(&w, "type", text);
    json_out_key_string(&w, "title", kinds[kind].title);
    json_out_key_integer(&w, "status", status);
    write_detail(&w, error, faults);
    encode_path(instance, text, sizeof text);
    json_out_key_string(&w, "instance", text);
    write_errors(&w, error, faults);
    json_out_object_end(&w);
    if (json_out_status(&w, NULL) == BF_OK)
        api_response_header(response, "Content-Type", "application/problem+json");
    else
        buffer_fini(&response->body); // the status alone has to say it
}

void api_problem(api_response *response, int status, const char *instance, const bf_error *error)
{
    problem__write(response, status, instance, error, NULL);
}

void api_problem_identify(api_response *response, const char *request_id)
{
    static const char type[] = "application/problem+json";
    const char *is = api_response_find(response, "Content-Type");
    bf_buffer *body = &response->body;
    size_t n = body->n;

    if (is == NULL || strcmp(is, type) != 0 || n == 0 || body->bytes[n - 1] != '}')
        return;
    buffer_truncate(body, n - 1);
    json_out w = json_out_to(body);
    w.needs_comma = true;
    json_out_key_string(&w, "request_id", request_id);
    json_out_object_end(&w);
    if (json_out_status(&w, NULL) == BF_OK)
        return;
    // Room for the bracket that stood there before needs no memory.
    buffer_truncate(body, n - 1);
    BF_CHECK(buffer_append(body, "}", 1) == BF_OK);
}
