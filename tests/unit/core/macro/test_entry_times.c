// Unit tests of the times of entry. Expected values are derived.

#include "core/base/digest.h"
#include "core/macro/congested/congested_priv.h"
#include "core/macro/entry_times.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define X(suffix) extern const congested_kernels congested__kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X
#define X(suffix) extern entry_times_carry_fn entry_times__carry_##suffix;
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

static void feed_and_step(const scene *s, macro_solver *solver, const bf_grid *g)
{
    for (size_t j = 0; j < g->n2; j++)
        macro_add(solver, j * g->n1, added_to(s), macro_time(solver));
    macro_step(solver);
}

// Of what flows evenly all has been there for the time of travel, whatever upwind fluxes do to its front.
static void what_is_carried_evenly_leaves_after_the_time_of_travel(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        scene s;
        make_scene(&s, kind, false);
        const bf_grid g = scene_grid(&s);
        const double travel = length / belt;
        macro_solver *solver = helper_macro_create(&s, 1);
        double left = 0.0;
        size_t n;
        while (macro_time(solver) < 3.0 * travel)
            feed_and_step(&s, solver, &g);
        const macro_exit *exits = macro_exits(solver, &n);
        for (size_t k = 0; k < n; k++) {
            left += exits[k].density;
            if (exits[k].density > 1e-9)
                assert_near(macro_time(solver) - exits[k].entered, travel, cell / belt);
        }
        assert_near(left, added_to(&s) * (double)g.n2, 1e-9);
        macro_destroy(solver);
        scene_fini(&s);
    }
}

// The integral of density and time of entry over the cells.
static double sum_of(const macro_solver *solver, const bf_grid *g)
{
    double sum = 0.0;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            sum += macro_row(solver, j)[i] * macro_entered(solver, j * g->n1 + i);
    return sum;
}

// To rounding by the unsplit upwind scheme, by which a cell passes on nothing that came in the same step.
static void times_are_conserved_in_a_jam_and_lie_between_those_that_mix(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        scene s;
        make_scene(&s, kind, true);
        const bf_grid g = scene_grid(&s);
        macro_solver *solver = helper_macro_create(&s, 1);
        double expected = 0.0;
        size_t n;
        for (int step = 0; step < 400; step++) {
            expected += added_to(&s) * (double)g.n2 * macro_time(solver);
            feed_and_step(&s, solver, &g);
            const macro_exit *exits = macro_exits(solver, &n);
            for (size_t k = 0; k < n; k++)
                expected -= exits[k].density * exits[k].entered;
        }
        assert_near(sum_of(solver, &g), expected, (kind == 0 ? 1e-12 : 1e-3) * expected);
        for (size_t k = 0; k < grid_cells(&g); k++) {
            assert_true(macro_entered(solver, k) >= 0.0);
            assert_true(macro_entered(solver, k) <= macro_time(solver));
        }
        macro_destroy(solver);
        scene_fini(&s);
    }
}

static uint64_t digest_after(const scene *s, macro_solver *solver, const bf_grid *g, int n_steps)
{
    uint64_t digest = DIGEST_START;
    size_t n;

    for (int step = 0; step < n_steps; step++) {
        feed_and_step(s, solver, g);
        const macro_exit *exits = macro_exits(solver, &n);
        digest = digest_add(digest, exits, n * sizeof *exits);
    }
    for (size_t k = 0; k < grid_cells(g); k++) {
        const double entered = macro_entered(solver, k);
        digest = digest_add(digest, &entered, sizeof entered);
    }
    return digest;
}

static void threads_instruction_sets_and_stops_do_not_change_a_bit(void **state)
{
    static const congested_kernels *const kernels[] = {
#define X(suffix) &congested__kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };
    static entry_times_carry_fn *const carry[] = {
#define X(suffix) entry_times__carry_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        scene s;
        bf_buffer saved = { 0 };
        make_scene(&s, kind, true);
        const bf_grid g = scene_grid(&s);
        macro_solver *whole = helper_macro_create(&s, 1);
        digest_after(&s, whole, &g, 150);
        assert_int_equal(macro_save(whole, &saved, NULL), BF_OK);
        const uint64_t digest = digest_after(&s, whole, &g, 20);
        for (cpu_level level = CPU_BASE; level <= cpu_best(); level++) {
            macro_solver *resumed = helper_macro_create(&s, 1 + (int)level);
            assert_int_equal(macro_load(resumed, saved.bytes, saved.n, NULL), BF_OK);
            resumed->entries->carry = carry[level];
            if (resumed->congested != NULL)
                resumed->congested->kernels = *kernels[level];
            assert_true(digest_after(&s, resumed, &g, 20) == digest);
            macro_destroy(resumed);
        }
        macro_destroy(whole);
        buffer_fini(&saved);
        scene_fini(&s);
    }
}

static void lack_of_memory_is_an_error_and_nothing_leaks(void **state)
{
    (void)state;
    scene s;
    make_scene(&s, 1, true);
    helper_macro_lack_memory(&s);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_carried_evenly_leaves_after_the_time_of_travel),
        cmocka_unit_test(times_are_conserved_in_a_jam_and_lie_between_those_that_mix),
        cmocka_unit_test(threads_instruction_sets_and_stops_do_not_change_a_bit),
        cmocka_unit_test(lack_of_memory_is_an_error_and_nothing_leaks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
