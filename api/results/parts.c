#include "api/results/results.h"

#include "api/json/json_out.h"
#include "api/json/number.h"
#include "api/results/results_priv.h"
#include "core/base/check.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

// The first two are those of scenarios with feeds alone.
static const char *const disk_columns[] = { "id",          "kind",   "x_m",    "y_m",
                                            "heading_rad", "vx_m_s", "vy_m_s", "spin_rad_s" };
static const char *const body_columns[] = {
    "id",  "kind",   "x_m",    "y_m",    "z_m",      "q_w",      "q_x",     "q_y",
    "q_z", "vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s"
};

_Static_assert(sizeof disk_columns / sizeof *disk_columns == FRAME_VALUES_FED + FRAME_VALUES_PLANAR,
               "a name each");
_Static_assert(sizeof body_columns / sizeof *body_columns ==
                   FRAME_VALUES_FED + FRAME_VALUES_SPATIAL,
               "a name each");

// Names of the values of a part, n_values of them.
static const char *const *columns_of(uint32_t n_values)
{
    const size_t n_ids = frame_has_ids(n_values) ? FRAME_VALUES_FED : 0;

    BF_CHECK(n_values - n_ids == FRAME_VALUES_PLANAR || n_values - n_ids == FRAME_VALUES_SPATIAL);
    return (frame_is_planar(n_values) ? disk_columns : body_columns) + FRAME_VALUES_FED - n_ids;
}

static bf_status append_header(const api_parts *parts, bf_buffer *out)
{
    const char *const *columns = columns_of(parts->n_values);
    const bool has_ids = frame_has_ids(parts->n_values);
    BF_TRY(buffer_printf(out, "%s", has_ids ? "" : "part"));

    for (uint32_t k = 0; k < parts->n_values; k++)
        BF_TRY(buffer_printf(out, "%s%s", has_ids && k == 0 ? "" : ",", columns[k]));
    return buffer_printf(out, "\n");
}

bf_status results_parts_csv(const double *rows, const api_parts *parts, bf_buffer *out,
                            bf_error *err)
{
    size_t n_before = out->n;
    uint32_t n_values = parts->n_values;

    bf_status status = append_header(parts, out);
    for (uint64_t k = 0; k < parts->n_parts && status == BF_OK; k++) {
        char *from = buffer_reserve(out, (n_values + 1) * NUMBER_SIZE);
        if (from == NULL)
            return results__finish(BF_ENOMEM, out, n_before, err);
        char *at = from;
        if (!frame_has_ids(n_values))
            at += snprintf(from, NUMBER_SIZE, "%" PRIu64 ",", k);
        for (uint32_t v = 0; v < n_values; v++)
            at = results__put_number(at, rows[k * n_values + v], v + 1 == n_values ? '\n' : ',');
        *at = '\0';
        out->n += (size_t)(at - from);
    }
    return results__finish(status, out, n_before, err);
}

static void write_row(json_out *w, const double *row, uint32_t n_values)
{
    // A part that has left the domain has no values at all.
    if (isnan(row[0])) {
        json_out_null(w);
        return;
    }
    json_out_array(w);
    for (uint32_t v = 0; v < n_values; v++)
        json_out_number(w, row[v]);
    json_out_array_end(w);
}

static void write_columns(json_out *w, const member *m, const void *item)
{
    const api_parts *parts = (const api_parts *)(const void *)((const char *)item + m->offset);
    const char *const *columns = columns_of(parts->n_values);

    json_out_array(w);
    for (uint32_t k = 0; k < parts->n_values; k++)
        json_out_string(w, columns[k]);
    json_out_array_end(w);
}

static const member_kind member_columns = { .type = "[string]", .write = write_columns };

static bool has_rows(const void *item)
{
    const api_parts *parts = item;

    return !frame_has_ids(parts->n_values);
}

#define COLUMNS "Names of the values of a part, with their units"
static const member layout_members[] = {
    MEMBER("rows", size, offsetof(api_parts, n_parts),
           "Parts, in the order of their placement; missing where there are feeds: a snapshot then "
           "has a row for each part in the domain, by their ids",
           .applies = has_rows),
    MEMBER("columns", columns, 0, COLUMNS),
};
const member_table results_parts_layout_members = { MEMBER_TABLE("PartsLayout", layout_members) };

typedef struct parts_view {
    api_snapshot snapshot;
    api_parts parts;
} parts_view;

#define AT(place) offsetof(parts_view, place)
static const member parts_members[] = {
    MEMBER("n", size, AT(snapshot.index), "Number of the snapshot"),
    MEMBER("t_s", number, AT(snapshot.t), "Its time", .unit = "s"),
    MEMBER("columns", columns, AT(parts), COLUMNS),
    MEMBER("parts", described, 0, "The values of each part; null: it has left the domain",
           .type = "[[number?]?]"),
};
const member_table results_parts_members = { MEMBER_TABLE("Parts", parts_members) };
#undef AT

bf_status results_parts_json(const double *rows, const api_parts *parts,
                             const api_snapshot *snapshot, bf_buffer *out, bf_error *err)
{
    const parts_view view = { .snapshot = *snapshot, .parts = *parts };
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    json_out_object(&w);
    members_write_into(&w, &results_parts_members, &view);
    json_out_key(&w, "parts");
    json_out_array(&w);
    for (uint64_t k = 0; k < parts->n_parts; k++)
        write_row(&w, rows + k * parts->n_values, parts->n_values);
    json_out_array_end(&w);
    json_out_object_end(&w);
    return results__finish(json_out_status(&w, err), out, n_before, err);
}
