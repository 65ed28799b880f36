// How fast the closure `congested` is next to `dispersive`: both in turn, in one run on one thread, on cells of 5 mm,
// with the steps of the ready examples (dispersive 1.25 ms, congested automatic). Then a belt of 1000 x 600 cells on
// one thread and on several.
//
//     bench_congested [THREADS]
//
// Each figure is the best of several repetitions. Before it is printed, its work is checked: no mass is lost before
// cargo reaches the edge, U at the end is the known value, and threads do not change a bit.

#include "core/base/cpu.h"
#include "core/base/memory.h"
#include "core/macro/macro.h"
#include "tests/unit/core/helper_congested.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { REPETITIONS = 5, LARGE_STEPS = 100, LARGE_REPETITIONS = 3 };

static const double time_inside = 0.5;   // s, when no cargo has reached the eastern edge
static const double mass_error = 1e-12;  // of the mass at t = 0, by rounding
static const double curve_error = 0.001; // of U from its known value, of the mass at t = 0
static const double jam_time = 3.5; // s, when the cargo of the large belt stands before its plate

// What is timed, and U, the part of the mass before the end of the plate, at the end by both closures.
typedef struct work {
    const char *name;
    void (*set_scene)(scene *s, double angle_deg);
    double duration; // s
    double dispersive_left;
    double congested_left;
} work;

static const work works[] = {
    { "Example 1", helper_congested_example, 6.0, 0.012195, 0.036400 },
    { "saturated outlet", helper_congested_saturated, 10.0, 0.000074, 0.133985 },
};

static double seconds(clockid_t clock)
{
    struct timespec t;

    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fail(const char *what)
{
    fprintf(stderr, "bench_congested: %s\n", what);
    exit(1);
}

static scene make_scene(const work *w, scene_closure closure)
{
    scene s;

    w->set_scene(&s, 60.0);
    s.macro.closure = closure;
    s.macro.cell = 0.005;
    s.macro.step = closure == SCENE_DISPERSIVE ? 0.00125 : 0.0;
    return s;
}

static double mass_before(const macro_solver *solver, const scene *s, double x)
{
    const bf_grid g = scene_grid(s);

    return macro_mass_in(solver, 0, (size_t)lround((x - s->domain.x_min) / g.d1), 0, g.n2);
}

static void advance(macro_solver *solver, double until, double dt)
{
    while (macro_time(solver) < until - 0.5 * dt)
        macro_step(solver);
}

// CPU seconds of a run, whose mass and curve are right.
static double time_run(const work *w, scene_closure closure)
{
    const double left = closure == SCENE_DISPERSIVE ? w->dispersive_left : w->congested_left;
    scene s = make_scene(w, closure);
    macro_solver *solver = helper_macro_start(&s, 1);
    const double all = mass_before(solver, &s, s.domain.x_max), dt = scene_macro_step(&s);
    const double begin = seconds(CLOCK_PROCESS_CPUTIME_ID);

    advance(solver, time_inside, dt);
    const double inside = mass_before(solver, &s, s.domain.x_max);
    advance(solver, w->duration, dt);
    const double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - begin;
    const double part = mass_before(solver, &s, 0.75) / all;
    if (fabs(inside - all) > mass_error * all)
        fail("mass is lost");
    if (fabs(part - left) > curve_error) {
        fprintf(stderr, "bench_congested: %s: %.6f of the mass is left, not %.6f\n", w->name, part,
                left);
        exit(1);
    }
    macro_destroy(solver);
    scene_fini(&s);
    return cpu;
}

static void compare(const work *w)
{
    double dispersive = INFINITY, congested = INFINITY;

    for (int k = 0; k < REPETITIONS; k++) {
        dispersive = fmin(dispersive, time_run(w, SCENE_DISPERSIVE));
        congested = fmin(congested, time_run(w, SCENE_CONGESTED));
    }
    printf("%-24s dispersive %.4f, congested %.4f CPU s per simulated second: %.2f times\n",
           w->name, dispersive / w->duration, congested / w->duration, congested / dispersive);
}

// Example 1 with belt, plate and heap five times as large in both directions.
static scene make_large_scene(void)
{
    enum { SCALE = 5 };
    scene s = make_scene(&works[0], SCENE_CONGESTED);
    scene_obstacle *plate = &s.obstacles[0];

    s.domain.x_max *= SCALE;
    s.domain.y_max *= SCALE;
    for (size_t k = 0; k < plate->n_points; k++)
        plate->path[k] = vec2_scale(plate->path[k], SCALE);
    s.initial.n_rows *= SCALE;
    s.initial.n_columns *= SCALE;
    s.initial.first = vec2_scale(s.initial.first, SCALE);
    return s;
}

// Wall seconds of a step in the jam before the plate.
static double time_large(int n_threads, uint64_t *ret_digest)
{
    scene s = make_large_scene();
    macro_solver *solver = helper_macro_start(&s, n_threads);
    double best = INFINITY;

    advance(solver, jam_time, scene_macro_step(&s));
    for (int k = 0; k < LARGE_REPETITIONS; k++) {
        const double begin = seconds(CLOCK_MONOTONIC);
        helper_macro_advance(solver, LARGE_STEPS);
        best = fmin(best, (seconds(CLOCK_MONOTONIC) - begin) / LARGE_STEPS);
    }
    *ret_digest = macro_digest(solver);
    macro_destroy(solver);
    scene_fini(&s);
    return best;
}

int main(int argc, char **argv)
{
    const int n_threads = argc > 1 ? atoi(argv[1]) : 2;
    uint64_t digest_one, digest_many;

    printf("instruction set          %s\n", cpu_level_name(cpu_best()));
    for (size_t k = 0; k < sizeof works / sizeof *works; k++)
        compare(&works[k]);
    const double one = time_large(1, &digest_one), many = time_large(n_threads, &digest_many);
    if (digest_one != digest_many)
        fail("the number of threads changes the result");
    printf("1000 x 600 cells         1 thread %.2f ms a step, %d threads %.2f ms: %.2f times as "
           "fast\n",
           1e3 * one, n_threads, 1e3 * many, one / many);
    return 0;
}
