// Unit tests of where the parts are at the start, and of the check of places.

#include "core/scene/placement.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/base/random.h"
#include "core/scene/shape.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

static const double radius = 0.012; // of the paper's cylinders, m

static scene_placement make(const scene *s)
{
    scene_placement p = { 0 };
    assert_int_equal(placement_make(s, &p, NULL), BF_OK);
    return p;
}

/// The faults of the scene's places.
static const bf_faults *check(const scene *s)
{
    static bf_faults faults;
    scene_placement p = make(s);

    faults = (bf_faults){ 0 };
    assert_int_equal(placement_check(s, &p, &faults, NULL), BF_OK);
    placement_fini(&p);
    return &faults;
}

/// A belt of 1 x 0.5 m with cylinders at these places.
static void lay_out(scene *s, const scene_pose *poses, size_t n)
{
    helper_scene_belt(s, 1.0, 0.5, 0.005, poses, n);
    helper_scene_resolve(s);
}

static void turn_into_boxes(scene *s, double length, double width)
{
    s->cargo[0].shape.type = SCENE_BOX;
    s->cargo[0].shape.length = length;
    s->cargo[0].shape.width = width;
}

static void lay_out_random(scene *s, uint32_t n, scene_rect region)
{
    lay_out(s, NULL, 0);
    s->initial.type = SCENE_INITIAL_RANDOM;
    s->initial.n_random = n;
    s->initial.region = region;
}

static void listed_places_are_taken_as_they_are(void **state)
{
    static const scene_pose poses[] = { { 0.1, 0.2, 0.3 }, { 0.4, 0.25, -6.0 } };
    scene s;

    lay_out(&s, poses, 2);
    scene_placement p = make(&s);
    assert_int_equal(p.n, 2);
    assert_memory_equal(p.poses, poses, sizeof poses);
    placement_fini(&p);
    assert_null(p.poses);
    placement_fini(NULL);
    scene_fini(&s);
}

static void example_1_lies_in_16_rows_of_12(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    scene_placement p = make(&s);
    double spacing = 1.02 * 2.0 * radius;
    assert_int_equal(p.n, 192);
    for (size_t k = 0; k < p.n; k++) {
        double row = (double)(k / 12), column = (double)(k % 12);
        double shift = k / 12 % 2 == 1 ? 0.5 : 0.0;
        assert_near(p.poses[k].x, 0.10 + (column + shift) * spacing, 1e-15);
        assert_near(p.poses[k].y, 0.11 + row * spacing * sqrt(3.0) / 2.0, 1e-15);
        assert_true(p.poses[k].heading == 0.0);
    }
    placement_fini(&p);
    assert_int_equal(check(&s)->n, 0);
    scene_fini(&s);
}

static void cylinders_may_touch_but_not_overlap(void **state)
{
    static const double gaps[] = { 1e-3, 1e-10, -1e-10, -1e-8, -0.01 };
    scene s;

    for (size_t k = 0; k < sizeof gaps / sizeof *gaps; k++) {
        double angle = 0.7 * (double)k, off = 2.0 * radius + gaps[k];
        scene_pose poses[] = { { 0.5, 0.25, 0.0 },
                               { 0.5 + off * cos(angle), 0.25 + off * sin(angle), 0.0 } };
        lay_out(&s, poses, 2);
        const bf_faults *faults = check(&s);
        assert_int_equal(faults->n, gaps[k] < -SCENE_TOLERANCE);
        if (faults->n > 0)
            assert_string_equal(faults->items[0].pointer, "/initial/positions_m/1");
        scene_fini(&s);
    }
}

static void boxes_overlap_by_their_sides_and_corners(void **state)
{
    // Boxes of 0.04 x 0.02: one at the origin of the offsets, another at (x, y), turned.
    static const struct {
        double x, y, turn;
        bool is_free;
    } cases[] = {
        { 0.0401, 0.0, 0.0, true },
        { 0.0399, 0.0, 0.0, false },
        { 0.0, 0.0201, 0.0, true },
        { 0.0, 0.0199, 0.0, false },
        { 0.0301, 0.0, M_PI / 2, true },
        { 0.0299, 0.0, M_PI / 2, false },
        { 0.0, 0.0299, M_PI / 2, false },
        { 0.0, 0.0301, M_PI / 2, true },
        // Turned by 45 degrees: half extent (0.02 + 0.01)/sqrt(2) = 0.0212 along both axes.
        { 0.0413, 0.0, M_PI / 4, true },
        { 0.0411, 0.0, M_PI / 4, false },
        { 0.0, 0.0, 1.0, false },
        { 0.04, 0.02, 0.0, true },
    };
    scene s;

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        for (double all = 0.0; all < 6.0; all += 0.7) { // the pair as a whole, turned
            double c = cos(all), d = sin(all);
            scene_pose poses[] = { { 0.5, 0.25, all },
                                   { 0.5 + c * cases[k].x - d * cases[k].y,
                                     0.25 + d * cases[k].x + c * cases[k].y,
                                     all + cases[k].turn } };
            lay_out(&s, poses, 2);
            turn_into_boxes(&s, 0.04, 0.02);
            assert_int_equal(check(&s)->n, !cases[k].is_free);
            scene_fini(&s);
        }
    }
}

static void cargo_must_not_overlap_walls_and_its_centres_lie_in_the_domain(void **state)
{
    static const struct {
        scene_pose pose;
        const char *words; // NULL: fine
    } cases[] = {
        { { 0.5, radius, 0.0 }, NULL },       { { 0.5, radius - 1e-6, 0.0 }, "south wall" },
        { { 0.5, 0.5 - radius, 0.0 }, NULL }, { { 0.5, 0.5 - radius + 1e-6, 0.0 }, "north wall" },
        { { 0.0, 0.25, 0.0 }, NULL },         { { -1e-6, 0.25, 0.0 }, "west" },
        { { 1.0, 0.25, 0.0 }, NULL },         { { 1.0 + 1e-6, 0.25, 0.0 }, "east" },
        { { 1e300, 0.25, 0.0 }, "east" },     { { 0.5, NAN, 0.0 }, "south wall" },
    };
    scene s;

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        lay_out(&s, &cases[k].pose, 1);
        const bf_faults *faults = check(&s);
        assert_int_equal(faults->n, cases[k].words != NULL);
        if (cases[k].words != NULL)
            assert_non_null(strstr(faults->items[0].text, cases[k].words));
        scene_fini(&s);
    }
}

static void a_turned_box_extends_farther_than_a_straight_one(void **state)
{
    // Half extent across the belt: 0.01 straight, (0.02 + 0.01)/sqrt(2) = 0.0212 at 45 degrees.
    scene s;

    lay_out(&s, (scene_pose[]){ { 0.3, 0.015, 0.0 }, { 0.6, 0.015, M_PI / 4 } }, 2);
    turn_into_boxes(&s, 0.04, 0.02);
    const bf_faults *faults = check(&s);
    assert_int_equal(faults->n, 1);
    assert_string_equal(faults->items[0].pointer, "/initial/positions_m/1");
    scene_fini(&s);
}

static void of_many_bad_places_only_a_few_are_reported(void **state)
{
    enum { N = 1000 };
    scene_pose poses[N];
    scene s;

    for (size_t k = 0; k < N; k++)
        poses[k] = (scene_pose){ 0.5, 0.25, 0.0 };
    lay_out(&s, poses, N);
    assert_in_range(check(&s)->n, 1, 8);
    scene_fini(&s);
    for (size_t k = 0; k < N; k++)
        poses[k] = (scene_pose){ 5.0 + (double)k, 0.25, 0.0 };
    lay_out(&s, poses, N);
    assert_in_range(check(&s)->n, 1, 8);
    scene_fini(&s);
}

static bool is_overlapping(const shape_footprint *f, scene_pose a, scene_pose b)
{
    vec2 corners_a[SCENE_VERTICES_MAX + 1], corners_b[SCENE_VERTICES_MAX + 1];

    if (f->n_corners == 0)
        return vec2_length((vec2){ a.x - b.x, a.y - b.y }) <
               2.0 * f->bounding_radius - SCENE_TOLERANCE;
    shape_place(f, a, corners_a);
    shape_place(f, b, corners_b);
    return polygon_overlaps(corners_a, f->n_corners, corners_b, f->n_corners, SCENE_TOLERANCE);
}

static void the_search_by_cells_finds_what_a_search_of_all_pairs_finds(void **state)
{
    enum { N = 40 };
    bf_random random;

    random_init(&random, 11);
    for (int round = 0; round < 400; round++) {
        scene_pose poses[N];
        scene s;
        size_t first = N;
        for (size_t k = 0; k < N; k++)
            poses[k] =
                (scene_pose){ 0.05 + 0.9 * random_unit(&random), 0.05 + 0.4 * random_unit(&random),
                              7.0 * random_unit(&random) };
        lay_out(&s, poses, N);
        if (round % 2 == 1)
            turn_into_boxes(&s, 0.05, 0.01);
        shape_footprint f = shape_footprint_of(&s.cargo[0].shape);
        for (size_t k = N; k-- > 0;) {
            for (size_t m = 0; m < k; m++)
                first = is_overlapping(&f, poses[k], poses[m]) ? k : first;
        }
        const bf_faults *faults = check(&s);
        assert_int_equal(faults->n > 0, first < N);
        char pointer[BF_POINTER_SIZE];
        snprintf(pointer, sizeof pointer, "/initial/positions_m/%zu", first);
        if (first < N)
            assert_string_equal(faults->items[0].pointer, pointer);
        scene_fini(&s);
    }
}

static void random_places_are_free_inside_and_within_the_region(void **state)
{
    static const scene_rect region = { 0.0, 0.4, 0.0, 0.5 };
    scene s;

    for (int is_box = 0; is_box < 2; is_box++) {
        lay_out_random(&s, 150, region);
        if (is_box)
            turn_into_boxes(&s, 0.04, 0.01);
        scene_placement p = make(&s);
        assert_int_equal(p.n, 150);
        for (size_t k = 0; k < p.n; k++) {
            assert_true(p.poses[k].x >= 0.0 && p.poses[k].x <= 0.4);
            assert_true(p.poses[k].y >= 0.0 && p.poses[k].y <= 0.5);
        }
        placement_fini(&p);
        assert_int_equal(check(&s)->n, 0);
        scene_fini(&s);
    }
}

static void a_seed_gives_the_same_places_every_time_and_another_gives_others(void **state)
{
    scene s;

    lay_out_random(&s, 50, (scene_rect){ 0.1, 0.4, 0.1, 0.4 });
    scene_placement a = make(&s), b = make(&s);
    assert_memory_equal(a.poses, b.poses, 50 * sizeof *a.poses);
    s.initial.seed = 2;
    scene_placement c = make(&s);
    assert_memory_not_equal(a.poses, c.poses, 50 * sizeof *a.poses);
    // The first place comes straight from the generator.
    bf_random random;
    random_init(&random, 2);
    assert_true(c.poses[0].x == 0.1 + random_unit(&random) * (0.4 - 0.1));
    assert_true(c.poses[0].y == 0.1 + random_unit(&random) * (0.4 - 0.1));
    placement_fini(&a);
    placement_fini(&b);
    placement_fini(&c);
    scene_fini(&s);
}

static void too_many_random_parts_are_refused_and_the_output_untouched(void **state)
{
    // 0.2 x 0.2 m hold at most 0.0576/(2 sqrt(3) r^2) = 115 cylinders, at random about 70.
    static const uint32_t many[] = { 110, 1000, SCENE_PARTS_MAX };
    scene s;

    for (size_t k = 0; k < sizeof many / sizeof *many; k++) {
        scene_placement p = { .n = 77 };
        bf_error err = { 0 };
        lay_out_random(&s, many[k], (scene_rect){ 0.1, 0.3, 0.1, 0.3 });
        assert_int_equal(placement_make(&s, &p, &err), BF_EINPUT);
        assert_string_equal(err.pointer, "/initial/random");
        assert_non_null(strstr(err.text, "about half of it"));
        assert_int_equal(p.n, 77);
        assert_null(p.poses);
        scene_fini(&s);
    }
}

static void without_memory_nothing_is_placed_or_lost(void **state)
{
    scene s;

    lay_out_random(&s, 50, (scene_rect){ 0.1, 0.4, 0.1, 0.4 });
    for (size_t n = 1;; n++) {
        scene_placement p = { .n = 77 };
        memory_plan_fault(n, 0);
        bf_status status = placement_make(&s, &p, NULL);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        if (n_faults == 0) {
            assert_int_equal(status, BF_OK);
            placement_fini(&p);
            break;
        }
        assert_int_equal(status, BF_ENOMEM);
        assert_int_equal(p.n, 77);
    }
    scene_placement p = make(&s);
    s.initial.type = SCENE_INITIAL_POSITIONS; // random places are not checked again
    for (size_t n = 1;; n++) {
        static bf_faults faults;
        memory_plan_fault(n, 0);
        bf_status status = placement_check(&s, &p, &faults, NULL);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        assert_int_equal(status, n_faults == 0 ? BF_OK : BF_ENOMEM);
        assert_int_equal(faults.n, 0);
        if (n_faults == 0)
            break;
    }
    placement_fini(&p);
    scene_fini(&s);
}

static void a_checked_scene_lends_the_places_that_the_check_made(void **state)
{
    bf_faults faults = { 0 };
    scene_placement p;
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    assert_int_equal(placement_of(&s, &p, NULL), BF_OK);
    assert_false(p.is_borrowed); // not checked yet: places of its own
    assert_int_equal(p.n, 192);
    placement_fini(&p);
    scene_check(&s, &faults);
    assert_int_equal(placement_of(&s, &p, NULL), BF_OK);
    assert_ptr_equal(p.poses, s.placement.poses);
    placement_fini(&p);
    assert_int_equal(s.placement.n, 192);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_checked_scene_lends_the_places_that_the_check_made),
        cmocka_unit_test(listed_places_are_taken_as_they_are),
        cmocka_unit_test(example_1_lies_in_16_rows_of_12),
        cmocka_unit_test(cylinders_may_touch_but_not_overlap),
        cmocka_unit_test(boxes_overlap_by_their_sides_and_corners),
        cmocka_unit_test(cargo_must_not_overlap_walls_and_its_centres_lie_in_the_domain),
        cmocka_unit_test(a_turned_box_extends_farther_than_a_straight_one),
        cmocka_unit_test(of_many_bad_places_only_a_few_are_reported),
        cmocka_unit_test(the_search_by_cells_finds_what_a_search_of_all_pairs_finds),
        cmocka_unit_test(random_places_are_free_inside_and_within_the_region),
        cmocka_unit_test(a_seed_gives_the_same_places_every_time_and_another_gives_others),
        cmocka_unit_test(too_many_random_parts_are_refused_and_the_output_untouched),
        cmocka_unit_test(without_memory_nothing_is_placed_or_lost),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
