// Unit tests of what a solver elsewhere may say of a run. That honest runs pass is checked of every run of helper_run().

#include "core/advice/plausible.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <stdlib.h>

/// An honest run, and what is said of it instead.
typedef struct claim {
    scene s;
    helper_run_log *log;
    frame_begin begin;
    frame_end end;
} claim;

static int setup(void **state)
{
    static claim c;

    c.log = calloc(1, sizeof *c.log);
    helper_scene_example(&c.s, 60.0, SCENE_SEALED);
    c.s.duration = 0.25; // no multiple of a snapshot's period
    c.s.macro.cell = 0.02;
    c.s.macro.step = 0.004;
    assert_int_equal(helper_run(&c.s, 1, 0, c.log), BF_OK);
    c.begin = c.log->begin;
    c.end = c.log->end;
    *state = &c;
    return 0;
}

static int teardown(void **state)
{
    claim *c = *state;

    scene_fini(&c->s);
    helper_run_free(c->log);
    return 0;
}

static bf_status check(const claim *c)
{
    return plausible_end(&c->s, RUN_MACRO, &c->begin, &c->end, NULL);
}

// Restores what was said.
static void assert_refused(claim *c)
{
    assert_int_equal(check(c), BF_ECORRUPT);
    c->begin = c->log->begin;
    c->end = c->log->end;
    assert_int_equal(check(c), BF_OK);
}

static void a_run_without_results_is_not_done(void **state)
{
    claim *c = *state;

    c->end = (frame_end){ .n_steps = c->begin.n_steps };
    assert_refused(c);
    c->end.n_samples--;
    assert_refused(c);
    c->end.n_samples++;
    assert_refused(c);
    c->end.n_snapshots--;
    assert_refused(c);
    c->end.n_cells = 0;
    assert_refused(c);
}

static void another_run_is_not_this_one(void **state)
{
    claim *c = *state;

    c->begin.model = RUN_MICRO;
    assert_refused(c);
    c->begin.n_columns++;
    assert_refused(c);
    c->begin.n_steps = c->end.n_steps = 1;
    assert_refused(c);
    c->begin.dt *= 2.0;
    assert_refused(c);
    c->begin.dt = 0.0;
    assert_refused(c);
    c->begin.grid.n1--;
    assert_refused(c);
    c->begin.n_values = FRAME_VALUES_PLANAR;
    assert_refused(c);
    c->begin.definition ^= 1;
    assert_refused(c);
    // One of the same form: only where the plate stands is another.
    scene other;
    helper_scene_example(&other, 70.0, SCENE_SEALED);
    other.duration = c->s.duration;
    other.macro = c->s.macro;
    assert_int_equal(plausible_begin(&c->s, RUN_MACRO, &c->begin, NULL), BF_OK);
    assert_int_equal(plausible_begin(&other, RUN_MACRO, &c->begin, NULL), BF_ECORRUPT);
    scene_fini(&other);
    c->s.duration = 0.5;
    assert_int_equal(check(c), BF_ECORRUPT);
}

static void only_what_its_scenario_names_ends_a_run_early(void **state)
{
    claim *c = *state;

    c->end.stopped = 1;
    assert_refused(c);
    c->end.n_steps++;
    assert_refused(c);
    c->end.t = 1.0;
    assert_refused(c);
    c->end.reason = FRAME_END_DRAINED;
    assert_refused(c);
    // The first step, with the results of both ends.
    c->end.n_steps = 1;
    c->end.t = c->begin.dt;
    c->end.n_samples = c->end.n_snapshots = 2;
    c->end.reason = FRAME_END_DRAINED;
    assert_int_equal(check(c), BF_ECORRUPT);
    c->s.until = SCENE_UNTIL_DRAINED;
    c->begin.definition = run_definition(&c->s, RUN_MACRO);
    assert_int_equal(check(c), BF_OK);
    c->end.reason = FRAME_END_STEADY;
    assert_int_equal(check(c), BF_ECORRUPT);
    c->end.reason = FRAME_END_DURATION;
    assert_int_equal(check(c), BF_ECORRUPT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_run_without_results_is_not_done, setup, teardown),
        cmocka_unit_test_setup_teardown(another_run_is_not_this_one, setup, teardown),
        cmocka_unit_test_setup_teardown(only_what_its_scenario_names_ends_a_run_early, setup,
                                        teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
