// The results of a run so far: scenario, summary, curve, snapshots, parts, all of them in one archive, and
// the stream of its events.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/http/negotiation.h"
#include "api/http/stream.h"
#include "api/results/array_file.h"
#include "api/results/picture.h"
#include "api/results/results.h"
#include "api/results/results_archive.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// Files from so many bytes on are sent piece by piece; smaller ones are sent faster as a whole.
#define WHOLE_BYTES_MAX 131072

// Largest tables that are written as text: cells of a grid, values of parts.
#define TEXT_CELLS_MAX  4000000
#define TEXT_VALUES_MAX 4000000

bf_status handlers_results_scenario(exchange *x, bf_error *err)
{
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    exchange__cache_immutable(x);
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
    exchange__cache_revalidate(x);
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
    exchange__cache_revalidate(x);
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

bf_status handlers_results_figures(exchange *x, bf_error *err)
{
    bf_buffer text = { 0 };
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    if (record.figures[0] == '\0')
        return bf_fail(err, BF_ECONFLICT, "", "the run is %s and has no key figures",
                       run_state_word(record.state));
    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-figures-%s", record.revision, x->media->word))
        return BF_OK;
    status = x->services->read_text(x->services->context, record.id, API_TEXT_FIGURES, &text, err);
    if (status == BF_OK)
        status = x->media->format == MEDIA_CSV
                     ? key_figures_csv(text.bytes, text.n, &x->response->body, err)
                     : buffer_append(&x->response->body, text.bytes, text.n);
    buffer_fini(&text);
    return status;
}

bf_status handlers_results_photo_eyes(exchange *x, bf_error *err)
{
    results_changes changes = { 0 };
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-eyes-%s", record.revision, x->media->word))
        return BF_OK;
    status = results_changes_read(x->services, record.id, &changes, err);
    if (status != BF_OK)
        return status;
    status = x->media->format == MEDIA_CSV
                 ? results_changes_csv(&changes, &x->response->body, err)
                 : results_changes_json(&changes, &x->response->body, err);
    results_changes_fini(&changes);
    return status;
}

// The parameters of a picture.
typedef struct picture_query {
    uint64_t width; // pixels; 0: chosen by picture_layout()
    double top;
    const colormap *map;
} picture_query;

bf_status handlers_results_snapshots(exchange *x, bf_error *err)
{
    api_snapshot_list list = { 0 };
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    exchange__cache_revalidate(x);
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

// Only pictures have a width, a scale and colours.
static bf_status refuse_picture_query(const exchange *x, bf_error *err)
{
    static const char *const names[] = { "width", "colormap", "max" };

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (exchange__text(x, names[i]) != NULL)
            return bf_fail(err, BF_EINPUT, "", "query parameter '%s' is for png, not for %s",
                           names[i], x->media->word);
    }
    return BF_OK;
}

static bf_status read_picture_query(const exchange *x, picture_query *ret_wanted, bf_error *err)
{
    const char *map = exchange__text(x, "colormap");

    if (x->media->format != MEDIA_PNG)
        return refuse_picture_query(x, err);
    *ret_wanted = (picture_query){ .width = exchange__whole(x, "width"),
                                   .top = exchange__real(x, "max"),
                                   .map = map == NULL ? colormap_first() : colormap_find(map) };
    return BF_OK;
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
        return exchange__refuse(x, 406, "", err,
                                "%zu cells are too many for text (limit %d); use npy or vti",
                                grid_cells(grid), TEXT_CELLS_MAX);
    return x->media->format == MEDIA_CSV ? results_snapshot_csv(rho, grid, body, err)
                                         : results_snapshot_json(rho, grid, snapshot, body, err);
}

// What an answer takes while it is made: the numbers as they are stored, and their form.
static bf_status reserve(const exchange *x, double n_bytes, bf_error *err)
{
    const bool is_text = x->media->format == MEDIA_CSV || x->media->format == MEDIA_JSON;

    return exchange__reserve(x, n_bytes * (is_text ? 6.0 : 2.0), err);
}

// True if an answer of so many bytes of numbers is sent piece by piece. What a client wants encoded is sent whole.
static bool is_sent_in_pieces(const exchange *x, uint64_t n_bytes)
{
    const bool is_array = x->media->format == MEDIA_NPY || x->media->format == MEDIA_VTI;
    const char *accepted = exchange__header(x, "Accept-Encoding");

    return is_array && n_bytes > WHOLE_BYTES_MAX &&
           negotiation_coding_quality(accepted, CODING_IDENTITY) > 0;
}

// Sends the file, which it takes over. Of parts with feeds the number is not known before, so it may be a small one.
static bf_status send_array(exchange *x, array_file *file, bf_error *err)
{
    bf_status status = BF_OK;

    if (array_file_size(file) > WHOLE_BYTES_MAX)
        return array_file_send(file, &x->response->source, err);
    while (status == BF_OK && x->response->body.n < array_file_size(file))
        status = array_file_read(file, x->services, x->response->body.n, WHOLE_BYTES_MAX,
                                 &x->response->body, err);
    array_file_fini(file);
    return status;
}

static bf_status send_snapshot(exchange *x, const char *id, uint64_t index, bf_error *err)
{
    array_file file = { .item_size = 0 };

    bf_status status = x->media->format == MEDIA_NPY
                           ? array_file_open_npy(x->services, id, index, &file, err)
                           : array_file_open_vti(x->services, id, index, &file, err);
    return status == BF_OK ? send_array(x, &file, err) : status;
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

bf_status handlers_results_snapshot(exchange *x, bf_error *err)
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
    exchange__cache_immutable(x);
    if (has_it_already(x, record.id, index, &wanted))
        return BF_OK;
    exchange__name_snapshot(x, index);
    if (is_sent_in_pieces(x, grid_cells(&record.grid) * sizeof(float)))
        return send_snapshot(x, record.id, index, err);
    status = reserve(x, (double)grid_cells(&record.grid) * sizeof(float), err);
    return status == BF_OK ? write_snapshot(x, record.id, index, &wanted, err) : status;
}

static bf_status write_rows(exchange *x, const api_parts *parts, const api_snapshot *snapshot,
                            const double *rows, bf_error *err)
{
    bf_buffer *body = &x->response->body;

    if (x->media->format == MEDIA_NPY)
        return results_parts_npy(rows, parts, body, err);
    if (x->media->format == MEDIA_VTP)
        return results_parts_vtp(rows, parts, snapshot->t, body, err);
    if (parts->n_parts * parts->n_values > TEXT_VALUES_MAX)
        return exchange__refuse(x, 406, "", err,
                                "%" PRIu64 " parts of %" PRIu32 " values are too many for text "
                                "(limit %d values); use npy or vtp",
                                parts->n_parts, parts->n_values, TEXT_VALUES_MAX);
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

    bf_status status = array_file_open_parts_npy(x->services, id, index, &file, err);
    if (status == BF_OK && !has_parts_already(x, id, index))
        status = send_array(x, &file, err);
    array_file_fini(&file);
    return status;
}

static bf_status write_parts(exchange *x, const char *id, uint64_t index, bf_error *err)
{
    bf_buffer rows = { 0 };
    api_snapshot snapshot;
    api_parts parts;

    bf_status status =
        x->services->read_parts(x->services->context, id, index, &snapshot, &parts, &rows, err);
    if (status == BF_OK && !has_parts_already(x, id, index))
        status = write_rows(x, &parts, &snapshot, (const double *)(const void *)rows.bytes, err);
    buffer_fini(&rows);
    return status;
}

bf_status handlers_results_parts(exchange *x, bf_error *err)
{
    uint64_t index = 0;
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status == BF_OK)
        status = exchange__find_snapshot(x, &record, &index, err);
    if (status != BF_OK)
        return status;
    const bool has_ids = frame_has_ids(record.parts.n_values);
    const uint64_t n = record.parts.n_parts * record.parts.n_values * sizeof(double);
    if (is_sent_in_pieces(x, has_ids ? UINT64_MAX : n))
        return send_parts(x, record.id, index, err);
    status = reserve(x, (double)n, err);
    return status == BF_OK ? write_parts(x, record.id, index, err) : status;
}

bf_status handlers_results_parts_series(exchange *x, bf_error *err)
{
    api_snapshot_list list = { 0 };
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    if (record.model != RUN_MICRO)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no parts: its model is %s",
                       run_model_words[record.model]);
    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-parts-%s", record.revision, x->media->word))
        return BF_OK;
    status = x->services->list_snapshots(x->services->context, record.id, &list, err);
    if (status != BF_OK)
        return status;
    status = results_series_pvd(&list, RESULTS_FILES_PARTS_VTK, &x->response->body, err);
    buffer_fini(&list.items);
    return status;
}

bf_status handlers_results_archive(exchange *x, bf_error *err)
{
    bool has_vtk = exchange__whole(x, "vtk") == 1;
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    if (!run_state_is_end(record.state))
        return bf_fail(err, BF_ECONFLICT, "", "the run is %s: results.zip comes at its end",
                       run_state_word(record.state));
    exchange__cache_immutable(x);
    if (exchange__is_unchanged(x, "%s-%" PRId64 "-zip%s", record.id, record.finished_ms,
                               has_vtk ? "-vtk" : ""))
        return BF_OK;
    api_response_header(x->response, "Content-Disposition", "attachment; filename=\"%s.zip\"",
                        record.id);
    return results_archive_open(&record, has_vtk ? RESULTS_ARCHIVE_VTK : RESULTS_ARCHIVE_PLAIN,
                                x->services, &x->response->source, err);
}

// The header counts more: a browser that reconnects sends it, with the URL unchanged.
static bf_status read_last_event(exchange *x, uint64_t *ret_id, bf_error *err)
{
    const char *last = exchange__header(x, "Last-Event-ID");
    uint64_t id = 0;

    if (last == NULL || *last == '\0')
        id = exchange__whole(x, "last_event_id");
    else if (param_read_digits(last, &id) != 0)
        return bf_fail(err, BF_EINPUT, "", "Last-Event-ID is no event's id: '%.64s'", last);
    *ret_id = id;
    return BF_OK;
}

static bf_status begin_stream(exchange *x, char (*runs)[API_ID_SIZE], size_t n_runs, bf_error *err)
{
    stream_format format = x->media->format == MEDIA_SSE ? STREAM_SSE : STREAM_NDJSON;
    api_response *response = x->response;
    stream_cursor cursor;
    bool is_inline = exchange__whole(x, "inline") == 1;
    uint64_t after = 0;

    bf_status status = read_last_event(x, &after, err);
    if (status == BF_OK)
        status = stream_begin(x->services, format, is_inline, (const char(*)[API_ID_SIZE])runs,
                              n_runs, after, &cursor, err);
    if (status != BF_OK)
        return status;
    if (cursor.n_open == 0) {
        response->status = 204; // tells a browser not to reconnect
        return BF_OK;
    }
    api_response_header(response, "X-Accel-Buffering", "no");
    return stream_open(&cursor, &response->source, err);
}

bf_status handlers_results_events(exchange *x, bf_error *err)
{
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status == BF_OK)
        status = begin_stream(x, &record.id, 1, err);
    return status;
}

bf_status handlers_results_events_of_runs(exchange *x, bf_error *err)
{
    char runs[API_STREAM_RUNS_MAX][API_ID_SIZE];
    size_t n = exchange__ids(x, "runs", runs);
    bf_status status = BF_OK;
    api_run record;

    for (size_t i = 0; status == BF_OK && i < n; i++)
        status = access_find_run(x, runs[i], &record, err);
    return status == BF_OK ? begin_stream(x, runs, n, err) : status;
}
