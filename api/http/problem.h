/// Problem documents (RFC 9457): the table of kinds, and the writer.

#pragma once

#include "api/http/exchange.h"
#include "api/json/members.h"
#include "core/base/faults.h"

/// X(HTTP status, last segment of the problem's type, title, headers that come with it, bf_status that it
/// stands for, when it is given, what to do), by rising status. The API answers with no other problem.
#define PROBLEM_LIST(X)                                                                            \
    X(400, "bad-request", "Bad Request", "", PROBLEM_OF(BF_EINPUT) | PROBLEM_OF(BF_ELIMIT),        \
      "The request is not well formed, or has a parameter that is not known",                      \
      "Correct the request; `detail` names the parameter or the place. Sent again as it is it is " \
      "refused again")                                                                             \
    X(401, "unauthorized", "Unauthorized", "WWW-Authenticate", 0,                                  \
      "The service wants an access token, and the request has none that is valid",                 \
      "Send `Authorization: Bearer` with a token (`beltflowd token add` makes one), or a new "     \
      "ticket: a ticket counts for a minute")                                                      \
    X(403, "forbidden", "Forbidden", "", 0,                                                        \
      "A browser sent the request for a page of another site, which the service does not allow, "  \
      "or the access token lacks the scope that this needs",                                       \
      "Take a token with the scope that `detail` names. For pages of other origins set "           \
      "`cors_origins`")                                                                            \
    X(404, "not-found", "Not Found", "", PROBLEM_OF(BF_ENOTFOUND), "There is no such resource",    \
      "Look at the id: what was removed, and what belongs to another owner, is not there either. " \
      "Lists show what there is")                                                                  \
    X(405, "method-not-allowed", "Method Not Allowed", "Allow", 0,                                 \
      "The path does not know this method", "`Allow` lists the methods of the path")               \
    X(406, "not-acceptable", "Not Acceptable", "", 0, "The resource has no such format",           \
      "Ask for a format that the operation has, by `format` or `Accept`")                          \
    X(409, "conflict", "Conflict", "", PROBLEM_OF(BF_ECONFLICT),                                   \
      "The request does not fit the present state",                                                \
      "Read the resource again: its `status` says why. A summary, for example, is there when the " \
      "run has ended, and what has ended cannot be cancelled")                                     \
    X(412, "precondition-failed", "Precondition Failed", "", 0,                                    \
      "The resource is not in the state that If-Match or If-None-Match asks for; nothing was "     \
      "done",                                                                                      \
      "Read the resource again, decide anew, and send its new ETag")                               \
    X(413, "content-too-large", "Content Too Large", "", 0, "The body is too large",               \
      "Send less; the limit is the setting `body_bytes`. Long lists can be stored as "             \
      "measurements and named by their id")                                                        \
    X(414, "uri-too-long", "URI Too Long", "", 0, "Path or query are too long",                    \
      "Shorten the query; follow many runs in several streams")                                    \
    X(415, "unsupported-media-type", "Unsupported Media Type", "", 0,                              \
      "The body has a media type that is not accepted, or none",                                   \
      "Send `Content-Type: application/json`, or another type that the operation has")             \
    X(416, "range-not-satisfiable", "Range Not Satisfiable", "Content-Range", 0,                   \
      "The range begins after the end",                                                            \
      "Ask for a range within the length that `Content-Range` says, or for the whole")             \
    X(421, "misdirected-request", "Misdirected Request", "", 0,                                    \
      "Host names none of the hosts that the service answers under",                               \
      "Use a name that the setting `hosts` lists, or the address that the service listens on")     \
    X(422, "bad-document", "Unprocessable Content", "", 0,                                         \
      "The document is JSON but at fault; `errors` has the places",                                \
      "Correct every place in `errors`: `pointer` is its place in the body (RFC 6901). `POST "     \
      "/v1/validate` checks without submitting")                                                   \
    X(429, "too-many-requests", "Too Many Requests", "Retry-After", 0,                             \
      "The client has used up a quota",                                                            \
      "Wait for `Retry-After` seconds, then try again; `RateLimit` and `GET /v1/quota` say what "  \
      "is left")                                                                                   \
    X(500, "internal-error", "Internal Server Error", "", 0,                                       \
      "The service failed; its log has the cause",                                                 \
      "Look into the service's log for the request's `X-Request-Id`. What was accepted before is " \
      "not lost")                                                                                  \
    X(501, "not-implemented", "Not Implemented", "", 0,                                            \
      "There is no such method or transfer coding",                                                \
      "Use a method and a transfer coding that HTTP clients use by themselves")                    \
    X(503, "unavailable", "Service Unavailable", "Retry-After",                                    \
      PROBLEM_OF(BF_ENOMEM) | PROBLEM_OF(BF_EBUSY),                                                \
      "Overloaded or stopping; another try can help later",                                        \
      "Try again after `Retry-After` seconds, with the same `Idempotency-Key` so that nothing is " \
      "done twice")                                                                                \
    X(507, "insufficient-storage", "Insufficient Storage", "Retry-After", PROBLEM_OF(BF_ENOSPACE), \
      "The disk has too little room left, or the owner of the access token has used up the quota " \
      "of bytes; nothing was changed",                                                             \
      "Remove runs and measurements that are not needed any more, or give the disk or the quota "  \
      "more room; `GET /v1/quota` says what is used")

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
    const char *remedy;  ///< what the client can do
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
