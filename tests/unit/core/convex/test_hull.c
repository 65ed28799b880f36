// Unit tests of convex bodies.

#include "core/convex/hull.h"

#include "core/scene/shape.h"
#include "tests/unit/core/helper_hull.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static void assert_counts(const hull *h, size_t n_vertices, size_t n_faces)
{
    assert_int_equal(h->n_vertices, n_vertices);
    assert_int_equal(h->n_faces, n_faces);
    assert_int_equal(h->n_edges, n_vertices + n_faces - 2); // Euler
    assert_int_equal(h->first[n_faces], 2 * h->n_edges);
    assert_int_equal(h->around[n_vertices], 2 * h->n_edges);
}

// All vertices are below every face, its own corners in it; edges stand between their faces.
static void assert_sound(const hull *h)
{
    for (size_t f = 0; f < h->n_faces; f++) {
        assert_near(vec3_length(h->normal[f]), 1.0, 1e-12);
        for (size_t k = 0; k < h->n_vertices; k++)
            assert_true(vec3_dot(h->normal[f], hull_vertex(h, k)) <=
                        h->offset[f] + 1e-9 * h->radius);
        for (size_t k = h->first[f]; k < h->first[f + 1]; k++)
            assert_near(vec3_dot(h->normal[f], hull_vertex(h, h->corner[k])), h->offset[f],
                        1e-9 * h->radius);
    }
    for (size_t e = 0; e < h->n_edges; e++) {
        vec3 along = vec3_sub(hull_vertex(h, h->edge[e].to), hull_vertex(h, h->edge[e].from));
        vec3 between = vec3_cross(h->normal[h->edge[e].left], h->normal[h->edge[e].right]);
        assert_true(vec3_dot(along, between) > 0.0);
        assert_near(vec3_dot(along, h->normal[h->edge[e].left]), 0.0, 1e-9 * h->radius);
        assert_near(vec3_dot(along, h->normal[h->edge[e].right]), 0.0, 1e-9 * h->radius);
    }
}

// Besides its corners: its middle, middles of faces, of edges and a third along an edge.
static void points_that_are_no_corners_are_dropped(void **state)
{
    const double points[][3] = {
        { 0.0, 0.0, 0.0 },  { -1.0, -2.0, -3.0 }, { 1.0, -2.0, -3.0 },    { 0.0, 2.0, 3.0 },
        { 1.0, 2.0, -3.0 }, { -1.0, 2.0, -3.0 },  { -1.0, -2.0, 3.0 },    { 1.0, 0.3, 0.7 },
        { 1.0, -2.0, 3.0 }, { 1.0, 2.0, 3.0 },    { -1.0, 2.0, 3.0 },     { 0.0, 0.0, 3.0 },
        { 1.0, 2.0, -1.0 }, { -1.0, 0.0, 3.0 },   { 1.0 / 3.0, 2.0, 3.0 }
    };
    hull h;
    assert_int_equal(hull_from_points(points, sizeof points / sizeof *points, &h, NULL), BF_OK);
    assert_counts(&h, 8, 6);
    assert_sound(&h);
    assert_near(h.radius, sqrt(14.0), 1e-15);
}

// V = l w h, I = m/12 (w^2 + h^2, ...), wherever the box is.
static void a_box_weighs_what_it_should(void **state)
{
    const vec2 outline[] = { { 5.0, 7.0 }, { 7.0, 7.0 }, { 7.0, 10.0 }, { 5.0, 10.0 } };
    hull h;
    hull_from_outline(outline, 4, -3.0, 1.0, &h);
    assert_counts(&h, 8, 6);
    assert_sound(&h);
    hull_mass m = hull_measure(&h);
    assert_near(m.volume, 24.0, 1e-12);
    assert_near(vec3_length(vec3_sub(m.centre, (vec3){ 6.0, 8.5, -1.0 })), 0.0, 1e-13);
    assert_near(m.inertia.row[0].x, (9.0 + 16.0) / 12.0, 1e-12);
    assert_near(m.inertia.row[1].y, (4.0 + 16.0) / 12.0, 1e-12);
    assert_near(m.inertia.row[2].z, (4.0 + 9.0) / 12.0, 1e-12);
    assert_near(m.inertia.row[0].y, 0.0, 1e-12);
    assert_near(m.inertia.row[2].x, 0.0, 1e-12);
}

// The integral of p p^T over a tetrahedron about its centre is V/20 sum p p^T over its corners.
static void a_tetrahedron_weighs_what_it_should(void **state)
{
    const double points[][3] = {
        { 0.0, 0.0, 0.0 }, { 4.0, 0.0, 0.0 }, { 1.0, 3.0, 0.0 }, { 1.0, 1.0, 2.0 }
    };
    hull h;
    assert_int_equal(hull_from_points(points, 4, &h, NULL), BF_OK);
    assert_counts(&h, 4, 4);
    assert_sound(&h);
    hull_mass m = hull_measure(&h);
    assert_near(m.volume, 4.0, 1e-13);
    assert_near(vec3_length(vec3_sub(m.centre, (vec3){ 1.5, 1.0, 0.5 })), 0.0, 1e-14);
    double yy = (1.0 + 1.0 + 4.0 + 0.0) / 20.0, zz = (3.0 * 0.25 + 2.25) / 20.0;
    double xy = (1.5 * 1.0 - 2.5 * 1.0 - 0.5 * 2.0) / 20.0;
    assert_near(m.inertia.row[0].x, yy + zz, 1e-14);
    assert_near(m.inertia.row[0].y, -xy, 1e-14);
}

// shape_volume() sums cones over facets that it finds by itself.
static void random_hulls_are_sound_and_have_their_volume(void **state)
{
    bf_random random;
    random_init(&random, 1);
    for (int k = 0; k < 40; k++) {
        double points[HULL_POINTS_MAX][3];
        size_t n = 4 + (size_t)k;
        hull h;
        for (size_t m = 0; m < n; m++)
            for (int axis = 0; axis < 3; axis++)
                points[m][axis] = helper_hull_number(&random, -1.0, 2.0);
        assert_int_equal(hull_from_points((const double(*)[3])points, n, &h, NULL), BF_OK);
        assert_sound(&h);
        assert_counts(&h, h.n_vertices, h.n_faces);
        scene_shape shape = { .type = SCENE_HULL, .n_vertices = n, .vertices = points };
        double volume = shape_volume(&shape);
        assert_near(hull_measure(&h).volume, volume, 1e-12 * volume);
    }
}

// A box turned by R has the tensor R diag R^T.
static void principal_axes_undo_a_rotation(void **state)
{
    bf_random random;
    random_init(&random, 2);
    for (int k = 0; k < 20; k++) {
        mat3 r = helper_hull_rotation(&random);
        hull h;
        vec3 moments;
        helper_hull_box(1.0, 2.0, 3.0, &h);
        mat3 back = mat3_between(&r, &(mat3){ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } });
        hull_move(&h, (vec3){ 0.5, -1.0, 2.0 }, &back);
        assert_sound(&h);
        hull_mass m = hull_measure(&h);
        mat3 axes = hull_principal_axes(&m.inertia, &moments);
        assert_near(moments.x + moments.y + moments.z, 2.0 * 14.0 / 12.0, 1e-12);
        assert_near(moments.x * moments.y * moments.z, 13.0 * 10.0 * 5.0 / 1728.0, 1e-12);
        for (int i = 0; i < 3; i++) {
            vec3 axis = mat3_column(&axes, i);
            vec3 image = mat3_apply(&m.inertia, axis);
            double moment = vec3_component(moments, i);
            assert_near(vec3_length(vec3_sub(image, vec3_scale(axis, moment))), 0.0, 1e-12);
        }
        vec3 z = vec3_cross(mat3_column(&axes, 0), mat3_column(&axes, 1));
        assert_near(vec3_dot(z, mat3_column(&axes, 2)), 1.0, 1e-12);
    }
}

static void a_diagonal_tensor_is_left_alone(void **state)
{
    const mat3 m = { { { 3.0, 0.0, 1e-17 }, { 0.0, 3.0, 0.0 }, { 1e-17, 0.0, 1.0 } } };
    vec3 moments;
    mat3 axes = hull_principal_axes(&m, &moments);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            assert_true(vec3_component(axes.row[i], j) == (i == j ? 1.0 : 0.0));
    assert_true(moments.x == 3.0 && moments.z == 1.0);
}

static void a_cylinder_is_a_prism_with_its_corners_on_the_circle(void **state)
{
    hull h;
    hull_from_cylinder(0.012, 0.008, &h);
    assert_counts(&h, 64, 34);
    assert_sound(&h);
    for (size_t k = 0; k < 64; k++) {
        assert_near(hypot(h.x[k], h.y[k]), 0.012, 1e-16);
        assert_near(fabs(h.z[k]), 0.004, 1e-18);
    }
}

static void the_largest_prism_fits(void **state)
{
    vec2 outline[HULL_POINTS_MAX];
    hull h;
    for (int k = 0; k < HULL_POINTS_MAX; k++) {
        double angle = 2.0 * M_PI * k / HULL_POINTS_MAX;
        outline[k] = (vec2){ cos(angle), 2.0 * sin(angle) };
    }
    hull_from_outline(outline, HULL_POINTS_MAX, 0.0, 0.3, &h);
    assert_counts(&h, 128, 66);
    assert_sound(&h);
    // The area of a regular polygon, stretched to twice its width.
    double area = 2.0 * 0.5 * HULL_POINTS_MAX * sin(2.0 * M_PI / HULL_POINTS_MAX);
    assert_near(hull_measure(&h).volume, 0.3 * area, 1e-12);
    assert_near(hull_vertex(&h, hull_support(&h, (vec3){ 0, 0, 1 })).z, 0.3, 0.0);
}

static void the_support_is_the_farthest_vertex_and_faces_look_from_it(void **state)
{
    bf_random random;
    random_init(&random, 3);
    for (int k = 0; k < 50; k++) {
        hull h;
        helper_hull_random(&random, 5 + (size_t)k, 1.0, &h);
        mat3 r = helper_hull_rotation(&random);
        vec3 d = r.row[0];
        size_t found = hull_support(&h, d);
        size_t face = hull_facing(&h, found, d);
        bool has_corner = false;
        for (size_t m = 0; m < h.n_vertices; m++)
            assert_true(vec3_dot(d, hull_vertex(&h, m)) <= vec3_dot(d, hull_vertex(&h, found)));
        for (size_t m = h.first[face]; m < h.first[face + 1]; m++)
            has_corner |= h.corner[m] == found;
        assert_true(has_corner);
    }
}

static void points_in_a_plane_are_refused_and_leave_the_output_alone(void **state)
{
    const double points[][3] = { { 0.0, 0.0, 1.0 },
                                 { 1.0, 0.0, 1.0 },
                                 { 0.0, 1.0, 1.0 },
                                 { 1.0, 1.0, 1.0 },
                                 { 0.2, 0.3, 1.0 } };
    hull h = { .n_vertices = 77 };
    bf_error err = { .code = BF_OK };
    assert_int_equal(hull_from_points(points, 5, &h, &err), BF_EINPUT);
    assert_int_equal(h.n_vertices, 77);
    assert_int_equal(err.code, BF_EINPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_that_are_no_corners_are_dropped),
        cmocka_unit_test(a_box_weighs_what_it_should),
        cmocka_unit_test(a_tetrahedron_weighs_what_it_should),
        cmocka_unit_test(random_hulls_are_sound_and_have_their_volume),
        cmocka_unit_test(principal_axes_undo_a_rotation),
        cmocka_unit_test(a_diagonal_tensor_is_left_alone),
        cmocka_unit_test(a_cylinder_is_a_prism_with_its_corners_on_the_circle),
        cmocka_unit_test(the_largest_prism_fits),
        cmocka_unit_test(the_support_is_the_farthest_vertex_and_faces_look_from_it),
        cmocka_unit_test(points_in_a_plane_are_refused_and_leave_the_output_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
