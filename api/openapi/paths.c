// The paths of the document: each route with its parameters, its body and its answers.

#include "api/openapi/openapi_priv.h"

#include "api/http/access.h"
#include "api/scenario/examples.h"
#include "core/base/check.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { NAME_SIZE = 96 };

static const media media_rows[] = {
#define X(format, word, type, content_type) { format, word, type, content_type },
    MEDIA_LIST(X)
#undef X
};

enum { N_MEDIA = sizeof media_rows / sizeof *media_rows };

// The formats of a route.
static void write_formats(json_out *w, const char *formats)
{
    json_out_object(w);
    json_out_key_string(w, "type", "string");
    json_out_key(w, "enum");
    schema_write_words(w, formats);
    json_out_object_end(w);
}

static void write_parameter_schema(json_out *w, const param *p, const char *formats)
{
    if (p->kind == &param_format) {
        write_formats(w, formats);
        return;
    }
    json_out_object(w);
    schema_write_members(w, p->type == NULL ? p->kind->type : p->type);
    if (p->kind->write_bounds != NULL)
        p->kind->write_bounds(p, w);
    schema_write_limits(w, p->limits);
    if (p->default_text != NULL) {
        json_out_key(w, "default");
        json_out_raw(w, p->default_text, strlen(p->default_text));
    }
    json_out_object_end(w);
}

static void write_parameter(json_out *w, const param *p, const char *formats)
{
    json_out_object(w);
    json_out_key_string(w, "name", p->name);
    json_out_key_string(w, "in", p->in);
    json_out_key_string(w, "description", p->help);
    if (p->is_required)
        json_out_key_bool(w, "required", true);
    if (p->kind == &param_ids) {
        json_out_key_string(w, "style", "form");
        json_out_key_bool(w, "explode", false);
    }
    json_out_key(w, "schema");
    write_parameter_schema(w, p, formats);
    json_out_object_end(w);
}

// The parameters of a route: those of its path, or the others. No member where there are none.
static void write_parameters(json_out *w, const route *r, bool of_path)
{
    size_t count = 0;

    for (size_t k = 0; r->params[k] != NULL; k++) {
        const param *p = r->params[k];
        if ((strcmp(p->in, "path") == 0) != of_path)
            continue;
        if (count++ == 0) {
            json_out_key(w, "parameters");
            json_out_array(w);
        }
        write_parameter(w, p, r->formats);
    }
    if (count > 0)
        json_out_array_end(w);
}

// References to the ready examples of a kind: "run" as bodies, "scenario" as scenarios.
static void write_samples(json_out *w, const char *kind)
{
    size_t n;
    const example *items = examples_list(&n);

    json_out_key(w, "examples");
    json_out_object(w);
    for (size_t k = 0; k < n; k++) {
        char name[NAME_SIZE];
        snprintf(name, sizeof name, "%s-%s", items[k].name, kind);
        json_out_key(w, items[k].name);
        json_out_object(w);
        schema_write_ref(w, "examples", name, strlen(name));
        json_out_object_end(w);
    }
    json_out_object_end(w);
}

// The kind of ready example that values of a schema have; NULL: there are none.
static const char *find_sample(const char *schema)
{
    if (strcmp(schema, "Scenario") == 0)
        return "scenario";
    return strcmp(schema, "Submission") == 0 ? "run" : NULL;
}

// One row of the formats; more rows can stand for one format.
static void write_media(json_out *w, const route *r, const char *where, const media *row,
                        const char *schema)
{
    const char *sample = find_sample(schema);

    json_out_key(w, row->type);
    json_out_object(w);
    json_out_key(w, "schema");
    json_out_object(w);
    schema_write_ref(w, "schemas", schema, strlen(schema));
    json_out_object_end(w);
    if (sample != NULL)
        write_samples(w, sample);
    else
        openapi__write_sample(w, r, where, row->type);
    json_out_object_end(w);
}

// where: "request", or the status of the answer.
static void write_content(json_out *w, const route *r, const char *where, const char *formats,
                          const char *schema)
{
    json_out_key(w, "content");
    json_out_object(w);
    for (size_t n; (n = schema_next_word(&formats)) > 0; formats += n) {
        for (size_t k = 0; k < N_MEDIA; k++) {
            const media *row = &media_rows[k];
            if (strlen(row->word) != n || memcmp(row->word, formats, n) != 0)
                continue;
            const char *other = openapi__format_schema(row->format);
            BF_CHECK(other != NULL || schema != NULL);
            write_media(w, r, where, row, other == NULL ? schema : other);
        }
    }
    json_out_object_end(w);
}

static void write_body(json_out *w, const route *r)
{
    if (r->body == NULL)
        return;
    json_out_key(w, "requestBody");
    json_out_object(w);
    json_out_key_bool(w, "required", true);
    write_content(w, r, "request", r->body_formats == NULL ? "json" : r->body_formats, r->body);
    json_out_object_end(w);
}

void openapi__write_header_components(json_out *w)
{
    size_t n;
    const openapi_header *headers = openapi__headers(&n);

    for (size_t k = 0; k < n; k++) {
        json_out_key(w, headers[k].name);
        json_out_object(w);
        json_out_key_string(w, "description", headers[k].help);
        if (!headers[k].may_lack)
            json_out_key_bool(w, "required", true);
        json_out_key(w, "schema");
        schema_write(w, headers[k].type, NULL, NULL);
        json_out_object_end(w);
    }
}

static void write_answer(json_out *w, const route *r, const route_answer *answer)
{
    bool has_body = answer->status != 204 && answer->status != 304;
    char status[16];

    snprintf(status, sizeof status, "%d", answer->status);
    json_out_key(w, status);
    json_out_object(w);
    json_out_key_string(w, "description", answer->help);
    openapi__write_headers(w, answer->headers);
    if (has_body)
        write_content(w, r, status, answer->formats == NULL ? r->formats : answer->formats,
                      answer->schema);
    json_out_object_end(w);
}

static void write_requirement(json_out *w, const char *scheme)
{
    json_out_object(w);
    json_out_key(w, scheme);
    json_out_array(w);
    json_out_array_end(w);
    json_out_object_end(w);
}

// Without tokens in the service nobody needs one: {} allows that.
static void write_security(json_out *w, const route *r)
{
    if (r->scope == API_SCOPE_NONE)
        return;
    json_out_key(w, "security");
    json_out_array(w);
    write_requirement(w, api_access_word(r->scope));
    if (access_takes_ticket(r))
        write_requirement(w, "ticket");
    json_out_object(w);
    json_out_object_end(w);
    json_out_array_end(w);
}

static void write_operation(json_out *w, const route *r)
{
    char method[8] = "";

    BF_CHECK(strlen(r->method) < sizeof method);
    for (size_t k = 0; r->method[k] != '\0'; k++)
        method[k] = (char)tolower((unsigned char)r->method[k]);
    json_out_key(w, method);
    json_out_object(w);
    json_out_key_string(w, "operationId", r->id);
    json_out_key_string(w, "summary", r->summary);
    json_out_key_string(w, "description", r->help);
    json_out_key(w, "tags");
    json_out_array(w);
    json_out_string(w, r->tag);
    json_out_array_end(w);
    write_security(w, r);
    write_parameters(w, r, false);
    write_body(w, r);
    json_out_key(w, "responses");
    json_out_object(w);
    for (size_t k = 0; k < ROUTES_ANSWERS_MAX && r->answers[k].status != 0; k++)
        write_answer(w, r, &r->answers[k]);
    openapi__write_refusals_of(w, r);
    json_out_object_end(w);
    json_out_object_end(w);
}

// True if an earlier route has the same path, with which this one was written.
static bool is_written(const route *routes, size_t k)
{
    for (size_t i = 0; i < k; i++) {
        if (strcmp(routes[i].path, routes[k].path) == 0)
            return true;
    }
    return false;
}

void openapi__write_paths(json_out *w)
{
    size_t n;
    const route *routes = routes_list(&n);

    for (size_t k = 0; k < n; k++) {
        if (is_written(routes, k))
            continue;
        json_out_key(w, routes[k].path);
        json_out_object(w);
        write_parameters(w, &routes[k], true);
        for (size_t i = k; i < n; i++) {
            if (strcmp(routes[i].path, routes[k].path) == 0)
                write_operation(w, &routes[i]);
        }
        json_out_object_end(w);
    }
}
