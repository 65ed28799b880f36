// Unit tests of the macroscopic solver. Expected values are derived, never recorded.

#include "core/base/memory.h"
#include "core/macro/macro.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N1 = 60, N2 = 24, CELLS = N1 * N2, FACES1 = (N1 + 1) * N2, FACES2 = N1 * (N2 + 1) };

static const double belt = 0.395; // m/s
static const double edge = 5e-3;  // m

// A belt of N1 x N2 cells, carried along x1, with walls along both long edges. The arrays live here
// so that tests can change faces before they create the solver.
typedef struct world {
    macro_def def;
    double v1[FACES1], v2[FACES2], rho[CELLS];
    uint8_t closed1[FACES1], closed2[FACES2];
} world;

static world *make_world(void)
{
    world *w = calloc(1, sizeof *w);

    assert_non_null(w);
    w->def = macro_def_default();
    w->def.grid = (bf_grid){ .n1 = N1, .n2 = N2, .d1 = edge, .d2 = edge };
    w->def.faces[0].v = w->v1;
    w->def.faces[1].v = w->v2;
    w->def.faces[0].closed = w->closed1;
    w->def.faces[1].closed = w->closed2;
    for (int k = 0; k < FACES1; k++)
        w->v1[k] = belt;
    for (int k = 0; k < N1; k++)
        w->closed2[k] = w->closed2[FACES2 - N1 + k] = 1;
    return w;
}

static world *make_world_of(scene_scheme scheme)
{
    world *w = make_world();

    w->def.scheme = scheme;
    return w;
}

// Fills the block i_min <= i < i_max, j_min <= j < j_max with density rho.
static void fill(world *w, int i_min, int i_max, int j_min, int j_max, double rho)
{
    for (int j = j_min; j < j_max; j++)
        for (int i = i_min; i < i_max; i++)
            w->rho[j * N1 + i] = rho;
}

static macro_solver *start(const world *w)
{
    return helper_macro_start_with(&w->def, w->rho);
}

// Mean x1 of the mass, m.
static double centre(const macro_solver *s)
{
    double mass = 0.0, moment = 0.0;

    for (size_t j = 0; j < N2; j++)
        for (size_t i = 0; i < N1; i++) {
            mass += macro_row(s, j)[i];
            moment += macro_row(s, j)[i] * ((double)i + 0.5) * edge;
        }
    return moment / mass;
}

// Upwinding moves the first moment by exactly v dt a step while nothing is saturated.
static void loose_cargo_rides_the_belt(void **state)
{
    world *w = make_world();
    fill(w, 8, 16, 4, 20, 0.6);
    macro_solver *s = start(w);
    double before = centre(s);
    helper_macro_advance(s, 40);
    assert_true(fabs(centre(s) - before - belt * 40 * w->def.dt) < 1e-12);
    macro_destroy(s);
    free(w);
}

// With dt = dx/v and no dispersion the upwind scheme shifts by exactly one cell a step.
static void a_step_of_one_cell_shifts_the_density_exactly(void **state)
{
    world *w = make_world();
    w->def.dispersion = 0.0;
    w->def.dt = 0.25;
    for (int k = 0; k < FACES1; k++)
        w->v1[k] = 0.02; // dt v / dx = 1 without rounding: 0.25 * 0.02 = 0.005
    for (int k = 0; k < CELLS; k++)
        w->rho[k] = k % N1 < 20 ? 0.25 * (k % 3) : 0.0;
    macro_solver *s = start(w);
    helper_macro_advance(s, 7);
    for (size_t j = 0; j < N2; j++)
        for (size_t i = 0; i < N1; i++) {
            double expected = i < 7 ? 0.0 : w->rho[j * N1 + i - 7];
            assert_true(fabs(macro_row(s, j)[i] - expected) < 1e-15);
        }
    macro_destroy(s);
    free(w);
}

// The largest relative drift of mass that rounding may cause over some hundred steps.
static const double mass_slack = 1e-12;

static void close_column(world *w, int column, int j_max)
{
    for (int j = 0; j < j_max; j++)
        w->closed1[j * (N1 + 1) + column] = 1;
}

static void check_wall(scene_scheme scheme)
{
    world *w = make_world_of(scheme);
    // Below the bound of positivity of every scheme.
    w->def.dt = 1e-3;
    close_column(w, 30, N2);
    fill(w, 6, 26, 2, 22, 1.2);
    macro_solver *s = start(w);
    double before = macro_measure(s).mass;
    helper_macro_advance(s, 600);
    for (size_t j = 0; j < N2; j++)
        for (size_t i = 0; i < N1; i++) {
            double rho = macro_row(s, j)[i];
            assert_true(i < 30 ? rho >= 0.0 : rho == 0.0);
        }
    assert_true(fabs(macro_measure(s).mass - before) <= mass_slack * before);
    assert_true(macro_mass_in(s, 30, N1, 0, N2) == 0.0);
    macro_destroy(s);
    free(w);
}

static void a_wall_holds_saturated_cargo_and_nothing_leaks(void **state)
{
    for (int scheme = 0; scheme < SCENE_SCHEME_COUNT; scheme++)
        check_wall((scene_scheme)scheme);
}

// Below dt = dx / (2 (eps + |v|)) no cell can lose more than it has in either sweep.
static void density_stays_positive_below_the_bound(void **state)
{
    world *w = make_world();
    close_column(w, 40, 16);
    w->def.dt = 0.999 * edge / (2.0 * (w->def.dispersion + belt));
    srand(7);
    for (int k = 0; k < CELLS; k++)
        w->rho[k] = k % N1 < 38 ? 3.0 * rand() / RAND_MAX : 0.0;
    macro_solver *s = start(w);
    for (int k = 0; k < 300; k++) {
        macro_step(s);
        for (size_t j = 0; j < N2; j++)
            for (size_t i = 0; i < N1; i++)
                assert_true(macro_row(s, j)[i] >= 0.0);
    }
    macro_destroy(s);
    free(w);
}

static void check_mass(scene_scheme scheme)
{
    for (int heaviside = 0; heaviside < SCENE_HEAVISIDE_COUNT; heaviside++) {
        world *w = make_world_of(scheme);
        close_column(w, 0, N2);
        close_column(w, N1, N2);
        w->def.heaviside = (scene_heaviside)heaviside;
        for (int side = 0; side < 4; side++)
            w->def.mirror[side] = true;
        fill(w, 20, 50, 3, 20, 1.4);
        macro_solver *s = start(w);
        double before = macro_measure(s).mass;
        helper_macro_advance(s, 400);
        assert_true(fabs(macro_measure(s).mass - before) <= mass_slack * before);
        macro_destroy(s);
        free(w);
    }
}

static void mass_is_conserved_in_a_closed_box_for_every_heaviside(void **state)
{
    for (int scheme = 0; scheme < SCENE_SCHEME_COUNT; scheme++)
        check_mass((scene_scheme)scheme);
}

// The scene is symmetric about the middle row, and so must the density be, to the bit: the mollifier's
// integral weights are symmetric, but gradient weights extend one cell further on one side, so only the
// static part is exactly symmetric.
static void check_symmetry(scene_scheme scheme)
{
    world *w = make_world_of(scheme);
    for (int j = 0; j < N2; j++)
        for (int i = 0; i < 20; i++)
            w->rho[j * N1 + i] =
                0.9 * exp(-0.01 * (i - 10) * (i - 10)) * exp(-0.02 * (j - 11.5) * (j - 11.5));
    macro_solver *s = start(w);
    helper_macro_advance(s, 100);
    for (size_t j = 0; j < N2 / 2; j++)
        assert_memory_equal(macro_row(s, j), macro_row(s, N2 - 1 - j), N1 * sizeof(double));
    macro_destroy(s);
    free(w);
}

static void transported_density_stays_symmetric(void **state)
{
    for (int scheme = 0; scheme < SCENE_SCHEME_COUNT; scheme++)
        check_symmetry((scene_scheme)scheme);
}

// L1 error of a smooth profile after a fixed time on a belt of n cells; the exact answer is the
// profile shifted by v t.
static double advection_error(size_t n)
{
    const double length = 1.0, t_end = 0.5;
    macro_def def = macro_def_default();
    macro_solver *s = NULL;
    double *v1 = calloc(n + 1, sizeof *v1), *rho = calloc(n, sizeof *rho);
    double error = 0.0;

    def.grid = (bf_grid){ .n1 = n, .n2 = 1, .d1 = length / (double)n, .d2 = length / (double)n };
    def.dispersion = 0.0;
    def.mollifier = 1e6;
    def.dt = 0.5 * def.grid.d1 / belt;
    size_t n_steps = (size_t)lround(t_end / def.dt);
    for (size_t k = 0; k <= n; k++)
        v1[k] = belt;
    def.faces[0].v = v1;
    for (size_t i = 0; i < n; i++)
        rho[i] = 0.8 * exp(-200.0 * pow(grid_x1(&def.grid, i) - 0.35, 2));
    assert_int_equal(macro_create(&def, &s, NULL), BF_OK);
    macro_set_density(s, rho);
    helper_macro_advance(s, (int)n_steps);
    for (size_t i = 0; i < n; i++) {
        double exact =
            0.8 * exp(-200.0 * pow(grid_x1(&def.grid, i) - 0.35 - belt * macro_time(s), 2));
        error += fabs(macro_row(s, 0)[i] - exact) * def.grid.d1;
    }
    macro_destroy(s);
    free(v1);
    free(rho);
    return error;
}

static void smooth_density_is_carried_with_first_order(void **state)
{
    double coarse = advection_error(800), fine = advection_error(1600);

    assert_true(log2(coarse / fine) >= 0.9);
}

static uint64_t digest_after(world *w, int n_steps)
{
    macro_solver *s = start(w);
    helper_macro_advance(s, n_steps);
    uint64_t digest = macro_digest(s);
    macro_destroy(s);
    return digest;
}

static void check_threads(scene_scheme scheme)
{
    static const int numbers[] = {
        2, 5, 40
    }; // of 24 rows: one that divides, one that does not, too many

    for (int heaviside = 0; heaviside < SCENE_HEAVISIDE_COUNT; heaviside++) {
        world *w = make_world_of(scheme);
        w->def.heaviside = (scene_heaviside)heaviside;
        close_column(w, 40, 16);
        fill(w, 5, 38, 1, 23, 1.3);
        uint64_t digest = digest_after(w, 60);
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
            w->def.n_threads = numbers[k];
            assert_true(digest_after(w, 60) == digest);
        }
        free(w);
    }
}

static void any_number_of_threads_gives_the_same_bits(void **state)
{
    for (int scheme = 0; scheme < SCENE_SCHEME_COUNT; scheme++)
        check_threads((scene_scheme)scheme);
}

static void check_resuming(scene_scheme scheme)
{
    world *w = make_world_of(scheme);
    close_column(w, 40, 16);
    fill(w, 5, 38, 1, 23, 1.3);
    macro_solver *undisturbed = start(w), *resumed = NULL;
    bf_buffer saved = { 0 };
    helper_macro_advance(undisturbed, 77);
    assert_int_equal(macro_save(undisturbed, &saved, NULL), BF_OK);
    helper_macro_advance(undisturbed, 123);
    assert_int_equal(macro_create(&w->def, &resumed, NULL), BF_OK);
    assert_int_equal(macro_load(resumed, saved.bytes, saved.n, NULL), BF_OK);
    assert_true(macro_steps(resumed) == 77);
    helper_macro_advance(resumed, 123);
    assert_true(macro_digest(resumed) == macro_digest(undisturbed));
    macro_destroy(undisturbed);
    macro_destroy(resumed);
    buffer_fini(&saved);
    free(w);
}

static void a_saved_solver_goes_on_with_the_same_bits(void **state)
{
    for (int scheme = 0; scheme < SCENE_SCHEME_COUNT; scheme++)
        check_resuming((scene_scheme)scheme);
}

static bf_status load_into(const world *w, const bf_buffer *saved)
{
    macro_solver *s = NULL;

    assert_int_equal(macro_create(&w->def, &s, NULL), BF_OK);
    bf_status status = macro_load(s, saved->bytes, saved->n, NULL);
    macro_destroy(s);
    return status;
}

static void a_damaged_state_is_refused(void **state)
{
    world *w = make_world();
    fill(w, 5, 38, 1, 23, 1.3);
    macro_solver *s = start(w);
    bf_buffer saved = { 0 };
    helper_macro_advance(s, 3);
    assert_int_equal(macro_save(s, &saved, NULL), BF_OK);
    for (size_t k = 0; k < saved.n; k += k < 48 ? 1 : 997) {
        saved.bytes[k] ^= 0x10;
        assert_int_equal(load_into(w, &saved), BF_ECORRUPT);
        saved.bytes[k] ^= 0x10;
    }
    saved.n -= 8;
    assert_int_equal(load_into(w, &saved), BF_ECORRUPT);
    saved.n = 5;
    assert_int_equal(load_into(w, &saved), BF_ECORRUPT);
    macro_destroy(s);
    buffer_fini(&saved);
    free(w);
}

// A block of saturated cells disperses in both directions, as grad(eta * rho) demands.
static void saturated_cargo_spreads_on_a_standing_belt(void **state)
{
    world *w = make_world();
    memset(w->v1, 0, sizeof w->v1);
    fill(w, 28, 32, 8, 16, 1.5);
    macro_solver *s = start(w);
    helper_macro_advance(s, 20);
    assert_true(macro_row(s, 12)[27] > 0.0);
    assert_true(macro_row(s, 12)[32] > 0.0);
    assert_true(macro_row(s, 7)[30] > 0.0);
    assert_true(macro_row(s, 16)[30] > 0.0);
    assert_true(macro_measure(s).peak < 1.5);
    macro_destroy(s);
    free(w);
}

// Face states lie between those of cells, so that none of them is saturated either.
static void check_loose_cargo(scene_scheme scheme)
{
    world *w = make_world_of(scheme);
    memset(w->v1, 0, sizeof w->v1);
    fill(w, 28, 32, 8, 16, nextafter(1.0, 0.0));
    macro_solver *s = start(w);
    helper_macro_advance(s, 20);
    for (size_t j = 0; j < N2; j++)
        assert_memory_equal(macro_row(s, j), w->rho + j * N1, N1 * sizeof(double));
    macro_destroy(s);
    free(w);
}

static void cargo_below_close_packing_does_not_disperse(void **state)
{
    for (int scheme = 0; scheme < SCENE_SCHEME_COUNT; scheme++)
        check_loose_cargo((scene_scheme)scheme);
}

static void an_unstable_step_is_refused(void **state)
{
    world *w = make_world();
    macro_solver *s = NULL;
    bf_error err = { 0 };
    w->def.dt = 1.01 * edge / (belt + w->def.dispersion);
    assert_int_equal(macro_create(&w->def, &s, &err), BF_EINPUT);
    assert_string_equal(err.pointer, "/macro/step_s");
    assert_null(s);
    free(w);
}

static void out_of_memory_anywhere_is_an_error_and_nothing_leaks(void **state)
{
    world *w = make_world();
    macro_solver *s = NULL;
    bf_status status = BF_ENOMEM;
    size_t n = 0;
    w->def.n_threads = 2;
    w->def.scheme = SCENE_SCHEME_MUSCL; // needs all that the other one does, and more
    while (status != BF_OK) {
        memory_plan_fault(++n, 0);
        status = macro_create(&w->def, &s, NULL);
        assert_true(status == BF_OK ? s != NULL : status == BF_ENOMEM && s == NULL);
    }
    memory_plan_fault(0, 0);
    assert_true(n > 10);
    macro_destroy(s);
    assert_null(macro_destroy(NULL));
    free(w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loose_cargo_rides_the_belt),
        cmocka_unit_test(a_step_of_one_cell_shifts_the_density_exactly),
        cmocka_unit_test(a_wall_holds_saturated_cargo_and_nothing_leaks),
        cmocka_unit_test(density_stays_positive_below_the_bound),
        cmocka_unit_test(mass_is_conserved_in_a_closed_box_for_every_heaviside),
        cmocka_unit_test(transported_density_stays_symmetric),
        cmocka_unit_test(smooth_density_is_carried_with_first_order),
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(a_saved_solver_goes_on_with_the_same_bits),
        cmocka_unit_test(a_damaged_state_is_refused),
        cmocka_unit_test(saturated_cargo_spreads_on_a_standing_belt),
        cmocka_unit_test(cargo_below_close_packing_does_not_disperse),
        cmocka_unit_test(an_unstable_step_is_refused),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error_and_nothing_leaks),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
