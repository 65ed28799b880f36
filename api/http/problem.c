#include "api/http/problem.h"

#include "api/json/json_out.h"
#include "core/base/check.h"

#include <stdio.h>
#include <string.h>

enum { RETRY_AFTER_S = 5 }; // for what is full or stopping at the moment

static const problem_kind kinds[] = {
#define X(status, word, title, headers, codes, when) { status, word, title, headers, codes, when },
    PROBLEM_LIST(X)
#undef X
};

enum { N_KINDS = sizeof kinds / sizeof *kinds };

const problem_kind *problem_kinds(size_t *ret_n)
{
    *ret_n = N_KINDS;
    return kinds;
}

static const problem_kind *find_kind(int status)
{
    size_t i = 0;

    while (i < N_KINDS && kinds[i].status != status)
        i++;
    BF_CHECK(i < N_KINDS);
    return &kinds[i];
}

int problem_status(bf_status code)
{
    for (size_t i = 0; i < N_KINDS; i++) {
        if ((kinds[i].codes & PROBLEM_OF(code)) != 0)
            return kinds[i].status;
    }
    return 500;
}

// A decoded path is made a URI reference again.
static void encode_path(const char *path, char *ret_text, size_t size)
{
    static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                "0123456789-._~/:@!$&'()*+,;=";
    size_t n = 0;

    for (; *path != '\0' && n + 4 <= size; path++) {
        if (strchr(plain, *path) != NULL)
            ret_text[n++] = *path;
        else
            n += (size_t)snprintf(ret_text + n, size - n, "%%%02X", (unsigned char)*path);
    }
    ret_text[n] = '\0';
}

static void write_item(json_out *w, const bf_error *item)
{
    json_out_object(w);
    json_out_key_string(w, "pointer", item->pointer);
    json_out_key_string(w, "detail", item->text);
    json_out_object_end(w);
}

static void write_errors(json_out *w, const bf_error *error, const bf_faults *faults)
{
    size_t n = faults == NULL ? 0 : faults_kept(faults);

    if (n == 0 && error->pointer[0] == '\0')
        return;
    json_out_key(w, "errors");
    json_out_array(w);
    if (n == 0)
        write_item(w, error);
    for (size_t i = 0; i < n; i++)
        write_item(w, &faults->items[i]);
    json_out_array_end(w);
}

static void write_detail(json_out *w, const bf_error *error, const bf_faults *faults)
{
    char text[BF_POINTER_SIZE + BF_TEXT_SIZE + 40];
    const char *gap = error->pointer[0] == '\0' ? "" : ": ";

    if (faults == NULL || faults->n < 2)
        snprintf(text, sizeof text, "%s%s%s", error->pointer, gap, error->text);
    else
        snprintf(text, sizeof text, "%s%s%s (and %zu more)", error->pointer, gap, error->text,
                 faults->n - 1);
    json_out_key_string(w, "detail", text);
}

void problem_write(api_response *response, int status, const char *instance, const bf_error *error,
                   const bf_faults *faults)
{
    const problem_kind *kind = find_kind(status);
    char text[API_PATH_MAX];

    api_response_fini(response);
    response->status = status;
    if (strcmp(kind->headers, "Retry-After") == 0)
        api_response_header(response, "Retry-After", "%d", RETRY_AFTER_S);
    api_response_header(response, "Cache-Control", "no-store");
    json_out w = json_out_to(&response->body);
    json_out_object(&w);
    snprintf(text, sizeof text, "/problems/%s", kind->word);
    json_out_key_string(&w, "type", text);
    json_out_key_string(&w, "title", kind->title);
    json_out_key_integer(&w, "status", status);
    write_detail(&w, error, faults);
    encode_path(instance, text, sizeof text);
    json_out_key_string(&w, "instance", text);
    write_errors(&w, error, faults);
    json_out_object_end(&w);
    if (json_out_status(&w, NULL) == BF_OK)
        api_response_header(response, "Content-Type", "application/problem+json");
    else
        buffer_fini(&response->body); // without memory the status alone
}

void api_problem(api_response *response, int status, const char *instance, const bf_error *error)
{
    problem_write(response, status, instance, error, NULL);
}

void api_problem_identify(api_response *response, const char *request_id)
{
    static const char type[] = "application/problem+json";
    const char *is = api_response_find(response, "Content-Type");
    bf_buffer *body = &response->body;
    size_t n = body->n;

    if (is == NULL || strcmp(is, type) != 0 || n == 0 || body->bytes[n - 1] != '}')
        return;
    buffer_truncate(body, n - 1);
    json_out w = json_out_to(body);
    w.needs_comma = true;
    json_out_key_string(&w, "request_id", request_id);
    json_out_object_end(&w);
    if (json_out_status(&w, NULL) == BF_OK)
        return;
    // Room for the bracket that stood there before needs no memory.
    buffer_truncate(body, n - 1);
    BF_CHECK(buffer_append(body, "}", 1) == BF_OK);
}
