#include "server/worker/http_call.h"

#include "core/base/memory.h"

#include <curl/curl.h>
#include <stdio.h>
#include <string.h>

enum {
    CONNECT_S = 10,
    SILENT_S = 30, // without a byte: the exchange has failed
    URL_SIZE = 1024,
    PATH_SIZE = 128,
    HEADER_SIZE = 512,
    FDS_MAX = 4,
};

struct http_call {
    CURLM *multi;
    CURL *easy;
    struct curl_slist *headers;
    char url[URL_SIZE]; // without a slash at its end
    char authorization[HEADER_SIZE];
    char ca_file[URL_SIZE];
    char error[CURL_ERROR_SIZE];
    bf_buffer body;
    size_t n_most;
    bool goes_on;
};

static size_t take_bytes(char *bytes, size_t size, size_t n, void *context)
{
    http_call *c = context;

    if (size * n > c->n_most - c->body.n || buffer_append(&c->body, bytes, size * n) != BF_OK)
        return CURL_WRITEFUNC_ERROR;
    return size * n;
}

static bf_status copy_options(http_call *c, const http_call_options *o, bf_error *err)
{
    size_t n = strlen(o->url);

    while (n > 0 && o->url[n - 1] == '/')
        n--;
    if (n >= sizeof c->url)
        return bf_fail(err, BF_EINPUT, "", "the URL is too long");
    if (strncmp(o->url, "http://", 7) != 0 && strncmp(o->url, "https://", 8) != 0)
        return bf_fail(err, BF_EINPUT, "", "the URL must begin with http:// or https://");
    memcpy(c->url, o->url, n);
    if (o->ca_file != NULL && strlen(o->ca_file) >= sizeof c->ca_file)
        return bf_fail(err, BF_EINPUT, "", "the path of the CA certificates is too long");
    snprintf(c->ca_file, sizeof c->ca_file, "%s", o->ca_file == NULL ? "" : o->ca_file);
    n = (size_t)snprintf(c->authorization, sizeof c->authorization, "Authorization: Bearer %s",
                         o->token);
    if (n >= sizeof c->authorization)
        return bf_fail(err, BF_EINPUT, "", "the token is too long");
    if (o->token[0] == '\0')
        c->authorization[0] = '\0';
    return BF_OK;
}

bf_status http_call_create(const http_call_options *options, http_call **ret_call, bf_error *err)
{
    http_call *c = memory_alloc(1, sizeof *c);

    if (c == NULL || curl_global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK) {
        memory_free(c);
        return bf_fail(err, BF_ENOMEM, "", "no memory to speak HTTP");
    }
    c->multi = curl_multi_init();
    c->easy = curl_easy_init();
    bf_status status = c->multi == NULL || c->easy == NULL
                           ? bf_fail(err, BF_ENOMEM, "", "no memory to speak HTTP")
                           : copy_options(c, options, err);
    if (status == BF_OK)
        *ret_call = c;
    else
        http_call_destroy(c);
    return status;
}

static void end_exchange(http_call *c)
{
    if (c->goes_on)
        curl_multi_remove_handle(c->multi, c->easy);
    c->goes_on = false;
}

http_call *http_call_destroy(http_call *c)
{
    if (c == NULL)
        return NULL;
    end_exchange(c);
    curl_easy_cleanup(c->easy);
    curl_multi_cleanup(c->multi);
    curl_slist_free_all(c->headers);
    buffer_fini(&c->body);
    explicit_bzero(c->authorization, sizeof c->authorization);
    memory_free(c);
    curl_global_cleanup();
    return NULL;
}

static bool add_header(http_call *c, const char *line)
{
    struct curl_slist *longer = curl_slist_append(c->headers, line);

    if (longer == NULL)
        return false;
    c->headers = longer;
    return true;
}

static bool make_headers(http_call *c, const http_call_request *request)
{
    char type[HEADER_SIZE];

    curl_slist_free_all(c->headers);
    c->headers = NULL;
    if (request->type != NULL) {
        snprintf(type, sizeof type, "Content-Type: %s", request->type);
        if (!add_header(c, type))
            return false;
    }
    // An empty Expect keeps curl from waiting for a 100 before each body.
    return add_header(c, "Expect:") &&
           (c->authorization[0] == '\0' || add_header(c, c->authorization));
}

bf_status http_call_begin(http_call *c, const http_call_request *request, bf_error *err)
{
    c->body.n = 0;
    c->n_most = request->n_most;
    c->error[0] = '\0';
    if (!make_headers(c, request))
        return bf_fail(err, BF_ENOMEM, "", "no memory for a request");
    char url[URL_SIZE + PATH_SIZE];
    snprintf(url, sizeof url, "%s%s", c->url, request->path);
    curl_easy_reset(c->easy); // the connection stays
    curl_easy_setopt(c->easy, CURLOPT_URL, url);
    curl_easy_setopt(c->easy, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(c->easy, CURLOPT_HTTPHEADER, c->headers);
    curl_easy_setopt(c->easy, CURLOPT_ERRORBUFFER, c->error);
    curl_easy_setopt(c->easy, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(c->easy, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
    curl_easy_setopt(c->easy, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(c->easy, CURLOPT_LOW_SPEED_TIME, (long)SILENT_S);
    curl_easy_setopt(c->easy, CURLOPT_WRITEFUNCTION, take_bytes);
    curl_easy_setopt(c->easy, CURLOPT_WRITEDATA, c);
    curl_easy_setopt(c->easy, CURLOPT_USERAGENT, "beltflow/" BELTFLOW_VERSION);
    if (c->ca_file[0] != '\0')
        curl_easy_setopt(c->easy, CURLOPT_CAINFO, c->ca_file);
    if (request->type != NULL) {
        curl_easy_setopt(c->easy, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)request->n_body);
        curl_easy_setopt(c->easy, CURLOPT_POSTFIELDS, request->body);
    }
    curl_easy_setopt(c->easy, CURLOPT_CUSTOMREQUEST, request->method);
    if (curl_multi_add_handle(c->multi, c->easy) != CURLM_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a request");
    c->goes_on = true;
    return BF_OK;
}

static http_call_answer find_answer(http_call *c)
{
    http_call_answer answer = { .body = &c->body, .error = c->error };
    int n_left = 0;
    const CURLMsg *message = curl_multi_info_read(c->multi, &n_left);

    if (message == NULL || message->msg != CURLMSG_DONE)
        return answer;
    const CURLcode code = message->data.result;
    if (code == CURLE_OK)
        curl_easy_getinfo(c->easy, CURLINFO_RESPONSE_CODE, &answer.status);
    else if (c->error[0] == '\0')
        snprintf(c->error, sizeof c->error, "%s", curl_easy_strerror(code));
    answer.has_ended = true;
    end_exchange(c);
    return answer;
}

http_call_answer http_call_wait(http_call *c, const int *fds, size_t n_fds, int timeout_ms)
{
    struct curl_waitfd waits[FDS_MAX] = { { .fd = 0 } };
    int n = 0;

    if (c->goes_on) // sends what can be sent at once
        curl_multi_perform(c->multi, &n);
    for (size_t k = 0; k < n_fds && k < FDS_MAX; k++)
        waits[k] = (struct curl_waitfd){ .fd = fds[k], .events = CURL_WAIT_POLLIN };
    if (!c->goes_on || n > 0)
        curl_multi_poll(c->multi, waits, (unsigned)n_fds, timeout_ms, NULL);
    if (c->goes_on)
        curl_multi_perform(c->multi, &n);
    return c->goes_on ? find_answer(c) : (http_call_answer){ .has_ended = false };
}
