// Warnings about plates that cargo gets past: of the paper's scene, whose plate of 60 degrees stands at another angle.

#include "core/advice/review_plates.h"

#include "core/base/memory.h"
#include "core/scene/placement.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const review_warnings *warnings_now(const scene *s)
{
    static review_warnings found;

    found = (review_warnings){ 0 };
    assert_int_equal(review_plates(s, &found, NULL), BF_OK);
    return &found;
}

static const review_warnings *warnings_at(double angle_deg)
{
    scene s;

    helper_scene_example(&s, angle_deg, SCENE_SEALED);
    const review_warnings *found = warnings_now(&s);
    scene_fini(&s);
    return found;
}

// Parts downstream of the line through (0.75, 0.5) m at an angle, as far as it is the plate: below its end.
static size_t count_behind(double angle_deg)
{
    scene_placement placed;
    size_t n = 0;
    scene s;

    helper_scene_example(&s, angle_deg, SCENE_SEALED);
    assert_int_equal(placement_make(&s, &placed, NULL), BF_OK);
    for (size_t k = 0; k < placed.n; k++) {
        const double x = 0.75 - (0.5 - placed.poses[k].y) / tan(angle_deg * M_PI / 180.0);
        n += placed.poses[k].y < 0.5 && placed.poses[k].x > x;
    }
    placement_fini(&placed);
    scene_fini(&s);
    return n;
}

static void plates_before_which_all_cargo_lies_are_in_order(void **unused)
{
    assert_int_equal(warnings_at(60.0)->n, 0);
    assert_int_equal(warnings_at(75.0)->n, 0);
    assert_int_equal(warnings_at(90.0)->n, 0);
}

static void assert_cargo_behind(double angle_deg, const char *why)
{
    const review_warnings *found = warnings_at(angle_deg);
    char begin[80];

    assert_int_equal(found->n, 1);
    assert_string_equal(found->items[0].title, "Cargo starts behind a deflector");
    assert_string_equal(found->items[0].pointer, "/obstacles/0");
    snprintf(begin, sizeof begin, "%zu of 192 parts start behind ", count_behind(angle_deg));
    assert_memory_equal(found->items[0].meaning, begin, strlen(begin));
    assert_non_null(strstr(found->items[0].meaning, why));
}

// 0.75 - 0.5/tan(20 degrees) = -0.624; 0.75 - 0.5/tan(40 degrees) = 0.154.
static void cargo_behind_a_plate_is_warned_of_with_the_reason(void **unused)
{
    assert_cargo_behind(20.0, "its foot lies off the belt, at (-0.624, 0) m");
    assert_cargo_behind(40.0, "its foot stands too far upstream, at (0.154, 0) m");
}

// 0.75 - 0.5/tan(120 degrees) = 1.039: beyond the outflow at 1 m, to which it leads its cargo.
static void a_plate_that_leads_off_the_end_of_its_belt_is_warned_of(void **unused)
{
    const review_warnings *found = warnings_at(120.0);
    assert_int_equal(found->n, 1);
    assert_string_equal(found->items[0].title, "A deflector ends off the belt");
    assert_string_equal(found->items[0].pointer, "/obstacles/0");
    assert_non_null(strstr(found->items[0].meaning, "(1.04, 0) m"));
}

// The scene without parts, fed on a line along y = 0.1 to 0.5 m.
static void make_fed(scene *s, double angle_deg, bool is_edge, double x)
{
    helper_scene_example(s, angle_deg, SCENE_SEALED);
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->n_feeds = 1;
    s->feeds = memory_alloc(1, sizeof *s->feeds);
    assert_non_null(s->feeds);
    scene_feed_init(&s->feeds[0]);
    snprintf(s->feeds[0].id, sizeof s->feeds[0].id, "infeed");
    s->feeds[0].is_edge = is_edge;
    s->feeds[0].edge = SCENE_WEST;
    s->feeds[0].line[0] = (vec2){ x, 0.1 };
    s->feeds[0].line[1] = (vec2){ x, 0.5 };
}

// At x = 0 the plate of 20 degrees is at y = 0.5 - 0.75 tan(20 degrees) = 0.227 m: 32 % of the line lie below.
static void a_feed_that_a_plate_cuts_is_warned_of(void **unused)
{
    scene s;

    make_fed(&s, 20.0, true, 0.0);
    const review_warnings *found = warnings_now(&s);
    assert_int_equal(found->n, 1);
    assert_string_equal(found->items[0].title, "Cargo enters behind a deflector");
    assert_non_null(strstr(found->items[0].meaning, "32 % of the line of the feed 'infeed'"));
    scene_fini(&s);
    make_fed(&s, 60.0, true, 0.0);
    assert_int_equal(warnings_now(&s)->n, 0);
    scene_fini(&s);
}

static void a_line_that_delivers_behind_a_plate_does_so_on_purpose(void **unused)
{
    scene s;

    make_fed(&s, 60.0, false, 0.9);
    assert_int_equal(warnings_now(&s)->n, 0);
    scene_fini(&s);
    make_fed(&s, 60.0, false, 0.6); // the plate is at y = 0.24 m there
    assert_int_equal(warnings_now(&s)->n, 1);
    scene_fini(&s);
}

static void a_plate_that_moves_is_not_looked_at(void **unused)
{
    static const double times[] = { 0.0, 1.0 }, angles[] = { 0.0, 1.0 };
    scene s;

    helper_scene_example(&s, 20.0, SCENE_SEALED);
    s.obstacles[0].turn = helper_scene_series(2, times, angles, INFINITY);
    assert_int_equal(warnings_now(&s)->n, 0);
    scene_fini(&s);
}

// A gate that leaves the domain, of 1 m by 0.6 m, by its own length is in order; by ten times as much, it was a slip.
static void a_plate_that_is_shifted_far_off_the_domain_is_warned_of(void **unused)
{
    static const double times[] = { 0.0, 1.0 }, angles[] = { 0.0, 0.0 };
    static const vec2 shifts[][2] = { { { 0.0, 0.0 }, { 0.0, 0.6 } },
                                      { { 0.0, 0.0 }, { 0.0, 6.0 } } };
    scene s;

    for (size_t k = 0; k < 2; k++) {
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        s.obstacles[0].turn = helper_scene_series(2, times, angles, INFINITY);
        s.obstacles[0].shifts = memory_alloc(2, sizeof(vec2));
        s.obstacles[0].n_shifts = 2;
        s.obstacles[0].shifts[1] = shifts[k][1];
        const review_warnings *found = warnings_now(&s);
        assert_int_equal(found->n, k);
        if (k == 1)
            assert_string_equal(found->items[0].pointer, "/obstacles/0/motion/shift_m/1");
        scene_fini(&s);
    }
}

// Parts of the first plate's lee that lie before another piece of the same plate are held by that one.
static void what_a_plate_holds_itself_is_not_behind_it(void **unused)
{
    static const vec2 hook[] = { { 0.05, 0.0 }, { 0.05, 0.5 }, { 0.8, 0.5 }, { 0.8, 0.0 } };
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    helper_scene_add_obstacle(&s, hook, 4, SCENE_SEALED);
    helper_scene_resolve(&s);
    assert_int_equal(warnings_now(&s)->n, 0);
    scene_fini(&s);
}

// A belt that stands carries nothing anywhere, and on one that runs the other way the plate lies ahead.
static void behind_is_what_lies_downstream_on_the_belt(void **unused)
{
    scene s;

    helper_scene_example(&s, 20.0, SCENE_SEALED);
    s.belts[0].velocity = (vec2){ 0.0, 0.0 };
    assert_int_equal(warnings_now(&s)->n, 0);
    s.belts[0].velocity = (vec2){ -0.4, 0.0 };
    const review_warnings *found = warnings_now(&s);
    const size_t n_before = count_behind(20.0);
    char begin[80];
    assert_true(found->n >= 1);
    // All parts lie below the plate's upper end, so that those that were before it are behind it now.
    snprintf(begin, sizeof begin, "%zu of 192 parts start behind ", 192 - n_before);
    assert_memory_equal(found->items[0].meaning, begin, strlen(begin));
    scene_fini(&s);
}

static void no_memory_is_reported(void **unused)
{
    review_warnings found = { 0 };
    scene s;

    helper_scene_example(&s, 20.0, SCENE_SEALED);
    memory_plan_fault(1, 0);
    assert_int_equal(review_plates(&s, &found, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_int_equal(found.n, 0);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plates_before_which_all_cargo_lies_are_in_order),
        cmocka_unit_test(cargo_behind_a_plate_is_warned_of_with_the_reason),
        cmocka_unit_test(a_plate_that_leads_off_the_end_of_its_belt_is_warned_of),
        cmocka_unit_test(a_feed_that_a_plate_cuts_is_warned_of),
        cmocka_unit_test(a_line_that_delivers_behind_a_plate_does_so_on_purpose),
        cmocka_unit_test(a_plate_that_moves_is_not_looked_at),
        cmocka_unit_test(a_plate_that_is_shifted_far_off_the_domain_is_warned_of),
        cmocka_unit_test(what_a_plate_holds_itself_is_not_behind_it),
        cmocka_unit_test(behind_is_what_lies_downstream_on_the_belt),
        cmocka_unit_test(no_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
