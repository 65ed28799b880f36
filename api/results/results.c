#include "api/results/results.h"

#include "api/json/json_out.h"
#include "api/json/number.h"
#include "api/results/results_files.h"
#include "api/results/results_priv.h"
#include "core/base/check.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

bf_status results__finish(bf_status status, bf_buffer *out, size_t n, bf_error *err)
{
    if (status == BF_OK)
        return BF_OK;
    buffer_truncate(out, n);
    return bf_fail(err, status, "", "out of memory");
}

bf_status results_curve_csv_header(const char *columns, bf_buffer *out, bf_error *err)
{
    return results__finish(buffer_printf(out, "t_s,%s\n", columns), out, out->n, err);
}

char *results__put_number(char *text, double value, char separator)
{
    text += isfinite(value) ? number_format(value, text) : snprintf(text, NUMBER_SIZE, "nan");
    *text++ = separator;
    return text;
}

bf_status results_curve_csv_rows(const double *t, const double *values, size_t n, size_t n_columns,
                                 bf_buffer *out, bf_error *err)
{
    size_t n_before = out->n;

    for (size_t k = 0; k < n; k++) {
        char *from = buffer_reserve(out, (n_columns + 1) * NUMBER_SIZE);
        if (from == NULL)
            return results__finish(BF_ENOMEM, out, n_before, err);
        char *at = results__put_number(from, t[k], n_columns == 0 ? '\n' : ',');
        for (size_t c = 0; c < n_columns; c++)
            at =
                results__put_number(at, values[k * n_columns + c], c + 1 == n_columns ? '\n' : ',');
        *at = '\0';
        out->n += (size_t)(at - from);
    }
    return BF_OK;
}

static const double *doubles_of(const bf_buffer *b)
{
    return (const double *)(const void *)b->bytes;
}

bf_status results_curve_csv(const api_curve *curve, bf_buffer *out, bf_error *err)
{
    const char *columns = curve->columns.bytes == NULL ? "" : curve->columns.bytes;
    size_t n_before = out->n;

    bf_status status = results_curve_csv_header(columns, out, err);
    if (status == BF_OK)
        status = results_curve_csv_rows(doubles_of(&curve->t), doubles_of(&curve->values), curve->n,
                                        curve->n_columns, out, err);
    return results__finish(status, out, n_before, err);
}

typedef struct curve_times {
    const double *t;
    size_t n;
} curve_times;

#define AT(place) offsetof(curve_times, place)
static const member curve_members[] = {
    MEMBER("t_s", numbers, AT(t), "Times of the samples", .unit = "s", .offset_n = AT(n)),
    MEMBER("left_domain", described, 0, "Parts that have left the domain at each time",
           .type = "[number]"),
};
const member_table results_curve_members = { MEMBER_TABLE("Curve", curve_members) };
#undef AT

bf_status results_curve_json(const api_curve *curve, bf_buffer *out, bf_error *err)
{
    const curve_times times = { .t = doubles_of(&curve->t), .n = curve->n };
    const char *names = curve->columns.bytes;
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    json_out_object(&w);
    members_write_into(&w, &results_curve_members, &times);
    for (size_t c = 0; c < curve->n_columns; c++) {
        char key[SCENE_ID_SIZE];
        bool has_name = api_take_column(&names, key);
        BF_CHECK(has_name);
        json_out_key(&w, key);
        json_out_numbers(&w, doubles_of(&curve->values) + c, curve->n, curve->n_columns);
    }
    json_out_object_end(&w);
    return results__finish(json_out_status(&w, err), out, n_before, err);
}

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
    MEMBER("snapshots", described, 0, "The snapshots so far", .type = "[#SnapshotItem]"),
};
const member_table results_snapshots_members = { MEMBER_TABLE("SnapshotList", snapshots_members) };
#undef AT

bf_status results_snapshots_json(const api_snapshot_list *list, const char *run_id, bf_buffer *out,
                                 bf_error *err)
{
    const api_snapshot *items = (const api_snapshot *)(const void *)list->items.bytes;
    snapshot_item item = { .has_parts = list_has_parts(list) };
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    snprintf(item.run, sizeof item.run, "%s", run_id == NULL ? "" : run_id);
    json_out_object(&w);
    members_write_into(&w, &results_snapshots_members, list);
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
