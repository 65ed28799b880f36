// Plates with bends: their sides and corners are one surface.

#include "tests/unit/core/helper_disk_state.h"
#include "tests/unit/core/helper_disks.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>

static const double radius = 0.012;

// Distance of c from the rectangle on the side of path a to b that down points to.
static double rectangle_distance(vec2 c, vec2 a, vec2 b, vec2 down, double thickness)
{
    double tx = b.x - a.x, ty = b.y - a.y, length = hypot(tx, ty);
    double along = ((c.x - a.x) * tx + (c.y - a.y) * ty) / length;
    double deep = (c.x - a.x) * down.x + (c.y - a.y) * down.y;

    return hypot(along - fmin(fmax(along, 0.0), length), deep - fmin(fmax(deep, 0.0), thickness));
}

// By the features of the state's boundary: the deepest overlap, and the number of contacts.
static double feature_overlap(const disk_state *s, vec2 c, int *ret_n)
{
    const disk part = { .x = c.x, .y = c.y, .radius = radius };
    double deepest = -INFINITY;

    *ret_n = 0;
    for (uint32_t f = 0; f < s->n_faces + s->n_arcs; f++) {
        bool counts;
        double overlap = disk__overlap(s, &part, f, &counts);
        if (!counts || overlap <= 0.0)
            continue;
        ++*ret_n;
        deepest = fmax(deepest, overlap);
    }
    return deepest;
}

// A path with a bend of `turn`, seen from a grid of places around it: the overlap is that with the
// nearest point of the union of the two rectangles, where no notch of it is filled, and only where
// the sides make an inner corner does a part feel two of them.
static void check_bend(double turn)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.395);
    const double first = M_PI / 2.0 + 0.5 * turn, second = M_PI / 2.0 - 0.5 * turn, h = 0.02;

    // Across the belt, bent towards it or away from it in (0.5, 0.5).
    d->path[0] = (vec2){ 0.5 - 0.2 * cos(first), 0.5 - 0.2 * sin(first) };
    d->path[1] = (vec2){ 0.5, 0.5 };
    d->path[2] = (vec2){ 0.5 + 0.2 * cos(second), 0.5 + 0.2 * sin(second) };
    helper_disks_block(d, 3, h);
    disk_state *s = helper_disk_state_start(&d->def);
    const vec2 down_a = { sin(first), -cos(first) }, down_b = { sin(second), -cos(second) };
    for (int i = 0; i < 120; i++)
        for (int j = 0; j < 120; j++) {
            vec2 c = { 0.44 + 0.001 * i + 1e-5, 0.44 + 0.001 * j + 2e-5 };
            double to_a = rectangle_distance(c, d->path[0], d->path[1], down_a, h);
            double to_b = rectangle_distance(c, d->path[1], d->path[2], down_b, h);
            double distance = fmin(to_a, to_b);
            int n;
            double overlap = feature_overlap(s, c, &n);
            bool is_notch = turn < 0.0 && hypot(c.x - 0.5, c.y - 0.5) < h + radius && c.x > 0.5 &&
                            fabs(atan2(c.y - 0.5, c.x - 0.5)) < fabs(0.5 * turn);
            if (distance <= 1e-9 || is_notch)
                continue;
            assert_true((n > 0) == (distance < radius));
            if (n > 0)
                assert_near(overlap, radius - distance, 1e-12);
            bool is_inner_corner = turn == 0.0 ? false : (turn > 0.0) == (c.x > 0.5);
            assert_true(n <= (is_inner_corner ? 2 : 1));
        }
    helper_disk_state_end(s);
    helper_disks_free(d);
}

static void the_sides_of_a_bent_plate_are_one_surface(void **state)
{
    const double turns[] = { 0.0, 0.3, -0.3, 1.2, -1.2 };

    for (size_t k = 0; k < sizeof turns / sizeof *turns; k++)
        check_bend(turns[k]);
}

// The notch behind an outer bend is filled by an arc around the joint: the distance of the part from the
// joint minus the thickness.
static void a_notch_behind_a_bend_is_filled(void **state)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.395);
    const double h = 0.02;
    int n;

    d->path[0] = (vec2){ 0.6, 0.3 };
    d->path[1] = (vec2){ 0.5, 0.5 };
    d->path[2] = (vec2){ 0.6, 0.7 };
    // Bent against the belt: upstream the joint sticks out, and nothing needs filling behind.
    helper_disks_block(d, 3, h);
    disk_state *s = helper_disk_state_start(&d->def);
    assert_near(feature_overlap(s, (vec2){ 0.5 - 0.01, 0.5 }, &n), radius - 0.01, 1e-12);
    assert_int_equal(n, 1);
    helper_disk_state_end(s);
    d->path[0].x = d->path[2].x = 0.4;
    s = helper_disk_state_start(&d->def);
    assert_near(feature_overlap(s, (vec2){ 0.5 + h + 0.005, 0.5 }, &n), radius - 0.005, 1e-12);
    assert_int_equal(n, 1);
    helper_disk_state_end(s);
    helper_disks_free(d);
}

// Cut into collinear pieces, a plate is the same plate: the part that glides along feels no joint.
static void a_joint_in_a_straight_plate_is_not_felt(void **state)
{
    micro_part end[2];

    for (int cut = 0; cut < 2; cut++) {
        helper_disks *d = helper_disks_make(2.0, 2.0, 0.395);
        d->path[0] = (vec2){ 0.25, 0.25 };
        d->path[1] = cut ? (vec2){ 0.5, 0.5 } : (vec2){ 0.75, 0.75 };
        d->path[2] = (vec2){ 0.75, 0.75 };
        helper_disks_block(d, cut ? 3 : 2, 0.005);
        helper_disks_add(d, 0.46, 0.46 + radius * sqrt(2.0));
        micro_solver *s = helper_disks_start(d);
        helper_disks_advance(s, 30000);
        end[cut] = micro_part_of(s, 0);
        assert_int_equal(micro_measure(s).n_contacts, 1);
        micro_destroy(s);
        helper_disks_free(d);
    }
    assert_true(end[0].x[0] > 0.5);
    assert_near(end[0].x[0], end[1].x[0], 1e-12);
    assert_near(end[0].x[1], end[1].x[1], 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_sides_of_a_bent_plate_are_one_surface),
        cmocka_unit_test(a_notch_behind_a_bend_is_filled),
        cmocka_unit_test(a_joint_in_a_straight_plate_is_not_felt),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
