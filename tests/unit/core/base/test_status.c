// Unit tests of status codes and the error record.

#include "core/base/status.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static void every_code_has_a_word_of_its_own(void **state)
{
    assert_string_equal(bf_status_word(BF_OK), "ok");
    assert_string_equal(bf_status_word(BF_EINPUT), "bad-input");
    for (int a = 0; a < BF_STATUS_COUNT; a++) {
        for (int b = 0; b < a; b++)
            assert_string_not_equal(bf_status_word((bf_status)a), bf_status_word((bf_status)b));
    }
}

static void a_code_out_of_range_has_a_word_too(void **state)
{
    assert_string_equal(bf_status_word(BF_STATUS_COUNT), "unknown");
    assert_string_equal(bf_status_word((bf_status)12345), "unknown");
}

static void a_failure_fills_the_record_and_returns_its_code(void **state)
{
    bf_error err;

    assert_int_equal(bf_fail(&err, BF_ELIMIT, "/macro/cell_m", "%d cells", 7), BF_ELIMIT);
    assert_int_equal(err.code, BF_ELIMIT);
    assert_string_equal(err.pointer, "/macro/cell_m");
    assert_string_equal(err.text, "7 cells");
}

static void no_record_is_needed(void **state)
{
    assert_int_equal(bf_fail(NULL, BF_ENOMEM, "", "nothing"), BF_ENOMEM);
}

static void too_long_a_text_is_cut(void **state)
{
    bf_error err;

    assert_int_equal(bf_fail(&err, BF_EINPUT, "", "%1000d", 1), BF_EINPUT);
    assert_int_equal(strlen(err.text), BF_TEXT_SIZE - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_code_has_a_word_of_its_own),
        cmocka_unit_test(a_code_out_of_range_has_a_word_too),
        cmocka_unit_test(a_failure_fills_the_record_and_returns_its_code),
        cmocka_unit_test(no_record_is_needed),
        cmocka_unit_test(too_long_a_text_is_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
