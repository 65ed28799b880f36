// Content codings and their choice by Accept-Encoding (RFC 9110, 12.5.3).

#include "api/http/coding.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
static void the_header_says_what_each_coding_is_worth(void **state)
{
    static const struct {
        const char *header;
        int zstd, gzip, identity;
    } cases[] = {
        { NULL, 0, 0, 1 },
        { "", 0, 0, 1 },
        { "gzip", 0, 1000, 1 },
        { "GZip;q=0.5, zstd ; q=0.25", 250, 500, 1 },
        { "x-gzip", 0, 1000, 1 },
        { "*", 1000, 1000, 1000 },
        { "*;q=0", 0, 0, 0 },
        { "*;q=0, gzip", 0, 1000, 0 },
        { "gzip, *;q=0.1", 100, 1000, 100 },
        { "gzip;q=0, *", 1000, 0, 1000 },
        { "identity;q=0, gzip;q=0.001", 0, 1, 0 },
        { "gzip;q=2, zstd;q=0.1", 100, 0, 1 },
        { "br, deflate", 0, 0, 1 },
        { "gzipped", 0, 0, 1 },
        { ",, gzip ,", 0, 1000, 1 },
    };

    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(coding_quality(cases[i].header, CODING_ZSTD), cases[i].zstd);
        assert_int_equal(coding_quality(cases[i].header, CODING_GZIP), cases[i].gzip);
        assert_int_equal(coding_quality(cases[i].header, CODING_IDENTITY), cases[i].identity);
    }
}

static void the_best_liked_is_chosen_and_of_equals_the_first(void **state)
{
    static const coding offers[] = { CODING_ZSTD, CODING_GZIP, CODING_IDENTITY };
    static const struct {
        const char *header;
        int chosen;
    } cases[] = {
        { NULL, 2 },
        { "deflate, gzip, br, zstd", 0 },
        { "gzip", 1 },
        { "gzip, identity", 1 },
        { "gzip;q=0.5, identity", 2 },
        { "zstd;q=0.5, gzip;q=0.6", 1 },
        { "*;q=0", -1 },
        { "identity;q=0", -1 },
    };

    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(coding_choose(cases[i].header, offers, 3), cases[i].chosen);
    assert_int_equal(coding_choose("gzip", offers, 0), -1);
}

static void each_form_has_a_tag_of_its_own(void **state)
{
    char tag[CODING_TAG_SIZE];

    (void)state;
    coding_tag("r1", CODING_IDENTITY, tag);
    assert_string_equal(tag, "r1");
    coding_tag("r1", CODING_GZIP, tag);
    assert_string_equal(tag, "r1-gzip");
    coding_tag("r1", CODING_ZSTD, tag);
    assert_string_equal(tag, "r1-zstd");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_header_says_what_each_coding_is_worth),
        cmocka_unit_test(the_best_liked_is_chosen_and_of_equals_the_first),
        cmocka_unit_test(each_form_has_a_tag_of_its_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
