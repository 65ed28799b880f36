#include "api/http/routes.h"

#include "api/http/negotiation.h"
#include "core/base/check.h"

#include <stdio.h>
#include <string.h>

// Matches one segment of a template that starts at *template with one of the path, which ends at `end`, and moves both
// to the segment's end. False: they differ.
static bool match_segment(const char **template, const char **path, const char *end,
                          route_params *params)
{
    const char *slash = memchr(*path, '/', (size_t)(end - *path));
    size_t n_template = strcspn(*template, "/");
    size_t n_path = (size_t)((slash == NULL ? end : slash) - *path);

    if (**template != '{') {
        if (n_template != n_path || memcmp(*template, *path, n_path) != 0)
            return false;
    } else {
        if (n_path == 0 || n_path >= ROUTES_PARAM_SIZE || memchr(*path, '.', n_path) != NULL)
            return false;
        BF_CHECK(params->n < ROUTES_PARAMS_MAX);
        memcpy(params->values[params->n], *path, n_path);
        params->values[params->n++][n_path] = '\0';
    }
    *template += n_template;
    *path += n_path;
    return true;
}

static bool match_path(const char *template, const char *path, size_t n, route_params *params)
{
    const char *end = path + n;

    while (*template == '/' && path < end && *path == '/') {
        template ++;
        path++;
        if (!match_segment(&template, &path, end, params))
            return false;
    }
    return *template == '\0' && path == end;
}

static bool has_body_formats(const route *r)
{
    return r->body_formats != NULL && strchr(r->body_formats, ' ') != NULL;
}

const char *routes_endings(const route *r)
{
    return has_body_formats(r) ? r->body_formats : r->formats;
}

// A path that ends in a dot and the word of one of the route's formats, where there are several, is that of this format.
static size_t cut_format(const route *r, const char *path, route_params *params)
{
    const char *dot = strrchr(path, '.'), *formats = routes_endings(r);
    const size_t n = strlen(path);

    if (dot == NULL || strchr(formats, ' ') == NULL || strlen(dot + 1) >= sizeof params->format ||
        !negotiation_has_format(formats, dot + 1))
        return n;
    memcpy(params->format, dot + 1, strlen(dot + 1) + 1);
    return (size_t)(dot - path);
}

static bool match_route(const route *r, const char *path, route_params *ret_params)
{
    route_params params = { 0 };

    if (!match_path(r->path, path, cut_format(r, path, &params), &params))
        return false;
    if (ret_params != NULL)
        *ret_params = params;
    return true;
}

const route *routes_find(const char *method, const char *path, route_params *ret_params)
{
    size_t n_routes;
    const route *table = routes_list(&n_routes);

    if (strcmp(method, "HEAD") == 0)
        method = "GET";
    for (size_t i = 0; i < n_routes; i++) {
        if (strcmp(table[i].method, method) == 0 && match_route(&table[i], path, ret_params))
            return &table[i];
    }
    return NULL;
}

const char *routes_formats(const route *found, const route_params *params)
{
    return params->format[0] == '\0' || has_body_formats(found) ? found->formats : params->format;
}

bool routes_allow(const char *path, char *ret_allow)
{
    size_t n_routes, n = 0;
    const route *table = routes_list(&n_routes);

    for (size_t i = 0; i < n_routes; i++) {
        if (!match_route(&table[i], path, NULL))
            continue;
        bool is_get = strcmp(table[i].method, "GET") == 0;
        n += (size_t)snprintf(ret_allow + n, ROUTES_ALLOW_SIZE - n, "%s, ",
                              is_get ? "GET, HEAD" : table[i].method);
        BF_CHECK(n < ROUTES_ALLOW_SIZE);
    }
    if (n == 0)
        return false;
    n += (size_t)snprintf(ret_allow + n, ROUTES_ALLOW_SIZE - n, "OPTIONS");
    BF_CHECK(n < ROUTES_ALLOW_SIZE);
    return true;
}
