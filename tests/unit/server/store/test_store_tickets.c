// Unit tests of tickets: what counts, for how long, and that nobody else can make one.

#include "server/base/clock.h"
#include "server/store/tickets.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

enum { NOW_MS = 5000 };

static tickets drawn(void)
{
    tickets t;

    assert_int_equal(tickets_draw(&t, NULL), BF_OK);
    return t;
}

static api_credential read_at(const tickets *t, const char *text, int64_t now_ms)
{
    uint64_t token = 99;

    api_credential credential = tickets_read(t, text, now_ms, &token);
    assert_int_equal(token, credential == API_CREDENTIAL_VALID ? 7 : 99);
    return credential;
}

static void a_ticket_counts_until_its_end(void **state)
{
    const tickets t = drawn();
    int64_t before_ms = clock_unix_ms();
    api_ticket ticket;

    tickets_make(&t, 7, NOW_MS, &ticket);
    assert_int_equal(strlen(ticket.text), API_TICKET_SIZE - 1);
    assert_int_equal(strspn(ticket.text, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                         "0123456789-_"),
                     API_TICKET_SIZE - 1);
    assert_in_range(ticket.expires_ms, before_ms + TICKETS_MS, clock_unix_ms() + TICKETS_MS);
    assert_int_equal(read_at(&t, ticket.text, NOW_MS), API_CREDENTIAL_VALID);
    assert_int_equal(read_at(&t, ticket.text, NOW_MS + TICKETS_MS - 1), API_CREDENTIAL_VALID);
    assert_int_equal(read_at(&t, ticket.text, NOW_MS + TICKETS_MS), API_CREDENTIAL_EXPIRED);
}

static void every_other_byte_makes_it_a_forged_one(void **state)
{
    static const char others[] = "AB-_=+/ \n";
    const tickets t = drawn();
    api_ticket ticket;

    tickets_make(&t, 7, NOW_MS, &ticket);
    for (size_t i = 0; i < API_TICKET_SIZE - 1; i++) {
        for (size_t k = 0; k < sizeof others; k++) { // its terminator, too
            char forged[API_TICKET_SIZE];
            memcpy(forged, ticket.text, sizeof forged);
            if (forged[i] == others[k])
                continue;
            forged[i] = others[k];
            assert_int_equal(read_at(&t, forged, NOW_MS), API_CREDENTIAL_UNKNOWN);
        }
    }
}

static void texts_of_other_lengths_are_none(void **state)
{
    const tickets t = drawn();
    api_ticket ticket;
    char longer[API_TICKET_SIZE + 1];

    tickets_make(&t, 7, NOW_MS, &ticket);
    memcpy(longer, ticket.text, sizeof ticket.text);
    longer[API_TICKET_SIZE - 1] = 'A';
    longer[API_TICKET_SIZE] = '\0';
    assert_int_equal(read_at(&t, longer, NOW_MS), API_CREDENTIAL_UNKNOWN);
    assert_int_equal(read_at(&t, "", NOW_MS), API_CREDENTIAL_UNKNOWN);
}

static void tickets_of_another_process_are_forged(void **state)
{
    const tickets t = drawn(), other = drawn();
    api_ticket ticket;

    assert_memory_not_equal(t.key, other.key, sizeof t.key);
    tickets_make(&other, 7, NOW_MS, &ticket);
    assert_int_equal(read_at(&t, ticket.text, NOW_MS), API_CREDENTIAL_UNKNOWN);
    assert_int_equal(read_at(&other, ticket.text, NOW_MS), API_CREDENTIAL_VALID);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ticket_counts_until_its_end),
        cmocka_unit_test(every_other_byte_makes_it_a_forged_one),
        cmocka_unit_test(texts_of_other_lengths_are_none),
        cmocka_unit_test(tickets_of_another_process_are_forged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
