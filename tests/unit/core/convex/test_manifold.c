// Unit tests of the contact region of two hulls.

#include "core/convex/manifold.h"

#include "tests/unit/core/helper_hull.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

static const mat3 still = { { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } } };
static const vec3 origin = { 0.0, 0.0, 0.0 };

static mat3 turn_about(vec3 axis, double angle)
{
    return mat3_of_quat((quat){ cos(0.5 * angle), vec3_scale(vec3_unit(axis), sin(0.5 * angle)) });
}

static double sum_shares(const manifold *m)
{
    double sum = 0.0;

    for (size_t k = 0; k < m->n; k++)
        sum += m->point[k].weight;
    return sum;
}

/// Force by unit of stiffness.
static double sum_press(const manifold *m)
{
    double sum = 0.0;

    for (size_t k = 0; k < m->n; k++)
        sum += m->point[k].weight * m->point[k].depth;
    return sum;
}

static manifold_feature find(const gjk_pair *pair, manifold *m)
{
    gjk_result touch = gjk_measure(pair, (vec3){ 0.1, 0.2, 1.0 });

    assert_true(touch.distance <= 0.0);
    manifold_feature feature = manifold_feature_of(pair, &touch);
    manifold_find(pair, feature, 0.0, m);
    return feature;
}

static void a_box_rests_on_a_box_on_its_four_corners(void **state)
{
    hull a, b;
    manifold m;
    helper_hull_box(4.0, 4.0, 2.0, &a);
    helper_hull_box(1.0, 2.0, 1.0, &b);
    gjk_pair pair = gjk_pair_of(&a, origin, &still, &b, (vec3){ 0.5, 0.25, 1.49 }, &still);
    manifold_feature feature = find(&pair, &m);
    assert_int_not_equal(feature.kind, MANIFOLD_EDGES);
    assert_true(m.is_least);
    assert_near(m.normal.z, 1.0, 1e-12);
    assert_near(m.depth, 0.01, 1e-12);
    assert_int_equal(m.n, 4);
    for (size_t k = 0; k < 4; k++) {
        assert_near(fabs(m.point[k].at.x - 0.5), 0.5, 1e-12);
        assert_near(fabs(m.point[k].at.y - 0.25), 1.0, 1e-12);
        assert_near(m.point[k].at.z, 0.995, 1e-12);
        assert_near(m.point[k].depth, 0.01, 1e-12);
        assert_near(m.point[k].weight, 0.25, 1e-12);
    }
}

// The overlap of [-2, 2] and [1.5, 2.5] along x; and of a square with itself turned by 45 degrees:
// an octagon with equal sides.
static void what_extends_over_the_side_is_clipped(void **state)
{
    hull a, b;
    manifold m;
    helper_hull_box(4.0, 4.0, 2.0, &a);
    helper_hull_box(1.0, 1.0, 1.0, &b);
    gjk_pair over = gjk_pair_of(&a, origin, &still, &b, (vec3){ 2.0, 0.0, 1.49 }, &still);
    find(&over, &m);
    assert_int_equal(m.n, 4);
    for (size_t k = 0; k < 4; k++)
        assert_true(m.point[k].at.x >= 1.5 - 1e-12 && m.point[k].at.x <= 2.0 + 1e-12);
    assert_near(sum_press(&m), 0.01, 1e-12);
    mat3 eighth = turn_about((vec3){ 0.0, 0.0, 1.0 }, M_PI / 4.0);
    gjk_pair star = gjk_pair_of(&b, origin, &still, &b, (vec3){ 0.0, 0.0, 0.99 }, &eighth);
    find(&star, &m);
    assert_int_equal(m.n, 8);
    for (size_t k = 0; k < 8; k++)
        assert_near(m.point[k].weight, 0.125, 1e-12);
}

// Crossed wedges touch in one point, half way along both.
static void crossing_edges_have_one_point(void **state)
{
    hull a, b;
    manifold m;
    helper_hull_box(1.0, 1.0, 1.0, &a);
    helper_hull_box(1.0, 1.0, 1.0, &b);
    mat3 up = turn_about((vec3){ 1.0, 0.0, 0.0 }, M_PI / 4.0);
    mat3 down = turn_about((vec3){ 0.0, 1.0, 0.0 }, M_PI / 4.0);
    gjk_pair pair = gjk_pair_of(&a, origin, &up, &b, (vec3){ 0.1, 0.2, M_SQRT2 - 0.01 }, &down);
    manifold_feature feature = find(&pair, &m);
    assert_int_equal(feature.kind, MANIFOLD_EDGES);
    assert_true(m.is_least);
    assert_int_equal(m.n, 1);
    assert_near(m.depth, 0.01, 1e-12);
    assert_near(m.point[0].weight, 0.25, 0.0);
    vec3 at = mat3_apply(&up, m.point[0].at), normal = mat3_apply(&up, m.normal);
    assert_near(normal.z, 1.0, 1e-12);
    assert_near(at.x, 0.1, 1e-12);
    assert_near(at.y, 0.0, 1e-12);
    assert_near(at.z, M_SQRT1_2 - 0.005, 1e-12);
}

// An edge that lies in a face: two points at full depth, two at none.
static void an_edge_in_a_face_has_half_the_stiffness(void **state)
{
    hull a, b;
    manifold m;
    helper_hull_box(4.0, 4.0, 2.0, &a);
    helper_hull_box(1.0, 1.0, 1.0, &b);
    mat3 leaning = turn_about((vec3){ 0.0, 1.0, 0.0 }, 0.5);
    double half = 0.5 * (cos(0.5) + sin(0.5));
    gjk_pair pair = gjk_pair_of(&a, origin, &still, &b, (vec3){ 0.3, 0.2, 0.999 + half }, &leaning);
    find(&pair, &m);
    assert_near(m.depth, 0.001, 1e-12);
    assert_int_equal(m.n, 4);
    assert_near(sum_press(&m), 0.5 * m.depth, 1e-12);
    assert_near(sum_shares(&m), 1.0, 1e-12);
}

// What the feature says is what the search found; points lie within both hulls.
static void random_pairs_have_their_depth_and_weights_that_sum_to_one(void **state)
{
    bf_random random;
    int n_edges = 0, n_faces = 0;
    random_init(&random, 6);
    for (int k = 0; k < 400; k++) {
        hull a, b;
        manifold m;
        mat3 r_a = helper_hull_rotation(&random), r_b = helper_hull_rotation(&random);
        helper_hull_random(&random, 4 + (size_t)k % 30, 1.0, &a);
        helper_hull_box(helper_hull_number(&random, 0.5, 2.0), 0.5, 1.0, &b);
        vec3 at = vec3_scale(r_a.row[0], helper_hull_number(&random, 0.5, 1.2));
        gjk_pair pair = gjk_pair_of(&a, origin, &r_a, &b, at, &r_b);
        gjk_result touch = gjk_measure(&pair, (vec3){ 1.0, 0.0, 0.0 });
        if (touch.distance >= -1e-6)
            continue;
        manifold_feature feature = manifold_feature_of(&pair, &touch);
        manifold_find(&pair, feature, 0.0, &m);
        assert_near(m.depth, -touch.distance, 1e-9);
        assert_true(vec3_length(vec3_sub(m.normal, touch.normal)) < 1e-6);
        assert_near(sum_shares(&m), feature.kind == MANIFOLD_EDGES ? 0.25 : 1.0, 1e-12);
        for (size_t p = 0; p < m.n; p++) {
            assert_true(m.point[p].depth >= 0.0 && m.point[p].depth <= m.depth + 1e-12);
            assert_true(m.point[p].weight >= 0.0);
            for (size_t f = 0; f < a.n_faces && feature.kind == MANIFOLD_FACE_A; f++)
                assert_true(vec3_dot(a.normal[f], m.point[p].at) <= a.offset[f] + 1e-9 ||
                            f != feature.of_a);
        }
        n_edges += feature.kind == MANIFOLD_EDGES;
        n_faces += feature.kind != MANIFOLD_EDGES;
    }
    assert_true(n_edges > 20 && n_faces > 20);
}

// A box glides off another: its face carries the contact until hardly anything is left of it, and
// says so when a way to the side has become shorter.
static void a_feature_is_kept_while_it_is_the_least_and_no_longer(void **state)
{
    hull a;
    manifold m;
    helper_hull_box(2.0, 2.0, 2.0, &a);
    gjk_pair pair = gjk_pair_of(&a, origin, &still, &a, (vec3){ 0.0, 0.0, 1.99 }, &still);
    manifold_feature feature = find(&pair, &m);
    mat3 leaning = turn_about((vec3){ 0.0, 1.0, 0.0 }, 0.01);
    for (int k = 0; k < 20; k++) {
        pair.translation.x = 0.099 * k;
        manifold_find(&pair, feature, 0.0, &m);
        assert_true(m.is_least);
        assert_near(sum_press(&m), 0.01, 1e-12);
    }
    // Leaning over the edge its deepest corner is beyond it, and a good deal deeper.
    gjk_pair tilted = gjk_pair_of(&a, origin, &still, &a, (vec3){ 1.0, 0.0, 1.995 }, &leaning);
    manifold_find(&tilted, (manifold_feature){ MANIFOLD_FACE_A, 1, 0 }, 0.0, &m);
    assert_false(m.is_least);
    // Apart along its normal there is nothing.
    pair.translation.z = 2.01;
    manifold_find(&pair, feature, 0.0, &m);
    assert_int_equal(m.n, 0);
    assert_true(m.depth <= 0.0);
}

static void a_prism_lies_on_a_plane_with_all_its_face(void **state)
{
    const manifold_plane floor = { .normal = { 0.0, 0.0, 1.0 }, .offset = 2.0 };
    hull h;
    manifold m;
    hull_from_cylinder(0.5, 1.0, &h);
    manifold_on_plane(&h, (vec3){ 1.0, 1.0, 2.49 }, &still, &floor, 0.0, &m);
    assert_int_equal(m.n, 32);
    assert_near(sum_press(&m), 0.01, 1e-12);
    for (size_t k = 0; k < m.n; k++)
        assert_near(m.point[k].weight, 1.0 / 32.0, 1e-12);
    manifold_on_plane(&h, (vec3){ 1.0, 1.0, 2.5 }, &still, &floor, 0.0, &m);
    assert_int_equal(m.n, 0);
}

static void a_strip_of_a_plane_ends(void **state)
{
    manifold_plane strip = { .normal = { 0.0, 0.0, 1.0 },
                             .half_length = 1.0,
                             .along = { 1.0, 0.0, 0.0 },
                             .middle = { 3.0, 0.0, 0.0 } };
    hull h;
    manifold m;
    helper_hull_box(2.0, 2.0, 2.0, &h);
    manifold_on_plane(&h, (vec3){ 4.0, 0.0, 0.99 }, &still, &strip, 0.0, &m);
    assert_true(m.is_least);
    assert_int_equal(m.n, 4);
    for (size_t k = 0; k < 4; k++)
        assert_true(m.point[k].at.x <= 4.0 + 1e-12);
    manifold_on_plane(&h, (vec3){ 5.1, 0.0, 0.99 }, &still, &strip, 0.0, &m);
    assert_int_equal(m.n, 0);
    assert_false(m.is_least);
}

static void caps_of_cylinders_in_the_same_place_fit_into_the_room(void **state)
{
    vec2 outline[HULL_POINTS_MAX];
    hull h;
    manifold m;
    for (int k = 0; k < HULL_POINTS_MAX; k++) {
        double angle = 2.0 * M_PI * k / HULL_POINTS_MAX;
        outline[k] = (vec2){ cos(angle), sin(angle) };
    }
    hull_from_outline(outline, HULL_POINTS_MAX, 0.0, 1.0, &h);
    for (int k = 0; k < 20; k++) {
        mat3 r = turn_about((vec3){ 0.0, 0.0, 1.0 }, 0.005 * k);
        gjk_pair pair = gjk_pair_of(&h, origin, &still, &h, (vec3){ 0.0, 0.0, 0.99 }, &r);
        find(&pair, &m);
        assert_in_range(m.n, 32, 128);
        assert_near(sum_press(&m), 0.01, 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_rests_on_a_box_on_its_four_corners),
        cmocka_unit_test(what_extends_over_the_side_is_clipped),
        cmocka_unit_test(crossing_edges_have_one_point),
        cmocka_unit_test(an_edge_in_a_face_has_half_the_stiffness),
        cmocka_unit_test(random_pairs_have_their_depth_and_weights_that_sum_to_one),
        cmocka_unit_test(a_feature_is_kept_while_it_is_the_least_and_no_longer),
        cmocka_unit_test(a_prism_lies_on_a_plane_with_all_its_face),
        cmocka_unit_test(a_strip_of_a_plane_ends),
        cmocka_unit_test(caps_of_cylinders_in_the_same_place_fit_into_the_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
