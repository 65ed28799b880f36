// Angles of plates to belts, openings and corners, computed by hand.

#include "core/advice/layout.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

static const double east[] = { 0.4, 0.0 };
static const scene_pose somewhere = { 0.1, 0.1, 0.0 };

/// A domain of 1 x 0.6 m, walls at y = 0 and 0.6 m, with a belt of a velocity; cells of 5 mm.
static void make_belt(scene *s, double vx, double vy)
{
    helper_scene_belt(s, 1.0, 0.6, 0.005, &somewhere, 1);
    helper_scene_add_belt(s, (vec2){ vx, vy }, NULL, 0);
}

static void add_plate(scene *s, double x0, double y0, double x1, double y1)
{
    const vec2 path[] = { { x0, y0 }, { x1, y1 } };

    helper_scene_add_obstacle(s, path, 2, SCENE_SEALED);
}

static layout measure(scene *s)
{
    layout of;

    helper_scene_resolve(s);
    assert_int_equal(layout_measure(s, &of, NULL), BF_OK);
    scene_fini(s);
    assert_true(of.is_measured);
    return of;
}

static void assert_angles(const layout *of, double least, double greatest)
{
    assert_near(of->least.value, least, 1e-9);
    assert_near(of->greatest.value, greatest, 1e-9);
}

static void a_belt_without_plates_has_no_opening(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    const layout of = measure(&s);
    assert_int_equal(of.n_plates, 0);
    assert_int_equal(of.n_pieces, 0);
    assert_true(isinf(of.opening.value));
    assert_true(of.wall_angle.value == 0.0);
}

// The paper's Examples: the tip is at y = 0.5 m, the wall at 0.6 m. At 30 degrees the foot lies upstream of the
// domain, where nothing comes in.
static void a_single_plate_opens_from_its_tip_to_the_wall(void **state)
{
    static const double degrees[] = { 30.0, 45.0, 60.0, 90.0 };

    for (size_t k = 0; k < sizeof degrees / sizeof *degrees; k++) {
        scene s;
        helper_scene_example(&s, degrees[k], SCENE_SEALED);
        const layout of = measure(&s);
        assert_int_equal(of.n_plates, 1);
        assert_angles(&of, degrees[k], degrees[k]);
        assert_near(of.opening.value, 0.1, 1e-12);
        assert_true(of.bends.value == 0.0);
    }
}

// 45 degrees from both walls to tips 0.2 m apart. The plate of 70 degrees at the other wall is shorter: the tips
// (0.7, 0.3) and (0.7, 0.45) are then 0.15 m apart.
static void a_funnel_opens_between_its_tips(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.5, 0.0, 0.7, 0.2);
    add_plate(&s, 0.5, 0.6, 0.7, 0.4);
    const layout symmetric = measure(&s);
    assert_int_equal(symmetric.n_plates, 2);
    assert_angles(&symmetric, 45.0, 45.0);
    assert_near(symmetric.opening.value, 0.2, 1e-12);
    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.4, 0.0, 0.7, 0.3);
    add_plate(&s, 0.7 - 0.15 / tan(70.0 * M_PI / 180.0), 0.6, 0.7, 0.45);
    const layout of = measure(&s);
    assert_angles(&of, 45.0, 70.0);
    assert_int_equal(of.least.index, 0);
    assert_int_equal(of.greatest.index, 1);
    assert_near(of.opening.value, 0.15, 1e-12);
}

// Plates one behind the other: from the first tip (0.4, 0.4) it is 0.2 m to the wall, and 0.1 m to the second
// plate, which stands across the belt at x = 0.5 m from y = 0.3 m to the other wall.
static void the_way_between_plates_one_behind_the_other_is_an_opening(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.4, 0.0, 0.4, 0.4);
    add_plate(&s, 0.5, 0.6, 0.5, 0.3);
    const layout of = measure(&s);
    assert_near(of.opening.value, 0.1 - 0.005, 1e-12); // the first one is 5 mm thick
    assert_angles(&of, 90.0, 90.0);
}

// Two plates at 45 degrees from both walls, the ends of which are 0.2 m apart across the belt, and then 0.1 m along it as well, so that
// they stay the places where they are nearest. From the end (0.6, 0.4) of a plate to the line y = 1.1 - x it is 0.1/sqrt 2, half
// a thickness less of each plate, and as far along the belt as across it.
static void plates_are_staggered_by_how_far_one_is_downstream_of_the_other(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.5, 0.0, 0.7, 0.2);
    const layout alone = measure(&s);
    assert_true(isinf(alone.stagger.value));
    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.5, 0.0, 0.7, 0.2);
    add_plate(&s, 0.5, 0.6, 0.7, 0.4);
    const layout opposite = measure(&s);
    assert_near(opposite.stagger.value, 0.0, 1e-12);
    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.5, 0.0, 0.7, 0.2);
    add_plate(&s, 0.6, 0.6, 0.8, 0.4);
    const layout shifted = measure(&s);
    assert_near(shifted.stagger.value, 0.1, 1e-12);
    assert_int_equal(shifted.stagger.index, 1);
}

// From the downstream end at x = 0.7 m of a plate to the end of the belt at 1 m; to the side that a belt at atan(3/4) reaches first, where
// it is 0.2 m to y = 0.6 m and 0.3 m to x = 1 m, or 0.4 m and 0.1 m; to none where it reaches a wall.
static void the_belt_behind_a_plate_ends_at_the_first_open_side(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.7, 0.4, 0.5, 0.6);
    add_plate(&s, 0.4, 0.0, 0.5, 0.1);
    const layout straight = measure(&s);
    assert_near(straight.run_out.value, 0.3, 1e-12);
    assert_int_equal(straight.run_out.index, 0);
    make_belt(&s, 0.4, 0.3);
    s.edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
    add_plate(&s, 0.4, 0.4, 0.7, 0.4);
    const layout oblique = measure(&s);
    assert_near(oblique.run_out.value, 0.2 * 5.0 / 3.0, 1e-12);
    make_belt(&s, 0.4, 0.3);
    s.edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
    add_plate(&s, 0.6, 0.2, 0.9, 0.2);
    const layout other = measure(&s);
    assert_near(other.run_out.value, 0.1 * 5.0 / 4.0, 1e-12);
    make_belt(&s, 0.4, 0.3);
    add_plate(&s, 0.4, 0.4, 0.7, 0.4);
    const layout walled = measure(&s);
    assert_true(isinf(walled.run_out.value));
}

// From the downstream end of a plate, at x = 0.7 or 0.8 m, to 0.75 m, where a faster belt begins, one that goes aside, or one as fast.
static void the_next_belt_begins_where_another_velocity_does(void **state)
{
    static const vec2 behind[] = { { 0.75, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.6 }, { 0.75, 0.6 } };
    static const struct {
        double end;
        vec2 velocity;
        double way;
    } cases[] = { { 0.7, { 0.6, 0.0 }, 0.05 },
                  { 0.7, { 0.4, 0.1 }, 0.05 },
                  { 0.7, { 0.4, 0.0 }, INFINITY },
                  { 0.8, { 0.6, 0.0 }, INFINITY } };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scene s;
        make_belt(&s, east[0], east[1]);
        helper_scene_add_belt(&s, cases[k].velocity, behind, 4);
        add_plate(&s, 0.4, 0.0, cases[k].end, 0.4);
        const layout of = measure(&s);
        if (isinf(cases[k].way))
            assert_true(isinf(of.next_belt.value));
        else
            assert_near(of.next_belt.value, cases[k].way, 1e-8);
    }
}

// Plates of 45, 90 and 63.43 degrees that begin at y = 0 m; one that goes on behind a bend at y = 0.01 m ends at 0.4 m, or at 0.01 m if it
// goes on along the belt. The last one begins at no wall.
static void the_end_of_a_plate_stands_off_the_wall_that_the_plate_begins_at(void **state)
{
    static const struct {
        size_t n;
        vec2 path[3];
        double off;
    } cases[] = { { 2, { { 0.4, 0.0 }, { 0.41, 0.01 } }, 0.01 },
                  { 2, { { 0.41, 0.01 }, { 0.4, 0.0 } }, 0.01 },
                  { 2, { { 0.4, 0.0 }, { 0.4, 0.01 } }, 0.01 },
                  { 2, { { 0.4, 0.01 }, { 0.4, 0.0 } }, 0.01 },
                  { 3, { { 0.4, 0.0 }, { 0.41, 0.01 }, { 0.605, 0.4 } }, 0.4 },
                  { 3, { { 0.605, 0.4 }, { 0.41, 0.01 }, { 0.4, 0.0 } }, 0.4 },
                  { 3, { { 0.4, 0.0 }, { 0.41, 0.01 }, { 0.6, 0.01 } }, 0.01 },
                  { 2, { { 0.4, 0.1 }, { 0.6, 0.3 } }, INFINITY } };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scene s;
        make_belt(&s, east[0], east[1]);
        helper_scene_add_obstacle(&s, cases[k].path, cases[k].n, SCENE_SEALED);
        const layout of = measure(&s);
        if (isinf(cases[k].off))
            assert_true(isinf(of.short_end.value));
        else
            assert_near(of.short_end.value, cases[k].off, 1e-12);
    }
}

// 45 degrees up to (0.6, 0.2), then atan 2 = 63.43 degrees, up to (0.7, 0.4); the tip is 0.2 m off the wall.
static void a_bent_plate_has_the_angles_of_its_pieces(void **state)
{
    static const vec2 path[] = { { 0.4, 0.0 }, { 0.6, 0.2 }, { 0.7, 0.4 } };
    static const vec2 straight[] = { { 0.4, 0.0 }, { 0.6, 0.2 }, { 0.7, 0.3 } };
    scene s;

    make_belt(&s, east[0], east[1]);
    helper_scene_add_obstacle(&s, path, 3, SCENE_SEALED);
    const layout of = measure(&s);
    assert_int_equal(of.n_plates, 1);
    assert_int_equal(of.n_pieces, 2);
    assert_angles(&of, 45.0, atan(2.0) * 180.0 / M_PI);
    assert_near(of.opening.value, 0.2, 1e-12);
    assert_true(of.bends.value == 1.0 && of.least_bends == 1.0);
    make_belt(&s, east[0], east[1]);
    helper_scene_add_obstacle(&s, straight, 3, SCENE_SEALED);
    assert_true(measure(&s).bends.value == 0.0);
}

// The belt at 30 degrees to the x axis runs against the upper wall; the plate of 75 degrees to the x axis stands
// at 45 degrees to it.
static void angles_are_those_to_the_belt(void **state)
{
    const double angle = 75.0 * M_PI / 180.0;
    scene s;

    make_belt(&s, 0.4 * cos(M_PI / 6.0), 0.4 * sin(M_PI / 6.0));
    add_plate(&s, 0.5, 0.0, 0.5 + 0.4 * cos(angle), 0.4 * sin(angle));
    const layout of = measure(&s);
    assert_angles(&of, 45.0, 45.0);
    assert_near(of.opening.value, 0.6 - 0.4 * sin(angle), 1e-12);
    assert_near(of.wall_angle.value, 30.0, 1e-9);
    assert_int_equal(of.wall_angle.index, SCENE_NORTH);
}

// A belt to the north between walls in the west and the east.
static void a_belt_may_run_in_any_direction(void **state)
{
    scene s;

    make_belt(&s, 0.0, 0.3);
    s.edges[SCENE_WEST] = s.edges[SCENE_EAST] = SCENE_EDGE_WALL;
    s.edges[SCENE_SOUTH] = SCENE_EDGE_INFLOW;
    s.edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
    add_plate(&s, 0.0, 0.1, 0.8, 0.5);
    const layout of = measure(&s);
    assert_angles(&of, atan(2.0) * 180.0 / M_PI, atan(2.0) * 180.0 / M_PI);
    assert_near(of.opening.value, 0.2, 1e-12);
    assert_true(of.wall_angle.value == 0.0);
}

// Two belts side by side, one to the east, one across it: a plate on each at 45 degrees and at 60 degrees.
static void each_plate_stands_on_its_own_belt(void **state)
{
    static const vec2 west_half[] = { { 0.0, 0.0 }, { 0.5, 0.0 }, { 0.5, 0.6 }, { 0.0, 0.6 } };
    static const vec2 east_half[] = { { 0.5, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.6 }, { 0.5, 0.6 } };
    scene s;

    helper_scene_belt(&s, 1.0, 0.6, 0.005, &somewhere, 1);
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, west_half, 4);
    helper_scene_add_belt(&s, (vec2){ 0.0, 0.4 }, east_half, 4);
    add_plate(&s, 0.1, 0.0, 0.4, 0.3);
    add_plate(&s, 0.8, 0.3, 0.8 - 0.2 * sin(M_PI / 3.0), 0.3 + 0.2 * cos(M_PI / 3.0));
    const layout of = measure(&s);
    assert_int_equal(of.n_plates, 2);
    assert_angles(&of, 45.0, 60.0);
    assert_near(of.wall_angle.value, 90.0, 1e-9); // the second belt runs against the north wall
}

// A plate that leans upstream by 30 degrees closes a corner with its wall.
static void a_plate_that_leans_against_the_belt_has_more_than_90_degrees(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.6 + 0.5 / tan(M_PI / 3.0), 0.0, 0.6, 0.5);
    const layout of = measure(&s);
    assert_angles(&of, 120.0, 120.0);
    // The downstream face of the plate, 5 mm behind, comes nearer to the wall: by 5 mm sin 30 degrees.
    assert_near(of.opening.value, 0.1 - 0.0025, 1e-12);
}

// A cup: both pieces lead into the bend downstream. Turned round it is a wedge, which parts the cargo.
static void a_cup_holds_cargo_and_a_wedge_does_not(void **state)
{
    static const vec2 cup[] = { { 0.5, 0.2 }, { 0.6, 0.3 }, { 0.5, 0.4 } };
    static const vec2 wedge[] = { { 0.6, 0.2 }, { 0.5, 0.3 }, { 0.6, 0.4 } };
    scene s;

    make_belt(&s, east[0], east[1]);
    helper_scene_add_obstacle(&s, cup, 3, SCENE_SEALED);
    const layout of = measure(&s);
    assert_angles(&of, 135.0, 135.0);
    make_belt(&s, east[0], east[1]);
    helper_scene_add_obstacle(&s, wedge, 3, SCENE_SEALED);
    const layout parting = measure(&s);
    assert_angles(&parting, 45.0, 45.0);
    assert_near(parting.opening.value, 0.2, 1e-12); // to either wall
}

// The same cup, of two obstacles that touch; and a plate that ends at a rail along the belt, on its own side of it
// and, as the rail begins there, not.
static void a_corner_may_be_made_of_two_obstacles(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.5, 0.2, 0.6, 0.3);
    add_plate(&s, 0.5, 0.4, 0.6, 0.3);
    const layout cup = measure(&s);
    assert_angles(&cup, 135.0, 135.0);
    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.4, 0.1, 0.6, 0.3);
    add_plate(&s, 0.2, 0.3, 0.9, 0.3);
    const layout trap = measure(&s);
    assert_int_equal(trap.n_plates, 1);
    assert_angles(&trap, 135.0, 135.0);
    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.4, 0.1, 0.6, 0.3);
    add_plate(&s, 0.6, 0.3, 0.9, 0.3);
    const layout led_on = measure(&s);
    assert_angles(&led_on, 45.0, 45.0);
}

// From wall to wall nothing passes; the angle is that which was meant.
static void plates_that_join_opposite_walls_leave_no_opening(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.3, 0.0, 0.5, 0.2);
    add_plate(&s, 0.5, 0.2, 0.9, 0.6);
    const layout of = measure(&s);
    assert_true(of.opening.value == 0.0);
    assert_angles(&of, 45.0, 45.0);
    assert_true(isinf(of.run_out.value));
}

// A rail along the belt with a joint of 3 mm, 0.1 m off the wall; and the same with a plate that joins it.
static void guides_along_the_belt_deflect_nothing_and_bound_openings(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.2, 0.1, 0.5, 0.1);
    add_plate(&s, 0.503, 0.1, 0.9, 0.1);
    const layout rail = measure(&s);
    assert_int_equal(rail.n_plates, 0);
    assert_near(rail.opening.value, 0.1 - 0.0025, 1e-12); // they are 5 mm thick
    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.2, 0.4, 0.5, 0.4);
    add_plate(&s, 0.2, 0.0, 0.5, 0.3);
    const layout narrowed = measure(&s);
    assert_near(narrowed.opening.value, 0.1 - 0.0025, 1e-12);
    assert_int_equal(narrowed.n_plates, 1);
}

// The feed delivers above the rail: the strip of 45 mm between it and the wall stays empty, and a guide that ends short of a
// corner leaves no opening there.
static void strips_to_which_no_cargo_comes_are_no_openings(void **state)
{
    scene s;

    for (int k = 0; k < 2; k++) {
        make_belt(&s, east[0], east[1]);
        add_plate(&s, 0.0, 0.05, 0.98, 0.05);
        add_plate(&s, 0.5, 0.6, 0.7, 0.3);
        scene_feed *feed = memory_alloc(1, sizeof *feed);
        assert_non_null(feed);
        feed->line[0] = (vec2){ 0.1, k == 0 ? 0.15 : 0.02 };
        feed->line[1] = (vec2){ 0.1, 0.5 };
        s.feeds = feed;
        s.n_feeds = 1;
        const layout of = measure(&s); // frees the scene
        assert_int_equal(of.n_guides, 1);
        if (k == 0)
            assert_true(of.opening.value > 0.2); // from the tip to the rail, some 25 cm
        else
            assert_true(of.opening.value < 0.05);
    }
}

// A shield upstream keeps all cargo off the two posts behind it, 3 cm apart.
static void what_lies_behind_a_plate_is_no_opening(void **state)
{
    scene s;

    for (int k = 0; k < 2; k++) {
        make_belt(&s, east[0], east[1]);
        if (k == 0)
            add_plate(&s, 0.3, 0.0, 0.5, 0.4);
        add_plate(&s, 0.7, 0.10, 0.9, 0.10);
        add_plate(&s, 0.7, 0.13, 0.9, 0.13);
        if (k == 0)
            assert_near(measure(&s).opening.value, 0.2, 1e-12);
        else
            assert_true(measure(&s).opening.value < 0.03);
    }
}

// Half a cell is 2.5 mm: a slit of 2 mm at the foot is closed on the grid, one of 4 mm is not.
static void a_slit_at_a_wall_counts_from_half_a_cell_on(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.5, 0.002, 0.5, 0.4);
    assert_true(isinf(measure(&s).gap.value));
    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.5, 0.004, 0.5, 0.4);
    assert_near(measure(&s).gap.value, 0.004, 1e-12);
}

// Parts are 24 mm wide: 23 mm at the foot of a plate let none through, 24 do.
static void a_gap_that_no_part_fits_through_is_no_opening(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.5, 0.023, 0.5, 0.4);
    const layout gap = measure(&s);
    assert_near(gap.opening.value, 0.2, 1e-12);
    assert_near(gap.gap.value, 0.023, 1e-12);
    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.5, 0.024, 0.5, 0.4);
    const layout opening = measure(&s);
    assert_near(opening.opening.value, 0.024, 1e-12);
    assert_true(isinf(opening.gap.value));
}

// Boxes of 60 x 20 mm, which pass 23 mm lengthwise, and with them the cylinders of 24 mm, which do not.
static void the_narrowest_kind_says_what_an_opening_is(void **state)
{
    scene s;

    for (size_t n = 1; n <= 2; n++) {
        make_belt(&s, east[0], east[1]);
        add_plate(&s, 0.5, 0.023, 0.5, 0.4);
        s.cargo[1] = s.cargo[0];
        s.n_cargo = n;
        s.cargo[n - 1].shape =
            (scene_shape){ .type = SCENE_BOX, .length = 0.06, .width = 0.02, .height = 0.01 };
        assert_near(measure(&s).opening.value, 0.023, 1e-12);
    }
}

// Where nothing else is left of a belt, downstream of an opening of 0.2 m or with none, a gap is the opening: beside one plate,
// and between two. Without walls it is, too, as there is no opening at all.
static void a_gap_that_alone_is_left_of_the_belt_is_the_opening(void **state)
{
    scene s;

    for (int k = 0; k < 4; k++) {
        make_belt(&s, east[0], east[1]);
        if (k > 0 && k < 3)
            add_plate(&s, 0.2, 0.6, 0.2, 0.2);
        add_plate(&s, 0.7, 0.01, 0.7, k == 2 ? 0.3 : 0.6);
        if (k == 2)
            add_plate(&s, 0.7, 0.32, 0.7, 0.6);
        if (k == 3)
            s.edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
        assert_near(measure(&s).opening.value, 0.01, 1e-12);
    }
}

// A belt from y = 0.1 to 0.5 m in a domain of 0.6 m: nothing passes between its rails and the walls.
static void what_lies_off_the_belts_is_no_opening(void **state)
{
    static const vec2 strip[] = { { 0.0, 0.1 }, { 1.0, 0.1 }, { 1.0, 0.5 }, { 0.0, 0.5 } };
    scene s;

    helper_scene_belt(&s, 1.0, 0.6, 0.005, &somewhere, 1);
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, strip, 4);
    add_plate(&s, 0.0, 0.1, 1.0, 0.1);
    add_plate(&s, 0.0, 0.5, 1.0, 0.5);
    add_plate(&s, 0.4, 0.1, 0.6, 0.3);
    const layout of = measure(&s);
    assert_int_equal(of.n_plates, 1);
    assert_near(of.opening.value, 0.2 - 0.0025, 1e-12); // the upper rail is 5 mm thick
    assert_angles(&of, 45.0, 45.0);
}

// A plate that leaves over the east side leads cargo out, though further on it would meet the north wall.
static void a_plate_that_leaves_the_domain_closes_nothing(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.8, 0.0, 1.4, 0.6);
    const layout of = measure(&s);
    assert_angles(&of, 45.0, 45.0);
    assert_near(of.opening.value, 0.4, 1e-12);
}

// The plate begins below the domain: what lies in it is 45 degrees from (0.5, 0) to (0.7, 0.2).
static void plates_count_as_far_as_they_lie_in_the_domain(void **state)
{
    scene s;

    make_belt(&s, east[0], east[1]);
    add_plate(&s, 0.3, -0.2, 0.7, 0.2);
    add_plate(&s, 0.2, -0.3, 0.9, -0.3);
    const layout of = measure(&s);
    assert_int_equal(of.n_plates, 1);
    assert_near(of.opening.value, 0.4, 1e-12);
    assert_angles(&of, 45.0, 45.0);
}

// A comb of 1024 bends, and one more.
static void so_many_pieces_are_measured_and_no_more(void **state)
{
    static vec2 path[LAYOUT_PIECES_MAX + 1];
    static const vec2 last[] = { { 0.1, 0.5 }, { 0.2, 0.5 } };
    layout of;
    scene s;

    make_belt(&s, east[0], east[1]);
    for (size_t k = 0; k <= LAYOUT_PIECES_MAX; k++)
        path[k] = (vec2){ 0.1 + 0.0005 * (double)k, k % 2 == 0 ? 0.2 : 0.3 };
    helper_scene_add_obstacle(&s, path, LAYOUT_PIECES_MAX + 1, SCENE_SEALED);
    helper_scene_resolve(&s);
    assert_int_equal(layout_measure(&s, &of, NULL), BF_OK);
    assert_true(of.is_measured);
    assert_true(of.bends.value == LAYOUT_PIECES_MAX - 1);
    assert_near(of.opening.value, 0.2, 0.001);
    helper_scene_add_obstacle(&s, last, 2, SCENE_SEALED);
    assert_int_equal(layout_measure(&s, &of, NULL), BF_OK);
    assert_false(of.is_measured);
    assert_int_equal(of.n_pieces, LAYOUT_PIECES_MAX + 1);
    scene_fini(&s);
}

static void no_memory_is_reported(void **state)
{
    layout of = { .n_pieces = 77 };
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    for (size_t n = 1; n <= 2; n++) {
        memory_plan_fault(n, 0);
        assert_int_equal(layout_measure(&s, &of, NULL), BF_ENOMEM);
        memory_plan_fault(0, 0);
        assert_int_equal(of.n_pieces, 77);
    }
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_belt_without_plates_has_no_opening),
        cmocka_unit_test(a_single_plate_opens_from_its_tip_to_the_wall),
        cmocka_unit_test(a_funnel_opens_between_its_tips),
        cmocka_unit_test(the_way_between_plates_one_behind_the_other_is_an_opening),
        cmocka_unit_test(plates_are_staggered_by_how_far_one_is_downstream_of_the_other),
        cmocka_unit_test(the_belt_behind_a_plate_ends_at_the_first_open_side),
        cmocka_unit_test(the_next_belt_begins_where_another_velocity_does),
        cmocka_unit_test(the_end_of_a_plate_stands_off_the_wall_that_the_plate_begins_at),
        cmocka_unit_test(a_bent_plate_has_the_angles_of_its_pieces),
        cmocka_unit_test(angles_are_those_to_the_belt),
        cmocka_unit_test(a_belt_may_run_in_any_direction),
        cmocka_unit_test(each_plate_stands_on_its_own_belt),
        cmocka_unit_test(a_plate_that_leans_against_the_belt_has_more_than_90_degrees),
        cmocka_unit_test(a_cup_holds_cargo_and_a_wedge_does_not),
        cmocka_unit_test(a_corner_may_be_made_of_two_obstacles),
        cmocka_unit_test(plates_that_join_opposite_walls_leave_no_opening),
        cmocka_unit_test(guides_along_the_belt_deflect_nothing_and_bound_openings),
        cmocka_unit_test(strips_to_which_no_cargo_comes_are_no_openings),
        cmocka_unit_test(what_lies_behind_a_plate_is_no_opening),
        cmocka_unit_test(a_slit_at_a_wall_counts_from_half_a_cell_on),
        cmocka_unit_test(a_gap_that_no_part_fits_through_is_no_opening),
        cmocka_unit_test(the_narrowest_kind_says_what_an_opening_is),
        cmocka_unit_test(a_gap_that_alone_is_left_of_the_belt_is_the_opening),
        cmocka_unit_test(what_lies_off_the_belts_is_no_opening),
        cmocka_unit_test(a_plate_that_leaves_the_domain_closes_nothing),
        cmocka_unit_test(plates_count_as_far_as_they_lie_in_the_domain),
        cmocka_unit_test(so_many_pieces_are_measured_and_no_more),
        cmocka_unit_test(no_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
