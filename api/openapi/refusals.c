// Problem documents as answers: one for each HTTP status that a route can refuse with.

#include "api/openapi/openapi_priv.h"

#include "api/http/problem.h"
#include "api/http/routes_params.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool has_status(const char *words, int status)
{
    for (size_t n; words != NULL && (n = schema_next_word(&words)) > 0; words += n) {
        if (atoi(words) == status)
            return true;
    }
    return false;
}

static bool has_param(const route *r, const param *wanted)
{
    for (const param *const *at = r->params; *at != NULL; at++) {
        if (*at == wanted)
            return true;
    }
    return false;
}

// What a route refuses by its path, parameters, body and scope, and what only it can know.
static bool can_refuse(const route *r, int status)
{
    if (status == 401 || status == 403)
        return r->scope != API_SCOPE_NONE;
    if ((status == 404 && strchr(r->path, '{') != NULL) ||
        (status == 412 && has_param(r, &routes__if_match)) ||
        (status == 416 && has_param(r, &routes__range)) ||
        (r->body != NULL && has_status("413 415 422", status)) ||
        (status == 507 && r->scope == API_SCOPE_SUBMIT))
        return true;
    return has_status(ROUTES_COMMON_REFUSALS, status) || has_status(r->refusals, status);
}

// "Not Found" is NotFound.
static void write_name(const problem_kind *kind, char *ret_name)
{
    for (const char *at = kind->title; *at != '\0'; at++) {
        if (*at != ' ')
            *ret_name++ = *at;
    }
    *ret_name = '\0';
}

static void write_refusal(json_out *w, const problem_kind *kind)
{
    char name[64];

    write_name(kind, name);
    json_out_key(w, name);
    json_out_object(w);
    json_out_key_string(w, "description", kind->when);
    openapi__write_headers(w, kind->headers);
    json_out_key(w, "content");
    json_out_object(w);
    json_out_key(w, "application/problem+json");
    json_out_object(w);
    json_out_key(w, "schema");
    schema_write(w, "#Problem", NULL, NULL);
    char type[64];
    snprintf(type, sizeof type, "/problems/%s", kind->word);
    json_out_key(w, "example");
    json_out_object(w);
    json_out_key_string(w, "type", type);
    json_out_key_string(w, "title", kind->title);
    json_out_key_integer(w, "status", kind->status);
    json_out_key_string(w, "detail", kind->when);
    json_out_key_string(w, "instance", "/v1/runs");
    json_out_object_end(w);
    json_out_object_end(w);
    json_out_object_end(w);
    json_out_object_end(w);
}

void openapi__write_refusals(json_out *w)
{
    size_t n;
    const problem_kind *kinds = problem_kinds(&n);

    for (size_t k = 0; k < n; k++)
        write_refusal(w, &kinds[k]);
}

void openapi__write_refusals_of(json_out *w, const route *r)
{
    size_t n;
    const problem_kind *kinds = problem_kinds(&n);

    for (size_t k = 0; k < n; k++) {
        char name[64], status[16];
        if (!can_refuse(r, kinds[k].status))
            continue;
        write_name(&kinds[k], name);
        snprintf(status, sizeof status, "%d", kinds[k].status);
        json_out_key(w, status);
        json_out_object(w);
        schema_write_ref(w, "responses", name, strlen(name));
        json_out_object_end(w);
    }
}

void openapi__write_problem_types(json_out *w, size_t tag)
{
    size_t n;
    const problem_kind *kinds = problem_kinds(&n);
    char type[64];

    (void)tag;
    json_out_key_string(w, "type", "string");
    json_out_key(w, "enum");
    json_out_array(w);
    for (size_t k = 0; k < n; k++) {
        snprintf(type, sizeof type, "/problems/%s", kinds[k].word);
        json_out_string(w, type);
    }
    json_out_array_end(w);
}
