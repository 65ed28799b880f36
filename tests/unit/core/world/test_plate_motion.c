// Unit tests of obstacles that turn, are shifted, come and go: schedules, repeats, commands, their largest speed, and states.

#include "core/world/plate_motion.h"

#include "core/base/memory.h"
#include "core/scene/plate_range.h"
#include "core/scene/scene.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static vec2 path[] = { { 1.0, 2.0 }, { 4.0, 6.0 } };

// 5 m long from its pivot, 0.5 m thick.
static scene_obstacle gate(void)
{
    scene_obstacle o;

    scene_obstacle_init(&o);
    o.n_points = 2;
    o.path = path;
    o.thickness = 0.5;
    o.pivot = path[0];
    return o;
}

static scene_series series(size_t n, double *times, double *values, double repeat)
{
    return (scene_series){ n, times, n, values, repeat };
}

static plate_motion motion_of(const scene_obstacle *o)
{
    plate_motion motion;

    assert_int_equal(plate_motion_init(&motion, 1, o, NULL), BF_OK);
    return motion;
}

static void assert_angles(const plate_motion *motion, size_t n, const double (*expected)[2])
{
    for (size_t k = 0; k < n; k++)
        assert_near(plate_motion_at(motion, 0, expected[k][0]).angle, expected[k][1], 1e-14);
}

#define ASSERT_ANGLES(motion, ...)                                                                 \
    assert_angles(motion, sizeof((const double[][2]){ __VA_ARGS__ }) / sizeof(double[2]),          \
                  (const double[][2]){ __VA_ARGS__ })

static void an_obstacle_without_motion_stands_as_in_the_document(void **state)
{
    scene_obstacle o = gate();
    plate_motion motion = motion_of(&o);
    const plate_pose pose = plate_pose_of(&o, (plate_displacement){ .angle = 0.0 });

    assert_false(motion.is_any);
    ASSERT_ANGLES(&motion, { 0.0, 0.0 }, { 1e6, 0.0 });
    assert_true(plate_motion_in_step(&motion, 0, 3, 1.0, 0.0).spin == 0.0);
    assert_true(plate_motion_is_present(&motion, 0, 7.0));
    assert_true(plate_pose_move(&pose, path[1]).x == 4.0);
    assert_true(plate_pose_move(&pose, path[1]).y == 6.0);
    assert_true(plate_range_largest_speed(&o, 0, 0, NULL) == 0.0);
    plate_motion_fini(&motion);
}

static void angles_are_linear_between_times_and_constant_outside(void **state)
{
    double times[] = { 1.0, 2.0, 4.0 }, angles[] = { 0.25, 0.5, -0.5 };
    scene_obstacle o = gate();
    o.turn = series(3, times, angles, INFINITY);
    plate_motion motion = motion_of(&o);

    assert_true(motion.is_any);
    ASSERT_ANGLES(&motion, { 0.0, 0.25 }, { 1.0, 0.25 }, { 1.5, 0.375 }, { 2.0, 0.5 },
                  { 2.5, 0.25 }, { 3.0, 0.0 }, { 4.0, -0.5 }, { 1e6, -0.5 });
    // Over [1.25, 2.5] it turns by 3/16 and back by 4/16.
    assert_near(plate_motion_in_step(&motion, 0, 1, 1.25, 0.0).spin, -0.05, 1e-15);
    assert_true(plate_motion_in_step(&motion, 0, 5, 1.0, 0.0).spin == 0.0);
    // 0.5 rad/s at most, 5 m and its thickness from the pivot.
    assert_near(plate_range_largest_speed(&o, 0, 0, NULL), 0.5 * 5.5, 1e-14);
    plate_motion_fini(&motion);
}

static void repeats_join_the_last_angle_to_the_first(void **state)
{
    double times[] = { 1.0, 2.0 }, angles[] = { 0.0, 0.5 };
    scene_obstacle o = gate();
    o.turn = series(2, times, angles, 2.5);
    plate_motion motion = motion_of(&o);

    // From 2 to 3.5 it returns; only before its very first time it waits.
    ASSERT_ANGLES(&motion, { 0.0, 0.0 }, { 0.5, 0.0 }, { 1.5, 0.25 }, { 2.0, 0.5 }, { 2.75, 0.25 },
                  { 3.5, 0.0 }, { 4.0, 0.25 }, { 4.5, 0.5 }, { 5.25, 0.25 }, { 6.0, 0.0 });
    assert_near(plate_range_largest_speed(&o, 0, 0, NULL), 0.5 * 5.5, 1e-14);
    plate_motion_fini(&motion);
}

static void a_jump_from_round_to_round_has_no_bound(void **state)
{
    double times[] = { 0.0, 2.0 }, angles[] = { 0.0, 0.5 };
    scene_obstacle o = gate();

    o.turn = series(2, times, angles, 2.0);
    assert_true(plate_range_largest_speed(&o, 0, 0, NULL) == INFINITY);
    angles[1] = 0.0;
    assert_true(plate_range_largest_speed(&o, 0, 0, NULL) == 0.0);
}

static void it_comes_and_goes_at_its_times(void **state)
{
    static const struct {
        double t;
        bool once, again;
    } expected[] = { { 0.0, true, true },   { 0.9, true, true },  { 1.0, false, false },
                     { 2.9, false, false }, { 3.0, true, true },  { 4.5, true, true },
                     { 5.0, true, false },  { 6.9, true, false }, { 7.0, true, true },
                     { 8.5, true, true },   { 9.0, true, false } };
    double times[] = { 1.0, 3.0 }, values[] = { 0.0, 1.0 };
    scene_obstacle o = gate();

    for (int is_again = 0; is_again < 2; is_again++) {
        o.presence = series(2, times, values, is_again ? 4.0 : INFINITY);
        plate_motion motion = motion_of(&o);
        for (size_t k = 0; k < sizeof expected / sizeof *expected; k++)
            assert_int_equal(plate_motion_is_present(&motion, 0, expected[k].t),
                             is_again ? expected[k].again : expected[k].once);
        plate_motion_fini(&motion);
    }
}

static double extent_of(double repeat, size_t n, double *times, double *values, double t)
{
    scene_obstacle o = gate();
    o.presence = series(n, times, values, repeat);
    plate_motion motion = motion_of(&o);
    const double extent = plate_motion_extent(&motion, 0, t);

    plate_motion_fini(&motion);
    return extent;
}

static void a_plate_that_comes_grows_steadily(void **state)
{
    double times[] = { 0.0, 1.0, 1.1, 2.0 }, values[] = { 0.0, 1.0, 1.0, 0.0 };

    assert_true(extent_of(INFINITY, 4, times, values, 0.5) == 0.0);
    assert_true(extent_of(INFINITY, 4, times, values, 1.0) == 0.0);
    // A time without a change does not begin it anew.
    assert_near(extent_of(INFINITY, 4, times, values, 1.15), 0.75, 1e-14);
    assert_true(extent_of(INFINITY, 4, times, values, 1.25) == 1.0);
    assert_true(extent_of(INFINITY, 4, times, values, 2.0) == 0.0);
    // Again in each round of 3 s.
    assert_near(extent_of(3.0, 4, times, values, 4.05), 0.25, 1e-14);
    assert_near(extent_of(3.0, 4, times, values, 31.15), 0.75, 1e-12);
    // Present from the start: in full; and present at the end of a round and in the next one: still.
    assert_true(extent_of(INFINITY, 2, times + 1, values + 1, 1.01) == 1.0);
    assert_true(extent_of(INFINITY, 1, times, values + 1, 0.0) == 1.0);
    assert_near(extent_of(1.2, 2, times, values, 1.15), 0.75, 1e-14);
    values[0] = 1.0;
    values[1] = 0.0;
    times[1] = 0.05;
    times[2] = 0.1;
    // There from 0.1 of a round of 0.15 s to 0.05 of the next.
    assert_true(extent_of(0.15, 3, times, values, 0.04) == 1.0);
    assert_near(extent_of(0.15, 3, times, values, 0.14), 0.2, 1e-13);
    assert_near(extent_of(0.15, 3, times, values, 0.18), 0.4, 1e-13);
    assert_true(extent_of(0.15, 3, times, values, 0.22) == 0.0);
}

static void it_turns_left_about_its_pivot(void **state)
{
    scene_obstacle o = gate();
    plate_motion motion = motion_of(&o);
    const plate_pose pose = plate_pose_of(&o, (plate_displacement){ .angle = M_PI / 2.0 });
    const vec2 pivot = plate_pose_move(&pose, path[0]), end = plate_pose_move(&pose, path[1]);
    const vec2 velocity = plate_pose_velocity(o.pivot, 2.0, (vec2){ 0.5, -1.0 }, path[1]);

    assert_true(pivot.x == 1.0 && pivot.y == 2.0);
    assert_near(end.x, 1.0 - 4.0, 1e-15);
    assert_near(end.y, 2.0 + 3.0, 1e-15);
    assert_true(velocity.x == -7.5 && velocity.y == 5.0);
    plate_motion_fini(&motion);
}

static void assert_displacement(const plate_motion *motion, double t, double angle, double x,
                                double y)
{
    const plate_displacement displacement = plate_motion_at(motion, 0, t);

    assert_near(displacement.angle, angle, 1e-14);
    assert_near(displacement.shift.x, x, 1e-14);
    assert_near(displacement.shift.y, y, 1e-14);
}

static void shifts_are_linear_between_the_times_of_angles(void **state)
{
    double times[] = { 1.0, 2.0, 4.0 }, angles[] = { 0.0, 0.5, -0.5 };
    vec2 shifts[] = { { 0.0, 0.0 }, { 0.0, 0.4 }, { 2.0, 0.0 } };
    scene_obstacle o = gate();
    o.turn = series(3, times, angles, 5.0);
    o.shifts = shifts;
    o.n_shifts = 3;
    plate_motion motion = motion_of(&o);

    assert_displacement(&motion, 0.5, 0.0, 0.0, 0.0);
    assert_displacement(&motion, 1.25, 0.125, 0.0, 0.1);
    assert_displacement(&motion, 3.0, 0.0, 1.0, 0.2);
    // From the last place at 4 s to the first one of the next round at 6 s.
    assert_displacement(&motion, 5.0, -0.25, 1.0, 0.0);
    assert_displacement(&motion, 6.25, 0.125, 0.0, 0.1);
    // Over [1.25, 2.5]: by 0.3 up, then by 0.5 along and 0.1 down.
    const plate_motion_step step = plate_motion_in_step(&motion, 0, 1, 1.25, 0.0);
    assert_near(step.velocity.x, 0.5 / 1.25, 1e-15);
    assert_near(step.velocity.y, 0.2 / 1.25, 1e-15);
    // By 0.5 rad/s and, in the second piece, hypot(2, 0.4)/2 m/s.
    assert_near(plate_range_largest_speed(&o, 0, 0, NULL), 0.5 * 5.5 + hypot(1.0, 0.2), 1e-14);
    plate_motion_fini(&motion);
}

static void what_is_turned_and_shifted_is_moved_back(void **state)
{
    const plate_pose pose = { path[0], { 0.25, -0.5 }, 0.6, 0.8 };
    const plate_pose back = plate_pose_inverse(&pose);
    const vec2 moved = plate_pose_move(&pose, path[1]);
    const vec2 same = plate_pose_move(&back, moved);

    // (3, 4) from the pivot is turned to (-1.4, 4.8).
    assert_near(moved.x, 1.0 - 1.4 + 0.25, 1e-15);
    assert_near(moved.y, 2.0 + 4.8 - 0.5, 1e-15);
    assert_near(same.x, path[1].x, 1e-15);
    assert_near(same.y, path[1].y, 1e-15);
    assert_true(plate_pose_pivot(&pose).x == 1.25 && plate_pose_pivot(&pose).y == 1.5);
}

static void a_shift_is_commanded_from_where_the_plate_is(void **state)
{
    double times[] = { 0.0, 4.0 }, angles[] = { 0.0, 1.0 };
    vec2 shifts[] = { { 0.0, 0.0 }, { 0.0, 0.8 } };
    scene_obstacle o = gate();
    o.turn = series(2, times, angles, INFINITY);
    o.shifts = shifts;
    o.n_shifts = 2;
    plate_motion motion = motion_of(&o);

    plate_motion_command_shift(&motion, 0, 2.0, (vec2){ 1.0, 0.0 }, 0.5);
    // Its angles go on by the schedule.
    assert_displacement(&motion, 2.0, 0.5, 0.0, 0.4);
    assert_displacement(&motion, 2.25, 0.5625, 0.5, 0.2);
    plate_motion_command_shift(&motion, 0, 2.25, (vec2){ 0.0, 0.0 }, 1.0);
    assert_displacement(&motion, 2.75, 0.6875, 0.25, 0.1);
    assert_displacement(&motion, 9.0, 1.0, 0.0, 0.0);
    plate_motion_fini(&motion);
}

static void the_fastest_shift_is_that_of_any_action_from_any_place(void **state)
{
    const scene_action actions[] = {
        { .type = SCENE_ACTION_SHIFT, .shift = { 0.3, 0.0 }, .over = 0.5 },
        { .type = SCENE_ACTION_SHIFT, .shift = { 0.0, 0.4 }, .over = 1.0 },
        { .type = SCENE_ACTION_SHIFT, .target = 1, .shift = { 9.0, 0.0 }, .over = 1e-3 },
    };
    scene_obstacle o[] = { gate(), gate() };
    const plate_range r = plate_range_of(o, 0, 3, actions);

    assert_true(r.moves && r.is_shifted && !r.is_line);
    // From (0, 0.4) to (0.3, 0) in 0.5 s.
    assert_near(plate_range_largest_speed(o, 0, 3, actions), 1.0, 1e-14);
    // The box of its pivot is (1 .. 1.3, 2 .. 2.4).
    assert_near(plate_range_distance(&r, o[0].pivot, (vec2){ 1.6, 2.8 }), 0.5, 1e-14);
    assert_true(plate_range_distance(&r, o[0].pivot, (vec2){ 1.1, 2.2 }) == 0.0);
    assert_true(plate_range_of(o, 0, 1, actions).is_line);
}

static void commands_replace_the_schedule(void **state)
{
    double times[] = { 0.0, 4.0 }, angles[] = { 0.0, 1.0 }, values[] = { 1.0, 1.0 };
    scene_obstacle o = gate();
    o.turn = series(2, times, angles, INFINITY);
    o.presence = series(2, times, values, INFINITY);
    plate_motion motion = motion_of(&o);

    plate_motion_command_turn(&motion, 0, 2.0, -0.5, 2.0);
    ASSERT_ANGLES(&motion, { 2.0, 0.5 }, { 3.0, 0.0 }, { 4.0, -0.5 }, { 5.0, -0.5 });
    // Once more before it has ended.
    plate_motion_command_turn(&motion, 0, 3.0, 1.0, 0.5);
    ASSERT_ANGLES(&motion, { 3.0, 0.0 }, { 3.25, 0.5 }, { 3.5, 1.0 }, { 9.0, 1.0 });
    plate_motion_command_presence(&motion, 0, 3.0, false);
    assert_false(plate_motion_is_present(&motion, 0, 3.0));
    plate_motion_command_presence(&motion, 0, 3.5, true);
    assert_true(plate_motion_is_present(&motion, 0, 3.5));
    assert_true(plate_motion_extent(&motion, 0, 3.5) == 0.0);
    // Another command of the same does not begin it anew.
    plate_motion_command_presence(&motion, 0, 3.6, true);
    assert_near(plate_motion_extent(&motion, 0, 3.65), 0.75, 1e-14);
    assert_true(plate_motion_extent(&motion, 0, 3.75) == 1.0);
    plate_motion_fini(&motion);
}

static void the_largest_speed_is_that_of_any_action_from_any_angle(void **state)
{
    double times[] = { 0.0, 4.0 }, angles[] = { 0.0, 1.0 };
    const scene_action actions[] = {
        { .type = SCENE_ACTION_TURN, .value = 0.5, .over = 0.5 },
        { .type = SCENE_ACTION_TURN, .value = -0.5, .over = 1.0 },
        { .type = SCENE_ACTION_TURN, .target = 1, .value = 9.0, .over = 1e-3 },
        { .type = SCENE_ACTION_BELT, .value = 9.0, .over = 1e-3 }
    };
    scene_obstacle o[] = { gate(), gate() };

    // Without a schedule the angles are 0, 0.5 and -0.5: by at most 1 in 0.5 s, or by 1 in 1 s.
    assert_near(plate_range_largest_speed(o, 0, 4, actions), 2.0 * 5.5, 1e-14);
    // With it up to 1: by 1.5 in 1 s, by 1 in 0.5 s.
    o[0].turn = series(2, times, angles, INFINITY);
    assert_near(plate_range_largest_speed(o, 0, 4, actions), 2.0 * 5.5, 1e-14);
    assert_near(plate_range_largest_speed(o, 0, 2, actions + 1), 1.5 * 5.5, 1e-14);
    assert_near(plate_range_largest_speed(o, 1, 4, actions), 9e3 * 5.5, 1e-9);
}

static void what_was_commanded_is_saved_and_loaded(void **state)
{
    scene_obstacle o[] = { gate(), gate() };
    bf_buffer bytes = { 0 };
    checkpoint_writer w;
    checkpoint_reader r;
    plate_motion from, to;

    o[1].is_commanded = true;
    assert_int_equal(plate_motion_init(&from, 2, o, NULL), BF_OK);
    assert_int_equal(plate_motion_init(&to, 2, o, NULL), BF_OK);
    plate_motion_command_turn(&from, 1, 2.0, 1.0, 2.0);
    plate_motion_command_presence(&from, 1, 2.0, false);
    checkpoint_begin(&w, &bytes, CHECKPOINT_DISK, 1);
    plate_motion_save(&from, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, bytes.bytes, bytes.n, CHECKPOINT_DISK, 1, NULL), BF_OK);
    checkpoint_reader cut = r;
    cut.n_left--;
    assert_false(plate_motion_load(&to, &cut));
    assert_true(plate_motion_load(&to, &r));
    assert_int_equal(r.n_left, 0);
    assert_true(plate_motion_at(&to, 1, 3.0).angle == 0.5);
    assert_false(plate_motion_is_present(&to, 1, 3.0));
    buffer_fini(&bytes);
    plate_motion_fini(&from);
    plate_motion_fini(&to);
}

// As a state has it.
typedef struct saved {
    plate_motion_command command;
    plate_motion_lag lag;
} saved;

static const saved sound = { { .angle = { 1.0, 2.0, { 0.0, 0.0 }, { 0.5, 0.0 } },
                               .shift = { 1.0, 2.0, { 0.0, 0.0 }, { 1.0, 0.0 } },
                               .presence = -1.0 },
                             { .angle = { .at = INFINITY },
                               .extent = { .at = INFINITY },
                               .shift = { 1.5, 1.6, { 0.2, 0.0 }, { 0.3, 0.0 } } } };

static void a_state_that_is_not_one_is_refused(void **state)
{
    saved s = sound;
    struct {
        double *place;
        double bad;
    } cases[] = {
        { &s.command.angle.until, 0.5 },  { &s.command.angle.at, -1.0 },
        { &s.command.angle.from.x, NAN }, { &s.command.angle.to.x, INFINITY },
        { &s.command.angle.at, NAN },     { &s.command.presence, 0.5 },
        { &s.command.came, NAN },         { &s.command.shift.at, -1.0 },
        { &s.command.shift.until, 0.5 },  { &s.command.shift.from.x, NAN },
        { &s.command.shift.to.y, NAN },   { &s.lag.shift.until, INFINITY },
        { &s.lag.shift.from.y, NAN },     { &s.lag.angle.at, 1.0 },
    };
    scene_obstacle o = gate();

    o.is_commanded = true;
    plate_motion motion = motion_of(&o);
    checkpoint_reader good = { (const char *)&s, sizeof s };
    assert_true(plate_motion_load(&motion, &good));
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const double kept = *cases[k].place;
        checkpoint_reader r = { (const char *)&s, sizeof s };
        *cases[k].place = cases[k].bad;
        assert_false(plate_motion_load(&motion, &r));
        *cases[k].place = kept;
    }
    plate_motion_fini(&motion);
}

static void without_memory_there_is_no_motion(void **state)
{
    double times[] = { 1.0 }, values[] = { 1.0 };
    scene_obstacle o = gate();
    plate_motion motion;

    o.turn = o.presence = series(1, times, values, INFINITY);
    memory_plan_fault(1, 0);
    assert_int_equal(plate_motion_init(&motion, 1, &o, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_int_equal(motion.n, 0);
    assert_null(motion.plates);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_obstacle_without_motion_stands_as_in_the_document),
        cmocka_unit_test(angles_are_linear_between_times_and_constant_outside),
        cmocka_unit_test(repeats_join_the_last_angle_to_the_first),
        cmocka_unit_test(a_jump_from_round_to_round_has_no_bound),
        cmocka_unit_test(it_comes_and_goes_at_its_times),
        cmocka_unit_test(a_plate_that_comes_grows_steadily),
        cmocka_unit_test(it_turns_left_about_its_pivot),
        cmocka_unit_test(shifts_are_linear_between_the_times_of_angles),
        cmocka_unit_test(what_is_turned_and_shifted_is_moved_back),
        cmocka_unit_test(a_shift_is_commanded_from_where_the_plate_is),
        cmocka_unit_test(the_fastest_shift_is_that_of_any_action_from_any_place),
        cmocka_unit_test(commands_replace_the_schedule),
        cmocka_unit_test(the_largest_speed_is_that_of_any_action_from_any_angle),
        cmocka_unit_test(what_was_commanded_is_saved_and_loaded),
        cmocka_unit_test(a_state_that_is_not_one_is_refused),
        cmocka_unit_test(without_memory_there_is_no_motion),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
