// Where a client wants to go on: Last-Event-ID and last_event_id of an event stream, cursor of both lists. What is
// accepted leads to exactly what lies behind it, everything else is a 400.

#include "tests/fuzz/fuzz.h"

#include "tests/unit/api/helper_ask.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    N_RUNS = 3,
    N_EVENTS = 12,    // of the first run; the last one is its end
    VALUE_MAX = 200,  // bytes, so that the header and the encoded query have room for it
    CHUNK_BYTES = 64, // about one event
    CHUNKS_MAX = 1000,
};

static helper_daemon d;

static void set_up(void)
{
    d = (helper_daemon){ 0 };
    for (int k = 0; k < N_RUNS; k++) {
        (void)helper_add_run(&d, RUN_SUCCEEDED);
        (void)helper_add_measurement(&d, "upstream");
    }
    for (int k = 1; k < N_EVENTS; k++)
        (void)helper_add_event(&d, &d.runs[0], API_EVENT_CURVE, "{}");
    (void)helper_add_event(&d, &d.runs[0], API_EVENT_END, "{}");
}

// The whole body of a stream.
static void pull(const body_source *source, bf_buffer *out)
{
    const api_services services = helper_services(&d);
    body_state state = BODY_MORE;
    bf_error err;

    for (int k = 0; k < CHUNKS_MAX && state == BODY_MORE; k++)
        fuzz_require(source->next_chunk(source->state, &services, CHUNK_BYTES, out, &state, &err) ==
                         BF_OK,
                     "a stream goes on");
    fuzz_require(state == BODY_DONE, "a stream of a run that has ended ends");
}

// An event's id as the C library reads it. False: it is none.
static bool read_event_id(const char *text, uint64_t *ret_id)
{
    errno = 0;
    *ret_id = strtoull(text, NULL, 10);
    return *text != '\0' && text[strspn(text, "0123456789")] == '\0' && errno == 0;
}

// The events behind the one with this id, in their order and nothing else.
static void require_events(const api_response *response, uint64_t after)
{
    bf_buffer got = { 0 }, expected = { 0 };

    if (after >= N_EVENTS) {
        fuzz_require(response->status == 204, "behind the end there is no content");
        return;
    }
    fuzz_require(response->status == 200, "an id of an event is accepted");
    pull(&response->source, &got);
    for (uint64_t id = after + 1; id <= N_EVENTS; id++)
        fuzz_require(buffer_printf(&expected,
                                   "{\"id\":%" PRIu64 ",\"run\":\"" ID_1
                                   "\",\"event\":\"%s\",\"data\":{}}\n",
                                   id, id == N_EVENTS ? "end" : "curve") == BF_OK,
                     "memory for the events");
    fuzz_require(got.n == expected.n && memcmp(got.bytes, expected.bytes, got.n) == 0,
                 "the events behind the id, each once");
    buffer_fini(&got);
    buffer_fini(&expected);
}

static void follow(const char *query, const char *headers, bool is_id, uint64_t id)
{
    api_response response = { 0 };

    helper_request(&d, "GET", RUN_1 "/events", query, headers, NULL, &response);
    if (is_id)
        require_events(&response, id);
    else
        fuzz_require(response.status == 400, "what is no id of an event is refused");
    api_response_fini(&response);
}

// A UUID in lower case: 8, 4, 4, 4 and 12 hexadecimal digits.
static bool is_id(const char *text)
{
    static const size_t groups[] = { 8, 4, 4, 4, 12 };

    for (size_t k = 0; k < sizeof groups / sizeof *groups; k++) {
        if (strspn(text, "0123456789abcdef") != groups[k])
            return false;
        text += groups[k];
        if (*text != (k < 4 ? '-' : '\0'))
            return false;
        text += k < 4;
    }
    return true;
}

static size_t count(const bf_buffer *text, const char *word)
{
    size_t n = 0;

    for (const char *at = text->bytes; (at = strstr(at, word)) != NULL; at++)
        n++;
    return n;
}

// Items with smaller ids, as lists are from the newest to the oldest.
static void list(const char *path, const char *query, const char *cursor, char ids[][API_ID_SIZE])
{
    api_response response = { 0 };
    size_t n = 0;

    helper_request(&d, "GET", path, query, "Accept: application/json\n", NULL, &response);
    fuzz_require(response.status == (is_id(cursor) ? 200 : 400), "a cursor is an id");
    for (int k = 0; k < N_RUNS; k++)
        n += strcmp(ids[k], cursor) < 0;
    if (response.status == 200)
        fuzz_require(count(&response.body, "\"id\":\"") == n, "a page begins behind its cursor");
    api_response_fini(&response);
}

static void list_both(const char *query, const char *cursor)
{
    char runs[N_RUNS][API_ID_SIZE], measurements[N_RUNS][API_ID_SIZE];

    for (int k = 0; k < N_RUNS; k++) {
        memcpy(runs[k], d.runs[k].record.id, API_ID_SIZE);
        memcpy(measurements[k], d.measurements[k].about.id, API_ID_SIZE);
    }
    list("/v1/runs", query, cursor, runs);
    list("/v1/measurements", query, cursor, measurements);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    char encoded[3 * VALUE_MAX + 1] = "", line[VALUE_MAX + 80], query[sizeof encoded + 20];
    char *text = fuzz_text(bytes, n);
    const size_t length = strlen(text);
    uint64_t id = 0;

    set_up();
    const bool is_event = read_event_id(text, &id);
    if (length <= VALUE_MAX) {
        for (size_t k = 0; k < length; k++)
            (void)snprintf(encoded + 3 * k, 4, "%%%02X", (unsigned char)text[k]);
        (void)snprintf(query, sizeof query, "last_event_id=%s", encoded);
        follow(query, "Accept: application/x-ndjson\n", is_event, id);
        (void)snprintf(query, sizeof query, "cursor=%s", encoded);
        list_both(query, text);
    }
    // A header that is empty is as good as none.
    if (length <= VALUE_MAX && strchr(text, '\n') == NULL) {
        (void)snprintf(line, sizeof line, "Accept: application/x-ndjson\nLast-Event-ID: %s\n",
                       text);
        follow("last_event_id=0", line, is_event || length == 0, id);
    }
    free(text);
    return 0;
}
