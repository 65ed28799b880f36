// The paths of the document: each route with its parameters, its body and its answers. A route of several formats, of answers
// or of bodies, is an operation for each, so that an operation takes and answers one media type.

#include "api/openapi/openapi_priv.h"

#include "api/http/access.h"
#include "api/scenario/examples.h"
#include "core/base/check.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { NAME_SIZE = 96, SUMMARY_SIZE = 160 };

static const media media_rows[] = {
#define X(format, word, type, content_type) { format, word, type, content_type },
    MEDIA_LIST(X)
#undef X
};

enum { N_MEDIA = sizeof media_rows / sizeof *media_rows };

// A route in one of its formats.
typedef struct operation {
    const route *route;
    char format[ROUTES_FORMAT_SIZE]; // word of MEDIA_LIST
    bool is_first;                   // the route's default, which is at the path without an ending
} operation;

// Takes the next format off the list of a route's; false: there is none.
static bool next_operation(const route *r, const char **formats, operation *ret_operation)
{
    const size_t n = schema_next_word(formats);

    if (n == 0)
        return false;
    BF_CHECK(n < ROUTES_FORMAT_SIZE);
    *ret_operation = (operation){ .route = r, .is_first = *formats == routes_endings(r) };
    memcpy(ret_operation->format, *formats, n);
    *formats += n;
    return true;
}

static void write_parameter(json_out *w, const param *p)
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
    json_out_object_end(w);
}

// `format` is for clients from before formats had paths.
static bool has_parameter(const operation *o, const param *p)
{
    return p->kind != &param_format &&
           (p->formats == NULL || negotiation_has_format(p->formats, o->format));
}

// The parameters of an operation: those of its path, or the others. No member where there are none.
static void write_parameters(json_out *w, const operation *o, bool of_path)
{
    size_t count = 0;

    for (const param *const *at = o->route->params; *at != NULL; at++) {
        if ((strcmp((*at)->in, "path") == 0) != of_path || !has_parameter(o, *at))
            continue;
        if (count++ == 0) {
            json_out_key(w, "parameters");
            json_out_array(w);
        }
        write_parameter(w, *at);
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

// The media type of a format.
static const media *find_media(const char *format, size_t n)
{
    size_t k = 0;

    while (k < N_MEDIA &&
           (strlen(media_rows[k].word) != n || memcmp(media_rows[k].word, format, n) != 0))
        k++;
    BF_CHECK(k < N_MEDIA);
    return &media_rows[k];
}

// The schema of JSON; other formats have their own.
static void write_media(json_out *w, const char *id, const operation *o, const char *where,
                        const media *row, const char *schema)
{
    const char *other = openapi__format_schema(row->format);
    const char *name = other == NULL ? schema : other;

    BF_CHECK(name != NULL);
    json_out_key(w, row->type);
    json_out_object(w);
    json_out_key(w, "schema");
    json_out_object(w);
    schema_write_ref(w, "schemas", name, strlen(name));
    json_out_object_end(w);
    if (find_sample(name) != NULL)
        write_samples(w, find_sample(name));
    else
        openapi__write_sample(w, o->route->method, id, where, row->type);
    json_out_object_end(w);
}

// where: "request", or the status of the answer.
static void write_content(json_out *w, const char *id, const operation *o, const char *where,
                          const char *formats, const char *schema)
{
    json_out_key(w, "content");
    json_out_object(w);
    for (size_t n; (n = schema_next_word(&formats)) > 0; formats += n)
        write_media(w, id, o, where, find_media(formats, n), schema);
    json_out_object_end(w);
}

static void write_body(json_out *w, const char *id, const operation *o)
{
    const route *r = o->route;
    char schema[MEMBER_TEXT_SIZE];

    if (r->body == NULL)
        return;
    members_schema_name(r->body, MEMBER_GIVEN, schema);
    json_out_key(w, "requestBody");
    json_out_object(w);
    json_out_key_bool(w, "required", true);
    const char *formats = r->body_formats == NULL ? "json" : r->body_formats;
    write_content(w, id, o, "request", formats == routes_endings(r) ? o->format : formats, schema);
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

// What it answers in: an ending that says the format of the body leaves one for the answer.
static const char *answer_format(const operation *o)
{
    const route *r = o->route;

    return routes_endings(r) == r->formats ? o->format : r->formats;
}

static void write_answer(json_out *w, const char *id, const operation *o,
                         const route_answer *answer)
{
    bool has_body = answer->status != 204 && answer->status != 304;
    char status[16];

    snprintf(status, sizeof status, "%d", answer->status);
    json_out_key(w, status);
    json_out_object(w);
    json_out_key_string(w, "description", answer->help);
    openapi__write_headers(w, answer->headers);
    if (has_body)
        write_content(w, id, o, status, answer_format(o), answer->schema);
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

// What it does; of what has several formats, in which.
static void write_summary(json_out *w, const operation *o)
{
    char text[SUMMARY_SIZE];
    int n = snprintf(text, sizeof text, "%s", o->route->summary);

    if (!o->is_first)
        n += snprintf(text + n, sizeof text - (size_t)n, ", as ");
    for (const char *at = o->is_first ? "" : o->format; *at != '\0'; at++)
        text[n++] = (char)toupper((unsigned char)*at);
    text[n] = '\0';
    BF_CHECK((size_t)n < sizeof text);
    json_out_key_string(w, "summary", text);
}

// The first of several formats names the endings.
static void write_help(json_out *w, const operation *o)
{
    const char *formats = routes_endings(o->route);
    const bool is_one_of_several = o->is_first && strchr(formats, ' ') != NULL;
    bf_buffer text = { 0 };
    operation other;

    bf_status status =
        buffer_printf(&text, "%s%s", o->route->help,
                      is_one_of_several ? " An ending of the path says the format:" : "");
    while (status == BF_OK && is_one_of_several && next_operation(o->route, &formats, &other))
        status = buffer_printf(&text, other.is_first ? " `.%s`, as without one" : ", `.%s`",
                               other.format);
    if (status == BF_OK && is_one_of_several)
        status = buffer_printf(&text, ".");
    if (status == BF_OK)
        json_out_key_string(w, "description", text.bytes);
    w->has_failed |= status != BF_OK;
    buffer_fini(&text);
}

static void write_operation(json_out *w, const operation *o)
{
    const route *r = o->route;
    char method[8] = "", id[NAME_SIZE];

    BF_CHECK(strlen(r->method) < sizeof method);
    for (size_t k = 0; r->method[k] != '\0'; k++)
        method[k] = (char)tolower((unsigned char)r->method[k]);
    // "curve" as CSV is "curveCsv": the name of the route's first format is the route's.
    const int n_id = snprintf(id, NAME_SIZE, "%s%s", o->route->id, o->is_first ? "" : o->format);
    char *ending = id + strlen(o->route->id);
    BF_CHECK(n_id > 0 && n_id < NAME_SIZE);
    *ending = (char)toupper((unsigned char)*ending);
    json_out_key(w, method);
    json_out_object(w);
    json_out_key_string(w, "operationId", id);
    write_summary(w, o);
    write_help(w, o);
    json_out_key(w, "tags");
    json_out_array(w);
    json_out_string(w, r->tag);
    json_out_array_end(w);
    write_security(w, r);
    write_parameters(w, o, false);
    write_body(w, id, o);
    json_out_key(w, "responses");
    json_out_object(w);
    for (size_t k = 0; k < ROUTES_ANSWERS_MAX && r->answers[k].status != 0; k++) {
        const char *formats = r->answers[k].formats;
        if (formats == NULL || negotiation_has_format(formats, answer_format(o)))
            write_answer(w, id, o, &r->answers[k]);
    }
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

// The operations of a path in the first format of each.
static void write_path(json_out *w, const route *routes, size_t n, const operation *first)
{
    const char *path = first->route->path;

    json_out_key(w, path);
    json_out_object(w);
    write_parameters(w, first, true);
    for (const route *r = first->route; r < routes + n; r++) {
        const char *formats = routes_endings(r);
        operation o;
        if (strcmp(r->path, path) == 0 && next_operation(r, &formats, &o))
            write_operation(w, &o);
    }
    json_out_object_end(w);
}

void openapi__write_paths(json_out *w)
{
    size_t n;
    const route *routes = routes_list(&n);

    for (size_t k = 0; k < n; k++) {
        const char *formats = routes_endings(&routes[k]);
        operation o;
        if (next_operation(&routes[k], &formats, &o) && !is_written(routes, k))
            write_path(w, routes, n, &o);
        while (next_operation(&routes[k], &formats, &o)) {
            char path[NAME_SIZE];
            snprintf(path, sizeof path, "%s.%s", o.route->path, o.format);
            json_out_key(w, path);
            json_out_object(w);
            write_parameters(w, &o, true);
            write_operation(w, &o);
            json_out_object_end(w);
        }
    }
}
