// `wait` among the preferences of a client (RFC 7240).

#include "api/http/prefer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <limits.h>

static void the_seconds_are_found_among_other_preferences(void **state)
{
    static const struct {
        const char *header;
        unsigned seconds;
    } cases[] = {
        { "wait=10", 10 },
        { "respond-async, wait=10", 10 },
        { "WAIT = 7 ; x=y, foo", 7 },
        { "return=minimal; note=\"a, wait=3\", wait=\"4\"", 4 },
        { "wait=5, wait=6", 5 },
        { "wait=0", 0 },
        { "wait=99999999999999999999", UINT_MAX },
    };

    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        unsigned seconds = 12345;
        assert_true(prefer_wait(cases[i].header, &seconds));
        assert_int_equal(seconds, cases[i].seconds);
    }
}

static void what_cannot_be_read_is_no_preference(void **state)
{
    static const char *const headers[] = { "",        "wait",      "wait=",     "wait=x",
                                           "wait=-1", "wait=1.5",  "wait=\"1",  "waiting=3",
                                           "await=3", "foo=wait=", "x; wait=3", "wait=3x" };
    unsigned seconds = 12345;

    (void)state;
    assert_false(prefer_wait(NULL, &seconds));
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
        assert_false(prefer_wait(headers[i], &seconds));
    assert_int_equal(seconds, 12345);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_seconds_are_found_among_other_preferences),
        cmocka_unit_test(what_cannot_be_read_is_no_preference),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
