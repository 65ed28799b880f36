// Implicit steps next to Box2D: the same jam for the same simulated time.
//
//     bench_box2d [steps]
//
// Example 1 and enlargements of it, of stiffer disks that lie before the plate from the start. Both solvers take turns
// on one core; measured is the processor's time for making the solver and for its steps, the best of several. It is
// printed only if the outflow curves agree and no overlap is too large.
//
// With `steps` instead how far implicit steps, and Box2D's of several lengths and numbers of iterations, are from
// explicit steps: the table of README.md.

#include "core/base/memory.h"
#include "tests/bench/box2d_jam.h"
#include "tests/unit/core/helper_outflow.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { REPETITIONS = 2, SAMPLES = 20 };

// The longest with which Box2D's disks overlap no more than those of implicit steps, as `bench_box2d steps` shows.
static const box2d_step peer_step = { 2.5e-3, 8, 3 };
static const double most_overlap = 0.12; // radii
static const double most_gap = 0.05;     // between the curves, of the parts past the plate

// A jam, and what it points to.
typedef struct jam {
    helper_outflow example; // whose definition is that of the jam
    double exit;            // x where the plate ends, m
    double duration;        // s
    scene_pose *poses;      // of its parts; memory_free()
} jam;

// What a program does with it.
typedef struct outcome {
    double seconds;           // of the processor's time: there is one thread
    double overlap;           // the largest, radii
    double upstream[SAMPLES]; // of the exit: parts after each twentieth of the duration
} outcome;

static double seconds(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fail(const char *what)
{
    fprintf(stderr, "bench_box2d: %s\n", what);
    exit(1);
}

// Rows as in Example 1, each up to the plate.
static void make_jam(size_t n, double duration, jam *ret_jam)
{
    jam *j = ret_jam;
    helper_outflow *e = &j->example;
    const double scale = sqrt((double)n / HELPER_OUTFLOW_PARTS), width = 0.6 * scale; // m

    helper_outflow_example(e, 60.0, 1e4);
    const double r = e->kind.shape.radius, spacing = 1.01 * 2.0 * r,
                 row_height = spacing * sqrt(0.75);
    const size_t n_rows = (size_t)((width - 2.0 * r) / row_height) + 1;
    scene_pose *poses = memory_alloc(n, sizeof *poses);

    if (poses == NULL)
        fail("no memory");
    e->path[0] = vec2_scale(e->path[0], scale);
    e->path[1] = vec2_scale(e->path[1], scale);
    j->exit = e->path[1].x;
    j->duration = duration;
    for (size_t k = 0, site = 0; k < n; site++) {
        double row = (double)(site % n_rows), column = (double)(site / n_rows);
        double x = e->path[0].x + 0.5 * spacing * row - spacing * (column + 1.0);
        if (x < j->exit)
            poses[k++] = (scene_pose){ .x = x, .y = 1.01 * r + row_height * row };
    }
    e->def.poses = j->poses = poses;
    e->def.n_parts = n;
    // None leaves within the duration: a disk is not much faster than the belt, 0.395 m/s.
    e->def.domain = (scene_rect){ poses[n - 1].x - width, j->exit + duration + 0.5, 0.0, width };
}

static void solve(const jam *j, micro_integrator integrator, outcome *ret_outcome)
{
    micro_def def = j->example.def;
    micro_solver *s = NULL;
    bf_error err = { 0 };

    def.integrator = integrator;
    def.dt = 0.0;
    double begin = seconds();
    if (micro_create(&def, &s, &err) != BF_OK)
        fail(err.text);
    ret_outcome->seconds = seconds() - begin;
    for (int k = 0; k < SAMPLES; k++) {
        begin = seconds();
        if (micro_advance(s, (uint64_t)llround(j->duration / SAMPLES / micro_dt(s)), &err) != BF_OK)
            fail(err.text);
        ret_outcome->seconds += seconds() - begin;
        ret_outcome->upstream[k] = 0.0;
        for (size_t part = 0; part < def.n_parts; part++)
            ret_outcome->upstream[k] += micro_part_of(s, part).x[0] < j->exit;
    }
    const micro_totals totals = micro_measure(s);
    if (totals.n_parts != def.n_parts)
        fail("a part has left the belt");
    ret_outcome->overlap = totals.overlap_share;
    micro_destroy(s);
}

// The walls of the belt, and the plate, which is to the right of its path and has an end.
static void add_walls(const jam *j, box2d_jam *peer)
{
    const helper_outflow *e = &j->example;
    const scene_rect belt = e->def.domain;
    const vec2 from = e->path[0], to = e->path[1], path = vec2_sub(to, from);
    const vec2 back =
        vec2_scale((vec2){ path.y, -path.x }, e->obstacle.thickness / vec2_length(path));
    const double lower[][2] = { { belt.x_max, belt.y_min }, { belt.x_min, belt.y_min } },
                 upper[][2] = { { belt.x_min, belt.y_max }, { belt.x_max, belt.y_max } },
                 plate[][2] = { { to.x + back.x, to.y + back.y },
                                { to.x, to.y },
                                { from.x, from.y } };

    box2d_jam_add_wall(peer, 2, lower);
    box2d_jam_add_wall(peer, 2, upper);
    box2d_jam_add_wall(peer, 3, plate);
}

static box2d_jam *make_peer(const jam *j)
{
    const helper_outflow *e = &j->example;
    const scene_contact *contact = e->def.contact, *belt = &contact[SCENE_CONVEYOR_CARGO];
    const double r = e->kind.shape.radius, a = belt->friction * e->def.gravity;
    box2d_jam *peer = box2d_jam_create(&(box2d_jam_def){
        .radius = r,
        .damping = e->def.damping,
        .friction = contact[SCENE_CARGO_CARGO].friction,
        .wall_friction = contact[SCENE_HANDLING_CARGO].friction,
        .belt_velocity = { e->belt.velocity.x, e->belt.velocity.y },
        .belt_deceleration = a,
        .belt_tanh_linear = belt->tanh_linear,
        .spin_deceleration = 2.0 * a * e->kind.spin_radius / (r * r),
        .belt_tanh_spin = belt->tanh_spin,
    });

    add_walls(j, peer);
    for (size_t k = 0; k < e->def.n_parts; k++)
        box2d_jam_add_disk(peer, e->def.poses[k].x, e->def.poses[k].y);
    return peer;
}

static void solve_peer(const jam *j, const box2d_step *step, outcome *ret_outcome)
{
    const size_t n_steps = (size_t)llround(j->duration / SAMPLES / step->dt);
    double begin = seconds();
    box2d_jam *peer = make_peer(j);

    *ret_outcome = (outcome){ .seconds = seconds() - begin };
    for (int k = 0; k < SAMPLES; k++) {
        begin = seconds();
        box2d_jam_advance(peer, n_steps, step);
        ret_outcome->seconds += seconds() - begin;
        ret_outcome->upstream[k] = (double)box2d_jam_count_before(peer, j->exit);
        ret_outcome->overlap = fmax(ret_outcome->overlap, box2d_jam_overlap(peer));
    }
    ret_outcome->overlap /= j->example.kind.shape.radius;
    box2d_jam_destroy(peer);
}

static double passed(const jam *j, const outcome *o)
{
    return (double)j->example.def.n_parts - o->upstream[SAMPLES - 1];
}

// Mean over time of the difference of the curves, in parts.
static double gap(const outcome *a, const outcome *b)
{
    double sum = 0.0;

    for (int k = 0; k < SAMPLES; k++)
        sum += fabs(a->upstream[k] - b->upstream[k]) / SAMPLES;
    return sum;
}

// What both take, after they have done the same.
static void show_jam(size_t n, double duration)
{
    jam j;
    outcome ours = { .seconds = INFINITY }, peer = ours;

    make_jam(n, duration, &j);
    for (int k = 0; k < REPETITIONS; k++) {
        const double best = ours.seconds, best_peer = peer.seconds;
        solve(&j, MICRO_IMPLICIT, &ours);
        solve_peer(&j, &peer_step, &peer);
        ours.seconds = fmin(ours.seconds, best);
        peer.seconds = fmin(peer.seconds, best_peer);
    }
    if (fmax(ours.overlap, peer.overlap) > most_overlap)
        fail("disks overlap too much");
    if (gap(&ours, &peer) > most_gap * passed(&j, &ours))
        fail("the curves differ too much");
    printf("%7zu parts, %g s: beltflow %.4g, Box2D %.4g simulated s/s; overlap %.1f and %.1f %% of "
           "a radius, %g and %g "
           "parts past the plate, curves %.1f parts apart\n",
           n, duration, duration / ours.seconds, duration / peer.seconds, 100.0 * ours.overlap,
           100.0 * peer.overlap, passed(&j, &ours), passed(&j, &peer), gap(&ours, &peer));
    fflush(stdout);
    memory_free(j.poses);
}

static void show_outcome(const jam *j, const char *steps, const outcome *o, const outcome *expected)
{
    printf("%-28s overlap %4.1f %% of a radius, %g parts past the plate, curve %4.1f parts off, "
           "%7.3f s\n",
           steps, 100.0 * o->overlap, passed(j, o), gap(o, expected), o->seconds);
    fflush(stdout);
}

static void show_steps(size_t n, double duration)
{
    const box2d_step steps[] = {
        { 1.0 / 240.0, 8, 3 }, { 1.0 / 240.0, 30, 10 }, { 1.0 / 320.0, 8, 3 }, { 2.5e-3, 4, 2 },
        { 2.5e-3, 8, 3 },      { 2e-3, 4, 2 },          { 2e-3, 8, 3 },        { 1e-3, 4, 2 },
    };
    char name[80];
    jam j;
    outcome expected, o;

    make_jam(n, duration, &j);
    solve(&j, MICRO_VERLET, &expected);
    show_outcome(&j, "explicit", &expected, &expected);
    solve(&j, MICRO_IMPLICIT, &o);
    show_outcome(&j, "implicit", &o, &expected);
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        solve_peer(&j, &steps[k], &o);
        snprintf(name, sizeof name, "Box2D, %.3g ms, %d and %d", steps[k].dt * 1e3,
                 steps[k].n_velocity_iterations, steps[k].n_position_iterations);
        show_outcome(&j, name, &o, &expected);
    }
    memory_free(j.poses);
}

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "steps") == 0) {
        show_steps(10000, 0.5);
        return 0;
    }
    show_jam(192, 2.0);
    show_jam(10000, 0.5);
    show_jam(100000, 0.2);
    return 0;
}
