#include "server/http/guard.h"

#include "api/http/exchange.h"
#include "api/http/query.h"
#include "server/http/mhd/framing.h"

#include <string.h>
#include <strings.h>

static bool is_token(const char *text, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!http_framing_is_token(text[i]))
            return false;
    }
    return n > 0;
}

static bool has_control_byte(const char *text, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (http_framing_is_control(text[i]))
            return true;
    }
    return false;
}

static bool is_name(const char *name, size_t n_name, const char *wanted)
{
    return n_name == strlen(wanted) && strncasecmp(name, wanted, n_name) == 0;
}

static void check_place(http_guard *g, const char *place)
{
    if (g->fault == NULL && g->next != NULL && place != g->next)
        g->fault = "a line is folded, has a zero byte, or does not end in CR and LF";
}

void http_guard_header(http_guard *g, const char *name, size_t n_name, const char *value,
                       size_t n_value)
{
    check_place(g, name);
    if (g->next != NULL)
        g->next = value + n_value + 2;
    if (g->fault == NULL && !is_token(name, n_name))
        g->fault = "a header's name is not a token";
    if (g->fault == NULL && has_control_byte(value, n_value))
        g->fault = "a header's value has a control byte";
    if (is_name(name, n_name, "Host"))
        g->n_hosts++;
    if (is_name(name, n_name, "Content-Length"))
        g->n_lengths++;
    if (is_name(name, n_name, "Transfer-Encoding")) {
        g->n_encodings++;
        g->is_chunked = is_name(value, n_value, "chunked");
    }
}

void http_guard_end(http_guard *g, const char *end)
{
    check_place(g, end - 2);
}

static const char *find_fault(const http_guard *g, const char *method, bool is_1_0)
{
    if (!is_token(method, strlen(method)))
        return "the method is not a token";
    if (g->fault != NULL)
        return g->fault;
    if (g->n_hosts > 1)
        return "there is more than one Host header";
    if (g->n_hosts == 0 && !is_1_0)
        return "the Host header is missing";
    if (g->n_lengths > 1)
        return "there is more than one Content-Length header";
    if (g->n_encodings > 1)
        return "there is more than one Transfer-Encoding header";
    if (g->n_encodings > 0 && g->n_lengths > 0)
        return "Content-Length and Transfer-Encoding stand together";
    if (g->n_encodings > 0 && is_1_0)
        return "HTTP/1.0 has no Transfer-Encoding";
    return NULL;
}

int http_guard_verdict(const http_guard *g, const char *method, const char *version, bf_error *err)
{
    const char *fault = find_fault(g, method, strcmp(version, "HTTP/1.0") == 0);

    if (fault != NULL) {
        (void)bf_fail(err, BF_EINPUT, "", "%s", fault);
        return 400;
    }
    if (g->n_encodings > 0 && !g->is_chunked) {
        (void)bf_fail(err, BF_EINPUT, "", "the only Transfer-Encoding known here is chunked");
        return 501;
    }
    return 0;
}

const char *http_guard_authority(const char *target, size_t *ret_n)
{
    const char *authority = strncasecmp(target, "http://", 7) == 0    ? target + 7
                            : strncasecmp(target, "https://", 8) == 0 ? target + 8
                                                                      : NULL;
    if (authority != NULL)
        *ret_n = strcspn(authority, "/?");
    return authority;
}

// Decodes n bytes into *ret_path, which has room for them. NULL, or what is wrong.
static const char *decode_path(const char *text, size_t n, char *ret_path)
{
    size_t n_path = 0;

    for (size_t i = 0; i < n; i++) {
        int byte = (unsigned char)text[i];
        if (byte == '%') {
            byte = i + 2 < n ? query_read_escape(text + i + 1) : -1;
            if (byte < 0)
                return "a percent sign in the path is not followed by two hexadecimal digits";
            i += 2;
        }
        if (byte < 0x20 || byte == 0x7f)
            return "the path has a control byte";
        ret_path[n_path++] = (char)byte;
    }
    ret_path[n_path] = '\0';
    return NULL;
}

static bool has_byte_outside_ascii(const char *text)
{
    for (; *text != '\0'; text++) {
        unsigned char c = (unsigned char)*text;
        if (c <= 0x20 || c >= 0x7f)
            return true;
    }
    return false;
}

int http_guard_target(const char *target, char *ret_path, char *ret_query, bf_error *err)
{
    size_t n_authority = 0; // of a target in absolute form
    const char *authority = http_guard_authority(target, &n_authority);
    const char *path =
        authority != NULL && authority[n_authority] == '/' ? authority + n_authority : target;
    size_t n_path = strcspn(path, "?");
    const char *query_text = path[n_path] == '?' ? path + n_path + 1 : "";
    char decoded[API_PATH_MAX];
    const char *fault = NULL;

    if (n_path >= API_PATH_MAX || strlen(query_text) >= API_PATH_MAX) {
        (void)bf_fail(err, BF_ELIMIT, "", "path and query are limited to %d bytes each",
                      API_PATH_MAX - 1);
        return 414;
    }
    if (*path != '/' && strcmp(path, "*") != 0)
        fault = "the request's target is not a path";
    else if (has_byte_outside_ascii(path))
        fault = "the request's target has a byte that must be percent-encoded";
    else
        fault = decode_path(path, n_path, decoded);
    if (fault != NULL) {
        (void)bf_fail(err, BF_EINPUT, "", "%s", fault);
        return 400;
    }
    memcpy(ret_path, decoded, strlen(decoded) + 1);
    memcpy(ret_query, query_text, strlen(query_text) + 1);
    return 0;
}
