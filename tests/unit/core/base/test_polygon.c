// Unit tests of plane geometry.

#include "core/base/polygon.h"

#include "core/base/random.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static vec2 draw(bf_random *random)
{
    vec2 at = { random_unit(random), random_unit(random) };
    return at;
}

static void a_vector_along_an_axis_has_its_length_exactly(void **state)
{
    bf_random random;

    random_init(&random, 1);
    assert_true(vec2_length((vec2){ 0.395, 0.0 }) == 0.395);
    for (int k = 0; k < 1000; k++) {
        double x = 2.0 * random_unit(&random) - 1.0;
        assert_true(vec2_length((vec2){ 0.0, x }) == fabs(x));
    }
}

static void the_distance_to_a_segment_is_to_its_nearest_point(void **state)
{
    vec2 a = { 1.0, 1.0 }, b = { 3.0, 1.0 };

    assert_near(polygon_segment_distance((vec2){ 2.0, 4.0 }, a, b), 3.0, 1e-15);
    assert_near(polygon_segment_distance((vec2){ 0.0, 1.0 }, a, b), 1.0, 1e-15);
    assert_near(polygon_segment_distance((vec2){ 6.0, 5.0 }, a, b), 5.0, 1e-15);
    assert_near(polygon_segment_distance((vec2){ 4.0, 5.0 }, a, a), 5.0, 1e-15);
}

static void a_segment_that_is_far_along_an_axis_is_no_nearer_than_that(void **state)
{
    bf_random random;
    int n_far = 0;

    random_init(&random, 7);
    for (int k = 0; k < 10000; k++) {
        const vec2 at = draw(&random), a = draw(&random), b = draw(&random);
        const double distance = 0.5 * random_unit(&random);
        if (!polygon_segment_is_far(at, a, b, distance))
            continue;
        n_far++;
        assert_true(polygon_segment_distance(at, a, b) > distance - 1e-15);
    }
    assert_in_range(n_far, 1000, 9000);
    for (int k = 0; k < 4; k++) {
        const vec2 sides[] = { { 2, 0.5 }, { -1, 0.5 }, { 0.5, 2 }, { 0.5, -1 } };
        assert_true(polygon_segment_is_far(sides[k], (vec2){ 0, 0 }, (vec2){ 1, 1 }, 0.99));
        assert_false(polygon_segment_is_far(sides[k], (vec2){ 0, 0 }, (vec2){ 1, 1 }, 1.01));
    }
}

static void segments_touch_where_they_cross_or_come_near(void **state)
{
    static const struct {
        vec2 a, b, c, d;
        bool touch;
    } cases[] = {
        { { 0, 0 }, { 2, 2 }, { 0, 2 }, { 2, 0 }, true },        // they cross
        { { 0, 0 }, { 1, 1 }, { 0, 3 }, { 3, 0 }, false },       // one ends before
        { { 0, 0 }, { 1, 1 }, { 1, 1 }, { 2, 0 }, true },        // an end in common
        { { 0, 0 }, { 2, 0 }, { 1, 0 }, { 1, 1 }, true },        // an end on the other
        { { 0, 0 }, { 2, 0 }, { 1, 1e-4 }, { 1, 1 }, true },     // within the tolerance
        { { 0, 0 }, { 2, 0 }, { 1, 1e-2 }, { 1, 1 }, false },    // not within it
        { { 0, 0 }, { 1, 0 }, { 2, 0 }, { 3, 0 }, false },       // on one line, apart
        { { 0, 0 }, { 2, 0 }, { 1, 0 }, { 3, 0 }, true },        // on one line, overlapping
        { { 0, 0 }, { 1, 0 }, { 2, 1e-9 }, { 2, -1 }, false },   // an end on the line, far off
        { { 0, 0 }, { 3, 0 }, { 0, 1e-2 }, { 3, 1e-2 }, false }, // parallel
    };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        vec2 a = cases[k].a, b = cases[k].b, c = cases[k].c, d = cases[k].d;
        assert_int_equal(polygon_segments_touch(a, b, c, d, 1e-3), cases[k].touch);
        assert_int_equal(polygon_segments_touch(d, c, a, b, 1e-3), cases[k].touch);
    }
}

static void a_polygon_holds_what_is_inside_or_on_its_border(void **state)
{
    // An L of three unit squares.
    static const vec2 corners[] = { { 0, 0 }, { 2, 0 }, { 2, 1 }, { 1, 1 }, { 1, 2 }, { 0, 2 } };
    bf_random random;

    random_init(&random, 2);
    for (int k = 0; k < 10000; k++) {
        vec2 at = vec2_add(vec2_scale(draw(&random), 3.0), (vec2){ -0.5, -0.5 });
        bool is_in = at.x >= 0 && at.y >= 0 && at.x <= 2 && at.y <= 2 && (at.x <= 1 || at.y <= 1);
        assert_int_equal(polygon_holds(corners, 6, at, 1e-12), is_in);
    }
    for (size_t k = 0; k < 6; k++)
        assert_true(polygon_holds(corners, 6, corners[k], 1e-12));
    assert_true(polygon_holds(corners, 6, (vec2){ 1.5, 1.0 }, 1e-12));
    assert_near(polygon_area(corners, 6), 3.0, 1e-15);
    assert_true(polygon_is_simple(corners, 6, 1e-9));
    assert_false(polygon_is_convex(corners, 6, 1e-9));
}

static void a_convex_hull_is_convex_and_has_all_points(void **state)
{
    enum { N = 40 };
    bf_random random;

    random_init(&random, 3);
    for (int trial = 0; trial < 300; trial++) {
        vec2 points[N], sorted[N], hull[N + 1];
        size_t n = 3 + (size_t)trial % (N - 2);
        for (size_t k = 0; k < n; k++) {
            points[k] = draw(&random);
            if (trial % 2 == 0) // many on one line, many the same
                points[k] = (vec2){ round(4.0 * points[k].x), round(4.0 * points[k].y) };
        }
        memcpy(sorted, points, n * sizeof *points);
        size_t n_hull = polygon_convex_hull(sorted, n, hull);
        assert_in_range(n_hull, 1, n);
        if (n_hull < 3)
            continue;
        assert_true(polygon_is_convex(hull, n_hull, 1e-12));
        for (size_t k = 0; k < n; k++)
            assert_true(polygon_holds(hull, n_hull, points[k], 1e-12));
    }
}

static void points_on_a_line_have_a_hull_of_two_ends_and_equal_ones_of_one(void **state)
{
    vec2 line[] = { { 2, 2 }, { 0, 0 }, { 1, 1 }, { 0, 0 } }, hull[5];
    vec2 equal[] = { { 7, 7 }, { 7, 7 }, { 7, 7 } };

    assert_int_equal(polygon_convex_hull(line, 4, hull), 2);
    assert_true(hull[0].x == 0.0 && hull[1].x == 2.0);
    assert_int_equal(polygon_convex_hull(equal, 3, hull), 1);
    assert_int_equal(polygon_convex_hull(equal, 0, hull), 0);
}

// A square of side 2 around the origin, and disks of radius 1: touching a side, a corner, overlapping
// either by less and by more than the tolerance, and inside.
static void a_disk_overlaps_a_polygon_that_it_enters(void **state)
{
    static const vec2 square[] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
    const double diagonal = 1.0 + sqrt(0.5);
    static const double tolerance = 1e-3;
    assert_false(polygon_overlaps_disk((vec2){ 2.0, 0.3 }, 1.0, square, 4, tolerance));
    assert_false(polygon_overlaps_disk((vec2){ 1.9995, 0.3 }, 1.0, square, 4, tolerance));
    assert_true(polygon_overlaps_disk((vec2){ 1.998, 0.3 }, 1.0, square, 4, tolerance));
    assert_false(polygon_overlaps_disk((vec2){ diagonal, -diagonal }, 1.0, square, 4, tolerance));
    assert_true(polygon_overlaps_disk((vec2){ diagonal - 0.002, 0.002 - diagonal }, 1.0, square, 4,
                                      tolerance));
    assert_true(polygon_overlaps_disk((vec2){ 0.1, 0.2 }, 0.01, square, 4, tolerance));
}

static void assert_clipped(vec2 start, vec2 end, bool is_left, vec2 from, vec2 to)
{
    assert_int_equal(polygon_clip_segment(&start, &end, (vec2){ 0.0, 0.0 }, (vec2){ 4.0, 2.0 }),
                     is_left);
    assert_true(vec2_length(vec2_sub(start, from)) <= 1e-15);
    assert_true(vec2_length(vec2_sub(end, to)) <= 1e-15);
}

// The rectangle from (0, 0) to (4, 2).
static void a_segment_is_cut_at_a_rectangle(void **state)
{
    assert_clipped((vec2){ 1, 1 }, (vec2){ 2, 2 }, true, (vec2){ 1, 1 }, (vec2){ 2, 2 });
    assert_clipped((vec2){ -1, -1 }, (vec2){ 3, 3 }, true, (vec2){ 0, 0 }, (vec2){ 2, 2 });
    assert_clipped((vec2){ 5, 1 }, (vec2){ 3, 1 }, true, (vec2){ 4, 1 }, (vec2){ 3, 1 });
    assert_clipped((vec2){ 1, 3 }, (vec2){ 1, -3 }, true, (vec2){ 1, 2 }, (vec2){ 1, 0 });
    assert_clipped((vec2){ -1, 2 }, (vec2){ 9, 2 }, true, (vec2){ 0, 2 }, (vec2){ 4, 2 });
    assert_clipped((vec2){ 3, 4 }, (vec2){ 6, 1 }, false, (vec2){ 3, 4 }, (vec2){ 6, 1 });
    assert_clipped((vec2){ 1, 3 }, (vec2){ 2, 3 }, false, (vec2){ 1, 3 }, (vec2){ 2, 3 });
}

static void assert_apart(const vec2 *a, const vec2 *b, double distance, vec2 on_a, vec2 on_b)
{
    vec2 places[2] = { { NAN, NAN }, { NAN, NAN } };

    assert_true(fabs(polygon_distance(a, 4, b, 4, &places[0], &places[1]) - distance) <= 1e-15);
    assert_true(vec2_length(vec2_sub(places[0], on_a)) <= 1e-15);
    assert_true(vec2_length(vec2_sub(places[1], on_b)) <= 1e-15);
}

// A unit square, one that stands on its corner (3, 0.5), and others that touch or overlap it.
static void polygons_are_as_far_apart_as_their_nearest_points(void **state)
{
    static const vec2 square[] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
    static const vec2 diamond[] = { { 3, 0.5 }, { 4, -0.5 }, { 5, 0.5 }, { 4, 1.5 } };
    static const vec2 diagonal[] = { { 4, 5 }, { 5, 5 }, { 5, 6 }, { 4, 6 } };
    static const vec2 touching[] = { { 1, 0.25 }, { 2, 0.25 }, { 2, 0.75 }, { 1, 0.75 } };
    static const vec2 inside[] = { { 0.4, 0.4 }, { 0.6, 0.4 }, { 0.6, 0.6 }, { 0.4, 0.6 } };
    vec2 on_a, on_b;
    assert_apart(square, diamond, 2.0, (vec2){ 1, 0.5 }, (vec2){ 3, 0.5 });
    assert_apart(diamond, square, 2.0, (vec2){ 3, 0.5 }, (vec2){ 1, 0.5 });
    assert_apart(square, diagonal, 5.0, (vec2){ 1, 1 }, (vec2){ 4, 5 });
    assert_true(polygon_distance(square, 4, touching, 4, &on_a, &on_b) == 0.0);
    assert_true(polygon_distance(square, 4, inside, 4, &on_a, &on_b) == 0.0);
    assert_true(polygon_distance(inside, 4, square, 4, &on_a, &on_b) == 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_vector_along_an_axis_has_its_length_exactly),
        cmocka_unit_test(the_distance_to_a_segment_is_to_its_nearest_point),
        cmocka_unit_test(a_segment_that_is_far_along_an_axis_is_no_nearer_than_that),
        cmocka_unit_test(segments_touch_where_they_cross_or_come_near),
        cmocka_unit_test(a_polygon_holds_what_is_inside_or_on_its_border),
        cmocka_unit_test(a_convex_hull_is_convex_and_has_all_points),
        cmocka_unit_test(points_on_a_line_have_a_hull_of_two_ends_and_equal_ones_of_one),
        cmocka_unit_test(a_disk_overlaps_a_polygon_that_it_enters),
        cmocka_unit_test(a_segment_is_cut_at_a_rectangle),
        cmocka_unit_test(polygons_are_as_far_apart_as_their_nearest_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
