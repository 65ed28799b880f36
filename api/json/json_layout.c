#include "api/json/json_layout.h"

#include <stdbool.h>
#include <string.h>

enum { LINE_WIDTH = 100, INDENT = 2 };

// The text that is laid out, and where it goes.
typedef struct layout {
    const char *at;  // next byte
    const char *end; // after the last one
    bf_buffer *out;
    size_t column; // of the line that is being written
    size_t depth;  // open brackets that were broken over lines
    bool has_failed;
} layout;

static void put(layout *l, const char *bytes, size_t n)
{
    if (!l->has_failed && buffer_append(l->out, bytes, n) != BF_OK)
        l->has_failed = true;
    l->column += n;
}

static void break_line(layout *l)
{
    put(l, "\n", 1);
    l->column = 0;
    for (size_t k = 0; k < l->depth; k++)
        put(l, "  ", INDENT);
}

static void skip_blanks(const char **at, const char *end)
{
    while (*at < end && strchr(" \t\r\n", **at) != NULL)
        (*at)++;
}

// Bytes of the token at text: a string with its quotes, a bracket, a comma, a colon, or a word.
static size_t measure_token(const char *text, const char *end)
{
    const char *at = text + 1;

    if (*text == '"') {
        while (at < end && *at != '"')
            at += *at == '\\' ? 2 : 1;
        return (size_t)(at - text) + 1;
    }
    if (strchr("{}[],:", *text) != NULL)
        return 1;
    while (at < end && strchr("{}[],: \t\r\n", *at) == NULL)
        at++;
    return (size_t)(at - text);
}

// True if what the bracket at l->at opens fits on the rest of the line, with a blank after each
// comma and colon and a comma after its end.
static bool fits(const layout *l)
{
    const char *at = l->at;
    size_t width = l->column + 1;
    size_t depth = 0;

    do {
        size_t n = measure_token(at, l->end);
        depth += *at == '{' || *at == '[';
        depth -= *at == '}' || *at == ']';
        width += n + (*at == ',' || *at == ':');
        at += n;
        skip_blanks(&at, l->end);
    } while (depth > 0 && width <= LINE_WIDTH);
    return width <= LINE_WIDTH;
}

// Writes what a bracket opens, to its end, on one line.
static void put_flat(layout *l)
{
    size_t depth = 0;

    do {
        size_t n = measure_token(l->at, l->end);
        depth += *l->at == '{' || *l->at == '[';
        depth -= *l->at == '}' || *l->at == ']';
        put(l, l->at, n);
        if (*l->at == ',' || *l->at == ':')
            put(l, " ", 1);
        l->at += n;
        skip_blanks(&l->at, l->end);
    } while (depth > 0);
}

static void put_token(layout *l)
{
    size_t n = measure_token(l->at, l->end);
    char first = *l->at;
    bool is_open = first == '{' || first == '[';

    if (is_open && fits(l)) {
        put_flat(l);
        return;
    }
    if (first == '}' || first == ']') {
        l->depth--;
        break_line(l);
    }
    put(l, l->at, n);
    l->at += n;
    l->depth += is_open;
    if (is_open || first == ',')
        break_line(l);
    else if (first == ':')
        put(l, " ", 1);
}

bf_status json_layout(const char *json, size_t n, bf_buffer *out, bf_error *err)
{
    layout l = { .at = json, .end = json + n, .out = out };
    size_t n_before = out->n;

    for (skip_blanks(&l.at, l.end); l.at < l.end && !l.has_failed; skip_blanks(&l.at, l.end))
        put_token(&l);
    put(&l, "\n", 1);
    if (!l.has_failed)
        return BF_OK;
    buffer_truncate(out, n_before);
    return bf_fail_memory(err);
}
