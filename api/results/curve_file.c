#include "api/results/curve_file.h"

#include "api/results/results.h"
#include "core/base/memory.h"

#include <stdio.h>

enum {
    PIECE_VALUES = 4096,      // numbers that are read at once, or one sample if it has more
    HELD_BYTES = 1024 * 1024, // of the longest sample, as numbers and as text
};

bf_status curve_file_open(const api_services *services, const char *id, uint64_t n,
                          curve_file *ret_file, bf_error *err)
{
    curve_file file = { .n = n };
    api_curve curve = { 0 };

    BF_TRY(services->read_curve(services->store, id, n, 0, &curve, err));
    (void)snprintf(file.id, sizeof file.id, "%s", id);
    file.n_values = n * (curve.n_columns + 1);
    api_curve_fini(&curve);
    *ret_file = file;
    return BF_OK;
}

bool curve_file_is_over(const curve_file *file)
{
    return file->has_header && file->at == file->n;
}

// The lines of a piece, and the header before the first one.
static bf_status write_piece(curve_file *file, const api_curve *curve, bf_buffer *out,
                             bf_error *err)
{
    const double *t = (const double *)(const void *)curve->t.bytes;
    const double *values = (const double *)(const void *)curve->values.bytes;
    const char *columns = curve->columns.bytes == NULL ? "" : curve->columns.bytes;
    bf_status status = BF_OK;

    if (!file->has_header)
        status = results_curve_csv_header(columns, out, err);
    if (status == BF_OK)
        status = results_curve_csv_rows(t, values, curve->n, curve->n_columns, out, err);
    file->has_header = true;
    file->at += curve->n;
    return status;
}

bf_status curve_file_read(curve_file *file, const api_services *services, bf_buffer *out,
                          bf_error *err)
{
    const uint64_t n_left = file->n - file->at;
    const uint64_t n_columns = file->n == 0 ? 1 : file->n_values / file->n;
    const uint64_t n_most = PIECE_VALUES / n_columns < 1 ? 1 : PIECE_VALUES / n_columns;
    api_curve curve = { 0 };

    BF_TRY(services->read_curve(services->store, file->id, file->at,
                                n_left < n_most ? n_left : n_most, &curve, err));
    bf_status status =
        curve.n == 0 && n_left > 0
            ? bf_fail(err, BF_ENOTFOUND, "", "the curve has fewer samples than before")
            : write_piece(file, &curve, out, err);
    api_curve_fini(&curve);
    return status;
}

static bf_status next_chunk(void *state, const api_services *services, size_t limit_bytes,
                            bf_buffer *out, body_state *ret_state, bf_error *err)
{
    curve_file *file = state;
    const size_t n_before = out->n;
    bf_status status = BF_OK;

    while (status == BF_OK && !curve_file_is_over(file) && out->n - n_before < limit_bytes)
        status = curve_file_read(file, services, out, err);
    *ret_state = curve_file_is_over(file) ? BODY_DONE : BODY_MORE;
    return status;
}

bf_status curve_file_send(const curve_file *file, body_source *ret_source, bf_error *err)
{
    curve_file *sent = memory_alloc(1, sizeof *sent);

    if (sent == NULL)
        return bf_fail_memory(err);
    *sent = *file;
    *ret_source = (body_source){
        .state = sent, .next_chunk = next_chunk, .destroy = memory_free, .n_held = HELD_BYTES
    };
    return BF_OK;
}
