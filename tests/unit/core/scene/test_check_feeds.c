// The checks of feeds: every fault at its place, and nothing else.

#include "core/scene/scene.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_faults.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Room for a profile or a list of arrivals, freed with the scene.
static double *numbers(size_t n, const double *values)
{
    double *copy = memory_alloc(n, sizeof *copy);

    assert_non_null(copy);
    memcpy(copy, values, n * sizeof *copy);
    return copy;
}

static void set_profile(scene_feed *f, size_t n, const double *times, const double *rates)
{
    f->demand = SCENE_DEMAND_PROFILE;
    f->profile.n_times = f->profile.n_values = n;
    f->profile.times = numbers(n, times);
    f->profile.values = numbers(n, rates);
}

static void set_schedule(scene_feed *f, size_t n, const double *times)
{
    f->demand = SCENE_DEMAND_SCHEDULE;
    f->schedule.n = n;
    f->schedule.times = numbers(n, times);
    f->schedule.counts = memory_alloc(n, sizeof *f->schedule.counts);
    f->schedule.kinds = memory_alloc(n, sizeof *f->schedule.kinds);
    f->schedule.places = memory_alloc(n, sizeof *f->schedule.places);
    f->schedule.headings = memory_alloc(n, sizeof *f->schedule.headings);
    for (size_t k = 0; k < n; k++) {
        f->schedule.counts[k] = 1;
        f->schedule.kinds[k] = 0;
        f->schedule.places[k] = f->schedule.headings[k] = NAN;
    }
}

static const double three[] = { 0.0, 1.0, 2.0 };

// A belt of 1 x 0.6 m along x with a feed over [0.1, 0.3] m of its west side and one on a line inside.
static void make_scene(scene *s)
{
    helper_scene_belt(s, 1.0, 0.6, 0.005, (scene_pose[]){ { 0.5, 0.3, 0.0 } }, 1);
    s->n_feeds = 2;
    s->feeds = memory_alloc(3, sizeof *s->feeds);
    for (size_t k = 0; k < 3; k++) {
        scene_feed_init(&s->feeds[k]);
        s->feeds[k].demand = SCENE_DEMAND_RATE;
        s->feeds[k].rate = 2.0;
    }
    s->feeds[0].is_edge = true;
    s->feeds[0].edge = SCENE_WEST;
    s->feeds[0].line[0].y = 0.1;
    s->feeds[0].line[1].y = 0.3;
    s->feeds[1].line[0] = (vec2){ 0.2, 0.1 };
    s->feeds[1].line[1] = (vec2){ 0.3, 0.5 };
}

static void feeds_in_order_are_accepted(void **unused)
{
    scene s;

    make_scene(&s);
    helper_faults_none(&s);
    make_scene(&s);
    set_profile(&s.feeds[0], 3, three, (double[]){ 0.0, 5.0, 0.0 });
    s.feeds[0].profile.repeat = 2.0;
    set_schedule(&s.feeds[1], 3, (double[]){ 0.0, 1.0, 1.0 });
    s.feeds[1].schedule.places[1] = 1.0;
    helper_faults_none(&s);
}

#define SPOIL(name, code)                                                                          \
    static void name(scene *s)                                                                     \
    {                                                                                              \
        scene_feed *f = &s->feeds[0], *inside = &s->feeds[1];                                      \
        (void)inside;                                                                              \
        (void)f;                                                                                   \
        code;                                                                                      \
    }
SPOIL(bad_id, strcpy(f->id, "a b"))
SPOIL(same_id, strcpy(f->id, "feed-2"))
SPOIL(bad_start, f->start = -1.0)
SPOIL(bad_end, f->start = f->end = 3.0)
SPOIL(endless, f->end = NAN)
SPOIL(half_count, f->count = 2.5)
SPOIL(no_count, f->count = 0.0)
SPOIL(no_rate, f->rate = 0.0)
SPOIL(endless_rate, f->rate = INFINITY)
SPOIL(no_demand, f->demand = SCENE_DEMAND_COUNT)
SPOIL(no_stage, f->shape = 0)
SPOIL(many_stages, f->shape = 1001)
SPOIL(empty_batch, f->batch_size = 0)
SPOIL(bad_heading, f->heading = NAN)
SPOIL(bad_wait, f->max_wait = -0.5)
SPOIL(bad_seed, f->seed = UINT64_C(1) << 53)
SPOIL(bad_substream, s->substream = UINT64_C(1) << 53)
SPOIL(unknown_kind, f->n_cargo = 1; f->cargo[0] = ((scene_feed_kind){ 4, 1.0 }))
SPOIL(kind_twice, f->n_cargo = 2; f->cargo[0] = f->cargo[1] = ((scene_feed_kind){ 0, 1.0 }))
SPOIL(no_share, f->n_cargo = 1; f->cargo[0] = ((scene_feed_kind){ 0, 0.0 }))
SPOIL(falling_profile, set_profile(f, 3, (double[]){ 0, 2, 1 }, three))
SPOIL(standing_profile, set_profile(f, 3, (double[]){ 0, 1, 1 }, three))
SPOIL(negative_profile, set_profile(f, 3, three, (double[]){ 0, -1, 0 }))
SPOIL(uneven_profile, set_profile(f, 3, three, three); f->profile.n_values = 2)
SPOIL(short_repeat, set_profile(f, 3, three, three); f->profile.repeat = 1.5)
SPOIL(empty_profile, f->demand = SCENE_DEMAND_PROFILE)
SPOIL(falling_schedule, set_schedule(f, 3, (double[]){ 0, 2, 1 }))
SPOIL(empty_schedule, f->demand = SCENE_DEMAND_SCHEDULE)
SPOIL(nobody_arrives, set_schedule(f, 3, three); f->schedule.counts[1] = 0)
SPOIL(unknown_arrives, set_schedule(f, 3, three); f->schedule.kinds[2] = 1)
SPOIL(place_beyond, set_schedule(f, 3, three); f->schedule.places[0] = 1.01)
SPOIL(heading_beyond, set_schedule(f, 3, three); f->schedule.headings[0] = INFINITY)
SPOIL(over_a_wall, s->edges[SCENE_WEST] = SCENE_EDGE_WALL)
SPOIL(over_an_outflow, s->edges[SCENE_WEST] = SCENE_EDGE_OUTFLOW)
SPOIL(backwards, f->line[1].y = 0.05)
SPOIL(beyond_the_side, f->line[1].y = 0.7)
SPOIL(without_length, inside->line[1] = inside->line[0])
SPOIL(outside, inside->line[1].x = 1.2)
SPOIL(nowhere, inside->line[0].x = NAN)

static void what_is_wrong_with_a_feed_is_pointed_at(void **unused)
{
    static const helper_faults_case bad[] = {
        { bad_id, "/feeds/0/id", "letters" },
        { same_id, "/feeds/1/id", "/feeds/0" },
        { bad_start, "/feeds/0/start_s", "at least 0" },
        { bad_end, "/feeds/0/end_s", "after start_s" },
        { half_count, "/feeds/0/count", "whole" },
        { no_count, "/feeds/0/count", "at least 1" },
        { no_rate, "/feeds/0/rate_per_s", "above 0" },
        { endless_rate, "/feeds/0/rate_per_s", "" },
        { no_demand, "/feeds/0", "rate_per_s, profile or schedule" },
        { no_stage, "/feeds/0/shape", "at least 1" },
        { many_stages, "/feeds/0/shape", "limit is 1000" },
        { empty_batch, "/feeds/0/batch_size", "at least 1" },
        { bad_heading, "/feeds/0/heading_deg", "" },
        { bad_wait, "/feeds/0/max_wait_s", "" },
        { bad_seed, "/feeds/0/seed", "2^53" },
        { bad_substream, "/substream", "2^53" },
        { unknown_kind, "/feeds/0/cargo/0/kind", "" },
        { kind_twice, "/feeds/0/cargo/1/kind", "'cargo' is there already" },
        { no_share, "/feeds/0/cargo/0/share", "above 0" },
        { falling_profile, "/feeds/0/profile/t_s/2", "1 s do not come after the 2 s" },
        { standing_profile, "/feeds/0/profile/t_s/2", "" },
        { negative_profile, "/feeds/0/profile/rate_per_s/1", "at least 0" },
        { uneven_profile, "/feeds/0/profile/rate_per_s", "2 items, but t_s has 3" },
        { short_repeat, "/feeds/0/profile/repeat_s", "at least the last time, 2 s" },
        { empty_profile, "/feeds/0/profile", "" },
        { falling_schedule, "/feeds/0/schedule/t_s/2", "before the 2 s" },
        { empty_schedule, "/feeds/0/schedule", "limits are 1 and" },
        { nobody_arrives, "/feeds/0/schedule/count/1", "at least 1" },
        { unknown_arrives, "/feeds/0/schedule/kind/2", "" },
        { place_beyond, "/feeds/0/schedule/place/0", "from 0 to 1" },
        { heading_beyond, "/feeds/0/schedule/heading_deg/0", "" },
        { over_a_wall, "/feeds/0/edge", "west is a wall" },
        { over_an_outflow, "/feeds/0/edge", "west is an outflow" },
        { backwards, "/feeds/0/y_m", "from < to" },
        { beyond_the_side, "/feeds/0/y_m", "0 to 0.6 m" },
        { without_length, "/feeds/1/line_m/1", "repeats" },
        { outside, "/feeds/1/line_m", "in the domain" },
        { nowhere, "/feeds/1/line_m/0", "" },
    };

    helper_faults_each(make_scene, bad, sizeof bad / sizeof *bad);
}

static void a_feed_without_an_end_that_is_a_number_is_refused(void **unused)
{
    scene s;

    make_scene(&s);
    endless(&s);
    const bf_faults *faults = helper_faults_of(&s);
    assert_string_equal(faults->items[0].pointer, "/feeds/0/end_s");
}

// The belt of the second scene ends at y = 0.25 m, that of the third moves outward.
static void belts_must_carry_parts_away(void **unused)
{
    const vec2 narrow[] = { { 0, 0 }, { 1, 0 }, { 1, 0.25 }, { 0, 0.25 } };
    const vec2 left[] = { { 0, 0 }, { 0.1, 0 }, { 0.1, 0.6 }, { 0, 0.6 } };
    scene s;

    make_scene(&s);
    s.n_feeds = 1;
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, narrow, 4);
    helper_faults_one(&s, "/feeds/0/y_m", "off every belt at (0, 0.252) m");
    make_scene(&s);
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, NULL, 0);
    helper_scene_add_belt(&s, (vec2){ -0.4, 0.1 }, left, 4);
    helper_faults_one(&s, "/feeds/0/y_m", "'belt-2' does not move inward at (0, 0.1) m");
}

// A plate that stands across a line is a fault, as it stands at t = 0.
static void lines_keep_clear_of_plates(void **unused)
{
    const vec2 across[] = { { 0.22, 0.3 }, { 0.35, 0.3 } };
    scene_obstacle *o;
    scene s;

    make_scene(&s);
    helper_scene_add_obstacle(&s, across, 2, SCENE_SEALED);
    helper_faults_one(&s, "/feeds/1/line_m", "plate of obstacle 'obstacle-1'");

    make_scene(&s);
    o = helper_scene_add_obstacle(&s, across, 2, SCENE_SEALED);
    o->presence.n_times = o->presence.n_values = 1;
    o->presence.times = numbers(1, (double[]){ 0.0 });
    o->presence.values = numbers(1, (double[]){ 0.0 });
    helper_faults_none(&s);

    // Turned by -90 degrees about its end at (0.35, 0.3) the plate runs from (0.35, 0.43) to the pivot.
    make_scene(&s);
    o = helper_scene_add_obstacle(&s, across, 2, SCENE_SEALED);
    o->pivot = across[1];
    o->turn.n_times = o->turn.n_values = 1;
    o->turn.times = numbers(1, (double[]){ 0.0 });
    o->turn.values = numbers(1, (double[]){ -M_PI / 2.0 });
    helper_faults_none(&s);
}

// From -90 degrees, where it is clear, the plate turns to where it stands across the line; to -80 degrees it does not come near.
static void lines_keep_clear_of_plates_that_turn(void **unused)
{
    static const double angles[] = { 0.0, -M_PI * 80.0 / 180.0 };
    const vec2 across[] = { { 0.22, 0.3 }, { 0.35, 0.3 } };

    for (int k = 0; k < 4; k++) {
        scene s;
        make_scene(&s);
        scene_obstacle *o = helper_scene_add_obstacle(&s, across, 2, SCENE_SEALED);
        o->pivot = across[1];
        const double last = angles[k / 2];
        o->turn.n_times = o->turn.n_values = k % 2 == 0 ? 2 : 1;
        o->turn.times = numbers(o->turn.n_times, (double[]){ 0.0, 5.0 });
        o->turn.values = numbers(o->turn.n_values, (double[]){ -M_PI / 2.0, last });
        if (k % 2 != 0) {
            s.n_eyes = s.n_actions = 1;
            s.eyes = memory_alloc(1, sizeof *s.eyes);
            scene_photo_eye_init(s.eyes);
            s.eyes[0].line[0] = (vec2){ 0.5, 0.2 };
            s.eyes[0].line[1] = (vec2){ 0.5, 0.4 };
            s.actions = memory_alloc(1, sizeof *s.actions);
            scene_action_init(s.actions);
            s.actions[0].eye = s.actions[0].target = 0;
            s.actions[0].type = SCENE_ACTION_TURN;
            s.actions[0].value = last;
        }
        if (last == 0.0)
            helper_faults_one(&s, "/feeds/1/line_m",
                              "plate of obstacle 'obstacle-1' moves onto it");
        else
            helper_faults_none(&s);
    }
}

// The line is at x = 0.25 m where the plate begins at 0.5 m and is shifted onto it, towards it, or past its end.
static void lines_keep_clear_of_plates_that_are_shifted(void **unused)
{
    static const vec2 ends[] = { { -0.24, 0.0 }, { -0.1, 0.0 }, { -0.2, 0.5 } };
    const vec2 path[] = { { 0.5, 0.25 }, { 0.5, 0.35 } };

    for (int k = 0; k < 3; k++) {
        scene s;
        make_scene(&s);
        scene_obstacle *o = helper_scene_add_obstacle(&s, path, 2, SCENE_SEALED);
        o->turn.n_times = o->turn.n_values = 2;
        o->turn.times = numbers(2, (double[]){ 0.0, 5.0 });
        o->turn.values = numbers(2, (double[]){ 0.0, 0.0 });
        o->shifts = memory_alloc(2, sizeof *o->shifts);
        o->n_shifts = 2;
        o->shifts[1] = ends[k];
        if (k == 0)
            helper_faults_one(&s, "/feeds/1/line_m",
                              "plate of obstacle 'obstacle-1' moves onto it");
        else
            helper_faults_none(&s);
    }
}

// Over a side, a plate that begins less than a radius, 12 mm, behind the line stands across it as well. Plates at the
// ends of the line, which reach over it by less than a radius, guide what enters.
static void inlets_keep_clear_of_plates(void **unused)
{
    scene s;

    for (int k = 0; k < 4; k++) {
        const double y = k < 2    ? 0.2
                         : k == 2 ? 0.1
                                  : 0.305,
                     x = k == 1   ? 0.013
                         : k == 0 ? 0.011
                                  : 0.0;
        const vec2 guide[] = { { x, y }, { 0.15, y } };
        make_scene(&s);
        s.n_feeds = 1;
        s.feeds[0].line[0].y = 0.1;
        s.feeds[0].line[1].y = 0.3;
        helper_scene_add_obstacle(&s, guide, 2, SCENE_SEALED);
        if (k == 0)
            helper_faults_one(&s, "/feeds/0/y_m", "plate of obstacle 'obstacle-1'");
        else
            helper_faults_none(&s);
    }
}

// A plate along a line leaves a part of 12 mm its place if it is 12 mm away.
static void every_kind_has_room_beside_plates(void **unused)
{
    const double away[] = { 0.0121, 0.0119 };
    scene s;

    for (int k = 0; k < 2; k++) {
        const vec2 along[] = { { 0.3 + away[k], 0.1 }, { 0.3 + away[k], 0.5 } };
        make_scene(&s);
        s.n_feeds = 2;
        s.feeds[1].line[0] = (vec2){ 0.3, 0.2 };
        s.feeds[1].line[1] = (vec2){ 0.3, 0.4 };
        helper_scene_add_obstacle(&s, along, 2, SCENE_SEALED);
        if (k == 0)
            helper_faults_none(&s);
        else
            helper_faults_one(&s, "/feeds/1/line_m", "no room between walls and plates");
    }
}

// Parts with a radius of 12 mm between walls at y = 0 and 0.6 m.
static void every_kind_has_room_between_the_walls(void **unused)
{
    scene s;

    make_scene(&s);
    s.n_feeds = 1;
    s.feeds[0].line[0].y = 0.0;
    s.feeds[0].line[1].y = 0.0121;
    helper_faults_none(&s);
    make_scene(&s);
    s.n_feeds = 1;
    s.feeds[0].line[0].y = 0.0;
    s.feeds[0].line[1].y = 0.0119;
    helper_faults_one(&s, "/feeds/0/y_m", "no room between walls and plates for a part of 'cargo'");
    make_scene(&s); // along the wall
    s.n_feeds = 2;
    s.feeds[1].line[0] = (vec2){ 0.2, 0.011 };
    s.feeds[1].line[1] = (vec2){ 0.4, 0.011 };
    helper_faults_one(&s, "/feeds/1/line_m", "no room");
}

// A box of 40 x 10 mm fits across a range of 11 mm at a wall, but not turned anyhow.
static void room_depends_on_the_heading(void **unused)
{
    for (int is_random = 0; is_random < 2; is_random++) {
        scene s;
        make_scene(&s);
        s.n_feeds = 1;
        s.feeds[0].line[0].y = 0.0;
        s.feeds[0].line[1].y = 0.011;
        s.feeds[0].has_random_heading = is_random == 1;
        s.cargo[0].shape.type = SCENE_BOX;
        s.cargo[0].shape.length = 0.04;
        s.cargo[0].shape.width = 0.01;
        if (is_random == 1)
            helper_faults_one(&s, "/feeds/0/y_m", "no room");
        else
            helper_faults_none(&s);
    }
}

static void feeds_do_not_overlap(void **unused)
{
    scene s;

    make_scene(&s);
    s.feeds[1] = s.feeds[0];
    s.feeds[1].line[0].y = 0.3;
    s.feeds[1].line[1].y = 0.5;
    helper_faults_none(&s);
    make_scene(&s);
    s.feeds[1] = s.feeds[0];
    s.feeds[1].line[0].y = 0.29;
    s.feeds[1].line[1].y = 0.5;
    helper_faults_one(&s, "/feeds/1/y_m", "overlaps the feed 'feed-1'");
    make_scene(&s);
    s.n_feeds = 3;
    s.feeds[2].line[0] = (vec2){ 0.2, 0.3 };
    s.feeds[2].line[1] = (vec2){ 0.3, 0.3 };
    helper_faults_one(&s, "/feeds/2/line_m", "overlaps the feed 'feed-2'");
    make_scene(&s); // a line that begins on the side, where the other feed is
    s.feeds[1].line[0] = (vec2){ 0.0, 0.2 };
    helper_faults_one(&s, "/feeds/1/line_m", "overlaps the feed 'feed-1'");
}

static void too_many_feeds_are_a_limit(void **unused)
{
    scene s;

    make_scene(&s);
    helper_scene_resolve(&s);
    s.n_feeds = SCENE_FEEDS_MAX + 1;
    static bf_faults faults;
    faults = (bf_faults){ 0 };
    scene_check(&s, &faults);
    assert_true(faults.n > 0 && faults.items[0].code == BF_ELIMIT);
    assert_string_equal(faults.items[0].pointer, "/feeds");
    s.n_feeds = 2;
    scene_fini(&s);
}

static void the_check_reports_that_memory_is_exhausted(void **unused)
{
    const vec2 path[] = { { 0.6, 0.3 }, { 0.8, 0.3 } };
    static bf_faults faults;
    scene s;

    make_scene(&s);
    scene_obstacle *o = helper_scene_add_obstacle(&s, path, 2, SCENE_SEALED);
    o->presence.n_times = o->presence.n_values = 1;
    o->presence.times = numbers(1, (double[]){ 1.0 });
    o->presence.values = numbers(1, (double[]){ 0.0 });
    helper_scene_resolve(&s);
    for (size_t n = 1;; n++) {
        faults = (bf_faults){ 0 };
        memory_plan_fault(n, 0);
        scene_check(&s, &faults);
        const size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        if (n_faults == 0)
            break;
        assert_int_equal(faults_status(&faults, NULL), BF_ENOMEM);
    }
    assert_int_equal(faults.n, 0);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(feeds_in_order_are_accepted),
        cmocka_unit_test(what_is_wrong_with_a_feed_is_pointed_at),
        cmocka_unit_test(a_feed_without_an_end_that_is_a_number_is_refused),
        cmocka_unit_test(belts_must_carry_parts_away),
        cmocka_unit_test(lines_keep_clear_of_plates),
        cmocka_unit_test(lines_keep_clear_of_plates_that_turn),
        cmocka_unit_test(lines_keep_clear_of_plates_that_are_shifted),
        cmocka_unit_test(inlets_keep_clear_of_plates),
        cmocka_unit_test(every_kind_has_room_beside_plates),
        cmocka_unit_test(every_kind_has_room_between_the_walls),
        cmocka_unit_test(room_depends_on_the_heading),
        cmocka_unit_test(feeds_do_not_overlap),
        cmocka_unit_test(too_many_feeds_are_a_limit),
        cmocka_unit_test(the_check_reports_that_memory_is_exhausted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
