// The parameters of queries, paths and request headers. Where a word means different things, a row
// with a path stands for that route and the row without one for all others.

#include "api/openapi/openapi_priv.h"

#include <string.h>

static const openapi_parameter table[] = {
    { "id", "path", NULL, "#Id", NULL, NULL, true, "Which run" },
    { "n", "path", NULL, "#Count", NULL, NULL, true, "Which snapshot, from 0" },
    { "name", "path", NULL, "string", "\"pattern\":\"^[a-z0-9-]+$\"", NULL, true,
      "Which ready scenario" },

    { "id", "path", "/v1/measurements/{id}", "#Id", NULL, NULL, true, "Which measurement" },
    { "a", "query", NULL, "#Id", NULL, NULL, false,
      "The first of two runs or measurements, and the reference; with b, without `runs`" },
    { "b", "query", NULL, "#Id", NULL, NULL, false, "The second of them" },
    { "colormap", "query", NULL, "#Colormap", NULL, NULL, false, "Of png: its colours" },
    { "column", "query", NULL, "#CounterId", NULL, NULL, false,
      "Which column of the curves is compared; the first one of the reference that all have if "
      "missing" },
    { "counter", "query", NULL, "#CounterId", NULL, NULL, false,
      "Of CSV: which column of a curve was measured; the name of its own if missing" },
    { "cursor", "query", NULL, "#Id", NULL, NULL, false,
      "Where the page begins; take it from the `next` link" },
    { "format", "query", NULL, NULL, NULL, NULL, false,
      "The format, in preference to what the Accept header asks for" },
    { "inline", "query", NULL, "integer", "\"enum\":[0,1]", "0", false,
      "1: snapshot events have the grid with them, as `data`" },
    { "label", "query", NULL, "string", "\"maxLength\":100", NULL, false,
      "Only runs with this label" },
    { "label", "query", "/v1/measurements", "string", "\"maxLength\":100", NULL, false,
      "GET: only measurements with this label. POST of CSV: the label that it gets" },
    { "last_event_id", "query", NULL, "#Count", NULL, "0", false,
      "Only events after the one with this id; the header Last-Event-ID counts more" },
    { "limit", "query", NULL, "integer", "\"minimum\":1,\"maximum\":200", "50", false,
      "How many a page" },
    { "max", "query", NULL, "number", "\"minimum\":1e-3,\"maximum\":1e3", "1.5", false,
      "Of png: the density at the end of the scale; 1 is close packing" },
    { "model", "query", NULL, "#Model", NULL, NULL, false, "Only runs of this model" },
    { "reference", "query", NULL, "#Id", NULL, NULL, false,
      "Which of `runs` the others are compared with; the first one if missing" },
    { "runs", "query", "/v1/compare", "[#Id 2-8]", "\"uniqueItems\":true", NULL, false,
      "Which runs and measurements, with commas between; without a and b" },
    { "runs", "query", NULL, "[#Id 1-32]", "\"uniqueItems\":true", NULL, true,
      "Which runs, with commas between" },
    { "status", "query", NULL, "#RunStatus", NULL, NULL, false, "Only runs in this state" },
    { "vtk", "query", NULL, "integer", "\"enum\":[0,1]", "0", false,
      "1: with files for ParaView beside the others" },
    { "wait", "query", NULL, "integer", "\"minimum\":0,\"maximum\":60", "0", false,
      "Answer when the run has ended, or with If-None-Match when it is another, at the latest "
      "after "
      "so many seconds [s]" },
    { "width", "query", NULL, "integer", "\"minimum\":1,\"maximum\":8192", NULL, false,
      "Of png: its width in pixels; some 1000 if missing" },

    { "Idempotency-Key", "header", NULL, "string", "\"minLength\":1", NULL, false,
      "Any text of the client's own: the same key and body get the first answer again" },
    { "If-Match", "header", NULL, "string", NULL, NULL, false,
      "The ETag that the run must still have" },
    { "If-None-Match", "header", NULL, "string", NULL, NULL, false,
      "The ETag of an answer before; 304 if nothing has changed since" },
    { "Last-Event-ID", "header", NULL, "#Count", NULL, NULL, false,
      "Only events after the one with this id; browsers send it by themselves" },
    { "If-Range", "header", NULL, "string", NULL, NULL, false,
      "The ETag that the bytes asked for must still belong to" },
    { "Prefer", "header", NULL, "string", "\"examples\":[\"wait=30\"]", NULL, false,
      "`wait=N`: answer when the run has ended, at the latest after N seconds, 60 at most [s]" },
    { "Range", "header", NULL, "string", "\"examples\":[\"bytes=0-1023\"]", NULL, false,
      "Which bytes of a binary body" },
};

const openapi_parameter *openapi__parameters(size_t *ret_n)
{
    *ret_n = sizeof table / sizeof *table;
    return table;
}

const openapi_parameter *openapi__parameter(const char *in, const char *path, const char *name,
                                            size_t n)
{
    const openapi_parameter *found = NULL;

    for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
        const openapi_parameter *row = &table[k];
        bool is_named =
            strcmp(row->in, in) == 0 && strlen(row->name) == n && memcmp(row->name, name, n) == 0;
        if (is_named && row->path != NULL && strcmp(row->path, path) == 0)
            return row;
        if (is_named && row->path == NULL)
            found = row;
    }
    return found;
}
