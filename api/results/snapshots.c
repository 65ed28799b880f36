#include "api/results/results.h"

#include "api/json/json_out.h"
#include "api/json/number.h"
#include "api/results/results_files.h"
#include "api/results/results_priv.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#define AT(place) offsetof(bf_grid, place)
static const member grid_members[] = {
    MEMBER("origin_m", point, AT(lower1), "Corner with the smallest x and y", .unit = "m, m"),
    MEMBER("cell_m", point, AT(d1), "Edges of a cell along x and y", .unit = "m, m"),
    MEMBER("shape", shape, 0, "Rows along y and columns along x"),
};
const member_table results_grid_members = { MEMBER_TABLE("Grid", grid_members) };
#undef AT
_Static_assert(offsetof(bf_grid, lower2) == offsetof(bf_grid, lower1) + sizeof(double) &&
                   offsetof(bf_grid, d2) == offsetof(bf_grid, d1) + sizeof(double),
               "a point is two doubles");

// A snapshot in a list: of a run, or of the files in a directory.
typedef struct snapshot_item {
    char run[API_ID_SIZE]; // "": files
    bool has_parts;
    api_snapshot snapshot;
} snapshot_item;

static bool is_file(const void *item)
{
    const snapshot_item *of = item;

    return of->run[0] == '\0';
}

static bool is_resource(const void *item)
{
    return !is_file(item);
}

static bool has_parts_file(const void *item)
{
    const snapshot_item *of = item;

    return is_file(item) && of->has_parts;
}

static bool has_parts_resource(const void *item)
{
    const snapshot_item *of = item;

    return is_resource(item) && of->has_parts;
}

static void write_file(json_out *w, results_files file, const void *item)
{
    const snapshot_item *of = item;
    char name[RESULTS_FILES_NAME_SIZE];

    (void)results_files_name(file, of->snapshot.index, name);
    json_out_string(w, name);
}

static void write_snapshot_file(json_out *w, const member *m, const void *item)
{
    (void)m;
    write_file(w, RESULTS_FILES_SNAPSHOT, item);
}

static void write_parts_file(json_out *w, const member *m, const void *item)
{
    (void)m;
    write_file(w, RESULTS_FILES_PARTS, item);
}

static const member_kind member_snapshot_file = { .type = "string", .write = write_snapshot_file };
static const member_kind member_parts_file = { .type = "string", .write = write_parts_file };

#define AT(place) offsetof(snapshot_item, place)
static const member item_members[] = {
    MEMBER("n", size, AT(snapshot.index), "Number of the snapshot, from 0"),
    MEMBER("t_s", number, AT(snapshot.t), "Its time", .unit = "s"),
    MEMBER("file", snapshot_file, 0, "Its density", .flags = MEMBER_FILE, .applies = is_file),
    MEMBER("url", link, AT(run), "Its density", .path = "/v1/runs/{id}/snapshots/{n}",
           .offset_n = AT(snapshot.index), .flags = MEMBER_SERVED, .applies = is_resource),
    MEMBER("peak", number, AT(snapshot.peak), "Largest density; 1 is close packing"),
    MEMBER("mass", number, AT(snapshot.mass), "Parts in the domain"),
    MEMBER("parts_file", parts_file, 0, "Its parts", .flags = MEMBER_FILE,
           .applies = has_parts_file),
    MEMBER("parts_url", link, AT(run), "Its parts (microscopic model)",
           .path = "/v1/runs/{id}/parts/{n}", .offset_n = AT(snapshot.index),
           .applies = has_parts_resource),
};
const member_table results_snapshot_item_members = { MEMBER_TABLE("SnapshotItem", item_members) };
#undef AT

static bool list_has_parts(const void *item)
{
    const api_snapshot_list *list = item;

    return list->parts.n_values > 0;
}

#define AT(place) offsetof(api_snapshot_list, place)
static const member snapshots_members[] = {
    MEMBER("grid", object, AT(grid), "Grid of every snapshot", .table = &results_grid_members),
    MEMBER("parts", object, AT(parts), "Layout of the parts of every snapshot (microscopic model)",
           .table = &results_parts_layout_members, .applies = list_has_parts),
    MEMBER("kinds", described, 0,
           "Of a mix without feeds: the kind of each part, an index in `cargo` of the scenario, in "
           "the order of placement (microscopic model)",
           .type = "[#Count]", .flags = MEMBER_OPTIONAL),
    MEMBER("snapshots", described, 0, "The snapshots so far", .type = "[#SnapshotItem]"),
};
const member_table results_snapshots_members = { MEMBER_TABLE("SnapshotList", snapshots_members) };
#undef AT

bf_status results_snapshots_json(const api_snapshot_list *list, const char *run_id,
                                 const part_kinds *kinds, bf_buffer *out, bf_error *err)
{
    const api_snapshot *items = (const api_snapshot *)(const void *)list->items.bytes;
    snapshot_item item = { .has_parts = list_has_parts(list) };
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    snprintf(item.run, sizeof item.run, "%s", run_id == NULL ? "" : run_id);
    json_out_object(&w);
    members_write_into(&w, &results_snapshots_members, list);
    if (kinds != NULL && kinds->n > 0) {
        json_out_key(&w, "kinds");
        json_out_array(&w);
        for (size_t k = 0; k < kinds->n; k++)
            json_out_integer(&w, kinds->of[k]);
        json_out_array_end(&w);
    }
    json_out_key(&w, "snapshots");
    json_out_array(&w);
    for (size_t k = 0; k < list->n; k++) {
        item.snapshot = items[k];
        members_write(&w, &results_snapshot_item_members, &item);
    }
    json_out_array_end(&w);
    json_out_object_end(&w);
    return results__finish(json_out_status(&w, err), out, n_before, err);
}

typedef struct snapshot_view {
    api_snapshot of;
    bf_grid grid;
} snapshot_view;

#define AT(place) offsetof(snapshot_view, place)
static const member snapshot_members[] = {
    MEMBER("n", size, AT(of.index), "Number of the snapshot, from 0"),
    MEMBER("t_s", number, AT(of.t), "Its time", .unit = "s"),
    MEMBER("peak", number, AT(of.peak), "Largest density"),
    MEMBER("mass", number, AT(of.mass), "Parts in the domain"),
    MEMBER_INLINE(&results_grid_members, AT(grid)),
    MEMBER("density", described, 0, "Rows along y of cells along x; 1 is close packing",
           .type = "[[number?]]"),
};
const member_table results_snapshot_members = { MEMBER_TABLE("Snapshot", snapshot_members) };
#undef AT

bf_status results_snapshot_json(const float *rho, const bf_grid *grid, const api_snapshot *snapshot,
                                bf_buffer *out, bf_error *err)
{
    const snapshot_view view = { .of = *snapshot, .grid = *grid };
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    json_out_object(&w);
    members_write_into(&w, &results_snapshot_members, &view);
    char text[NUMBER_SIZE];
    json_out_key(&w, "density");
    json_out_array(&w);
    for (size_t j = 0; j < grid->n2; j++) {
        json_out_array(&w);
        for (size_t i = 0; i < grid->n1; i++) {
            float value = rho[j * grid->n1 + i];
            if (isfinite(value))
                json_out_raw(&w, text, (size_t)number_format_float(value, text));
            else
                json_out_null(&w);
        }
        json_out_array_end(&w);
    }
    json_out_array_end(&w);
    json_out_object_end(&w);
    return results__finish(json_out_status(&w, err), out, n_before, err);
}

// Room for a line of n cells and what stands before them. NULL: no memory.
static char *reserve_line(bf_buffer *out, size_t n)
{
    return buffer_reserve(out, (n + 1) * NUMBER_SIZE);
}

static void end_line(bf_buffer *out, char *at)
{
    at[-1] = '\n'; // instead of a comma
    *at = '\0';
    out->n = (size_t)(at - out->bytes);
}

static bf_status append_centres(const bf_grid *grid, bf_buffer *out)
{
    char *at = reserve_line(out, grid->n1);

    if (at == NULL)
        return BF_ENOMEM;
    at += snprintf(at, NUMBER_SIZE, "y_m/x_m,");
    for (size_t i = 0; i < grid->n1; i++)
        at = results__put_number(at, grid_x1(grid, i), ',');
    end_line(out, at);
    return BF_OK;
}

static bf_status append_row(const bf_grid *grid, size_t j, const float *rho, bf_buffer *out)
{
    char *at = reserve_line(out, grid->n1);

    if (at == NULL)
        return BF_ENOMEM;
    at = results__put_number(at, grid_x2(grid, j), ',');
    for (size_t i = 0; i < grid->n1; i++) {
        at += isfinite(rho[i]) ? number_format_float(rho[i], at) : snprintf(at, NUMBER_SIZE, "nan");
        *at++ = ',';
    }
    end_line(out, at);
    return BF_OK;
}

bf_status results_snapshot_csv(const float *rho, const bf_grid *grid, bf_buffer *out, bf_error *err)
{
    size_t n_before = out->n;

    bf_status status = append_centres(grid, out);
    for (size_t j = 0; j < grid->n2 && status == BF_OK; j++)
        status = append_row(grid, j, rho + j * grid->n1, out);
    return results__finish(status, out, n_before, err);
}
