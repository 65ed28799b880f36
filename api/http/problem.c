#include "api/http/problem.h"

#include "api/http/query.h"
#include "api/json/json_out.h"
#include "core/base/check.h"

#include <stdio.h>
#include <string.h>

enum { RETRY_AFTER_S = 5 }; // where something is full, or the daemon is stopping

static const problem_kind kinds[] = {
#define X(status, word, title, headers, codes, when, remedy)                                       \
    { status, word, title, headers, codes, when, remedy },
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

static bool has_limit(const void *item)
{
    return ((const bf_error *)item)->has_limit;
}

static bool has_unit(const void *item)
{
    return has_limit(item) && ((const bf_error *)item)->unit != NULL;
}

#define AT(place) offsetof(bf_error, place)
static const member error_members[] = {
    MEMBER("pointer", text, AT(pointer), "The place in the document", .type = "#JsonPointer"),
    MEMBER("detail", text, AT(text), "What is wrong there"),
    MEMBER("value", number, AT(value), "The number, or the number of items, that breaks a limit",
           .applies = has_limit),
    MEMBER("limit", number, AT(limit), "The limit that it breaks", .applies = has_limit),
    MEMBER("unit", string, AT(unit), "Unit of both, where they have one", .applies = has_unit),
};
const member_table problem_error_members = { MEMBER_TABLE("ProblemError", error_members),
                                             .size = sizeof(bf_error) };
#undef AT

// What the description of a kind is written from.
typedef struct description {
    char type[64];
    const char *title;
    int status;
    const char *when;
    const char *remedy;
} description;

#define AT(place) offsetof(description, place)
static const member kind_members[] = {
    MEMBER("type", text, AT(type), "The kind of problem", .type = "#ProblemType"),
    MEMBER("title", string, AT(title), "The kind of problem, for people"),
    MEMBER("status", int, AT(status), "The HTTP status"),
    MEMBER("description", string, AT(when), "When a request meets it"),
    MEMBER("remedy", string, AT(remedy), "What the client can do"),
};
const member_table problem_kind_members = { MEMBER_TABLE("ProblemKind", kind_members) };
#undef AT

bf_status problem_describe(const char *word, bf_buffer *out, bf_error *err)
{
    size_t i = 0;

    while (i < N_KINDS && strcmp(kinds[i].word, word) != 0)
        i++;
    if (i == N_KINDS)
        return bf_fail(err, BF_ENOTFOUND, "", "there is no problem '%s'", word);
    description d = { .title = kinds[i].title,
                      .status = kinds[i].status,
                      .when = kinds[i].when,
                      .remedy = kinds[i].remedy };
    snprintf(d.type, sizeof d.type, "/problems/%s", word);
    json_out w = json_out_to(out);
    members_write(&w, &problem_kind_members, &d);
    return json_out_status(&w, err);
}

// What a problem is written from.
typedef struct problem {
    char type[64];
    const char *title;
    int status;
    char detail[BF_POINTER_SIZE + BF_TEXT_SIZE + 40];
    char instance[API_PATH_MAX];
    const bf_error *errors;
    size_t n_errors;
} problem;

#define AT(place) offsetof(problem, place)
static const member members[] = {
    MEMBER("type", text, AT(type), "The kind of problem", .type = "#ProblemType"),
    MEMBER("title", string, AT(title), "The kind of problem, for people"),
    MEMBER("status", int, AT(status), "The HTTP status"),
    MEMBER("detail", text, AT(detail), "What is wrong with this request, for people"),
    MEMBER("instance", text, AT(instance), "The path of the request", .type = "#Path"),
    // Added by api_problem_identify().
    MEMBER("request_id", described, 0, "Identifier of the request, as in X-Request-Id",
           .type = "string", .flags = MEMBER_OPTIONAL),
    MEMBER("errors", list, AT(errors), "Each fault of a document, up to 64",
           .offset_n = AT(n_errors), .table = &problem_error_members, .flags = MEMBER_OMIT_EMPTY),
};
const member_table problem_members = { MEMBER_TABLE("Problem", members) };
#undef AT

static problem make_problem(int status, const char *instance, const bf_error *error,
                            const bf_faults *faults)
{
    const problem_kind *kind = find_kind(status);
    const char *gap = error->pointer[0] == '\0' ? "" : ": ";
    size_t n = faults == NULL ? 0 : faults_kept(faults);
    problem p = { .title = kind->title,
                  .status = status,
                  .errors = n > 0 ? faults->items : error,
                  .n_errors = n > 0 ? n : error->pointer[0] != '\0' };

    snprintf(p.type, sizeof p.type, "/problems/%s", kind->word);
    (void)query_write_escaped(instance, "/:@!$&'()*+,;=", p.instance, sizeof p.instance);
    if (faults == NULL || faults->n < 2)
        snprintf(p.detail, sizeof p.detail, "%s%s%s", error->pointer, gap, error->text);
    else
        snprintf(p.detail, sizeof p.detail, "%s%s%s (and %zu more)", error->pointer, gap,
                 error->text, faults->n - 1);
    return p;
}

void problem_write(api_response *response, int status, const char *instance, const bf_error *error,
                   const bf_faults *faults)
{
    const problem p = make_problem(status, instance, error, faults);

    api_response_fini(response);
    response->status = status;
    if (strcmp(find_kind(status)->headers, "Retry-After") == 0)
        api_response_header(response, "Retry-After", "%d", RETRY_AFTER_S);
    api_response_header(response, "Cache-Control", "no-store");
    json_out w = json_out_to(&response->body);
    members_write(&w, &problem_members, &p);
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
    // The bracket that was there before needs no more memory.
    buffer_truncate(body, n - 1);
    BF_CHECK(buffer_append(body, "}", 1) == BF_OK);
}
