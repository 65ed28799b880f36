// Warnings about places at which cargo gets off the belts, in a domain of 1 x 0.6 m with parts of 12 mm.

#include "core/advice/review_belts.h"

#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static const scene_pose somewhere = { 0.1, 0.3, 0.0 };

// A belt along x up to x_end, and one from x_begin on to the end of the domain, if that lies in it.
static void make_scene(scene *s, double x_end, double x_begin)
{
    const vec2 first[] = { { 0.0, 0.0 }, { x_end, 0.0 }, { x_end, 0.6 }, { 0.0, 0.6 } };
    const vec2 second[] = { { x_begin, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.6 }, { x_begin, 0.6 } };

    helper_scene_belt(s, 1.0, 0.6, 0.01, &somewhere, 1);
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, first, 4);
    if (x_begin < 1.0)
        helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, second, 4);
}

static review_warnings warnings_of(scene *s)
{
    review_warnings found = { 0 };

    helper_scene_resolve(s);
    assert_int_equal(review_belts(s, &found, NULL), BF_OK);
    scene_fini(s);
    return found;
}

static void assert_one(const review_warnings *found, const char *title, const char *pointer,
                       const char *place)
{
    assert_int_equal(found->n, 1);
    assert_string_equal(found->items[0].title, title);
    assert_string_equal(found->items[0].pointer, pointer);
    assert_non_null(strstr(found->items[0].meaning, place));
}

static void belts_that_go_on_are_in_order(void **unused)
{
    scene s;

    make_scene(&s, 1.0, 1.0);
    assert_int_equal(warnings_of(&s).n, 0);
    make_scene(&s, 0.5, 0.5);
    assert_int_equal(warnings_of(&s).n, 0);
    make_scene(&s, 0.6, 0.5);
    assert_int_equal(warnings_of(&s).n, 0);
}

// The first of 101 places of the side that runs up from (0.5, 0).
static void a_belt_that_ends_is_named_with_the_place(void **unused)
{
    scene s;

    make_scene(&s, 0.5, 0.5121);
    const review_warnings found = warnings_of(&s);
    assert_one(&found, "Cargo leaves the belts", "/belts/0/polygon_m", "(0.5, 0.00297) m");
}

// One that ends where the domain begins carries nothing; one that reaches into it by a hair does.
static void a_belt_outside_of_the_domain_is_named(void **unused)
{
    static const struct {
        double x_begin;
        size_t n;
    } rows[] = { { 1.0, 1 }, { 0.999, 0 }, { 5.0, 1 } };
    scene s;

    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        const double x = rows[k].x_begin;
        const vec2 beyond[] = { { x, 0.0 }, { x + 1.0, 0.0 }, { x + 1.0, 0.3 }, { x, 0.3 } };
        make_scene(&s, x == 0.999 ? 0.999 : 1.0, 1.0);
        helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, beyond, 4);
        review_warnings found = { 0 };
        helper_scene_resolve(&s);
        review_belts_outside(&s, &found);
        assert_int_equal(warnings_of(&s).n, 0); // nothing falls there
        assert_int_equal(found.n, rows[k].n);
        if (rows[k].n > 0)
            assert_one(&found, "A belt lies outside of the domain", "/belts/1",
                       "0 m to 1 m by 0 m to 0.6 m");
    }
}

// The second belt alone, which runs back over its western side from 1 s on.
static void a_belt_that_runs_backwards_leads_off_over_its_other_end(void **unused)
{
    scene s;

    make_scene(&s, 0.4, 0.4);
    s.belts[0].polygon[0].x = s.belts[0].polygon[3].x = 0.05;
    assert_int_equal(warnings_of(&s).n, 0);
    make_scene(&s, 0.4, 0.4);
    s.belts[0].polygon[0].x = s.belts[0].polygon[3].x = 0.05;
    helper_scene_schedule(&s.belts[0], 1, (double[]){ 1.0 }, (double[]){ -0.5 });
    const review_warnings found = warnings_of(&s);
    assert_one(&found, "Cargo leaves the belts", "/belts/0/polygon_m", "(0.05, ");
}

static void a_gap_below_a_radius_is_bridged(void **unused)
{
    scene s;

    make_scene(&s, 0.5, 0.5119);
    assert_int_equal(warnings_of(&s).n, 0);
}

static void a_plate_at_the_end_holds_cargo(void **unused)
{
    scene s;

    make_scene(&s, 0.5, 1.0);
    helper_scene_add_obstacle(&s, (vec2[]){ { 0.5, 0.0 }, { 0.5, 0.6 } }, 2, SCENE_SEALED);
    assert_int_equal(warnings_of(&s).n, 0);
}

static void parts_off_every_belt_are_counted(void **unused)
{
    scene s;

    make_scene(&s, 1.0, 1.0);
    s.belts[0].polygon[0].x = s.belts[0].polygon[3].x = 0.2;
    const review_warnings found = warnings_of(&s);
    assert_one(&found, "Cargo starts off every belt", "/initial", "1 of 1 parts");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(belts_that_go_on_are_in_order),
        cmocka_unit_test(a_belt_that_ends_is_named_with_the_place),
        cmocka_unit_test(a_belt_outside_of_the_domain_is_named),
        cmocka_unit_test(a_belt_that_runs_backwards_leads_off_over_its_other_end),
        cmocka_unit_test(a_gap_below_a_radius_is_bridged),
        cmocka_unit_test(a_plate_at_the_end_holds_cargo),
        cmocka_unit_test(parts_off_every_belt_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
