#include "server/store/tickets.h"

#include "server/base/clock.h"

#include <sodium.h>
#include <string.h>

// What the MAC is over. Bytes of this machine's order: only this process reads them.
typedef struct claim {
    uint64_t token;
    int64_t end_ms;
} claim;

enum { TICKET_BYTES = sizeof(claim) + crypto_auth_BYTES };

_Static_assert(sizeof(claim) == 16, "every byte of a claim is one of its numbers");
_Static_assert(TICKETS_KEY_BYTES == crypto_auth_KEYBYTES, "a key is one of crypto_auth");
// Without left-over bits, so that one ticket has one text.
_Static_assert(TICKET_BYTES % 3 == 0 && TICKET_BYTES / 3 * 4 + 1 == API_TICKET_SIZE,
               "a ticket fits its text");

bf_status tickets_draw(tickets *ret_tickets, bf_error *err)
{
    if (sodium_init() < 0)
        return bf_fail(err, BF_ESYSTEM, "", "libsodium cannot be used on this machine");
    crypto_auth_keygen(ret_tickets->key);
    return BF_OK;
}

void tickets_make(const tickets *t, uint64_t token, int64_t now_ms, api_ticket *ret_ticket)
{
    const claim made = { .token = token, .end_ms = now_ms + TICKETS_MS };
    unsigned char bytes[TICKET_BYTES];

    memcpy(bytes, &made, sizeof made);
    (void)crypto_auth(bytes + sizeof made, bytes, sizeof made, t->key);
    (void)sodium_bin2base64(ret_ticket->text, sizeof ret_ticket->text, bytes, sizeof bytes,
                            sodium_base64_VARIANT_URLSAFE_NO_PADDING);
    ret_ticket->expires_ms = clock_unix_ms() + TICKETS_MS;
}

api_credential tickets_read(const tickets *t, const char *text, int64_t now_ms, uint64_t *ret_token)
{
    unsigned char bytes[TICKET_BYTES];
    size_t n = 0;
    claim made;

    if (strnlen(text, API_TICKET_SIZE) != API_TICKET_SIZE - 1 ||
        sodium_base642bin(bytes, sizeof bytes, text, API_TICKET_SIZE - 1, NULL, &n, NULL,
                          sodium_base64_VARIANT_URLSAFE_NO_PADDING) != 0 ||
        n != sizeof bytes ||
        crypto_auth_verify(bytes + sizeof made, bytes, sizeof made, t->key) != 0)
        return API_CREDENTIAL_UNKNOWN;
    memcpy(&made, bytes, sizeof made);
    if (now_ms >= made.end_ms)
        return API_CREDENTIAL_EXPIRED;
    *ret_token = made.token;
    return API_CREDENTIAL_VALID;
}
