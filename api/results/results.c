#include "api/results/results.h"

#include "api/json/json_out.h"
#include "api/json/number.h"
#include "api/results/results_files.h"
#include "api/results/results_priv.h"
#include "core/base/check.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

bf_status results__finish(bf_status status, bf_buffer *out, size_t n, bf_error *err)
{
    if (status == BF_OK)
        return BF_OK;
    buffer_truncate(out, n);
    return bf_fail(err, status, "", "out of memory");
}

bf_status results_curve_csv_header(const char *columns, bf_buffer *out, bf_error *err)
{
    return results__finish(buffer_printf(out, "t_s,%s\n", columns), out, out->n, err);
}

char *results__put_number(char *text, double value, char separator)
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
            return results__finish(BF_ENOMEM, out, n_before, err);
        char *at = results__put_number(from, t[k], n_columns == 0 ? '\n' : ',');
        for (size_t c = 0; c < n_columns; c++)
            at =
                results__put_number(at, values[k * n_columns + c], c + 1 == n_columns ? '\n' : ',');
        *at = '\0';
        out->n += (size_t)(at - from);
    }
    return BF_OK;
}

static const double *doubles_of(const bf_buffer *b)
{
    return (const double *)(const void *)b->bytes;
}

bf_status results_curve_csv(const api_curve *curve, bf_buffer *out, bf_error *err)
{
    const char *columns = curve->columns.bytes == NULL ? "" : curve->columns.bytes;
    size_t n_before = out->n;

    bf_status status = results_curve_csv_header(columns, out, err);
    if (status == BF_OK)
        status = results_curve_csv_rows(doubles_of(&curve->t), doubles_of(&curve->values), curve->n,
                                        curve->n_columns, out, err);
    return results__finish(status, out, n_before, err);
}

bf_status results_curve_json(const api_curve *curve, bf_buffer *out, bf_error *err)
{
    const char *names = curve->columns.bytes;
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    json_out_object(&w);
    json_out_key(&w, "t_s");
    json_out_numbers(&w, doubles_of(&curve->t), curve->n, 1);
    for (size_t c = 0; c < curve->n_columns; c++) {
        char key[SCENE_ID_SIZE];
        bool has_name = api_take_column(&names, key);
        BF_CHECK(has_name);
        json_out_key(&w, key);
        json_out_numbers(&w, doubles_of(&curve->values) + c, curve->n, curve->n_columns);
    }
    json_out_object_end(&w);
    return results__finish(json_out_status(&w, err), out, n_before, err);
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

// Where a result of a snapshot is in a directory, or below the run.
static void write_file(json_out *w, const char *key, results_files file, uint64_t index)
{
    char name[RESULTS_FILES_NAME_SIZE];

    (void)results_files_name(file, index, name);
    json_out_key_string(w, key, name);
}

static void write_url(json_out *w, const char *key, const char *run_url, const char *folder,
                      uint64_t index)
{
    char url[512];

    snprintf(url, sizeof url, "%s/%s/%" PRIu64, run_url, folder, index);
    json_out_key_string(w, key, url);
}

static void write_parts(json_out *w, const api_parts *parts)
{
    const char *const *columns = results_parts_columns(parts->n_values);

    json_out_key(w, "parts");
    json_out_object(w);
    json_out_key_integer(w, "rows", (int64_t)parts->n_parts);
    json_out_key(w, "columns");
    json_out_array(w);
    for (uint32_t k = 0; k < parts->n_values; k++)
        json_out_string(w, columns[k]);
    json_out_array_end(w);
    json_out_object_end(w);
}

static void write_snapshot(json_out *w, const api_snapshot *item, bool has_parts,
                           const char *run_url)
{
    json_out_object(w);
    json_out_key_integer(w, "n", (int64_t)item->index);
    json_out_key_number(w, "t_s", item->t);
    if (run_url == NULL)
        write_file(w, "file", RESULTS_FILES_SNAPSHOT, item->index);
    else
        write_url(w, "url", run_url, "snapshots", item->index);
    json_out_key_number(w, "peak", item->peak);
    json_out_key_number(w, "mass", item->mass);
    if (has_parts && run_url == NULL)
        write_file(w, "parts_file", RESULTS_FILES_PARTS, item->index);
    else if (has_parts)
        write_url(w, "parts_url", run_url, "parts", item->index);
    json_out_object_end(w);
}

bf_status results_snapshots_json(const api_snapshot_list *list, const char *run_url, bf_buffer *out,
                                 bf_error *err)
{
    const api_snapshot *items = (const api_snapshot *)(const void *)list->items.bytes;
    bool has_parts = list->parts.n_values > 0;
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    json_out_object(&w);
    json_out_key(&w, "grid");
    write_grid(&w, &list->grid);
    if (has_parts)
        write_parts(&w, &list->parts);
    json_out_key(&w, "snapshots");
    json_out_array(&w);
    for (size_t k = 0; k < list->n; k++)
        write_snapshot(&w, &items[k], has_parts, run_url);
    json_out_array_end(&w);
    json_out_object_end(&w);
    return results__finish(json_out_status(&w, err), out, n_before, err);
}
