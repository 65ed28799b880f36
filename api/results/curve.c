#include "api/results/results.h"

#include "api/json/json_out.h"
#include "api/json/number.h"
#include "api/json/text.h"
#include "api/results/results_priv.h"
#include "core/base/check.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

bf_status results__finish(bf_status status, bf_buffer *out, size_t n, bf_error *err)
{
    if (status == BF_OK)
        return BF_OK;
    buffer_truncate(out, n);
    return bf_fail_memory(err);
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

static void write_columns(json_out *w, const member *m, const void *item)
{
    const results__samples *samples = item;
    const char *names = samples->columns;
    char name[COLUMN_NAME_SIZE];

    (void)m;
    json_out_object(w);
    for (size_t c = 0; c < samples->n_columns; c++) {
        bool has_name = api_next_column(&names, name);
        BF_CHECK(has_name);
        json_out_key(w, name);
        json_out_numbers(w, samples->values + c, samples->n, samples->n_columns);
    }
    BF_CHECK(names == NULL || *names == '\0');
    json_out_object_end(w);
}

static const member_kind member_columns = { .type = "#CurveColumns", .write = write_columns };

#define AT(place) offsetof(results__samples, place)
static const member curve_members[] = {
    MEMBER("t_s", numbers, AT(t), "Times of the samples", .unit = "s", .offset_n = AT(n)),
    MEMBER("columns", columns, 0, "Their values"),
};
const member_table results_curve_members = { MEMBER_TABLE("Curve", curve_members) };
#undef AT

const member_table results_columns_members = { .title = "CurveColumns" };

bf_status results_curve_json(const api_curve *curve, bf_buffer *out, bf_error *err)
{
    const results__samples samples = { .columns = curve->columns.bytes,
                                       .t = doubles_of(&curve->t),
                                       .values = doubles_of(&curve->values),
                                       .n = curve->n,
                                       .n_columns = curve->n_columns };
    size_t n_before = out->n;
    json_out w = json_out_to(out);

    members_write(&w, &results_curve_members, &samples);
    return results__finish(json_out_status(&w, err), out, n_before, err);
}

static text_piece trim(text_piece p)
{
    while (p.n > 0 && isspace((unsigned char)*p.at)) {
        p.at++;
        p.n--;
    }
    while (p.n > 0 && isspace((unsigned char)p.at[p.n - 1]))
        p.n--;
    return p;
}

// The place of the wanted column in the header, 0 if it has none. Column 0 is the time.
static size_t find_column(text_piece header, const char *id)
{
    size_t column = 0;
    text_piece rest = header;

    if (!text_is(trim(text_take_until(&rest, ',')), "t_s"))
        return 0;
    while (rest.n > 0) {
        text_piece name = trim(text_take_until(&rest, ','));
        column++;
        if (id == NULL || text_is(name, id))
            return column;
    }
    return 0;
}

static const char *pointer_to(size_t line, char ret_pointer[BF_POINTER_SIZE])
{
    snprintf(ret_pointer, BF_POINTER_SIZE, "/line/%zu", line);
    return ret_pointer;
}

// column is that of the counts, among n_columns.
static bf_status read_row(text_piece row, size_t column, size_t n_columns, size_t line,
                          bf_buffer *t, bf_buffer *parts, bf_error *err)
{
    char pointer[BF_POINTER_SIZE];
    const size_t n_cells = text_count_pieces(row, ',');
    double time, count;

    if (n_cells != n_columns)
        return bf_fail(err, BF_EINPUT, pointer_to(line, pointer),
                       "has %zu fields, the header has %zu", n_cells, n_columns);
    text_piece cell = trim(text_take_until(&row, ','));
    if (number_read(cell.at, cell.n, &time) != 0)
        return bf_fail(err, BF_EINPUT, pointer_to(line, pointer), "the time is not a number");
    for (size_t k = 0; k < column; k++)
        cell = trim(text_take_until(&row, ','));
    if (number_read(cell.at, cell.n, &count) != 0)
        return bf_fail(err, BF_EINPUT, pointer_to(line, pointer), "column %zu is not a number",
                       column + 1);
    if (buffer_append(t, &time, sizeof time) != BF_OK ||
        buffer_append(parts, &count, sizeof count) != BF_OK)
        return bf_fail_memory(err);
    return BF_OK;
}

// The text as a piece, without the mark that some programs put before UTF-8.
static text_piece begin_text(const char *text, size_t n)
{
    static const char mark[] = "\xef\xbb\xbf";
    size_t n_mark = sizeof mark - 1;

    if (n >= n_mark && memcmp(text, mark, n_mark) == 0)
        return (text_piece){ text + n_mark, n - n_mark };
    return (text_piece){ text == NULL ? "" : text, n };
}

bf_status results_read_curve_column(const char *text, size_t n, char *ret_name, bf_error *err)
{
    text_piece rest = begin_text(text, n);
    text_piece header = trim(text_take_until(&rest, '\n'));

    text_piece time = trim(text_take_until(&header, ','));
    text_piece name = trim(text_take_until(&header, ','));
    if (!text_is(time, "t_s") || name.n == 0 || name.n >= SCENE_ID_SIZE)
        return bf_fail(err, BF_EINPUT, "/line/1", "must be \"t_s,count\" or \"t_s,<counter>\"");
    memcpy(ret_name, name.at, name.n);
    ret_name[name.n] = '\0';
    return BF_OK;
}

bf_status results_read_curve_csv(const char *text, size_t n, const char *id, bf_buffer *t,
                                 bf_buffer *parts, bf_buffer *lines, bf_error *err)
{
    text_piece rest = begin_text(text, n);
    size_t n_t = t->n, n_parts = parts->n, n_lines = lines == NULL ? 0 : lines->n;
    bf_status status = BF_OK;

    text_piece header = trim(text_take_until(&rest, '\n'));
    size_t column = find_column(header, id), n_columns = text_count_pieces(header, ',');
    if (column == 0)
        return bf_fail(err, BF_EINPUT, "/line/1", "must be \"t_s,%.*s\" or have more columns",
                       SCENE_ID_SIZE, id == NULL ? "<id>" : id);
    for (size_t line = 2; rest.n > 0 && status == BF_OK; line++) {
        text_piece row = trim(text_take_until(&rest, '\n'));
        if (row.n == 0)
            continue;
        status = read_row(row, column, n_columns, line, t, parts, err);
        if (status == BF_OK && lines != NULL && buffer_append(lines, &line, sizeof line) != BF_OK)
            status = bf_fail_memory(err);
    }
    if (status != BF_OK) {
        buffer_truncate(t, n_t);
        buffer_truncate(parts, n_parts);
        if (lines != NULL)
            buffer_truncate(lines, n_lines);
    }
    return status;
}
