// Unit tests of the scenario: defaults and derived figures. Expected values are derived from the
// formulas of the paper or of the headers.

#include "core/scene/scene.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static void defaults_are_those_of_the_paper(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    assert_int_equal(s.n_belts, 1);
    assert_string_equal(s.belts[0].id, "main");
    assert_string_equal(s.obstacles[0].id, "obstacle-1");
    assert_string_equal(s.counters[0].id, "upstream");
    assert_true(s.macro.dispersion == 0.79); // 2 |v_T|
    // Steel, pi r^2 h * 7850 kg/m3 = 0.02841 kg.
    assert_near(s.cargo[0].mass, 7850.0 * M_PI * 0.012 * 0.012 * 0.008, 1e-15);
    assert_near(s.cargo[0].mass, 0.02841, 5e-6);
    assert_near(s.micro.spin_friction_radius, 0.008, 1e-17); // 2/3 r
    assert_near(s.obstacles[0].band, 0.08, 1e-16);           // 8/sqrt(sigma)
    assert_near(s.obstacles[0].slide_width, 0.03, 1e-16);    // 3/sqrt(sigma)
    // The counter's y range is left to its default, the domain's.
    assert_true(s.counters[0].rect.x_max == 0.75);
    assert_true(s.counters[0].rect.y_max == 0.6);
    scene_fini(&s);
}

static void the_papers_treatments_have_a_narrower_slide_zone_and_no_mirror(void **state)
{
    scene s;

    for (int treatment = 0; treatment < SCENE_TREATMENT_COUNT; treatment++) {
        helper_scene_example(&s, 60.0, (scene_treatment)treatment);
        bool is_sealed = treatment == SCENE_SEALED;
        assert_near(s.obstacles[0].slide_width, is_sealed ? 0.03 : 0.02, 1e-16);
        assert_int_equal(scene_mirrors_walls(&s), is_sealed);
        scene_fini(&s);
    }
}

static void several_items_without_ids_are_numbered(void **state)
{
    scene s;

    helper_scene_belt(&s, 1.0, 0.5, 0.005, (scene_pose[]){ { 0.2, 0.2, 0.0 } }, 1);
    for (int k = 0; k < 3; k++)
        helper_scene_add_belt(&s, (vec2){ 0.395, 0.0 }, NULL, 0);
    s.n_counters = 2;
    s.counters = memory_alloc(2, sizeof *s.counters);
    assert_non_null(s.counters);
    for (int k = 0; k < 2; k++)
        scene_counter_init(&s.counters[k]);
    helper_scene_resolve(&s);
    assert_string_equal(s.belts[0].id, "main");
    assert_string_equal(s.belts[2].id, "belt-3");
    assert_string_equal(s.counters[1].id, "upstream-2");
    static bf_faults faults;
    scene_check(&s, &faults);
    assert_int_equal(faults.n, 0);
    scene_fini(&s);
}

static void resolving_twice_changes_nothing(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    scene before = s;
    scene_obstacle obstacle = s.obstacles[0];
    helper_scene_resolve(&s);
    assert_memory_equal(&s, &before, sizeof s);
    assert_memory_equal(&s.obstacles[0], &obstacle, sizeof obstacle);
    scene_fini(&s);
}

static void without_memory_the_scene_is_as_before(void **state)
{
    scene s, before;

    helper_scene_belt(&s, 1.0, 0.5, 0.005, (scene_pose[]){ { 0.2, 0.2, 0.0 } }, 1);
    before = s;
    for (size_t n = 1;; n++) {
        bf_error err = { 0 };
        memory_plan_fault(n, 1);
        bf_status status = scene_resolve(&s, &err);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        if (n_faults == 0) {
            assert_int_equal(status, BF_OK);
            break;
        }
        assert_int_equal(status, BF_ENOMEM);
        assert_int_equal(err.code, BF_ENOMEM);
        assert_memory_equal(&s, &before, sizeof s);
    }
    scene_fini(&s);
    scene_fini(NULL);
}

static void the_grid_of_the_examples_is_that_of_the_paper(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    bf_grid grid = scene_grid(&s);
    assert_int_equal(grid.n1, 200);
    assert_int_equal(grid.n2, 120);
    assert_true(grid.d1 == 0.005 && grid.d2 == 0.005);
    assert_true(grid.lower1 == 0.0 && grid.lower2 == 0.0);
    assert_int_equal(scene_parts(&s), 192);
    scene_fini(&s);
}

static double resolved_packing(scene *s)
{
    s->macro.packing = NAN;
    helper_scene_resolve(s);
    return scene_packing_density(s);
}

static void close_packing_has_the_density_of_its_shape(void **state)
{
    // A hexagon of circumradius 0.01: area 3 sqrt(3)/2 R^2.
    double hexagon[6][3], area = 1.5 * sqrt(3.0) * 1e-4;
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    // 1/(2 sqrt(3) 0.012^2) = 2004.69, of which the paper keeps four digits.
    assert_true(scene_packing_density(&s) == 2004.0);
    s.cargo[0].shape.type = SCENE_BOX;
    s.cargo[0].shape.length = 0.05;
    s.cargo[0].shape.width = 0.02;
    assert_true(resolved_packing(&s) == 1000.0);
    s.cargo[0].shape.length = 0.7; // 1/0.014 = 71.428...
    assert_near(resolved_packing(&s), 71.42, 1e-12);
    for (int k = 0; k < 6; k++) {
        hexagon[k][0] = 0.01 * cos(k * M_PI / 3.0);
        hexagon[k][1] = 0.01 * sin(k * M_PI / 3.0);
        hexagon[k][2] = 0.0;
    }
    helper_scene_set_vertices(&s, SCENE_PRISM, (const double(*)[3])hexagon, 6);
    // pi/(2 sqrt(3)) / area = 3490.65...
    assert_near(resolved_packing(&s), floor(M_PI / (2.0 * sqrt(3.0)) / area), 0.0);
    s.macro.packing = 3000.5;
    helper_scene_resolve(&s);
    assert_true(scene_packing_density(&s) == 3000.5);
    scene_fini(&s);
}

static void steps_are_bounded_by_stability_and_positivity(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    // dx / (|v_T| + eps) = 0.005 / (0.395 + 0.79).
    assert_near(scene_step_stable(&s), 0.005 / 1.185, 1e-15);
    assert_near(scene_step_positive(&s), 0.0025 / 1.185, 1e-15);
    assert_true(scene_macro_step(&s) == 0.00125);
    // Both axes at once: half of it.
    s.macro.scheme = SCENE_SCHEME_MUSCL;
    assert_near(scene_step_stable(&s), 0.0025 / 1.185, 1e-15);
    assert_near(scene_step_positive(&s), 0.00125 / 1.185, 1e-15);
    s.macro.step = 0.0;
    // The bound is 0.0010549 s: 0.01 s in 10 steps, not in 9.
    assert_near(scene_macro_step(&s), 0.001, 1e-18);
    scene_fini(&s);
}

static void an_auto_step_fits_into_the_period_of_the_curve(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.step = 0.0;
    // The bound is 0.0021097 s: 0.01 s in 5 steps, not in 4.
    assert_near(scene_macro_step(&s), 0.002, 1e-18);
    for (double every = 1e-4; every < 1.0; every *= 1.13) {
        s.output.curve_every = every;
        double step = scene_macro_step(&s), n = every / step;
        assert_true(step < scene_step_positive(&s));
        if (every >= scene_step_positive(&s)) {
            assert_near(n, round(n), 1e-9 * n);
            assert_true(every / (round(n) - 1.0) >= scene_step_positive(&s));
        } else {
            assert_near(step, scene_step_positive(&s), 1e-8 * step);
        }
    }
    scene_fini(&s);
}

static void an_auto_step_is_no_longer_than_the_run(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.step = 0.0;
    s.duration = 1e-4;
    assert_true(scene_macro_step(&s) == 1e-4);
    s.duration = 6.0;
    s.belts[0].velocity.x = s.macro.dispersion = 0.0;
    assert_true(scene_macro_step(&s) == 6.0);
    scene_fini(&s);
}

// Half of 0.005 m / 0.395 m/s = 6.33 ms, and of the 0.01 s between two samples.
static void the_congested_closure_has_steps_of_its_own(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.closure = SCENE_CONGESTED;
    assert_true(scene_macro_step(&s) == 0.00125);
    s.macro.step = 0.0;
    assert_near(scene_macro_step(&s), 0.005, 1e-17);
    s.output.curve_every = 1.0; // 158 steps of 6.33 ms
    assert_near(scene_macro_step(&s), 1.0 / 158.0, 1e-17);
    s.output.curve_every = 0.001;
    assert_near(scene_macro_step(&s), 0.5 * 0.005 / 0.395, 1e-17);
    assert_near(scene_step_stable(&s), 0.5 * 0.005 / 0.395, 1e-17);
    assert_true(isinf(scene_step_positive(&s)));
    s.macro.dispersion = 100.0; // has no effect
    assert_near(scene_step_stable(&s), 0.5 * 0.005 / 0.395, 1e-17);
    s.macro.scheme = SCENE_SCHEME_MUSCL;
    assert_near(scene_step_stable(&s), 0.25 * 0.005 / 0.395, 1e-17);
    scene_fini(&s);
}

static void the_default_is_congested_in_steps_and_cells_that_are_chosen(void **state)
{
    scene s;

    scene_init(&s);
    helper_scene_resolve(&s);
    assert_int_equal(s.macro.closure, SCENE_CONGESTED);
    assert_true(s.macro.step == 0.0);
    assert_true(s.macro.cell == 0.0);
    assert_true(s.macro.jam_density == 0.93);
    scene_fini(&s);
}

// The paper's step is the default where its closure is chosen and the cell is named.
static void the_papers_step_belongs_to_cells_that_are_given(void **state)
{
    scene s;

    for (int is_named = 0; is_named < 2; is_named++) {
        scene_init(&s);
        s.macro.closure = SCENE_DISPERSIVE;
        s.macro.cell = is_named ? 0.005 : 0.0;
        helper_scene_resolve(&s);
        assert_true(s.macro.step == (is_named ? 0.00125 : 0.0));
        scene_fini(&s);
    }
}

// The paper's 2500/m2 for its 12 mm, in proportion to 1/r2; a disk of 0.04 m2 has r2 = 0.04/pi: 28.27; cells of 0.5 m allow 4.
static void the_gaussian_of_a_part_has_its_size(void **state)
{
    static const struct {
        scene_shape shape;
        double cell, expected;
    } cases[] = {
        { { .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.01 }, 0.0, 2500.0 },
        { { .type = SCENE_CYLINDER, .radius = 0.120, .height = 0.01 }, 0.0, 25.0 },
        { { .type = SCENE_BOX, .length = 0.4, .width = 0.1, .height = 0.1 }, 0.0, 28.27 },
        { { .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.01 }, 0.5, 4.0 },
    };
    scene s;

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scene_init(&s);
        s.domain = (scene_rect){ 0.0, 2.0, 0.0, 1.0 };
        s.cargo[0].shape = cases[k].shape;
        s.macro.cell = cases[k].cell;
        helper_scene_resolve(&s);
        assert_near(s.macro.initial_mollifier, cases[k].expected, 1e-12);
        scene_fini(&s);
    }
}

static double mass_of(scene *s)
{
    s->cargo[0].mass = NAN;
    helper_scene_resolve(s);
    double mass = s->cargo[0].mass;
    scene_fini(s);
    return mass;
}

static void the_mass_of_a_solid_is_steel_times_its_volume(void **state)
{
    // Two unit cubes' corners with points inside, on an edge and on a face; a regular octahedron of
    // unit radius has the volume 4/3.
    static const double cube[12][3] = {
        { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 },    { 1, 1, 0 },  { 0, 0, 1 },   { 1, 0, 1 },
        { 0, 1, 1 }, { 1, 1, 1 }, { .5, .5, .5 }, { .5, 0, 0 }, { .3, .4, 1 }, { 1, .5, .7 }
    };
    static const double octahedron[6][3] = { { 1, 0, 0 },  { -1, 0, 0 }, { 0, 1, 0 },
                                             { 0, -1, 0 }, { 0, 0, 1 },  { 0, 0, -1 } };
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    helper_scene_set_vertices(&s, SCENE_HULL, cube, 12);
    assert_near(mass_of(&s), 7850.0, 1e-8);
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    helper_scene_set_vertices(&s, SCENE_HULL, octahedron, 6);
    assert_near(mass_of(&s), 7850.0 * 4.0 / 3.0, 1e-8);
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.cargo[0].shape.type = SCENE_BOX;
    s.cargo[0].shape.length = 0.03;
    s.cargo[0].shape.width = 0.02;
    s.cargo[0].shape.height = 0.01;
    assert_near(mass_of(&s), 7850.0 * 6e-6, 1e-15);
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    static const double triangle[3][3] = { { 0, 0, 0 }, { 2, 0, 0 }, { 0, 1, 0 } };
    helper_scene_set_vertices(&s, SCENE_PRISM, triangle, 3);
    s.cargo[0].shape.height = 3.0;
    assert_near(mass_of(&s), 7850.0 * 3.0, 1e-8);
}

static void the_hull_of_a_fine_cylinder_has_nearly_its_volume(void **state)
{
    // A prism over a regular 32-gon: area n/2 R^2 sin(2 pi/n); all ends are facets of 32 corners.
    double vertices[64][3];
    scene s;

    for (int k = 0; k < 64; k++) {
        vertices[k][0] = 0.012 * cos(k / 2 * M_PI / 16.0);
        vertices[k][1] = 0.012 * sin(k / 2 * M_PI / 16.0);
        vertices[k][2] = k % 2 * 0.008;
    }
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    helper_scene_set_vertices(&s, SCENE_HULL, (const double(*)[3])vertices, 64);
    double area = 16.0 * 0.012 * 0.012 * sin(M_PI / 16.0);
    assert_near(resolved_packing(&s), floor(M_PI / (2.0 * sqrt(3.0)) / area), 0.0);
    assert_near(mass_of(&s), 7850.0 * area * 0.008, 1e-14);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_are_those_of_the_paper),
        cmocka_unit_test(the_papers_treatments_have_a_narrower_slide_zone_and_no_mirror),
        cmocka_unit_test(several_items_without_ids_are_numbered),
        cmocka_unit_test(resolving_twice_changes_nothing),
        cmocka_unit_test(without_memory_the_scene_is_as_before),
        cmocka_unit_test(the_grid_of_the_examples_is_that_of_the_paper),
        cmocka_unit_test(close_packing_has_the_density_of_its_shape),
        cmocka_unit_test(steps_are_bounded_by_stability_and_positivity),
        cmocka_unit_test(an_auto_step_fits_into_the_period_of_the_curve),
        cmocka_unit_test(an_auto_step_is_no_longer_than_the_run),
        cmocka_unit_test(the_congested_closure_has_steps_of_its_own),
        cmocka_unit_test(the_default_is_congested_in_steps_and_cells_that_are_chosen),
        cmocka_unit_test(the_papers_step_belongs_to_cells_that_are_given),
        cmocka_unit_test(the_gaussian_of_a_part_has_its_size),
        cmocka_unit_test(the_mass_of_a_solid_is_steel_times_its_volume),
        cmocka_unit_test(the_hull_of_a_fine_cylinder_has_nearly_its_volume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
