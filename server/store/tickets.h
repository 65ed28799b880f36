/// Tickets: what stands for an access token in a URL for a minute (api_ticket).
///
/// A ticket is the number of its token and the end of its time, and a MAC of both (HMAC-SHA512-256, crypto_auth of
/// libsodium) by a key that is drawn at the start and never leaves the process. So nothing is kept of a ticket, and one of
/// another process, also of this daemon before a restart, is a forged one.
///
/// Time     that of tickets is monotonic: no change of the machine's clock makes one last.
/// Threads  all functions may be called from any thread: what was drawn stays.

#pragma once

#include "api/access.h"
#include "core/base/status.h"

#include <stdint.h>

enum {
    TICKETS_KEY_BYTES = 32, ///< of a key
    TICKETS_MS = 60000,     ///< how long a ticket counts
};

/// What tickets are made and checked by.
typedef struct tickets {
    unsigned char key[TICKETS_KEY_BYTES]; ///< secret
} tickets;

/// Draw a key. BF_ESYSTEM: libsodium cannot be used.
BF_MUST_CHECK bf_status tickets_draw(tickets *ret_tickets, bf_error *err);

/// Make a ticket for a token. now_ms is clock_monotonic_ms().
void tickets_make(const tickets *t, uint64_t token, int64_t now_ms, api_ticket *ret_ticket);

/// What becomes of a ticket: API_CREDENTIAL_VALID with the number of its token, _EXPIRED, or _UNKNOWN where it is none
/// that was made by this key. Compares in constant time.
api_credential tickets_read(const tickets *t, const char *text, int64_t now_ms,
                            uint64_t *ret_token);
