// Goods before a plate at the defaults: parts overlap little, none gets through, harder parts pass as fast; and what
// happens where a number makes them too soft.

#include "core/advice/advice.h"
#include "core/base/memory.h"
#include "core/micro/hardness.h"
#include "core/micro/micro.h"
#include "core/run/micro_press.h"
#include "core/run/micro_setup.h"
#include "core/run/run.h"
#include "core/scene/shape.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Goods, in the plane or in space.
typedef struct goods {
    scene_shape shape;
    double mass;  // kg
    double width; // across, m
} goods;

static const goods can = { { .type = SCENE_CYLINDER, .radius = 0.033, .height = 0.115 },
                           0.35,
                           0.066 };
static const goods keg = { { .type = SCENE_CYLINDER, .radius = 0.205, .height = 0.4 }, 12.5, 0.41 };
static const goods carton = { { .type = SCENE_BOX, .length = 0.24, .width = 0.18, .height = 0.12 },
                              1.7,
                              0.24 };

// A belt of 0.4 m/s, 15 by 9 widths, a plate at 60 degrees that leaves 4 of them, and more parts than come through.
static void make_line(scene *s, const goods *of, double duration)
{
    const double w = of->width, tip = 5.0 * w, x = 11.0 * w;
    const vec2 path[] = { { x - tip / sqrt(3.0), 0.0 }, { x, tip } };

    helper_scene_belt(s, 15.0 * w, 9.0 * w, w / 6.0, NULL, 0);
    s->initial.type = SCENE_INITIAL_COUNT;
    helper_scene_add_obstacle(s, path, 2, SCENE_SEALED);
    s->cargo[0].shape = of->shape;
    s->cargo[0].mass = of->mass;
    s->cargo[0].material = (scene_material){ 210e9, 0.28 };
    helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_POISSON, 6.0 * 0.4 / w);
    s->duration = duration;
    s->output.curve_every = 0.1;
    s->output.snapshot_every = duration;
    helper_scene_resolve(s);
}

static helper_run_log *run_line(const scene *s)
{
    helper_run_log *log = calloc(1, sizeof *log);

    assert_non_null(log);
    log->model = RUN_MICRO;
    assert_int_equal(helper_run(s, 1, 0, log), BF_OK);
    return log;
}

static void check_goods(const goods *of, double duration, double most)
{
    scene s;

    make_line(&s, of, duration);
    helper_run_log *log = run_line(&s);
    assert_true(log->end.overlap_share > 0.0 && log->end.overlap_share < most);
    assert_true(log->end.reduction >= 1.0 && log->end.reduction <= log->end.reduction_start);
    helper_run_free(log);
    scene_fini(&s);
}

// 2 % is aimed at; a crowd that stops at once may be heavier than the line that is reckoned with.
static void goods_overlap_little_at_the_defaults(void **state)
{
    check_goods(&can, HELPER_AMOUNT(15.0, 8.0), 0.05);
    check_goods(&keg, HELPER_AMOUNT(60.0, 30.0), 0.05);
    check_goods(&carton, HELPER_AMOUNT(15.0, 8.0), 0.05);
}

// 36 parts on the belt before the plate.
static void make_heap(scene *s, const goods *of)
{
    make_line(s, of, 15.0);
    s->n_feeds = 0;
    memory_free(s->feeds);
    s->feeds = NULL;
    s->initial.type = SCENE_INITIAL_HEXAGONAL;
    s->initial.n_rows = s->initial.n_columns = 6;
    s->initial.spacing = 2.06 * shape_footprint_of(&of->shape).bounding_radius;
    s->initial.first = (vec2){ s->initial.spacing, s->initial.spacing };
}

static micro_solver *start(const micro_def *def)
{
    micro_solver *s = NULL;

    assert_int_equal(micro_create(def, &s, NULL), BF_OK);
    return s;
}

static void check_soft(const goods *of)
{
    micro_setup setup;
    static advice given;
    micro_press press;
    scene s;
    bf_error err = { 0 };
    bool is_warned = false;

    make_heap(&s, of);
    s.micro.modulus_reduction = 1e6;
    assert_int_equal(advice_of(&s, RUN_MICRO, &given, NULL), BF_OK);
    for (size_t k = 0; k < given.warnings.n; k++)
        is_warned =
            is_warned || strcmp(given.warnings.items[k].pointer, "/micro/modulus_reduction") == 0;
    assert_true(is_warned);
    assert_int_equal(micro_setup_init(&s, NULL, 1, &setup, NULL), BF_OK);
    micro_solver *solver = start(&setup.def);
    assert_false(micro_press_now(solver, &press));
    assert_int_equal(micro_advance(solver, 10000, &err), BF_ENUMERIC);
    assert_true(micro_press_now(solver, &press));
    assert_true(press.overlap > 0.2 && press.part < 36);
    assert_int_equal(micro_press_fail(&s, &press, 1.0, &err), BF_ENUMERIC);
    assert_string_equal(err.pointer, "/micro/modulus_reduction");
    press.other = UINT64_MAX;
    assert_int_equal(micro_press_fail(&s, &press, 1.0, &err), BF_ENUMERIC);
    assert_non_null(strstr(err.text, "the plate 'obstacle-1'"));
    micro_destroy(solver);
    micro_setup_fini(&setup);
    scene_fini(&s);
}

// With the paper's modulus_reduction a part is pressed into the plate by more than 20 % of its radius.
static void parts_that_are_too_soft_fail_with_part_and_plate(void **state)
{
    check_soft(&can);
    check_soft(&carton);
}

// A part of 1 g between parts of 1 kg, at the hardness of their materials: the masses are the cause.
static void a_light_part_between_heavy_ones_fails_with_the_masses(void **state)
{
    const micro_press press = { .overlap = 0.3, .part = 1, .other = 2, .at = { 0.1, 0.5 } };
    bf_error err = { 0 };
    scene s;

    make_heap(&s, &can);
    s.micro.modulus_reduction = 0.0; // "auto"
    scene mixed = s;
    mixed.n_obstacles = 0;
    mixed.n_cargo = 2;
    mixed.cargo[1] = mixed.cargo[0];
    mixed.cargo[0].mass = 1e-3;
    mixed.cargo[1].mass = 1.0;
    assert_int_equal(micro_press_fail(&mixed, &press, 1.0, &err), BF_ENUMERIC);
    assert_string_equal(err.pointer, "/cargo");
    mixed.cargo[0].mass = 0.5;
    assert_int_equal(micro_press_fail(&mixed, &press, 1.0, &err), BF_ENUMERIC);
    assert_string_equal(err.pointer, "/micro/modulus_reduction");
    scene_fini(&s);
}

// Belt and plate each press a carton onto the other by their frictions, 1.1 and 1: without bound.
static void a_carton_that_belt_and_plate_wedge_fails_with_their_frictions(void **state)
{
    static const char *const pointers[] = { "/contacts/handling_cargo/friction",
                                            "/micro/modulus_reduction", "/micro/modulus_reduction",
                                            "/micro/modulus_reduction" };

    for (int k = 0; k < 4; k++) {
        micro_press press = { .overlap = 0.3, .part = 1 };
        bf_error err = { 0 };
        scene s;
        make_heap(&s, k == 1 ? &can : &carton);
        s.micro.modulus_reduction = 0.0; // "auto"
        s.micro.contact[SCENE_CONVEYOR_CARGO].friction = 0.1;
        s.belts[0].friction = k == 2 ? 0.9 : 1.1;
        s.micro.contact[SCENE_HANDLING_CARGO].friction = 1.0;
        press.at = s.obstacles[0].path[1];
        press.other = k == 3 ? 2 : UINT64_MAX;
        assert_int_equal(micro_press_fail(&s, &press, 1.0, &err), BF_ENUMERIC);
        assert_string_equal(err.pointer, pointers[k]);
        scene_fini(&s);
    }
}

// A part that is squeezed out beside a plate that moves is that plate's fault; farther away, or beside one that stands, the
// solver's own words stay.
static void a_part_that_is_squeezed_out_fails_with_the_plate(void **state)
{
    const double times[] = { 0.0, 1.0 }, angles[] = { 0.0, 0.5 };
    bf_error err = { .pointer = "", .text = "as it was" };
    scene s;

    make_heap(&s, &can);
    const vec2 foot = s.obstacles[0].path[0];
    const micro_thrown near = { 7, { foot.x, foot.y + 2.9 * s.cargo[0].shape.radius }, 26.0 };
    assert_int_equal(micro_press_fail_thrown(&s, &near, 1.0, &err), BF_ENUMERIC);
    assert_string_equal(err.text, "as it was");
    s.obstacles[0].turn = helper_scene_series(2, times, angles, INFINITY);
    const micro_thrown far = { 7, { foot.x - 50.0, foot.y }, 26.0 };
    assert_int_equal(micro_press_fail_thrown(&s, &far, 1.0, &err), BF_ENUMERIC);
    assert_string_equal(err.text, "as it was");
    assert_int_equal(micro_press_fail_thrown(&s, &near, 1.0, &err), BF_ENUMERIC);
    assert_string_equal(err.pointer, "/obstacles/0/motion");
    assert_non_null(
        strstr(err.text, "part 7 was squeezed out by the plate 'obstacle-1' with 26 m/s"));
    // One that actions alone move has no motion to point at.
    s.obstacles[0].turn.n_times = 0;
    s.obstacles[0].is_commanded = true;
    assert_int_equal(micro_press_fail_thrown(&s, &near, 1.0, &err), BF_ENUMERIC);
    assert_string_equal(err.pointer, "/obstacles/0");
    // Of two that move it is the nearer one's.
    const vec2 closer[] = { near.at, { near.at.x, near.at.y + 0.01 } };
    helper_scene_add_obstacle(&s, closer, 2, SCENE_SEALED)->turn =
        helper_scene_series(2, times, angles, INFINITY);
    assert_int_equal(micro_press_fail_thrown(&s, &near, 1.0, &err), BF_ENUMERIC);
    assert_string_equal(err.pointer, "/obstacles/1/motion");
    scene_fini(&s);
}

// The expected overlap d of a line of mass M = 2 L m/2r under F = mu g M, from v, with k of steel on aluminium:
// k d^2/2 = M v^2/2 + F d.
static void the_expected_overlap_stops_the_line(void **state)
{
    micro_setup setup;
    scene s;

    make_line(&s, &can, 15.0);
    assert_int_equal(micro_setup_init(&s, NULL, 1, &setup, NULL), BF_OK);
    const micro_def *def = &setup.def;
    const double r = can.shape.radius, length = def->domain.x_max - def->domain.x_min;
    const double mass = 2.0 * length * can.mass / (2.0 * r), v = s.belts[0].velocity.x;
    const double compliance = (1.0 - 0.28 * 0.28) / 210e9 + (1.0 - 0.34 * 0.34) / 70e9;
    const double k = 0.25 * M_PI * 0.008 / compliance / def->modulus_reduction;
    const double overlap = hardness_expected_overlap(def) * r;
    const double energy = 0.5 * mass * v * v + 1.0 * 9.81 * mass * overlap;
    assert_near(overlap, 0.02 * r, 1e-9 * r);
    assert_near(0.5 * k * overlap * overlap, energy, 1e-9 * energy);
    micro_setup_fini(&setup);
    scene_fini(&s);
}

// Critical damping of a mass m on a spring k is 2 sqrt(k m): 20 N s/m for 1 kg on 100 N/m.
static void dashpots_are_at_most_four_times_critical_where_the_hardness_is_chosen(void **state)
{
    micro_def def = micro_def_default();
    def.hardens = true;
    def.integrator = MICRO_IMPLICIT;
    assert_near(hardness_dashpot(&def, 119.0, 100.0, 1.0), 80.0, 1e-12);
    assert_near(hardness_dashpot(&def, 119.0, 100.0, 4.0), 40.0, 1e-12);
    assert_true(hardness_dashpot(&def, 79.0, 100.0, 1.0) == 79.0);
    def.integrator = MICRO_VERLET;
    assert_true(hardness_dashpot(&def, 119.0, 100.0, 1.0) == 119.0);
    def.integrator = MICRO_IMPLICIT;
    def.hardens = false;
    assert_true(hardness_dashpot(&def, 119.0, 100.0, 1.0) == 119.0);
}

// The loads are as the mass, and so is the stiffness that they require: light parts need no shorter steps.
static void light_parts_take_steps_as_long_as_heavy_ones(void **state)
{
    const goods *const all[] = { &can, &carton };

    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        double steps[2];
        for (int light = 0; light < 2; light++) {
            micro_setup setup;
            scene s;
            make_line(&s, all[k], 15.0);
            s.cargo[0].mass = light ? 1e-4 : all[k]->mass;
            assert_int_equal(micro_setup_init(&s, NULL, 1, &setup, NULL), BF_OK);
            steps[light] = setup.def.dt;
            micro_setup_fini(&setup);
            scene_fini(&s);
        }
        assert_true(steps[1] > 0.9 * steps[0]);
    }
}

// Begun too soft, contacts become harder; a solver that takes a state of half the way ends with the same bits.
static void parts_that_press_harder_than_foreseen_become_harder(void **state)
{
    micro_setup setup;
    bf_buffer saved = { 0 };
    scene s;

    make_heap(&s, &can);
    assert_int_equal(micro_setup_init(&s, NULL, 1, &setup, NULL), BF_OK);
    setup.def.modulus_reduction = 3e4;
    micro_solver *whole = start(&setup.def), *resumed = start(&setup.def);
    assert_int_equal(micro_advance(whole, 505, NULL), BF_OK);
    assert_int_equal(micro_save(whole, &saved, NULL), BF_OK);
    assert_int_equal(micro_advance(whole, 500, NULL), BF_OK);
    assert_int_equal(micro_load(resumed, saved.bytes, saved.n, NULL), BF_OK);
    for (int k = 0; k < 100; k++)
        assert_int_equal(micro_advance(resumed, 5, NULL), BF_OK);
    assert_true(micro_reduction(whole) < 3e4);
    assert_true(micro_reduction(resumed) == micro_reduction(whole));
    assert_true(micro_digest(resumed) == micro_digest(whole));
    buffer_fini(&saved);
    micro_destroy(whole);
    micro_destroy(resumed);
    micro_setup_fini(&setup);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(goods_overlap_little_at_the_defaults),
        cmocka_unit_test(parts_that_are_too_soft_fail_with_part_and_plate),
        cmocka_unit_test(a_part_that_is_squeezed_out_fails_with_the_plate),
        cmocka_unit_test(a_light_part_between_heavy_ones_fails_with_the_masses),
        cmocka_unit_test(a_carton_that_belt_and_plate_wedge_fails_with_their_frictions),
        cmocka_unit_test(the_expected_overlap_stops_the_line),
        cmocka_unit_test(dashpots_are_at_most_four_times_critical_where_the_hardness_is_chosen),
        cmocka_unit_test(light_parts_take_steps_as_long_as_heavy_ones),
        cmocka_unit_test(parts_that_press_harder_than_foreseen_become_harder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
