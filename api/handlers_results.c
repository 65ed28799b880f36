// What a run has given so far: resolved scenario, summary, curve, snapshots.

#include "api/exchange_priv.h"
#include "api/handlers.h"
#include "api/json_out.h"
#include "api/number.h"
#include "api/results.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

// Largest grid that is written as JSON text, cells.
#define JSON_CELLS_MAX 4000000

static void let_cache_forever(exchange *x)
{
    api_response_header(x->response, "Cache-Control", "private, max-age=31536000, immutable");
}

bf_status handlers_results_scenario(exchange *x, bf_error *err)
{
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    let_cache_forever(x);
    if (exchange__is_unchanged(x, "%s-scenario", record.id))
        return BF_OK;
    return x->services->read_text(x->services->context, record.id, API_TEXT_SCENARIO,
                                  &x->response->body, err);
}

bf_status handlers_results_summary(exchange *x, bf_error *err)
{
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    if (!record.has_summary)
        return bf_fail(err, BF_ECONFLICT, "",
                       run_state_is_end(record.state)
                           ? "the run is %s and has left no summary"
                           : "the run is %s: the summary comes at its end",
                       run_state_word(record.state));
    exchange__let_revalidate(x);
    if (exchange__is_unchanged(x, "%s-summary", record.id))
        return BF_OK;
    return x->services->read_text(x->services->context, record.id, API_TEXT_SUMMARY,
                                  &x->response->body, err);
}

bf_status handlers_results_curve(exchange *x, bf_error *err)
{
    api_curve curve = { 0 };
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    exchange__let_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-%s", record.revision, x->media->word))
        return BF_OK;
    status = x->services->read_curve(x->services->context, record.id, 0, &curve, err);
    if (status != BF_OK)
        return status;
    status = x->media->format == MEDIA_CSV ? results_curve_csv(&curve, &x->response->body, err)
                                           : results_curve_json(&curve, &x->response->body, err);
    api_curve_fini(&curve);
    return status;
}

bf_status handlers_results_snapshots(exchange *x, bf_error *err)
{
    api_snapshot_list list = { 0 };
    char url[API_ID_SIZE + 32];
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    exchange__let_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-snapshots", record.revision))
        return BF_OK;
    status = x->services->list_snapshots(x->services->context, record.id, &list, err);
    if (status != BF_OK)
        return status;
    snprintf(url, sizeof url, "/v1/runs/%s", record.id);
    status = results_snapshots_json(&list, url, &x->response->body, err);
    buffer_fini(&list.items);
    return status;
}

static void write_rows(json_out *w, const bf_grid *grid, const float *rho)
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

static bf_status write_snapshot_json(const api_snapshot *snapshot, const bf_grid *grid,
                                     const float *rho, bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);

    json_out_object(&w);
    json_out_key_integer(&w, "n", (int64_t)snapshot->index);
    json_out_key_number(&w, "t_s", snapshot->t);
    json_out_key_number(&w, "peak", snapshot->peak);
    json_out_key_number(&w, "mass", snapshot->mass);
    json_out_key_pair(&w, "origin_m", grid->lower1, grid->lower2);
    json_out_key_pair(&w, "cell_m", grid->d1, grid->d2);
    json_out_key_pair(&w, "shape", (double)grid->n2, (double)grid->n1);
    write_rows(&w, grid, rho);
    json_out_object_end(&w);
    return json_out_status(&w, err);
}

// Reads the grid and writes it in the format that was chosen.
static bf_status write_snapshot(exchange *x, const char *id, uint64_t index, bf_error *err)
{
    bf_buffer *body = &x->response->body;
    bf_buffer bytes = { 0 };
    api_snapshot snapshot;
    bf_grid grid;

    bf_status status =
        x->services->read_snapshot(x->services->context, id, index, &snapshot, &grid, &bytes, err);
    if (status != BF_OK)
        return status;
    const float *rho = (const float *)(const void *)bytes.bytes;
    if (x->media->format == MEDIA_NPY)
        status = results_npy(rho, grid.n1, grid.n2, body, err);
    else if (grid_cells(&grid) > JSON_CELLS_MAX)
        status =
            exchange__refuse(x, 406, err, "%zu cells are too many for JSON (limit %d); use npy",
                             grid_cells(&grid), JSON_CELLS_MAX);
    else
        status = write_snapshot_json(&snapshot, &grid, rho, body, err);
    buffer_fini(&bytes);
    return status;
}

bf_status handlers_results_snapshot(exchange *x, bf_error *err)
{
    const char *number = x->params.values[1];
    uint64_t index = 0;
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    if (query_read_number(number, &index) != 0 || index >= record.n_snapshots)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no snapshot '%s'; it has %" PRIu64,
                       number, record.n_snapshots);
    let_cache_forever(x);
    if (exchange__is_unchanged(x, "%s-%" PRIu64 "-%s", record.id, index, x->media->word))
        return BF_OK;
    return write_snapshot(x, record.id, index, err);
}
