// Benchmark of the prediction of how long a run takes: for each scenario that is named its kind of solver, the CPU time
// that was measured, the same on the machine of the costs, what was predicted, what the prediction itself took, s, and the amounts
// of prediction.h, as CSV.
// tests/bench/prediction.py makes scenarios, judges, and fits the costs.
//
//     bench_prediction macro|micro scenario.json...
//     bench_prediction learn                           lines of kind, measured time and amounts from stdin: what is
//                                                      predicted of each before it is learned from
//     bench_prediction speed                           how fast this machine is, for each kind

#include "api/scenario/scenario.h"
#include "core/advice/prediction_learn.h"
#include "core/base/buffer.h"
#include "core/base/check.h"
#include "server/base/file_io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 3 };
static const double speed_s = 0.03; // as the daemon does
static const double enough_s = 4.0; // of all rounds of a scenario

static int compare(const void *one, const void *other)
{
    const double a = *(const double *)one, b = *(const double *)other;

    return (a > b) - (a < b);
}

static double now_s(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bf_status take(void *context, const frame *f, bf_error *err)
{
    return BF_OK;
}

// The CPU time of a run, s, the least of the rounds; and on the machine of the costs: the median of the rounds' times, each by the
// speed of this machine at that moment, which other processes change.
static double solve(const scene *s, run_model model, prediction_kind kind, double *ret_reference_s)
{
    const run_sink sink = { NULL, take, NULL };
    double references[ROUNDS], best = INFINITY;
    size_t n = 0;

    do {
        double factor;
        run *r = NULL;
        BF_CHECK(prediction_measure(kind, now_s, speed_s, &factor, NULL) == BF_OK);
        const double begin = now_s();
        BF_CHECK(run_create(s, model, 1, &r, NULL) == BF_OK);
        const bf_status status = run_execute(r, &sink, NULL);
        r = run_destroy(r);
        if (status != BF_OK)
            return NAN;
        const double seconds = now_s() - begin;
        best = fmin(best, seconds);
        references[n++] = seconds / factor;
    } while (n < ROUNDS && best * (double)(n + 1) < enough_s);
    qsort(references, n, sizeof *references, compare);
    *ret_reference_s = references[n / 2];
    return best;
}

static prediction_speed measure_speed(void)
{
    prediction_speed here = { 0 };

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
    double reference_s;
    const double seconds = solve(&s, model, work.kind, &reference_s);
    buffer_fini(&text);
    scene_fini(&s);
    if (isnan(seconds))
        return false;
    printf("%s,%s,%.6g,%.6g,%.6g,%.6g", path, prediction_kind_words[work.kind], seconds,
           reference_s, prediction_seconds(&work, here), spent);
    for (size_t i = 0; i < PREDICTION_TERM_COUNT; i++)
        printf(",%.6g", work.amounts[i]);
    printf("\n");
    fflush(stdout);
    return true;
}

static prediction_kind find_kind(const char *word)
{
    int kind = 0;

    while (kind < PREDICTION_KIND_COUNT && strcmp(prediction_kind_words[kind], word) != 0)
        kind++;
    BF_CHECK(kind < PREDICTION_KIND_COUNT);
    return (prediction_kind)kind;
}

static void learn(prediction_speed *here)
{
    static prediction_learned learned;
    char word[32];
    double seconds;

    prediction_learn_begin(&learned);
    while (scanf("%31[^,],%lf", word, &seconds) == 2) {
        prediction_work work = { .kind = find_kind(word) };
        for (size_t i = 0; i < PREDICTION_TERM_COUNT; i++)
            BF_CHECK(scanf(",%lf", &work.amounts[i]) == 1);
        BF_CHECK(scanf(" ") == 0);
        printf("%.6g\n", prediction_seconds(&work, here));
        prediction_learn(&learned, &work, seconds, here);
    }
}

int main(int n_arguments, char **arguments)
{
    BF_CHECK(n_arguments > 1);
    const run_model model = strcmp(arguments[1], "micro") == 0 ? RUN_MICRO : RUN_MACRO;
    prediction_speed here = measure_speed();
    if (strcmp(arguments[1], "learn") == 0)
        learn(&here);
    for (int k = 0; k < PREDICTION_KIND_COUNT && strcmp(arguments[1], "speed") == 0; k++)
        printf("%s,%.4g\n", prediction_kind_words[k], here.factors[k]);
    for (int k = 2; k < n_arguments; k++) {
        if (!measure(arguments[k], model, &here))
            fprintf(stderr, "%s cannot be solved\n", arguments[k]);
    }
    return EXIT_SUCCESS;
}
