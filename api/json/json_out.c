#include "api/json/json_out.h"

#include "api/json/moment.h"
#include "api/json/number.h"
#include "api/json/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

json_out json_out_to(bf_buffer *buffer)
{
    return (json_out){ .buffer = buffer };
}

bf_status json_out_status(const json_out *w, bf_error *err)
{
    return w->has_failed ? bf_fail_memory(err) : BF_OK;
}

static void put(json_out *w, const char *bytes, size_t n)
{
    if (!w->has_failed && buffer_append(w->buffer, bytes, n) != BF_OK)
        w->has_failed = true;
}

static void put_comma(json_out *w)
{
    if (w->needs_comma)
        put(w, ",", 1);
}

static void put_value(json_out *w, const char *bytes, size_t n)
{
    put_comma(w);
    put(w, bytes, n);
    w->needs_comma = true;
}

static void put_open(json_out *w, const char *bracket)
{
    put_comma(w);
    put(w, bracket, 1);
    w->needs_comma = false;
}

static void put_close(json_out *w, const char *bracket)
{
    put(w, bracket, 1);
    w->needs_comma = true;
}

static void put_escaped(json_out *w, unsigned char c)
{
    static const char named[] = "\"\"\\\\\bb\ff\nn\rr\tt"; // character, letter, ...
    char text[8];

    for (const char *pair = named; *pair != '\0'; pair += 2) {
        if ((unsigned char)*pair == c) {
            put(w, (const char[]){ '\\', pair[1] }, 2);
            return;
        }
    }
    put(w, text, (size_t)snprintf(text, sizeof text, "\\u%04x", (unsigned)c));
}

// True for ASCII that stands for itself, of which nearly all text is.
static bool is_plain(char c)
{
    return c >= 0x20 && c < 0x7f && c != '"' && c != '\\';
}

static void put_text(json_out *w, const char *text)
{
    const char *from = text;
    const char *at = text;

    put(w, "\"", 1);
    for (;;) {
        while (is_plain(*at))
            at++;
        if (*at == '\0')
            break;
        const size_t n = text_utf8_size(at);
        if (n > 1 || *at == 0x7f) {
            at += n;
            continue;
        }
        put(w, from, (size_t)(at - from));
        if (n == 0)
            put(w, "\xef\xbf\xbd", 3);
        else
            put_escaped(w, (unsigned char)*at);
        from = ++at;
    }
    put(w, from, (size_t)(at - from));
    put(w, "\"", 1);
}

void json_out_object(json_out *w)
{
    put_open(w, "{");
}

void json_out_object_end(json_out *w)
{
    put_close(w, "}");
}

void json_out_array(json_out *w)
{
    put_open(w, "[");
}

void json_out_array_end(json_out *w)
{
    put_close(w, "]");
}

void json_out_key(json_out *w, const char *key)
{
    put_comma(w);
    put_text(w, key);
    put(w, ":", 1);
    w->needs_comma = false;
}

void json_out_string(json_out *w, const char *text)
{
    if (text == NULL) {
        json_out_null(w);
        return;
    }
    put_comma(w);
    put_text(w, text);
    w->needs_comma = true;
}

void json_out_number(json_out *w, double value)
{
    char text[NUMBER_SIZE];

    if (isfinite(value))
        put_value(w, text, (size_t)number_format(value, text));
    else
        json_out_null(w);
}

void json_out_measure(json_out *w, double value)
{
    json_out_number(w, number_round(value));
}

void json_out_integer(json_out *w, int64_t value)
{
    char text[NUMBER_SIZE];

    put_value(w, text, (size_t)snprintf(text, sizeof text, "%" PRId64, value));
}

void json_out_bool(json_out *w, bool value)
{
    put_value(w, value ? "true" : "false", value ? 4 : 5);
}

void json_out_null(json_out *w)
{
    put_value(w, "null", 4);
}

void json_out_raw(json_out *w, const char *json, size_t n)
{
    put_value(w, json, n);
}

void json_out_time(json_out *w, int64_t unix_ms)
{
    char text[MOMENT_SIZE];

    if (!moment_write(unix_ms, text)) {
        json_out_null(w);
        return;
    }
    json_out_string(w, text);
}

void json_out_numbers(json_out *w, const double *values, size_t n, size_t stride)
{
    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        json_out_number(w, values[k * stride]);
    json_out_array_end(w);
}

void json_out_key_string(json_out *w, const char *key, const char *text)
{
    json_out_key(w, key);
    json_out_string(w, text);
}

void json_out_key_number(json_out *w, const char *key, double value)
{
    json_out_key(w, key);
    json_out_number(w, value);
}

void json_out_key_measure(json_out *w, const char *key, double value)
{
    json_out_key(w, key);
    json_out_measure(w, value);
}

void json_out_key_integer(json_out *w, const char *key, int64_t value)
{
    json_out_key(w, key);
    json_out_integer(w, value);
}

void json_out_key_bool(json_out *w, const char *key, bool value)
{
    json_out_key(w, key);
    json_out_bool(w, value);
}
