// What must not change a bit of the congested closure: threads, instruction sets, a checkpoint, a pause of the belt.

#include "core/base/memory.h"
#include "core/macro/congested/congested_priv.h"
#include "core/macro/congested/half_rows.h"
#include "core/macro/macro.h"
#include "tests/unit/core/helper_congested.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

#define X(suffix) extern const congested_kernels congested__kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X

enum { STEPS = HELPER_AMOUNT(160, 80), SCENES = 4 };

// A saturated outlet, in steps of 2^-7 s; the same on a belt that runs obliquely, so that the laws of both directions are
// coupled; a belt that stops and goes by ramps, from 0.5 s on; and one that crosses another one, which stands at times.
static void make_scene(scene *s, int kind)
{
    static const vec2 west[] = { { -0.7, 0.0 }, { 0.2, 0.0 }, { 0.2, 0.6 }, { -0.7, 0.6 } };
    static const vec2 east[] = { { 0.2, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.6 }, { 0.2, 0.6 } };

    helper_congested_saturated(s, kind == 0 ? 90.0 : 60.0);
    s->macro.step = 0x1p-7;
    if (kind == 1)
        s->belts[0].velocity = (vec2){ 0.35, 0.15 };
    if (kind == 2) {
        helper_scene_schedule(&s->belts[0], 2, (double[]){ 0.5, 1.2 }, (double[]){ 0.0, 1.0 });
        s->belts[0].acceleration = s->belts[0].deceleration = 1.0;
    }
    if (kind == 3) {
        helper_scene_add_belt(s, (vec2){ 0.3, 0.1 }, west, 4);
        helper_scene_add_belt(s, (vec2){ 0.395, 0.0 }, east, 4);
        helper_scene_schedule(&s->belts[2], 2, (double[]){ 0.6, 1.1 }, (double[]){ 0.0, 1.0 });
    }
    helper_scene_resolve(s);
}

static uint64_t digest_after(macro_solver *solver, int n_steps)
{
    helper_macro_advance(solver, n_steps);
    assert_int_equal(macro_check(solver, NULL), BF_OK);
    return macro_digest(solver);
}

// From a jam on, as more threads than processors wait long for each other.
static void any_number_of_threads_gives_the_same_bits(void **state)
{
    static const int numbers[] = { 2, 3, 7 };
    const int n_steps = HELPER_AMOUNT(10, 4);

    for (int kind = 0; kind < SCENES; kind++) {
        scene s;
        bf_buffer saved = { 0 };
        make_scene(&s, kind);
        macro_solver *one = helper_macro_start(&s, 1);
        helper_macro_advance(one, 60);
        assert_int_equal(macro_save(one, &saved, NULL), BF_OK);
        const uint64_t digest = digest_after(one, n_steps);
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
            macro_solver *many = helper_macro_create(&s, numbers[k]);
            assert_int_equal(macro_load(many, saved.bytes, saved.n, NULL), BF_OK);
            assert_true(digest_after(many, n_steps) == digest);
            macro_destroy(many);
        }
        macro_destroy(one);
        buffer_fini(&saved);
        scene_fini(&s);
    }
}

static void every_instruction_set_gives_the_same_bits(void **state)
{
    static const congested_kernels *const builds[] = {
#define X(suffix) &congested__kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    for (int kind = 0; kind < SCENES; kind++) {
        scene s;
        uint64_t digest = 0;
        make_scene(&s, kind);
        for (cpu_level level = CPU_BASE; level <= cpu_best(); level++) {
            macro_solver *solver = helper_macro_start(&s, 1);
            solver->congested->kernels = *builds[level];
            const uint64_t of_build = digest_after(solver, STEPS);
            assert_true(level == CPU_BASE || of_build == digest);
            digest = of_build;
            macro_destroy(solver);
        }
        scene_fini(&s);
    }
}

// In the jam: before a belt changes its speed, in a ramp, while a belt stands, and after.
static void a_run_resumed_in_a_jam_goes_on_with_the_same_bits(void **state)
{
    static const int stops[] = { 1, 60, 75, 120, 145 };

    for (int kind = 0; kind < SCENES; kind++) {
        scene s;
        make_scene(&s, kind);
        macro_solver *whole = helper_macro_start(&s, 1);
        for (size_t k = 0; k < sizeof stops / sizeof *stops - HELPER_AMOUNT(0, 2); k++) {
            macro_solver *then = helper_macro_start(&s, 1);
            bf_buffer saved = { 0 };
            helper_macro_advance(whole, stops[k] - (int)macro_steps(whole));
            assert_int_equal(macro_save(whole, &saved, NULL), BF_OK);
            assert_int_equal(macro_load(then, saved.bytes, saved.n, NULL), BF_OK);
            assert_true(macro_steps(then) == (uint64_t)stops[k]);
            assert_true(digest_after(then, 15) == digest_after(whole, 15));
            buffer_fini(&saved);
            macro_destroy(then);
        }
        macro_destroy(whole);
        scene_fini(&s);
    }
}

// A heap that queues before a slower belt until all of it is there.
static void make_passing_queue(scene *s)
{
    static const vec2 fast[] = { { 0.0, 0.0 }, { 0.4, 0.0 }, { 0.4, 0.5 }, { 0.0, 0.5 } };
    static const vec2 slow[] = { { 0.4, 0.0 }, { 0.7, 0.0 }, { 0.7, 0.5 }, { 0.4, 0.5 } };

    helper_scene_belt(s, 0.7, 0.5, 0.01, NULL, 0);
    s->macro.closure = SCENE_CONGESTED;
    helper_scene_add_belt(s, (vec2){ 0.35, 0.1 }, fast, 4);
    helper_scene_add_belt(s, (vec2){ 0.14, 0.04 }, slow, 4);
    helper_scene_resolve(s);
}

static bool is_pressed(const macro_solver *solver)
{
    const congested *c = solver->congested;

    for (int colour = 0; colour < 2; colour++)
        for (ptrdiff_t row = 0; row < solver->n2; row++)
            for (ptrdiff_t k = 0; 2 * k < solver->n1; k++)
                if (congested__row(c, c->pressure[colour], row)[k] != 0.0F)
                    return true;
    return false;
}

static bf_buffer saved_of(const macro_solver *solver)
{
    bf_buffer saved = { 0 };

    assert_int_equal(macro_save(solver, &saved, NULL), BF_OK);
    return saved;
}

// A solver that begins with a state makes CONGESTED_PRESSED_STEPS steps as if pressures had been everywhere.
static void check_cells_far_from_pressures(const scene *s, macro_solver *solver, int n_steps)
{
    bf_buffer now = saved_of(solver);

    for (int step = 0; step < n_steps; step += CONGESTED_PRESSED_STEPS) {
        macro_solver *other = helper_macro_start(s, 1);
        assert_int_equal(macro_load(other, now.bytes, now.n, NULL), BF_OK);
        helper_macro_advance(other, CONGESTED_PRESSED_STEPS);
        helper_macro_advance(solver, CONGESTED_PRESSED_STEPS);
        buffer_fini(&now);
        now = saved_of(solver);
        bf_buffer of_other = saved_of(other);
        assert_int_equal(of_other.n, now.n);
        assert_memory_equal(of_other.bytes, now.bytes, now.n);
        buffer_fini(&of_other);
        macro_destroy(other);
    }
    buffer_fini(&now);
}

static void what_is_left_out_far_from_pressures_changes_no_bit_of_the_state(void **state)
{
    static const scene_rect heap = { 0.15, 0.38, 0.1, 0.25 };

    for (int kind = 0; kind < SCENES; kind++) {
        scene s;
        make_scene(&s, kind);
        macro_solver *solver = helper_macro_start(&s, 1);
        check_cells_far_from_pressures(&s, solver, STEPS);
        macro_destroy(solver);
        scene_fini(&s);
    }
    scene s;
    make_passing_queue(&s);
    macro_solver *solver = helper_macro_create(&s, 1);
    helper_congested_fill(&s, heap, 0.8, solver);
    check_cells_far_from_pressures(&s, solver, 45);
    assert_true(is_pressed(solver));
    check_cells_far_from_pressures(&s, solver, 45);
    assert_false(is_pressed(solver));
    macro_destroy(solver);
    scene_fini(&s);
}

static bf_status load_into(const scene *s, const bf_buffer *saved)
{
    macro_solver *solver = helper_macro_create(s, 1);
    const bf_status status = macro_load(solver, saved->bytes, saved->n, NULL);

    macro_destroy(solver);
    return status;
}

static void a_damaged_state_is_refused(void **state)
{
    scene s;
    bf_buffer saved = { 0 };

    make_scene(&s, 1);
    macro_solver *solver = helper_macro_start(&s, 1);
    helper_macro_advance(solver, 50);
    assert_int_equal(macro_save(solver, &saved, NULL), BF_OK);
    const size_t n_all = saved.n;
    for (size_t k = 0; k < n_all; k += k < 48 ? 1 : 9973) {
        saved.bytes[k] ^= 0x10;
        assert_int_equal(load_into(&s, &saved), BF_ECORRUPT);
        saved.bytes[k] ^= 0x10;
    }
    for (saved.n = 0; saved.n < n_all; saved.n += saved.n < 64 ? 1 : 9973)
        assert_int_equal(load_into(&s, &saved), BF_ECORRUPT);
    saved.n = n_all - 4;
    assert_int_equal(load_into(&s, &saved), BF_ECORRUPT);
    macro_destroy(solver);
    buffer_fini(&saved);
    scene_fini(&s);
}

static double *densities_of(const macro_solver *solver)
{
    double *rho = memory_alloc(grid_cells(&solver->def.grid), sizeof *rho);

    assert_non_null(rho);
    helper_macro_copy(solver, rho);
    return rho;
}

// A pause of 1 s, 128 steps, in the jam: cargo stands, and the run is the same later.
static void check_pause(vec2 velocity)
{
    scene with, without;

    make_scene(&with, 0);
    make_scene(&without, 0);
    with.belts[0].velocity = without.belts[0].velocity = velocity;
    helper_scene_schedule(&with.belts[0], 2, (double[]){ 1.5, 2.5 }, (double[]){ 0.0, 1.0 });
    macro_solver *late = helper_macro_start(&with, 1);
    macro_solver *early = helper_macro_start(&without, 1);
    const size_t n_bytes = grid_cells(&late->def.grid) * sizeof(double);
    helper_macro_advance(late, 192);
    helper_macro_advance(early, 192);
    double *of_early = densities_of(early);
    for (int k = 0; k < 6; k++) {
        double *of_late = densities_of(late);
        assert_memory_equal(of_late, of_early, n_bytes);
        memory_free(of_late);
        helper_macro_advance(late, k < 5 ? 25 : 3);
    }
    memory_free(of_early);
    for (int k = 0; k < 5; k++) {
        double *of_late = densities_of(late);
        of_early = densities_of(early);
        assert_memory_equal(of_late, of_early, n_bytes);
        memory_free(of_late);
        memory_free(of_early);
        helper_macro_advance(late, 16);
        helper_macro_advance(early, 16);
    }
    macro_destroy(late);
    macro_destroy(early);
    scene_fini(&with);
    scene_fini(&without);
}

static void a_stop_and_go_is_the_same_run_later(void **state)
{
    if (!HELPER_AMOUNT_IS_LESS)
        check_pause((vec2){ 0.395, 0.0 });
    check_pause((vec2){ 0.35, 0.15 });
}

static void nothing_is_lost_in_a_closed_box_whatever_the_belts_do(void **state)
{
    for (int kind = 0; kind < SCENES; kind++) {
        scene s;
        make_scene(&s, kind);
        for (int side = 0; side < SCENE_SIDE_COUNT; side++)
            s.edges[side] = SCENE_EDGE_WALL;
        macro_solver *solver = helper_macro_start(&s, 1);
        const double mass = macro_measure(solver).mass;
        for (int step = 0; step < STEPS; step++) {
            macro_step(solver);
            const macro_totals now = macro_measure(solver);
            assert_true(now.peak <= 1.1);
            assert_near(now.mass, mass, 1e-12 * mass);
        }
        macro_destroy(solver);
        scene_fini(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
        cmocka_unit_test(a_run_resumed_in_a_jam_goes_on_with_the_same_bits),
        cmocka_unit_test(what_is_left_out_far_from_pressures_changes_no_bit_of_the_state),
        cmocka_unit_test(a_damaged_state_is_refused),
        cmocka_unit_test(a_stop_and_go_is_the_same_run_later),
        cmocka_unit_test(nothing_is_lost_in_a_closed_box_whatever_the_belts_do),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
