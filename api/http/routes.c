#include "api/http/routes.h"

#include "api/http/handlers.h"
#include "core/base/check.h"

#include <stdio.h>
#include <string.h>

static const route table[] = {
    { "POST", "/v1/runs", handlers_runs_submit, API_COST_WORK, API_COST_NONE, "", "json",
      "Accept a run; it is on disk before the answer leaves" },
    { "GET", "/v1/runs", handlers_runs_list, API_COST_STORE, API_COST_NONE,
      "status model label limit cursor", "json", "List runs, newest first" },
    { "GET", "/v1/runs/{id}", handlers_runs_show, API_COST_STORE, API_COST_NONE, "wait", "json",
      "Show a run: state, progress, times, links" },
    { "DELETE", "/v1/runs/{id}", handlers_runs_remove, API_COST_STORE, API_COST_NONE, "", "json",
      "Stop a run if need be and remove it with its results" },
    { "POST", "/v1/runs/{id}/cancel", handlers_runs_cancel, API_COST_STORE, API_COST_NONE, "",
      "json", "Stop a run and keep what it has" },
    { "GET", "/v1/runs/{id}/scenario", handlers_results_scenario, API_COST_STORE, API_COST_NONE, "",
      "json", "The resolved scenario, every default filled in" },
    { "GET", "/v1/runs/{id}/summary", handlers_results_summary, API_COST_STORE, API_COST_NONE, "",
      "json", "The figures of a run that has ended" },
    { "GET", "/v1/runs/{id}/curve", handlers_results_curve, API_COST_STORE, API_COST_NONE, "format",
      "json csv", "The outflow curve so far" },
    { "GET", "/v1/runs/{id}/snapshots", handlers_snapshots_list, API_COST_STORE, API_COST_NONE, "",
      "json", "List the density snapshots so far" },
    { "GET", "/v1/runs/{id}/snapshots/{n}", handlers_snapshots_show, API_COST_STORE, API_COST_WORK,
      "format width colormap max", "npy json csv png vti", "One density snapshot" },
    { "GET", "/v1/runs/{id}/snapshots.pvd", handlers_snapshots_list, API_COST_STORE, API_COST_NONE,
      "", "pvd", "The snapshots of results.zip?vtk=1 in time, for ParaView" },
    { "GET", "/v1/runs/{id}/parts/{n}", handlers_parts_show, API_COST_STORE, API_COST_WORK,
      "format", "npy json csv vtp", "The parts at the time of a snapshot (micro)" },
    { "GET", "/v1/runs/{id}/parts.pvd", handlers_parts_series, API_COST_STORE, API_COST_NONE, "",
      "pvd", "The parts of results.zip?vtk=1 in time, for ParaView (micro)" },
    { "GET", "/v1/runs/{id}/results.zip", handlers_archive_show, API_COST_WORK, API_COST_NONE,
      "vtk", "zip", "All results of a run that has ended" },
    { "GET", "/v1/runs/{id}/events", handlers_events_of_run, API_COST_STORE, API_COST_NONE,
      "format inline last_event_id", "sse ndjson",
      "Follow a run: its events from the first one on, until it has ended" },
    { "GET", "/v1/events", handlers_events_of_runs, API_COST_STORE, API_COST_NONE,
      "runs format inline last_event_id", "sse ndjson", "Follow several runs in one stream" },
    { "POST", "/v1/measurements", handlers_measurements_add, API_COST_WORK, API_COST_NONE,
      "label counter", "json",
      "Store a measured curve, JSON or CSV; it is on disk before the answer leaves" },
    { "GET", "/v1/measurements", handlers_measurements_list, API_COST_STORE, API_COST_NONE,
      "label limit cursor", "json", "List measured curves, newest first" },
    { "GET", "/v1/measurements/{id}", handlers_measurements_show, API_COST_STORE, API_COST_NONE,
      "format", "json csv", "A measured curve with its samples" },
    { "DELETE", "/v1/measurements/{id}", handlers_measurements_remove, API_COST_STORE,
      API_COST_NONE, "", "json", "Remove a measured curve" },
    { "GET", "/v1/compare", handlers_compare_runs, API_COST_WORK, API_COST_NONE,
      "a b runs reference column", "json",
      "Measures between the curves and densities of two to eight runs and measurements" },
    { "POST", "/v1/validate", handlers_runs_validate, API_COST_WORK, API_COST_NONE, "", "json",
      "Say what POST /v1/runs would say, and store nothing" },
    { "GET", "/v1/examples", handlers_meta_examples, API_COST_NONE, API_COST_NONE, "", "json",
      "List the ready scenarios" },
    { "GET", "/v1/examples/{name}", handlers_meta_example, API_COST_NONE, API_COST_NONE, "", "json",
      "One ready scenario" },
    { "GET", "/livez", handlers_meta_livez, API_COST_HEALTH, API_COST_NONE, "", "json",
      "Is the daemon alive?" },
    { "GET", "/readyz", handlers_meta_readyz, API_COST_HEALTH, API_COST_NONE, "", "json",
      "Can the daemon accept runs?" },
    { "GET", "/metrics", handlers_meta_metrics, API_COST_HEALTH, API_COST_NONE, "", "prometheus",
      "The service's figures for Prometheus" },
    { "GET", "/version", handlers_meta_version, API_COST_NONE, API_COST_NONE, "", "json",
      "Which build this is" },
    { "GET", "/openapi.json", handlers_meta_openapi, API_COST_STORE, API_COST_NONE, "", "json",
      "This API as an OpenAPI 3.1 document" },
};

enum { N_ROUTES = sizeof table / sizeof *table };

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

const route *routes_list(size_t *ret_n)
{
    *ret_n = N_ROUTES;
    return table;
}

const route *routes_find(const char *method, const char *path, route_params *ret_params)
{
    if (strcmp(method, "HEAD") == 0)
        method = "GET";
    for (size_t i = 0; i < N_ROUTES; i++) {
        if (strcmp(table[i].method, method) == 0 && match_path(table[i].path, path, ret_params))
            return &table[i];
    }
    return NULL;
}

bool routes_allow(const char *path, char *ret_allow)
{
    size_t n = 0;

    for (size_t i = 0; i < N_ROUTES; i++) {
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
