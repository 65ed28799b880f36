#include "api/results/results.h"

#include "api/results/results_priv.h"

#include <endian.h>
#include <stdio.h>

// Magic and version, length of the rest of the header, and the description that ends in a newline
// and pads all of it to a multiple of 64 bytes (NumPy's format 1.0).
bf_status results__npy_head(const char *type, size_t n1, size_t n2, bf_buffer *out)
{
    enum { START = 10, MULTIPLE = 64 };
    char description[160];
    int n =
        snprintf(description, sizeof description,
                 "{'descr': '%s', 'fortran_order': False, 'shape': (%zu, %zu), }", type, n2, n1);
    int padding = MULTIPLE - (START + n + 1) % MULTIPLE;

    padding %= MULTIPLE;
    int length = n + padding + 1;
    const char start[START] = {
        '\x93', 'N', 'U', 'M', 'P', 'Y', 1, 0, (char)(length & 0xff), (char)(length >> 8)
    };
    BF_TRY(buffer_append(out, start, sizeof start));
    return buffer_printf(out, "%s%*s\n", description, padding, "");
}

void results__order_bytes(char *bytes, size_t n, size_t size)
{
    for (size_t k = 0; BYTE_ORDER == BIG_ENDIAN && k < n; k++, bytes += size) {
        for (size_t from = 0, to = size - 1; from < to; from++, to--) {
            char byte = bytes[from];
            bytes[from] = bytes[to];
            bytes[to] = byte;
        }
    }
}

bf_status results__append_values(const void *values, size_t n, size_t size, bf_buffer *out)
{
    size_t n_before = out->n;

    BF_TRY(buffer_append(out, values, n * size));
    results__order_bytes(out->bytes + n_before, n, size);
    return BF_OK;
}

bf_status results_npy_head(size_t n1, size_t n2, bf_buffer *out, bf_error *err)
{
    const size_t n_before = out->n;

    return results__finish(results__npy_head("<f4", n1, n2, out), out, n_before, err);
}

bf_status results_parts_npy_head(const api_parts *parts, bf_buffer *out, bf_error *err)
{
    const size_t n_before = out->n;

    return results__finish(results__npy_head("<f8", parts->n_values, (size_t)parts->n_parts, out),
                           out, n_before, err);
}

bf_status results_npy(const float *rho, size_t n1, size_t n2, bf_buffer *out, bf_error *err)
{
    size_t n_before = out->n;

    bf_status status = results__npy_head("<f4", n1, n2, out);
    if (status == BF_OK)
        status = results__append_values(rho, n1 * n2, sizeof *rho, out);
    return results__finish(status, out, n_before, err);
}

bf_status results_parts_npy(const double *rows, const api_parts *parts, bf_buffer *out,
                            bf_error *err)
{
    size_t n_before = out->n;
    size_t n = (size_t)parts->n_parts * parts->n_values;

    bf_status status = results__npy_head("<f8", parts->n_values, (size_t)parts->n_parts, out);
    if (status == BF_OK)
        status = results__append_values(rows, n, sizeof *rows, out);
    return results__finish(status, out, n_before, err);
}
