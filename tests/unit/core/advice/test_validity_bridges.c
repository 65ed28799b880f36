// How likely a queue before a narrow opening stops for good, from the table of what was measured.

#include "core/advice/bridges.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static void a_place_of_the_table_has_what_was_measured(void **unused)
{
    for (int two = 0; two < 2; two++) {
        for (int a = 0; a < BRIDGES_ANGLES; a++) {
            for (int f = 0; f < BRIDGES_FRICTIONS; f++) {
                for (int o = 0; o < BRIDGES_OPENINGS; o++) {
                    const bridges_cell *cell = &bridges_table[two][a][f][o];
                    const bridges_outlet at = { two == 1, bridges_openings[o], bridges_angles[a],
                                                bridges_frictions[f] };
                    if (cell->stops > 0.0)
                        assert_near(bridges_probability(&at, 1.0), cell->stops / cell->passed,
                                    1e-9);
                    else
                        assert_true(bridges_probability(&at, 1.0) < 1e-3);
                }
            }
        }
    }
}

// Of each part that passes the chance is the same: that all of n pass is the n-th power.
static void parts_are_chances(void **unused)
{
    const bridges_outlet at = { false, 2.3, 70.0, 0.4 };
    const double once = bridges_probability(&at, 1.0);

    assert_true(once > 0.0 && once < 1.0);
    assert_near(bridges_probability(&at, 1000.0), 1.0 - pow(1.0 - once, 1000.0), 1e-9);
    assert_near(bridges_probability(&at, 0.0), 0.0, 0.0);
}

static void between_places_it_lies_between_them_and_beyond_it_stays(void **unused)
{
    const bridges_outlet low = { true, 2.0, 60.0, 0.34 }, high = { true, 2.5, 60.0, 0.34 };
    const bridges_outlet middle = { true, 2.25, 60.0, 0.34 };
    const bridges_outlet steep = { true, 2.0, 130.0, 0.34 }, upright = { true, 2.0, 90.0, 0.34 };
    const bridges_outlet rough = { true, 2.0, 60.0, 3.0 }, most = { true, 2.0, 60.0, 0.9 };
    const bridges_outlet wide = { true, 5.01, 60.0, 0.34 };

    assert_near(bridges_probability(&middle, 1.0),
                sqrt(bridges_probability(&low, 1.0) * bridges_probability(&high, 1.0)), 1e-9);
    assert_near(bridges_probability(&steep, 1.0), bridges_probability(&upright, 1.0), 1e-12);
    assert_near(bridges_probability(&rough, 1.0), bridges_probability(&most, 1.0), 1e-12);
    assert_near(bridges_probability(&wide, 1e9), 0.0, 0.0);
}

static void below_two_diameters_queues_stop(void **unused)
{
    for (int two = 0; two < 2; two++) {
        for (double opening = 0.5; opening < 1.6; opening += 0.1) {
            const bridges_outlet at = { two == 1, opening, 60.0, 0.34 };
            assert_true(bridges_probability(&at, 1000.0) > 0.999);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_place_of_the_table_has_what_was_measured),
        cmocka_unit_test(parts_are_chances),
        cmocka_unit_test(between_places_it_lies_between_them_and_beyond_it_stays),
        cmocka_unit_test(below_two_diameters_queues_stop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
