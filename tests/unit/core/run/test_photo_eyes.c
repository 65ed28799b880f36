// Unit tests of photo eyes: states that last, beams that parts and cells meet, and commands with delays.

#include "core/run/photo_eyes.h"

#include "core/base/memory.h"
#include "core/run/beam.h"
#include "core/run/commands.h"
#include "core/run/control.h"
#include "tests/unit/helper_cmocka.h"

// Steps of 0.1 s: blocked after 3 steps, clear after 2.
static scene_photo_eye eye = { .block_time = 0.3, .clear_time = 0.2 };

static scene scene_with_eye(void)
{
    return (scene){ .n_eyes = 1, .eyes = &eye };
}

static void a_state_changes_when_the_beam_has_been_so_for_its_time(void **state)
{
    const scene s = scene_with_eye();
    photo_eyes eyes = photo_eyes_of(&s, 0.1);
    static const struct {
        bool is_broken, is_blocked, changes;
    } expected[] = {
        { true, false, false },  { true, false, false }, // broken for 1 step, 0.1 s
        { false, false, false },                         // that was too short
        { true, false, false },  { true, false, false }, { true, false, false },
        { true, true, true }, // after 0.3 s
        { true, true, false },   { false, true, false }, { true, true, false },
        { false, true, false },  { false, true, false }, { false, false, true }, // after 0.2 s
    };

    for (uint64_t k = 0; k < sizeof expected / sizeof *expected; k++) {
        assert_int_equal(photo_eyes_see(&eyes, 0, k, expected[k].is_broken), expected[k].changes);
        assert_int_equal(eyes.states[0].is_blocked, expected[k].is_blocked);
    }
}

static void times_that_rounding_touches_end_at_their_step(void **state)
{
    scene_photo_eye third = { .block_time = 0.3, .clear_time = 0.0 };
    const scene s = { .n_eyes = 1, .eyes = &third };
    photo_eyes eyes = photo_eyes_of(&s, 1e-3);

    // 0.3 and 700 * 1e-3 - 400 * 1e-3 differ in their last bits.
    assert_false(photo_eyes_see(&eyes, 0, 400, true));
    assert_false(photo_eyes_see(&eyes, 0, 699, true));
    assert_true(photo_eyes_see(&eyes, 0, 700, true));
    assert_true(photo_eyes_see(&eyes, 0, 701, false));
}

static void a_saved_eye_goes_on_as_it_would_have(void **state)
{
    const scene s = scene_with_eye();
    photo_eyes eyes = photo_eyes_of(&s, 0.1), loaded = photo_eyes_of(&s, 0.1);
    checkpoint_writer w;
    checkpoint_reader r;
    bf_buffer out = { 0 };

    assert_false(photo_eyes_see(&eyes, 0, 5, true));
    checkpoint_begin(&w, &out, CHECKPOINT_RUN, 1);
    photo_eyes_save(&eyes, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, out.bytes, out.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
    assert_int_equal(photo_eyes_load(&loaded, &r, NULL), BF_OK);
    assert_int_equal(photo_eyes_load(&loaded, &r, NULL), BF_ECORRUPT); // nothing is left
    assert_false(photo_eyes_see(&loaded, 0, 7, true));
    assert_true(photo_eyes_see(&loaded, 0, 8, true));
    buffer_fini(&out);
}

// An eye at which an action acts for parts of kind 1.
static scene scene_of_kinds(void)
{
    static scene_action of_kind = { .eye = 0, .kind = 1, .when_blocked = true };
    scene s = scene_with_eye();

    s.n_actions = 1;
    s.actions = &of_kind;
    return s;
}

// How many parts of a kind became blocked, or clear, at the last tick.
static size_t count_new(const photo_eyes *eyes, uint64_t kind, bool is_blocked)
{
    size_t n = 0;

    for (size_t k = 0; k < eyes->parts[0].n; k++) {
        const photo_eye_known *of = &eyes->parts[0].items[k];
        n += of->is_new_state != 0 && of->part.kind == kind &&
             (of->state.is_blocked != 0) == is_blocked;
    }
    return n;
}

// Part 7 of kind 1 and part 8 of kind 0 break the beam at once, part 9 of kind 1 follows 7 without a gap; part 10 is too short.
static void each_part_of_a_kind_has_a_state_of_its_own(void **state)
{
    static const photo_eye_part parts[] = { { 7, 1 }, { 8, 0 }, { 9, 1 }, { 10, 1 } };
    static const struct {
        size_t n, first; // of parts
        size_t blocked, clear, others;
    } ticks[] = {
        { 2, 0, 0, 0, 0 }, { 2, 0, 0, 0, 0 }, { 2, 0, 0, 0, 0 }, { 2, 0, 1, 0, 1 }, // 0.3 s later
        { 1, 2, 0, 0, 0 }, { 1, 2, 0, 0, 0 }, { 1, 2, 0, 1, 0 }, // 7 has been away for 0.2 s
        { 1, 2, 1, 0, 0 }, { 1, 3, 0, 0, 0 }, { 0, 0, 0, 0, 0 }, { 0, 0, 0, 1, 0 },
        { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 },
    };
    const scene s = scene_of_kinds();
    photo_eyes eyes = photo_eyes_of(&s, 0.1);

    assert_true(eyes.tells_kinds[0]);
    for (uint64_t k = 0; k < sizeof ticks / sizeof *ticks; k++) {
        assert_int_equal(
            photo_eyes_see_parts(&eyes, 0, k, ticks[k].n, parts + ticks[k].first, NULL), BF_OK);
        assert_int_equal(count_new(&eyes, 1, true), ticks[k].blocked);
        assert_int_equal(count_new(&eyes, 1, false), ticks[k].clear);
        assert_int_equal(count_new(&eyes, 0, true), ticks[k].others);
    }
    assert_int_equal(eyes.parts[0].n, 0);
    photo_eyes_fini(&eyes);
}

static void saved_parts_at_an_eye_go_on_as_they_would_have(void **state)
{
    static const photo_eye_part part = { 3, 1 };
    const scene s = scene_of_kinds();
    photo_eyes eyes = photo_eyes_of(&s, 0.1), loaded = photo_eyes_of(&s, 0.1);
    checkpoint_writer w;
    checkpoint_reader r;
    bf_buffer out = { 0 };

    assert_int_equal(photo_eyes_see_parts(&eyes, 0, 5, 1, &part, NULL), BF_OK);
    checkpoint_begin(&w, &out, CHECKPOINT_RUN, 1);
    photo_eyes_save(&eyes, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, out.bytes, out.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
    assert_int_equal(photo_eyes_load(&loaded, &r, NULL), BF_OK);
    assert_int_equal(photo_eyes_see_parts(&loaded, 0, 7, 1, &part, NULL), BF_OK);
    assert_int_equal(count_new(&loaded, 1, true), 0);
    assert_int_equal(photo_eyes_see_parts(&loaded, 0, 8, 1, &part, NULL), BF_OK);
    assert_int_equal(count_new(&loaded, 1, true), 1);
    photo_eyes_fini(&eyes);
    photo_eyes_fini(&loaded);
    buffer_fini(&out);
}

static const vec2 beam[2] = { { 0.5, 0.1 }, { 0.5, 0.4 } };

static void a_disk_breaks_the_beams_that_it_touches(void **state)
{
    const scene_shape disk = { .type = SCENE_CYLINDER, .radius = 0.0625, .height = 0.01 };
    const shape_footprint f = shape_footprint_of(&disk);

    assert_true(beam_meets_part(beam, &f, (scene_pose){ 0.5625, 0.2, 0.0 }));
    assert_false(beam_meets_part(beam, &f, (scene_pose){ 0.5626, 0.2, 0.0 }));
    assert_true(beam_meets_part(beam, &f, (scene_pose){ 0.5, 0.46, 0.0 }));
    assert_false(
        beam_meets_part(beam, &f, (scene_pose){ 0.55, 0.45, 0.0 })); // 0.0707 m from its end
}

static void a_box_breaks_the_beams_that_it_touches_as_it_is_turned(void **state)
{
    const scene_shape box = { .type = SCENE_BOX, .length = 0.2, .width = 0.02, .height = 0.01 };
    const shape_footprint f = shape_footprint_of(&box);
    const vec2 within[2] = { { 0.0, 0.0 }, { 0.001, 0.0 } };

    assert_true(beam_meets_part(beam, &f, (scene_pose){ 0.41, 0.2, 0.0 }));
    assert_false(beam_meets_part(beam, &f, (scene_pose){ 0.41, 0.2, 1.5707963267948966 }));
    assert_true(beam_meets_part(within, &f, (scene_pose){ 0.0, 0.0, 0.3 })); // wholly inside
}

static void assert_cells(const vec2 line[2], size_t n, const size_t *expected)
{
    const bf_grid grid = { 4, 3, 0.0, 0.0, 0.1, 0.1 };
    beam_cells cells;

    assert_int_equal(beam_cells_of(line, &grid, &cells, NULL), BF_OK);
    assert_int_equal(cells.n, n);
    if (n > 0)
        assert_memory_equal(cells.cells, expected, n * sizeof *expected);
    beam_cells_fini(&cells);
}

static void a_beam_has_the_cells_that_it_crosses_or_touches(void **state)
{
    assert_cells((vec2[]){ { 0.05, 0.05 }, { 0.05, 0.25 } }, 3, (size_t[]){ 0, 4, 8 });
    assert_cells((vec2[]){ { 0.1, 0.05 }, { 0.1, 0.15 } }, 4, (size_t[]){ 0, 1, 4, 5 });
    assert_cells((vec2[]){ { 0.05, 0.02 }, { 0.15, 0.12 } }, 3, (size_t[]){ 0, 1, 5 });
    assert_cells((vec2[]){ { -1.0, 0.25 }, { 9.0, 0.25 } }, 4, (size_t[]){ 8, 9, 10, 11 });
    assert_cells((vec2[]){ { 0.5, 0.0 }, { 0.6, 0.3 } }, 0, NULL);
}

// Four actions of two eyes.
static scene_action actions[] = {
    { .eye = 0, .kind = SCENE_KIND_ANY, .when_blocked = true, .delay = 0.2 },
    { .eye = 1, .kind = SCENE_KIND_ANY, .when_blocked = true, .delay = 0.1 },
    { .eye = 0, .kind = SCENE_KIND_ANY, .when_blocked = true, .delay = 0.0 },
    { .eye = 0, .kind = SCENE_KIND_ANY, .when_blocked = false, .delay = 0.1 },
};
static const scene commanded = { .n_actions = 4, .actions = actions };

static void assert_taken(commands *c, uint64_t step, size_t expected)
{
    size_t action = SIZE_MAX;

    assert_true(commands_take(c, step, &action));
    assert_int_equal(action, expected);
}

static void commands_come_when_due_and_those_of_a_step_in_the_order_of_actions(void **state)
{
    commands c = commands_of(&commanded, 0.1);
    size_t action;

    assert_int_equal(commands_note(&c, 0, SCENE_KIND_ANY, true, 10, NULL),
                     BF_OK); // 2 at step 10, 0 at step 12
    assert_taken(&c, 10, 2);
    assert_false(commands_take(&c, 11, &action));
    assert_int_equal(commands_note(&c, 0, SCENE_KIND_ANY, false, 11, NULL), BF_OK); // 3 at step 12
    assert_int_equal(commands_note(&c, 1, SCENE_KIND_ANY, true, 11, NULL), BF_OK);  // 1 at step 12
    assert_taken(&c, 13, 0);
    assert_taken(&c, 13, 1);
    assert_taken(&c, 13, 3);
    assert_false(commands_take(&c, 1000, &action));
    commands_fini(&c);
}

static void saved_commands_come_as_they_would_have(void **state)
{
    commands c = commands_of(&commanded, 0.1), loaded = commands_of(&commanded, 0.1);
    checkpoint_writer w;
    checkpoint_reader r;
    bf_buffer out = { 0 };
    size_t action;

    assert_int_equal(commands_note(&c, 0, SCENE_KIND_ANY, true, 10, NULL), BF_OK);
    checkpoint_begin(&w, &out, CHECKPOINT_RUN, 1);
    commands_save(&c, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, out.bytes, out.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
    assert_int_equal(commands_load(&loaded, &r, NULL), BF_OK);
    assert_int_equal(commands_load(&loaded, &r, NULL), BF_ECORRUPT); // nothing is left
    assert_taken(&loaded, 10, 2);
    assert_false(commands_take(&loaded, 11, &action));
    assert_taken(&loaded, 12, 0);
    commands_fini(&c);
    commands_fini(&loaded);
    buffer_fini(&out);
}

static void an_action_that_is_not_in_the_scene_is_damage(void **state)
{
    const scene fewer = { .n_actions = 2, .actions = actions };
    commands c = commands_of(&commanded, 0.1), loaded = commands_of(&fewer, 0.1);
    checkpoint_writer w;
    checkpoint_reader r;
    bf_buffer out = { 0 };

    assert_int_equal(commands_note(&c, 0, SCENE_KIND_ANY, true, 10, NULL), BF_OK);
    checkpoint_begin(&w, &out, CHECKPOINT_RUN, 1);
    commands_save(&c, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, out.bytes, out.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
    assert_int_equal(commands_load(&loaded, &r, NULL), BF_ECORRUPT);
    assert_int_equal(loaded.n, 0);
    commands_fini(&c);
    commands_fini(&loaded);
    buffer_fini(&out);
}

static void more_commands_than_may_wait_end_the_run(void **state)
{
    scene_action late = { .kind = SCENE_KIND_ANY, .when_blocked = true, .delay = 1e9 };
    const scene s = { .n_actions = 1, .actions = &late };
    commands c = commands_of(&s, 0.1);
    bf_error err;

    for (uint64_t k = 0; k < COMMANDS_MAX; k++)
        assert_int_equal(commands_note(&c, 0, SCENE_KIND_ANY, true, k, NULL), BF_OK);
    assert_int_equal(commands_note(&c, 0, SCENE_KIND_ANY, true, COMMANDS_MAX, &err), BF_ELIMIT);
    assert_string_equal(err.pointer, "/actions");
    commands_fini(&c);
}

static void no_memory_is_reported(void **state)
{
    const bf_grid grid = { 4, 3, 0.0, 0.0, 0.1, 0.1 };
    const vec2 line[2] = { { 0.05, 0.05 }, { 0.05, 0.25 } };
    commands c = commands_of(&commanded, 0.1);
    beam_cells cells = { .n = 99 };
    const scene s = scene_of_kinds();
    photo_eyes eyes = photo_eyes_of(&s, 0.1);

    memory_plan_fault(1, 1);
    assert_int_equal(beam_cells_of(line, &grid, &cells, NULL), BF_ENOMEM);
    assert_int_equal(commands_note(&c, 0, SCENE_KIND_ANY, true, 10, NULL), BF_ENOMEM);
    assert_int_equal(photo_eyes_see_parts(&eyes, 0, 5, 1, &(photo_eye_part){ 3, 1 }, NULL),
                     BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_int_equal(cells.n, 99);
    assert_int_equal(c.n, 0);
}

// A model that parts never pass, and whose beam changes at every look.
static bf_status look(void *solver, size_t at, run_view *ret_view, bf_error *err)
{
    bool *is_broken = solver;

    (void)at;
    *is_broken = !*is_broken;
    *ret_view = (run_view){ .is_broken = *is_broken };
    return BF_OK;
}

static bf_status count_change(void *context, const frame *f, bf_error *err)
{
    uint64_t *n = context;

    assert_int_equal(f->type, FRAME_CHANGE);
    assert_int_equal(f->change.index, (*n)++);
    return BF_OK;
}

static void a_run_tells_of_so_many_changes_at_most(void **state)
{
    static const run_backend backend = { .look = look };
    scene_photo_eye nervous = { .id = "pe" };
    const scene s = { .n_eyes = 1, .eyes = &nervous };
    bf_world at_rest = { .drives = NULL };
    control c = control_of(&s, &at_rest, &backend, &(run_plan){ .dt = 1e-3, .n_tick = 1 });
    bool is_broken = false;
    uint64_t n = 0;
    const run_sink sink = { .context = &n, .on_frame = count_change };

    figures *to;

    assert_int_equal(figures_create(&s, false, &to, NULL), BF_OK);
    for (uint64_t step = 0; step < FRAME_CHANGES_MAX + 5; step++)
        assert_int_equal(control_tick(&c, &is_broken, step, to, &sink, NULL), BF_OK);
    assert_int_equal(n, FRAME_CHANGES_MAX);
    // The state is known all the same.
    assert_int_equal(c.eyes.states[0].is_blocked, is_broken);
    control_fini(&c);
    figures_destroy(to);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_state_changes_when_the_beam_has_been_so_for_its_time),
        cmocka_unit_test(times_that_rounding_touches_end_at_their_step),
        cmocka_unit_test(a_saved_eye_goes_on_as_it_would_have),
        cmocka_unit_test(each_part_of_a_kind_has_a_state_of_its_own),
        cmocka_unit_test(saved_parts_at_an_eye_go_on_as_they_would_have),
        cmocka_unit_test(a_disk_breaks_the_beams_that_it_touches),
        cmocka_unit_test(a_box_breaks_the_beams_that_it_touches_as_it_is_turned),
        cmocka_unit_test(a_beam_has_the_cells_that_it_crosses_or_touches),
        cmocka_unit_test(commands_come_when_due_and_those_of_a_step_in_the_order_of_actions),
        cmocka_unit_test(saved_commands_come_as_they_would_have),
        cmocka_unit_test(an_action_that_is_not_in_the_scene_is_damage),
        cmocka_unit_test(more_commands_than_may_wait_end_the_run),
        cmocka_unit_test(no_memory_is_reported),
        cmocka_unit_test(a_run_tells_of_so_many_changes_at_most),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
