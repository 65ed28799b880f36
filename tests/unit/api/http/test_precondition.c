// Lists of entity tags: If-None-Match by weak comparison, If-Match by strong (RFC 9110, 8.8.3.2).

#include "api/http/precondition.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
static void a_client_knows_a_state_by_the_tag_of_any_form_that_it_takes(void **state)
{
    static const struct {
        const char *list, *accepted, *form; // form NULL: not known
    } cases[] = {
        { "\"a\"", NULL, "a" },
        { "W/\"a\"", NULL, "a" },
        { "\"b\", \"a\"", NULL, "a" },
        { " ,\"b\",,W/\"a\" ", NULL, "a" },
        { "*", NULL, "a" },
        { "\"a-gzip\"", "gzip", "a-gzip" },
        { "\"a-gzip\"", NULL, NULL },
        { "\"a-gzip\"", "zstd", NULL },
        { "\"a-zstd\", \"a\"", "gzip", "a" },
        { "\"a\"", "gzip, identity;q=0", NULL },
        { "\"ab\"", NULL, NULL },
        { "\"\"", NULL, NULL },
        { "a", NULL, NULL },
        { "\"a", NULL, NULL },
        { "", NULL, NULL },
        { "b, \"a\"", NULL, NULL },
    };

    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char form[CODING_TAG_SIZE] = "as it was";
        bool is_known = precondition_match_etag(cases[i].list, "a", cases[i].accepted, form);
        assert_int_equal(is_known, cases[i].form != NULL);
        assert_string_equal(form, is_known ? cases[i].form : "as it was");
    }
}

static void a_change_needs_the_strong_tag_of_any_form(void **state)
{
    (void)state;
    assert_true(precondition_holds("*", "a"));
    assert_true(precondition_holds("\"a\"", "a"));
    assert_true(precondition_holds("\"x\", \"a-zstd\"", "a"));
    assert_false(precondition_holds("W/\"a\"", "a"));
    assert_false(precondition_holds("\"b\"", "a"));
    assert_false(precondition_holds("", "a"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_client_knows_a_state_by_the_tag_of_any_form_that_it_takes),
        cmocka_unit_test(a_change_needs_the_strong_tag_of_any_form),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
