#include "server/cli/cmd.h"

#include "api/results/compare_json.h"
#include "api/results/compare_verdict.h"
#include "core/compare/compare.h"
#include "server/base/file_io.h"

#include <argp.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CURVES_MIN = 2, CURVES_MAX = 8 };

typedef struct compare_arguments {
    const char *paths[CURVES_MAX]; // the first one is the reference
    size_t n;
    const char *column; // NULL: the first
    bool is_json;
} compare_arguments;

// What is printed of a curve.
typedef struct compare_result {
    compare_figures figures;
    compare_measures measures; // against the reference; all NAN for itself
    compare_side side;         // what verdicts are about
    compare_flows flows;       // of a run
} compare_result;

enum { KEY_COLUMN = 'c', KEY_JSON = 'j' };

static error_t parse_option(int key, char *argument, struct argp_state *state)
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
        if (a->n == CURVES_MAX)
            argp_usage(state);
        a->paths[a->n++] = argument;
        return 0;
    case ARGP_KEY_END:
        if (a->n < CURVES_MIN)
            argp_usage(state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

// The columns of the table: titles, and the figures in their order.
static const char *const titles[] = { "drain",   "throughput", "l1",        "l2",
                                      "largest", "largest_at", "drain_gap", "throughput_gap" };
static const char *const units[] = {
    "s", "parts/s", "parts", "parts", "parts", "s", "s", "parts/s"
};

enum { N_TITLES = sizeof titles / sizeof *titles, WIDTH_MIN = 10 };

static int width_of(size_t k)
{
    int n = (int)strlen(titles[k]);

    return n < WIDTH_MIN ? WIDTH_MIN : n;
}

static void print_head(const char *const *words)
{
    for (size_t k = 0; k < N_TITLES; k++)
        printf("%s%*s", k == 0 ? "" : "  ", width_of(k), words[k]);
}

static void print_row(const compare_result *r, const char *path)
{
    const compare_measures *m = &r->measures;
    const double values[N_TITLES] = {
        r->figures.drain_time, r->figures.throughput, m->l1, m->l2, m->largest, m->largest_at,
        m->drain_gap,          m->throughput_gap,
    };

    for (size_t k = 0; k < N_TITLES; k++) {
        if (isnan(values[k]))
            printf("%*s  ", width_of(k), "-");
        else
            printf("%*.6g  ", width_of(k), values[k]);
    }
    printf("%s\n", path);
}

// A run whose directory has a summary is known, of anything else only the curve.
static bf_status find_side(const char *path, compare_result *r, bf_error *err)
{
    bf_buffer summary = { 0 };
    bf_error why = { 0 };

    bf_status status = file_io_read(path, "summary.json", CMD_CURVE_BYTES_MAX, &summary, &why);
    if (status == BF_OK)
        status =
            compare_verdict_side_of_summary(summary.bytes, summary.n, &r->side, &r->flows, &why);
    buffer_fini(&summary);
    if (status == BF_ENOMEM)
        return bf_fail_memory(err);
    if (status != BF_OK) {
        r->side = (compare_side){ .error_per_h = NAN, .needs_s = NAN };
        r->flows = (compare_flows){ 0 };
    }
    return BF_OK;
}

// What b is to the first one. Where one is known by its curve alone, both are.
static void find_verdicts(const compare_result *a, const compare_result *b, verdicts *ret_all)
{
    compare_side of_a = a->side, of_b = b->side;

    if (!of_a.is_run || !of_b.is_run) {
        of_a.throughput_per_h = 3600.0 * a->figures.throughput;
        of_b.throughput_per_h = 3600.0 * b->figures.throughput;
        of_a.error_per_h = of_b.error_per_h = NAN;
    }
    *ret_all = (verdicts){ 0 };
    compare_verdict_find(&of_a, &of_b, ret_all);
    compare_verdict_flows(&of_a, &of_b, &a->flows, &b->flows, ret_all);
}

static bf_status print_json(const compare_arguments *a, const compare_result *results,
                            bf_error *err)
{
    static verdicts all;
    bf_buffer text = { 0 };
    json_out w = json_out_to(&text);

    json_out_object(&w);
    json_out_key(&w, "entries");
    json_out_array(&w);
    for (size_t i = 0; i < a->n; i++) {
        json_out_object(&w);
        json_out_key_string(&w, "path", a->paths[i]);
        members_write_into(&w, &compare_json_figures, &results[i].figures);
        json_out_object_end(&w);
    }
    json_out_array_end(&w);
    json_out_key(&w, "pairs");
    json_out_array(&w);
    for (size_t i = 1; i < a->n; i++) {
        json_out_object(&w);
        json_out_key_string(&w, "a", a->paths[0]);
        json_out_key_string(&w, "b", a->paths[i]);
        find_verdicts(&results[0], &results[i], &all);
        json_out_key(&w, "verdicts");
        verdict_write_all(&w, &all);
        json_out_key(&w, "flows");
        compare_flows_write(&w, &results[0].flows, &results[i].flows);
        json_out_key(&w, "curve");
        members_write(&w, &compare_json_measures, &results[i].measures);
        json_out_object_end(&w);
    }
    json_out_array_end(&w);
    json_out_object_end(&w);
    bf_status status = json_out_status(&w, err);
    if (status == BF_OK)
        printf("%s\n", text.bytes);
    buffer_fini(&text);
    return status;
}

static compare_curve view_of(const cmd_curve *curve)
{
    return (compare_curve){ .n = curve->n,
                            .t = (const double *)(const void *)curve->t.bytes,
                            .parts = (const double *)(const void *)curve->parts.bytes };
}

// Names the file that an error of a comparison is about.
static bf_status fail_curve(bf_status status, const bf_error *why, const char *path, bf_error *err)
{
    return bf_fail(err, status, "", "%.120s: %.180s", path, why->text);
}

static bf_status measure(const char *path, const char *column, const compare_curve *reference,
                         compare_result *ret_result, bf_error *err)
{
    cmd_curve curve = { .n = 0 };
    bf_error why = { 0 };

    BF_TRY(cmd_read_curve(path, column, &curve, err));
    compare_curve view = view_of(&curve);
    bf_status status = compare_figures_of(&view, &ret_result->figures, &why);
    if (status == BF_OK)
        status = compare_curves(reference, &view, &ret_result->measures, &why);
    cmd_curve_fini(&curve);
    return status == BF_OK ? BF_OK : fail_curve(status, &why, path, err);
}

static bf_status measure_all(const compare_arguments *a, compare_result *results, bf_error *err)
{
    const compare_measures none = {
        .l1 = NAN,
        .l2 = NAN,
        .largest = NAN,
        .largest_at = NAN,
        .drain_gap = NAN,
        .throughput_gap = NAN,
    };
    cmd_curve curve = { .n = 0 };
    bf_error why = { 0 };

    BF_TRY(cmd_read_curve(a->paths[0], a->column, &curve, err));
    compare_curve reference = view_of(&curve);
    results[0].measures = none;
    bf_status status = compare_figures_of(&reference, &results[0].figures, &why);
    if (status != BF_OK)
        status = fail_curve(status, &why, a->paths[0], err);
    for (size_t i = 1; i < a->n && status == BF_OK; i++)
        status = measure(a->paths[i], a->column, &reference, &results[i], err);
    for (size_t i = 0; i < a->n && status == BF_OK; i++)
        status = find_side(a->paths[i], &results[i], err);
    cmd_curve_fini(&curve);
    for (size_t i = 0; i < a->n && status == BF_OK; i++)
        compare_verdict_leave_out(&results[0].side, &results[i].side, a->column,
                                  &results[i].figures, &results[i].measures);
    return status;
}

static bf_status compare(const compare_arguments *a, bf_error *err)
{
    compare_result results[CURVES_MAX];

    bf_status status = measure_all(a, results, err);
    if (status == BF_OK && a->is_json)
        status = print_json(a, results, err);
    else if (status == BF_OK) {
        static verdicts all;
        print_head(titles);
        printf("  curve\n");
        print_head(units);
        printf("\n");
        for (size_t i = 0; i < a->n; i++)
            print_row(&results[i], a->paths[i]);
        for (size_t i = 1; i < a->n; i++) {
            find_verdicts(&results[0], &results[i], &all);
            for (size_t k = 0; k < all.n; k++)
                printf("\n%s: %s", a->paths[i], all.items[k].text);
        }
        putchar('\n');
    }
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
        .parser = parse_option,
        .args_doc = "DIR-OR-CSV DIR-OR-CSV...",
        .doc = "Print how far two to eight outflow curves are apart from the first, one a line.\v"
               "A curve has drained when 1 % of its parts are left; throughput counts from 10 % to "
               "90 % of what left. l1 is the mean, l2 the root mean square, largest the largest "
               "distance over the common interval; gaps are of the curve minus the first one. "
               "What does not exist is '-', as drain and throughput of what is inside while cargo "
               "enters and leaves. Sentences for each but the first say what its throughput is to "
               "that of the first one, and which flows of counters, outlets and sinks differ.",
    };
    compare_arguments arguments = { .column = NULL };
    bf_error err = { 0 };

    argp_parse(&parser, argc, argv, 0, NULL, &arguments);
    return compare(&arguments, &err) == BF_OK ? CMD_DONE : (int)cmd_fail(argv[0], &err);
}
