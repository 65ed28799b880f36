#include "server/http/range.h"

#include <string.h>
#include <strings.h>

// Reads digits and moves *text behind them; beyond 2^64 - 1 it is that. False: there are none.
static bool read_number(const char **text, uint64_t *ret_number)
{
    const char *p = *text;
    uint64_t number = 0;

    for (; *p >= '0' && *p <= '9'; p++) {
        uint64_t digit = (uint64_t)(*p - '0');
        number = number > (UINT64_MAX - digit) / 10 ? UINT64_MAX : number * 10 + digit;
    }
    if (p == *text)
        return false;
    *text = p;
    *ret_number = number;
    return true;
}

static bool is_end(const char *text)
{
    return text[strspn(text, " \t")] == '\0';
}

// "-500": the last bytes.
static http_range read_suffix(const char *text, uint64_t n, uint64_t *ret_first, uint64_t *ret_n)
{
    uint64_t length = 0;

    if (!read_number(&text, &length) || !is_end(text))
        return HTTP_RANGE_WHOLE;
    if (length == 0 || n == 0)
        return HTTP_RANGE_BEYOND;
    *ret_n = length < n ? length : n;
    *ret_first = n - *ret_n;
    return HTTP_RANGE_PART;
}

http_range http_range_read(const char *header, uint64_t n, uint64_t *ret_first, uint64_t *ret_n)
{
    static const char unit[] = "bytes=";
    uint64_t first = 0, last = UINT64_MAX;

    if (header == NULL || strncasecmp(header, unit, sizeof unit - 1) != 0)
        return HTTP_RANGE_WHOLE;
    const char *text = header + sizeof unit - 1;
    text += strspn(text, " \t");
    if (*text == '-')
        return read_suffix(text + 1, n, ret_first, ret_n);
    if (!read_number(&text, &first) || *text++ != '-')
        return HTTP_RANGE_WHOLE;
    bool has_last = read_number(&text, &last);
    if (!is_end(text) || (has_last && last < first))
        return HTTP_RANGE_WHOLE;
    if (first >= n)
        return HTTP_RANGE_BEYOND;
    *ret_first = first;
    *ret_n = (last < n - 1 ? last : n - 1) - first + 1;
    return HTTP_RANGE_PART;
}

bool http_range_is_current(const char *if_range, const char *etag)
{
    return if_range == NULL || (*etag == '"' && strcmp(if_range, etag) == 0);
}
