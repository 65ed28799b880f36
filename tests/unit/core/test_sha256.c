// Unit tests of SHA-256. The digests are those of the standard's own examples.

#include "core/base/sha256.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void expect(const char *text, size_t times, const char *digest)
{
    unsigned char bytes[SHA256_SIZE];
    char shown[2 * SHA256_SIZE + 1];
    sha256 s;

    sha256_begin(&s);
    for (size_t i = 0; i < times; i++)
        sha256_add(&s, text, strlen(text));
    sha256_end(&s, bytes);
    for (size_t i = 0; i < SHA256_SIZE; i++)
        snprintf(shown + 2 * i, 3, "%02x", bytes[i]);
    assert_string_equal(shown, digest);
}

static void the_standards_examples_come_out(void **state)
{
    (void)state;
    expect("", 1, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    expect("abc", 1, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    expect("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", 1,
           "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    expect("a", 1000000, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// Lengths around a block and around the room for the length in it.
static void cuts_do_not_count(void **state)
{
    unsigned char text[200], whole[SHA256_SIZE], cut[SHA256_SIZE];
    sha256 s;

    (void)state;
    for (size_t i = 0; i < sizeof text; i++)
        text[i] = (unsigned char)(i * 37);
    for (size_t n = 0; n <= sizeof text; n++) {
        sha256_begin(&s);
        sha256_add(&s, text, n);
        sha256_end(&s, whole);
        for (size_t at = 0; at <= n; at += 7) {
            sha256_begin(&s);
            sha256_add(&s, text, at);
            sha256_add(&s, text + at, n - at);
            sha256_end(&s, cut);
            assert_memory_equal(cut, whole, sizeof whole);
        }
    }
}

static void each_bit_counts(void **state)
{
    unsigned char text[64] = { 0 }, digests[2][SHA256_SIZE];
    sha256 s;

    (void)state;
    sha256_begin(&s);
    sha256_add(&s, text, sizeof text);
    sha256_end(&s, digests[0]);
    for (size_t bit = 0; bit < 8 * sizeof text; bit++) {
        text[bit / 8] ^= (unsigned char)(1U << bit % 8);
        sha256_begin(&s);
        sha256_add(&s, text, sizeof text);
        sha256_end(&s, digests[1]);
        assert_memory_not_equal(digests[1], digests[0], SHA256_SIZE);
        text[bit / 8] ^= (unsigned char)(1U << bit % 8);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_standards_examples_come_out),
        cmocka_unit_test(cuts_do_not_count),
        cmocka_unit_test(each_bit_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
