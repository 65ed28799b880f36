#include "server/cli/cmd.h"

#include "api/json/number.h"
#include "api/results/results.h"
#include "api/results/run_verdict.h"
#include "api/scenario/scenario.h"
#include "core/run/run.h"
#include "server/base/clock.h"
#include "server/cli/progress_bar.h"
#include "server/cli/results_dir.h"
#include "server/run/run_control.h"

#include <argp.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { REPORT_MS = 100, THREADS_MAX = 256, KEY_OUT = 'o', KEY_THREADS = 'j' };

typedef struct solve_arguments {
    cmd_subject subject;
    const char *out;
    int n_threads;
} solve_arguments;

// One run being solved: where its frames go, and what is known from them.
typedef struct solving {
    const solve_arguments *arguments;
    scene scene;
    bf_buffer columns;
    bf_buffer document; // the resolved scenario
    results_dir *results;
    progress_bar bar;
    run_control run_control;
    frame_begin begin;
    frame_end end;
    double figures_t;
    bf_buffer figures;  // values of the newest FRAME_FIGURES
    double first_count; // of the curve's first column
    double last_count;
    double wall_s;
} solving;

static bf_status on_frame(void *context, const frame *f, bf_error *err)
{
    solving *s = context;

    switch (f->type) {
    case FRAME_BEGIN:
        s->begin = f->begin;
        break;
    case FRAME_CURVE:
        if (f->curve.n > 0 && f->curve.first == 0)
            s->first_count = f->curve.values[0];
        if (f->curve.n > 0)
            s->last_count = f->curve.values[(size_t)(f->curve.n - 1) * f->curve.n_columns];
        break;
    case FRAME_PROGRESS:
        progress_bar_show(&s->bar, &f->progress);
        break;
    case FRAME_FIGURES:
        s->figures_t = f->figures.t;
        s->figures.n = 0;
        if (buffer_append(&s->figures, f->figures.values,
                          f->figures.n * sizeof *f->figures.values) != BF_OK)
            return bf_fail(err, BF_ENOMEM, "", "no memory for key figures");
        break;
    case FRAME_END:
        s->end = f->end;
        break;
    default:
        break;
    }
    return results_dir_take(s->results, f, err);
}

static unsigned find_requested(void *context)
{
    solving *s = context;

    return run_control_requested(&s->run_control);
}

static bf_status execute(solving *s, bf_error *err)
{
    run *r = NULL;
    run_sink sink = { .context = s, .on_frame = on_frame, .requested = find_requested };

    bf_status status =
        run_create(&s->scene, s->arguments->subject.model, s->arguments->n_threads, &r, err);
    if (status == BF_OK)
        status = results_dir_open(s->arguments->out, s->columns.bytes, &s->results, err);
    if (status == BF_OK)
        status = results_dir_scenario(s->results, s->document.bytes, s->document.n, err);
    if (status == BF_OK) {
        double start_s = clock_monotonic_s();
        s->bar = progress_bar_start();
        status = run_execute(r, &sink, err);
        progress_bar_end(&s->bar);
        s->wall_s = clock_monotonic_s() - start_s;
    }
    run_destroy(r);
    return status;
}

static bf_status finish(solving *s, bf_error *err)
{
    const results_timing timing = { .wall_s = s->wall_s,
                                    .n_threads = (uint32_t)s->arguments->n_threads };
    const key_figures figures = { .columns = s->columns.bytes,
                                  .t = s->figures_t,
                                  .n = s->figures.n / sizeof(double),
                                  .values = (const double *)(const void *)s->figures.bytes };
    bf_buffer summary = { 0 };

    if (s->end.stopped)
        return results_dir_finish(s->results, NULL, 0, err);
    bf_status status =
        results_summary(s->arguments->subject.model, s->document.bytes, s->document.n, &s->begin,
                        &s->end, &figures, &timing, &summary, err);
    if (status == BF_OK)
        status = results_dir_finish(s->results, summary.bytes, summary.n, err);
    buffer_fini(&summary);
    return status;
}

// How often belts whose speed changes stood, and failed.
static void print_stops(const solving *s)
{
    const double *values = (const double *)(const void *)s->figures.bytes;

    for (size_t k = 0; k < figure_items(&s->scene, FIGURE_OF_BELT); k++) {
        const double *stopped = &values[figure_at(&s->scene, FIGURE_STOPPED_COUNT, k)];
        if (!isnan(stopped[0]))
            printf("  stops        of '%s': %.0f, %.6g s in all, %.6g s at most\n",
                   figure_item_id(&s->scene, FIGURE_OF_BELT, k), stopped[0], stopped[1],
                   stopped[2]);
        if (!isnan(stopped[FIGURE_AVAILABILITY - FIGURE_STOPPED_COUNT]))
            printf("  availability of '%s': %.6g\n", figure_item_id(&s->scene, FIGURE_OF_BELT, k),
                   stopped[FIGURE_AVAILABILITY - FIGURE_STOPPED_COUNT]);
    }
    for (size_t k = 0; k < figure_items(&s->scene, FIGURE_OF_FAILURE); k++) {
        const double *failed = &values[figure_at(&s->scene, FIGURE_FAILED_COUNT, k)];
        if (!isnan(failed[0]))
            printf("  failures     of '%s': %.0f, %.6g s in all\n",
                   figure_item_id(&s->scene, FIGURE_OF_FAILURE, k), failed[0], failed[1]);
    }
}

// What leaves counters and outlets, and what sinks take, in the long run.
static void print_flows(const solving *s)
{
    static const figure_id flows[] = { FIGURE_FLOW, FIGURE_OUTFLOW, FIGURE_SINK_FLOW };
    const double *values = (const double *)(const void *)s->figures.bytes;

    for (size_t i = 0; i < sizeof flows / sizeof *flows; i++) {
        const figure_scope scope = figure_table[flows[i]].scope;
        for (size_t k = 0; k < figure_items(&s->scene, scope); k++) {
            const double *flow = &values[figure_at(&s->scene, flows[i], k)];
            if (isnan(flow[0]))
                continue;
            printf("  flow         %s '%s': %.6g", scope == FIGURE_OF_SINK ? "taken by" : "out of",
                   figure_item_id(&s->scene, scope, k), flow[0]);
            if (!isnan(flow[1]))
                printf(" ± %.3g", flow[1]);
            printf(" parts/h\n");
        }
    }
}

static void print_result(const solving *s)
{
    const frame_end *e = &s->end;
    size_t n_id = strcspn(s->columns.bytes, ",");

    printf("%s%s%s model, %g s in %llu steps%s\n", s->scene.name, s->scene.name[0] ? ": " : "",
           run_model_words[s->arguments->subject.model], e->t, (unsigned long long)e->n_steps,
           e->stopped ? " (interrupted)" : "");
    if (s->scene.n_feeds > 0)
        printf("  parts        %.3f entered, %.3f inside, %.3f left the domain\n", e->parts_entered,
               e->parts_end,
               run_left(e->parts_start + e->parts_entered, e->parts_end, e->parts_fallen));
    else
        printf("  parts left   %.3f of %.3f in '%.*s', %.3f of %.3f in the domain\n", s->last_count,
               s->first_count, (int)n_id, s->columns.bytes, e->parts_end, e->parts_start);
    if (s->scene.may_drop)
        printf("  fallen       %.3f parts fell off the belts\n", e->parts_fallen);
    print_stops(s);
    print_flows(s);
    // Work in the model's own measure.
    bool has_parts = s->begin.n_values > 0;
    double n = has_parts ? (double)s->begin.n_parts : (double)s->end.n_cells;
    double work = n * (double)s->end.n_steps;
    printf("  time         %.3f s with %d thread%s", s->wall_s, s->arguments->n_threads,
           s->arguments->n_threads == 1 ? "" : "s");
    // The number of parts of feeds changes.
    if (!frame_has_ids(s->begin.n_values))
        printf(", %.3g %s-steps/s", s->wall_s > 0.0 ? work / s->wall_s : 0.0,
               has_parts ? "particle" : "cell");
    putchar('\n');
    if (has_parts)
        printf("  overlap      at most %.3g mm, %.3g %% of a radius\n",
               1000.0 * s->end.largest_overlap, 100.0 * s->end.overlap_share);
    printf("  results      %s (%llu samples, %llu snapshots)\n", s->arguments->out,
           (unsigned long long)e->n_samples, (unsigned long long)e->n_snapshots);
}

// What the run says, a line each.
static bf_status print_verdicts(const solving *s, bf_error *err)
{
    verdicts *all = calloc(1, sizeof *all);
    advice *given = calloc(1, sizeof *given);
    bf_status status = BF_OK;

    if (all == NULL || given == NULL)
        status = bf_fail_memory(err);
    if (status == BF_OK)
        status = advice_of(&s->scene, s->arguments->subject.model, given, err);
    const run_verdict_subject of = { .scene = &s->scene,
                                     .advice = given,
                                     .end = &s->end,
                                     .values = (const double *)(const void *)s->figures.bytes };
    if (status == BF_OK)
        status = run_verdict_find(&of, all, err);
    for (size_t k = 0; status == BF_OK && k < all->n; k++)
        printf("%s\n", all->items[k].text);
    free(given);
    free(all);
    return status;
}

static bf_status draw_result(const solving *s, bf_error *err)
{
    char *path = strdup(s->arguments->out);

    if (path == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the chart");
    putchar('\n');
    bf_status status = cmd_draw_curves(&path, 1, NULL, err);
    free(path);
    return status;
}

static cmd_exit solve(solving *s, const char *command)
{
    bf_error err = { 0 };

    bf_status status = scenario_columns(&s->scene, &s->columns, &err);
    if (status == BF_OK)
        status = scenario_write(&s->scene, &s->document, &err);
    if (status == BF_OK)
        status = execute(s, &err);
    if (status == BF_OK)
        status = finish(s, &err);
    if (status == BF_OK) {
        print_result(s);
        status = s->end.stopped ? BF_OK : print_verdicts(s, &err);
        if (status == BF_OK && isatty(STDOUT_FILENO))
            status = draw_result(s, &err);
    }
    if (status != BF_OK)
        return cmd_fail(command, &err);
    return s->end.stopped ? CMD_INTERRUPTED : CMD_DONE;
}

static void take_threads(solve_arguments *a, const char *text, struct argp_state *state)
{
    uint64_t n = 0;

    if (!number_read_digits(text, 1, THREADS_MAX, &n))
        argp_failure(state, CMD_BAD_INPUT, 0, "--threads is a number from 1 to %d", THREADS_MAX);
    a->n_threads = (int)n;
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    solve_arguments *a = state->input;

    switch (key) {
    case KEY_OUT:
        a->out = argument;
        return 0;
    case KEY_THREADS:
        take_threads(a, argument, state);
        return 0;
    case ARGP_KEY_END:
        if (a->out == NULL)
            argp_usage(state);
        return 0;
    default:
        return cmd_take_subject(key, argument, state, &a->subject);
    }
}

static const struct argp_option options[] = {
    { "model", CMD_KEY_MODEL, "macro|micro", 0, "The model to solve (default macro)", 0 },
    { "out", KEY_OUT, "DIR", 0, "Where results go; created if missing", 0 },
    { "threads", KEY_THREADS, "N", 0, "Threads (default 1); results do not depend on it", 0 },
    { 0 },
};

static const struct argp parser = {
    .options = options,
    .parser = parse_option,
    .args_doc = "SCENARIO.json --out DIR",
    .doc = "Solve a scenario ('-' reads standard input) and write scenario.json, curve.csv, "
           "snapshots, snapshots.json and summary.json into DIR.\v"
           "Ctrl-C stops it: what was computed stays in DIR, without a summary.json, and the exit "
           "code is 130.",
};

int cmd_solve(int argc, char **argv)
{
    solve_arguments arguments = { .subject = { .model = RUN_MACRO }, .n_threads = 1 };
    solving s = { .arguments = &arguments };

    argp_parse(&parser, argc, argv, 0, NULL, &arguments);
    cmd_exit code = cmd_read_scenario(argv[0], &arguments.subject, &s.scene);
    if (code != CMD_DONE)
        return code;
    run_control_catch(SIGINT, RUN_CONTROL_CATCH_FIRST);
    run_control_catch(SIGTERM, RUN_CONTROL_CATCH_FIRST);
    s.run_control = run_control_init(REPORT_MS, 0);
    code = solve(&s, argv[0]);
    results_dir_close(s.results);
    buffer_fini(&s.columns);
    buffer_fini(&s.figures);
    buffer_fini(&s.document);
    scene_fini(&s.scene);
    return code;
}
