// How fast the closure `congested` is next to `dispersive`: both in turn, in one run on one thread, on cells of 5 mm,
// with the steps of the ready examples (dispersive 1.25 ms, congested automatic). Then a quarter of an arc next to a straight belt of
// its area, width and speed on cells of 1 cm, both with automatic steps; and a belt of 1000 x 600 cells on one thread and on several.
//
//     bench_congested [THREADS]
//
// Each figure is the best of several repetitions. Before it is printed, its work is checked: no mass is lost before
// cargo reaches the edge, U at the end is the known value, what leaves a belt and the queue on it are those of the exact solution,
// and threads do not change a bit.

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
static const double queue_error = 0.02;  // of the area of a queue, by what its front is wide
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

#define INNER        0.5 // of the arc, m
#define OUTER        1.1
#define ARC_SPEED    0.4 // m/s
#define ARC_DENSITY  0.5
#define ARC_DURATION 1.0 // s, when the last of the cargo has neither reached the end nor the queue

static double on_belt(const scene *s, vec2 at)
{
    (void)s;
    (void)at;
    return ARC_DENSITY;
}

static double on_arc(const scene *s, vec2 at)
{
    const double r = vec2_length(at);

    (void)s;
    return r >= INNER && r <= OUTER ? ARC_DENSITY : 0.0;
}

static void add_rail(scene *s, double radius)
{
    enum { PIECES = 45 };
    vec2 rail[PIECES + 1];

    for (int k = 0; k <= PIECES; k++) {
        const double at = 0.5 * M_PI * k / PIECES;
        rail[k] = (vec2){ radius * cos(at), radius * sin(at) };
    }
    (void)helper_scene_add_obstacle(s, rail, PIECES + 1, SCENE_SEALED);
}

// A quarter of an arc between rails, or a straight belt between walls; half full, with an open end or with a wall there.
static void make_curve_scene(scene *s, bool is_arc, bool has_queue)
{
    const double width = OUTER - INNER, length = 0.25 * M_PI * (INNER + OUTER);
    const scene_side begin = is_arc ? SCENE_SOUTH : SCENE_WEST,
                     end = is_arc ? SCENE_WEST : SCENE_EAST;

    helper_scene_belt(s, is_arc ? OUTER : length, is_arc ? OUTER : width, 0.01, NULL, 0);
    s->macro.closure = SCENE_CONGESTED;
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        s->edges[side] = SCENE_EDGE_WALL;
    s->edges[begin] = SCENE_EDGE_INFLOW;
    s->edges[end] = has_queue ? SCENE_EDGE_WALL : SCENE_EDGE_OUTFLOW;
    if (!is_arc) {
        helper_scene_add_belt(s, (vec2){ ARC_SPEED, 0.0 }, NULL, 0);
        return;
    }
    helper_scene_add_arc(s, ARC_SPEED, INNER, OUTER, 0.0, 90.0);
    add_rail(s, INNER);
    add_rail(s, OUTER);
}

// CPU seconds of a run. What passes a radius, and a straight belt of the same width, is speed times width; the shock before a wall
// moves with speed rho_0/(rho_j - rho_0).
static double time_curve(bool is_arc, bool has_queue)
{
    helper_macro_world w;

    make_curve_scene(&w.s, is_arc, has_queue);
    helper_macro_world_init(&w, is_arc ? on_arc : on_belt, 1);
    const double all = macro_measure(w.solver).mass;
    const double begin = seconds(CLOCK_PROCESS_CPUTIME_ID);
    advance(w.solver, ARC_DURATION, scene_macro_step(&w.s));
    const double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - begin;
    const double passed = ARC_DENSITY * ARC_SPEED * (OUTER - INNER) * macro_time(w.solver);
    const double left = all - macro_measure(w.solver).mass;
    if (fabs(left - (has_queue ? 0.0 : passed)) > mass_error * all)
        fail("what leaves a belt is not what passes along it");
    const double queue = passed / (w.s.macro.jam_density - ARC_DENSITY);
    if (has_queue && fabs(helper_macro_jammed_area(&w) - queue) > queue_error * queue)
        fail("the queue on a belt is not that of the shock");
    helper_macro_world_fini(&w);
    return cpu;
}

static void compare_curves(const char *name, bool has_queue)
{
    double straight = INFINITY, arc = INFINITY;

    for (int k = 0; k < REPETITIONS; k++) {
        straight = fmin(straight, time_curve(false, has_queue));
        arc = fmin(arc, time_curve(true, has_queue));
    }
    printf("%-24s straight %.4f, arc %.4f CPU s per simulated second: %.2f times\n", name,
           straight / ARC_DURATION, arc / ARC_DURATION, arc / straight);
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
    compare_curves("arc, light", false);
    compare_curves("arc, with a queue", true);
    const double one = time_large(1, &digest_one), many = time_large(n_threads, &digest_many);
    if (digest_one != digest_many)
        fail("the number of threads changes the result");
    printf("1000 x 600 cells         1 thread %.2f ms a step, %d threads %.2f ms: %.2f times as "
           "fast\n",
           1e3 * one, n_threads, 1e3 * many, one / many);
    return 0;
}
