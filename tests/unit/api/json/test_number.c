// Numbers as text: what is written reads back to the same bits and is no longer than need be.

#include "api/json/number.h"

#include "core/base/random.h"
#include "tests/unit/helper_cmocka.h"

#include <float.h>
#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bf_random generator;

static bool same_bits(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

static void expect_round_trip(double value)
{
    char text[NUMBER_SIZE];

    int n = number_format(value, text);
    assert_int_equal(n, strlen(text));
    assert_true(n < NUMBER_SIZE);
    assert_true(same_bits(strtod(text, NULL), value));
}

static void expect_float_round_trip(float value)
{
    char text[NUMBER_SIZE];

    number_format_float(value, text);
    float back = strtof(text, NULL);
    assert_memory_equal(&back, &value, sizeof value);
}

// JSON readers must find the same double, too; the brackets make it a document.
static void expect_json(double value)
{
    char text[NUMBER_SIZE];
    char document[NUMBER_SIZE + 2];

    number_format(value, text);
    snprintf(document, sizeof document, "[%s]", text);
    json_t *root = json_loads(document, JSON_DECODE_INT_AS_REAL, NULL);
    assert_non_null(root);
    assert_true(same_bits(json_real_value(json_array_get(root, 0)), value));
    json_decref(root);
}

static void random_bits_read_back(void **unused)
{
    random_init(&generator, 1);
    for (int k = 0; k < 200000; k++) {
        uint64_t bits = random_bits(&generator);
        double value;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        expect_round_trip(value);
        if (k % 20 == 0)
            expect_json(value);
    }
}

static void random_float_bits_read_back(void **unused)
{
    random_init(&generator, 2);
    for (int k = 0; k < 200000; k++) {
        uint32_t bits = (uint32_t)(random_bits(&generator) >> 32);
        float value;
        memcpy(&value, &bits, sizeof value);
        if (isfinite(value))
            expect_float_round_trip(value);
    }
}

static void the_ends_of_the_range_read_back(void **unused)
{
    static const double values[] = {
        DBL_MAX,     -DBL_MAX,          DBL_MIN,           DBL_TRUE_MIN, -DBL_TRUE_MIN,
        DBL_EPSILON, 1.0 + DBL_EPSILON, 1.0 - DBL_EPSILON, 0.0,          -0.0,
        0x1p53,      0x1p53 + 2.0,      -0x1p63,           0x1p64,
    };
    for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
        expect_round_trip(values[k]);
        expect_json(values[k]);
    }
    expect_float_round_trip(FLT_MAX);
    expect_float_round_trip(FLT_TRUE_MIN);
    expect_float_round_trip(-0.0F);
}

static void subnormal_numbers_read_back(void **unused)
{
    random_init(&generator, 3);
    for (int k = 0; k < 20000; k++) {
        uint64_t bits = random_bits(&generator) >> (12 + k % 50);
        double value;
        memcpy(&value, &bits, sizeof value);
        expect_round_trip(value);
    }
}

static void powers_of_ten_have_one_digit(void **unused)
{
    for (int exponent = -307; exponent <= 308; exponent++) {
        char source[16];
        char text[NUMBER_SIZE];
        snprintf(source, sizeof source, "1e%d", exponent);
        double value = strtod(source, NULL);
        number_format(value, text);
        expect_round_trip(value);
        const char *at = text + strspn(text, "0.");
        assert_int_equal(*at, '1');
        at += 1 + strspn(at + 1, "0");
        assert_true(*at == '\0' || *at == 'e');
    }
}

static void decimals_come_out_as_they_were_written(void **unused)
{
    static const char *const texts[] = { "0.1",
                                         "0.3",
                                         "0.00125",
                                         "1e-05",
                                         "0.57735027",
                                         "-12.5",
                                         "100",
                                         "0",
                                         "-0.0",
                                         "5e-324",
                                         "1e+300",
                                         "123456",
                                         "1e+15",
                                         "0.79",
                                         "2.2250738585072014e-308",
                                         "1.7976931348623157e+308" };
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        char text[NUMBER_SIZE];
        number_format(strtod(texts[k], NULL), text);
        assert_string_equal(text, texts[k]);
    }
}

// A text with fewer digits would read back as another number: try all shorter ones.
static void no_shorter_text_reads_back(void **unused)
{
    random_init(&generator, 4);
    for (int k = 0; k < 5000; k++) {
        char text[NUMBER_SIZE];
        double value = random_unit(&generator);
        number_format(value, text);
        int n_digits = 0;
        for (const char *at = text + strspn(text, "0."); *at != '\0' && *at != 'e'; at++)
            n_digits += *at != '.';
        for (int digits = 1; digits < n_digits; digits++) {
            char shorter[400];
            snprintf(shorter, sizeof shorter, "%.*g", digits, value);
            assert_false(strtod(shorter, NULL) == value);
        }
    }
}

static void floats_take_few_digits(void **unused)
{
    char text[NUMBER_SIZE];

    number_format_float(0.1F, text);
    assert_string_equal(text, "0.1");
    number_format_float(16777216.0F, text);
    assert_true(strlen(text) <= 12);
    number_format_float(1.0F / 3.0F, text);
    assert_string_equal(text, "0.33333334");
}

// As the C library prints it, with the least precision from that of all decimals on that reads back.
static void expect_printed(double value)
{
    char text[NUMBER_SIZE], expected[NUMBER_SIZE];
    int digits = DBL_DIG - 1;

    do
        snprintf(expected, sizeof expected, "%.*g", ++digits, value);
    while (strtod(expected, NULL) != value);
    assert_int_equal(number_format(value, text), strlen(expected));
    assert_string_equal(text, expected);
}

static void expect_float_printed(float value)
{
    char text[NUMBER_SIZE], expected[NUMBER_SIZE];
    int digits = FLT_DIG - 1;

    do
        snprintf(expected, sizeof expected, "%.*g", ++digits, (double)value);
    while (strtof(expected, NULL) != value);
    assert_int_equal(number_format_float(value, text), strlen(expected));
    assert_string_equal(text, expected);
}

// Around the powers of 2 and 10, decimals, and any numbers, of the sizes that are written without an exponent and next to them.
static void numbers_of_moderate_size_are_written_as_printf_does(void **unused)
{
    random_init(&generator, 5);
    for (int k = 0; k < 6000; k++) {
        const int a = k % 7 - 3, b = k / 7 % 80;
        double values[] = { ldexp(1.0, b - 20), pow(10.0, b % 23 - 6),
                            floor(1e6 * random_unit(&generator)) / pow(10.0, b % 9),
                            ldexp(random_unit(&generator), b - 20) };
        for (size_t i = 0; i < 4; i++) {
            for (int j = 0; i < 2 && j < abs(a); j++)
                values[i] = nextafter(values[i], a < 0 ? 0.0 : INFINITY);
            if (values[i] == 0.0)
                continue;
            expect_printed(k % 2 == 0 ? values[i] : -values[i]);
            expect_float_printed((float)values[i]);
        }
    }
}

// 12 digits; ties, which are none in binary, do not matter.
static void measures_lose_the_rounding_of_sums(void **state)
{
    assert_true(number_round(233640.00000000003) == 233640.0);
    assert_true(number_round(0.1 + 0.2) == 0.3);
    assert_true(number_round(-1.0 / 3.0) == -0.333333333333);
    assert_true(number_round(2e12 / 3.0) == 666666666667.0);
    assert_true(number_round(1e300 / 7.0) == 1.42857142857e299);
    assert_true(number_round(0.0) == 0.0);
    assert_true(isnan(number_round((double)NAN)));
    assert_true(isinf(number_round((double)INFINITY)));
}

static void digits_are_a_whole_number_within_bounds(void **state)
{
    static const char *const bad[] = { "", "-1", "+1", " 1", "1 ", "1.0", "0x1", "1e2", "8", "2" };
    uint64_t value = 7;

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        assert_false(number_read_digits(bad[k], 3, 7, &value));
    assert_false(number_read_digits("18446744073709551616", 0, UINT64_MAX, &value));
    assert_int_equal(value, 7);
    assert_true(number_read_digits("003", 3, 7, &value));
    assert_int_equal(value, 3);
    assert_true(number_read_digits("18446744073709551615", 0, UINT64_MAX, &value));
    assert_true(value == UINT64_MAX);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_bits_read_back),
        cmocka_unit_test(random_float_bits_read_back),
        cmocka_unit_test(the_ends_of_the_range_read_back),
        cmocka_unit_test(subnormal_numbers_read_back),
        cmocka_unit_test(powers_of_ten_have_one_digit),
        cmocka_unit_test(decimals_come_out_as_they_were_written),
        cmocka_unit_test(no_shorter_text_reads_back),
        cmocka_unit_test(floats_take_few_digits),
        cmocka_unit_test(numbers_of_moderate_size_are_written_as_printf_does),
        cmocka_unit_test(measures_lose_the_rounding_of_sums),
        cmocka_unit_test(digits_are_a_whole_number_within_bounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
