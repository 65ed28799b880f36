// Goods and the frictions of surfaces: each row is sound, and a scene has the frictions that follow from it.

#include "core/scene/goods.h"

#include "core/scene/scene.h"
#include "core/scene/shape.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static scene scene_of(size_t n, const scene_goods *goods)
{
    scene s;

    scene_init(&s);
    s.n_cargo = n;
    for (size_t k = 0; k < n; k++) {
        scene_cargo_init(&s.cargo[k]);
        goods_apply(goods[k], &s.cargo[k]);
    }
    return s;
}

static double friction(const scene *s, scene_pair pair)
{
    return s->micro.contact[pair].friction;
}

static void each_row_has_a_sound_shape_a_mass_and_a_source(void **unused)
{
    for (unsigned k = 0; k < SCENE_GOODS_COUNT; k++) {
        const scene_goods goods = (scene_goods)k;
        scene s = scene_of(1, &goods);
        bf_faults faults = { 0 };
        bf_error err;
        assert_int_equal(scene_resolve(&s, &err), BF_OK);
        shape_check(&s.cargo[0].shape, "", &faults);
        goods_check(&s, &faults);
        if (faults.n > 0)
            fail_msg("%s: %s", scene_goods_words[k], faults.items[0].text);
        // No goods are as heavy as solid steel,.
        const double volume = shape_volume(&s.cargo[0].shape);
        const double density = s.cargo[0].mass / volume;
        assert_true(density > 50.0 && density <= SCENE_STEEL_DENSITY * (1.0 + 1e-12));
        assert_true(strlen(goods_items[k].title) > 0 && goods_items[k].source != NULL);
        assert_true(strcmp(goods_items[k].source->title, "assumed") != 0 ||
                    strlen(goods_items[k].note) > 0);
        scene_fini(&s);
    }
}

static void each_pair_is_there_once_with_a_source(void **unused)
{
    for (size_t k = 0; k < goods_n_frictions; k++) {
        const goods_friction *pair = &goods_frictions[k];
        const double value = goods_friction_of(pair);
        assert_true(pair->low > 0.0 && pair->low <= pair->high && pair->high < 1.0);
        assert_true(value >= pair->low - 5e-5 && value <= pair->high + 5e-5);
        assert_true(strlen(pair->note) > 0);
        for (size_t j = 0; j < k; j++)
            assert_false((goods_frictions[j].a == pair->a && goods_frictions[j].b == pair->b) ||
                         (goods_frictions[j].a == pair->b && goods_frictions[j].b == pair->a));
    }
}

static void without_surfaces_frictions_are_the_papers(void **unused)
{
    const scene_goods paper = SCENE_PAPER_CYLINDER;
    scene s = scene_of(1, &paper);

    goods_resolve(&s);
    assert_true(friction(&s, SCENE_CARGO_CARGO) == 0.15);
    assert_true(friction(&s, SCENE_CONVEYOR_CARGO) == 1.0);
    assert_true(friction(&s, SCENE_HANDLING_CARGO) == 0.19);
    assert_int_equal(s.surfaces.conveyor, SCENE_SURFACE_COUNT);
    scene_fini(&s);
}

// Of the table: steel on steel 0.22 to 0.32, steel on acetal 0.25, steel on rubber 0.5 to 0.6, steel on PE 0.12 to 0.2.
static void surfaces_say_the_frictions_that_are_not_given(void **unused)
{
    const scene_goods can = SCENE_CAN_330;
    scene s = scene_of(1, &can), other = scene_of(1, &can);

    goods_resolve(&s);
    assert_true(friction(&s, SCENE_CARGO_CARGO) == 0.27);
    assert_true(friction(&s, SCENE_CONVEYOR_CARGO) == 0.25);
    assert_true(friction(&s, SCENE_HANDLING_CARGO) == 0.27);
    assert_int_equal(s.surfaces.conveyor, SCENE_ACETAL);
    assert_int_equal(s.surfaces.handling, SCENE_STEEL);
    other.surfaces = (scene_surfaces){ SCENE_RUBBER, SCENE_PE };
    other.micro.contact[SCENE_CARGO_CARGO].friction = 0.4;
    goods_resolve(&other);
    assert_true(friction(&other, SCENE_CARGO_CARGO) == 0.4);
    assert_true(friction(&other, SCENE_CONVEYOR_CARGO) == 0.55);
    assert_true(friction(&other, SCENE_HANDLING_CARGO) == 0.16);
    scene_fini(&s);
    scene_fini(&other);
}

static void check_fault(scene *s, const char *pointer, const char *part)
{
    bf_faults faults = { 0 };

    goods_resolve(s);
    goods_check(s, &faults);
    assert_true(faults.n > 0);
    assert_string_equal(faults.items[0].pointer, pointer);
    assert_non_null(strstr(faults.items[0].text, part));
    scene_fini(s);
}

static void a_friction_that_has_no_one_value_is_a_fault(void **unused)
{
    const scene_goods mix[] = { SCENE_CAN_330, SCENE_TRAY_24X330 };
    const scene_goods half[] = { SCENE_CAN_330, SCENE_PAPER_CYLINDER };
    scene s = scene_of(2, mix);

    s.micro.contact[SCENE_CARGO_CARGO].friction = 0.3;
    check_fault(&s, "/contacts/conveyor_cargo/friction", "different ones, 0.25 and 0.3");
    s = scene_of(2, half);
    check_fault(&s, "/contacts/cargo_cargo/friction", "a surface for kind 1");
    s = scene_of(1, mix);
    s.cargo[0].surface = SCENE_RUBBER;
    check_fault(&s, "/contacts/cargo_cargo/friction", "rubber on rubber");
    s = scene_of(1, half + 1);
    s.surfaces.conveyor = SCENE_PVC;
    check_fault(&s, "/surfaces/conveyor", "no cargo has a surface");
}

static void kinds_of_one_surface_mix(void **unused)
{
    const scene_goods cans[] = { SCENE_CAN_330, SCENE_KEG_30 };
    scene s = scene_of(2, cans);

    goods_resolve(&s);
    assert_true(friction(&s, SCENE_CONVEYOR_CARGO) == 0.25);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_row_has_a_sound_shape_a_mass_and_a_source),
        cmocka_unit_test(each_pair_is_there_once_with_a_source),
        cmocka_unit_test(without_surfaces_frictions_are_the_papers),
        cmocka_unit_test(surfaces_say_the_frictions_that_are_not_given),
        cmocka_unit_test(a_friction_that_has_no_one_value_is_a_fault),
        cmocka_unit_test(kinds_of_one_surface_mix),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
