// How fast the macroscopic solver is, next to the direct sum as printed in the paper, in one run on
// one thread and the same work.
//
//     bench_macro [THREADS]
//
//
// Each figure is the best of several repetitions. Before a figure is printed, its work is checked: both
// solvers must give the same density, and Example 1 by the scheme roe the reference answers.

#include "core/base/cpu.h"
#include "core/base/memory.h"
#include "core/macro/macro.h"
#include "core/macro/velocity_field.h"
#include "core/scene/density.h"
#include "core/scene/placement.h"
#include "tests/reference/direct.h"
#include "tests/unit/core/helper_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    EXAMPLE_STEPS = 4800,
    DIRECT_STEPS = 15,
    DIRECT_REPETITIONS = 5,
    DENSE_STEPS = 200,
    JAM_STEPS = 600,
    REPETITIONS = 7
};

static const double reference_upstream = 11.747285; // parts with x < 0.75 m at 6 s

// Example 1 at the paper's grid, refined by a whole number in each direction, on a belt that goes on for a length.
typedef struct work {
    scene scene;
    velocity_field *field;
    macro_def def;
    double *rho;
    size_t n_cells;
} work;

static double seconds(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fail(const char *what)
{
    fprintf(stderr, "bench_macro: %s\n", what);
    exit(1);
}

static work make_work(int refinement, double length, int n_threads)
{
    work w = { 0 };
    scene_placement p = { 0 };

    helper_scene_example(&w.scene, 60.0, SCENE_SEALED);
    w.scene.obstacles[0].path[0] = (vec2){ 0.461325, 0.0 };
    w.scene.domain.x_max = length;
    w.scene.macro.cell /= refinement;
    w.scene.macro.step /= refinement;
    if (velocity_field_create(&w.scene, &w.field, NULL) != BF_OK ||
        placement_make(&w.scene, &p, NULL) != BF_OK)
        fail("no memory");
    w.n_cells = grid_cells(&w.field->grid);
    w.rho = memory_alloc(w.n_cells, sizeof *w.rho);
    if (w.rho == NULL || density_from_parts(&w.field->grid, scene_packing_density(&w.scene), 2500.0,
                                            p.poses, p.n, w.rho, NULL) != BF_OK)
        fail("no memory");
    placement_fini(&p);
    w.def = macro_def_default();
    w.def.grid = w.field->grid;
    w.def.dt = scene_macro_step(&w.scene);
    memcpy(w.def.faces, w.field->faces, sizeof w.def.faces);
    w.def.mirror[2] = w.def.mirror[3] = true;
    w.def.n_threads = n_threads;
    return w;
}

static void free_work(work *w)
{
    velocity_field_destroy(w->field);
    memory_free(w->rho);
    scene_fini(&w->scene);
}

static macro_solver *start(const work *w, const double *rho)
{
    macro_solver *s = NULL;

    if (macro_create(&w->def, &s, NULL) != BF_OK)
        fail("no solver");
    macro_set_density(s, rho);
    return s;
}

static double time_steps(macro_solver *s, int n)
{
    double begin = seconds();

    for (int k = 0; k < n; k++)
        macro_step(s);
    return seconds() - begin;
}

// Wall time of Example 1, whose outcome by the scheme roe must be the reference answer.
static double time_example(const work *w)
{
    double best = INFINITY;

    for (int k = 0; k < REPETITIONS; k++) {
        macro_solver *s = start(w, w->rho);
        best = fmin(best, time_steps(s, EXAMPLE_STEPS));
        double upstream =
            scene_packing_density(&w->scene) * macro_mass_in(s, 0, 150, 0, w->def.grid.n2);
        if (w->def.scheme == SCENE_SCHEME_ROE && fabs(upstream - reference_upstream) > 192e-6)
            fail("Example 1 does not give the reference answer");
        macro_destroy(s);
    }
    return best;
}

// Wall time of the direct sum's first steps from a density.
static double time_direct_sum(direct *d, const double *rho)
{
    direct_set_density(d, rho);
    double begin = seconds();
    for (int k = 0; k < DIRECT_STEPS; k++)
        direct_step(d);
    return seconds() - begin;
}

// Cell-steps per second of the direct sum, which must agree with the solver.
static double rate_of_direct_sum(const work *w)
{
    direct *slow = direct_create(&w->def);
    macro_solver *s = start(w, w->rho);
    double best = INFINITY;

    if (slow == NULL)
        fail("no memory");
    for (int k = 0; k < DIRECT_REPETITIONS; k++)
        best = fmin(best, time_direct_sum(slow, w->rho));
    time_steps(s, DIRECT_STEPS);
    for (size_t j = 0; j < w->def.grid.n2; j++)
        for (size_t i = 0; i < w->def.grid.n1; i++)
            if (fabs(macro_row(s, j)[i] - direct_density(slow)[j * w->def.grid.n1 + i]) > 1e-11)
                fail("the solver does not agree with the direct sum");
    macro_destroy(s);
    direct_destroy(slow);
    return (double)w->n_cells * DIRECT_STEPS / best;
}

// Cell-steps per second with rho > 1 everywhere: nothing to leave out.
static double rate_when_dense(const work *w)
{
    double *rho = memory_alloc(w->n_cells, sizeof *rho), best = INFINITY;

    if (rho == NULL)
        fail("no memory");
    for (size_t k = 0; k < w->n_cells; k++)
        rho[k] = 1.5 + 0.2 * sin(0.37 * (double)k);
    for (int k = 0; k < REPETITIONS; k++) {
        macro_solver *s = start(w, rho);
        best = fmin(best, time_steps(s, DENSE_STEPS));
        macro_destroy(s);
    }
    memory_free(rho);
    return (double)w->n_cells * DENSE_STEPS / best;
}

// Cell-steps per second of the first steps of the example on a finer grid.
static double rate_when_refined(int refinement, int n_threads, int n_steps, uint64_t *ret_digest)
{
    work w = make_work(refinement, 1.0, n_threads);
    double best = INFINITY;

    // The jam forms first, untimed; the mollifier spans more cells of a finer grid.
    w.def.mollifier *= refinement * refinement;
    macro_solver *s = start(&w, w.rho);
    time_steps(s, 1600 * refinement / 4);
    for (int k = 0; k < 3; k++)
        best = fmin(best, time_steps(s, n_steps));
    *ret_digest = macro_digest(s);
    macro_destroy(s);
    double rate = (double)w.n_cells * n_steps / best;
    free_work(&w);
    return rate;
}

// Wall time of Example 1's jam at the plate, on a belt of a length: no cargo has gone far behind the plate.
static double time_jam(double length)
{
    work w = make_work(1, length, 1);
    double best = INFINITY;

    for (int k = 0; k < REPETITIONS; k++) {
        macro_solver *s = start(&w, w.rho);
        best = fmin(best, time_steps(s, JAM_STEPS));
        macro_destroy(s);
    }
    free_work(&w);
    return best;
}

// Example 1 by the scheme muscl, in the same steps.
static void time_muscl(double wall_roe)
{
    work w = make_work(1, 1.0, 1);

    w.def.scheme = SCENE_SCHEME_MUSCL;
    rate_of_direct_sum(&w);
    double wall = time_example(&w);
    printf("Example 1 by muscl, 1 thread    %.4f s, %.2f times that of roe\n", wall,
           wall / wall_roe);
    free_work(&w);
}

int main(int argc, char **argv)
{
    const int n_threads = argc > 1 ? atoi(argv[1]) : 2;
    work w = make_work(1, 1.0, 1);
    double direct_rate = rate_of_direct_sum(&w);
    double wall = time_example(&w);
    double rate = (double)w.n_cells * EXAMPLE_STEPS / wall;
    uint64_t digest_one, digest_many;

    printf("instruction set                 %s\n", cpu_level_name(cpu_best()));
    printf("direct sum                      %.2f M cell-steps/s\n", direct_rate / 1e6);
    printf("Example 1, 1 thread             %.4f s, %.0f M cell-steps/s\n", wall, rate / 1e6);
    printf("ratio to the direct sum         %.0f\n", rate / direct_rate);
    printf("rho > 1 everywhere, 1 thread    %.0f M cell-steps/s\n", rate_when_dense(&w) / 1e6);
    free_work(&w);
    time_muscl(wall);
    printf("belt 8 times as long, 1 thread  %.2f times the time of the jam\n",
           time_jam(8.0) / time_jam(1.0));
    double one = rate_when_refined(5, 1, 200, &digest_one);
    double many = rate_when_refined(5, n_threads, 200, &digest_many);
    if (digest_one != digest_many)
        fail("the number of threads changes the result");
    printf("1000 x 600 cells, 1 thread      %.0f M cell-steps/s\n", one / 1e6);
    printf("1000 x 600 cells, %d threads     %.0f M cell-steps/s, %.2f times as fast\n", n_threads,
           many / 1e6, many / one);
    return 0;
}
