// What lies outside the comparison of the models where feeds keep an opening full, with the values computed by hand.

#include "core/advice/validity.h"
#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

// The value of a figure that is outside, NAN: it is not.
static double value_outside(const scene *s, validity_figure figure)
{
    validity of;
    double value = NAN;

    assert_int_equal(validity_of(s, &of, NULL), BF_OK);
    for (size_t k = 0; k < of.n; k++)
        value = of.items[k].figure == figure ? of.items[k].value : value;
    return value;
}

// A plate leaves 0.2 m of 0.6 m, of which 200 parts/s are 1.5 times what it passes when full.
static void make_full(scene *s, double degrees)
{
    helper_scene_example(s, degrees, SCENE_SEALED);
    s->obstacles[0].path[0] = (vec2){ 0.75 - 0.4 / tan(degrees * M_PI / 180.0), 0.0 };
    s->obstacles[0].path[1].y = 0.4;
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->macro.closure = SCENE_CONGESTED;
    helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_POISSON, 200.0);
    helper_scene_resolve(s);
}

// Without friction and with 0.5 at 45 degrees, not at 60, nor where few parts are offered.
static void queues_slide_along_shallow_plates_as_their_friction_lets_them(void **state)
{
    scene s;

    make_full(&s, 45.0);
    double *friction = &s.micro.contact[SCENE_HANDLING_CARGO].friction;
    assert_true(isnan(value_outside(&s, VALIDITY_SLIDING)));
    *friction = 0.0;
    assert_near(value_outside(&s, VALIDITY_SLIDING), 0.0, 0.0);
    *friction = 0.5;
    assert_near(value_outside(&s, VALIDITY_SLIDING), 0.5, 0.0);
    s.feeds[0].rate = 50.0;
    assert_true(isnan(value_outside(&s, VALIDITY_SLIDING)));
    scene_fini(&s);
    make_full(&s, 60.0);
    s.micro.contact[SCENE_HANDLING_CARGO].friction = 0.0;
    assert_true(isnan(value_outside(&s, VALIDITY_SLIDING)));
    scene_fini(&s);
}

// Two plates at 25 degrees, 0.2 m apart; at 35 degrees they were compared.
static void shallow_funnels_were_not_compared_where_they_are_full(void **state)
{
    static const double angles[] = { 25.0, 35.0 };

    for (int k = 0; k < 2; k++) {
        const double foot = 0.7 - 0.2 / tan(angles[k] * M_PI / 180.0);
        const vec2 right[] = { { foot, 0.0 }, { 0.7, 0.2 } },
                   left[] = { { foot, 0.6 }, { 0.7, 0.4 } };
        scene s;
        make_full(&s, 45.0);
        memcpy(s.obstacles[0].path, right, sizeof right);
        helper_scene_add_obstacle(&s, left, 2, SCENE_SEALED);
        helper_scene_resolve(&s);
        const double angle = value_outside(&s, VALIDITY_FUNNEL_ANGLE);
        if (k == 0)
            assert_near(angle, 25.0, 1e-9);
        else
            assert_true(isnan(angle));
        scene_fini(&s);
    }
}

// Feeds over half of the belt and all but a part's width of it; over half of it between guides.
static void feeds_on_a_part_of_the_belt_were_not_compared_where_cargo_queues(void **state)
{
    static const vec2 guide[] = { { 0.0, 0.32 }, { 0.15, 0.32 } };
    scene s;

    make_full(&s, 60.0);
    scene_feed *feed = &s.feeds[0];
    assert_true(isnan(value_outside(&s, VALIDITY_BESIDE)));
    feed->line[0].y = 0.024;
    feed->line[1].y = 0.576;
    assert_true(isnan(value_outside(&s, VALIDITY_BESIDE)));
    feed->line[1].y = 0.3;
    assert_near(value_outside(&s, VALIDITY_BESIDE), 1.0, 0.0);
    helper_scene_add_obstacle(&s, guide, 2, SCENE_SEALED);
    assert_true(isnan(value_outside(&s, VALIDITY_BESIDE)));
    scene_fini(&s);
}

// A plate that ends at x = 0.75 m, and a belt half as fast from 0.87 m on, 5 diameters of 24 mm.
static void another_belt_behind_a_full_opening_was_not_compared(void **state)
{
    static const vec2 behind[] = { { 0.87, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.6 }, { 0.87, 0.6 } };
    scene s;

    make_full(&s, 60.0);
    assert_true(isnan(value_outside(&s, VALIDITY_NEXT_BELT)));
    helper_scene_add_belt(&s, (vec2){ 0.1975, 0.0 }, behind, 4);
    assert_near(value_outside(&s, VALIDITY_NEXT_BELT), 5.0, 1e-6);
    scene_fini(&s);
}

// A plate at 60 degrees that ends 16.7, 0.4 and 0.6 diameters of 24 mm off its wall.
static void short_ends_of_plates_were_not_compared_where_the_opening_is_full(void **state)
{
    scene s;

    make_full(&s, 60.0);
    assert_true(isnan(value_outside(&s, VALIDITY_SHORT_END)));
    s.obstacles[0].path[1].y = 0.4 * 0.024;
    s.obstacles[0].path[0].x = 0.75 - 0.4 * 0.024 / tan(M_PI / 3.0);
    s.feeds[0].rate = 2000.0;
    assert_near(value_outside(&s, VALIDITY_SHORT_END), 0.4, 1e-6);
    s.feeds[0].rate = 50.0;
    assert_true(isnan(value_outside(&s, VALIDITY_SHORT_END)));
    s.obstacles[0].path[1].y = 0.6 * 0.024;
    s.feeds[0].rate = 2000.0;
    assert_true(isnan(value_outside(&s, VALIDITY_SHORT_END)));
    scene_fini(&s);
}

// The foot of the plate is 21.6 to 1 diameters of 24 mm behind the feed; it was compared from 8 on.
static void short_queues_before_full_openings_were_not_compared(void **state)
{
    static const struct {
        double diameters;
        bool is_outside;
    } cases[] = { { 21.6, false }, { 8.1, false }, { 7.0, true }, { 1.0, true } };
    scene s;

    make_full(&s, 60.0);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        s.feeds[0].line[0].x = s.feeds[0].line[1].x =
            s.obstacles[0].path[0].x - cases[k].diameters * 0.024;
        const double value = value_outside(&s, VALIDITY_QUEUE);
        assert_int_equal(isnan(value), !cases[k].is_outside);
        if (cases[k].is_outside)
            assert_near(value, cases[k].diameters, 1e-6);
    }
    scene_fini(&s);
}

// From 0.7 of the 133 parts/s on that pass when it is full.
static void friction_of_parts_was_compared_in_a_range_where_an_opening_is_nearly_full(void **state)
{
    scene s;

    make_full(&s, 60.0);
    double *friction = &s.micro.contact[SCENE_CARGO_CARGO].friction;
    s.feeds[0].rate = 100.0;
    assert_true(isnan(value_outside(&s, VALIDITY_FRICTION_FULL)));
    *friction = 0.0;
    assert_near(value_outside(&s, VALIDITY_FRICTION_FULL), 0.0, 0.0);
    *friction = 0.8;
    assert_near(value_outside(&s, VALIDITY_FRICTION_FULL), 0.8, 0.0);
    s.feeds[0].rate = 80.0;
    assert_true(isnan(value_outside(&s, VALIDITY_FRICTION_FULL)));
    scene_fini(&s);
}

// v^2/(2 mu g) on a belt of friction 0.2 at 0.395 m/s is 1.66 diameters of 24 mm.
static void fast_belts_were_not_compared_where_an_opening_is_nearly_full(void **state)
{
    scene s;

    make_full(&s, 60.0);
    assert_true(isnan(value_outside(&s, VALIDITY_ACCELERATION_FULL)));
    s.micro.contact[SCENE_CONVEYOR_CARGO].friction = 0.2;
    assert_near(value_outside(&s, VALIDITY_ACCELERATION_FULL), 0.395 * 0.395 / (0.4 * 9.81 * 0.024),
                1e-9);
    s.feeds[0].rate = 80.0;
    assert_true(isnan(value_outside(&s, VALIDITY_ACCELERATION_FULL)));
    scene_fini(&s);
}

static void a_belt_without_friction_is_told_without_a_number_where_an_opening_is_nearly_full(
    void **state)
{
    validity of;
    const char *title = "";
    scene s;

    make_full(&s, 60.0);
    s.micro.contact[SCENE_CONVEYOR_CARGO].friction = 0.0;
    assert_int_equal(validity_of(&s, &of, NULL), BF_OK);
    for (size_t k = 0; k < of.n_never; k++)
        title = of.never[k].figure == VALIDITY_ACCELERATION_FULL ? of.never[k].title : title;
    assert_string_equal(title, "The opening is nearly full, and without friction the fastest belt "
                               "brings no part to its speed");
    scene_fini(&s);
}

// A plate at 60 degrees that goes on along the belt, with its foot 21.6 and 5 diameters of 24 mm behind the feed.
static void short_queues_before_full_lanes_were_not_compared(void **state)
{
    scene s;

    make_full(&s, 60.0);
    const vec2 foot = s.obstacles[0].path[0], tip = s.obstacles[0].path[1];
    const vec2 lane[] = { foot, tip, { tip.x + 0.1, tip.y } };
    memory_free(s.obstacles[0].path);
    s.n_obstacles = 0;
    helper_scene_add_obstacle(&s, lane, 3, SCENE_SEALED);
    assert_true(isnan(value_outside(&s, VALIDITY_LANE_QUEUE)));
    s.feeds[0].line[0].x = s.feeds[0].line[1].x = foot.x - 0.12;
    assert_near(value_outside(&s, VALIDITY_LANE_QUEUE), 5.0, 1e-6);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(queues_slide_along_shallow_plates_as_their_friction_lets_them),
        cmocka_unit_test(shallow_funnels_were_not_compared_where_they_are_full),
        cmocka_unit_test(feeds_on_a_part_of_the_belt_were_not_compared_where_cargo_queues),
        cmocka_unit_test(another_belt_behind_a_full_opening_was_not_compared),
        cmocka_unit_test(short_ends_of_plates_were_not_compared_where_the_opening_is_full),
        cmocka_unit_test(short_queues_before_full_openings_were_not_compared),
        cmocka_unit_test(friction_of_parts_was_compared_in_a_range_where_an_opening_is_nearly_full),
        cmocka_unit_test(fast_belts_were_not_compared_where_an_opening_is_nearly_full),
        cmocka_unit_test(
            a_belt_without_friction_is_told_without_a_number_where_an_opening_is_nearly_full),
        cmocka_unit_test(short_queues_before_full_lanes_were_not_compared),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
