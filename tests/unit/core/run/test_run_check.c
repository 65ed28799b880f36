// Faults for which a scenario cannot be solved with the macroscopic model, but with the microscopic one.

#include "core/run/run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static void assert_accepted(const scene *s, run_model model)
{
    bf_faults faults = { 0 };
    bf_error err = { 0 };

    run_check(s, model, &faults);
    if (faults_status(&faults, &err) != BF_OK)
        fail_msg("%s: %s", err.pointer, err.text);
}

// The scene, which is freed, is good but for the macroscopic model.
static void assert_macro_refuses(scene *s, bf_status code, const char *pointer, const char *text)
{
    bf_faults general = { 0 }, faults = { 0 };
    bf_error err = { 0 };

    scene_check(s, &general);
    assert_int_equal(general.n, 0);
    run_check(s, RUN_MACRO, &faults);
    assert_int_equal(faults.n, 1);
    assert_int_equal(faults_status(&faults, &err), code);
    assert_string_equal(err.pointer, pointer);
    if (strstr(err.text, text) == NULL)
        fail_msg("%s", err.text);
    assert_accepted(s, RUN_MICRO);
    scene_fini(s);
}

// 0.005 m / (0.395 m/s + 0.79 m/s) = 4.2194 ms.
static void macroscopic_steps_beyond_cfl_are_refused_with_the_largest_stable_one(void **state)
{
    scene s;
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.step = 0.005;
    assert_macro_refuses(&s, BF_EINPUT, "/macro/step_s", "0.0042194");
    // Both axes at once: half of that.
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.step = 0.0022;
    s.macro.scheme = SCENE_SCHEME_MUSCL;
    assert_macro_refuses(&s, BF_EINPUT, "/macro/step_s", "0.0021097");
    // Stable but perhaps not positive is the user's choice.
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.step = scene_step_stable(&s);
    assert_accepted(&s, RUN_MACRO);
    scene_fini(&s);
}

// A belt of 4 m/s: 0.005 m / (4 m/s + 0.79 m/s) = 1.0438 ms.
static void a_belt_too_fast_for_the_macroscopic_step_is_not_for_the_other_model(void **state)
{
    scene s;
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.belts[0].velocity.x = 4.0;
    assert_macro_refuses(&s, BF_EINPUT, "/macro/step_s", "0.0010438");
}

static void a_run_shorter_than_a_macroscopic_step_is_refused(void **state)
{
    scene s;
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.duration = 0.001;
    assert_macro_refuses(&s, BF_EINPUT, "/duration_s", "less than one step of 0.00125 s");
}

// tan(15 degrees)/0.3 = 0.89, tan(16 degrees)/0.3 = 0.96.
static void slopes_that_do_not_hold_cargo_are_refused(void **state)
{
    const double degree = M_PI / 180.0;

    for (double sign = -1.0; sign <= 1.0; sign += 2.0) {
        scene s;
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        s.macro.closure = SCENE_CONGESTED;
        s.belts[0].friction = 0.3;
        s.belts[0].incline = sign * 15.0 * degree;
        assert_accepted(&s, RUN_MACRO);
        s.belts[0].incline = sign * 16.0 * degree;
        assert_macro_refuses(&s, BF_EINPUT, "/belts/0/incline_deg", "slides");
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        s.belts[0].incline = sign * degree;
        assert_macro_refuses(&s, BF_EINPUT, "/belts/0/incline_deg", "'congested'");
    }
}

static void too_many_macroscopic_steps_are_refused_with_figure_and_limit(void **state)
{
    scene s;
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.step = 1e-9;
    assert_macro_refuses(&s, BF_ELIMIT, "/macro/step_s",
                         "6000000000 steps of the macroscopic model, the limit is 1000000000");
}

// ceil(4 / (sqrt(100) 0.005)) = 80 cells.
static void a_mollifier_that_covers_too_many_cells_is_refused(void **state)
{
    scene s;
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.mollifier = 100.0;
    assert_macro_refuses(&s, BF_ELIMIT, "/macro/mollifier_per_m2", "80 cells");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(macroscopic_steps_beyond_cfl_are_refused_with_the_largest_stable_one),
        cmocka_unit_test(a_belt_too_fast_for_the_macroscopic_step_is_not_for_the_other_model),
        cmocka_unit_test(a_run_shorter_than_a_macroscopic_step_is_refused),
        cmocka_unit_test(slopes_that_do_not_hold_cargo_are_refused),
        cmocka_unit_test(too_many_macroscopic_steps_are_refused_with_figure_and_limit),
        cmocka_unit_test(a_mollifier_that_covers_too_many_cells_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
