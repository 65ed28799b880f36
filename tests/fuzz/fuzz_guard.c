// The guard before every request: a request target, a line feed, and the lines of a header, as libmicrohttpd hands them
// over, each name and value ended by a zero byte in the place of ':' and CR.

#include "tests/fuzz/fuzz.h"

#include "api/http/exchange.h"
#include "server/http/guard.h"

#include <stdlib.h>
#include <string.h>

static void guard_lines(char *line)
{
    http_guard guard = { .next = line };
    bf_error err;

    for (char *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        char *colon = memchr(line, ':', (size_t)(end - line));
        if (colon == NULL)
            break;
        *end = '\0';
        if (end > line && end[-1] == '\r')
            end[-1] = '\0';
        *colon = '\0';
        const char *value = colon + 1 + strspn(colon + 1, " \t");
        http_guard_header(&guard, line, strlen(line), value, strlen(value));
    }
    http_guard_end(&guard, line);
    const int status = http_guard_verdict(&guard, "GET", "HTTP/1.1", &err);
    fuzz_require(status == 0 || status == 400 || status == 501, "the status of a refusal");
    fuzz_require(status != 0 || (guard.n_hosts == 1 && guard.n_lengths <= 1),
                 "what passes has one Host and at most one length");
}

static void guard_target(const char *target)
{
    char path[API_PATH_MAX], query[API_PATH_MAX];
    bf_error err;
    size_t n_authority = 0;

    const char *authority = http_guard_authority(target, &n_authority);
    fuzz_require(authority == NULL ||
                     (authority >= target && authority + n_authority <= target + strlen(target)),
                 "an authority is a part of its target");
    if (http_guard_target(target, path, query, &err) == 0)
        fuzz_require(path[0] == '/' || strcmp(path, "*") == 0, "a path begins with a slash");
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    char *text = fuzz_text(bytes, n);
    char *end = strchr(text, '\n');

    if (end != NULL) {
        *end = '\0';
        guard_lines(end + 1);
    }
    guard_target(text);
    free(text);
    return 0;
}
