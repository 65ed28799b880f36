// Unit tests of numbers in sentences.

#include "core/base/number_text.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static void numbers_have_their_digits_and_thousands_apart(void **state)
{
    static const struct {
        double value;
        int digits;
        const char *text;
    } expected[] = {
        { 155578.8, 3, "155,579" },
        { 1234567.0, 3, "1,234,567" },
        { -1234.4, 3, "-1,234" },
        { 999.6, 3, "1,000" },
        { 100.4, 3, "100" },
        { 99.96, 3, "100" },
        { 99.94, 3, "99.9" },
        { 12.34, 3, "12.3" },
        { 0.0, 3, "0" },
        { 0.00012, 3, "0.00012" },
        { 1e-7, 3, "1e-07" },
        { 999.94, 4, "999.9" },
        { 12345.6, 6, "12,345.6" },
        { 123456.7, 6, "123,457" },
        { 0.62349, 6, "0.62349" },
        { 1e15, 3, "1e+15" },
        { (double)INFINITY, 3, "inf" },
        { (double)NAN, 3, "an unknown value" },
    };
    char text[NUMBER_TEXT_SIZE];

    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++)
        assert_string_equal(number_text(expected[k].value, expected[k].digits, text),
                            expected[k].text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_have_their_digits_and_thousands_apart),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
