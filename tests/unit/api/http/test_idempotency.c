// The header Idempotency-Key: strings of structured fields (RFC 8941) and bare keys.

#include "api/http/idempotency.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void both_forms_of_a_key_are_the_same_key(void **state)
{
    static const char *const forms[][2] = {
        { "\"8e03978e-40d5-43dd-bc93-6894a57f9324\"", "8e03978e-40d5-43dd-bc93-6894a57f9324" },
        { "8e03978e-40d5-43dd-bc93-6894a57f9324", "8e03978e-40d5-43dd-bc93-6894a57f9324" },
        { " a ", "a" },
        { "\"two words, one key; really\"", "two words, one key; really" },
        { "\"a\\\"b\\\\c\"", "a\"b\\c" },
        { "YWJj+/==", "YWJj+/==" },
    };

    (void)state;
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        char key[API_KEY_SIZE] = "?";
        assert_int_equal(idempotency_read_key(forms[i][0], key, NULL), BF_OK);
        assert_string_equal(key, forms[i][1]);
    }
}

static void no_header_is_no_key(void **state)
{
    char key[API_KEY_SIZE] = "?";

    (void)state;
    assert_int_equal(idempotency_read_key(NULL, key, NULL), BF_OK);
    assert_string_equal(key, "");
    assert_int_equal(idempotency_read_key("", key, NULL), BF_OK);
    assert_string_equal(key, "");
}

static void what_is_no_key_is_refused_and_leaves_the_place_alone(void **state)
{
    static const char *const bad[] = {
        " ",
        "\"\"",
        "\"",
        "\"a",
        "a\"",
        "a b",
        "a, b",
        "\"a\", \"b\"",
        "\"a\";p",
        "a\\b",
        "\"a\\b\"",
        "\"a\x01\"",
        "\"a\xc3\xa4\"",
        "\xc3\xa4",
        "\"a\\",
        "a\tb",
    };

    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char key[API_KEY_SIZE] = "?";
        bf_error err = { 0 };
        assert_int_equal(idempotency_read_key(bad[i], key, &err), BF_EINPUT);
        assert_non_null(strstr(err.text, "Idempotency-Key is no key"));
        assert_string_equal(key, "?");
    }
}

static void a_key_has_at_most_255_bytes(void **state)
{
    char header[600], key[API_KEY_SIZE] = "?";
    bf_error err = { 0 };

    (void)state;
    memset(header, 'k', 255);
    header[255] = '\0';
    assert_int_equal(idempotency_read_key(header, key, NULL), BF_OK);
    assert_int_equal(strlen(key), 255);
    memset(header, 'k', 256);
    header[256] = '\0';
    assert_int_equal(idempotency_read_key(header, key, &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "more than 255 bytes"));
    // In quotes it is the key that counts, not what it takes to write it.
    header[0] = '"';
    for (int i = 0; i < 255; i++)
        memcpy(header + 1 + 2 * i, "\\\"", 2);
    memcpy(header + 511, "\"", 2);
    assert_int_equal(idempotency_read_key(header, key, NULL), BF_OK);
    assert_int_equal(strlen(key), 255);
    memcpy(header + 511, "k\"", 3);
    assert_int_equal(idempotency_read_key(header, key, &err), BF_EINPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_forms_of_a_key_are_the_same_key),
        cmocka_unit_test(no_header_is_no_key),
        cmocka_unit_test(what_is_no_key_is_refused_and_leaves_the_place_alone),
        cmocka_unit_test(a_key_has_at_most_255_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
