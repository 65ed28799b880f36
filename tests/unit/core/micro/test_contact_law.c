// The contact law against the paper's table, by hand.

#include "core/micro/contact_law.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static const scene_material steel = { 210e9, 0.28 }, conveyor = { 40e9, 0.05 },
                            handling = { 70e9, 0.34 };
static const scene_contact contact = { 0.008, 119.0, 0.15, 10.0, 1.0 };

static void steel_on_steel_has_716_newtons_a_metre(void **state)
{
    // pi/4 * 210e3 / (2 (1 - 0.28^2)) * 0.008 = 715.86.
    assert_near(contact_law_of_line(&contact, &steel, &steel, 1e6).stiffness, 715.86, 0.01);
}

static void different_materials_add_their_softness(void **state)
{
    // (1 - 0.0784)/210e9 + (1 - 0.1156)/70e9 = 4.38857e-12 + 1.263429e-11 = 1.702286e-11 1/Pa.
    assert_near(contact_law_modulus(&steel, &handling, 1.0) * 1.702286e-11, 1.0, 1e-6);
    assert_true(contact_law_modulus(&steel, &handling, 1.0) ==
                contact_law_modulus(&handling, &steel, 1.0));
    // pi/4 * 0.008 / 1.702286e-5 = 369.10.
    assert_near(contact_law_of_line(&contact, &steel, &handling, 1e6).stiffness, 369.10, 0.01);
}

static void a_disk_on_the_belt_has_twice_modulus_times_radius(void **state)
{
    // 1/E* = 4.38857e-12 + (1 - 0.0025)/40e9 = 2.932607e-11 1/Pa; 2 * 0.012 / 2.932607e-5 = 818.38.
    assert_near(contact_law_of_disk(&contact, &steel, &conveyor, 1e6, 0.012).stiffness, 818.38,
                0.01);
}

static void reduction_divides_the_stiffness_and_nothing_else(void **state)
{
    micro_law soft = contact_law_of_line(&contact, &steel, &steel, 1e6);
    micro_law hard = contact_law_of_line(&contact, &steel, &steel, 1e4);

    assert_near(hard.stiffness / soft.stiffness, 100.0, 1e-9);
    assert_true(hard.damping == 119.0 && soft.damping == 119.0);
    assert_true(hard.friction == 0.15 && hard.tanh_linear == 10.0 && hard.tanh_spin == 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steel_on_steel_has_716_newtons_a_metre),
        cmocka_unit_test(different_materials_add_their_softness),
        cmocka_unit_test(a_disk_on_the_belt_has_twice_modulus_times_radius),
        cmocka_unit_test(reduction_divides_the_stiffness_and_nothing_else),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
