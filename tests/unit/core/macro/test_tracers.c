// Unit tests of tracers and of the speed of cargo. Expected values are derived.

#include "core/base/digest.h"
#include "core/macro/congested/congested_priv.h"
#include "core/macro/moving_field.h"
#include "core/macro/tracers.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

#define X(suffix) extern const congested_kernels congested__kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X

static const double length = 0.6, width = 0.3, belt = 0.4, cell = 0.01; // m, m/s

// What a feed adds to the first cell of each row in a step, so that the belt carries 0.4.
static double added_to(const scene *s)
{
    return 0.4 * belt * scene_macro_step(s) / cell;
}

// Both closures by both schemes.
enum { KINDS = 4 };

// A belt, with a plate at 60 degrees that leaves 10 cm where it is to hold cargo back.
static void make_scene(scene *s, int kind, bool has_plate)
{
    static const vec2 plate[] = { { 0.3, 0.0 }, { 0.4155, 0.2 } };

    helper_scene_belt(s, length, width, cell, NULL, 0);
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->macro.closure = kind < 2 ? SCENE_CONGESTED : SCENE_DISPERSIVE;
    s->macro.scheme = kind % 2 == 0 ? SCENE_SCHEME_ROE : SCENE_SCHEME_MUSCL;
    helper_scene_add_belt(s, (vec2){ belt, 0.0 }, NULL, 0);
    helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 10.0);
    if (has_plate)
        helper_scene_add_obstacle(s, plate, 2, SCENE_SEALED);
    helper_scene_resolve(s);
}

// Fills the first cell of each row through the western side, and makes a step.
static void feed_and_step(const scene *s, macro_solver *solver, const bf_grid *g)
{
    for (size_t j = 0; j < g->n2; j++) {
        macro_add(solver, j * g->n1, added_to(s), NULL);
        macro_trace(solver, (vec2){ 0.0, grid_x2(g, j) }, added_to(s));
    }
    macro_step(solver);
}

// Of what flows evenly each tracer leaves after the time of travel, whatever upwind fluxes do to the density's front; and
// as much is told to leave as enters, to a portion.
static void what_is_carried_evenly_leaves_after_the_time_of_travel(void **state)
{
    for (int kind = 0; kind < KINDS; kind++) {
        scene s;
        make_scene(&s, kind, false);
        const bf_grid g = scene_grid(&s);
        const double travel = length / belt;
        macro_solver *solver = helper_macro_create(&s, 1);
        double left = 0.0;
        size_t n, n_inside;
        double portion;
        while (macro_time(solver) < 3.0 * travel) {
            feed_and_step(&s, solver, &g);
            const macro_exit *exits = macro_exits(solver, &n, &portion);
            for (size_t k = 0; k < n; k++)
                assert_near(exits[k].left - exits[k].entered, travel, 1e-9);
            left += portion * (double)n;
        }
        (void)macro_tracers(solver, &n_inside, &portion);
        const double entered = added_to(&s) * (double)(g.n2 * macro_steps(solver));
        assert_near(left + portion * (double)n_inside, entered, portion);
        assert_near(left, entered * 2.0 / 3.0, 0.01 * entered);
        macro_destroy(solver);
        scene_fini(&s);
    }
}

// Two belts beside each other at 0.4 and 0.1 m/s: no tracer leaves its own.
static void each_lane_has_its_own_time(void **state)
{
    static const vec2 slow[] = { { 0.0, 0.15 }, { 0.6, 0.15 }, { 0.6, 0.3 }, { 0.0, 0.3 } };

    for (int kind = 0; kind < KINDS; kind++) {
        scene s;
        size_t n, n_slow = 0, n_fast = 0;
        double portion;
        make_scene(&s, kind, false);
        helper_scene_add_belt(&s, (vec2){ 0.1, 0.0 }, slow, 4);
        helper_scene_resolve(&s);
        const bf_grid g = scene_grid(&s);
        macro_solver *solver = helper_macro_create(&s, 1);
        while (macro_time(solver) < 8.0) {
            const bool is_time = macro_time(solver) < 1.0;
            for (size_t j = 0; is_time && j < g.n2; j++) {
                macro_add(solver, j * g.n1, 0.2 * added_to(&s), NULL);
                macro_trace(solver, (vec2){ 0.0, grid_x2(&g, j) }, 0.2 * added_to(&s));
            }
            macro_step(solver);
            const macro_exit *exits = macro_exits(solver, &n, &portion);
            for (size_t k = 0; k < n; k++) {
                const double time = exits[k].left - exits[k].entered;
                n_fast += fabs(time - 1.5) < 1e-9;
                n_slow += fabs(time - 6.0) < 1e-9;
                assert_true(fabs(time - 1.5) < 1e-9 || fabs(time - 6.0) < 1e-9);
            }
        }
        (void)macro_tracers(solver, &n, &portion);
        assert_int_equal(n, 0);
        assert_true(n_slow > 5 && n_fast > 5);
        assert_true(n_slow <= n_fast + 5 && n_fast <= n_slow + 5);
        macro_destroy(solver);
        scene_fini(&s);
    }
}

// Cargo before a plate across the whole belt: what entered is there, none is behind it, and all of the queue stands.
static void tracers_stay_before_a_plate_that_leaves_no_way(void **state)
{
    static const vec2 plate[] = { { 0.3, 0.0 }, { 0.4, 0.3 } };

    for (int kind = 0; kind < KINDS; kind++) {
        scene s;
        size_t n;
        double portion;
        make_scene(&s, kind, false);
        helper_scene_add_obstacle(&s, plate, 2, SCENE_SEALED);
        helper_scene_resolve(&s);
        const bf_grid g = scene_grid(&s);
        macro_solver *solver = helper_macro_create(&s, 1);
        while (macro_time(solver) < 1.0)
            feed_and_step(&s, solver, &g);
        const double entered = added_to(&s) * (double)(g.n2 * macro_steps(solver));
        while (macro_time(solver) < 4.0) {
            macro_step(solver);
            (void)macro_exits(solver, &n, &portion);
            assert_int_equal(n, 0);
        }
        const macro_tracer *inside = macro_tracers(solver, &n, &portion);
        assert_near(portion * (double)n, entered, portion);
        for (size_t k = 0; k < n; k++) {
            const double x = cell * (inside[k].column + inside[k].at1);
            const double y = cell * (inside[k].row + inside[k].at2);
            assert_true(x < 0.3 + y / 3.0 + cell);
        }
        macro_destroy(solver);
        scene_fini(&s);
    }
}

// A million portions: at most TRACERS_MOST are inside, and stand for all of them.
static void tracers_are_bounded(void **state)
{
    scene s;
    size_t n;
    double portion;
    make_scene(&s, 0, false);
    macro_solver *solver = helper_macro_create(&s, 1);
    for (int k = 0; k < 1000000; k++)
        macro_trace(solver, (vec2){ 0.0, 0.1 }, 1.0);
    (void)macro_tracers(solver, &n, &portion);
    assert_true(n <= TRACERS_MOST && n > TRACERS_MOST / 4);
    assert_true(fabs(portion * (double)n / 1e6 - 1.0) < 0.01);
    macro_destroy(solver);
    scene_fini(&s);
}

/// A step, and all that tracers tell after it.
static uint64_t digest_of_step(const scene *s, macro_solver *solver, const bf_grid *g)
{
    double portion, speeds[256];
    size_t n;

    assert_true(g->n1 <= 256);
    feed_and_step(s, solver, g);
    const macro_exit *exits = macro_exits(solver, &n, &portion);
    uint64_t digest = digest_add(DIGEST_START, exits, n * sizeof *exits);
    for (size_t j = 0; j < g->n2; j++) {
        macro_speeds(solver, j, speeds);
        digest = digest_add(digest, speeds, g->n1 * sizeof *speeds);
    }
    const macro_tracer *inside = macro_tracers(solver, &n, &portion);
    assert_true(n > 0);
    return digest_add(digest, inside, n * sizeof *inside);
}

// Stopped at each of some steps one after the other, as tracers do not move in each.
static void threads_instruction_sets_and_stops_do_not_change_a_bit(void **state)
{
    enum { STOPS = 4, STEPS = 20 };
    static const congested_kernels *const kernels[] = {
#define X(suffix) &congested__kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    for (int kind = 0; kind < KINDS; kind++) {
        scene s;
        bf_buffer saved[STOPS] = { { 0 } };
        uint64_t digests[STOPS + STEPS];
        make_scene(&s, kind, true);
        const bf_grid g = scene_grid(&s);
        macro_solver *whole = helper_macro_create(&s, 1);
        for (int step = 0; step < 150; step++)
            feed_and_step(&s, whole, &g);
        for (int step = 0; step < STOPS + STEPS; step++) {
            if (step < STOPS)
                assert_int_equal(macro_save(whole, &saved[step], NULL), BF_OK);
            digests[step] = digest_of_step(&s, whole, &g);
        }
        for (int stop = 0; stop < STOPS; stop++) {
            for (cpu_level level = CPU_BASE; level <= cpu_best(); level++) {
                macro_solver *resumed = helper_macro_create(&s, 1 + (int)level);
                assert_int_equal(macro_load(resumed, saved[stop].bytes, saved[stop].n, NULL),
                                 BF_OK);
                if (resumed->congested != NULL)
                    resumed->congested->kernels = *kernels[level];
                for (int step = stop; step < stop + STEPS; step++)
                    assert_true(digest_of_step(&s, resumed, &g) == digests[step]);
                macro_destroy(resumed);
            }
            buffer_fini(&saved[stop]);
        }
        macro_destroy(whole);
        scene_fini(&s);
    }
}

static void lack_of_memory_is_an_error_and_nothing_leaks(void **state)
{
    scene s;
    make_scene(&s, 1, true);
    helper_macro_lack_memory(&s);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_carried_evenly_leaves_after_the_time_of_travel),
        cmocka_unit_test(each_lane_has_its_own_time),
        cmocka_unit_test(tracers_stay_before_a_plate_that_leaves_no_way),
        cmocka_unit_test(tracers_are_bounded),
        cmocka_unit_test(threads_instruction_sets_and_stops_do_not_change_a_bit),
        cmocka_unit_test(lack_of_memory_is_an_error_and_nothing_leaks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
