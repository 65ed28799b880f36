// Unit tests of the density from parts (18).

#include "core/scene/density.h"

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/scene/placement.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

enum { N1 = 60, N2 = 40 };
static const bf_grid grid = { N1, N2, -0.1, 0.2, 0.005, 0.005 };

static void density_is_the_printed_sum_to_rounding(void **state)
{
    enum { PARTS = 7 };
    static const double sigma0 = 20000.0, packing = 2004.0;
    scene_pose poses[PARTS];
    double rho[N1 * N2];
    bf_random random;

    random_init(&random, 3);
    for (int k = 0; k < PARTS; k++) // some of them outside the grid
        poses[k] = (scene_pose){ -0.15 + 0.4 * random_unit(&random),
                                 0.15 + 0.3 * random_unit(&random), 0.0 };
    assert_int_equal(density_from_parts(&grid, packing, sigma0, poses, PARTS, rho, NULL), BF_OK);
    double peak = sigma0 / (2.0 * M_PI * packing);
    for (size_t j = 0; j < N2; j++) {
        for (size_t i = 0; i < N1; i++) {
            double sum = 0.0;
            for (int k = 0; k < PARTS; k++) {
                double x = grid_x1(&grid, i) - poses[k].x, y = grid_x2(&grid, j) - poses[k].y;
                sum += peak * exp(-0.5 * sigma0 * (x * x + y * y));
            }
            // What is left out of each part is below 2^-53 of the peak; the rest is rounding.
            assert_near(rho[j * N1 + i], sum, PARTS * 1e-15 * peak);
        }
    }
}

static void cells_far_from_cargo_are_exactly_zero(void **state)
{
    static const double sigma0 = 20000.0;
    scene_pose pose = { 0.0, 0.3, 0.0 };
    double rho[N1 * N2], reach = sqrt(2.0 * 53.0 * M_LN2 / sigma0);

    assert_int_equal(density_from_parts(&grid, 2004.0, sigma0, &pose, 1, rho, NULL), BF_OK);
    for (size_t j = 0; j < N2; j++) {
        for (size_t i = 0; i < N1; i++) {
            double x = grid_x1(&grid, i) - pose.x, y = grid_x2(&grid, j) - pose.y;
            double off = sqrt(x * x + y * y);
            if (off > reach * (1.0 + 1e-12))
                assert_true(rho[j * N1 + i] == 0.0);
            if (off < reach * (1.0 - 1e-12))
                assert_true(rho[j * N1 + i] > 0.0);
        }
    }
}

static void the_density_of_example_1_holds_its_192_parts(void **state)
{
    scene s;
    scene_placement p;
    double sum = 0.0;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    assert_int_equal(placement_make(&s, &p, NULL), BF_OK);
    bf_grid cells = scene_grid(&s);
    double *rho = memory_alloc(grid_cells(&cells), sizeof *rho),
           packing = scene_packing_density(&s);
    assert_non_null(rho);
    assert_int_equal(
        density_from_parts(&cells, packing, s.macro.initial_mollifier, p.poses, p.n, rho, NULL),
        BF_OK);
    for (size_t k = 0; k < grid_cells(&cells); k++)
        sum += rho[k];
    // The reference answer of the model's page; the rest lies outside the domain.
    assert_near(packing * sum * cells.d1 * cells.d2, 191.999998, 1e-6);
    memory_free(rho);
    placement_fini(&p);
    scene_fini(&s);
}

static void parts_far_outside_and_a_flat_kernel_are_no_trouble(void **state)
{
    scene_pose poses[] = { { 1e5, -1e5, 0.0 }, { -1e5, 0.3, 0.0 } };
    double rho[N1 * N2];

    memset(rho, 0xff, sizeof rho);
    assert_int_equal(density_from_parts(&grid, 1.0, 2500.0, poses, 2, rho, NULL), BF_OK);
    for (size_t k = 0; k < N1 * N2; k++)
        assert_true(rho[k] == 0.0);
    assert_int_equal(density_from_parts(&grid, 1.0, 1e-300, poses, 2, rho, NULL), BF_OK);
    for (size_t k = 0; k < N1 * N2; k++)
        assert_true(rho[k] > 0.0);
}

static void without_memory_the_density_is_as_before(void **state)
{
    scene_pose pose = { 0.0, 0.3, 0.0 };
    double rho[N1 * N2] = { 7.0, 8.0 };
    bf_error err = { 0 };

    memory_plan_fault(1, 0);
    assert_int_equal(density_from_parts(&grid, 2004.0, 2500.0, &pose, 1, rho, &err), BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_int_equal(err.code, BF_ENOMEM);
    assert_true(rho[0] == 7.0 && rho[1] == 8.0 && rho[2] == 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(density_is_the_printed_sum_to_rounding),
        cmocka_unit_test(cells_far_from_cargo_are_exactly_zero),
        cmocka_unit_test(the_density_of_example_1_holds_its_192_parts),
        cmocka_unit_test(parts_far_outside_and_a_flat_kernel_are_no_trouble),
        cmocka_unit_test(without_memory_the_density_is_as_before),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
