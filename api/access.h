/// Who sent a request and what they may do: scopes of access tokens, and what became of the token or ticket that came
/// with a request. Tokens and tickets themselves are the server's.

#pragma once

#include <stdbool.h>
#include <stdint.h>

enum {
    API_OWNER_SIZE = 65,    ///< bytes of an owner's name with its terminator
    API_SCOPES_SIZE = 48,   ///< bytes of a list of all scopes with its terminator
    API_TOKEN_SIZE = 48,    ///< bytes of a token with its terminator
    API_TICKET_SIZE = 65,   ///< bytes of a ticket with its terminator
    API_RESOURCE_SIZE = 56, ///< bytes of the path of a run or study with its terminator
};

/// What a token allows, X(scope, flag, word). API_SCOPE_ADMIN includes all others; API_SCOPE_READ the figures of API_SCOPE_METRICS
/// that tell nothing of owners. API_SCOPE_GRANTED reads one run or study, that of the identity, and nothing else.
#define API_SCOPE_LIST(X)                                                                          \
    X(API_SCOPE_READ, 1, "read")                                                                   \
    X(API_SCOPE_SUBMIT, 2, "submit")                                                               \
    X(API_SCOPE_WORK, 4, "work")                                                                   \
    X(API_SCOPE_ADMIN, 8, "admin")                                                                 \
    X(API_SCOPE_PRIORITY, 16, "priority")                                                          \
    X(API_SCOPE_METRICS, 32, "metrics")                                                            \
    X(API_SCOPE_GRANTED, 64, "granted")

/// The scopes, as flags.
typedef enum api_scope {
    API_SCOPE_NONE = 0, ///< needs no token
#define X(scope, flag, word) scope = flag,
    API_SCOPE_LIST(X)
#undef X
#define X(scope, flag, word) | flag
        API_SCOPE_ANY = 0 API_SCOPE_LIST(X), ///< needs a token, whatever it allows
#undef X
} api_scope;

/// What became of the token or ticket of a request.
typedef enum api_credential {
    API_CREDENTIAL_UNUSED,  ///< there are no tokens: everybody may do everything
    API_CREDENTIAL_MISSING, ///< there are tokens, but the request has none
    API_CREDENTIAL_UNKNOWN, ///< it is none of this service
    API_CREDENTIAL_EXPIRED, ///< its time is over
    API_CREDENTIAL_REVOKED, ///< it was revoked
    API_CREDENTIAL_VALID,   ///< it counts
} api_credential;

/// Whose token it is.
typedef struct api_identity {
    uint64_t token;                   ///< its number; 0: there is none
    char owner[API_OWNER_SIZE];       ///< whose it is; "": nobody's
    unsigned scopes;                  ///< flags of api_scope
    char resource[API_RESOURCE_SIZE]; ///< of API_SCOPE_GRANTED: "/v1/runs/ID"; else ""
} api_identity;

/// What stands for a token in the query of a GET for a short time, where no header can be sent.
typedef struct api_ticket {
    char text[API_TICKET_SIZE]; ///< letters, digits, '-' and '_'
    int64_t expires_ms;         ///< Unix time, ms: from then on it does not count
} api_ticket;

/// The word of one scope, "any" for API_SCOPE_ANY. Never NULL.
const char *api_access_word(api_scope scope);

/// Read a list of words with commas, "read,submit". False: empty, or a word is unknown.
bool api_access_read_scopes(const char *text, unsigned *ret_scopes);

/// Write scopes as such a list into API_SCOPES_SIZE bytes. Returns ret_text.
const char *api_access_write_scopes(unsigned scopes, char *ret_text);

/// True if these scopes allow what needs this one.
bool api_access_includes(unsigned scopes, api_scope needed);
