// The checks of what moves, of photo eyes, actions, windows and the end of a run: every fault at its place.

#include "core/scene/scene.h"

#include "core/base/memory.h"
#include "core/scene/placement.h"
#include "tests/unit/core/helper_faults.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void set_series(scene_series *series, size_t n, const double *times, const double *values)
{
    series->n_times = series->n_values = n;
    series->times = memory_alloc(n, sizeof *times);
    series->values = memory_alloc(n, sizeof *values);
    memcpy(series->times, times, n * sizeof *times);
    memcpy(series->values, values, n * sizeof *values);
}

// A belt of 1 x 0.6 m with a plate, a feed, a photo eye behind the plate, two windows, and an action of each kind.
static void make_scene(scene *s)
{
    const vec2 path[] = { { 0.5, 0.1 }, { 0.6, 0.3 } };

    helper_scene_belt(s, 1.0, 0.6, 0.005, (scene_pose[]){ { 0.2, 0.3, 0.0 } }, 1);
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, NULL, 0);
    helper_scene_add_obstacle(s, path, 2, SCENE_SEALED);
    s->duration = 10.0;
    s->n_feeds = 1;
    s->feeds = memory_alloc(1, sizeof *s->feeds);
    scene_feed_init(&s->feeds[0]);
    s->feeds[0].is_edge = true;
    s->feeds[0].edge = SCENE_WEST;
    s->feeds[0].demand = SCENE_DEMAND_RATE;
    s->feeds[0].rate = 1.0;
    s->n_eyes = 2;
    s->eyes = memory_alloc(2, sizeof *s->eyes);
    for (int k = 0; k < 2; k++) {
        scene_photo_eye_init(&s->eyes[k]);
        s->eyes[k].line[0] = (vec2){ 0.7, -0.1 };
        s->eyes[k].line[1] = (vec2){ 0.7, 0.7 };
    }
    s->n_actions = SCENE_ACTION_COUNT;
    s->actions = memory_alloc(s->n_actions, sizeof *s->actions);
    for (size_t k = 0; k < s->n_actions; k++) {
        scene_action_init(&s->actions[k]);
        s->actions[k].eye = 0;
        s->actions[k].type = (scene_action_type)k;
        s->actions[k].target = 0;
        s->actions[k].value = 1.0;
    }
    s->output.n_windows = 2;
    s->output.windows = memory_alloc(2, sizeof *s->output.windows);
    for (int k = 0; k < 2; k++) {
        scene_output_window_init(&s->output.windows[k]);
        s->output.windows[k].from = k;
        s->output.windows[k].to = k + 1.0;
    }
}

static void equipment_in_order_is_accepted(void **unused)
{
    scene s;

    make_scene(&s);
    set_series(&s.obstacles[0].turn, 2, (double[]){ 0.0, 2.0 }, (double[]){ 0.0, -9.0 });
    set_series(&s.obstacles[0].presence, 2, (double[]){ 0.0, 2.0 }, (double[]){ 0.0, 1.0 });
    s.obstacles[0].turn.repeat = 2.5;
    s.until = SCENE_UNTIL_STEADY;
    s.warmup = 9.5;
    helper_faults_none(&s);
}

#define SPOIL(name, code)                                                                          \
    static void name(scene *s)                                                                     \
    {                                                                                              \
        scene_obstacle *o = &s->obstacles[0];                                                      \
        scene_photo_eye *eye = &s->eyes[0];                                                        \
        scene_action *of_belt = &s->actions[SCENE_ACTION_BELT];                                    \
        scene_action *turn = &s->actions[SCENE_ACTION_TURN];                                       \
        scene_output_window *window = s->output.windows;                                           \
        (void)o, (void)eye, (void)of_belt, (void)turn, (void)window;                               \
        code;                                                                                      \
    }
static const double two[] = { 0.0, 1.0 };
SPOIL(bad_pivot, o->pivot = ((vec2){ 0.0, INFINITY }))
SPOIL(falling_turn, set_series(&o->turn, 2, (double[]){ 1, 0 }, two))
SPOIL(endless_turn, set_series(&o->turn, 2, two, (double[]){ 0, INFINITY }))
SPOIL(short_turn, set_series(&o->turn, 2, two, two); o->turn.repeat = 0.5)
SPOIL(jumping_turn, set_series(&o->turn, 2, two, two); o->turn.repeat = 1.0)
static void set_shifts(scene_obstacle *o, size_t n, double x)
{
    set_series(&o->turn, 2, two, two);
    o->shifts = memory_alloc(n, sizeof *o->shifts);
    o->n_shifts = n;
    for (size_t k = 1; k < n; k++)
        o->shifts[k].x = x;
}
SPOIL(uneven_shifts, set_shifts(o, 3, 1.0))
SPOIL(endless_shift, set_shifts(o, 2, INFINITY))
SPOIL(jumping_shift, set_shifts(o, 2, 1.0); o->turn.values[1] = 0.0; o->turn.repeat = 1.0)
SPOIL(bad_shift_command, s->actions[SCENE_ACTION_SHIFT].shift.y = NAN)
SPOIL(uneven_turn, set_series(&o->turn, 2, two, two); o->turn.n_values = 1)
SPOIL(negative_time, set_series(&o->presence, 2, (double[]){ -1, 0 }, two))
SPOIL(half_there, set_series(&o->presence, 2, two, (double[]){ 0, 2 }))
SPOIL(endless_round, set_series(&o->turn, 2, two, two); o->turn.repeat = NAN)
SPOIL(bad_eye_id, strcpy(eye->id, "/"))
SPOIL(short_beam, eye->line[1] = eye->line[0])
SPOIL(beam_outside, eye->line[0].x = eye->line[1].x = 1.5)
SPOIL(bad_beam, eye->line[0].x = NAN)
SPOIL(bad_block, eye->block_time = -1.0)
SPOIL(bad_clear, eye->clear_time = INFINITY)
SPOIL(bad_ratio, eye->density_ratio = 1.5)
SPOIL(no_eye, of_belt->eye = 2)
SPOIL(no_kind, of_belt->kind = 1)
SPOIL(kind_of_density, (of_belt->kind = 0, s->eyes[0].density_ratio = 0.5))
SPOIL(no_target, of_belt->target = 1)
SPOIL(no_obstacle, turn->target = 1)
SPOIL(no_feed, s->actions[SCENE_ACTION_FEED].target = 1)
SPOIL(bad_delay, of_belt->delay = -1.0)
SPOIL(bad_factor, of_belt->value = -2e9)
SPOIL(too_fast_backwards, of_belt->value = -1e4)
SPOIL(too_fast, of_belt->value = 1e4)
SPOIL(bad_turn, turn->value = INFINITY)
SPOIL(sudden, turn->over = 0.0)
SPOIL(no_action, of_belt->type = SCENE_ACTION_COUNT)
SPOIL(backwards, window[1].from = 3.0; window[1].to = 2.5)
SPOIL(overlapping, window[1].from = 0.9)
SPOIL(bad_period, window[0].curve_every = 0.0)
SPOIL(bad_snapshots, window[1].snapshot_every = -1.0)
SPOIL(long_warmup, s->warmup = 10.0)
SPOIL(bad_jam, s->jam_time = 0.0)
SPOIL(bad_end, s->until = SCENE_UNTIL_COUNT)
SPOIL(bad_precision, s->steady_precision = 1.5)
SPOIL(bad_cargo, strcpy(s->cargo[0].id, "a b"))

// The plate, the eyes and the feed lie on straight belts on either side.
static void make_curve(scene *s)
{
    const vec2 before[] = { { -1.0, -0.6 }, { 0.0, -0.6 }, { 0.0, -0.2 }, { -1.0, -0.2 } };

    helper_scene_belt(s, 1.0, 0.6, 0.005, (scene_pose[]){ { -0.5, -0.4, 0.0 } }, 1);
    s->domain = (scene_rect){ -1.0, 1.0, -1.0, 1.0 };
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, before, 4);
    helper_scene_add_arc(s, 0.4, 0.2, 0.6, -90.0, 0.0);
}

#define SPOIL_ARC(name, code)                                                                      \
    static void name(scene *s)                                                                     \
    {                                                                                              \
        scene_belt *belt = &s->belts[1];                                                           \
        scene_arc *arc = &belt->arc;                                                               \
        (void)belt, (void)arc;                                                                     \
        code;                                                                                      \
    }
SPOIL_ARC(no_inner_radius, arc->inner_radius = 0.0)
SPOIL_ARC(negative_radius, arc->inner_radius = -0.1)
SPOIL_ARC(inverted, arc->outer_radius = 0.2)
SPOIL_ARC(far_centre, belt->centre.x = INFINITY)
SPOIL_ARC(no_angle, arc->to = arc->from)
SPOIL_ARC(more_than_a_turn, arc->to = arc->from - 2.1 * M_PI)
SPOIL_ARC(reference_outside, arc->reference_radius = 0.61)
SPOIL_ARC(rising, belt->incline = 0.1)
SPOIL_ARC(fast_outside, belt->velocity.x = 0.9 * SCENE_SPEED_MAX)
SPOIL_ARC(over_the_belt, arc->from = -0.6 * M_PI)
SPOIL_ARC(over_the_domain, helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, NULL, 0))

static void beside_it(scene *s)
{
    const vec2 beside[] = { { 0.0, -1.0 }, { 0.4, -1.0 }, { 0.4, -0.6 }, { 0.0, -0.6 } };

    helper_scene_add_belt(s, (vec2){ 0.0, 0.4 }, beside, 4);
}

static void fed_on_an_arc(scene *s)
{
    scene_feed *feed = helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 1.0);

    feed->is_edge = false;
    feed->line[0] = (vec2){ 0.3, -0.2 };
    feed->line[1] = (vec2){ 0.4, -0.2 };
}

static void what_is_wrong_with_an_arc_is_pointed_at(void **unused)
{
    static const helper_faults_case bad[] = {
        { no_inner_radius, "/belts/1/arc/inner_radius_m", "must be above 0" },
        { negative_radius, "/belts/1/arc/inner_radius_m", "must be above 0" },
        { inverted, "/belts/1/arc/outer_radius_m", "greater than inner_radius_m" },
        { far_centre, "/belts/1/arc/centre_m", "within" },
        { no_angle, "/belts/1/arc/to_deg", "at least 1 degree" },
        { more_than_a_turn, "/belts/1/arc/to_deg", "more than a whole turn" },
        { reference_outside, "/belts/1/arc/reference_radius_m", "between" },
        { rising, "/belts/1/incline_deg", "curves are level" },
        { fast_outside, "/belts/1/velocity_m_s", "at most" },
        { over_the_belt, "/belts/1/arc", "the belt 'main' overlaps it" },
        { over_the_domain, "/belts/1/arc", "the belt 'belt-3' overlaps it" },
        { beside_it, "/belts/1/arc", "the belt 'belt-3' overlaps it" },
        { fed_on_an_arc, "/feeds/0/line_m", "must enter on a straight belt" },
    };
    scene s;

    make_curve(&s);
    helper_faults_none(&s);
    helper_faults_each(make_curve, bad, sizeof bad / sizeof *bad);
}

static void what_is_wrong_is_pointed_at(void **unused)
{
    static const helper_faults_case bad[] = {
        { bad_pivot, "/obstacles/0/motion/pivot_m", "within" },
        { falling_turn, "/obstacles/0/motion/t_s/1", "0 s do not come after the 1 s" },
        { endless_turn, "/obstacles/0/motion/turn_deg/1", "" },
        { short_turn, "/obstacles/0/motion/repeat_s", "at least the last time, 1 s, not 0.5 s" },
        { jumping_turn, "/obstacles/0/motion/repeat_s", "no time to move" },
        { uneven_shifts, "/obstacles/0/motion/shift_m", "3 items, but t_s has 2" },
        { endless_shift, "/obstacles/0/motion/shift_m/1", "within" },
        { jumping_shift, "/obstacles/0/motion/repeat_s", "no time to move" },
        { bad_shift_command, "/actions/4/do/shift_m", "within" },
        { uneven_turn, "/obstacles/0/motion/turn_deg", "1 items, but t_s has 2" },
        { endless_round, "/obstacles/0/motion/repeat_s", "" },
        { negative_time, "/obstacles/0/present/t_s/0", "at least 0" },
        { half_there, "/obstacles/0/present/value/1", "" },
        { bad_eye_id, "/photo_eyes/0/id", "letters" },
        { short_beam, "/photo_eyes/0/line_m/1", "repeats" },
        { beam_outside, "/photo_eyes/0/line_m", "outside of the domain" },
        { bad_beam, "/photo_eyes/0/line_m/0", "" },
        { bad_block, "/photo_eyes/0/block_time_s", "" },
        { bad_clear, "/photo_eyes/0/clear_time_s", "" },
        { bad_ratio, "/photo_eyes/0/density_ratio", "" },
        { no_eye, "/actions/0/when/photo_eye", "" },
        { no_kind, "/actions/0/when/kind", "a kind of cargo" },
        { kind_of_density, "/actions/0/when/kind", "sees no parts" },
        { no_target, "/actions/0/do/belt", "" },
        { no_obstacle, "/actions/1/do/obstacle", "" },
        { no_feed, "/actions/3/do/feed", "" },
        { bad_delay, "/actions/0/delay_s", "" },
        { bad_factor, "/actions/0/do/factor", "at least -1e+09" },
        { too_fast_backwards, "/actions/0/do/factor", "4000 m/s, the limit is 1000" },
        { too_fast, "/actions/0/do/factor", "4000 m/s, the limit is 1000" },
        { bad_turn, "/actions/1/do/turn_deg", "" },
        { sudden, "/actions/1/do/over_s", "above 0" },
        { no_action, "/actions/0/do", "" },
        { backwards, "/output/windows/1/t_s", "from < to" },
        { overlapping, "/output/windows/1/t_s", "before the end of the window before it at 1 s" },
        { bad_period, "/output/windows/0/curve_every_s", "" },
        { bad_snapshots, "/output/windows/1/snapshot_every_s", "" },
        { long_warmup, "/warmup_s", "shorter than duration_s, 10 s" },
        { bad_jam, "/jam_time_s", "" },
        { bad_end, "/until", "" },
        { bad_precision, "/steady_precision", "" },
        { bad_cargo, "/cargo/id", "letters" },
    };

    helper_faults_each(make_scene, bad, sizeof bad / sizeof *bad);
}

static void nothing_becomes_steady_without_a_feed(void **unused)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.until = SCENE_UNTIL_STEADY;
    assert_string_equal(helper_faults_of(&s)->items[0].pointer, "/until");
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.until = SCENE_UNTIL_DRAINED;
    assert_int_equal(helper_faults_of(&s)->n, 0);
}

static void a_belt_has_a_friction_above_0_of_its_own_or_that_of_contacts(void **unused)
{
    static const struct {
        double friction, contact;
        size_t n;
    } cases[] = {
        { 0.0, 1.0, 0 }, { 0.3, 1.0, 0 }, { -0.3, 1.0, 1 }, { 2e6, 1.0, 1 }, { 0.3, 0.0, 1 }
    };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scene s;
        make_scene(&s);
        s.belts[0].friction = cases[k].friction;
        s.micro.contact[SCENE_CONVEYOR_CARGO].friction = cases[k].contact;
        const bf_faults *faults = helper_faults_of(&s);
        assert_int_equal(faults->n, cases[k].n);
        if (cases[k].n > 0)
            assert_string_equal(faults->items[0].pointer, "/belts/0/friction");
    }
}

static void a_belt_rises_by_45_degrees_at_most_in_the_direction_that_it_has(void **unused)
{
    static const struct {
        double incline, speed;
        const char *text;
    } cases[] = { { 0.25 * M_PI, 0.4, NULL }, { -0.25 * M_PI, 0.4, NULL },
                  { 0.79, 0.4, "between" },   { -0.79, 0.4, "between" },
                  { NAN, 0.4, "between" },    { 0.1, 0.0, "velocity_m_s" } };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scene s;
        make_scene(&s);
        s.belts[0].incline = cases[k].incline;
        s.belts[0].velocity = (vec2){ cases[k].speed, 0.0 };
        const bf_faults *faults = helper_faults_of(&s);
        assert_int_equal(faults->n, cases[k].text == NULL ? 0 : 1);
        if (cases[k].text == NULL)
            continue;
        assert_string_equal(faults->items[0].pointer, "/belts/0/incline_deg");
        assert_non_null(strstr(faults->items[0].text, cases[k].text));
    }
}

static void kinds_have_ids_of_their_own(void **unused)
{
    scene s;

    make_scene(&s);
    s.n_cargo = 2;
    scene_cargo_init(&s.cargo[1]);
    strcpy(s.cargo[1].id, "cargo");
    const bf_faults *faults = helper_faults_of(&s);
    assert_int_equal(faults->n, 1);
    assert_string_equal(faults->items[0].pointer, "/cargo/1/id");
}

// A part at (0.55, 0.1) m is clear of the plate from (0.5, 0.1) to (0.6, 0.3) m, and under it when that is turned by
// -63.4 degrees about its start, along y = 0.1 m; not where it comes later.
static void parts_keep_clear_of_plates_as_they_stand_at_the_start(void **unused)
{
    static const struct {
        double turn, presence;
        size_t n;
    } cases[] = { { 0.0, 1.0, 0 }, { -1.1071487, 1.0, 1 }, { -1.1071487, 0.0, 0 } };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        static bf_faults faults;
        scene s;
        make_scene(&s);
        s.initial.poses[0] = (scene_pose){ 0.57, 0.1, 0.0 };
        set_series(&s.obstacles[0].turn, 1, (double[]){ 0.0 }, &cases[k].turn);
        set_series(&s.obstacles[0].presence, 1, (double[]){ 0.0 }, &cases[k].presence);
        helper_scene_resolve(&s);
        faults = (bf_faults){ 0 };
        scene_check(&s, &faults);
        assert_int_equal(faults.n, 0);
        assert_int_equal(placement_check_plates(&s, &s.placement, &faults), BF_OK);
        assert_int_equal(faults.n, cases[k].n);
        scene_fini(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equipment_in_order_is_accepted),
        cmocka_unit_test(what_is_wrong_is_pointed_at),
        cmocka_unit_test(what_is_wrong_with_an_arc_is_pointed_at),
        cmocka_unit_test(nothing_becomes_steady_without_a_feed),
        cmocka_unit_test(a_belt_has_a_friction_above_0_of_its_own_or_that_of_contacts),
        cmocka_unit_test(a_belt_rises_by_45_degrees_at_most_in_the_direction_that_it_has),
        cmocka_unit_test(kinds_have_ids_of_their_own),
        cmocka_unit_test(parts_keep_clear_of_plates_as_they_stand_at_the_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
