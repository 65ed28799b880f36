// Unit tests of what a scene leaves to chance, and of its cycle.

#include "core/scene/regime.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

// One feed of one kind at one place, regular.
static void make(scene *s)
{
    helper_scene_belt(s, 1.0, 0.5, 0.01, NULL, 0);
    s->duration = 100.0;
    s->warmup = 10.0;
    s->n_feeds = 1;
    s->feeds = memory_alloc(1, sizeof *s->feeds);
    scene_feed_init(s->feeds);
    s->feeds[0].line[0] = s->feeds[0].line[1] = (vec2){ 0.0, 0.25 };
    s->feeds[0].demand = SCENE_DEMAND_RATE;
    s->feeds[0].arrivals = SCENE_ARRIVALS_REGULAR;
    s->feeds[0].rate = 4.0;
    s->feeds[0].n_cargo = 1;
}

static void what_feeds_draw_is_chance(void **state)
{
    scene s;
    make(&s);
    scene_feed *f = s.feeds;
    assert_false(scene_has_chance(&s, false));
    f->arrivals = SCENE_ARRIVALS_POISSON;
    assert_true(scene_has_chance(&s, false));
    f->arrivals = SCENE_ARRIVALS_ERLANG;
    assert_true(scene_has_chance(&s, false));
    f->arrivals = SCENE_ARRIVALS_BATCH;
    assert_false(scene_has_chance(&s, false));
    f->line[1].y = 0.3;
    assert_true(scene_has_chance(&s, false));
    f->line[1].y = 0.25;
    f->has_random_heading = true;
    assert_true(scene_has_chance(&s, false));
    f->has_random_heading = false;
    f->n_cargo = 2;
    assert_true(scene_has_chance(&s, false));
    scene_fini(&s);
}

// The density is fed by rates; an eye that draws gaps, and commands a belt, makes its runs differ.
static void eyes_that_command_by_drawn_gaps_are_chance_of_the_density(void **state)
{
    scene_photo_eye eyes[] = { { .density_ratio = 0.5 } };
    scene_action actions[] = { { .eye = 0, .kind = SCENE_KIND_ANY, .type = SCENE_ACTION_BELT } };
    scene s;

    make(&s);
    s.feeds[0].arrivals = SCENE_ARRIVALS_POISSON;
    assert_false(scene_has_chance(&s, true));
    s.eyes = eyes;
    s.actions = actions;
    s.n_eyes = s.n_actions = 1;
    assert_false(scene_has_chance(&s, true));
    eyes[0].density_ratio = 0.0; // "auto"
    assert_true(scene_has_chance(&s, true));
    assert_true(scene_regime_of(&s, true).has_chance);
    s.feeds[0].arrivals = SCENE_ARRIVALS_REGULAR;
    assert_false(scene_has_chance(&s, true));
    s.n_eyes = s.n_actions = 0;
    s.eyes = NULL;
    s.actions = NULL;
    scene_fini(&s);
}

// A counter of a kind counts what is drawn of a mix. An eye that commands something for a kind draws the kind of what comes to it, but not
// the gaps between parts, as the density is let in part by part.
static void kinds_that_are_told_apart_are_chance_of_the_density(void **state)
{
    scene_counter of_kind = { .kind = 0 };
    scene_photo_eye eye = { .density_ratio = 0.0 };
    scene_action action = { .kind = 1 };
    scene s;

    make(&s);
    s.counters = &of_kind;
    s.n_counters = 1;
    s.feeds[0].arrivals = SCENE_ARRIVALS_POISSON;
    assert_false(scene_has_chance(&s, true));
    assert_int_equal(scene_gap_shape(&s), 1);
    s.feeds[0].n_cargo = 2;
    assert_true(scene_has_chance(&s, true));
    s.feeds[0].n_cargo = 1;
    assert_false(scene_has_chance(&s, true));
    s.eyes = &eye;
    s.actions = &action;
    s.n_eyes = s.n_actions = 1;
    assert_true(scene_has_chance(&s, true));
    assert_int_equal(scene_gap_shape(&s), 0);
    s.n_eyes = s.n_actions = s.n_counters = 0;
    s.eyes = NULL;
    s.actions = NULL;
    s.counters = NULL;
    scene_fini(&s);
}

static void failures_are_chance_of_both_models_unless_they_are_given(void **state)
{
    scene_failure f = { .between = { 60.0, SCENE_TIME_EXPONENTIAL, 1.0 },
                        .repair = { 6.0, SCENE_TIME_FIXED, 1.0 } };
    scene_belt belt = { .velocity = { 0.4, 0.0 } };
    scene_stops *stops = &belt.stops;
    scene s;

    make(&s);
    s.belts = &belt;
    s.n_belts = 1;
    stops->n_failures = 1;
    stops->failures = &f;
    assert_true(scene_has_chance(&s, true) && scene_has_chance(&s, false));
    assert_true(scene_regime_of(&s, true).is_constant);
    f.between.law = SCENE_TIME_FIXED;
    assert_false(scene_has_chance(&s, true) || scene_has_chance(&s, false));
    f = (scene_failure){ .type = SCENE_FAILURE_LISTED,
                         .n_times = 1,
                         .times = &(double){ s.warmup + 0.1 },
                         .n_durations = 1,
                         .durations = &(double){ 0.1 } };
    assert_false(scene_has_chance(&s, true));
    assert_false(scene_regime_of(&s, true).is_constant);
    f.n_times = 0;
    stops->n_breaks = 1;
    stops->breaks = &(scene_break){ .start = 1.0, .duration = 0.5, .every = 4.0 };
    assert_true(scene_regime_of(&s, true).is_constant && scene_regime_of(&s, true).cycle == 4.0);
    s.belts = NULL;
    s.n_belts = 0;
    scene_fini(&s);
}

// Poisson belongs to a rate, not to a list; of a list what is not given is drawn.
static void a_list_draws_what_it_does_not_give(void **state)
{
    scene s;
    make(&s);
    scene_feed *f = s.feeds;
    f->demand = SCENE_DEMAND_SCHEDULE;
    f->arrivals = SCENE_ARRIVALS_POISSON;
    f->line[1].y = 0.3;
    f->schedule.n = 2;
    assert_true(scene_has_chance(&s, false));
    f->schedule.places = memory_alloc(2, sizeof *f->schedule.places);
    assert_false(scene_has_chance(&s, false));
    f->schedule.places[1] = (double)NAN;
    assert_true(scene_has_chance(&s, false));
    scene_fini(&s);
}

static void set_presence(scene *s, double t0, double t1, double repeat)
{
    static double times[2], values[2] = { 1.0, 0.0 };

    times[0] = t0;
    times[1] = t1;
    s->n_obstacles = 1;
    s->obstacles[0].presence = (scene_series){
        .n_times = 2, .times = times, .n_values = 2, .values = values, .repeat = repeat
    };
}

static void a_gate_that_repeats_is_a_cycle(void **state)
{
    static scene_obstacle plate;
    scene s;
    make(&s);
    assert_true(scene_regime_of(&s, false).is_constant && scene_regime_of(&s, false).cycle == 0.0);
    s.obstacles = &plate;
    set_presence(&s, 0.0, 6.0, 12.0);
    assert_true(scene_regime_of(&s, false).is_constant);
    assert_near(scene_regime_of(&s, false).cycle, 12.0, 0.0);
    s.feeds[0].arrivals = SCENE_ARRIVALS_BATCH; // of 10 by 4 parts/s: 2.5 s; 24 times are 5 cycles
    assert_near(scene_regime_of(&s, false).cycle, 60.0, 1e-12);
    s.obstacles = NULL;
    s.n_obstacles = 0;
    scene_fini(&s);
}

static void what_changes_once_does_so_before_the_warm_up_or_is_not_constant(void **state)
{
    static scene_obstacle plate;
    scene s;
    make(&s);
    s.obstacles = &plate;
    set_presence(&s, 2.0, 10.0, (double)INFINITY);
    assert_true(scene_regime_of(&s, false).is_constant);
    set_presence(&s, 2.0, 11.0, (double)INFINITY);
    assert_false(scene_regime_of(&s, false).is_constant);
    s.obstacles = NULL;
    s.n_obstacles = 0;
    s.feeds[0].end = 90.0;
    assert_false(scene_regime_of(&s, false).is_constant);
    s.feeds[0].end = (double)INFINITY;
    s.feeds[0].count = 1e6;
    assert_false(scene_regime_of(&s, false).is_constant);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_feeds_draw_is_chance),
        cmocka_unit_test(eyes_that_command_by_drawn_gaps_are_chance_of_the_density),
        cmocka_unit_test(kinds_that_are_told_apart_are_chance_of_the_density),
        cmocka_unit_test(failures_are_chance_of_both_models_unless_they_are_given),
        cmocka_unit_test(a_list_draws_what_it_does_not_give),
        cmocka_unit_test(a_gate_that_repeats_is_a_cycle),
        cmocka_unit_test(what_changes_once_does_so_before_the_warm_up_or_is_not_constant),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
