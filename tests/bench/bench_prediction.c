// Benchmark of the prediction of how long a run takes: for each scenario that is named its kind of solver, the CPU time
// that was measured and predicted, what the prediction itself took, s, and the amounts of prediction.h, as CSV.
// tests/bench/prediction.py makes scenarios, judges, and fits the costs.
//
//     bench_prediction macro|micro scenario.json...
//     bench_prediction speed                           how fast this machine is, for each kind

#include "api/scenario/scenario.h"
#include "core/base/buffer.h"
#include "core/base/check.h"
#include "core/run/prediction.h"
#include "server/base/file_io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 3 };                // of which the fastest counts
static const double speed_s = 0.03; // as the daemon does
static const double enough_s = 0.3; // of all rounds of a scenario

static double now_s(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bf_status take(void *context, const frame *f, bf_error *err)
{
    (void)context;
    (void)f;
    (void)err;
    return BF_OK;
}

static double solve(const scene *s, run_model model)
{
    const run_sink sink = { NULL, take, NULL };
    double best = INFINITY;
    bf_error err;
    run *r = NULL;

    const double first = now_s();
    for (int round = 0; round < ROUNDS && (round == 0 || now_s() < first + enough_s); round++) {
        const double begin = now_s();
        BF_CHECK(run_create(s, model, 1, &r, &err) == BF_OK);
        BF_CHECK(run_execute(r, &sink, &err) == BF_OK);
        r = run_destroy(r);
        best = fmin(best, now_s() - begin);
    }
    return best;
}

static prediction_speed measure_speed(void)
{
    prediction_speed here;

    for (int kind = 0; kind < PREDICTION_KIND_COUNT; kind++)
        BF_CHECK(prediction_measure((prediction_kind)kind, now_s, speed_s, &here.factors[kind],
                                    NULL) == BF_OK);
    return here;
}

static bool measure(const char *path, run_model model, const prediction_speed *here)
{
    bf_buffer text = { 0 };
    bf_faults faults = { 0 };
    bf_error err = { 0 };
    prediction_work work;
    scene s;

    if (file_io_read(path, NULL, UINT64_C(1) << 26, &text, &err) != BF_OK ||
        scenario_read(text.bytes, text.n, &s, &faults, &err) != BF_OK)
        return false;
    run_check(&s, model, &faults);
    if (faults.n > 0)
        return false;
    const double begin = now_s();
    BF_CHECK(prediction_work_of(&s, model, &work, &err) == BF_OK);
    const double spent = now_s() - begin;
    printf("%s,%s,%.6g,%.6g,%.6g", path, prediction_kind_words[work.kind], solve(&s, model),
           prediction_seconds(&work, here), spent);
    for (size_t i = 0; i < PREDICTION_TERM_COUNT; i++)
        printf(",%.6g", work.amounts[i]);
    printf("\n");
    fflush(stdout);
    buffer_fini(&text);
    scene_fini(&s);
    return true;
}

int main(int n_arguments, char **arguments)
{
    BF_CHECK(n_arguments > 1);
    const run_model model = strcmp(arguments[1], "micro") == 0 ? RUN_MICRO : RUN_MACRO;
    const prediction_speed here = measure_speed();
    for (int k = 0; k < PREDICTION_KIND_COUNT && strcmp(arguments[1], "speed") == 0; k++)
        printf("%s,%.4g\n", prediction_kind_words[k], here.factors[k]);
    for (int k = 2; k < n_arguments; k++) {
        if (!measure(arguments[k], model, &here))
            fprintf(stderr, "%s cannot be solved\n", arguments[k]);
    }
    return EXIT_SUCCESS;
}
