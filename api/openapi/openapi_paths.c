// The paths of the document: each route with its parameters, its body and its answers.

#include "api/openapi/openapi_priv.h"

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

static void write_parameter_schema(json_out *w, const openapi_parameter *p, const char *formats)
{
    if (p->type == NULL) {
        write_formats(w, formats);
        return;
    }
    json_out_object(w);
    schema_write_members(w, p->type);
    schema_write_limits(w, p->limits);
    if (p->standard != NULL) {
        json_out_key(w, "default");
        json_out_raw(w, p->standard, strlen(p->standard));
    }
    json_out_object_end(w);
}

static void write_parameter(json_out *w, const openapi_parameter *p, const char *formats)
{
    json_out_object(w);
    json_out_key_string(w, "name", p->name);
    json_out_key_string(w, "in", p->in);
    json_out_key_string(w, "description", p->help);
    if (p->is_required)
        json_out_key_bool(w, "required", true);
    if (p->type != NULL && p->type[0] == '[') {
        json_out_key_string(w, "style", "form");
        json_out_key_bool(w, "explode", false);
    }
    json_out_key(w, "schema");
    write_parameter_schema(w, p, formats);
    json_out_object_end(w);
}

// Parameters of one kind; words are their names. Returns how many.
static size_t write_parameters(json_out *w, const route *r, const char *in, const char *words)
{
    size_t count = 0;

    for (size_t n; words != NULL && (n = schema_next_word(&words)) > 0; words += n, count++) {
        const openapi_parameter *p = openapi__parameter(in, r->path, words, n);
        BF_CHECK(p != NULL);
        write_parameter(w, p, r->formats);
    }
    return count;
}

static void write_path_parameters(json_out *w, const route *r)
{
    const char *at = strchr(r->path, '{');

    if (at == NULL)
        return;
    json_out_key(w, "parameters");
    json_out_array(w);
    for (; at != NULL; at = strchr(at, '{')) {
        size_t n = strcspn(++at, "}");
        const openapi_parameter *p = openapi__parameter("path", r->path, at, n);
        BF_CHECK(p != NULL);
        write_parameter(w, p, NULL);
    }
    json_out_array_end(w);
}

static void write_request_parameters(json_out *w, const route *r, const openapi_operation *o)
{
    if (r->query[0] == '\0' && o->headers == NULL)
        return;
    json_out_key(w, "parameters");
    json_out_array(w);
    write_parameters(w, r, "query", r->query);
    write_parameters(w, r, "header", o->headers);
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
static void write_media(json_out *w, const media *row, const char *schema)
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
    json_out_object_end(w);
}

static void write_content(json_out *w, const char *formats, const char *schema)
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
            write_media(w, row, other == NULL ? schema : other);
        }
    }
    json_out_object_end(w);
}

static void write_body(json_out *w, const openapi_operation *o)
{
    if (o->body == NULL)
        return;
    json_out_key(w, "requestBody");
    json_out_object(w);
    json_out_key_bool(w, "required", true);
    write_content(w, o->body_formats == NULL ? "json" : o->body_formats, o->body);
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

static void write_header_refs(json_out *w, const char *words)
{
    for (size_t n; words != NULL && (n = schema_next_word(&words)) > 0; words += n) {
        const openapi_header *header = openapi__header(words, n);
        BF_CHECK(header != NULL);
        json_out_key(w, header->name);
        json_out_object(w);
        schema_write_ref(w, "headers", header->name, n);
        json_out_object_end(w);
    }
}

void openapi__write_headers(json_out *w, const char *words)
{
    json_out_key(w, "headers");
    json_out_object(w);
    write_header_refs(w, words);
    write_header_refs(w, openapi__common_headers);
    json_out_object_end(w);
}

static void write_answer(json_out *w, const route *r, const openapi_answer *answer)
{
    bool has_body = answer->status != 204 && answer->status != 304;
    char status[16];

    snprintf(status, sizeof status, "%d", answer->status);
    json_out_key(w, status);
    json_out_object(w);
    json_out_key_string(w, "description", answer->help);
    openapi__write_headers(w, answer->headers);
    if (has_body)
        write_content(w, answer->formats == NULL ? r->formats : answer->formats, answer->schema);
    json_out_object_end(w);
}

static void write_operation(json_out *w, const route *r)
{
    const openapi_operation *o = openapi__operation(r->method, r->path);
    char method[8] = "";

    BF_CHECK(o != NULL && strlen(r->method) < sizeof method);
    for (size_t k = 0; r->method[k] != '\0'; k++)
        method[k] = (char)tolower((unsigned char)r->method[k]);
    json_out_key(w, method);
    json_out_object(w);
    json_out_key_string(w, "operationId", o->id);
    json_out_key_string(w, "summary", r->summary);
    json_out_key_string(w, "description", o->help);
    json_out_key(w, "tags");
    json_out_array(w);
    json_out_string(w, o->tag);
    json_out_array_end(w);
    write_request_parameters(w, r, o);
    write_body(w, o);
    json_out_key(w, "responses");
    json_out_object(w);
    for (size_t k = 0; k < OPENAPI_ANSWERS_MAX && o->answers[k].status != 0; k++)
        write_answer(w, r, &o->answers[k]);
    openapi__write_refusals_of(w, o);
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
        write_path_parameters(w, &routes[k]);
        for (size_t i = k; i < n; i++) {
            if (strcmp(routes[i].path, routes[k].path) == 0)
                write_operation(w, &routes[i]);
        }
        json_out_object_end(w);
    }
}
