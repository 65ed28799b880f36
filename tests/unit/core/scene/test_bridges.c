// Gaps that parts bridge, and where some of the domain is under no belt. Expected values are derived.

#include "core/scene/shape.h"
#include "core/scene/surroundings.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

#define RADIUS 0.012 // of parts, m

enum { BELTS_MAX = 6 };

// Rectangular belts in a domain of 1 x 0.6 m. Do not move it once it was made.
typedef struct floor_plan {
    surroundings around;
    scene_belt belts[BELTS_MAX];
    vec2 corners[BELTS_MAX][4];
} floor_plan;

static void add_belt(floor_plan *p, double x_min, double x_max, double y_min, double y_max)
{
    const size_t k = p->around.n_belts++;

    p->corners[k][0] = (vec2){ x_min, y_min };
    p->corners[k][1] = (vec2){ x_max, y_min };
    p->corners[k][2] = (vec2){ x_max, y_max };
    p->corners[k][3] = (vec2){ x_min, y_max };
    p->belts[k] = (scene_belt){ .n_points = 4, .polygon = p->corners[k] };
    p->around.belts = p->belts;
    p->around.domain = (scene_rect){ 0.0, 1.0, 0.0, 0.6 };
    p->around.bridge = RADIUS;
}

static size_t belt_at(const floor_plan *p, double x, double y)
{
    return surroundings_belt_at(&p->around, (vec2){ x, y });
}

// A part whose centre comes to the first border has its front at RADIUS behind it.
static void a_gap_is_bridged_where_it_is_narrower_than_a_radius(void **state)
{
    static const double gaps[] = { 0.4 * RADIUS, 0.99 * RADIUS, 1.01 * RADIUS, 3.0 * RADIUS };

    for (size_t k = 0; k < 4; k++) {
        floor_plan p = { 0 };
        add_belt(&p, 0.0, 0.5, 0.0, 0.6);
        add_belt(&p, 0.5 + gaps[k], 1.0, 0.0, 0.6);
        const size_t none = p.around.n_belts;
        for (int i = 1; i < 100; i++) {
            const double y = 0.006 * i;
            assert_int_equal(belt_at(&p, 0.5 + 1e-6, y), gaps[k] < RADIUS ? 0 : none);
            assert_int_equal(belt_at(&p, 0.5 + 0.51 * gaps[k], y), gaps[k] < RADIUS ? 1 : none);
            assert_int_equal(belt_at(&p, 0.5 + gaps[k] - 1e-6, y), gaps[k] < RADIUS ? 1 : none);
        }
        assert_int_equal(surroundings_belt_below(&p.around, (vec2){ 0.5 + 1e-6, 0.3 }), none);
        assert_int_equal(surroundings_belt_under(&p.around, (vec2){ 0.5 + 1e-6, 0.3 }, 0.04),
                         gaps[k] < 0.04 ? 0 : none);
    }
}

static void the_nearest_belt_carries_and_the_later_one_of_two(void **state)
{
    floor_plan p = { 0 };

    add_belt(&p, 0.0, 0.5, 0.0, 0.6);
    add_belt(&p, 0.5078125, 1.0, 0.0, 0.6);
    assert_int_equal(belt_at(&p, 0.503, 0.3), 0);
    assert_int_equal(belt_at(&p, 0.50390625, 0.3), 1); // in the middle, exactly
    assert_int_equal(belt_at(&p, 0.505, 0.3), 1);
}

// Also where a belt behind the gap is narrower, beside its end, and near the sides of the domain.
static void nothing_is_carried_where_nothing_lies_beyond(void **state)
{
    floor_plan p = { 0 };

    add_belt(&p, 0.0, 0.5, 0.1, 0.5);
    add_belt(&p, 0.505, 0.9, 0.2, 0.4);
    for (int k = 0; k <= 100; k++) {
        assert_int_equal(belt_at(&p, 0.01 * k, 0.5 + 1e-6), 2);
        assert_int_equal(belt_at(&p, 0.01 * k, 0.1 - 1e-6), 2);
        assert_int_equal(belt_at(&p, 0.9 + 1e-6, 0.006 * k), 2);
    }
    assert_int_equal(belt_at(&p, 0.503, 0.3), 1);
    assert_int_equal(belt_at(&p, 0.503, 0.42), 2);
}

// Behind a side lies the mirror image of the belt.
static void a_strip_before_a_side_is_bridged_up_to_half_a_radius(void **state)
{
    floor_plan p = { 0 };

    add_belt(&p, 0.0, 1.0 - 0.49 * RADIUS, 0.0, 0.6);
    assert_int_equal(belt_at(&p, 1.0 - 0.48 * RADIUS, 0.3), 0);
    assert_int_equal(belt_at(&p, 1.0, 0.3), 0);
    p.corners[0][1].x = p.corners[0][2].x = 1.0 - 0.51 * RADIUS;
    assert_int_equal(belt_at(&p, 1.0 - 0.5 * RADIUS, 0.3), 1);
}

// In the corner of two belts a disk whose centre is at (a, a) rests on both up to a + sqrt(r^2 - a^2) along each: the chord
// between these ends passes behind the centre while a < r/sqrt(2).
static void an_inner_corner_holds_what_lies_before_the_chord(void **state)
{
    floor_plan p = { 0 };
    const double inside = 0.7 * RADIUS, outside = 0.72 * RADIUS;

    add_belt(&p, 0.0, 0.5, 0.0, 0.6);
    add_belt(&p, 0.5, 1.0, 0.0, 0.3);
    assert_true(belt_at(&p, 0.5 + inside, 0.3 + inside) < 2);
    assert_int_equal(belt_at(&p, 0.5 + outside, 0.3 + outside), 2);
}

static void radii_reach_from_the_centre_to_the_nearest_side(void **state)
{
    const scene_shape cylinder = { .type = SCENE_CYLINDER, .radius = 0.033, .height = 0.1 };
    const scene_shape carton = { .type = SCENE_BOX, .length = 0.24, .width = 0.18, .height = 0.12 };
    // A right-angled triangle, off its origin: its centre is a third of each leg from the other one.
    double corners[][3] = { { 1.0, 1.0, 0.0 }, { 1.3, 1.0, 0.0 }, { 1.0, 1.3, 0.0 } };
    const scene_shape triangle = {
        .type = SCENE_PRISM, .n_vertices = 3, .vertices = corners, .height = 0.1
    };

    assert_near(shape_inner_radius(&cylinder), 0.033, 1e-15);
    assert_near(shape_inner_radius(&carton), 0.09, 1e-15);
    assert_near(shape_inner_radius(&triangle), 0.1 / sqrt(2.0), 1e-12);
}

// The eastern side of the domain is an outflow, and so is the northern one.
static void cargo_leaves_from_belts_that_lie_along_an_outflow(void **state)
{
    floor_plan p = { .around.edges = { SCENE_EDGE_INFLOW, SCENE_EDGE_OUTFLOW, SCENE_EDGE_WALL,
                                       SCENE_EDGE_OUTFLOW } };
    add_belt(&p, 0.0, 0.5, 0.0, 0.5);  // ends inside
    add_belt(&p, 0.5, 1.0, 0.0, 0.3);  // to the eastern side
    add_belt(&p, 0.5, 1.2, 0.3, 0.5);  // beyond it
    add_belt(&p, 0.2, 0.4, 0.5, 0.7);  // beyond the northern one
    add_belt(&p, -0.2, 0.0, 0.0, 0.6); // touches a corner of it
    add_belt(&p, 0.0, 0.2, -0.1, 0.0); // along a wall
    static const bool are_outlets[] = { false, true, true, true, false, false };
    for (size_t k = 0; k < 6; k++)
        assert_int_equal(surroundings_is_outlet(&p.around, k), are_outlets[k]);
}

static void a_scene_may_drop_parts_where_no_belt_lies(void **state)
{
    floor_plan whole = { 0 };
    assert_false(surroundings_may_drop(&whole.around)); // no belt at all
    add_belt(&whole, 0.0, 1.0, 0.0, 0.6);
    assert_false(surroundings_may_drop(&whole.around));
    add_belt(&whole, 0.3, 0.7, 0.2, 0.4);
    assert_false(surroundings_may_drop(&whole.around));

    floor_plan slit = { 0 };
    add_belt(&slit, -0.1, 0.5, -0.1, 0.7);
    add_belt(&slit, 0.5, 1.0, 0.0, 0.6);
    assert_false(surroundings_may_drop(&slit.around));
    slit.corners[1][0].x = 0.501; // a wedge at the lower end of the common border
    assert_true(surroundings_may_drop(&slit.around));
    add_belt(&slit, 0.45, 0.55, 0.0, 0.6);
    assert_false(surroundings_may_drop(&slit.around));

    floor_plan corner = { 0 };
    add_belt(&corner, 0.0, 0.9, 0.0, 0.3);
    add_belt(&corner, 0.9, 1.0, 0.0, 0.6);
    assert_true(surroundings_may_drop(&corner.around));
    add_belt(&corner, 0.0, 0.9, 0.3, 0.6);
    assert_false(surroundings_may_drop(&corner.around));
    corner.corners[2][3].y = 0.599;
    assert_true(surroundings_may_drop(&corner.around));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_gap_is_bridged_where_it_is_narrower_than_a_radius),
        cmocka_unit_test(the_nearest_belt_carries_and_the_later_one_of_two),
        cmocka_unit_test(nothing_is_carried_where_nothing_lies_beyond),
        cmocka_unit_test(a_strip_before_a_side_is_bridged_up_to_half_a_radius),
        cmocka_unit_test(an_inner_corner_holds_what_lies_before_the_chord),
        cmocka_unit_test(radii_reach_from_the_centre_to_the_nearest_side),
        cmocka_unit_test(cargo_leaves_from_belts_that_lie_along_an_outflow),
        cmocka_unit_test(a_scene_may_drop_parts_where_no_belt_lies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
