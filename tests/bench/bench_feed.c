// Benchmark of a lasting feed: many parts go through a small belt in one run of the microscopic model. Prints the time
// of a step early and late, and the memory for each part that is present. Nothing may be lost.
//
//     bench_feed [parts that are fed, default 100000 [length of the belt in m, default 0.5]]

#include "core/base/check.h"
#include "core/base/memory.h"
#include "core/run/run.h"
#include "tests/bench/resident.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PERIODS = 10 }; // of which the first and the last are compared

// What the frames say.
typedef struct progress {
    double period;  // of simulated time, s
    size_t n;       // periods that have begun
    double begin_s; // wall time
    double spent_s[PERIODS + 2];
    double most_inside;
    frame_end end;
} progress;

static double now_s(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID,
                  &t); // of one thread, so that other programs do not count
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bf_status take(void *context, const frame *f, bf_error *err)
{
    progress *l = context;

    if (f->type == FRAME_END)
        l->end = f->end;
    for (uint32_t k = 0; f->type == FRAME_CURVE && k < f->curve.n; k++) {
        l->most_inside = fmax(l->most_inside, f->curve.values[k * f->curve.n_columns]);
        while (l->n <= PERIODS && f->curve.t[k] >= (double)l->n * l->period)
            l->spent_s[l->n++] = now_s() - l->begin_s;
    }
    return BF_OK;
}

// Makes the curve arrive sample by sample.
static unsigned requested(void *context)
{
    return RUN_REPORT;
}

// A belt of 1 m/s, 0.4 m wide, with disks of 12 mm radius: 300/s are 0.37 of close packing.
static void make_scene(scene *s, double n, double length)
{
    bf_faults faults = { 0 };

    scene_init(s);
    s->domain = (scene_rect){ 0.0, length, 0.0, 0.4 };
    s->duration = n / 300.0 + 1.0 + length;
    s->macro.cell = 0.1;
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->micro.integrator = SCENE_IMPLICIT;
    s->micro.modulus_reduction = 1e4;
    s->output.curve_every = fmax(0.05, s->duration / 1e5);
    s->output.snapshot_every = s->duration;
    s->n_belts = s->n_feeds = 1;
    s->belts = memory_alloc(1, sizeof *s->belts);
    s->feeds = memory_alloc(1, sizeof *s->feeds);
    BF_CHECK(s->belts != NULL && s->feeds != NULL);
    scene_belt_init(s->belts);
    s->belts[0].velocity = (vec2){ 1.0, 0.0 };
    scene_feed_init(s->feeds);
    s->feeds[0].is_edge = true;
    s->feeds[0].edge = SCENE_WEST;
    s->feeds[0].demand = SCENE_DEMAND_RATE;
    s->feeds[0].rate = 300.0;
    s->feeds[0].count = n;
    BF_CHECK(scene_resolve(s, NULL) == BF_OK);
    scene_check(s, &faults);
    if (faults.n == 0)
        run_check(s, RUN_MICRO, &faults);
    for (size_t k = 0; k < faults_kept(&faults); k++)
        fprintf(stderr, "%s: %s\n", faults.items[k].pointer, faults.items[k].text);
    BF_CHECK(faults.n == 0);
}

int main(int n_arguments, char **arguments)
{
    const double n = n_arguments > 1 ? atof(arguments[1]) : 1e5;
    const double length = n_arguments > 2 ? atof(arguments[2]) : 0.5;
    progress l = { .begin_s = now_s() };
    const run_sink sink = { &l, take, requested };
    bf_error err = { 0 };
    run *r = NULL;
    scene s;

    make_scene(&s, n, length);
    l.period = s.duration / PERIODS;
    const double before = resident_peak_bytes();
    if (run_create(&s, RUN_MICRO, 1, &r, &err) != BF_OK || run_execute(r, &sink, &err) != BF_OK) {
        fprintf(stderr, "%s\n", err.text);
        return EXIT_FAILURE;
    }
    BF_CHECK(l.end.parts_entered == l.end.parts_end + (double)l.end.n_parts_left);
    const double per_period = (double)l.end.n_steps / PERIODS;
    printf("%.0f parts fed, %.0f at most inside, %.0f left; %llu steps in %.1f s\n",
           l.end.parts_entered, l.most_inside, (double)l.end.n_parts_left,
           (unsigned long long)l.end.n_steps, now_s() - l.begin_s);
    printf("time of a step: %.4f ms in the second tenth, %.4f ms in the ninth\n",
           1e3 * (l.spent_s[2] - l.spent_s[1]) / per_period,
           1e3 * (l.spent_s[9] - l.spent_s[8]) / per_period);
    const double grown = resident_peak_bytes() - before;
    printf("memory: %.0f kB more than before the run, %.0f bytes for each part inside\n",
           grown / 1024.0, grown / l.most_inside);
    run_destroy(r);
    scene_fini(&s);
    return EXIT_SUCCESS;
}
