// Unit tests of mixes: how many parts of each kind, which, and what it means for the scene.

#include "core/scene/mix.h"

#include "core/base/memory.h"
#include "core/scene/placement.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

// A belt of 1 m x 1 m with two kinds: cylinders of radius 0.01 m, and boxes of 0.04 m x 0.02 m.
static void make_mix(scene *s, const scene_pose *poses, size_t n)
{
    helper_scene_belt(s, 1.0, 1.0, 0.01, poses, n);
    s->n_cargo = 2;
    scene_cargo_init(&s->cargo[1]);
    s->cargo[0].shape.radius = 0.01;
    s->cargo[1].shape.type = SCENE_BOX;
    s->cargo[1].shape.length = 0.04;
    s->cargo[1].shape.width = 0.02;
}

static void check_counts(const double *shares, size_t n_kinds, size_t n, const size_t *expected)
{
    size_t counts[SCENE_KINDS_MAX];
    scene s;

    scene_init(&s);
    s.n_cargo = n_kinds;
    for (size_t k = 0; k < n_kinds; k++) {
        scene_cargo_init(&s.cargo[k]);
        s.cargo[k].share = shares[k];
    }
    mix_count(&s, n, counts);
    assert_memory_equal(counts, expected, n_kinds * sizeof *counts);
    scene_fini(&s);
}

// 10 parts of 1 : 1 : 1 are 3.33 each: the first of the equal remainders gets the tenth. 7 parts of
// 5 : 3 : 2 are 3.5, 2.1, 1.4: rounded down 6, and the remainder 0.5 is the largest.
static void counts_follow_the_proportions_by_the_largest_remainder(void **state)
{
    check_counts((double[]){ 1, 1, 1 }, 3, 10, (size_t[]){ 4, 3, 3 });
    check_counts((double[]){ 5, 3, 2 }, 3, 7, (size_t[]){ 4, 2, 1 });
    check_counts((double[]){ 0.5, 0.3, 0.2 }, 3, 10, (size_t[]){ 5, 3, 2 });
    check_counts((double[]){ 1e9, 1e-9 }, 2, 1000000, (size_t[]){ 1000000, 0 });
    check_counts((double[]){ 3 }, 1, 5, (size_t[]){ 5 });
    check_counts((double[]){ 1, 1 }, 2, 0, (size_t[]){ 0, 0 });
}

static void one_kind_needs_no_list(void **state)
{
    uint32_t *kinds = (uint32_t *)1;
    scene s;
    scene_init(&s);
    assert_int_equal(mix_draw(&s, 5, &kinds, NULL), BF_OK);
    assert_null(kinds);
    assert_int_equal(mix_kind(kinds, 3), 0);
    scene_fini(&s);
}

// 600 parts of 2 : 1 are 400 and 200, and spread: a run of one kind as long as 40 has a chance of
// (2/3)^40, below 1e-4 even for all 560 places together.
static void kinds_are_spread_and_follow_their_seed(void **state)
{
    enum { N = 600 };
    uint32_t *first, *again, *other;
    size_t n_second = 0, run = 0;
    scene s;
    make_mix(&s, NULL, 0);
    s.cargo[0].share = 2.0;
    assert_int_equal(mix_draw(&s, N, &first, NULL), BF_OK);
    assert_int_equal(mix_draw(&s, N, &again, NULL), BF_OK);
    s.cargo_seed = 2;
    assert_int_equal(mix_draw(&s, N, &other, NULL), BF_OK);
    for (size_t k = 0; k < N; k++) {
        n_second += first[k];
        run = k > 0 && first[k] == first[k - 1] ? run + 1 : 1;
        assert_true(first[k] < 2 && run < 40);
    }
    assert_int_equal(n_second, 200);
    assert_memory_equal(first, again, N * sizeof *first);
    assert_true(memcmp(first, other, N * sizeof *first) != 0);
    memory_free(first);
    memory_free(again);
    memory_free(other);
    scene_fini(&s);
}

// Kinds take area in proportion: 1/rho = (0.5/rho_1 + 0.5/rho_2). Cylinders of 0.01 m:
// 1/(2 sqrt(3) 1e-4) = 2886.75 per m2; boxes of 8 cm2: 1250. Together 1744.6..., cut to 1744.
static void the_packing_of_a_mix_is_the_mean_of_areas(void **state)
{
    scene s;
    make_mix(&s, NULL, 0);
    helper_scene_resolve(&s);
    double one = 1.0 / (2.0 * sqrt(3.0) * 1e-4), two = 1250.0;
    assert_near(scene_packing_density(&s), floor(1.0 / (0.5 / one + 0.5 / two)), 1e-9);
    assert_near(scene_packing_density(&s), 1744.0, 1e-9);
    assert_true(s.is_mix);
    scene_fini(&s);
}

// 2/3 of the radius of a disk of the footprint's area, for each kind, unless micro says otherwise.
static void each_kind_has_its_own_lever_of_spin_friction(void **state)
{
    scene s;
    make_mix(&s, NULL, 0);
    helper_scene_resolve(&s);
    assert_near(s.cargo[0].spin_friction_radius, 2.0 / 3.0 * 0.01, 1e-16);
    assert_near(s.cargo[1].spin_friction_radius, 2.0 / 3.0 * sqrt(8e-4 / M_PI), 1e-16);
    assert_true(s.micro.spin_friction_radius == s.cargo[0].spin_friction_radius);
    scene_fini(&s);
    make_mix(&s, NULL, 0);
    s.micro.spin_friction_radius = 0.5;
    helper_scene_resolve(&s);
    assert_true(s.cargo[0].spin_friction_radius == 0.5 && s.cargo[1].spin_friction_radius == 0.5);
    scene_fini(&s);
}

// The second kind's mass is at fault: it is pointed at below its place in the list.
static void faults_of_a_kind_point_into_the_list(void **state)
{
    static const scene_pose pose = { 0.5, 0.5, 0.0 };
    bf_faults faults = { 0 };
    bf_error err;
    scene s;
    make_mix(&s, &pose, 1);
    s.cargo[1].mass = 0.0;
    helper_scene_resolve(&s);
    scene_check(&s, &faults);
    assert_int_equal(faults_status(&faults, &err), BF_EINPUT);
    assert_string_equal(err.pointer, "/cargo/1/mass_kg");
    scene_fini(&s);
}

static size_t count_faults(scene *s, const char *text)
{
    bf_faults faults = { 0 };

    scene_check(s, &faults);
    if (faults.n > 0 && strstr(faults.items[0].text, text) == NULL)
        fail_msg("%s", faults.items[0].text);
    return faults.n;
}

// Two parts, one of each kind, whichever is which: the box's end is 0.02 m from its centre, its side
// 0.01 m, its corner hypot(0.02, 0.01); the disk's radius is 0.01 m.
static void kinds_overlap_by_their_own_footprints(void **state)
{
    const double corner = 0.02 + 0.01 * sqrt(0.5), side = 0.01 + 0.01 * sqrt(0.5);
    const struct {
        scene_pose by;
        size_t n_faults;
    } cases[] = {
        { { 0.5301, 0.5, 0.0 }, 0 },
        { { 0.5299, 0.5, 0.0 }, 1 },
        { { 0.5, 0.5201, 0.0 }, 0 },
        { { 0.5, 0.5199, 0.0 }, 1 },
        { { 0.5 + corner + 1e-4, 0.5 + side + 1e-4, 0.0 }, 0 },
        { { 0.5 + corner - 1e-4, 0.5 + side - 1e-4, 0.0 }, 1 },
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const scene_pose poses[] = { { 0.5, 0.5, 0.0 }, cases[k].by };
        scene s;
        make_mix(&s, poses, 2);
        helper_scene_resolve(&s);
        assert_int_equal(count_faults(&s, "overlaps"), cases[k].n_faults);
        scene_fini(&s);
    }
}

// The wall is where the part of that kind ends: 0.011 m is enough for a disk and not for a box that
// lies across.
static void overlaps_with_walls_depend_on_the_footprint_of_the_kind(void **state)
{
    const scene_pose poses[] = { { 0.2, 0.011, M_PI / 2.0 }, { 0.7, 0.011, M_PI / 2.0 } };
    scene s;
    make_mix(&s, poses, 2);
    helper_scene_resolve(&s);
    assert_int_equal(count_faults(&s, "over the south wall"), 1);
    scene_fini(&s);
}

static void a_random_mix_has_its_proportions_and_no_overlaps(void **state)
{
    scene_placement p = { 0 };
    size_t n_boxes = 0;
    scene s;
    make_mix(&s, NULL, 0);
    s.initial.type = SCENE_INITIAL_RANDOM;
    s.initial.n_random = 400;
    s.initial.region = (scene_rect){ 0.05, 0.95, 0.05, 0.95 };
    s.cargo[0].share = 3.0;
    helper_scene_resolve(&s);
    assert_int_equal(count_faults(&s, ""), 0);
    assert_int_equal(placement_make(&s, &p, NULL), BF_OK);
    for (size_t k = 0; k < p.n; k++) {
        n_boxes += p.kinds[k];
        // Disks are not turned, boxes are.
        assert_true((p.poses[k].heading != 0.0) == (p.kinds[k] == 1));
    }
    assert_int_equal(n_boxes, 100);
    placement_fini(&p);
    assert_null(p.kinds);
    scene_fini(&s);
}

static void out_of_memory_anywhere_is_an_error(void **state)
{
    bf_status status = BF_ENOMEM;
    scene_placement p = { 0 };
    scene s;
    make_mix(&s, NULL, 0);
    s.initial.type = SCENE_INITIAL_RANDOM;
    s.initial.n_random = 20;
    s.initial.region = (scene_rect){ 0.05, 0.95, 0.05, 0.95 };
    helper_scene_resolve(&s);
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = placement_make(&s, &p, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || (status == BF_ENOMEM && p.poses == NULL));
    }
    placement_fini(&p);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_follow_the_proportions_by_the_largest_remainder),
        cmocka_unit_test(one_kind_needs_no_list),
        cmocka_unit_test(kinds_are_spread_and_follow_their_seed),
        cmocka_unit_test(the_packing_of_a_mix_is_the_mean_of_areas),
        cmocka_unit_test(each_kind_has_its_own_lever_of_spin_friction),
        cmocka_unit_test(faults_of_a_kind_point_into_the_list),
        cmocka_unit_test(kinds_overlap_by_their_own_footprints),
        cmocka_unit_test(overlaps_with_walls_depend_on_the_footprint_of_the_kind),
        cmocka_unit_test(a_random_mix_has_its_proportions_and_no_overlaps),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
