// The world of a run: its commands, its checkpoint, and lack of memory.

#include "core/base/memory.h"
#include "core/world/world.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/core/helper_world.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

// A belt of 0.5 m/s that accelerates by 1 m/s2, and a plate; both wait for commands.
static bf_world *commandable_world(void)
{
    static vec2 path[] = { { 0.0, 0.0 }, { 0.1, 0.0 } };
    const scene_belt belt = {
        .velocity = { 0.5, 0.0 }, .acceleration = 1.0, .deceleration = 1.0, .is_commanded = true
    };
    scene_obstacle plate;

    scene_obstacle_init(&plate);
    plate.n_points = 2;
    plate.path = path;
    plate.is_commanded = true;
    return helper_world(1, &belt, 1, &plate);
}

static void command_all(bf_world *w)
{
    const scene_action stop = { .type = SCENE_ACTION_BELT, .value = 0.0 };
    const scene_action hold = { .type = SCENE_ACTION_FEED, .value = 1.0 };

    world_command(w, &stop, 1.0);
    world_command(w, &hold, 1.0);
    helper_world_turn(w, 2.0, 0.4, 0.2);
    helper_world_presence(w, 3.0, false);
}

static void assert_commanded(const bf_world *w)
{
    assert_true(belt_speeds_at(&w->belts, 0, 1.0) == 1.0);
    assert_near(belt_speeds_at(&w->belts, 0, 1.25), 0.5, 1e-12);
    assert_true(belt_speeds_at(&w->belts, 0, 1.6) == 0.0);
    assert_true(plate_motion_at(&w->plates, 0, 2.0).angle == 0.0);
    assert_near(plate_motion_at(&w->plates, 0, 2.1).angle, 0.2, 1e-12);
    assert_true(plate_motion_at(&w->plates, 0, 2.3).angle == 0.4);
    assert_false(plate_motion_is_present(&w->plates, 0, 3.0));
}

static void belts_and_plates_do_what_they_are_told(void **state)
{
    bf_world *w = commandable_world();

    assert_true(belt_speeds_at(&w->belts, 0, 9.0) == 1.0);
    assert_true(plate_motion_is_present(&w->plates, 0, 9.0));
    command_all(w);
    assert_commanded(w);
}

static void off_every_belt_the_factor_is_1(void **state)
{
    const bf_world *w = commandable_world();

    assert_true(belt_speeds_at(&w->belts, 1, 2.0) == 1.0);
    assert_true(belt_speeds_mean(&w->belts, 1, 1.0, 2.0) == 1.0);
}

static void a_checkpoint_has_all_commands(void **state)
{
    bf_world *w = commandable_world(), *resumed = commandable_world();

    command_all(w);
    helper_world_copy(w, resumed);
    assert_commanded(resumed);
}

static void a_checkpoint_that_is_cut_is_refused(void **state)
{
    bf_world *w = commandable_world();
    bf_buffer saved = { 0 };
    checkpoint_writer writer;
    checkpoint_reader r;

    command_all(w);
    checkpoint_begin(&writer, &saved, CHECKPOINT_RUN, 0);
    world_save(w, &writer);
    assert_int_equal(checkpoint_end(&writer, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, saved.bytes, saved.n, CHECKPOINT_RUN, 0, NULL), BF_OK);
    for (size_t n = 0; n < r.n_left; n++) {
        checkpoint_reader cut = { r.at, n };
        assert_false(world_load(commandable_world(), &cut));
    }
    buffer_fini(&saved);
}

static void out_of_memory_anywhere_is_an_error_and_nothing_leaks(void **state)
{
    static vec2 path[] = { { 0.0, 0.0 }, { 0.1, 0.0 } };
    scene_belt belt = { .velocity = { 0.5, 0.0 }, .is_commanded = true };
    scene_obstacle plate;
    bf_status status = BF_ENOMEM;

    scene_obstacle_init(&plate);
    plate.n_points = 2;
    plate.path = path;
    plate.is_commanded = true;
    plate.force_limit = 1.0;
    const scene s = {
        .n_belts = 1, .n_sections = 1, .belts = &belt, .n_obstacles = 1, .obstacles = &plate
    };
    for (size_t n = 1; status != BF_OK; n++) {
        bf_world w;
        memory_plan_fault(n, 0);
        status = world_init(&w, &s, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || (status == BF_ENOMEM && w.drives == NULL));
        world_fini(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(belts_and_plates_do_what_they_are_told),
        cmocka_unit_test(off_every_belt_the_factor_is_1),
        cmocka_unit_test(a_checkpoint_has_all_commands),
        cmocka_unit_test(a_checkpoint_that_is_cut_is_refused),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error_and_nothing_leaks),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
