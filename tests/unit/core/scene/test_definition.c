// The digest that the checkpoints of a run belong to.

#include "core/scene/definition.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static void make_scene(scene *s)
{
    helper_scene_example(s, 60.0, SCENE_SEALED);
    s->belts[0].acceleration = s->belts[0].deceleration = 1.0;
    helper_scene_schedule(&s->belts[0], 2, (double[]){ 0.5, 1.0 }, (double[]){ 0.5, 1.0 });
    s->obstacles[0].turn =
        helper_scene_series(2, (double[]){ 0.5, 1.0 }, (double[]){ 0.1, 0.2 }, INFINITY);
    helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_POISSON, 10.0);
    scene_stops *stops = &s->belts[0].stops;
    const scene_series listed =
        helper_scene_series(2, (double[]){ 1.0, 2.0 }, (double[]){ 0.1, 0.2 }, INFINITY);
    stops->failures = memory_alloc(2, sizeof *stops->failures);
    stops->breaks = memory_alloc(1, sizeof *stops->breaks);
    assert_true(stops->failures != NULL && stops->breaks != NULL);
    stops->n_failures = 2;
    stops->n_breaks = 1;
    stops->failures[0] = (scene_failure){ .id = "f",
                                          .between = { 60.0, SCENE_TIME_WEIBULL, 1.5 },
                                          .repair = { 6.0, SCENE_TIME_WEIBULL, 2.0 } };
    stops->failures[1] = (scene_failure){ .id = "g",
                                          .type = SCENE_FAILURE_LISTED,
                                          .n_times = 2,
                                          .times = listed.times,
                                          .n_durations = 2,
                                          .durations = listed.values };
    stops->breaks[0] = (scene_break){ 1.0, 2.0, 3.0 };
}

static void a_definition_that_differs_in_one_number_has_another_digest(void **state)
{
    scene s;

    make_scene(&s);
    const uint64_t digest = definition_digest(&s);
    double *const numbers[] = { &s.domain.x_max,
                                &s.duration,
                                &s.belts[0].velocity.x,
                                &s.belts[0].incline,
                                &s.belts[0].acceleration,
                                &s.belts[0].deceleration,
                                &s.belts[0].speed_schedule.times[1],
                                &s.belts[0].speed_schedule.factors[1],
                                &s.belts[0].stops.failures[0].between.mean,
                                &s.belts[0].stops.failures[0].between.shape,
                                &s.belts[0].stops.failures[0].repair.mean,
                                &s.belts[0].stops.failures[0].repair.shape,
                                &s.belts[0].stops.failures[1].times[1],
                                &s.belts[0].stops.failures[1].durations[0],
                                &s.belts[0].stops.breaks[0].start,
                                &s.belts[0].stops.breaks[0].duration,
                                &s.belts[0].stops.breaks[0].every,
                                &s.obstacles[0].thickness,
                                &s.obstacles[0].path[1].y,
                                &s.obstacles[0].turn.times[1],
                                &s.obstacles[0].turn.values[1],
                                &s.cargo[0].shape.radius,
                                &s.cargo[0].material.young_modulus,
                                &s.cargo[0].mass,
                                &s.cargo[0].spin_friction_radius,
                                &s.feeds[0].rate,
                                &s.counters[0].rect.x_max,
                                &s.output.curve_every,
                                &s.macro.step,
                                &s.macro.dispersion,
                                &s.macro.mollifier,
                                &s.macro.heaviside_width,
                                &s.micro.step,
                                &s.micro.modulus_reduction,
                                &s.micro.damping,
                                &s.micro.gravity,
                                &s.micro.handling.young_modulus,
                                &s.micro.contact[SCENE_CARGO_CARGO].friction,
                                &s.micro.contact[SCENE_CONVEYOR_CARGO].tanh_linear,
                                &s.micro.contact[SCENE_CONVEYOR_CARGO].tanh_spin };
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        const double number = *numbers[k];
        *numbers[k] = number == 0.0 ? 0x1p-40 : number * (1.0 - 0x1p-40);
        assert_true(definition_digest(&s) != digest);
        *numbers[k] = number;
    }
    assert_true(definition_digest(&s) == digest);
    scene_fini(&s);
}

static void a_definition_that_differs_in_a_choice_has_another_digest(void **state)
{
    scene s;

    make_scene(&s);
    const uint64_t digest = definition_digest(&s);
    s.edges[SCENE_EAST] = SCENE_EDGE_WALL;
    assert_true(definition_digest(&s) != digest);
    s.edges[SCENE_EAST] = SCENE_EDGE_OUTFLOW;
    s.macro.scheme = SCENE_SCHEME_MUSCL;
    assert_true(definition_digest(&s) != digest);
    s.macro.scheme = SCENE_SCHEME_ROE;
    s.macro.heaviside = SCENE_HEAVISIDE_NONE;
    assert_true(definition_digest(&s) != digest);
    s.macro.heaviside = SCENE_HEAVISIDE_SHARP;
    s.micro.path = SCENE_PATH_SPATIAL;
    assert_true(definition_digest(&s) != digest);
    s.micro.path = SCENE_PATH_AUTO;
    assert_true(definition_digest(&s) == digest);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_definition_that_differs_in_one_number_has_another_digest),
        cmocka_unit_test(a_definition_that_differs_in_a_choice_has_another_digest),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
