// Unit tests of the limits of work: no scenario keeps its checks busy for long.

#include "core/scene/check_work.h"

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/scene/overlap_grid.h"
#include "core/scene/placement.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static const scene_rect square = { 0.0, 9.0, 0.0, 9.0 };

static void lay_out_random(scene *s, uint32_t n)
{
    helper_scene_belt(s, 9.0, 9.0, 0.05, NULL, 0);
    s->initial.type = SCENE_INITIAL_RANDOM;
    s->initial.n_random = n;
    s->initial.region = square;
}

static void turn_into_boxes(scene *s, double length, double width)
{
    s->cargo[0].shape.type = SCENE_BOX;
    s->cargo[0].shape.length = length;
    s->cargo[0].shape.width = width;
}

static void check(scene *s, bf_faults *ret_faults)
{
    helper_scene_resolve(s);
    *ret_faults = (bf_faults){ .n = 0 };
    scene_check(s, ret_faults);
}

static void assert_limit(const bf_faults *faults, const char *pointer)
{
    assert_int_equal(faults->n, 1);
    assert_int_equal(faults->items[0].code, BF_ELIMIT);
    assert_string_equal(faults->items[0].pointer, pointer);
}

// Boxes of 0.1 x 0.001 m exclude 2 A + P^2/(2 pi) = 0.0067 m2 each, 200,000 of them 16 times the region.
static void needles_that_cannot_find_room_are_refused_before_places_are_tried(void **state)
{
    const bf_faults check_of = { .n = 0 };
    bf_error err = { 0 };
    scene_placement p;
    scene s;

    lay_out_random(&s, 200000);
    turn_into_boxes(&s, 0.1, 0.001);
    helper_scene_resolve(&s);
    assert_int_equal(placement_make_within(&s, 0, &check_of, &p, &err), BF_EINPUT);
    assert_string_equal(err.pointer, "/initial/random");
    assert_non_null(strstr(err.text, "attempts, the limit is 4100000"));
    scene_fini(&s);
}

static void random_places_are_looked_for_within_a_number_of_steps(void **state)
{
    const bf_faults check_of = { .n = 0 };
    scene_placement all, within;
    bf_error err = { 0 };
    scene s;

    lay_out_random(&s, 1000);
    helper_scene_resolve(&s);
    assert_int_equal(placement_make_within(&s, 1000, &check_of, &within, &err), BF_ELIMIT);
    assert_string_equal(err.pointer, "/initial/random");
    assert_int_equal(placement_make_within(&s, 1000000, &check_of, &within, &err), BF_OK);
    assert_int_equal(placement_make(&s, &all, &err), BF_OK);
    assert_memory_equal(all.poses, within.poses, 1000 * sizeof *all.poses);
    placement_fini(&all);
    placement_fini(&within);
    scene_fini(&s);
}

// Parts in rows of boxes one above the other all have the ends of some thousand others near.
static void parts_that_lie_too_near_are_refused(void **state)
{
    enum { ROWS = 8000, COLUMNS = 8 };
    scene_pose *poses = memory_alloc(ROWS * COLUMNS, sizeof *poses);
    bf_faults faults;
    scene s;

    assert_non_null(poses);
    for (size_t k = 0; k < ROWS * COLUMNS; k++)
        poses[k] =
            (scene_pose){ 0.5 + (double)(k / ROWS), 0.01 + 0.00101 * (double)(k % ROWS), 0.0 };
    helper_scene_belt(&s, 9.0, 9.0, 0.05, poses, ROWS * COLUMNS);
    turn_into_boxes(&s, 0.99, 0.001);
    check(&s, &faults);
    assert_limit(&faults, "/initial");
    scene_fini(&s);
    memory_free(poses);
}

static void a_cancelled_check_ends(void **state)
{
    static const _Atomic bool is_cancelled = true;
    static const scene_pose pose = { 1.0, 1.0, 0.0 };
    bf_faults faults = { .is_cancelled = &is_cancelled };
    scene s;

    lay_out_random(&s, 1000);
    helper_scene_resolve(&s);
    scene_check(&s, &faults);
    assert_int_equal(faults.n, 1);
    assert_int_equal(faults.items[0].code, BF_EBUSY);
    scene_fini(&s);
    helper_scene_belt(&s, 9.0, 9.0, 0.05, &pose, 1);
    helper_scene_resolve(&s);
    faults.n = 0;
    scene_check(&s, &faults);
    assert_int_equal(faults.n, 1);
    assert_int_equal(faults.items[0].code, BF_EBUSY);
    scene_fini(&s);
}

static void set_disk(shape_footprint *footprint, double radius)
{
    *footprint = (shape_footprint){ .bounding_radius = radius, .area = M_PI * radius * radius };
}

// The 3 x 3 cells of the small parts hold at most some 40 of them, those of the large ones all 1,000 that lie there.
static void a_large_part_does_not_slow_down_the_search_among_small_ones(void **state)
{
    enum { N = 20000 };
    static scene_pose poses[N];
    static uint32_t kinds[N];
    shape_footprint footprints[2];
    overlap_grid c;
    bf_random random;
    size_t n = 0, other, n_searches = 0;

    set_disk(&footprints[0], 0.06);
    set_disk(&footprints[1], 0.002);
    for (size_t k = 0; k < N; k++)
        kinds[k] = k % 1000 != 0;
    random_init(&random, 1);
    assert_int_equal(overlap_grid_init(&c, footprints, 2, kinds, poses, N, NULL), BF_OK);
    for (; n < N; n_searches++) {
        poses[n] = (scene_pose){ random_unit(&random), random_unit(&random), 0.0 };
        bool is_expected = false;
        for (size_t k = 0; k < n && n < 2000; k++)
            is_expected = is_expected || shape_overlaps(&footprints[kinds[n]], poses[n],
                                                        &footprints[kinds[k]], poses[k]);
        const bool overlaps = overlap_grid_overlaps(&c, n, poses[n], &other);
        if (n < 2000)
            assert_int_equal(overlaps, is_expected);
        if (!overlaps || n % 1000 == 0)
            overlap_grid_add(&c, n++);
    }
    assert_true(c.steps < 300 * n_searches);
    overlap_grid_fini(&c);
}

static void add_outlines(scene *s, size_t n_belts, size_t n_points)
{
    vec2 outline[SCENE_POINTS_MAX];

    for (size_t k = 0; k < n_points; k++) {
        const double angle = 2.0 * M_PI * (double)k / (double)n_points;
        outline[k] = (vec2){ 4.5 + 9.0 * cos(angle), 4.5 + 9.0 * sin(angle) };
    }
    for (size_t k = 0; k < n_belts; k++)
        helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, outline, n_points);
}

static void outlines_with_too_many_points_are_refused(void **state)
{
    bf_faults faults;
    scene s;

    lay_out_random(&s, 10);
    add_outlines(&s, 5, SCENE_POINTS_MAX); // 5 x 1024^2/2 pairs of 20 steps: 5e7
    check(&s, &faults);
    assert_int_equal(faults.n, 0);
    add_outlines(&s, 5, SCENE_POINTS_MAX);
    check(&s, &faults);
    assert_limit(&faults, "/belts");
    scene_fini(&s);
}

static void plates_below_too_many_belts_are_refused(void **state)
{
    vec2 path[SCENE_POINTS_MAX];
    bf_faults faults = { .n = 0 };
    scene s;

    for (size_t k = 0; k < SCENE_POINTS_MAX; k++)
        path[k] = (vec2){ k % 2 == 0 ? 1.0 : 8.0, 1.0 + 0.007 * (double)k };
    lay_out_random(&s, 10);
    add_outlines(&s, SCENE_BELTS_MAX, 100);
    helper_scene_resolve(&s);
    assert_true(check_work(&s, &faults));
    for (size_t k = 0; k < 8; k++) // 8,192 pieces and 25,856 points and belts: 2e8
        helper_scene_add_obstacle(&s, path, SCENE_POINTS_MAX, SCENE_SEALED);
    helper_scene_resolve(&s);
    assert_false(check_work(&s, &faults));
    assert_limit(&faults, "/obstacles");
    scene_fini(&s);
}

// Upright pieces cross all of some 300 strips.
static void plates_that_cross_too_many_parts_are_refused(void **state)
{
    vec2 path[SCENE_POINTS_MAX];
    bf_faults faults;
    scene s;

    for (size_t k = 0; k < SCENE_POINTS_MAX; k++)
        path[k] = (vec2){ 8.9 + 1e-5 * (double)k, k % 2 == 0 ? 0.0 : 9.0 };
    lay_out_random(&s, 0);
    s.initial.type = SCENE_INITIAL_HEXAGONAL;
    s.initial.n_rows = s.initial.n_columns = 320;
    s.initial.first = (vec2){ 0.1, 0.1 };
    s.initial.spacing = 0.0265;
    for (size_t k = 0; k < 14; k++)
        helper_scene_add_obstacle(&s, path, SCENE_POINTS_MAX, SCENE_SEALED)->thickness = 1e-6;
    check(&s, &faults);
    assert_int_equal(faults.n, 0);
    assert_int_equal(placement_check_plates(&s, &s.placement, &faults), BF_OK);
    assert_limit(&faults, "/obstacles");
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(needles_that_cannot_find_room_are_refused_before_places_are_tried),
        cmocka_unit_test(random_places_are_looked_for_within_a_number_of_steps),
        cmocka_unit_test(parts_that_lie_too_near_are_refused),
        cmocka_unit_test(a_cancelled_check_ends),
        cmocka_unit_test(a_large_part_does_not_slow_down_the_search_among_small_ones),
        cmocka_unit_test(outlines_with_too_many_points_are_refused),
        cmocka_unit_test(plates_below_too_many_belts_are_refused),
        cmocka_unit_test(plates_that_cross_too_many_parts_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
