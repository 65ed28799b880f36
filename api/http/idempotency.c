#include "api/http/idempotency.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static bool is_plain(char c)
{
    return c > ' ' && c <= '~' && strchr("\",;\\", c) == NULL;
}

// Reads a key without quotes. Returns what follows it.
static const char *read_bare(const char *from, char *key, size_t *n)
{
    for (; is_plain(*from) && *n < API_KEY_SIZE; from++)
        key[(*n)++] = *from;
    return from;
}

// Reads a string behind its first quote. Returns what follows it, NULL if it is none.
static const char *read_string(const char *from, char *key, size_t *n)
{
    for (; *from != '"' && *n < API_KEY_SIZE; from++) {
        if (*from == '\\' && (from[1] == '"' || from[1] == '\\'))
            from++;
        else if (*from < ' ' || *from > '~' || *from == '\\')
            return NULL;
        key[(*n)++] = *from;
    }
    return *n < API_KEY_SIZE ? from + 1 : from;
}

bf_status idempotency_read_key(const char *header, char ret_key[API_KEY_SIZE], bf_error *err)
{
    char key[API_KEY_SIZE];
    size_t n = 0;

    if (header == NULL || *header == '\0') {
        ret_key[0] = '\0';
        return BF_OK;
    }
    header += strspn(header, " ");
    const char *rest =
        *header == '"' ? read_string(header + 1, key, &n) : read_bare(header, key, &n);
    if (n == API_KEY_SIZE)
        return bf_fail(err, BF_EINPUT, "", "Idempotency-Key has more than %d bytes",
                       API_KEY_SIZE - 1);
    if (n == 0 || rest == NULL || rest[strspn(rest, " ")] != '\0')
        return bf_fail(err, BF_EINPUT, "",
                       "Idempotency-Key is no key: a string in quotes, or visible characters "
                       "without quotes, commas, semicolons and backslashes");
    memcpy(ret_key, key, n);
    ret_key[n] = '\0';
    return BF_OK;
}
