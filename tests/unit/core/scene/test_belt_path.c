// Paths: their sections, what these share, and what may be wrong with them.

#include "core/scene/belt_path.h"

#include "core/base/memory.h"
#include "core/observe/figure.h"
#include "core/scene/belt.h"
#include "core/scene/surroundings.h"
#include "core/world/world.h"
#include "tests/unit/core/helper_faults.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

// Right, up and right again: two corners of 90 degrees.
static const vec2 points[] = { { 0.0, 0.5 }, { 1.5, 0.5 }, { 1.5, 2.5 }, { 3.0, 2.5 } };

static void make_path(scene *s)
{
    helper_scene_belt(s, 3.0, 3.0, 0.05, (scene_pose[]){ { 0.3, 0.5, 0.0 } }, 1);
    helper_scene_add_path(s, 0.4, 0.5, 0.6, points, 4);
}

// From the start: 0.9 m straight, a quarter of a circle of 0.6 m, 0.8 m, a quarter, 0.9 m.
static vec2 place_on_centre_line(double way)
{
    const double quarter = 0.6 * 0.5 * M_PI;

    if (way < 0.9)
        return (vec2){ way, 0.5 };
    if (way < 0.9 + quarter)
        return (vec2){ 0.9 + 0.6 * sin((way - 0.9) / 0.6), 1.1 - 0.6 * cos((way - 0.9) / 0.6) };
    if (way < 1.7 + quarter)
        return (vec2){ 1.5, 1.1 + way - 0.9 - quarter };
    const double turned = (way - 1.7 - quarter) / 0.6;
    if (turned < 0.5 * M_PI)
        return (vec2){ 2.1 - 0.6 * cos(turned), 1.9 + 0.6 * sin(turned) };
    return (vec2){ 2.1 + way - 1.7 - 2.0 * quarter, 2.5 };
}

static void on_the_centre_line_a_path_has_its_speed_along_it(void **state)
{
    scene s;

    make_path(&s);
    helper_scene_resolve(&s);
    assert_int_equal(s.n_belts, 1);
    assert_int_equal(s.n_sections, 5);
    const surroundings around = surroundings_of(&s);
    for (double way = 0.01; way < 4.4; way += 0.07) {
        const vec2 at = place_on_centre_line(way), next = place_on_centre_line(way + 1e-5);
        const vec2 v = surroundings_velocity_under(&around, at);
        const vec2 expected = vec2_scale(vec2_sub(next, at), 0.4 / 1e-5);
        assert_near(vec2_length(vec2_sub(v, expected)), 0.0, 1e-4);
        // Its borders are half the width aside.
        const vec2 aside = vec2_scale(vec2_turn_left(v), 1.0 / 0.4);
        for (int side = -1; side <= 1; side += 2) {
            const vec2 within = vec2_add(at, vec2_scale(aside, 0.2499 * side));
            const vec2 beyond = vec2_add(at, vec2_scale(aside, 0.2501 * side));
            assert_true(surroundings_belt_below(&around, within) < s.n_sections);
            assert_true(surroundings_belt_below(&around, beyond) == s.n_sections);
        }
    }
    scene_fini(&s);
}

static void the_lanes_of_an_arc_of_a_path_turn_as_a_whole(void **state)
{
    scene s;

    make_path(&s);
    helper_scene_resolve(&s);
    const surroundings around = surroundings_of(&s);
    const vec2 centre = { 0.9, 1.1 }, ray = { sqrt(0.5), -sqrt(0.5) };
    for (double radius = 0.36; radius < 0.85; radius += 0.1) {
        const vec2 at = vec2_add(centre, vec2_scale(ray, radius));
        const double speed = vec2_length(surroundings_velocity_under(&around, at));
        assert_near(speed, 0.4 * radius / 0.6, 1e-12);
    }
    scene_fini(&s);
}

static void a_path_is_one_belt_for_commands_figures_and_stops(void **state)
{
    bf_world w;
    scene s;

    make_path(&s);
    helper_scene_schedule(&s.belts[0], 1, (double[]){ 2.0 }, (double[]){ 0.5 });
    s.actions = memory_alloc(1, sizeof *s.actions);
    s.n_actions = 1;
    scene_action_init(&s.actions[0]);
    s.actions[0].type = SCENE_ACTION_BELT;
    s.actions[0].target = 0;
    s.actions[0].value = 0.25;
    s.belts[0].friction = 0.3;
    helper_scene_resolve(&s);
    assert_int_equal(figure_items(&s, FIGURE_OF_BELT), 1);
    assert_int_equal(world_init(&w, &s, NULL), BF_OK);
    for (size_t k = 0; k < s.n_sections; k++) {
        assert_int_equal(scene_belt_of(&s, k), 0);
        assert_string_equal(s.belts[k].id, "main");
        assert_true(s.belts[k].friction == 0.3);
        assert_true(belt_speeds_at(&w.belts, k, 1.0) == 1.0);
        assert_true(belt_speeds_at(&w.belts, k, 3.0) == 0.5);
    }
    world_command(&w, &s.actions[0], 4.0);
    for (size_t k = 0; k < s.n_sections; k++)
        assert_true(belt_speeds_at(&w.belts, k, 5.0) == 0.25);
    world_fini(&w);
    scene_fini(&s);
}

static void cargo_leaves_a_path_at_the_outlet_of_its_last_section(void **state)
{
    scene s;

    make_path(&s);
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 },
                          (vec2[]){ { 2.0, 0.0 }, { 3.0, 0.0 }, { 3.0, 0.5 }, { 2.0, 0.5 } }, 4);
    helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 1.0);
    helper_scene_resolve(&s);
    assert_int_equal(figure_items(&s, FIGURE_OF_OUTLET), 2);
    const surroundings around = surroundings_of(&s);
    const size_t last = surroundings_belt_below(&around, (vec2){ 2.9, 2.5 });
    assert_true(last >= s.n_belts);
    assert_int_equal(figure_outlet(&s, last), 0);
    scene_fini(&s);
}

// So that the document of a run is one of the same run.
static void a_resolved_path_resolves_to_itself(void **state)
{
    scene_belt first[5];
    scene s;

    make_path(&s);
    s.belts[0].velocity = (vec2){ 0.1, -0.3 }; // only its size counts
    helper_scene_resolve(&s);
    assert_near(s.belts[0].velocity.x, hypot(0.1, 0.3), 1e-15);
    assert_true(s.belts[0].velocity.y == 0.0);
    memcpy(first, s.belts, sizeof first);
    helper_scene_resolve(&s);
    assert_int_equal(s.n_sections, 5);
    for (size_t k = 0; k < 5; k++) {
        assert_memory_equal(&s.belts[k].velocity, &first[k].velocity, sizeof first[k].velocity);
        assert_true(s.belts[k].turn == first[k].turn);
        assert_memory_equal(&s.belts[k].centre, &first[k].centre, sizeof first[k].centre);
        assert_int_equal(s.belts[k].n_points, first[k].n_points);
    }
    scene_fini(&s);
}

// Its velocity keeps its bits, whatever its direction: the size of a vector that was scaled is not always that again.
static void a_path_in_any_direction_keeps_its_velocity(void **state)
{
    for (int k = 0; k < 90; k++) {
        const vec2 along = { cos(0.07 * k), sin(0.07 * k) };
        const vec2 line[] = { { 1.5, 1.5 }, vec2_add((vec2){ 1.5, 1.5 }, along) };
        scene s;
        helper_scene_belt(&s, 3.0, 3.0, 0.05, (scene_pose[]){ { 1.5, 1.5, 0.0 } }, 1);
        helper_scene_add_path(&s, 0.37, 0.5, 0.6, line, 2);
        helper_scene_resolve(&s);
        const vec2 first = s.belts[0].velocity;
        assert_near(vec2_length(vec2_sub(first, vec2_scale(along, 0.37))), 0.0, 1e-15);
        helper_scene_resolve(&s);
        assert_memory_equal(&s.belts[0].velocity, &first, sizeof first);
        scene_fini(&s);
    }
}

static void without_memory_for_its_sections_a_scene_says_so(void **state)
{
    size_t n = 1;
    bf_status status;

    do {
        scene s;
        make_path(&s);
        memory_plan_fault(n++, 0);
        status = scene_resolve(&s, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || status == BF_ENOMEM);
        scene_fini(&s);
    } while (status != BF_OK);
    assert_true(n > 5);
}

#define SPOIL(name, code)                                                                          \
    static void name(scene *s)                                                                     \
    {                                                                                              \
        scene_belt *belt = &s->belts[0];                                                           \
        scene_belt_path *path = &belt->path;                                                       \
        (void)belt, (void)path;                                                                    \
        code;                                                                                      \
    }
SPOIL(no_width, path->width = 0.0)
SPOIL(one_point, path->n_points = 1)
SPOIL(no_radius, path->n_radii = 1)
SPOIL(tight, path->radii[1] = 0.25)
SPOIL(repeated, path->points[2] = path->points[1])
SPOIL(far, path->points[3].x = INFINITY)
SPOIL(no_room, path->radii[1] = 1.45)
SPOIL(back, (path->points[3] = (vec2){ 1.5, 0.9 }))
SPOIL(hardly_bent, (path->points[1] = (vec2){ 0.75, 1.505 }))
SPOIL(rising, belt->incline = 0.1)
SPOIL(over_itself, (path->radii[0] = path->radii[1] = 0.3, path->points[3] = (vec2){ 0.3, -0.5 }))

static void beside_an_arc(scene *s)
{
    const vec2 beside[] = { { 1.6, 0.5 }, { 2.0, 0.5 }, { 2.0, 0.9 }, { 1.6, 0.9 } };

    helper_scene_add_belt(s, (vec2){ -0.4, 0.0 }, beside, 4);
}

static void over_a_straight(scene *s)
{
    const vec2 over[] = { { 0.2, 0.0 }, { 0.4, 0.0 }, { 0.4, 0.5 }, { 0.2, 0.5 } };

    helper_scene_add_belt(s, (vec2){ 0.0, 0.4 }, over, 4);
}

static void too_many(scene *s)
{
    for (int k = 0; k < 64; k++)
        helper_scene_add_path(s, 0.4, 0.1, 0.1, points, 4);
}

static void what_is_wrong_with_a_path_is_pointed_at(void **state)
{
    static const helper_faults_case bad[] = {
        { no_width, "/belts/0/path/width_m", "above 0" },
        { one_point, "/belts/0/path/points_m", "2 to 64 points" },
        { no_radius, "/belts/0/path/radius_m", "each of the 2 inner points, not 1" },
        { tight, "/belts/0/path/radius_m/1", "greater than half of width_m" },
        { repeated, "/belts/0/path/points_m/2", "repeats" },
        { far, "/belts/0/path/points_m/3", "within" },
        { no_room, "/belts/0/path/points_m/2", "the arcs of the corners there need 2.05 m" },
        { back, "/belts/0/path/points_m/2", "back by more than 179 degrees" },
        { hardly_bent, "/belts/0/path/points_m/1", "less than 1 degree" },
        { rising, "/belts/0/incline_deg", "level" },
        { over_itself, "/belts/0/path", "crosses itself" },
        { beside_an_arc, "/belts/0/path", "the belt 'belt-2' overlaps it or lies along it" },
        { over_a_straight, "/belts/0/path", "the belt 'belt-2' overlaps it" },
        { too_many, "/belts", "sections of paths" },
    };
    scene s;

    make_path(&s);
    helper_faults_none(&s);
    helper_faults_each(make_path, bad, sizeof bad / sizeof *bad);
}

static void cargo_may_come_over_the_side_of_a_straight_along_an_axis(void **state)
{
    const vec2 spur[] = { { 0.2, 0.0 }, { 0.5, 0.0 }, { 0.5, 0.25 }, { 0.2, 0.25 } };
    scene s;

    make_path(&s);
    helper_scene_add_belt(&s, (vec2){ 0.0, 0.4 }, spur, 4);
    helper_faults_none(&s);
}

// Each of 61 sections has 181 x 9 places that are looked for in 599 sides around it, or in twice as many.
static void outlines_beside_paths_are_looked_at_within_a_number_of_steps(void **state)
{
    enum { CORNERS = 32, ALONG = 594 };
    vec2 corners[CORNERS], beside[ALONG + 5];
    scene s;

    for (int k = 0; k < CORNERS; k++)
        corners[k] = (vec2){ 1.0 + 2.0 * k, 3.0 + k % 2 };
    for (int k = 0; k < ALONG; k++)
        beside[k] = (vec2){ 0.1 * k, 0.0 };
    memcpy(beside + ALONG,
           (vec2[]){ { 99.0, 0.0 }, { 99.0, 9.0 }, { 98.0, 9.0 }, { 98.0, 1.0 }, { 0.0, 1.0 } },
           5 * sizeof *beside);
    helper_scene_belt(&s, 99.0, 9.0, 0.05, (scene_pose[]){ { 2.0, 3.5, 0.0 } }, 1);
    helper_scene_add_path(&s, 0.4, 0.5, 0.6, corners, CORNERS);
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, beside, ALONG + 5);
    helper_faults_none(&s);
    helper_scene_belt(&s, 99.0, 9.0, 0.05, (scene_pose[]){ { 2.0, 3.5, 0.0 } }, 1);
    helper_scene_add_path(&s, 0.4, 0.5, 0.6, corners, CORNERS);
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, beside, ALONG + 5);
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, beside, ALONG + 5);
    helper_scene_resolve(&s);
    bf_faults faults = { .n = 0 };
    scene_check(&s, &faults);
    assert_int_equal(faults.n, 1);
    assert_int_equal(faults.items[0].code, BF_ELIMIT);
    assert_string_equal(faults.items[0].pointer, "/belts");
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(on_the_centre_line_a_path_has_its_speed_along_it),
        cmocka_unit_test(the_lanes_of_an_arc_of_a_path_turn_as_a_whole),
        cmocka_unit_test(a_path_is_one_belt_for_commands_figures_and_stops),
        cmocka_unit_test(cargo_leaves_a_path_at_the_outlet_of_its_last_section),
        cmocka_unit_test(a_resolved_path_resolves_to_itself),
        cmocka_unit_test(a_path_in_any_direction_keeps_its_velocity),
        cmocka_unit_test(without_memory_for_its_sections_a_scene_says_so),
        cmocka_unit_test(what_is_wrong_with_a_path_is_pointed_at),
        cmocka_unit_test(cargo_may_come_over_the_side_of_a_straight_along_an_axis),
        cmocka_unit_test(outlines_beside_paths_are_looked_at_within_a_number_of_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
