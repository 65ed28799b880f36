#include "api/http/query.h"

#include "api/json/number.h"
#include "core/base/check.h"

#include <inttypes.h>
#include <stdbool.h>
#include <string.h>

static int read_hex(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

// The byte at *text, decoded, with *text moved past it; -1 if it is broken or a control byte.
static int read_byte(const char **text)
{
    int c = (unsigned char)**text;

    if (c == '%') {
        int high = read_hex((*text)[1]);
        int low = high < 0 ? -1 : read_hex((*text)[2]);
        if (low < 0)
            return -1;
        c = high * 16 + low;
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
        bf_status status = add_param(q, name, value, err);
        if (status != BF_OK)
            return status;
    }
    return BF_OK;
}

bf_status query_parse(const char *text, query *ret_query, bf_error *err)
{
    query q = { 0 };

    // A pair never decodes to more bytes than it has with its separator, so q.text suffices.
    if (strlen(text) >= QUERY_SIZE - 1)
        return bf_fail(err, BF_ELIMIT, "", "the query is longer than %d bytes", QUERY_SIZE - 2);
    bf_status status = parse(text, &q, err);
    if (status == BF_OK)
        *ret_query = q;
    return status;
}

const char *query_value(const query *q, const char *name)
{
    for (size_t i = 0; i < q->n; i++) {
        if (strcmp(q->text + q->params[i].name, name) == 0)
            return q->text + q->params[i].value;
    }
    return NULL;
}

static bool has_word(const char *words, const char *word)
{
    size_t n = strlen(word);

    while (*words != '\0') {
        size_t length = strcspn(words, " ");
        if (length == n && memcmp(words, word, n) == 0)
            return true;
        words += length;
        words += strspn(words, " ");
    }
    return false;
}

bf_status query_allow(const query *q, const char *known, bf_error *err)
{
    for (size_t i = 0; i < q->n; i++) {
        const char *name = q->text + q->params[i].name;
        if (!has_word(known, name))
            return bf_fail(err, BF_EINPUT, "",
                           "query parameter '%.64s' is not known here; known: %s", name,
                           *known == '\0' ? "none" : known);
    }
    return BF_OK;
}

int query_read_number(const char *text, uint64_t *ret_value)
{
    uint64_t value = 0;

    if (*text == '\0')
        return -1;
    for (; *text != '\0'; text++) {
        if (*text < '0' || *text > '9' || __builtin_mul_overflow(value, 10, &value) ||
            __builtin_add_overflow(value, (uint64_t)(*text - '0'), &value))
            return -1;
    }
    *ret_value = value;
    return 0;
}

bf_status query_number(const query *q, const char *name, uint64_t least, uint64_t most,
                       uint64_t *ret_value, bf_error *err)
{
    const char *text = query_value(q, name);
    uint64_t value = 0;

    BF_CHECK(least <= most);
    if (text == NULL)
        return BF_OK;
    if (query_read_number(text, &value) != 0 || value < least || value > most)
        return bf_fail(err, BF_EINPUT, "",
                       "query parameter '%s' must be a whole number from %" PRIu64 " to %" PRIu64
                       ", not '%.64s'",
                       name, least, most, text);
    *ret_value = value;
    return BF_OK;
}

bf_status query_real(const query *q, const char *name, double least, double most, double *ret_value,
                     bf_error *err)
{
    const char *text = query_value(q, name);
    double value = 0.0;

    BF_CHECK(least <= most);
    if (text == NULL)
        return BF_OK;
    if (number_read(text, strlen(text), &value) != 0 || value < least || value > most)
        return bf_fail(err, BF_EINPUT, "",
                       "query parameter '%s' must be a number from %g to %g, not '%.64s'", name,
                       least, most, text);
    *ret_value = value;
    return BF_OK;
}
