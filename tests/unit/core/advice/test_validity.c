// What lies outside the comparison of the models, figure by figure, with the values computed by hand.

#include "core/advice/validity.h"

#include "core/advice/bridges.h"
#include "core/advice/layout.h"
#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static validity validity_now(const scene *s)
{
    validity of;

    assert_int_equal(validity_of(s, &of, NULL), BF_OK);
    assert_int_equal(of.is_compared, of.n == 0 && of.n_never == 0);
    return of;
}

// The only item of a scene, which is freed.
static validity_item find_only(scene *s)
{
    const validity of = validity_now(s);

    for (size_t k = 1; k < of.n; k++)
        print_error("%s\n", of.items[k].detail);
    assert_int_equal(of.n, 1);
    assert_int_equal(of.n_never, 0);
    scene_fini(s);
    return of.items[0];
}

static void assert_only(scene *s, validity_figure figure, double value, const char *pointer)
{
    const validity_item item = find_only(s);

    assert_string_equal(validity_words[item.figure], validity_words[figure]);
    assert_near(item.value, value, 1e-9 * fabs(value));
    assert_true(item.value < item.minimum || item.value > item.maximum);
    assert_string_equal(item.pointer, pointer);
}

// Example 1 with a tip at another place above (0.75, 0), at an angle.
static void make_plate(scene *s, double degrees, double tip)
{
    helper_scene_example(s, degrees, SCENE_SEALED);
    s->obstacles[0].path[0].x = 0.75 - tip / tan(degrees * M_PI / 180.0);
    s->obstacles[0].path[0].y = 0.0;
    s->obstacles[0].path[1].y = tip;
}

// The paper's three: 30 to 90 degrees, 0.1 m are 4.17 diameters of 24 mm, 192 parts are 46 for each.
static void the_papers_examples_were_compared(void **state)
{
    static const double degrees[] = { 30.0, 45.0, 60.0, 75.0, 90.0 };

    for (size_t k = 0; k < sizeof degrees / sizeof *degrees; k++) {
        scene s;
        helper_scene_example(&s, degrees[k], SCENE_SEALED);
        assert_true(validity_now(&s).is_compared);
        scene_fini(&s);
    }
}

// The item of a figure of a scene in the congested closure, which is freed; of no figure if there is none.
static validity_item find_congested(scene *s, validity_figure figure)
{
    validity_item found = { .figure = VALIDITY_FIGURE_COUNT };

    helper_scene_resolve(s);
    s->macro.closure = SCENE_CONGESTED;
    const validity of = validity_now(s);
    for (size_t k = 0; k < of.n; k++)
        if (of.items[k].figure == figure)
            found = of.items[k];
    scene_fini(s);
    return found;
}

// By a belt of 0.6 m at 0.395 m/s, from the whole edge and from half of it.
static void a_feed_that_fills_its_belt_was_not_compared(void **state)
{
    static const double shares[] = { 0.79, 0.81 };

    for (int k = 0; k < 4; k++) {
        scene s;
        make_plate(&s, 45.0, 0.2);
        s.initial.type = SCENE_INITIAL_EMPTY;
        const double width = k < 2 ? 0.6 : 0.3;
        const double rate = shares[k % 2] * scene_packing_density(&s) * width * 0.395;
        scene_feed *feed = helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_POISSON, rate);
        if (k >= 2) {
            feed->line[0] = (vec2){ 0.0, 0.1 };
            feed->line[1] = (vec2){ 0.0, 0.4 };
        }
        const validity_item item = find_congested(&s, VALIDITY_FEED);
        assert_int_equal(item.figure == VALIDITY_FEED, k % 2 == 1);
        if (k % 2 == 1) {
            assert_near(item.value, 81.0, 1e-9);
            assert_string_equal(item.pointer, "/feeds/0");
        }
    }
}

// A plate at 45 degrees goes on along the belt, 4.5 or 6 diameters beside the wall; or it ends there. A guide elsewhere bends.
static void a_narrow_lane_beside_a_plate_was_not_compared(void **state)
{
    static const struct {
        double width;
        size_t n_points;
    } plates[] = { { 0.108, 3 }, { 0.144, 3 }, { 0.108, 2 } };
    static const vec2 guide[] = { { 0.75, 0.3 }, { 0.85, 0.30015 }, { 0.95, 0.3 } };

    for (int k = 0; k < 3; k++) {
        const double tip = 0.6 - plates[k].width;
        const vec2 path[] = { { 0.2, 0.0 }, { 0.2 + tip, tip }, { 0.5 + tip, tip } };
        scene s;
        make_plate(&s, 45.0, 0.2);
        helper_scene_add_obstacle(&s, path, plates[k].n_points, SCENE_SEALED);
        memory_free(s.obstacles[0].path);
        s.obstacles[0] = s.obstacles[1];
        s.n_obstacles = 1;
        helper_scene_add_obstacle(&s, guide, 3, SCENE_SEALED);
        const validity_item item = find_congested(&s, VALIDITY_LANE);
        assert_int_equal(item.figure == VALIDITY_LANE, k == 0);
        if (k == 0)
            assert_near(item.value, 4.5, 1e-9);
    }
}

static void the_end_of_a_heap_alone_was_not_compared(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.warmup = 2.0;
    assert_only(&s, VALIDITY_WARM_UP, 2.0, "/warmup_s");
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.warmup = 2.0;
    helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_POISSON, 5.0);
    helper_scene_resolve(&s);
    assert_true(validity_now(&s).is_compared);
    scene_fini(&s);
}

static void shallow_and_leaning_plates_were_not_compared(void **state)
{
    scene s;

    make_plate(&s, 20.0, 0.5);
    assert_only(&s, VALIDITY_ANGLE, 20.0, "/obstacles/0");
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.obstacles[0].path[0] = (vec2){ 0.95, 0.0 }; // 0.2 m behind its tip: atan(0.5/0.2)
    s.obstacles[0].path[1] = (vec2){ 0.75, 0.45 };
    assert_only(&s, VALIDITY_ANGLE, 180.0 - atan(0.45 / 0.2) * 180.0 / M_PI, "/obstacles/0");
}

static bool has_bridges(const validity *of)
{
    bool has = false;

    for (size_t k = 0; k < of->n; k++)
        has = has || of->items[k].figure == VALIDITY_BRIDGES;
    return has;
}

// 54 mm are 2.25 diameters, and 90 parts 40 for each of them.
static void narrow_openings_were_not_compared(void **state)
{
    scene s;

    make_plate(&s, 60.0, 0.546);
    s.initial.n_rows = 9;
    s.initial.n_columns = 10;
    const validity of = validity_now(&s);
    const validity_item item = of.items[0];
    assert_int_equal(of.n, 2);
    assert_true(has_bridges(&of));
    assert_int_equal(item.figure, VALIDITY_OPENING);
    assert_near(item.value, 2.25, 1e-9);
    assert_string_equal(item.unit, "diameters");
    assert_string_equal(item.pointer, "/obstacles/0");
    assert_string_equal(item.detail,
                        "The narrowest opening is 2.25 part diameters wide; the model was compared "
                        "with moving parts for 2.9 to 12.5 diameters. Parts may bridge the "
                        "opening, which a density cannot show.");
    scene_fini(&s);
}

// 54 mm are 2.25 diameters of a plate and a wall at 60 degrees, with the frictions 0.15 and 0.19. Feeds that offer less than
// half of what it passes make no queue, and boxes were not measured.
static void queues_that_stop_are_told_where_they_may_be(void **state)
{
    const bridges_outlet at = { false, 2.25, 60.0, 0.34 };
    validity of;
    scene s;

    make_plate(&s, 60.0, 0.546);
    of = validity_now(&s);
    assert_int_equal(of.items[1].figure, VALIDITY_BRIDGES);
    assert_near(of.items[1].value, 100.0 * bridges_probability(&at, 1000.0), 0.1);
    assert_string_equal(of.items[1].pointer, "/obstacles/0");
    assert_non_null(strstr(of.items[1].detail,
                           "Parts bridge this opening: solve it with the microscopic model."));
    assert_int_equal(validity_of_parts(&s, NAN, &of, NULL), BF_OK);
    assert_false(has_bridges(&of));
    s.initial.type = SCENE_INITIAL_EMPTY;
    helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_POISSON, 30.0);
    helper_scene_resolve(&s);
    of = validity_now(&s);
    assert_true(has_bridges(&of));
    s.feeds[0].rate = 5.0;
    of = validity_now(&s);
    assert_false(has_bridges(&of));
    s.feeds[0].rate = 30.0;
    s.cargo[0].shape.type = SCENE_BOX;
    s.cargo[0].shape.length = s.cargo[0].shape.width = 0.02;
    of = validity_now(&s);
    assert_false(has_bridges(&of));
    scene_fini(&s);
}

static void a_closed_belt_is_told_as_such(void **state)
{
    scene s;

    make_plate(&s, 60.0, 0.6);
    const validity_item item = find_only(&s);
    assert_int_equal(item.figure, VALIDITY_OPENING);
    assert_true(item.value == 0.0);
    assert_non_null(strstr(item.detail, "The deflectors close the belt"));
}

// 16 rows of 40 parts at 0.1 m: 640 parts, 153.6 for each diameter of the opening.
static void a_heap_that_saturates_the_opening_was_not_compared(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.initial.n_columns = 40;
    assert_only(&s, VALIDITY_HEAP, 153.6, "/initial");
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.initial.n_columns = 16; // 61.4
    assert_true(validity_now(&s).is_compared);
    s.initial.n_columns = 17; // 65.3
    assert_only(&s, VALIDITY_HEAP, 65.28, "/initial");
}

static void few_parts_were_not_compared(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.initial.n_rows = s.initial.n_columns = 4;
    assert_only(&s, VALIDITY_PARTS, 16.0, "/initial");
}

// Below and above the range: two items, the slow one first.
static void slow_and_fast_belts_were_not_compared(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.belts[0].velocity.x = 0.1;
    s.macro.dispersion = 0.2; // as by default, twice the speed
    assert_only(&s, VALIDITY_SPEED, 0.1, "/belts/0/velocity_m_s");
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.belts[0].velocity = (vec2){ 0.9, 0.0 };
    s.macro.dispersion = 1.8;
    assert_only(&s, VALIDITY_SPEED, 0.9, "/belts/0/velocity_m_s");
}

// The paper's 0.395 m/s, half of it, which is 0.1975 m/s, from 2 s on, and 0.79 m/s from 5 s on. Of the speeds below the range the
// one that is farthest out is told, a quarter from 3 s on.
static void belts_whose_speed_changes_were_not_compared(void **state)
{
    static const double times[] = { 2.0, 3.0, 4.0, 5.0 }, factors[] = { 0.5, 0.25, 0.5, 2.0 };
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    scene_speed_schedule *schedule = &s.belts[0].speed_schedule;
    schedule->times = memory_alloc(4, sizeof *times);
    schedule->factors = memory_alloc(4, sizeof *factors);
    assert_true(schedule->times != NULL && schedule->factors != NULL);
    memcpy(schedule->times, times, sizeof times);
    memcpy(schedule->factors, factors, sizeof factors);
    schedule->n_times = schedule->n_factors = 4;
    const validity of = validity_now(&s);
    assert_int_equal(of.n, 2);
    assert_int_equal(of.items[0].figure, VALIDITY_SPEED);
    assert_near(of.items[0].value, 0.09875, 1e-12);
    assert_string_equal(of.items[0].pointer, "/belts/0/speed_schedule/factor/1");
    assert_int_equal(of.items[1].figure, VALIDITY_SCHEDULES);
    scene_fini(&s);
}

static bool is_outside(const validity *of, validity_figure figure, const char *pointer)
{
    bool is = false;

    for (size_t k = 0; k < of->n; k++)
        is = is || (of->items[k].figure == figure && strcmp(of->items[k].pointer, pointer) == 0);
    return is;
}

static void slopes_of_more_than_12_degrees_were_not_compared(void **state)
{
    for (double sign = -1.0; sign <= 1.0; sign += 2.0)
        for (double degrees = 12.0; degrees <= 13.0; degrees += 1.0) {
            scene s;
            helper_scene_example(&s, 60.0, SCENE_SEALED);
            s.macro.closure = SCENE_CONGESTED;
            s.belts[0].incline = sign * degrees * M_PI / 180.0 * (1.0 - 1e-9);
            const validity of = validity_now(&s);
            assert_true(is_outside(&of, VALIDITY_INCLINE, "/belts/0/incline_deg") ==
                        (degrees > 12.0));
            scene_fini(&s);
        }
}

static void belts_of_several_velocities_were_not_compared(void **state)
{
    static const vec2 half[] = { { 0.0, 0.0 }, { 0.5, 0.0 }, { 0.5, 0.6 }, { 0.0, 0.6 } };
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    helper_scene_add_belt(&s, (vec2){ 0.5, 0.0 }, half, 4);
    s.macro.dispersion = 1.0;
    const validity of = validity_now(&s);
    assert_int_equal(of.n, 1);
    assert_int_equal(of.items[0].figure, VALIDITY_BELTS);
    assert_true(of.items[0].value == 2.0);
    assert_int_equal(of.n_never, 1); // the dispersive closure was compared on one belt alone
    assert_int_equal(of.never[0].figure, VALIDITY_RATIO);
    assert_near(of.never[0].value, 0.5 / 0.395, 1e-12);
    scene_fini(&s);
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    helper_scene_add_belt(&s, s.belts[0].velocity, half, 4);
    assert_true(validity_now(&s).is_compared);
    scene_fini(&s);
}

// 30 degrees upwards; the plate stands at 75 degrees to the x axis and 45 degrees to the belt.
static void a_belt_against_a_wall_was_not_compared(void **state)
{
    scene s;

    make_plate(&s, 75.0, 0.5);
    s.belts[0].velocity = (vec2){ 0.4 * cos(M_PI / 6.0), 0.4 * sin(M_PI / 6.0) };
    s.macro.dispersion = 0.8;
    assert_only(&s, VALIDITY_WALL, 30.0, "/edges/north");
}

// Two plates of 45 degrees, 0.2 m apart, 23 parts for each diameter.
static void a_funnel_was_not_compared(void **state)
{
    static const vec2 upper[] = { { 0.55, 0.6 }, { 0.75, 0.4 } };
    scene s;

    make_plate(&s, 45.0, 0.2);
    helper_scene_add_obstacle(&s, upper, 2, SCENE_SEALED);
    helper_scene_resolve(&s);
    assert_only(&s, VALIDITY_PLATES, 2.0, "/obstacles");
}

// A funnel of 0.2 m, the second plate of which is 72 mm, 3 diameters of 24 mm, farther down the belt. The domain ends 0.3 m behind it.
static void staggered_plates_were_not_compared_where_cargo_queues(void **state)
{
    static const vec2 upper[] = { { 0.622, 0.6 }, { 0.822, 0.4 } };
    scene s;

    make_plate(&s, 45.0, 0.2);
    helper_scene_add_obstacle(&s, upper, 2, SCENE_SEALED);
    helper_scene_resolve(&s);
    s.macro.closure = SCENE_CONGESTED;
    assert_only(&s, VALIDITY_STAGGER, 3.0, "/obstacles/1");
    make_plate(&s, 45.0, 0.2);
    helper_scene_add_obstacle(&s, upper, 2, SCENE_SEALED);
    s.initial.type = SCENE_INITIAL_EMPTY;
    helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_POISSON, 5.0);
    helper_scene_resolve(&s);
    s.macro.closure = SCENE_CONGESTED;
    const validity of = validity_now(&s);
    for (size_t k = 0; k < of.n; k++)
        assert_int_not_equal(of.items[k].figure, VALIDITY_STAGGER);
    scene_fini(&s);
}

// From 0.2 m, 8 diameters, beside one wall to as much beside the other, at 75 degrees and at 45.
static void a_steep_plate_with_two_free_ends_was_not_compared_where_cargo_queues(void **state)
{
    static const double angles[] = { 75.0, 45.0 };

    for (int k = 0; k < 2; k++) {
        const double foot = 0.5 - 0.2 / tan(angles[k] * M_PI / 180.0);
        const vec2 path[] = { { foot, 0.2 }, { 0.5, 0.4 } };
        scene s;
        make_plate(&s, 45.0, 0.2);
        memcpy(s.obstacles[0].path, path, sizeof path);
        helper_scene_resolve(&s);
        s.macro.closure = SCENE_CONGESTED;
        const validity of = validity_now(&s);
        bool is_told = false;
        for (size_t i = 0; i < of.n; i++)
            is_told = is_told || of.items[i].figure == VALIDITY_FREE_ENDS;
        assert_int_equal(is_told, k == 0);
        s.obstacles[0].path[0].y = 0.005; // a gap that nothing fits through
        const validity beside = validity_now(&s);
        for (size_t i = 0; i < beside.n; i++)
            assert_int_not_equal(beside.items[i].figure, VALIDITY_FREE_ENDS);
        scene_fini(&s);
    }
}

// The plate ends at x = 0.75 m, 4 diameters of 24 mm before the end of the domain.
static void a_plate_at_the_end_of_the_belt_was_not_compared(void **state)
{
    validity of;
    scene s;

    make_plate(&s, 45.0, 0.5);
    s.domain.x_max = 0.846;
    helper_scene_resolve(&s);
    s.macro.closure = SCENE_CONGESTED;
    assert_int_equal(validity_of_parts(&s, NAN, &of, NULL), BF_OK);
    assert_int_equal(of.items[0].figure, VALIDITY_RUN_OUT);
    assert_only(&s, VALIDITY_RUN_OUT, 4.0, "/obstacles/0");
}

static void a_plate_that_is_bent_twice_was_not_compared(void **state)
{
    static const vec2 path[] = { { 0.45, 0.0 }, { 0.6, 0.2 }, { 0.65, 0.35 }, { 0.75, 0.5 } };
    static const vec2 off[] = { { 0.45, -0.2 }, { 0.5, -0.1 } };
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    helper_scene_add_obstacle(&s, path, 4, SCENE_SEALED);
    memory_free(s.obstacles[0].path);
    s.obstacles[0] = s.obstacles[1];
    s.n_obstacles = 1;
    assert_only(&s, VALIDITY_BENDS, 2.0, "/obstacles/0");
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    helper_scene_add_obstacle(&s, off, 2, SCENE_SEALED);
    helper_scene_resolve(&s);
    assert_true(validity_now(&s).is_compared);
    scene_fini(&s);
}

// Disks of 20 mm, ten rows of ten: 100 mm are 5 of their diameters, and the cell 0.25 of one.
static void parts_of_another_size_were_not_compared(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.cargo[0].shape.radius = 0.010;
    s.initial.n_rows = s.initial.n_columns = 10;
    const validity_item item = find_only(&s);
    assert_int_equal(item.figure, VALIDITY_DIAMETER);
    assert_near(item.value, 0.020, 1e-12);
    assert_string_equal(item.unit, "m");
    assert_string_equal(item.pointer, "/cargo/shape");
}

// A box of 21 x 14 mm: its circle has a diameter of 25.2 mm, sqrt(21^2 + 14^2).
static void other_shapes_were_not_compared(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.cargo[0].shape = (scene_shape){ SCENE_BOX, .height = 0.01, .length = 0.021, .width = 0.014 };
    const validity_item item = find_only(&s);
    assert_int_equal(item.figure, VALIDITY_SHAPE);
    assert_near(item.value, 100.0, 1e-12);
    assert_true(isinf(item.minimum) && item.maximum == 0.0);
    assert_string_equal(item.pointer, "/cargo/shape");
    assert_string_equal(item.detail, "The share of parts that are no cylinders is 100 %; the model "
                                     "was compared with moving parts for cylinders alone.");
}

// Of 192 parts 144 are boxes, whose kind is the second.
static void mixes_were_not_compared(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.cargo[1] = s.cargo[0];
    s.cargo[1].shape = (scene_shape){ SCENE_BOX, .height = 0.01, .length = 0.021, .width = 0.014 };
    s.cargo[1].share = 3.0;
    s.n_cargo = 2;
    helper_scene_resolve(&s);
    const validity of = validity_now(&s);
    assert_int_equal(of.n, 2);
    assert_int_equal(of.items[0].figure, VALIDITY_SHAPE);
    assert_near(of.items[0].value, 75.0, 1e-12);
    assert_string_equal(of.items[0].pointer, "/cargo/1/shape");
    assert_int_equal(of.items[1].figure, VALIDITY_KINDS);
    assert_true(of.items[1].value == 2.0);
    assert_null(of.items[1].unit);
    assert_string_equal(of.items[1].pointer, "/cargo");
    scene_fini(&s);
}

static void other_frictions_were_not_compared(void **state)
{
    static const struct {
        scene_pair pair;
        double friction;
        validity_figure figure;
        const char *pointer;
    } rows[] = {
        { SCENE_HANDLING_CARGO, 0.6, VALIDITY_PLATE_FRICTION, "/contacts/handling_cargo/friction" },
        { SCENE_HANDLING_CARGO, 0.05, VALIDITY_PLATE_FRICTION,
          "/contacts/handling_cargo/friction" },
        { SCENE_CARGO_CARGO, 0.01, VALIDITY_PART_FRICTION, "/contacts/cargo_cargo/friction" },
        { SCENE_CONVEYOR_CARGO, 0.2, VALIDITY_BELT_FRICTION, "/contacts/conveyor_cargo/friction" },
    };

    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        scene s;
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        s.micro.contact[rows[k].pair].friction = rows[k].friction;
        assert_only(&s, rows[k].figure, rows[k].friction, rows[k].pointer);
    }
}

static void a_belt_without_friction_brings_no_part_to_its_speed(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.closure = SCENE_CONGESTED;
    s.micro.contact[SCENE_CONVEYOR_CARGO].friction = 0.0;
    const validity of = validity_now(&s);
    assert_int_equal(of.n_never, 1);
    assert_int_equal(of.never[0].figure, VALIDITY_ACCELERATION);
    assert_true(isnan(of.never[0].value));
    assert_string_equal(of.never[0].title,
                        "Without friction the fastest belt brings no part to its speed");
    scene_fini(&s);
}

static void only_sealed_plates_agree_with_moving_parts(void **state)
{
    static const scene_treatment others[] = { SCENE_FIELD, SCENE_WALL };

    for (size_t k = 0; k < 2; k++) {
        scene s;
        helper_scene_example(&s, 60.0, others[k]);
        assert_only(&s, VALIDITY_TREATMENT, 1.0, "/obstacles/0/treatment");
    }
}

// 10 mm are 0.4167 diameters.
static void coarse_grids_were_not_compared(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.cell = 0.01;
    assert_only(&s, VALIDITY_CELL, 0.01 / 0.024, "/macro/cell_m");
}

// Also one that lies along its belt, where no other figure is looked at.
static void obstacles_that_move_were_not_compared(void **state)
{
    scene s;

    for (int k = 0; k < 2; k++) {
        const double zero = 0.0;
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        if (k == 0) {
            s.obstacles[0].turn = helper_scene_series(1, &zero, &zero, INFINITY);
        } else {
            s.obstacles[0].path[0] = (vec2){ 0.4, 0.0 };
            s.obstacles[0].path[1] = (vec2){ 0.7, 0.0 };
            s.obstacles[0].is_commanded = true;
        }
        assert_only(&s, VALIDITY_MOTIONS, 1.0, "/obstacles/0");
    }
}

// A pusher was compared less than a plate that turns.
static void obstacles_that_are_shifted_were_not_compared(void **state)
{
    const scene_action shift = {
        .type = SCENE_ACTION_SHIFT, .target = 0, .shift = { 0.0, 0.1 }, .over = 0.5
    };
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.actions = memory_alloc(1, sizeof *s.actions);
    s.actions[0] = shift;
    s.n_actions = 1;
    s.obstacles[0].is_commanded = true;
    const validity v = validity_now(&s);
    bool is_told = false;
    assert_false(v.is_compared);
    for (size_t k = 0; k < v.n; k++)
        is_told = is_told || v.items[k].figure == VALIDITY_SHIFTS;
    assert_true(is_told);
    scene_fini(&s);
}

// 16 rows of 40 parts at 0.1 m, and a plate of 15 degrees: for the one closure both were compared.
static void each_closure_has_ranges_of_its_own(void **state)
{
    scene s;

    make_plate(&s, 15.0, 0.5);
    s.initial.n_columns = 40;
    assert_int_equal(validity_now(&s).subject, VALIDITY_DISPERSIVE);
    assert_int_equal(validity_now(&s).n, 2);
    s.macro.closure = SCENE_CONGESTED;
    assert_int_equal(validity_now(&s).subject, VALIDITY_CONGESTED);
    assert_true(validity_now(&s).is_compared);
    s.micro.contact[SCENE_HANDLING_CARGO].friction = 0.9;
    const validity_item item = find_only(&s);
    assert_int_equal(item.figure, VALIDITY_PLATE_FRICTION);
    assert_string_equal(item.detail, "The friction of parts on deflectors is 0.9; the model was "
                                     "compared with moving parts for 0 to 0.8.");
}

// Tips of 45 degrees 0.108 m apart are 4.5 diameters, a single plate has that opening, too.
static void openings_of_funnels_have_a_range_of_their_own(void **state)
{
    static const vec2 upper[] = { { 0.492, 0.6 }, { 0.75, 0.342 } };
    scene s;

    make_plate(&s, 45.0, 0.234);
    helper_scene_add_obstacle(&s, upper, 2, SCENE_SEALED);
    helper_scene_resolve(&s);
    s.macro.closure = SCENE_CONGESTED;
    assert_only(&s, VALIDITY_FUNNEL, 4.5, "/obstacles/1");
    make_plate(&s, 45.0, 0.468);
    s.macro.closure = SCENE_CONGESTED;
    assert_true(validity_now(&s).is_compared);
    scene_fini(&s);
}

static void plates_of_too_many_pieces_are_not_measured(void **state)
{
    static vec2 path[LAYOUT_PIECES_MAX + 2];
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    for (size_t k = 0; k < LAYOUT_PIECES_MAX + 2; k++)
        path[k] = (vec2){ 0.6, 0.0001 * (double)k };
    helper_scene_add_obstacle(&s, path, LAYOUT_PIECES_MAX + 1, SCENE_SEALED);
    helper_scene_resolve(&s);
    const validity of = validity_now(&s);
    assert_int_equal(of.n, 1);
    assert_int_equal(of.items[0].figure, VALIDITY_PIECES);
    assert_near(of.items[0].value, LAYOUT_PIECES_MAX + 1.0, 1e-9);
    assert_int_equal(of.n_never, 2); // nobody knows them
    assert_int_equal(of.never[0].figure, VALIDITY_ANGLE);
    assert_true(isnan(of.never[0].value));
    assert_int_equal(of.never[1].figure, VALIDITY_OPENING);
    scene_fini(&s);
}

// Whatever the cargo, its number and its speed: nothing is in its way.
static void cargo_that_nothing_deflects_rides_on_its_belt(void **state)
{
    static const scene_pose place = { 0.5, 0.3, 0.0 };
    scene s;

    helper_scene_belt(&s, 1.0, 0.6, 0.01, &place, 1);
    helper_scene_add_belt(&s, (vec2){ 2.0, 0.0 }, NULL, 0);
    helper_scene_resolve(&s);
    s.cargo[0].shape = (scene_shape){ SCENE_BOX, .height = 0.01, .length = 0.1, .width = 0.1 };
    assert_true(validity_now(&s).is_compared);
    scene_fini(&s);
}

static void every_figure_has_a_word_of_its_own(void **state)
{
    for (int k = 0; k < VALIDITY_FIGURE_COUNT; k++) {
        assert_non_null(validity_words[k]);
        for (int i = 0; i < k; i++)
            assert_string_not_equal(validity_words[k], validity_words[i]);
    }
    assert_null(validity_words[VALIDITY_FIGURE_COUNT]);
}

static void no_memory_is_reported(void **state)
{
    validity of = { .n = 7 };
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    memory_plan_fault(1, 0);
    assert_int_equal(validity_of(&s, &of, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_int_equal(of.n, 7);
    scene_fini(&s);
}

// A belt of 0.4 m along an S that carries 5 flat parts/s of 66 mm; mu on it is 1.
static void make_s(scene *s, double speed, double radius, bool has_lane)
{
    static const vec2 points[] = { { 0.0, 0.3 }, { 1.5, 0.3 }, { 2.5, 1.3 }, { 4.0, 1.3 } };
    static const vec2 lane[] = { { 0.3, 0.5 }, { 0.7, 0.5 }, { 0.7, 1.6 }, { 0.3, 1.6 } };

    helper_scene_belt(s, 4.0, 1.6, 0.022, NULL, 0);
    s->cargo[0].shape.radius = 0.033;
    s->cargo[0].mass = 0.1;
    s->macro.closure = SCENE_CONGESTED;
    s->duration = 100.0;
    s->micro.contact[SCENE_CONVEYOR_CARGO].friction = 1.0;
    helper_scene_add_path(s, speed, 0.4, radius, points, 4);
    if (has_lane)
        helper_scene_add_belt(s, (vec2){ 0.0, -speed }, lane, 4);
    s->n_feeds = 1;
    s->feeds = memory_alloc(1, sizeof *s->feeds);
    assert_non_null(s->feeds);
    scene_feed_init(&s->feeds[0]);
    s->feeds[0].is_edge = true;
    s->feeds[0].edge = SCENE_WEST;
    s->feeds[0].line[0].y = 0.2;
    s->feeds[0].line[1].y = 0.4;
    s->feeds[0].demand = SCENE_DEMAND_RATE;
    s->feeds[0].rate = 5.0;
    helper_scene_resolve(s);
}

// Curves of 1.2 widths of the belt and more were compared, up to v^2/(mu g R) of 23 %, but none that a lane comes to.
static void curves_were_compared_where_they_are_wide_and_slow(void **state)
{
    scene s;

    (void)state;
    make_s(&s, 0.4, 0.6, false);
    assert_true(validity_now(&s).is_compared);
    s.macro.closure = SCENE_DISPERSIVE;
    assert_false(validity_now(&s).is_compared);
    scene_fini(&s);
    make_s(&s, 0.4, 0.44, false);
    assert_only(&s, VALIDITY_CURVE, 1.1, "/belts");
    make_s(&s, 1.2, 0.6, false);
    assert_only(&s, VALIDITY_CORNERING, 100.0 * 1.44 / (9.81 * 0.6), "/belts");
    make_s(&s, 0.4, 0.6, true);
    assert_only(&s, VALIDITY_BELTS, 3.0, "/belts");
    make_s(&s, 0.4, 0.6, false);
    s.micro.contact[SCENE_CONVEYOR_CARGO].friction = 0.0;
    const validity of = validity_now(&s);
    assert_int_equal(of.n_never, 2);
    assert_int_equal(of.never[1].figure, VALIDITY_CORNERING);
    assert_string_equal(of.never[1].title, "Without friction no part turns with a curve");
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_papers_examples_were_compared),
        cmocka_unit_test(the_end_of_a_heap_alone_was_not_compared),
        cmocka_unit_test(a_feed_that_fills_its_belt_was_not_compared),
        cmocka_unit_test(a_narrow_lane_beside_a_plate_was_not_compared),
        cmocka_unit_test(shallow_and_leaning_plates_were_not_compared),
        cmocka_unit_test(narrow_openings_were_not_compared),
        cmocka_unit_test(queues_that_stop_are_told_where_they_may_be),
        cmocka_unit_test(a_closed_belt_is_told_as_such),
        cmocka_unit_test(a_heap_that_saturates_the_opening_was_not_compared),
        cmocka_unit_test(few_parts_were_not_compared),
        cmocka_unit_test(slow_and_fast_belts_were_not_compared),
        cmocka_unit_test(belts_whose_speed_changes_were_not_compared),
        cmocka_unit_test(slopes_of_more_than_12_degrees_were_not_compared),
        cmocka_unit_test(belts_of_several_velocities_were_not_compared),
        cmocka_unit_test(a_belt_against_a_wall_was_not_compared),
        cmocka_unit_test(a_funnel_was_not_compared),
        cmocka_unit_test(staggered_plates_were_not_compared_where_cargo_queues),
        cmocka_unit_test(a_steep_plate_with_two_free_ends_was_not_compared_where_cargo_queues),
        cmocka_unit_test(curves_were_compared_where_they_are_wide_and_slow),
        cmocka_unit_test(a_plate_at_the_end_of_the_belt_was_not_compared),
        cmocka_unit_test(a_plate_that_is_bent_twice_was_not_compared),
        cmocka_unit_test(parts_of_another_size_were_not_compared),
        cmocka_unit_test(other_shapes_were_not_compared),
        cmocka_unit_test(mixes_were_not_compared),
        cmocka_unit_test(other_frictions_were_not_compared),
        cmocka_unit_test(a_belt_without_friction_brings_no_part_to_its_speed),
        cmocka_unit_test(only_sealed_plates_agree_with_moving_parts),
        cmocka_unit_test(coarse_grids_were_not_compared),
        cmocka_unit_test(each_closure_has_ranges_of_its_own),
        cmocka_unit_test(openings_of_funnels_have_a_range_of_their_own),
        cmocka_unit_test(plates_of_too_many_pieces_are_not_measured),
        cmocka_unit_test(cargo_that_nothing_deflects_rides_on_its_belt),
        cmocka_unit_test(every_figure_has_a_word_of_its_own),
        cmocka_unit_test(no_memory_is_reported),
        cmocka_unit_test(obstacles_that_move_were_not_compared),
        cmocka_unit_test(obstacles_that_are_shifted_were_not_compared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
