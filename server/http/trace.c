#include "server/http/trace.h"

#include "server/base/run_id.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>

// The fields of `00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01`.
enum { TRACE_AT = 3, N_TRACE = 32, SPAN_AT = 36, N_SPAN = 16, FLAGS_AT = 53, N_FLAGS = 2 };

static _Atomic uint64_t n_made;

static bool is_sane(const char *id)
{
    size_t n =
        strspn(id, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.:~+/=@");
    return n > 0 && n < HTTP_TRACE_ID_SIZE && id[n] == '\0';
}

// A span that is not zero.
static uint64_t make_span(void)
{
    uint64_t span = 0;

    if (getrandom(&span, sizeof span, 0) != (ssize_t)sizeof span || span == 0)
        span = atomic_fetch_add(&n_made, 1) + 1;
    return span;
}

static bool is_hex(const char *text, size_t n)
{
    return strspn(text, "0123456789abcdef") >= n;
}

static bool is_zero(const char *text, size_t n)
{
    return strspn(text, "0") >= n;
}

// Later versions may have more behind the flags.
static bool is_parent(const char *text)
{
    if (strnlen(text, HTTP_TRACE_PARENT_SIZE) < HTTP_TRACE_PARENT_SIZE - 1)
        return false;
    char next = text[HTTP_TRACE_PARENT_SIZE - 1];
    bool is_first_version = memcmp(text, "00", 2) == 0;
    return is_hex(text, 2) && memcmp(text, "ff", 2) != 0 && text[TRACE_AT - 1] == '-' &&
           is_hex(text + TRACE_AT, N_TRACE) && !is_zero(text + TRACE_AT, N_TRACE) &&
           text[SPAN_AT - 1] == '-' && is_hex(text + SPAN_AT, N_SPAN) &&
           !is_zero(text + SPAN_AT, N_SPAN) && text[FLAGS_AT - 1] == '-' &&
           is_hex(text + FLAGS_AT, N_FLAGS) && (next == '\0' || (next == '-' && !is_first_version));
}

http_trace http_trace_read(const char *request_id, const char *traceparent)
{
    http_trace trace = { .parent = "" };

    if (request_id != NULL && is_sane(request_id))
        memcpy(trace.id, request_id, strlen(request_id) + 1);
    else {
        char id[API_ID_SIZE];
        if (run_id_make(id, NULL) == BF_OK)
            memcpy(trace.id, id, sizeof id);
        else
            (void)snprintf(trace.id, HTTP_TRACE_ID_SIZE, "%" PRIu64,
                           atomic_fetch_add(&n_made, 1) + 1);
    }
    if (traceparent != NULL && is_parent(traceparent))
        (void)snprintf(trace.parent, sizeof trace.parent, "00-%.*s-%016" PRIx64 "-%.*s", N_TRACE,
                       traceparent + TRACE_AT, make_span(), N_FLAGS, traceparent + FLAGS_AT);
    return trace;
}
