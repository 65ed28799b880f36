// Parts of a micro run: one snapshot of them in its formats, and the series for ParaView.

#include "api/http/http_priv.h"
#include "api/http/negotiation.h"
#include "api/results/array_file.h"
#include "api/results/results.h"
#include "api/results/results_files.h"
#include "core/observe/frame.h"

#include <inttypes.h>

static bf_status write_rows(exchange *x, const api_parts *parts, const api_snapshot *snapshot,
                            const double *rows, bf_error *err)
{
    bf_buffer *body = &x->response->body;

    if (x->media->format == MEDIA_NPY)
        return results_parts_npy(rows, parts, body, err);
    if (x->media->format == MEDIA_VTP)
        return results_parts_vtp(rows, parts, snapshot->t, body, err);
    return x->media->format == MEDIA_CSV ? results_parts_csv(rows, parts, body, err)
                                         : results_parts_json(rows, parts, snapshot, body, err);
}

// Whether the client has the parts already; if not, the answer is one of them.
static bool has_parts_already(exchange *x, const char *id, uint64_t index)
{
    exchange__cache_immutable(x);
    if (exchange__is_unchanged(x, "%s-parts-%" PRIu64 "-%s", id, index, x->media->word))
        return true;
    exchange__name_snapshot(x, index);
    return false;
}

static bf_status send_parts(exchange *x, const char *id, uint64_t index, bf_error *err)
{
    array_file file = { .item_size = 0 };

    bf_status status = array_file_open(x->services, id, index, ARRAY_FILE_PARTS_NPY, &file, err);
    if (status == BF_OK && !has_parts_already(x, id, index))
        status = exchange__send_array(x, &file, err);
    array_file_fini(&file);
    return status;
}

// How many parts there are, which with feeds the snapshot alone knows.
static bf_status count_parts(exchange *x, const char *id, uint64_t index, api_array *ret_array,
                             bf_error *err)
{
    api_slices slices = { .n = 0 };

    bf_status status = x->services->open_array(x->services->store, id, index, API_ARRAY_PARTS,
                                               ret_array, &slices, err);
    api_slices_fini(&slices);
    return status;
}

// VTK points are made of all columns at once, and as a whole.
static bf_status reserve_parts(exchange *x, const char *id, uint64_t index, bf_error *err)
{
    api_array of;

    BF_TRY(count_parts(x, id, index, &of, err));
    const uint64_t n = of.parts.n_parts * of.parts.n_values;
    if (x->media->format == MEDIA_VTP)
        return exchange__reserve(x, 2.0 * sizeof(double) * (double)n, err);
    return exchange__reserve_whole(x, n, sizeof(double), "npy or vtp", err);
}

static bf_status write_parts(exchange *x, const char *id, uint64_t index, bf_error *err)
{
    bf_buffer rows = { 0 };
    api_array of;

    bf_status status =
        x->services->read_array(x->services->store, id, index, API_ARRAY_PARTS, &of, &rows, err);
    if (status == BF_OK)
        status =
            write_rows(x, &of.parts, &of.snapshot, (const double *)(const void *)rows.bytes, err);
    buffer_fini(&rows);
    return status;
}

static bool is_sent_in_pieces(const exchange *x, const api_parts *parts)
{
    const uint64_t n = parts->n_parts * parts->n_values * sizeof(double);

    return x->media->format == MEDIA_NPY && exchange__accepts_plain(x) &&
           (frame_has_ids(parts->n_values) || n > EXCHANGE_PIECE_BYTES);
}

bf_status handlers_results_parts(exchange *x, bf_error *err)
{
    uint64_t index = 0;
    const api_run *of = &x->named->run;

    BF_TRY(exchange__find_snapshot(x, &index, err));
    if (exchange__wants_several(x))
        return exchange__send_several(x, index, true, err);
    if (is_sent_in_pieces(x, &of->parts))
        return send_parts(x, of->id, index, err);
    BF_TRY(reserve_parts(x, of->id, index, err));
    return has_parts_already(x, of->id, index) ? BF_OK : write_parts(x, of->id, index, err);
}

bf_status handlers_results_parts_series(exchange *x, bf_error *err)
{
    api_snapshot_list list = { 0 };
    const api_run *of = &x->named->run;

    if (of->model != RUN_MICRO)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no parts: its model is %s",
                       run_model_words[of->model]);
    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-parts-%s", of->revision, x->media->word))
        return BF_OK;
    BF_TRY(x->services->list_snapshots(x->services->store, of->id, &list, err));
    const bf_status status =
        results_series_pvd(&list, RESULTS_FILES_PARTS_VTK, &x->response->body, err);
    buffer_fini(&list.items);
    return status;
}
