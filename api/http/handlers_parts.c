// The parts of a microscopic run: at the time of a snapshot, and all of them for ParaView.

#include "api/http/exchange_priv.h"
#include "api/http/handlers.h"
#include "api/results/results.h"

#include <inttypes.h>

// Largest table that is written as text, values.
#define TEXT_VALUES_MAX 4000000

static bf_status write_rows(exchange *x, const api_parts *parts, const api_snapshot *snapshot,
                            const double *rows, bf_error *err)
{
    bf_buffer *body = &x->response->body;

    if (x->media->format == MEDIA_NPY)
        return results_parts_npy(rows, parts, body, err);
    if (x->media->format == MEDIA_VTP)
        return results_parts_vtp(rows, parts, snapshot->t, body, err);
    if (parts->n_parts * parts->n_values > TEXT_VALUES_MAX)
        return exchange__refuse(x, 406, err,
                                "%" PRIu64 " parts of %" PRIu32 " values are too many for text "
                                "(limit %d values); use npy or vtp",
                                parts->n_parts, parts->n_values, TEXT_VALUES_MAX);
    return x->media->format == MEDIA_CSV ? results_parts_csv(rows, parts, body, err)
                                         : results_parts_json(rows, parts, snapshot, body, err);
}

bf_status handlers_parts_show(exchange *x, bf_error *err)
{
    bf_buffer rows = { 0 };
    uint64_t index = 0;
    api_snapshot snapshot;
    api_parts parts;
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status == BF_OK)
        status = exchange__find_snapshot(x, &record, &index, err);
    if (status == BF_OK)
        status = x->services->read_parts(x->services->context, record.id, index, &snapshot, &parts,
                                         &rows, err);
    if (status != BF_OK)
        return status;
    exchange__let_keep(x);
    if (!exchange__is_unchanged(x, "%s-parts-%" PRIu64 "-%s", record.id, index, x->media->word)) {
        exchange__name_snapshot(x, index);
        status = write_rows(x, &parts, &snapshot, (const double *)(const void *)rows.bytes, err);
    }
    buffer_fini(&rows);
    return status;
}

bf_status handlers_parts_series(exchange *x, bf_error *err)
{
    api_snapshot_list list = { 0 };
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    if (record.model != RUN_MICRO)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no parts: its model is %s",
                       run_model_words[record.model]);
    exchange__let_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-parts-%s", record.revision, x->media->word))
        return BF_OK;
    status = x->services->list_snapshots(x->services->context, record.id, &list, err);
    if (status != BF_OK)
        return status;
    status = results_series_pvd(&list, RESULTS_FILES_PARTS_VTK, &x->response->body, err);
    buffer_fini(&list.items);
    return status;
}
