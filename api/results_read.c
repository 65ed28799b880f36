#include "api/results.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

// A piece of the text, not terminated.
typedef struct piece {
    const char *from;
    size_t n;
} piece;

static piece trim(piece p)
{
    while (p.n > 0 && isspace((unsigned char)*p.from)) {
        p.from++;
        p.n--;
    }
    while (p.n > 0 && isspace((unsigned char)p.from[p.n - 1]))
        p.n--;
    return p;
}

// Takes what stands before the separator off the rest; without one, all of it.
static piece take_until(piece *rest, char separator)
{
    const char *end = memchr(rest->from, separator, rest->n);
    piece taken = *rest;

    if (end != NULL) {
        taken.n = (size_t)(end - rest->from);
        rest->from = end + 1;
        rest->n -= taken.n + 1;
    } else {
        *rest = (piece){ rest->from + rest->n, 0 };
    }
    return taken;
}

static bool is_text(piece p, const char *text)
{
    return p.n == strlen(text) && memcmp(p.from, text, p.n) == 0;
}

// The place of the wanted column in the header, 0 if it has none. Column 0 is the time.
static size_t find_column(piece header, const char *id)
{
    size_t column = 0;
    piece rest = header;

    if (!is_text(trim(take_until(&rest, ',')), "t_s"))
        return 0;
    while (rest.n > 0) {
        piece name = trim(take_until(&rest, ','));
        column++;
        if (id == NULL || is_text(name, id))
            return column;
    }
    return 0;
}

// Numbers as CSV has them: no "nan", "inf" or hexadecimal, which strtod() would take.
static bool read_number(piece cell, double *ret_number)
{
    char text[64];
    char *end;

    if (cell.n == 0 || cell.n >= sizeof text)
        return false;
    memcpy(text, cell.from, cell.n);
    text[cell.n] = '\0';
    if (strspn(text, "0123456789+-.eE") != cell.n)
        return false;
    double number = strtod(text, &end);
    if (*end != '\0' || !isfinite(number))
        return false;
    *ret_number = number;
    return true;
}

static bf_status read_row(piece row, size_t column, size_t line, bf_buffer *t, bf_buffer *parts,
                          bf_error *err)
{
    piece cell = trim(take_until(&row, ','));
    double time;
    double count;

    if (!read_number(cell, &time))
        return bf_fail(err, BF_EINPUT, "", "line %zu: the time is not a number", line);
    for (size_t k = 0; k < column; k++)
        cell = trim(take_until(&row, ','));
    if (!read_number(cell, &count))
        return bf_fail(err, BF_EINPUT, "", "line %zu: column %zu is not a number", line,
                       column + 1);
    if (buffer_append(t, &time, sizeof time) != BF_OK ||
        buffer_append(parts, &count, sizeof count) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    return BF_OK;
}

bf_status results_read_curve_csv(const char *text, size_t n, const char *id, bf_buffer *t,
                                 bf_buffer *parts, bf_error *err)
{
    piece rest = { text == NULL ? "" : text, n };
    size_t n_t = t->n;
    size_t n_parts = parts->n;
    bf_status status = BF_OK;

    size_t column = find_column(trim(take_until(&rest, '\n')), id);
    if (column == 0)
        return bf_fail(err, BF_EINPUT, "", "line 1: must be \"t_s,%s\" or have more columns",
                       id == NULL ? "<id>" : id);
    for (size_t line = 2; rest.n > 0 && status == BF_OK; line++) {
        piece row = trim(take_until(&rest, '\n'));
        if (row.n > 0)
            status = read_row(row, column, line, t, parts, err);
    }
    if (status != BF_OK) {
        buffer_truncate(t, n_t);
        buffer_truncate(parts, n_parts);
    }
    return status;
}
