// Warnings about members that the closure does not use, and about cells that had to be fitted.

#include "core/advice/review_closure.h"

#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static void use_smooth(scene *s)
{
    s->macro.heaviside = SCENE_HEAVISIDE_SMOOTH;
}

static void use_width(scene *s)
{
    s->macro.heaviside_width = 0.1;
}

static void use_dispersion(scene *s)
{
    s->macro.dispersion = 0.5;
}

static void use_mollifier(scene *s)
{
    s->macro.mollifier = 1000.0;
}

static void use_band(scene *s)
{
    s->obstacles[0].band = 0.02;
}

static void use_slide(scene *s)
{
    s->obstacles[0].slide_width = 0.02;
}

static void use_jam(scene *s)
{
    s->macro.jam_density = 0.8;
}

static void use_nothing(scene *s)
{
}

static void use_cell(scene *s)
{
    s->macro.cell = 0.25; // 0.6 m are 2 of 0.3 m
}

static void use_nearly_fitting_cell(scene *s)
{
    s->macro.cell = 0.0101;
}

static void what_the_closure_does_not_use_is_warned_of(void **state)
{
    static const struct {
        scene_closure closure;
        scene_treatment treatment;
        void (*use)(scene *s);
        const char *pointer; // of the warning; NULL: none
    } cases[] = {
        { SCENE_CONGESTED, SCENE_SEALED, use_nothing, NULL },
        { SCENE_DISPERSIVE, SCENE_FIELD, use_nothing, NULL },
        { SCENE_CONGESTED, SCENE_FIELD, use_nothing, "/obstacles/0/treatment" },
        { SCENE_CONGESTED, SCENE_SEALED, use_band, "/obstacles/0/band_m" },
        { SCENE_CONGESTED, SCENE_SEALED, use_slide, "/obstacles/0/slide_width_m" },
        { SCENE_CONGESTED, SCENE_SEALED, use_smooth, "/macro/heaviside" },
        { SCENE_CONGESTED, SCENE_SEALED, use_width, "/macro/heaviside_width" },
        { SCENE_CONGESTED, SCENE_SEALED, use_dispersion, "/macro/dispersion_m_s" },
        { SCENE_CONGESTED, SCENE_SEALED, use_mollifier, "/macro/mollifier_per_m2" },
        { SCENE_CONGESTED, SCENE_SEALED, use_jam, NULL },
        { SCENE_DISPERSIVE, SCENE_SEALED, use_jam, "/macro/jam_density" },
        { SCENE_DISPERSIVE, SCENE_SEALED, use_smooth, NULL },
        { SCENE_CONGESTED, SCENE_SEALED, use_cell, "/macro/cell_m" },
        { SCENE_CONGESTED, SCENE_SEALED, use_nearly_fitting_cell, NULL },
    };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scene s;
        review_warnings found = { 0 };
        helper_scene_example(&s, 60.0, cases[k].treatment);
        s.macro.closure = cases[k].closure;
        cases[k].use(&s);
        review_closure(&s, &found);
        if (cases[k].pointer == NULL && found.n > 0)
            fail_msg("case %zu: %s", k, found.items[0].title);
        if (cases[k].pointer != NULL) {
            // A mollifier of one's own has other widths of obstacles, which are set: all are told.
            assert_true(found.n >= 1);
            assert_string_equal(found.items[0].pointer, cases[k].pointer);
        }
        scene_fini(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_the_closure_does_not_use_is_warned_of),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
