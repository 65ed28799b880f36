#include "api/results.h"

#include "api/results_priv.h"

#include <endian.h>
#include <stdio.h>
#include <string.h>

// Magic and version, length of the rest of the header, and the description that ends in a newline
// and pads all of it to a multiple of 64 bytes (NumPy's format 1.0).
static bf_status append_header(const char *type, size_t n1, size_t n2, bf_buffer *out)
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
    bf_status status = buffer_append(out, start, sizeof start);
    if (status == BF_OK)
        status = buffer_printf(out, "%s%*s\n", description, padding, "");
    return status;
}

bf_status results_npy(const float *rho, size_t n1, size_t n2, bf_buffer *out, bf_error *err)
{
    size_t n_before = out->n;
    size_t n = n1 * n2;

    if (append_header("<f4", n1, n2, out) != BF_OK)
        return results__finish(BF_ENOMEM, out, n_before, err);
    char *at = buffer_reserve(out, n * sizeof *rho);
    if (at == NULL)
        return results__finish(BF_ENOMEM, out, n_before, err);
    for (size_t k = 0; k < n; k++) {
        uint32_t bits;
        memcpy(&bits, &rho[k], sizeof bits);
        bits = htole32(bits);
        memcpy(at + k * sizeof bits, &bits, sizeof bits);
    }
    out->n += n * sizeof *rho;
    out->bytes[out->n] = '\0';
    return BF_OK;
}

bf_status results_parts_npy(const double *rows, const api_parts *parts, bf_buffer *out,
                            bf_error *err)
{
    size_t n_before = out->n;
    size_t n = (size_t)parts->n_parts * parts->n_values;

    if (append_header("<f8", parts->n_values, (size_t)parts->n_parts, out) != BF_OK)
        return results__finish(BF_ENOMEM, out, n_before, err);
    char *at = buffer_reserve(out, n * sizeof *rows);
    if (at == NULL)
        return results__finish(BF_ENOMEM, out, n_before, err);
    for (size_t k = 0; k < n; k++) {
        uint64_t bits;
        memcpy(&bits, &rows[k], sizeof bits);
        bits = htole64(bits);
        memcpy(at + k * sizeof bits, &bits, sizeof bits);
    }
    out->n += n * sizeof *rows;
    out->bytes[out->n] = '\0';
    return BF_OK;
}
