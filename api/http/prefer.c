#include "api/http/prefer.h"

#include <limits.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

static const char *skip_spaces(const char *text)
{
    return text + strspn(text, " \t");
}

// The end of a preference: the next comma that is not inside a quoted string.
static const char *find_end(const char *text)
{
    bool is_quoted = false;

    for (; *text != '\0' && (is_quoted || *text != ','); text++) {
        if (*text == '"')
            is_quoted = !is_quoted;
        else if (is_quoted && *text == '\\' && text[1] != '\0')
            text++;
    }
    return text;
}

// Reads `= 10` or `="10"` and what may follow, up to end.
static bool read_seconds(const char *text, const char *end, unsigned *ret_seconds)
{
    unsigned long long seconds = 0;

    text = skip_spaces(text);
    if (*text != '=')
        return false;
    text = skip_spaces(text + 1);
    bool is_quoted = *text == '"';
    text += is_quoted;
    const char *digits = text;
    for (; *text >= '0' && *text <= '9'; text++)
        seconds = seconds > UINT_MAX ? seconds : seconds * 10 + (unsigned)(*text - '0');
    bool has_digits = text > digits;
    if (is_quoted && *text++ != '"')
        return false;
    text = skip_spaces(text);
    if (!has_digits || (text != end && *text != ';'))
        return false;
    *ret_seconds = seconds > UINT_MAX ? UINT_MAX : (unsigned)seconds;
    return true;
}

bool prefer_wait(const char *header, unsigned *ret_seconds)
{
    static const char name[] = "wait";
    size_t n = sizeof name - 1;

    for (const char *p = header; p != NULL && *p != '\0';) {
        p += strspn(p, ", \t");
        const char *end = find_end(p);
        bool is_named = strncasecmp(p, name, n) == 0 && strchr(" \t=;,", p[n]) != NULL;
        if (is_named)
            return read_seconds(p + n, end, ret_seconds);
        p = end;
    }
    return false;
}
