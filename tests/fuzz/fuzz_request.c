// A whole request to the API: "METHOD PATH?QUERY", header lines, an empty line, a body. The daemon has a run of each
// state that matters, events and a measurement; no answer is 500.

#include "tests/fuzz/fuzz.h"

#include "tests/unit/api/helper_ask.h"

#include <stdlib.h>
#include <string.h>

enum { CHUNKS_MAX = 64 };

static void set_up(helper_daemon *d)
{
    *d = (helper_daemon){ 0 };
    helper_run *done = helper_add_run(d, RUN_SUCCEEDED);
    (void)helper_add_run(d, RUN_RUNNING);
    (void)helper_add_run(d, RUN_QUEUED);
    (void)helper_add_event(d, done, API_EVENT_CURVE, "{}");
    (void)helper_add_measurement(d, "upstream");
}

// Make the body as the transport would for a client that takes all of it.
static void pull(helper_daemon *d, const body_source *source)
{
    const api_services services = helper_services(d);
    body_state state = BODY_MORE;
    bf_buffer out = { 0 };
    bf_error err;

    for (int k = 0; k < CHUNKS_MAX && state == BODY_MORE; k++) {
        out.n = 0;
        if (source->next_chunk(source->state, &services, 65536, &out, &state, &err) != BF_OK)
            break;
    }
    buffer_fini(&out);
}

// The first line up to its end, cut into words; "" for what is not there.
static void cut(char *line, char **ret_path, char **ret_query)
{
    char *blank = strchr(line, ' ');

    *ret_path = blank == NULL ? line + strlen(line) : blank + 1;
    if (blank != NULL)
        *blank = '\0';
    char *mark = strchr(*ret_path, '?');
    *ret_query = mark == NULL ? *ret_path + strlen(*ret_path) : mark + 1;
    if (mark != NULL)
        *mark = '\0';
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    static helper_daemon d;
    api_response response = { 0 };
    char *text = fuzz_text(bytes, n), *headers = strchr(text, '\n'), *path, *query;
    char *body = headers == NULL ? NULL : strstr(headers, "\n\n");

    set_up(&d);
    if (body != NULL) {
        *headers++ = '\0';
        body += 2;
        body[-1] = '\0'; // the header lines keep the line feed of the last of them
        if (headers > body - 1)
            headers = NULL;
        cut(text, &path, &query);
        helper_request(&d, text, path, query, headers, body, &response);
        fuzz_require(response.status >= 200 && response.status != 500, "an answer that is no 500");
        if (response.source.next_chunk != NULL)
            pull(&d, &response.source);
        api_response_fini(&response);
    }
    free(text);
    return 0;
}
