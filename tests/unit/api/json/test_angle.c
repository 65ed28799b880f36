// Angles: degrees of a document, radians of a struct, and the same bits after the way there and back.

#include "api/json/number.h"

#include "core/base/random.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static bool same_bits(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

static void radians_of_any_degrees_come_back(void **unused)
{
    bf_random random;

    random_init(&random, 1);
    for (int k = 0; k < 100000; k++) {
        uint64_t bits = random_bits(&random);
        double degrees;
        memcpy(&degrees, &bits, sizeof degrees);
        if (!isfinite(degrees))
            continue;
        double radians = number_from_degrees(degrees);
        assert_true(same_bits(number_from_degrees(number_to_degrees(radians)), radians));
    }
}

static void radians_of_usual_degrees_come_back(void **unused)
{
    bf_random random;

    random_init(&random, 2);
    for (int k = 0; k < 100000; k++) {
        double radians = number_from_degrees(720.0 * random_unit(&random) - 360.0);
        assert_true(same_bits(number_from_degrees(number_to_degrees(radians)), radians));
    }
    assert_true(same_bits(number_to_degrees(-0.0), -0.0));
    assert_true(same_bits(number_to_degrees(number_from_degrees(4.9406564584124654e-324)), 0.0));
}

// A thousandth of a degree is written by a person: it must not come back with 17 digits.
static void short_degrees_stay_short(void **unused)
{
    for (int k = -360000; k <= 360000; k += 7) {
        double degrees = k / 1000.0;
        assert_true(number_to_degrees(number_from_degrees(degrees)) == degrees);
    }
}

static void a_quarter_turn_is_exact(void **unused)
{
    static const double expected[][3] = { { 0, 1, 0 },    { 90, 0, 1 },   { 180, -1, 0 },
                                          { 270, 0, -1 }, { -90, 0, -1 }, { 450, 0, 1 },
                                          { -360, 1, 0 }, { -180, -1, 0 } };

    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++) {
        double cosine;
        double sine;
        number_direction(expected[k][0], &cosine, &sine);
        assert_true(cosine == expected[k][1]);
        assert_true(sine == expected[k][2]);
    }
}

static void other_directions_are_those_of_the_circle(void **unused)
{
    double cosine;
    double sine;

    number_direction(60.0, &cosine, &sine);
    assert_true(fabs(cosine - 0.5) < 1e-15);
    assert_true(fabs(sine - sqrt(3.0) / 2.0) < 1e-15);
    number_direction(1e300, &cosine, &sine);
    assert_true(fabs(cosine * cosine + sine * sine - 1.0) < 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(radians_of_any_degrees_come_back),
        cmocka_unit_test(radians_of_usual_degrees_come_back),
        cmocka_unit_test(short_degrees_stay_short),
        cmocka_unit_test(a_quarter_turn_is_exact),
        cmocka_unit_test(other_directions_are_those_of_the_circle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
