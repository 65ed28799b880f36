// How fast the explicit microscopic solver is on a jam: disks that a belt drives against a plate.
//
//     bench_jam SCENE RESULT WARMUP STEPS REPETITIONS [THREADS]
//
// SCENE is a text: how far upstream of the plate and how wide the belt is, the belt's velocity, the
// number of parts, then the place of each; m and m/s. RESULT gets x, y, vx, vy and spin of each part
// at the end. After WARMUP steps each repetition times STEPS of them, with 1 and with THREADS threads
// in turn; both must have the same bits before anything is printed: threads, then seconds of the best
// repetition; at last the bytes that one solver takes for each part. lammps/compare.py runs this next to LAMMPS.

#include "core/base/memory.h"
#include "core/micro/micro.h"
#include "tests/bench/resident.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { TEAMS = 2 };

static const double plate_thickness = 0.005; // m

// A belt that ends at a plate, and the parts on it.
typedef struct jam {
    scene_belt belt;
    vec2 path[2];
    scene_obstacle plate;
    micro_kind kind;
    scene_pose *poses;
    size_t n;
    micro_def def; // points to what stands above
} jam;

// One solver and what it was timed at.
typedef struct team {
    micro_solver *solver;
    int n_threads;
    double best; // s
} team;

static double seconds(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fail(const char *what)
{
    fprintf(stderr, "bench_jam: %s\n", what);
    exit(1);
}

static FILE *open_file(const char *path, const char *mode)
{
    FILE *file = fopen(path, mode);

    if (file == NULL)
        fail("cannot open SCENE or RESULT");
    return file;
}

static void read_jam(const char *path, jam *ret_jam)
{
    FILE *file = open_file(path, "r");
    jam *j = ret_jam;
    double length, width;

    *j = (jam){ .def = micro_def_default() };
    if (fscanf(file, "%lf %lf %lf %lf %zu", &length, &width, &j->belt.velocity.x,
               &j->belt.velocity.y, &j->n) != 5)
        fail("SCENE has no first line");
    j->poses = memory_alloc(j->n, sizeof *j->poses);
    if (j->poses == NULL)
        fail("no memory");
    for (size_t k = 0; k < j->n; k++)
        if (fscanf(file, "%lf %lf", &j->poses[k].x, &j->poses[k].y) != 2)
            fail("SCENE ends too early");
    fclose(file);
    j->path[0] = (vec2){ length, 0.0 };
    j->path[1] = (vec2){ length, width };
    j->def.domain = (scene_rect){ 0.0, length + 2.0 * plate_thickness, 0.0, width };
}

static void define_jam(jam *j)
{
    j->plate = (scene_obstacle){ .n_points = 2, .path = j->path, .thickness = plate_thickness };
    j->kind = (micro_kind){
        .shape = { .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.008 },
        .material = { 210e9, 0.28 },
        .mass = 0.02841,
        .spin_radius = 0.0, // LAMMPS has no friction of spin on the belt
    };
    j->def.n_belts = j->def.n_obstacles = j->def.n_kinds = 1;
    j->def.belts = &j->belt;
    j->def.obstacles = &j->plate;
    j->def.kinds = &j->kind;
    j->def.n_parts = j->n;
    j->def.poses = j->poses;
}

static void advance(team *t, uint64_t n)
{
    bf_error err = { 0 };

    if (micro_advance(t->solver, n, &err) != BF_OK)
        fail(err.text);
}

// A round of every repetition for each team, so that a busy moment of the machine hits all of them.
static void time_teams(team *teams, uint64_t n_warmup, uint64_t n_steps, int n_repetitions)
{
    for (int k = 0; k < TEAMS; k++)
        advance(&teams[k], n_warmup);
    for (int r = 0; r < n_repetitions; r++) {
        for (int k = 0; k < TEAMS; k++) {
            double begin = seconds();
            advance(&teams[k], n_steps);
            teams[k].best = fmin(teams[k].best, seconds() - begin);
        }
    }
}

static void write_parts(const char *path, const micro_solver *s)
{
    FILE *file = open_file(path, "w");

    for (size_t k = 0; k < micro_parts(s); k++) {
        micro_part part = micro_part_of(s, k);
        if (part.is_gone)
            fail("a part has left the jam");
        fprintf(file, "%.10g %.10g %.10g %.10g %.10g\n", part.x[0], part.x[1], part.v[0], part.v[1],
                part.w[2]);
    }
    if (fclose(file) != 0)
        fail("cannot write RESULT");
}

int main(int argc, char **argv)
{
    jam j;
    bf_error err = { 0 };
    team teams[TEAMS] = { { .n_threads = 1, .best = INFINITY },
                          { .n_threads = argc > 6 ? atoi(argv[6]) : 2, .best = INFINITY } };

    if (argc < 6)
        fail("usage: bench_jam SCENE RESULT WARMUP STEPS REPETITIONS [THREADS]");
    read_jam(argv[1], &j);
    define_jam(&j);
    const double before = resident_bytes();
    for (int k = 0; k < TEAMS; k++) {
        j.def.n_threads = teams[k].n_threads;
        if (micro_create(&j.def, &teams[k].solver, &err) != BF_OK)
            fail(err.text);
    }
    time_teams(teams, strtoull(argv[3], NULL, 10), strtoull(argv[4], NULL, 10), atoi(argv[5]));
    const double bytes = (resident_bytes() - before) / TEAMS / (double)j.n;
    if (micro_digest(teams[0].solver) != micro_digest(teams[1].solver))
        fail("the number of threads changes the result");
    write_parts(argv[2], teams[0].solver);
    for (int k = 0; k < TEAMS; k++) {
        printf("%d %.6f\n", teams[k].n_threads, teams[k].best);
        micro_destroy(teams[k].solver);
    }
    printf("bytes %.0f\n", bytes);
    memory_free(j.poses);
    return 0;
}
