// Warnings before a run: rates that belts cannot carry, and actions in a circle.

#include "core/run/run.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// A belt of 1 x 0.6 m at 0.4 m/s, of which the second half may be another belt, and a feed over 0.4 m of its west side.
static void make_scene(scene *s, bool has_second)
{
    const vec2 right[] = { { 0.5, 0 }, { 1, 0 }, { 1, 0.6 }, { 0.5, 0.6 } };

    helper_scene_belt(s, 1.0, 0.6, 0.005, (scene_pose[]){ { 0.5, 0.3, 0.0 } }, 1);
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, NULL, 0);
    if (has_second)
        helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, right, 4);
    s->n_feeds = 1;
    s->feeds = memory_alloc(1, sizeof *s->feeds);
    scene_feed_init(&s->feeds[0]);
    s->feeds[0].is_edge = true;
    s->feeds[0].edge = SCENE_WEST;
    s->feeds[0].line[0].y = 0.1;
    s->feeds[0].line[1].y = 0.5;
    s->feeds[0].demand = SCENE_DEMAND_RATE;
    s->feeds[0].rate = 1.0;
}

static void add_eye(scene *s, double x_from, double x_to)
{
    if (s->eyes == NULL)
        s->eyes = memory_alloc(4, sizeof *s->eyes);
    scene_photo_eye_init(&s->eyes[s->n_eyes]);
    s->eyes[s->n_eyes].line[0] = (vec2){ x_from, 0.1 };
    s->eyes[s->n_eyes++].line[1] = (vec2){ x_to, 0.5 };
}

static void add_action(scene *s, size_t eye, bool when_blocked, size_t belt, double factor)
{
    if (s->actions == NULL)
        s->actions = memory_alloc(8, sizeof *s->actions);
    scene_action *a = &s->actions[s->n_actions++];
    scene_action_init(a);
    a->eye = eye;
    a->when_blocked = when_blocked;
    a->type = SCENE_ACTION_BELT;
    a->target = belt;
    a->value = factor;
}

// The warnings about a scene, which is freed.
static const bf_faults *warnings_of(scene *s)
{
    static run_review review;
    static bf_faults faults;

    helper_scene_resolve(s);
    faults = (bf_faults){ 0 };
    scene_check(s, &faults);
    if (faults.n > 0)
        fail_msg("%s: %s", faults.items[0].pointer, faults.items[0].text);
    assert_int_equal(run_review_of(s, RUN_MICRO, &review, NULL), BF_OK);
    scene_fini(s);
    return &review.warnings;
}

// 2004 parts/m2 at 0.4 m/s over 0.4 m and the width of a part, 1/sqrt(2004) m: 338.55 parts/s.
static void rates_beyond_the_belts_are_warned_of(void **unused)
{
    scene s;

    (void)unused;
    make_scene(&s, false);
    s.feeds[0].rate = 338.5;
    assert_int_equal(warnings_of(&s)->n, 0);
    make_scene(&s, false);
    s.feeds[0].rate = 338.6;
    const bf_faults *warnings = warnings_of(&s);
    assert_int_equal(warnings->n, 1);
    assert_string_equal(warnings->items[0].pointer, "/feeds/0/rate_per_s");
    assert_non_null(
        strstr(warnings->items[0].text, "up to 338.6 parts/s, but belts carry at most 338.5"));
}

static void a_belt_that_its_own_cargo_stops_is_warned_of(void **unused)
{
    scene s;

    (void)unused;
    make_scene(&s, false);
    add_eye(&s, 0.7, 0.7);
    add_action(&s, 0, false, 0, 1.0);
    add_action(&s, 0, true, 0, 0.0);
    const bf_faults *warnings = warnings_of(&s);
    assert_int_equal(warnings->n, 1);
    assert_string_equal(warnings->items[0].pointer, "/actions/1");
    assert_non_null(strstr(warnings->items[0].text, "'eye-1' stops the belt 'main'"));
}

static void a_belt_that_goes_slower_is_not_stopped(void **unused)
{
    scene s;

    (void)unused;
    make_scene(&s, false);
    add_eye(&s, 0.7, 0.7);
    add_action(&s, 0, true, 0, 0.1);
    assert_int_equal(warnings_of(&s)->n, 0);
}

// The eye is above the next belt, which goes on: its cargo leaves.
static void a_belt_that_the_next_one_stops_is_in_order(void **unused)
{
    scene s;

    (void)unused;
    make_scene(&s, true);
    add_eye(&s, 0.7, 0.7);
    add_action(&s, 0, true, 0, 0.0);
    add_action(&s, 0, false, 0, 1.0);
    assert_int_equal(warnings_of(&s)->n, 0);
}

// Cargo stops the belt under it, and an eye above the other belt starts it again.
static void another_belt_may_start_it_again(void **unused)
{
    scene s;

    (void)unused;
    make_scene(&s, true);
    add_eye(&s, 0.3, 0.3);
    add_eye(&s, 0.7, 0.7);
    add_action(&s, 0, true, 0, 0.0);
    add_action(&s, 1, false, 0, 1.0);
    assert_int_equal(warnings_of(&s)->n, 0);
}

// Each of two belts is stopped by its own cargo and started by the eye of the other one.
static void two_belts_may_wait_for_each_other(void **unused)
{
    scene s;

    (void)unused;
    make_scene(&s, true);
    add_eye(&s, 0.3, 0.3);
    add_eye(&s, 0.7, 0.7);
    add_action(&s, 0, true, 0, 0.0);
    add_action(&s, 1, true, 1, 0.0);
    add_action(&s, 1, false, 0, 1.0);
    add_action(&s, 0, false, 1, 1.0);
    const bf_faults *warnings = warnings_of(&s);
    assert_int_equal(warnings->n, 2);
    assert_string_equal(warnings->items[0].pointer, "/actions/0");
    assert_string_equal(warnings->items[1].pointer, "/actions/1");
}

// A beam across both belts clears as long as one of them moves.
static void a_beam_above_a_moving_belt_clears(void **unused)
{
    scene s;

    (void)unused;
    make_scene(&s, true);
    add_eye(&s, 0.4, 0.6);
    add_action(&s, 0, true, 0, 0.0);
    assert_int_equal(warnings_of(&s)->n, 0);
}

static void no_memory_is_reported(void **unused)
{
    bf_status status = BF_ENOMEM;
    run_review review;
    scene s;

    (void)unused;
    make_scene(&s, false);
    helper_scene_resolve(&s);
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = run_review_of(&s, RUN_MACRO, &review, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || status == BF_ENOMEM);
        assert_true(n < 1000);
    }
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_beyond_the_belts_are_warned_of),
        cmocka_unit_test(a_belt_that_its_own_cargo_stops_is_warned_of),
        cmocka_unit_test(a_belt_that_goes_slower_is_not_stopped),
        cmocka_unit_test(a_belt_that_the_next_one_stops_is_in_order),
        cmocka_unit_test(another_belt_may_start_it_again),
        cmocka_unit_test(two_belts_may_wait_for_each_other),
        cmocka_unit_test(a_beam_above_a_moving_belt_clears),
        cmocka_unit_test(no_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
