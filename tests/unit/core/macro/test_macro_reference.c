// The macroscopic solver against the direct sum as printed in the paper (tests/reference), on small
// random scenes, for each scheme, with everything in them: saturated cargo, closed faces, velocities in both directions,
// open and mirrored edges, cells that are not square, grids that fill no whole block.

#include "core/macro/macro.h"
#include "core/macro/macro_priv.h"
#include "tests/reference/direct.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_world.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LENGTH_MAX = 640, WIDTH_MAX = 80, FACES_MAX = (LENGTH_MAX + 1) * (WIDTH_MAX + 1) };

// The two sum in another order. A cell within rounding of the threshold of H would make them differ
// at once; densities are random, so none is that near in these scenes.
static const double agreement = 1e-11;

typedef struct fixture {
    macro_def def;
    double v1[FACES_MAX], v2[FACES_MAX], rho[FACES_MAX];
    uint8_t closed1[FACES_MAX], closed2[FACES_MAX];
    scene_belt belts[2];
    uint16_t belt1[FACES_MAX], belt2[FACES_MAX];
} fixture;

static double uniform(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

static void fill_faces(fixture *s)
{
    const size_t n1 = s->def.grid.n1, n2 = s->def.grid.n2;
    const double plain = uniform(-0.2, 0.4);

    for (size_t k = 0; k < (n1 + 1) * n2; k++) {
        s->v1[k] = k % (n1 + 1) < n1 / 2 ? plain : uniform(-0.4, 0.4);
        s->closed1[k] = rand() % 20 == 0;
    }
    for (size_t k = 0; k < n1 * (n2 + 1); k++) {
        s->v2[k] = k % n1 < n1 / 2 ? 0.0 : uniform(-0.4, 0.4);
        s->closed2[k] = rand() % 20 == 0;
    }
}

// A mirroring edge is a wall: all its faces are closed.
static void close_mirroring_edges(fixture *s)
{
    const size_t n1 = s->def.grid.n1, n2 = s->def.grid.n2;

    for (size_t j = 0; j < n2; j++) {
        s->closed1[j * (n1 + 1)] |= s->def.mirror[0];
        s->closed1[j * (n1 + 1) + n1] |= s->def.mirror[1];
    }
    for (size_t i = 0; i < n1; i++) {
        s->closed2[i] |= s->def.mirror[2];
        s->closed2[n2 * n1 + i] |= s->def.mirror[3];
    }
}

// Rows of more than 63 blocks need more than one word for a set of blocks.
typedef enum row_length { SHORT_ROWS, LONG_ROWS } row_length;

static fixture *random_fixture(unsigned seed, scene_scheme scheme, scene_heaviside heaviside,
                               row_length length)
{
    fixture *s = calloc(1, sizeof *s);

    assert_non_null(s);
    srand(seed);
    s->def = macro_def_default();
    s->def.grid = (bf_grid){ .n1 = (length == LONG_ROWS ? 490 : 20) + (size_t)rand() % 60,
                             .n2 = 20 + (size_t)rand() % (length == LONG_ROWS ? 10 : 60),
                             .d1 = 5e-3,
                             .d2 = uniform(4e-3, 7e-3) };
    s->def.scheme = scheme;
    s->def.heaviside = heaviside;
    s->def.dt = 1e-3;
    s->def.faces[0].v = s->v1;
    s->def.faces[1].v = s->v2;
    s->def.faces[0].closed = s->closed1;
    s->def.faces[1].closed = s->closed2;
    s->def.n_threads = 1 + rand() % 3;
    for (int side = 0; side < 4; side++)
        s->def.mirror[side] = rand() % 2 == 0;
    fill_faces(s);
    close_mirroring_edges(s);
    // A third of the columns stays empty, so that sparse rows and growing spans occur too.
    for (size_t k = 0; k < grid_cells(&s->def.grid); k++)
        s->rho[k] =
            k % s->def.grid.n1 > s->def.grid.n1 / 3 && rand() % 4 > 0 ? uniform(0.0, 1.6) : 0.0;
    return s;
}

// Belt 0 under the plain velocity, elsewhere any belt or none. They stop, stand and start within 25 ms.
static void let_belts_change(fixture *s)
{
    static double times[2][3] = { { 3e-3, 10e-3, 16e-3 }, { 0.0, 5.5e-3, 20e-3 } };
    static double factors[2][3] = { { 0.0, 0.0, 1.3 }, { 0.5, 1.5, 0.2 } };
    const size_t n1 = s->def.grid.n1, n2 = s->def.grid.n2;

    s->belts[0] = (scene_belt){ .velocity = { 0.4, 0.0 },
                                .acceleration = 60.0,
                                .deceleration = 100.0,
                                .speed_schedule = { 3, times[0], 3, factors[0] } };
    s->belts[1] = (scene_belt){ .velocity = { 0.0, 0.4 },
                                .acceleration = 50.0,
                                .deceleration = INFINITY,
                                .speed_schedule = { 3, times[1], 3, factors[1] } };
    for (size_t k = 0; k < (n1 + 1) * n2; k++)
        s->belt1[k] = (uint16_t)(k % (n1 + 1) < n1 / 2 ? 0 : rand() % 3);
    for (size_t k = 0; k < n1 * (n2 + 1); k++)
        s->belt2[k] = (uint16_t)(k % n1 < n1 / 2 ? 0 : rand() % 3);
    s->def.n_belts = 2;
    s->def.belts = s->belts;
    s->def.world = helper_world(2, s->belts, 0, NULL);
    s->def.faces[0].belt = s->belt1;
    s->def.faces[1].belt = s->belt2;
}

static void compare_with_direct_sum(fixture *s)
{
    const size_t n = grid_cells(&s->def.grid);
    double *rho = calloc(n, sizeof *rho);
    macro_solver *fast = NULL;
    direct *slow = direct_create(&s->def);

    assert_non_null(slow);
    assert_int_equal(macro_create(&s->def, &fast, NULL), BF_OK);
    macro_set_density(fast, s->rho);
    direct_set_density(slow, s->rho);
    for (int step = 0; step < 25; step++) {
        macro_step(fast);
        direct_step(slow);
    }
    helper_macro_copy(fast, rho);
    for (size_t k = 0; k < n; k++)
        assert_true(fabs(rho[k] - direct_density(slow)[k]) < agreement);
    macro_destroy(fast);
    direct_destroy(slow);
    free(rho);
    free(s);
}

static void random_scenes_agree_with_the_direct_sum_on_one_to_three_threads(void **state)
{
    for (int k = 0; k < SCENE_SCHEME_COUNT; k++) {
        const scene_scheme scheme = (scene_scheme)k;
        for (unsigned seed = 1; seed <= HELPER_AMOUNT(8, 3); seed++)
            compare_with_direct_sum(
                random_fixture(seed, scheme, SCENE_HEAVISIDE_SHARP, SHORT_ROWS));
        for (unsigned seed = 13; seed <= HELPER_AMOUNT(15, 13); seed++)
            compare_with_direct_sum(random_fixture(seed, scheme, SCENE_HEAVISIDE_SHARP, LONG_ROWS));
    }
}

static void the_other_forms_of_h_agree_with_it_on_one_to_three_threads(void **state)
{
    for (int k = 0; k < SCENE_SCHEME_COUNT; k++) {
        const scene_scheme scheme = (scene_scheme)k;
        for (unsigned seed = 21; seed <= HELPER_AMOUNT(23, 21); seed++) {
            compare_with_direct_sum(
                random_fixture(seed, scheme, SCENE_HEAVISIDE_SMOOTH, SHORT_ROWS));
            compare_with_direct_sum(random_fixture(seed, scheme, SCENE_HEAVISIDE_NONE, SHORT_ROWS));
        }
    }
}

static void belts_whose_speed_changes_agree_with_it_on_one_to_three_threads(void **state)
{
    for (int scheme = 0; scheme < SCENE_SCHEME_COUNT; scheme++) {
        for (unsigned seed = HELPER_AMOUNT(51, 54); seed <= 56; seed++) {
            fixture *s = random_fixture(seed, (scene_scheme)scheme,
                                        (scene_heaviside)(seed % SCENE_HEAVISIDE_COUNT),
                                        seed % 5 == 0 ? LONG_ROWS : SHORT_ROWS);
            let_belts_change(s);
            compare_with_direct_sum(s);
        }
    }
}

// On one thread.
static uint64_t digest_with(const fixture *s, macro_sweep_fn *sweep)
{
    macro_def def = s->def;
    macro_solver *solver = NULL;

    def.n_threads = 1;
    assert_int_equal(macro_create(&def, &solver, NULL), BF_OK);
    solver->sweep = sweep;
    macro_set_density(solver, s->rho);
    for (int step = 0; step < HELPER_AMOUNT(60, 15); step++)
        macro_step(solver);
    uint64_t digest = macro_digest(solver);
    macro_destroy(solver);
    return digest;
}

static void compare_instruction_sets(unsigned seed, scene_scheme scheme, bool is_narrow)
{
    fixture *s =
        random_fixture(seed, scheme, SCENE_HEAVISIDE_SHARP, is_narrow ? SHORT_ROWS : LONG_ROWS);
    if (seed > 32)
        let_belts_change(s);
    const uint64_t digest = digest_with(s, macro__sweep_of(scheme, CPU_BASE, is_narrow));
    for (cpu_level level = CPU_BASE; level <= cpu_best(); level++)
        assert_true(digest_with(s, macro__sweep_of(scheme, level, is_narrow)) == digest);
    free(s);
}

static void every_instruction_set_gives_the_same_bits(void **state)
{
    for (int scheme = 0; scheme < SCENE_SCHEME_COUNT; scheme++)
        for (unsigned seed = 31; seed <= 34; seed++)
            compare_instruction_sets(seed, (scene_scheme)scheme, seed % 2 != 0);
}

// The build for narrow grids against the one for any width.
static void both_builds_give_the_same_bits(void **state)
{
    for (int k = 0; k < SCENE_SCHEME_COUNT; k++) {
        const scene_scheme scheme = (scene_scheme)k;
        fixture *s = random_fixture(41, scheme, SCENE_HEAVISIDE_SHARP, SHORT_ROWS);
        assert_true(digest_with(s, macro__sweep_of(scheme, cpu_best(), false)) ==
                    digest_with(s, macro__sweep_of(scheme, cpu_best(), true)));
        free(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_scenes_agree_with_the_direct_sum_on_one_to_three_threads),
        cmocka_unit_test(the_other_forms_of_h_agree_with_it_on_one_to_three_threads),
        cmocka_unit_test(belts_whose_speed_changes_agree_with_it_on_one_to_three_threads),
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
        cmocka_unit_test(both_builds_give_the_same_bits),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
