// Unit tests of the drives of obstacles that move: the force they have by default, how they fall behind under a load
// and catch up, and states.

#include "core/world/plate_drive.h"

#include "core/base/memory.h"
#include "core/scene/mix.h"
#include "core/scene/scene.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static vec2 path[] = { { 0.0, 0.0 }, { 2.0, 0.0 } };

// 2 m long, of no thickness: turns at 1 rad/s from 1 to 2 s.
static double times[] = { 1.0, 2.0 }, angles[] = { 0.0, 1.0 };

static const plate_drive drive = { .force = 10.0, .torque = 20.0, .rate = 1.0 };
static const plate_load none = { .torque = 0.0 }, at_limit = { .torque = -20.0 };

static plate_motion turning(void)
{
    static scene_obstacle o; // borrowed by the motion
    plate_motion motion;

    scene_obstacle_init(&o);
    o.n_points = 2;
    o.path = path;
    o.turn = (scene_series){ 2, times, 2, angles, INFINITY };
    assert_int_equal(plate_motion_init(&motion, 1, &o, NULL), BF_OK);
    return motion;
}

// Follows from a time on in pieces of 0.01 s; returns the angle at the end.
static double follow(plate_motion *motion, const plate_load *load, double t, int n)
{
    for (int k = 0; k < n; k++)
        plate_drive_follow(motion, 0, &drive, load, t + 0.01 * k, t + 0.01 * (k + 1));
    return plate_motion_at(motion, 0, t + 0.01 * n).angle;
}

static void it_is_as_told_up_to_half_its_limit_and_slower_beyond(void **state)
{
    // Of the limit, and the part of the speed that is left: steadily from 1 at half to 0 at the limit.
    static const double expected[][2] = { { -2.0, 1.0 }, { 0.0, 1.0 }, { 0.5, 1.0 }, { 0.6, 0.8 },
                                          { 0.75, 0.5 }, { 1.0, 0.0 }, { 3.0, 0.0 } };

    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++) {
        plate_motion motion = turning();
        const plate_load load = { .torque = -20.0 * expected[k][0] };
        plate_drive_follow(&motion, 0, &drive, &load, 1.0, 1.25);
        assert_near(plate_motion_at(&motion, 0, 1.25).angle, 0.25 * expected[k][1], 1e-15);
        assert_near(plate_motion_at(&motion, 0, 1.125).angle, 0.125 * expected[k][1], 1e-15);
        assert_int_equal(plate_drive_state_of(&motion, 0, 1.25),
                         expected[k][1] == 0.0  ? PLATE_DRIVE_STALLED
                         : expected[k][1] < 1.0 ? PLATE_DRIVE_BEHIND
                                                : PLATE_DRIVE_AS_TOLD);
        // At rest after the piece, until it follows again.
        if (expected[k][1] < 1.0)
            assert_near(plate_motion_at(&motion, 0, 9.0).angle, 0.25 * expected[k][1], 1e-15);
        plate_motion_fini(&motion);
    }
}

// Shifted by (0.3, 0.4) m in a second with a limit of 10 N, of which what stands against its way counts.
static void a_shift_is_slower_the_more_bears_against_it(void **state)
{
    static const double expected[][2] = {
        { -2.0, 1.0 }, { 0.4, 1.0 }, { 0.75, 0.5 }, { 1.0, 0.0 }
    };
    static const plate_drive linear = { .force = 10.0, .torque = 20.0, .speed = 0.5 };
    static double flat[] = { 0.0, 0.0 };
    static vec2 shifts[] = { { 0.0, 0.0 }, { 0.3, 0.4 } };

    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++) {
        scene_obstacle o;
        plate_motion motion;
        const double force = 10.0 * expected[k][0], part = expected[k][1];
        // Against the way, and 7 N across it.
        const plate_load load = { .resultant = { -0.6 * force - 0.8 * 7.0,
                                                 -0.8 * force + 0.6 * 7.0 } };
        scene_obstacle_init(&o);
        o.n_points = 2;
        o.path = path;
        o.turn = (scene_series){ 2, times, 2, flat, INFINITY };
        o.shifts = shifts;
        o.n_shifts = 2;
        assert_int_equal(plate_motion_init(&motion, 1, &o, NULL), BF_OK);
        assert_true(plate_drive_is_needed(&motion, 0, 1.0, 1.25));
        plate_drive_follow(&motion, 0, &linear, &load, 1.0, 1.25);
        assert_near(plate_motion_at(&motion, 0, 1.25).shift.x, 0.25 * 0.3 * part, 1e-15);
        assert_near(plate_motion_at(&motion, 0, 1.25).shift.y, 0.25 * 0.4 * part, 1e-15);
        assert_int_equal(plate_drive_state_of(&motion, 0, 1.25), part == 0.0 ? PLATE_DRIVE_STALLED
                                                                 : part < 1.0
                                                                     ? PLATE_DRIVE_BEHIND
                                                                     : PLATE_DRIVE_AS_TOLD);
        // It catches up at 0.5 m/s once nothing bears on it.
        for (int m = 0; m < 102; m++)
            plate_drive_follow(&motion, 0, &linear, &none, 1.25 + 0.01 * m, 1.25 + 0.01 * (m + 1));
        assert_near(plate_motion_at(&motion, 0, 2.25).shift.x, 0.3, 1e-12);
        assert_int_equal(plate_drive_state_of(&motion, 0, 2.27), PLATE_DRIVE_AS_TOLD);
        plate_motion_fini(&motion);
    }
}

static void what_pushes_in_its_direction_does_not_turn_it_faster(void **state)
{
    static const plate_load with = { .torque = 1e6 };
    plate_motion motion = turning();

    assert_near(follow(&motion, &with, 1.0, 50), 0.5, 1e-14);
    assert_int_equal(plate_drive_state_of(&motion, 0, 1.5), PLATE_DRIVE_AS_TOLD);
    plate_motion_fini(&motion);
}

// Held for half a second, it is behind by 0.5 rad, and by 0.5 rad when the schedule has ended; 1 rad/s is its fastest rate.
static void it_catches_up_at_its_fastest_rate(void **state)
{
    plate_motion motion = turning();

    assert_near(follow(&motion, &at_limit, 1.0, 50), 0.0, 1e-15);
    assert_near(follow(&motion, &none, 1.5, 50), 0.5, 1e-12);
    assert_int_equal(plate_drive_state_of(&motion, 0, 2.0), PLATE_DRIVE_BEHIND);
    assert_true(plate_drive_is_needed(&motion, 0, 2.0, 2.01));
    assert_near(follow(&motion, &none, 2.0, 51), 1.0, 1e-12);
    assert_false(plate_drive_is_needed(&motion, 0, 3.0, 3.01));
    assert_int_equal(plate_drive_state_of(&motion, 0, 3.0), PLATE_DRIVE_AS_TOLD);
    plate_motion_fini(&motion);
}

static void a_command_begins_where_it_stands(void **state)
{
    plate_motion motion = turning();

    (void)follow(&motion, &at_limit, 1.0, 50);
    plate_motion_command_turn(&motion, 0, 1.5, -1.0, 0.5);
    assert_near(plate_motion_at(&motion, 0, 1.75).angle, -0.5, 1e-15);
    assert_int_equal(plate_drive_state_of(&motion, 0, 1.75), PLATE_DRIVE_AS_TOLD);
    plate_motion_fini(&motion);
}

// Its surfaces come forth within PLATE_SCHEDULE_COMING; what bears on them holds them back, and it goes at once.
static void a_plate_that_comes_is_held_back_by_the_force_on_its_surfaces(void **state)
{
    static double switches[] = { 1.0, 2.0, 3.0 }, there[] = { 0.0, 1.0, 0.0 };
    static const plate_load held = { .force = 7.5 };
    const double come = 2.0 + PLATE_SCHEDULE_COMING / 2.0;
    scene_obstacle o;
    plate_motion motion;

    scene_obstacle_init(&o);
    o.n_points = 2;
    o.path = path;
    o.presence = (scene_series){ 3, switches, 3, there, INFINITY };
    assert_int_equal(plate_motion_init(&motion, 1, &o, NULL), BF_OK);
    assert_true(plate_drive_is_needed(&motion, 0, 2.0, 2.01));
    assert_false(plate_drive_is_needed(&motion, 0, 3.0, 3.01));
    plate_drive_follow(&motion, 0, &drive, &held, 2.0, come);
    assert_near(plate_motion_extent(&motion, 0, come), 0.25, 1e-14);
    plate_drive_follow(&motion, 0, &drive, &(plate_load){ .force = 10.0 }, come, 2.9);
    assert_near(plate_motion_extent(&motion, 0, 2.9), 0.25, 1e-14);
    assert_int_equal(plate_drive_state_of(&motion, 0, 2.9), PLATE_DRIVE_STALLED);
    assert_true(plate_motion_extent(&motion, 0, 3.0) == 0.0);
    plate_drive_follow(&motion, 0, &drive, &held, 3.0, 3.1);
    assert_int_equal(plate_drive_state_of(&motion, 0, 3.1), PLATE_DRIVE_AS_TOLD);
    plate_motion_fini(&motion);
}

// mu g M R: friction 0.19 (see helper_scene_belt()), M of cargo packed on 0.5 m by the longer side of 2 m.
static void its_force_is_what_the_document_says_or_twice_that_of_a_full_belt(void **state)
{
    static const scene_pose somewhere = { 0.1, 0.1, 0.0 };
    static const vec2 arm[] = { { 1.0, 0.0 }, { 1.0, 0.5 } };
    static const double at[] = { 0.0, 2.0 }, turned[] = { 0.0, 1.0 };
    scene s;

    helper_scene_belt(&s, 2.0, 1.0, 0.01, &somewhere, 1);
    scene_obstacle *o = helper_scene_add_obstacle(&s, arm, 2, SCENE_SEALED);
    o->thickness = 0.0;
    o->turn = helper_scene_series(2, at, turned, INFINITY);
    helper_scene_resolve(&s);
    const double packed = s.cargo[0].mass * scene_packing_density(&s);
    const double friction = s.micro.contact[SCENE_CONVEYOR_CARGO].friction;
    plate_drive of = plate_drive_of(&s, 0);
    assert_near(mix_mass_per_area(&s), packed, 1e-12 * packed);
    assert_near(of.force, friction * s.micro.gravity * packed * 0.5 * 2.0, 1e-12 * of.force);
    assert_near(of.torque, 0.5 * of.force, 1e-12 * of.torque);
    assert_near(of.rate, 0.5, 1e-15);
    s.obstacles[0].force_limit = 3.0;
    of = plate_drive_of(&s, 0);
    assert_true(of.force == 3.0 && of.torque == 1.5);
    scene_fini(&s);
}

static void a_saved_lag_goes_on_and_a_damaged_one_is_refused(void **state)
{
    plate_motion motion = turning(), other = turning();
    bf_buffer bytes = { 0 };

    (void)follow(&motion, &at_limit, 1.0, 50);
    for (int damaged = 0; damaged < 2; damaged++) {
        checkpoint_writer w;
        checkpoint_reader r;
        if (damaged != 0)
            motion.plates[0].lag.angle.until = 0.5 * motion.plates[0].lag.angle.at;
        bytes.n = 0;
        checkpoint_begin(&w, &bytes, CHECKPOINT_DISK, 1);
        plate_motion_save(&motion, &w);
        assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
        assert_int_equal(checkpoint_open(&r, bytes.bytes, bytes.n, CHECKPOINT_DISK, 1, NULL),
                         BF_OK);
        assert_true(plate_motion_load(&other, &r) == (damaged == 0));
        if (damaged == 0)
            assert_true(follow(&motion, &none, 1.5, 20) == follow(&other, &none, 1.5, 20));
    }
    buffer_fini(&bytes);
    plate_motion_fini(&motion);
    plate_motion_fini(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_as_told_up_to_half_its_limit_and_slower_beyond),
        cmocka_unit_test(a_shift_is_slower_the_more_bears_against_it),
        cmocka_unit_test(what_pushes_in_its_direction_does_not_turn_it_faster),
        cmocka_unit_test(it_catches_up_at_its_fastest_rate),
        cmocka_unit_test(a_command_begins_where_it_stands),
        cmocka_unit_test(a_plate_that_comes_is_held_back_by_the_force_on_its_surfaces),
        cmocka_unit_test(its_force_is_what_the_document_says_or_twice_that_of_a_full_belt),
        cmocka_unit_test(a_saved_lag_goes_on_and_a_damaged_one_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
