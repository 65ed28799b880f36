#include "api/access.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const struct {
    api_scope scope;
    const char *word;
} rows[] = {
#define X(scope, flag, word) { scope, word },
    API_SCOPE_LIST(X)
#undef X
};

enum { N_ROWS = sizeof rows / sizeof *rows };

const char *api_access_word(api_scope scope)
{
    for (size_t i = 0; i < N_ROWS; i++) {
        if (rows[i].scope == scope)
            return rows[i].word;
    }
    return scope == API_SCOPE_ANY ? "any" : "none";
}

static unsigned find_scope(const char *word, size_t n)
{
    for (size_t i = 0; i < N_ROWS; i++) {
        if (strlen(rows[i].word) == n && memcmp(rows[i].word, word, n) == 0)
            return rows[i].scope;
    }
    return API_SCOPE_NONE;
}

bool api_access_read_scopes(const char *text, unsigned *ret_scopes)
{
    unsigned scopes = 0;

    for (;;) {
        size_t n = strcspn(text, ",");
        unsigned found = find_scope(text, n);
        if (found == API_SCOPE_NONE)
            return false;
        scopes |= found;
        if (text[n] == '\0')
            break;
        text += n + 1;
    }
    *ret_scopes = scopes;
    return true;
}

const char *api_access_write_scopes(unsigned scopes, char *ret_text)
{
    size_t n = 0;

    ret_text[0] = '\0';
    for (size_t i = 0; i < N_ROWS; i++) {
        if ((scopes & rows[i].scope) != 0)
            n += (size_t)snprintf(ret_text + n, API_SCOPES_SIZE - n, "%s%s", n == 0 ? "" : ",",
                                  rows[i].word);
    }
    return ret_text;
}

bool api_access_includes(unsigned scopes, api_scope needed)
{
    const unsigned also = needed == API_SCOPE_METRICS ? API_SCOPE_READ : API_SCOPE_NONE;

    return needed == API_SCOPE_NONE || (scopes & (needed | also | API_SCOPE_ADMIN)) != 0;
}
