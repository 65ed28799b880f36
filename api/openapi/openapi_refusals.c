// Problem documents as answers: one for each HTTP status that a route can refuse with.

#include "api/openapi/openapi_priv.h"

#include "api/http/exchange_priv.h"
#include "core/base/check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// When a status is given, and the headers that come with it.
static const struct {
    int status;
    const char *headers;
    const char *help;
} reasons[] = {
    { 400, "", "The request is not well formed, or has a parameter that is not known" },
    { 404, "", "There is no such thing" },
    { 405, "Allow", "The path does not know this method" },
    { 406, "", "There is no such format of this" },
    { 409, "", "It does not fit the present state" },
    { 412, "", "The run is not in the state that If-Match names; nothing was changed" },
    { 413, "", "The body is too large" },
    { 414, "", "Path or query are too long" },
    { 415, "", "The body is not JSON, or does not say so" },
    { 416, "Content-Range", "The range begins behind the end" },
    { 422, "", "The document is JSON but at fault; `errors` has the places" },
    { 429, "Retry-After", "The client has used up a quota" },
    { 500, "", "The service failed; its log says why" },
    { 501, "", "There is no such method or transfer coding" },
    { 503, "Retry-After", "Full or stopping at the moment" },
};

enum { N_REASONS = sizeof reasons / sizeof *reasons };

static bool has_status(const char *words, int status)
{
    for (size_t n; words != NULL && (n = schema_next_word(&words)) > 0; words += n) {
        if (atoi(words) == status)
            return true;
    }
    return false;
}

static bool is_used(int status)
{
    size_t n;
    const openapi_operation *operations = openapi__operations(&n);
    bool found = has_status(openapi__common_refusals, status);

    for (size_t k = 0; k < n && !found; k++)
        found = has_status(operations[k].refusals, status);
    return found;
}

static size_t find_reason(int status)
{
    size_t k = 0;

    while (k < N_REASONS && reasons[k].status != status)
        k++;
    BF_CHECK(k < N_REASONS);
    return k;
}

// "Not Found" is NotFound.
static void write_name(const problem__kind *kind, char *ret_name)
{
    for (const char *at = kind->title; *at != '\0'; at++) {
        if (*at != ' ')
            *ret_name++ = *at;
    }
    *ret_name = '\0';
}

static void write_example(json_out *w, const problem__kind *kind, const char *help)
{
    char type[64];

    snprintf(type, sizeof type, "/problems/%s", kind->word);
    json_out_key(w, "example");
    json_out_object(w);
    json_out_key_string(w, "type", type);
    json_out_key_string(w, "title", kind->title);
    json_out_key_integer(w, "status", kind->status);
    json_out_key_string(w, "detail", help);
    json_out_key_string(w, "instance", "/v1/runs");
    json_out_object_end(w);
}

static void write_refusal(json_out *w, const problem__kind *kind)
{
    size_t reason = find_reason(kind->status);
    char name[64];

    write_name(kind, name);
    json_out_key(w, name);
    json_out_object(w);
    json_out_key_string(w, "description", reasons[reason].help);
    openapi__write_headers(w, reasons[reason].headers);
    json_out_key(w, "content");
    json_out_object(w);
    json_out_key(w, "application/problem+json");
    json_out_object(w);
    json_out_key(w, "schema");
    schema_write(w, "#Problem", NULL, NULL);
    write_example(w, kind, reasons[reason].help);
    json_out_object_end(w);
    json_out_object_end(w);
    json_out_object_end(w);
}

void openapi__write_refusals(json_out *w)
{
    size_t n;
    const problem__kind *kinds = problem__kinds(&n);

    for (size_t k = 0; k < n; k++) {
        if (is_used(kinds[k].status))
            write_refusal(w, &kinds[k]);
    }
}

void openapi__write_refusals_of(json_out *w, const openapi_operation *operation)
{
    size_t n;
    const problem__kind *kinds = problem__kinds(&n);

    for (size_t k = 0; k < n; k++) {
        char name[64], status[16];
        if (!has_status(openapi__common_refusals, kinds[k].status) &&
            !has_status(operation->refusals, kinds[k].status))
            continue;
        write_name(&kinds[k], name);
        snprintf(status, sizeof status, "%d", kinds[k].status);
        json_out_key(w, status);
        json_out_object(w);
        schema_write_ref(w, "responses", name, strlen(name));
        json_out_object_end(w);
    }
}

void openapi__write_problem_types(json_out *w)
{
    size_t n;
    const problem__kind *kinds = problem__kinds(&n);
    char type[64];

    json_out_key_string(w, "type", "string");
    json_out_key(w, "enum");
    json_out_array(w);
    for (size_t k = 0; k < n; k++) {
        snprintf(type, sizeof type, "/problems/%s", kinds[k].word);
        json_out_string(w, type);
    }
    json_out_array_end(w);
}
