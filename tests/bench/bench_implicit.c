// How fast and how near to explicit steps the implicit ones are.
//
//     bench_implicit [space|memory]
//
// Examples 1 and 2 by the explicit method at 1e-5 s and by implicit steps: wall time of the 6 s on one
// thread and the mean distance of the outflow curves, which is checked; then part-steps per second of
// jams between walls, which no part may leave, explicit and implicit, on one thread and on all. Each time is the best
// of several.
//
// With `space` the example mixed-cargo, which moves in space, likewise: once with the explicit method in
// its own step and once with each implicit one; then jams of 1,000 boxes. With `memory` one jam of 100,000 disks and
// the memory that it takes.

#include "api/scenario/examples.h"
#include "api/scenario/scenario.h"
#include "core/base/memory.h"
#include "core/base/team.h"
#include "core/run/micro_setup.h"
#include "tests/bench/resident.h"
#include "tests/unit/core/helper_outflow.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { REPETITIONS = 7 };

static const double duration = 6.0; // s
static const double most_gap =
    0.02; // of the parts: twice what one chaotic run may stray from another

static double seconds(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fail(const char *what)
{
    fprintf(stderr, "bench_implicit: %s\n", what);
    exit(1);
}

static double time_curve(const micro_def *def, int n_repetitions, double *ret_u)
{
    double best = INFINITY;

    for (int k = 0; k < n_repetitions; k++) {
        double begin = seconds();
        helper_outflow_curve(def, duration, ret_u);
        best = fmin(best, seconds() - begin);
    }
    return best;
}

static void show_example(double angle_deg, double modulus_reduction)
{
    const double steps[] = { 0.0, 2e-4, 5e-4, 1e-3, 2e-3, 4e-3 };
    double expected[HELPER_OUTFLOW_SAMPLES], u[HELPER_OUTFLOW_SAMPLES];
    helper_outflow *e = malloc(sizeof *e);

    if (e == NULL)
        fail("no memory");
    helper_outflow_example(e, angle_deg, modulus_reduction);
    double time = time_curve(&e->def, 2, expected);
    printf("%2.0f deg, reduction %g: explicit, 0.01 ms    %7.4f s\n", angle_deg, modulus_reduction,
           time);
    e->def.integrator = MICRO_IMPLICIT;
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        e->def.dt = steps[k];
        time = time_curve(&e->def, REPETITIONS, u);
        double gap = helper_outflow_gap(u, expected);
        printf("                          implicit, %-8s   %7.4f s, gap %.2f %% of N\n",
               (const char *[]){ "chosen", "0.2 ms", "0.5 ms", "1 ms", "2 ms", "4 ms" }[k], time,
               100.0 * gap);
        if (gap > most_gap)
            fail("the curve is not that of the explicit method");
    }
    free(e);
}

// What a jam consists of, and how it is solved.
typedef struct jam {
    size_t n;
    scene_shape_type shape; // a cylinder or a box
    micro_integrator integrator;
    double dt; // s
    int n_threads;
} jam;

// Parts in hexagonal order between walls, driven east by the belt: about 6 contacts each.
static void place_jam(helper_outflow *e, scene_pose *poses, const jam *j)
{
    const double spacing = 0.024;
    const size_t columns = (size_t)ceil(sqrt((double)j->n)), rows = (j->n + columns - 1) / columns;

    helper_outflow_example(e, 60.0, 1e4);
    for (size_t k = 0; k < j->n; k++) {
        size_t row = k / columns, column = k % columns;
        poses[k].x = 0.013 + spacing * ((double)column + 0.5 * (double)(row % 2));
        poses[k].y = 0.013 + spacing * sqrt(0.75) * (double)row;
        poses[k].heading = 0.0;
    }
    if (j->shape == SCENE_BOX) // as bricks in a wall
        e->kind.shape = (scene_shape){
            .type = SCENE_BOX, .length = spacing, .width = spacing * sqrt(0.75), .height = 0.008
        };
    e->def.domain = (scene_rect){ 0.0, spacing * ((double)columns + 0.5) + 2e-3, 0.0,
                                  spacing * sqrt(0.75) * (double)rows + 5e-3 };
    for (int k = 0; k < SCENE_SIDE_COUNT; k++)
        e->def.edges[k] = SCENE_EDGE_WALL;
    e->def.n_obstacles = 0;
    e->def.n_parts = j->n;
    e->def.poses = poses;
    e->def.integrator = j->integrator;
    e->def.dt = j->dt;
    e->def.n_threads = j->n_threads;
}

static double time_jam(const micro_def *def, uint64_t n_steps, int n_repetitions,
                       double *ret_contacts)
{
    micro_solver *s = NULL;
    double best = INFINITY;

    if (micro_create(def, &s, NULL) != BF_OK || micro_advance(s, 50, NULL) != BF_OK)
        fail("the jam does not start");
    for (int k = 0; k < n_repetitions; k++) {
        double begin = seconds();
        if (micro_advance(s, n_steps, NULL) != BF_OK)
            fail("the jam fails");
        best = fmin(best, seconds() - begin);
    }
    const micro_totals totals = micro_measure(s);
    if (totals.n_parts != def->n_parts)
        fail("a part has left the jam");
    *ret_contacts = 2.0 * (double)totals.n_contacts / (double)def->n_parts;
    micro_destroy(s);
    return best;
}

static void show_jam(const jam *j, int n_repetitions)
{
    const size_t work = j->shape == SCENE_BOX ? 200000 : 4000000;
    const uint64_t n_steps = work / j->n < 1000 ? work / j->n : 1000;
    scene_pose *poses = memory_alloc(j->n, sizeof *poses);
    helper_outflow *e = malloc(sizeof *e);
    double contacts;

    if (poses == NULL || e == NULL)
        fail("no memory");
    place_jam(e, poses, j);
    const double time = time_jam(&e->def, n_steps, n_repetitions, &contacts);
    printf(
        "%7zu %s, %.1f contacts each, %s, %g ms, %d threads: %7.3f M part-steps/s, %.4g simulated "
        "s/s\n",
        j->n, j->shape == SCENE_BOX ? "boxes" : "parts", contacts,
        j->integrator == MICRO_IMPLICIT ? "implicit" : "explicit", j->dt * 1e3, j->n_threads,
        (double)(j->n * n_steps) / time * 1e-6, (double)n_steps * j->dt / time);
    memory_free(poses);
    free(e);
}

// The part of a jam's memory that grows with it.
static void show_memory(void)
{
    const jam j = { 100000, SCENE_CYLINDER, MICRO_IMPLICIT, 2e-3, 1 };
    const double before = resident_bytes();

    show_jam(&j, 1);
    printf("memory: %.0f bytes for each part\n", (resident_peak_bytes() - before) / (double)j.n);
}

static void read_mix(scene *ret_scene, micro_setup *ret_setup)
{
    const example *mix = examples_find("mixed-cargo");
    bf_faults faults = { 0 };
    bf_error err;

    if (mix == NULL || scenario_read(mix->document, mix->n, ret_scene, &faults, &err) != BF_OK ||
        micro_setup_init(ret_scene, NULL, 1, ret_setup, &err) != BF_OK)
        fail("the example cannot be read");
}

static void show_mix(void)
{
    const double steps[] = { 0.0, 2e-4, 5e-4, 1e-3 };
    double expected[HELPER_OUTFLOW_SAMPLES], u[HELPER_OUTFLOW_SAMPLES];
    micro_setup setup;
    scene s;

    read_mix(&s, &setup);
    micro_def *def = &setup.def;
    // The samples are in parts of the Examples, which have more of them.
    const double share = (double)HELPER_OUTFLOW_PARTS / (double)def->n_parts;
    double begin = seconds();
    helper_outflow_curve(def, s.duration, expected);
    printf("mixed-cargo, %zu parts, %g s: explicit, %g ms    %7.4f s\n", def->n_parts, s.duration,
           def->dt * 1e3, seconds() - begin);
    def->integrator = MICRO_IMPLICIT;
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        def->dt = steps[k];
        begin = seconds();
        helper_outflow_curve(def, s.duration, u);
        double time = seconds() - begin, gap = share * helper_outflow_gap(u, expected);
        printf("                          implicit, %-8s   %7.4f s, gap %.2f %% of N\n",
               (const char *[]){ "chosen", "0.2 ms", "0.5 ms", "1 ms" }[k], time, 100.0 * gap);
        if (gap > most_gap)
            fail("the curve is not that of the explicit method");
    }
    micro_setup_fini(&setup);
    scene_fini(&s);
}

int main(int argc, char **argv)
{
    const size_t sizes[] = { 192, 10000, 100000 };
    const jam boxes[] = { { 1000, SCENE_BOX, MICRO_VERLET, 1e-5, 1 },
                          { 1000, SCENE_BOX, MICRO_IMPLICIT, 5e-4, 1 } };

    if (argc > 1 && strcmp(argv[1], "space") == 0) {
        show_mix();
        for (size_t k = 0; k < sizeof boxes / sizeof *boxes; k++)
            show_jam(&boxes[k], 3);
        return 0;
    }
    if (argc > 1 && strcmp(argv[1], "memory") == 0) {
        show_memory();
        return 0;
    }
    show_example(60.0, 1e6);
    show_example(60.0, 1e4);
    show_example(90.0, 1e6);
    show_example(90.0, 1e4);
    for (size_t k = 0; k < 3; k++) {
        const jam jams[] = {
            { sizes[k], SCENE_CYLINDER, MICRO_VERLET, 1e-5, 1 },
            { sizes[k], SCENE_CYLINDER, MICRO_IMPLICIT, 5e-4, 1 },
            { sizes[k], SCENE_CYLINDER, MICRO_IMPLICIT, 2e-3, 1 },
            { sizes[k], SCENE_CYLINDER, MICRO_IMPLICIT, 2e-3, team_processors() },
        };
        for (size_t i = 0; i < sizeof jams / sizeof *jams; i++)
            show_jam(&jams[i], REPETITIONS);
    }
    return 0;
}
