#include "server/cmd.h"

#include "api/results.h"
#include "core/compare/compare.h"

#include <argp.h>
#include <math.h>
#include <stdio.h>

typedef struct compare_arguments {
    const char *paths[2];
    const char *column; // NULL: the first
    bool is_json;
} compare_arguments;

enum { KEY_COLUMN = 'c', KEY_JSON = 'j' };

static error_t take_option(int key, char *argument, struct argp_state *state)
{
    compare_arguments *a = state->input;

    switch (key) {
    case KEY_COLUMN:
        a->column = argument;
        return 0;
    case KEY_JSON:
        a->is_json = true;
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num >= 2)
            argp_usage(state);
        a->paths[state->arg_num] = argument;
        return 0;
    case ARGP_KEY_END:
        if (state->arg_num < 2)
            argp_usage(state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static void print_time(const char *name, double time)
{
    if (isnan(time))
        printf("%-14s %12s\n", name, "never");
    else
        printf("%-14s %12.6g s\n", name, time);
}

static void print_measures(const compare_measures *m)
{
    printf("%-14s %12.6g s\n", "t_start", m->t_start);
    printf("%-14s %12.6g s\n", "t_end", m->t_end);
    printf("%-14s %12.6g parts\n", "l1", m->l1);
    printf("%-14s %12.6g parts\n", "l2", m->l2);
    printf("%-14s %12.6g parts\n", "largest", m->largest);
    printf("%-14s %12.6g s\n", "largest_at", m->largest_at);
    print_time("drain_time_a", m->drain_time_a);
    print_time("drain_time_b", m->drain_time_b);
    printf("%-14s %12.6g parts/s\n", "rate_a", m->rate_a);
    printf("%-14s %12.6g parts/s\n", "rate_b", m->rate_b);
}

static bf_status print_json(const compare_measures *m, bf_error *err)
{
    bf_buffer text = { 0 };
    bf_status status = results_compare_json(m, &text, err);

    if (status == BF_OK)
        printf("%s\n", text.bytes);
    buffer_fini(&text);
    return status;
}

static bf_status compare(const compare_arguments *a, bf_error *err)
{
    cmd_curve curves[2] = { { .n = 0 } };
    compare_curve views[2];
    compare_measures measures;
    bf_status status = BF_OK;

    for (int i = 0; i < 2 && status == BF_OK; i++) {
        status = cmd_read_curve(a->paths[i], a->column, &curves[i], err);
        views[i] = (compare_curve){ .n = curves[i].n,
                                    .t = (const double *)(void *)curves[i].t.bytes,
                                    .parts = (const double *)(void *)curves[i].parts.bytes };
    }
    if (status == BF_OK)
        status = compare_curves(&views[0], &views[1], &measures, err);
    if (status == BF_OK && a->is_json)
        status = print_json(&measures, err);
    else if (status == BF_OK)
        print_measures(&measures);
    cmd_curve_fini(&curves[0]);
    cmd_curve_fini(&curves[1]);
    return status;
}

int cmd_compare(int argc, char **argv)
{
    static const struct argp_option options[] = {
        { "column", KEY_COLUMN, "ID", 0, "Compare this column (default: the first)", 0 },
        { "json", KEY_JSON, NULL, 0, "Print one JSON object", 0 },
        { 0 },
    };
    static const struct argp parser = {
        .options = options,
        .parser = take_option,
        .args_doc = "DIR-OR-CSV DIR-OR-CSV",
        .doc = "Print how far two outflow curves are apart, one 'name value unit' a line.\v"
               "l1 is the mean, l2 the root mean square, largest the largest distance over the "
               "common interval; a curve has drained when 1 % of its parts are left.",
    };
    compare_arguments arguments = { .column = NULL };
    bf_error err = { 0 };

    argp_parse(&parser, argc, argv, 0, NULL, &arguments);
    return compare(&arguments, &err) == BF_OK ? CMD_DONE : (int)cmd_fail(argv[0], &err);
}
