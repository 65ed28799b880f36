// Unit tests of distance and depth of convex hulls: closed forms, and exhaustive search.

#include "core/convex/gjk.h"
#include "core/convex/manifold.h"

#include "tests/unit/core/helper_hull.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

static const mat3 still = { { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } } };
static const vec3 origin = { 0.0, 0.0, 0.0 };

static mat3 turn_about_z(double angle)
{
    return mat3_of_quat((quat){ cos(0.5 * angle), { 0.0, 0.0, sin(0.5 * angle) } });
}

// The witnesses are as far apart as it says, along the normal, whichever direction it began with.
static gjk_result measure(const gjk_pair *pair)
{
    const vec3 starts[] = { { 1.0, 0.0, 0.0 }, { -0.3, 0.2, -1.0 }, { 0.0, -1.0, 0.1 } };
    gjk_result first = gjk_measure(pair, starts[0]);

    for (int k = 0; k < 3; k++) {
        gjk_result t = gjk_measure(pair, starts[k]);
        assert_near(t.distance, first.distance, 1e-12);
        assert_near(vec3_length(t.normal), 1.0, 1e-12);
        vec3 between = vec3_sub(t.on_b, t.on_a);
        assert_true(vec3_length(vec3_sub(between, vec3_scale(t.normal, t.distance))) < 1e-9);
        vec3 axis = starts[k];
        double gap = gjk_find_gap(pair, &axis);
        assert_true(gap <= fmax(0.0, t.distance) + 1e-12 && gap >= 0.0);
        assert_true((gap > 0.0) == (t.distance > 0.0) || fabs(t.distance) < 1e-12);
    }
    return first;
}

static void boxes_apart_face_to_face_edge_to_edge_and_corner_to_corner(void **state)
{
    hull a, b;
    helper_hull_box(2.0, 2.0, 2.0, &a);
    helper_hull_box(1.0, 1.0, 1.0, &b);
    gjk_pair faces = gjk_pair_of(&a, origin, &still, &b, (vec3){ 1.75, 0.2, -0.3 }, &still);
    gjk_result t = measure(&faces);
    assert_near(t.distance, 0.25, 1e-12);
    assert_near(t.normal.x, 1.0, 1e-12);
    gjk_pair edges = gjk_pair_of(&a, origin, &still, &b, (vec3){ 1.8, 1.9, 0.3 }, &still);
    assert_near(measure(&edges).distance, 0.5, 1e-12); // 0.3, 0.4
    gjk_pair corners = gjk_pair_of(&a, origin, &still, &b, (vec3){ 1.6, 1.7, -1.7 }, &still);
    assert_near(measure(&corners).distance, 0.3, 1e-12); // 0.1, 0.2, 0.2
    mat3 eighth = turn_about_z(M_PI / 4.0);
    gjk_pair edge_on_face = gjk_pair_of(&a, origin, &still, &b, (vec3){ 2.0, 0.0, 0.0 }, &eighth);
    assert_near(measure(&edge_on_face).distance, 1.0 - M_SQRT1_2, 1e-12);
}

static void boxes_in_each_other_come_out_the_shortest_way(void **state)
{
    hull a, b;
    helper_hull_box(2.0, 2.0, 2.0, &a);
    helper_hull_box(1.0, 1.0, 1.0, &b);
    gjk_pair faces = gjk_pair_of(&a, origin, &still, &b, (vec3){ 0.2, -1.3, 0.4 }, &still);
    gjk_result t = measure(&faces);
    assert_near(t.distance, -0.2, 1e-12);
    assert_near(t.normal.y, -1.0, 1e-12);
    gjk_pair same = gjk_pair_of(&a, origin, &still, &b, origin, &still);
    assert_near(measure(&same).distance, -1.5, 1e-12);
    mat3 eighth = turn_about_z(M_PI / 4.0);
    gjk_pair corner = gjk_pair_of(&a, origin, &still, &b, (vec3){ 1.5, 0.1, 0.0 }, &eighth);
    t = measure(&corner);
    assert_near(t.distance, 0.5 - M_SQRT1_2, 1e-12);
    assert_near(t.normal.x, 1.0, 1e-12);
}

// A ball is a point with a radius: its distance is that of the point less the radius.
static void points_stand_for_balls(void **state)
{
    hull a, b;
    const double point[1][3] = { { 0.0, 0.0, 0.0 } };
    hull_set_points(point, 1, &a);
    gjk_pair points = gjk_pair_of(&a, origin, &still, &a, (vec3){ 2.0, 3.0, 6.0 }, &still);
    gjk_result t = measure(&points);
    assert_near(t.distance, 7.0, 1e-12);
    assert_near(t.normal.z, 6.0 / 7.0, 1e-12);
    helper_hull_box(2.0, 4.0, 6.0, &b);
    gjk_pair outside = gjk_pair_of(&b, origin, &still, &a, (vec3){ 1.4, 2.3, 0.0 }, &still);
    assert_near(measure(&outside).distance, 0.5, 1e-12);
    gjk_pair inside = gjk_pair_of(&b, origin, &still, &a, (vec3){ 0.3, -1.9, 0.0 }, &still);
    t = measure(&inside);
    assert_near(t.distance, -0.1, 1e-12);
    assert_near(t.normal.y, -1.0, 1e-12);
    gjk_pair same = gjk_pair_of(&a, origin, &still, &a, origin, &still);
    t = gjk_measure(&same, (vec3){ 0.0, 1.0, 0.0 });
    assert_near(t.distance, 0.0, 1e-12);
    assert_near(vec3_length(t.normal), 1.0, 1e-12);
}

// Depth or distance 0, in a face, an edge and a corner, and for flat things.
static void touching_is_neither_apart_nor_deep(void **state)
{
    const vec3 places[] = { { 1.5, 0.2, 0.1 }, { 1.5, 1.5, 0.1 }, { 1.5, -1.5, 1.5 } };
    const double segment[2][3] = { { -1.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0 } };
    hull a, b, s;
    helper_hull_box(2.0, 2.0, 2.0, &a);
    helper_hull_box(1.0, 1.0, 1.0, &b);
    for (int k = 0; k < 3; k++) {
        gjk_pair pair = gjk_pair_of(&a, origin, &still, &b, places[k], &still);
        assert_near(measure(&pair).distance, 0.0, 1e-12);
    }
    hull_set_points(segment, 2, &s);
    mat3 quarter = turn_about_z(M_PI / 2.0);
    gjk_pair crossing = gjk_pair_of(&s, origin, &still, &s, origin, &quarter);
    gjk_result t = gjk_measure(&crossing, (vec3){ 1.0, 0.0, 0.0 });
    assert_near(t.distance, 0.0, 1e-12);
    assert_near(fabs(t.normal.z), 1.0, 1e-9);
    gjk_pair above = gjk_pair_of(&s, origin, &still, &s, (vec3){ 0.3, 0.2, 0.5 }, &quarter);
    assert_near(measure(&above).distance, 0.5, 1e-12);
}

// A plate of 1e-6 of its length, in contact with a corner, and one through which a box stands.
static void thin_plates_are_no_harder(void **state)
{
    hull plate, box;
    helper_hull_box(1.0, 1.0, 1e-6, &plate);
    helper_hull_box(0.1, 0.1, 0.1, &box);
    gjk_pair on = gjk_pair_of(&plate, origin, &still, &box, (vec3){ 0.2, 0.1, 0.05 }, &still);
    gjk_result t = measure(&on);
    assert_near(t.distance, -5e-7, 1e-12);
    assert_near(t.normal.z, 1.0, 1e-9);
    gjk_pair through = gjk_pair_of(&plate, origin, &still, &box, (vec3){ 0.2, 0.1, 0.01 }, &still);
    assert_near(measure(&through).distance, -0.0400005, 1e-12);
    mat3 tiny = mat3_of_quat(quat_unit((quat){ 1.0, { 1e-9, -2e-9, 0.0 } }));
    gjk_pair parallel = gjk_pair_of(&plate, origin, &still, &box, (vec3){ 0.2, 0.1, 0.06 }, &tiny);
    assert_near(measure(&parallel).distance, helper_hull_distance(&parallel), 1e-12);
}

static void random_hulls_agree_with_everything_tried(void **state)
{
    bf_random random;
    int n_deep = 0;
    random_init(&random, 4);
    for (int k = 0; k < 300; k++) {
        hull a, b;
        mat3 r_a = helper_hull_rotation(&random), r_b = helper_hull_rotation(&random);
        double span = k % 2 == 0 ? 0.8 : 2.0;
        vec3 at = { helper_hull_number(&random, -span, span),
                    helper_hull_number(&random, -span, span),
                    helper_hull_number(&random, -span, span) };
        helper_hull_random(&random, 4 + (size_t)k % 25, 1.0, &a);
        if (k % 3 == 0)
            helper_hull_box(helper_hull_number(&random, 0.1, 2.0), 0.5, 1.0, &b);
        else
            helper_hull_random(&random, 4 + (size_t)k % 21, 1.0, &b);
        // Parallel faces and the same place are the hard cases.
        gjk_pair pair = gjk_pair_of(&a, origin, &r_a, k % 7 == 0 ? &a : &b,
                                    k % 11 == 0 ? origin : at, k % 5 == 0 ? &r_a : &r_b);
        double expected = helper_hull_distance(&pair);
        assert_near(measure(&pair).distance, expected, 1e-11);
        n_deep += expected < 0.0;
    }
    assert_in_range(n_deep, 50, 250);
}

// Two pairs of boxes that touch flush, turned out of line by rounding, from which the simplex is left without area: the
// normal is across the face, and the region is the common part of both sides.
static void flush_boxes_tilted_by_rounding_touch_at_their_faces(void **state)
{
    const struct {
        double a[3], b[3];
        mat3 rotation;
        vec3 at, axis, normal;
    } poses[] = {
        { { 0.35, 0.05, 0.3 },
          { 0.35, 0.05, 0.3 },
          { { { 1.0000000000000002, 0.0, 8.020929875194053e-14 },
              { -2.5225252872510616e-27, 1.0000000000000002, 3.1449287383154364e-14 },
              { -8.0209298751940505e-14, -3.1449287383154371e-14, 1.0 } } },
          { -0.35000000000000009, -2.7755575615628914e-17, 1.5777218104420236e-30 },
          { -1.0000000000000777, -6.3720568296828723e-14, -6.8853501558504117e-14 },
          { -1.0, 0.0, 0.0 } },
        { { 0.4, 0.05, 0.3 },
          { 0.4, 0.05, 0.3 },
          { { { 0.99999999999999978, 8.7985174701543656e-14, -3.181672304371073e-13 },
              { -8.7985174701543656e-14, 0.99999999999999978, 2.7969852255516195e-26 },
              { 3.181672304371074e-13, 0.0, 1.0 } } },
          { -0.39999999934147756, 6.1449617616560204e-10, 0.0 },
          { 0.24162181584590936, 0.1001000860872403, 0.056835979336045339 },
          { -1.0, 0.0, 0.0 } },
    };

    for (size_t k = 0; k < sizeof poses / sizeof *poses; k++) {
        const double *of_a = poses[k].a, *of_b = poses[k].b;
        manifold m;
        hull a, b;
        helper_hull_box(of_a[0], of_a[1], of_a[2], &a);
        helper_hull_box(of_b[0], of_b[1], of_b[2], &b);
        gjk_pair pair = { &a, &b, poses[k].rotation, poses[k].at };
        gjk_result t = gjk_measure(&pair, poses[k].axis);
        assert_near(t.distance, helper_hull_distance(&pair), 1e-12);
        assert_near(vec3_dot(t.normal, poses[k].normal), 1.0, 1e-12);
        manifold_find(&pair, manifold_feature_of(&pair, &t), 1e-4, &m);
        assert_true(m.n >= 4);
        for (size_t point = 0; point < m.n; point++)
            assert_near(m.point[point].depth, 0.0, 1e-7);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_apart_face_to_face_edge_to_edge_and_corner_to_corner),
        cmocka_unit_test(boxes_in_each_other_come_out_the_shortest_way),
        cmocka_unit_test(points_stand_for_balls),
        cmocka_unit_test(touching_is_neither_apart_nor_deep),
        cmocka_unit_test(thin_plates_are_no_harder),
        cmocka_unit_test(random_hulls_agree_with_everything_tried),
        cmocka_unit_test(flush_boxes_tilted_by_rounding_touch_at_their_faces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
