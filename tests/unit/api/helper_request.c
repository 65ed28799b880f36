// Requests to the daemon in arrays, and what is in its answers.

#include "tests/unit/api/helper_services.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

// Header lines with the values that were asked for last.
typedef struct header_lines {
    const char *lines;
    size_t n_asked;
    char values[4][256];
} header_lines;

static const char *find_header(void *context, const char *name)
{
    header_lines *h = context;
    size_t n = strlen(name);

    for (const char *line = h->lines; line != NULL && *line != '\0';
         line = strchr(line, '\n') + 1) {
        if (strncasecmp(line, name, n) != 0 || strncmp(line + n, ": ", 2) != 0)
            continue;
        char *value = h->values[h->n_asked++ % 4];
        snprintf(value, sizeof *h->values, "%.*s", (int)strcspn(line + n + 2, "\n"), line + n + 2);
        return value;
    }
    return NULL;
}

void helper_request(helper_daemon *d, const char *method, const char *path, const char *query,
                    const char *headers, const char *body, api_response *response)
{
    api_services services = helper_services(d);
    header_lines lines = { .lines = headers };
    api_request request = { .method = method,
                            .path = path,
                            .query = query == NULL ? "" : query,
                            .header = find_header,
                            .header_context = &lines,
                            .body = body,
                            .n_body = body == NULL ? 0 : strlen(body) };

    api_handle(&services, &request, response);
}

const char *helper_header(const api_response *response, const char *name)
{
    for (size_t i = 0; i < response->n_headers; i++) {
        if (strcasecmp(response->headers[i].name, name) == 0)
            return response->headers[i].value;
    }
    return NULL;
}

json_t *helper_json(const api_response *response)
{
    json_error_t error;

    assert_non_null(response->body.bytes);
    json_t *root =
        json_loadb(response->body.bytes, response->body.n, JSON_REJECT_DUPLICATES, &error);
    if (root == NULL)
        fail_msg("%s in %s", error.text, response->body.bytes);
    return root;
}
