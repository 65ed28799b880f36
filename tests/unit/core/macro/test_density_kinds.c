// Kinds of cargo in a density: their fractions are fractions, each one's mass is conserved, the density knows nothing of them. Expected
// values are derived.

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/macro/kinds_priv.h"
#include "core/macro/macro.h"
#include "core/macro/macro_priv.h"
#include "tests/unit/core/helper_congested.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

#define X(suffix) extern const kinds_kernels kinds__kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X

enum { STEPS = HELPER_AMOUNT(80, 40), KINDS = 3 };

static const scene_pose somewhere = { 0.1, 0.1, 0.0 };

static macro_solver *create(const scene *s, size_t n_kinds, int n_threads)
{
    velocity_field *f = helper_macro_field(s);
    macro_def def = helper_macro_def(s, f);
    macro_solver *solver = NULL;

    def.n_kinds = n_kinds;
    def.n_threads = n_threads;
    assert_int_equal(macro_create(&def, &solver, NULL), BF_OK);
    velocity_field_destroy(f);
    return solver;
}

// A jam before a deflector, or on a belt that runs obliquely; nothing leaves.
static void make_jam(scene *s, bool is_oblique)
{
    helper_congested_saturated(s, 60.0);
    if (is_oblique)
        s->belts[0].velocity = (vec2){ 0.35, 0.15 };
    // Cells are not square.
    s->domain.y_max += 0.4 * s->macro.cell;
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        s->edges[side] = SCENE_EDGE_WALL;
    helper_scene_resolve(s);
    assert_true(scene_grid(s).d1 != scene_grid(s).d2);
}

// Shares that differ from cell to cell, some of them 0 and 1.
static void draw_fractions(macro_solver *solver, size_t n)
{
    bf_random random;

    random_init(&random, 7);
    for (size_t cell = 0; cell < grid_cells(&solver->def.grid); cell++) {
        double fractions[KINDS] = { 0.0 }, left = 1.0;
        for (size_t k = 0; k + 1 < n; k++) {
            const double drawn = random_unit(&random);
            fractions[k] = drawn < 0.3 ? 0.0 : drawn > 0.7 ? left : drawn * left;
            left -= fractions[k];
        }
        fractions[n - 1] = left;
        macro_set_fractions(solver, cell, fractions);
    }
}

static void assert_fractions(const macro_solver *solver, size_t n)
{
    for (size_t cell = 0; cell < grid_cells(&solver->def.grid); cell++) {
        const double *fractions = macro_fractions(solver, cell);
        double sum = 0.0;
        for (size_t k = 0; k < n; k++) {
            assert_true(fractions[k] >= 0.0 && fractions[k] <= 1.0);
            sum += fractions[k];
        }
        assert_true(fabs(sum - 1.0) < 1e-14);
    }
}

static double mass_of(const macro_solver *solver, size_t kind)
{
    const bf_grid *g = &solver->def.grid;

    return macro_kind_mass_in(solver, kind, 0, g->n1, 0, g->n2);
}

static void fill(const scene *s, macro_solver *solver)
{
    helper_congested_fill(s, (scene_rect){ -0.6, 0.3, 0.02, 0.58 }, 0.6, solver);
}

static void check_jam(bool is_oblique, size_t n_kinds)
{
    scene s;
    double before[KINDS];

    make_jam(&s, is_oblique);
    macro_solver *with = create(&s, n_kinds, 1), *without = create(&s, 0, 1);
    fill(&s, with);
    fill(&s, without);
    draw_fractions(with, n_kinds);
    for (size_t k = 0; k < n_kinds; k++)
        before[k] = mass_of(with, k);
    for (int step = 0; step < STEPS; step++) {
        macro_step(with);
        macro_step(without);
        assert_fractions(with, n_kinds);
    }
    for (size_t j = 0; j < with->def.grid.n2; j++)
        assert_memory_equal(macro_row(with, j), macro_row(without, j),
                            with->def.grid.n1 * sizeof(double));
    for (size_t k = 0; k < n_kinds; k++)
        assert_true(fabs(mass_of(with, k) - before[k]) < 1e-12 * before[k]);
    macro_destroy(with);
    macro_destroy(without);
    scene_fini(&s);
}

static void each_kind_keeps_its_mass_and_the_density_its_bits(void **state)
{
    check_jam(false, 2);
    check_jam(true, 2);
    check_jam(true, 3);
}

// A belt along its cells, of which those of column i have a fraction by a function of i.
static macro_solver *start_stripes(scene *s, scene_edge east, double density, double first,
                                   double last)
{
    helper_scene_belt(s, 2.0, 0.08, 0.01, &somewhere, 1);
    s->macro.closure = SCENE_CONGESTED;
    s->edges[SCENE_EAST] = east;
    helper_scene_resolve(s);
    macro_solver *solver = create(s, 2, 1);
    helper_congested_fill(s, (scene_rect){ 0.0, 2.0, 0.0, 0.08 }, density, solver);
    const bf_grid *g = &solver->def.grid;
    for (size_t cell = 0; cell < grid_cells(g); cell++) {
        const double x = grid_x1(g, cell % g->n1);
        const bool is_second = x > first && x < last;
        macro_set_fractions(solver, cell, (double[]){ !is_second, is_second });
    }
    return solver;
}

static void a_change_of_kinds_goes_with_the_belt_and_stays_a_few_cells_wide(void **state)
{
    scene s;
    const double way = 1.0;
    macro_solver *solver = start_stripes(&s, SCENE_EDGE_OUTFLOW, 0.3, 0.2, 0.5);
    const double speed = s.belts[0].velocity.x, dt = scene_macro_step(&s);
    const int n_steps = (int)floor(way / (speed * dt));
    helper_macro_advance(solver, n_steps);
    const double moved = n_steps * dt * speed;
    size_t n_mixed = 0;
    double centre = 0.0, mass = 0.0;
    for (size_t i = 0; i < solver->def.grid.n1; i++) {
        const double fraction = macro_fractions(solver, i)[1];
        const double of = fraction * macro_row(solver, 0)[i];
        n_mixed += fraction > 0.01 && fraction < 0.99;
        centre += of * grid_x1(&solver->def.grid, i);
        mass += of;
    }
    // Its middle was at 0.35 m. Upwind, both changes were sqrt(v dx t) = 10 cells of deviation wide, of which 4.6 deviations have
    // fractions from 1 to 99 %.
    assert_true(fabs(centre / mass - (0.35 + moved)) < 0.005);
    assert_true(n_mixed <= 2 * 10);
    macro_destroy(solver);
    scene_fini(&s);
}

// A queue before a wall: as much as the belt brings is pushed back. Were both carried, 2,000 steps of half a cell would mix
// sqrt(0.5 * 2000) = 31 cells; what is left is that the pressure of a step is near that of the one before.
static void kinds_in_a_queue_that_stands_do_not_mix(void **state)
{
    scene s;
    double before[200];

    macro_solver *solver = start_stripes(&s, SCENE_EDGE_WALL, 0.93, 0.8, 1.1);
    helper_macro_advance(solver, 400);
    for (size_t i = 0; i < 200; i++)
        before[i] = macro_fractions(solver, i)[1];
    helper_macro_advance(solver, 2000);
    for (size_t i = 0; i < 200; i++)
        assert_true(fabs(macro_fractions(solver, i)[1] - before[i]) < 0.1);
    macro_destroy(solver);
    scene_fini(&s);
}

static void every_instruction_set_gives_the_same_bits(void **state)
{
    static const kinds_kernels *const builds[] = {
#define X(suffix) &kinds__kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    for (int is_oblique = 0; is_oblique < 2; is_oblique++) {
        scene s;
        uint64_t digest = 0;
        make_jam(&s, is_oblique);
        for (cpu_level level = CPU_BASE; level <= cpu_best(); level++) {
            macro_solver *solver = create(&s, KINDS, 1);
            solver->kinds->kernels = *builds[level];
            fill(&s, solver);
            draw_fractions(solver, KINDS);
            helper_macro_advance(solver, STEPS / 2);
            assert_true(level == CPU_BASE || macro_digest(solver) == digest);
            digest = macro_digest(solver);
            macro_destroy(solver);
        }
        scene_fini(&s);
    }
}

static void threads_and_a_checkpoint_change_no_bit(void **state)
{
    scene s;
    bf_buffer saved = { 0 };

    make_jam(&s, true);
    macro_solver *one = create(&s, 2, 1), *three = create(&s, 2, 3), *resumed = create(&s, 2, 2);
    fill(&s, one);
    fill(&s, three);
    draw_fractions(one, 2);
    draw_fractions(three, 2);
    helper_macro_advance(one, 20);
    helper_macro_advance(three, 20);
    assert_int_equal(macro_save(three, &saved, NULL), BF_OK);
    assert_int_equal(macro_load(resumed, saved.bytes, saved.n, NULL), BF_OK);
    helper_macro_advance(one, 10);
    helper_macro_advance(resumed, 10);
    assert_true(macro_digest(one) == macro_digest(resumed));
    assert_memory_equal(macro_fractions(one, 0), macro_fractions(resumed, 0),
                        2 * grid_cells(&one->def.grid) * sizeof(double));
    // The digest tells other fractions apart.
    const uint64_t digest = macro_digest(one);
    macro_set_fractions(one, 0, (double[]){ 0.25, 0.75 });
    assert_true(macro_digest(one) != digest);
    macro_destroy(one);
    macro_destroy(three);
    macro_destroy(resumed);
    buffer_fini(&saved);
    scene_fini(&s);
}

static void what_is_added_and_taken_has_its_kinds(void **state)
{
    scene s;

    macro_solver *solver = start_stripes(&s, SCENE_EDGE_OUTFLOW, 0.2, 5.0, 6.0);
    macro_add(solver, 10, 0.6, (double[]){ 0.5, 0.5 });
    assert_true(fabs(macro_fractions(solver, 10)[1] - 0.3 / 0.8) < 1e-15);
    macro_add(solver, 10, -0.4, NULL);
    assert_true(fabs(macro_fractions(solver, 10)[1] - 0.3 / 0.8) < 1e-15);
    // Of 0.4 there are 0.15 of the second kind, and no more can be taken.
    macro_take_kind(solver, 10, 1, 0.05);
    assert_true(fabs(macro_fractions(solver, 10)[1] - 0.1 / 0.35) < 1e-14);
    macro_take_kind(solver, 10, 1, 1.0);
    assert_true(macro_fractions(solver, 10)[1] == 0.0);
    assert_true(fabs(macro_row(solver, 0)[10] - 0.25) < 1e-14);
    macro_destroy(solver);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_kind_keeps_its_mass_and_the_density_its_bits),
        cmocka_unit_test(a_change_of_kinds_goes_with_the_belt_and_stays_a_few_cells_wide),
        cmocka_unit_test(kinds_in_a_queue_that_stands_do_not_mix),
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
        cmocka_unit_test(threads_and_a_checkpoint_change_no_bit),
        cmocka_unit_test(what_is_added_and_taken_has_its_kinds),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
