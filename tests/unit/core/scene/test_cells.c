// Unit tests of the cells of the macroscopic grid: what "auto" is, and how they are fitted to the domain.

#include "core/scene/cells.h"

#include "core/base/random.h"
#include "core/scene/scene.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static scene scene_of(double length, double width, double cell, scene_shape shape)
{
    scene s;

    scene_init(&s);
    s.domain = (scene_rect){ 0.0, length, 0.0, width };
    s.macro.cell = cell;
    s.cargo[0].shape = shape;
    return s;
}

static const scene_shape can = { .type = SCENE_CYLINDER, .radius = 0.033, .height = 0.115 };

static void auto_follows_the_size_of_the_goods(void **state)
{
    static const scene_shape carton = {
        .type = SCENE_BOX, .length = 0.24, .width = 0.18, .height = 0.12
    };
    scene s = scene_of(4.0, 1.2, 0.0, can);

    assert_near(cells_wanted(&s), 0.066 / 3.0, 1e-15);
    s.macro.closure = SCENE_DISPERSIVE;
    assert_near(cells_wanted(&s), 0.066 / 5.0, 1e-15);
    // A disk of 0.24 m x 0.18 m is 2 sqrt(0.0432/pi) = 0.2345 m across.
    s = scene_of(4.0, 1.2, 0.0, carton);
    assert_near(cells_wanted(&s), 0.23453 / 3.0, 1e-5);
    // The smallest kind counts; one whose shape is at fault does not.
    s.n_cargo = 3;
    scene_cargo_init(&s.cargo[1]);
    s.cargo[1].shape = can;
    scene_cargo_init(&s.cargo[2]);
    s.cargo[2].shape.radius = -1.0;
    assert_near(cells_wanted(&s), 0.066 / 3.0, 1e-15);
}

// Parts of 2 mm on 100 m x 10 m would make 2.25e9 cells.
static void auto_is_bounded_in_number(void **state)
{
    static const scene_shape bead = { .type = SCENE_CYLINDER, .radius = 0.001, .height = 0.001 };
    const scene s = scene_of(100.0, 10.0, 0.0, bead);
    const cells c = cells_of(&s);

    assert_true(c.n1 * c.n2 > 0.99 * CELLS_AUTO_MAX && c.n1 * c.n2 < 1.01 * CELLS_AUTO_MAX);
}

static void a_cell_that_divides_the_domain_is_taken_as_it_is(void **state)
{
    const scene s = scene_of(1.0, 0.6, 0.005, can);
    const cells c = cells_of(&s);

    assert_true(c.n1 == 200.0 && c.n2 == 120.0);
    assert_true(c.d1 == 0.005 && c.d2 == 0.005);
    // Rounding of the document is forgiven, 1e-6 of the length.
    const scene rounded = scene_of(1.0000005, 0.6, 0.005, can);
    const cells of_rounded = cells_of(&rounded);
    assert_true(of_rounded.n1 == 200.0 && of_rounded.d1 == 0.005);
}

// 0.613 m are 61.3 cells of 1 cm: 61 of 10.049 mm; 1 m then are 99.51 of these: 100 of 10 mm.
static void another_one_is_fitted_to_the_shorter_side_first(void **state)
{
    const scene along = scene_of(1.0, 0.613, 0.01, can), across = scene_of(0.613, 1.0, 0.01, can);
    const cells c = cells_of(&along), turned = cells_of(&across);

    assert_true(c.n1 == 100.0 && c.n2 == 61.0);
    assert_near(c.d1, 0.01, 1e-17);
    assert_near(c.d2, 0.613 / 61.0, 1e-17);
    assert_true(turned.n1 == 61.0 && turned.n2 == 100.0);
}

static void a_cell_beyond_the_domain_is_one_of_it(void **state)
{
    const scene s = scene_of(0.1, 0.1, 0.3, can);
    const cells c = cells_of(&s);

    assert_true(c.n1 == 1.0 && c.n2 == 1.0);
    assert_near(c.d1, 0.1, 1e-17);
}

// Whatever the domain: the grid covers it, and the edges differ by at most 1/(2 n) of the mean.
static void any_domain_has_cells_that_are_nearly_square(void **state)
{
    bf_random random;

    random_init(&random, 7);
    for (int k = 0; k < 2000; k++) {
        const double length = 0.1 + 20.0 * random_unit(&random);
        const double width = 0.1 + 3.0 * random_unit(&random);
        const scene s = scene_of(length, width, 0.002 + 0.3 * random_unit(&random), can);
        const cells c = cells_of(&s);
        const double n = fmax(c.n1, c.n2);
        assert_near(c.n1 * c.d1, length, 2e-6 * length);
        assert_near(c.n2 * c.d2, width, 2e-6 * width);
        assert_true(fabs(c.d1 - c.d2) <= 0.5 / n * fmax(c.d1, c.d2) * 1.0001);
        if (fmin(length, width) >= s.macro.cell)
            assert_true(fabs(fmin(c.n1, c.n2) - fmin(length, width) / s.macro.cell) <= 0.5 + 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(auto_follows_the_size_of_the_goods),
        cmocka_unit_test(auto_is_bounded_in_number),
        cmocka_unit_test(a_cell_that_divides_the_domain_is_taken_as_it_is),
        cmocka_unit_test(another_one_is_fitted_to_the_shorter_side_first),
        cmocka_unit_test(a_cell_beyond_the_domain_is_one_of_it),
        cmocka_unit_test(any_domain_has_cells_that_are_nearly_square),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
