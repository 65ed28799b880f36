/// Problem documents (RFC 9457): the table of kinds, and the writer.

#pragma once

#include "api/http/exchange.h"
#include "api/json/members.h"
#include "core/base/faults.h"

/// X(HTTP status, last segment of the problem's type, title, headers that come with it, bf_status that it
/// stands for, when it is given), by rising status. The API answers with no other problem.
#define PROBLEM_LIST(X)                                                                            \
    X(400, "bad-request", "Bad Request", "", PROBLEM_OF(BF_EINPUT) | PROBLEM_OF(BF_ELIMIT),        \
      "The request is not well formed, or has a parameter that is not known")                      \
    X(401, "unauthorized", "Unauthorized", "WWW-Authenticate", 0,                                  \
      "The service wants an access token, and the request has none that is valid")                 \
    X(403, "forbidden", "Forbidden", "", 0,                                                        \
      "A browser sent the request for a page of another site, which the service does not allow, "  \
      "or the access token lacks the scope that this needs")                                       \
    X(404, "not-found", "Not Found", "", PROBLEM_OF(BF_ENOTFOUND), "There is no such resource")    \
    X(405, "method-not-allowed", "Method Not Allowed", "Allow", 0,                                 \
      "The path does not know this method")                                                        \
    X(406, "not-acceptable", "Not Acceptable", "", 0, "The resource has no such format")           \
    X(409, "conflict", "Conflict", "", PROBLEM_OF(BF_ECONFLICT),                                   \
      "The request does not fit the present state")                                                \
    X(412, "precondition-failed", "Precondition Failed", "", 0,                                    \
      "The resource is not in the state that If-Match or If-None-Match asks for; nothing was "     \
      "done")                                                                                      \
    X(413, "content-too-large", "Content Too Large", "", 0, "The body is too large")               \
    X(414, "uri-too-long", "URI Too Long", "", 0, "Path or query are too long")                    \
    X(415, "unsupported-media-type", "Unsupported Media Type", "", 0,                              \
      "The body has a media type that is not accepted, or none")                                   \
    X(416, "range-not-satisfiable", "Range Not Satisfiable", "Content-Range", 0,                   \
      "The range begins after the end")                                                            \
    X(421, "misdirected-request", "Misdirected Request", "", 0,                                    \
      "Host names none of the hosts that the service answers under")                               \
    X(422, "bad-document", "Unprocessable Content", "", 0,                                         \
      "The document is JSON but at fault; `errors` has the places")                                \
    X(429, "too-many-requests", "Too Many Requests", "Retry-After", 0,                             \
      "The client has used up a quota")                                                            \
    X(500, "internal-error", "Internal Server Error", "", 0,                                       \
      "The service failed; its log has the cause")                                                 \
    X(501, "not-implemented", "Not Implemented", "", 0,                                            \
      "There is no such method or transfer coding")                                                \
    X(503, "unavailable", "Service Unavailable", "Retry-After",                                    \
      PROBLEM_OF(BF_ENOMEM) | PROBLEM_OF(BF_EBUSY),                                                \
      "Overloaded or stopping; another try can help later")                                        \
    X(507, "insufficient-storage", "Insufficient Storage", "Retry-After", PROBLEM_OF(BF_ENOSPACE), \
      "The disk has too little room left, or the owner of the access token has used up the quota " \
      "of bytes; nothing was changed")

/// The flag of a bf_status in the table. Those without a row are 500.
#define PROBLEM_OF(code) (1U << (code))

/// A row of the table.
typedef struct problem_kind {
    int status;          ///< HTTP status
    const char *word;    ///< last segment of the problem's type
    const char *title;   ///< of the problem
    const char *headers; ///< that come with it: words
    unsigned codes;      ///< flags of bf_status
    const char *when;    ///< it is given
} problem_kind;

/// The table; *ret_n is how many rows.
const problem_kind *problem_kinds(size_t *ret_n);

/// What GET of a problem's type answers.
extern const member_table problem_kind_members;

/// Append the description of the kind with this word. BF_ENOTFOUND: there is none.
BF_MUST_CHECK bf_status problem_describe(const char *word, bf_buffer *out, bf_error *err);

/// The HTTP status of a failure.
int problem_status(bf_status code);

/// A problem document, and an item of its `errors` (bf_error).
extern const member_table problem_members;
extern const member_table problem_error_members;

/// Make the response a problem document with the errors of faults (NULL: none). A status without a row
/// is a bug.
void problem_write(api_response *response, int status, const char *instance, const bf_error *error,
                   const bf_faults *faults);
