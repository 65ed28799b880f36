#include "api/results/results.h"

#include "api/json/json_out.h"
#include "api/json/number.h"
#include "api/results/results_priv.h"

#include <math.h>
#include <stdio.h>

static void write_density(json_out *w, const bf_grid *grid, const float *rho)
{
    char text[NUMBER_SIZE];

    json_out_key(w, "density");
    json_out_array(w);
    for (size_t j = 0; j < grid->n2; j++) {
        json_out_array(w);
        for (size_t i = 0; i < grid->n1; i++) {
            float value = rho[j * grid->n1 + i];
            if (isfinite(value))
                json_out_raw(w, text, (size_t)number_format_float(value, text));
            else
                json_out_null(w);
        }
        json_out_array_end(w);
    }
    json_out_array_end(w);
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
    write_density(&w, grid, rho);
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
