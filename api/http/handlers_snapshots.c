// Density snapshots: the list, one of them in any format, and all of them for ParaView.

#include "api/http/exchange_priv.h"
#include "api/http/handlers.h"
#include "api/results/picture.h"
#include "api/results/results.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// Largest grid that is written as text, cells.
#define TEXT_CELLS_MAX 4000000

// Range of the end of a picture's scale.
#define TOP_LEAST 1e-3
#define TOP_MOST  1e3

// How a picture is wanted.
typedef struct picture_query {
    uint64_t width; // pixels; 0: as it comes out well
    double top;
    const colormap *map;
} picture_query;

bf_status handlers_snapshots_list(exchange *x, bf_error *err)
{
    api_snapshot_list list = { 0 };
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    exchange__let_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-snapshots-%s", record.revision, x->media->word))
        return BF_OK;
    status = x->services->list_snapshots(x->services->context, record.id, &list, err);
    if (status != BF_OK)
        return status;
    status = x->media->format == MEDIA_PVD
                 ? results_series_pvd(&list, RESULTS_FILES_SNAPSHOT_VTK, &x->response->body, err)
                 : results_snapshots_json(&list, record.id, &x->response->body, err);
    buffer_fini(&list.items);
    return status;
}

static bf_status read_colormap(const query *q, const colormap **ret_map, bf_error *err)
{
    const char *word = query_value(q, "colormap");

    if (word == NULL)
        return BF_OK;
    const colormap *map = colormap_find(word);
    if (map == NULL)
        return bf_fail(err, BF_EINPUT, "", "there is no colormap '%.32s'; there is: %s", word,
                       colormap_words());
    *ret_map = map;
    return BF_OK;
}

// Only pictures have a width, a scale and colours.
static bf_status refuse_picture_query(const exchange *x, bf_error *err)
{
    static const char *const names[] = { "width", "colormap", "max" };

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (query_value(&x->query, names[i]) != NULL)
            return bf_fail(err, BF_EINPUT, "", "query parameter '%s' is for png, not for %s",
                           names[i], x->media->word);
    }
    return BF_OK;
}

static bf_status read_picture_query(const exchange *x, picture_query *ret_wanted, bf_error *err)
{
    picture_query wanted = { .top = PICTURE_TOP, .map = colormap_first() };

    if (x->media->format != MEDIA_PNG)
        return refuse_picture_query(x, err);
    bf_status status = query_number(&x->query, "width", 1, PICTURE_WIDTH_MAX, &wanted.width, err);
    if (status == BF_OK)
        status = query_real(&x->query, "max", TOP_LEAST, TOP_MOST, &wanted.top, err);
    if (status == BF_OK)
        status = read_colormap(&x->query, &wanted.map, err);
    if (status == BF_OK)
        *ret_wanted = wanted;
    return status;
}

static bool has_it_already(exchange *x, const char *id, uint64_t index, const picture_query *wanted)
{
    if (x->media->format != MEDIA_PNG)
        return exchange__is_unchanged(x, "%s-%" PRIu64 "-%s", id, index, x->media->word);
    return exchange__is_unchanged(x, "%s-%" PRIu64 "-png-%" PRIu64 "-%s-%.17g", id, index,
                                  wanted->width, colormap_word(wanted->map), wanted->top);
}

static bf_status write_picture(exchange *x, const picture_query *wanted, const bf_grid *grid,
                               const float *rho, double t, bf_error *err)
{
    picture p;

    bf_status status = picture_layout(grid, (size_t)wanted->width, wanted->top, &p, err);
    if (status == BF_ELIMIT)
        x->refusal = 422;
    if (status != BF_OK)
        return status;
    return results_snapshot_png(&p, wanted->map, rho, t, &x->response->body, err);
}

static bf_status write_text(exchange *x, const api_snapshot *snapshot, const bf_grid *grid,
                            const float *rho, bf_error *err)
{
    bf_buffer *body = &x->response->body;

    if (grid_cells(grid) > TEXT_CELLS_MAX)
        return exchange__refuse(x, 406, err,
                                "%zu cells are too many for text (limit %d); use npy or vti",
                                grid_cells(grid), TEXT_CELLS_MAX);
    return x->media->format == MEDIA_CSV ? results_snapshot_csv(rho, grid, body, err)
                                         : results_snapshot_json(rho, grid, snapshot, body, err);
}

// Reads the grid and writes it in the format that was chosen.
static bf_status write_snapshot(exchange *x, const char *id, uint64_t index,
                                const picture_query *wanted, bf_error *err)
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
    else if (x->media->format == MEDIA_VTI)
        status = results_snapshot_vti(rho, &grid, snapshot.t, body, err);
    else if (x->media->format == MEDIA_PNG)
        status = write_picture(x, wanted, &grid, rho, snapshot.t, err);
    else
        status = write_text(x, &snapshot, &grid, rho, err);
    buffer_fini(&bytes);
    return status;
}

bf_status handlers_snapshots_show(exchange *x, bf_error *err)
{
    picture_query wanted = { .map = NULL };
    uint64_t index = 0;
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status == BF_OK)
        status = exchange__find_snapshot(x, &record, &index, err);
    if (status == BF_OK)
        status = read_picture_query(x, &wanted, err);
    if (status != BF_OK)
        return status;
    exchange__let_keep(x);
    if (has_it_already(x, record.id, index, &wanted))
        return BF_OK;
    exchange__name_snapshot(x, index);
    return write_snapshot(x, record.id, index, &wanted, err);
}
