#include "api/http/query.h"

#include "core/base/check.h"

#include <stdio.h>
#include <string.h>

static int read_hex(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

int query_read_escape(const char *text)
{
    const int high = read_hex(text[0]);
    const int low = high < 0 ? -1 : read_hex(text[1]);

    return low < 0 ? -1 : high * 16 + low;
}

size_t query_write_escaped(const char *text, const char *kept, char *ret_text, size_t size)
{
    static const char unreserved[] = // RFC 3986, 2.3
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
    size_t n = 0;

    for (; *text != '\0' && n + 4 <= size; text++) {
        if (strchr(unreserved, *text) != NULL || strchr(kept, *text) != NULL)
            ret_text[n++] = *text;
        else
            n += (size_t)snprintf(ret_text + n, size - n, "%%%02X", (unsigned char)*text);
    }
    ret_text[n] = '\0';
    return n;
}

// The byte at *text, decoded, with *text moved past it; -1 if it is broken or a control byte.
static int read_byte(const char **text)
{
    int c = (unsigned char)**text;

    if (c == '%') {
        c = query_read_escape(*text + 1);
        if (c < 0)
            return -1;
        *text += 2;
    } else if (c == '+') {
        c = ' ';
    }
    (*text)++;
    return c < ' ' || c == 0x7f ? -1 : c;
}

// Decodes up to one of the stops (or the end) into q->text at *n; false if a byte is refused.
static bool decode_until(query *q, const char **text, const char *stops, size_t *n)
{
    while (**text != '\0' && strchr(stops, **text) == NULL) {
        int c = read_byte(text);
        if (c < 0)
            return false;
        q->text[(*n)++] = (char)c;
    }
    q->text[(*n)++] = '\0';
    return true;
}

static bf_status add_param(query *q, size_t name, size_t value, bf_error *err)
{
    if (q->text[name] == '\0')
        return bf_fail(err, BF_EINPUT, "", "a query parameter has no name");
    if (query_value(q, q->text + name) != NULL)
        return bf_fail(err, BF_EINPUT, "", "query parameter '%.64s' is given twice",
                       q->text + name);
    if (q->n == QUERY_PARAMS_MAX)
        return bf_fail(err, BF_ELIMIT, "", "the query has more than %d parameters",
                       QUERY_PARAMS_MAX);
    q->params[q->n++] = (query_param){ (uint16_t)name, (uint16_t)value };
    return BF_OK;
}

static bf_status parse(const char *text, query *q, bf_error *err)
{
    size_t n = 0;

    while (*text != '\0') {
        if (*text == '&') {
            text++;
            continue;
        }
        size_t name = n;
        if (!decode_until(q, &text, "=&", &n))
            return bf_fail(err, BF_EINPUT, "",
                           "the query has a broken %%XX or a control byte in a name");
        size_t value = n - 1;
        if (*text == '=') {
            text++;
            value = n;
            if (!decode_until(q, &text, "&", &n))
                return bf_fail(err, BF_EINPUT, "",
                               "query parameter '%.64s' has a broken %%XX or a control byte",
                               q->text + name);
        }
        BF_TRY(add_param(q, name, value, err));
    }
    return BF_OK;
}

bf_status query_parse(const char *text, query *ret_query, bf_error *err)
{
    query q = { 0 };

    // A pair never decodes to more bytes than it has with its separator, so q.text suffices.
    if (strlen(text) >= QUERY_SIZE - 1)
        return bf_fail(err, BF_ELIMIT, "", "the query is longer than %d bytes", QUERY_SIZE - 2);
    BF_TRY(parse(text, &q, err));
    *ret_query = q;
    return BF_OK;
}

const char *query_value(const query *q, const char *name)
{
    for (size_t i = 0; i < q->n; i++) {
        if (strcmp(q->text + q->params[i].name, name) == 0)
            return q->text + q->params[i].value;
    }
    return NULL;
}

const char *query_take(query *q, const char *name)
{
    for (size_t i = 0; i < q->n; i++) {
        if (strcmp(q->text + q->params[i].name, name) != 0)
            continue;
        const char *value = q->text + q->params[i].value;
        q->n--;
        memmove(&q->params[i], &q->params[i + 1], (q->n - i) * sizeof *q->params);
        return value;
    }
    return NULL;
}

// The row of a parameter that a query can have, or NULL.
static const param *find_row(const param *const *params, const char *name)
{
    for (; *params != NULL; params++) {
        if (strcmp((*params)->in, "query") == 0 && strcmp((*params)->name, name) == 0)
            return *params;
    }
    return NULL;
}

static bf_status refuse_unknown(const param *const *params, const char *name, bf_error *err)
{
    char known[QUERY_KNOWN_SIZE] = "";
    size_t n = 0;

    for (; *params != NULL; params++) {
        if (strcmp((*params)->in, "query") == 0)
            n += (size_t)snprintf(known + n, sizeof known - n, "%s%s", n > 0 ? " " : "",
                                  (*params)->name);
        BF_CHECK(n < sizeof known);
    }
    return bf_fail(err, BF_EINPUT, "", "query parameter '%.64s' is not known here; known: %s", name,
                   *known == '\0' ? "none" : known);
}

bf_status query_check(const query *q, const param *const *params, bf_error *err)
{
    param_value unused;

    for (size_t i = 0; i < q->n; i++) {
        const char *name = q->text + q->params[i].name;
        if (find_row(params, name) == NULL)
            return refuse_unknown(params, name, err);
    }
    for (; *params != NULL; params++) {
        const char *text = query_value(q, (*params)->name);
        if (strcmp((*params)->in, "query") != 0)
            continue;
        if (text == NULL && (*params)->is_required)
            text = "";
        BF_TRY(text == NULL ? BF_OK : param_read(*params, text, &unused, err));
    }
    return BF_OK;
}

bool query_read(const query *q, const param *const *params, const char *name,
                param_value *ret_value)
{
    const param *row = find_row(params, name);
    const char *text = query_value(q, name);

    BF_CHECK(row != NULL);
    if (text == NULL)
        text = row->default_text;
    if (text == NULL)
        return false;
    BF_CHECK(param_read(row, text, ret_value, NULL) == BF_OK);
    return true;
}
