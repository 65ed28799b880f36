#include "api/http/routes.h"

#include "core/base/check.h"

#include <stdio.h>
#include <string.h>

// Matches one segment of a template that starts at *template with one of the path, and moves both
// to the segment's end. False: they differ.
static bool match_segment(const char **template, const char **path, route_params *params)
{
    size_t n_template = strcspn(*template, "/");
    size_t n_path = strcspn(*path, "/");

    if (**template != '{') {
        if (n_template != n_path || memcmp(*template, *path, n_path) != 0)
            return false;
    } else {
        if (n_path == 0 || n_path >= ROUTES_PARAM_SIZE)
            return false;
        BF_CHECK(params->n < ROUTES_PARAMS_MAX);
        memcpy(params->values[params->n], *path, n_path);
        params->values[params->n++][n_path] = '\0';
    }
    *template += n_template;
    *path += n_path;
    return true;
}

static bool match_path(const char *template, const char *path, route_params *ret_params)
{
    route_params params = { 0 };

    while (*template == '/' && *path == '/') {
        template ++;
        path++;
        if (!match_segment(&template, &path, &params))
            return false;
    }
    if (*template != '\0' || *path != '\0')
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
        if (strcmp(table[i].method, method) == 0 && match_path(table[i].path, path, ret_params))
            return &table[i];
    }
    return NULL;
}

bool routes_allow(const char *path, char *ret_allow)
{
    size_t n_routes, n = 0;
    const route *table = routes_list(&n_routes);

    for (size_t i = 0; i < n_routes; i++) {
        if (!match_path(table[i].path, path, NULL))
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
