#include "api/results.h"

#include "api/json_out.h"
#include "api/number.h"

#include <endian.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// Ends a function that appends: on failure *out is again as it was, n bytes long.
static bf_status finish(bf_status status, bf_buffer *out, size_t n, bf_error *err)
{
    if (status == BF_OK)
        return BF_OK;
    buffer_truncate(out, n);
    return bf_fail(err, status, "", "out of memory");
}

bf_status results_curve_csv_header(const char *columns, bf_buffer *out, bf_error *err)
{
    return finish(buffer_printf(out, "t_s,%s\n", columns), out, out->n, err);
}

// Writes the number and a separator at text; returns where the next one goes.
static char *put_number(char *text, double value, char separator)
{
    text += isfinite(value) ? number_format(value, text) : snprintf(text, NUMBER_SIZE, "nan");
    *text++ = separator;
    return text;
}

bf_status results_curve_csv_rows(const double *t, const double *values, size_t n, size_t n_columns,
                                 bf_buffer *out, bf_error *err)
{
    size_t n_before = out->n;

    for (size_t k = 0; k < n; k++) {
        char *from = buffer_reserve(out, (n_columns + 1) * NUMBER_SIZE);
        if (from == NULL)
            return finish(BF_ENOMEM, out, n_before, err);
        char *at = put_number(from, t[k], n_columns == 0 ? '\n' : ',');
        for (size_t c = 0; c < n_columns; c++)
            at = put_number(at, values[k * n_columns + c], c + 1 == n_columns ? '\n' : ',');
        *at = '\0';
        out->n += (size_t)(at - from);
    }
    return BF_OK;
}

static void write_column(json_out *w, const double *values, size_t n, size_t stride)
{
    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        json_out_number(w, values[k * stride]);
    json_out_array_end(w);
}

static const double *doubles_of(const bf_buffer *b)
{
    return (const double *)(const void *)b->bytes;
}

bf_status results_curve_json(const api_curve *curve, bf_buffer *out, bf_error *err)
{
    const char *name = curve->columns.bytes;
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    json_out_object(&w);
    json_out_key(&w, "t_s");
    write_column(&w, doubles_of(&curve->t), curve->n, 1);
    for (size_t c = 0; c < curve->n_columns; c++) {
        char key[SCENE_ID_SIZE];
        size_t n = strcspn(name, ",");
        snprintf(key, sizeof key, "%.*s", (int)n, name);
        name += n + (name[n] == ',');
        json_out_key(&w, key);
        write_column(&w, doubles_of(&curve->values) + c, curve->n, curve->n_columns);
    }
    json_out_object_end(&w);
    return finish(json_out_status(&w, err), out, n_before, err);
}

// Magic and version, length of the rest of the header, and the description that ends in a newline
// and pads all of it to a multiple of 64 bytes (NumPy's format 1.0).
static bf_status append_npy_header(size_t n1, size_t n2, bf_buffer *out)
{
    enum { START = 10, MULTIPLE = 64 };
    char description[160];
    int n = snprintf(description, sizeof description,
                     "{'descr': '<f4', 'fortran_order': False, 'shape': (%zu, %zu), }", n2, n1);
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

    if (append_npy_header(n1, n2, out) != BF_OK)
        return finish(BF_ENOMEM, out, n_before, err);
    char *at = buffer_reserve(out, n * sizeof *rho);
    if (at == NULL)
        return finish(BF_ENOMEM, out, n_before, err);
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

static void write_grid(json_out *w, const bf_grid *grid)
{
    json_out_object(w);
    json_out_key_pair(w, "origin_m", grid->lower1, grid->lower2);
    json_out_key_pair(w, "cell_m", grid->d1, grid->d2);
    json_out_key(w, "shape");
    json_out_array(w);
    json_out_integer(w, (int64_t)grid->n2);
    json_out_integer(w, (int64_t)grid->n1);
    json_out_array_end(w);
    json_out_object_end(w);
}

static void write_place(json_out *w, uint64_t index, const char *url_prefix)
{
    char text[512];

    if (url_prefix == NULL)
        snprintf(text, sizeof text, "snapshots/%06" PRIu64 ".npy", index);
    else
        snprintf(text, sizeof text, "%s%" PRIu64, url_prefix, index);
    json_out_key_string(w, url_prefix == NULL ? "file" : "url", text);
}

bf_status results_snapshots_json(const bf_grid *grid, const api_snapshot *items, size_t n,
                                 const char *url_prefix, bf_buffer *out, bf_error *err)
{
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    json_out_object(&w);
    json_out_key(&w, "grid");
    write_grid(&w, grid);
    json_out_key(&w, "snapshots");
    json_out_array(&w);
    for (size_t k = 0; k < n; k++) {
        json_out_object(&w);
        json_out_key_integer(&w, "n", (int64_t)items[k].index);
        json_out_key_number(&w, "t_s", items[k].t);
        write_place(&w, items[k].index, url_prefix);
        json_out_key_number(&w, "peak", items[k].peak);
        json_out_key_number(&w, "mass", items[k].mass);
        json_out_object_end(&w);
    }
    json_out_array_end(&w);
    json_out_object_end(&w);
    return finish(json_out_status(&w, err), out, n_before, err);
}

bf_status results_compare_json(const compare_measures *m, bf_buffer *out, bf_error *err)
{
    const struct {
        const char *key;
        double value;
    } members[] = {
        { "t_start_s", m->t_start },
        { "t_end_s", m->t_end },
        { "l1", m->l1 },
        { "l2", m->l2 },
        { "largest", m->largest },
        { "largest_at_s", m->largest_at },
        { "drain_time_a_s", m->drain_time_a },
        { "drain_time_b_s", m->drain_time_b },
        { "rate_a_per_s", m->rate_a },
        { "rate_b_per_s", m->rate_b },
    };
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    json_out_object(&w);
    for (size_t k = 0; k < sizeof members / sizeof *members; k++)
        json_out_key_number(&w, members[k].key, members[k].value);
    json_out_object_end(&w);
    return finish(json_out_status(&w, err), out, n_before, err);
}
