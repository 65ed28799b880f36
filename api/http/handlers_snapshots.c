// The density snapshots of a run: their list, and one of them in its formats.

#include "api/http/http_priv.h"
#include "api/http/negotiation.h"
#include "api/results/array_file.h"
#include "api/results/grid_rows.h"
#include "api/results/picture.h"
#include "api/results/results.h"
#include "core/base/memory.h"

#include <inttypes.h>

// The parameters of a picture.
typedef struct picture_query {
    uint64_t width; // pixels; 0: chosen by picture_layout()
    double top;
    const colormap *map;
} picture_query;

static bf_status write_list(exchange *x, const api_run *of, const api_snapshot_list *list,
                            bf_error *err)
{
    bf_buffer scenario = { 0 };
    part_kinds kinds = { 0 };
    bf_status status = BF_OK;

    if (list->parts.n_values > 0)
        status =
            x->services->read_text(x->services->store, of->id, API_TEXT_SCENARIO, &scenario, err);
    if (status == BF_OK)
        status = kinds_find(scenario.bytes, scenario.n, &list->parts, &kinds, err);
    if (status == BF_OK)
        status = results_snapshots_json(list, of->id, &kinds, &x->response->body, err);
    kinds_fini(&kinds);
    buffer_fini(&scenario);
    return status;
}

bf_status handlers_results_snapshots(exchange *x, bf_error *err)
{
    api_snapshot_list list = { 0 };
    const api_run *of = &x->named->run;

    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-snapshots-%s", of->revision, x->media->word))
        return BF_OK;
    BF_TRY(x->services->list_snapshots(x->services->store, of->id, &list, err));
    const bf_status status =
        x->media->format == MEDIA_PVD
            ? results_series_pvd(&list, RESULTS_FILES_SNAPSHOT_VTK, &x->response->body, err)
            : write_list(x, of, &list, err);
    buffer_fini(&list.items);
    return status;
}

// Reads the grid from its lowest row up, so that only some rows of it are in memory.
static bf_status draw(exchange *x, const picture *p, const char *id, uint64_t index,
                      uint8_t *levels, double *ret_t, bf_error *err)
{
    grid_rows rows;

    BF_TRY(grid_rows_open(x->services, id, index, &rows, err));
    *ret_t = rows.of.snapshot.t;
    const bf_status status = picture_draw(p, grid_rows_next, &rows, levels, err);
    grid_rows_fini(&rows);
    return status;
}

static bf_status write_picture(exchange *x, const api_run *of, uint64_t index,
                               const picture_query *wanted, bf_error *err)
{
    double t = 0.0;
    picture p;

    bf_status status = picture_layout(&of->grid, (size_t)wanted->width, wanted->top, &p, err);
    if (status == BF_ELIMIT)
        x->refusal = 422;
    if (status != BF_OK)
        return status;
    // The levels and the file, whose size is about that of the levels at most; a row of cells, and its mean.
    BF_TRY(exchange__reserve(x,
                             2.0 * (double)(p.width * p.height) +
                                 (double)p.grid.n1 * (sizeof(double) + sizeof(float)) +
                                 GRID_ROWS_BYTES,
                             err));
    uint8_t *levels = memory_alloc(p.width, p.height);
    if (levels == NULL)
        return bf_fail_memory(err);
    status = draw(x, &p, of->id, index, levels, &t, err);
    if (status == BF_OK)
        status = results_snapshot_png(&p, wanted->map, levels, t, &x->response->body, err);
    memory_free(levels);
    return status;
}

// Reads the grid and writes it in the format that was chosen.
static bf_status write_snapshot(exchange *x, const char *id, uint64_t index, bf_error *err)
{
    bf_buffer *body = &x->response->body;
    bf_buffer bytes = { 0 };
    api_array of;

    BF_TRY(x->services->read_array(x->services->store, id, index, API_ARRAY_DENSITY, &of, &bytes,
                                   err));
    const float *rho = (const float *)(const void *)bytes.bytes;
    bf_status status;

    if (x->media->format == MEDIA_NPY)
        status = results_npy(rho, of.grid.n1, of.grid.n2, body, err);
    else if (x->media->format == MEDIA_VTI)
        status = results_snapshot_vti(rho, &of.grid, of.snapshot.t, body, err);
    else if (x->media->format == MEDIA_CSV)
        status = results_snapshot_csv(rho, &of.grid, body, err);
    else
        status = results_snapshot_json(rho, &of.grid, &of.snapshot, body, err);
    buffer_fini(&bytes);
    return status;
}

static bool is_sent_in_pieces(const exchange *x, size_t n_cells)
{
    const bool is_array = x->media->format == MEDIA_NPY || x->media->format == MEDIA_VTI;

    // VTK images are not compressed.
    const size_t n_whole =
        x->media->format == MEDIA_NPY ? exchange__whole_bytes(x) : EXCHANGE_PIECE_BYTES;

    return is_array && n_cells * sizeof(float) > n_whole && exchange__accepts_plain(x);
}

bf_status handlers_results_snapshot(exchange *x, bf_error *err)
{
    const char *map = exchange__text(x, "colormap");
    const picture_query wanted = { .width = exchange__whole(x, "width"),
                                   .top = exchange__real(x, "max"),
                                   .map = map == NULL ? colormap_first() : colormap_find(map) };
    const bool is_picture = x->media->format == MEDIA_PNG;
    uint64_t index = 0;
    const api_run *of = &x->named->run;

    BF_TRY(exchange__find_snapshot(x, &index, err));
    if (exchange__wants_several(x))
        return exchange__send_several(x, index, false, err);
    exchange__cache_immutable(x);
    if (is_picture
            ? exchange__is_unchanged(x, "%s-%" PRIu64 "-png-%" PRIu64 "-%s-%.17g", of->id, index,
                                     wanted.width, colormap_word(wanted.map), wanted.top)
            : exchange__is_unchanged(x, "%s-%" PRIu64 "-%s", of->id, index, x->media->word))
        return BF_OK;
    exchange__name_snapshot(x, index);
    const size_t n_cells = grid_cells(&of->grid);
    if (is_picture)
        return write_picture(x, of, index, &wanted, err);
    if (is_sent_in_pieces(x, n_cells)) {
        array_file file = { .item_size = 0 };
        BF_TRY(array_file_open(x->services, of->id, index,
                               x->media->format == MEDIA_NPY ? ARRAY_FILE_NPY : ARRAY_FILE_VTI,
                               &file, err));
        return exchange__send_array(x, &file, err);
    }
    BF_TRY(exchange__reserve_whole(x, n_cells, sizeof(float), "npy or vti", err));
    return write_snapshot(x, of->id, index, err);
}
