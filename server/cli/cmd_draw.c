#include "server/cli/cmd.h"

#include "server/cli/terminal.h"
#include "server/cli/terminal_chart.h"

#include <argp.h>
#include <stdio.h>
#include <string.h>

enum { HEIGHT_DEFAULT = 16, TITLE_SIZE = 100, KEY_COLUMN = 'c' };

typedef struct draw_arguments {
    char *paths[TERMINAL_CHART_CURVES_MAX];
    size_t n_paths;
    const char *column; // NULL: the first
} draw_arguments;

static bf_status draw(const cmd_curve *curves, char *const *paths, size_t n, const char *column,
                      bf_error *err)
{
    terminal_chart_curve views[TERMINAL_CHART_CURVES_MAX];
    char title[TITLE_SIZE];
    bf_buffer text = { 0 };

    for (size_t i = 0; i < n; i++) {
        views[i] = (terminal_chart_curve){ .label = strcmp(paths[i], "-") == 0 ? "stdin" : paths[i],
                                           .n = curves[i].n,
                                           .x = (const double *)(void *)curves[i].t.bytes,
                                           .y = (const double *)(void *)curves[i].parts.bytes };
    }
    snprintf(title, sizeof title, "parts%s%s", column == NULL ? "" : " in ",
             column == NULL ? "" : column);
    terminal_chart_options options = {
        .width = terminal_columns(),
        .height = HEIGHT_DEFAULT,
        .is_unicode = terminal_is_utf8(),
        .has_colors = terminal_has_colors(),
        .x_title = "t [s]",
        .y_title = title,
    };
    bf_status status = terminal_chart_draw(&options, views, n, &text, err);
    if (status == BF_OK)
        fwrite(text.bytes, 1, text.n, stdout);
    buffer_fini(&text);
    return status;
}

bf_status cmd_draw_curves(char *const *paths, size_t n_paths, const char *column, bf_error *err)
{
    cmd_curve curves[TERMINAL_CHART_CURVES_MAX] = { { .n = 0 } };
    bf_status status = BF_OK;

    for (size_t i = 0; i < n_paths && status == BF_OK; i++)
        status = cmd_read_curve(paths[i], column, &curves[i], err);
    if (status == BF_OK)
        status = draw(curves, paths, n_paths, column, err);
    for (size_t i = 0; i < n_paths; i++)
        cmd_curve_fini(&curves[i]);
    return status;
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    draw_arguments *a = state->input;

    switch (key) {
    case KEY_COLUMN:
        a->column = argument;
        return 0;
    case ARGP_KEY_ARG:
        if (a->n_paths == TERMINAL_CHART_CURVES_MAX)
            argp_error(state, "more than the %d curves that can be told apart",
                       TERMINAL_CHART_CURVES_MAX);
        a->paths[a->n_paths++] = argument;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_usage(state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int cmd_draw(int argc, char **argv)
{
    static const struct argp_option options[] = {
        { "column", KEY_COLUMN, "ID", 0, "Draw this column (default: the first)", 0 },
        { 0 },
    };
    static const struct argp parser = {
        .options = options,
        .parser = parse_option,
        .args_doc = "DIR-OR-CSV...",
        .doc =
            "Draw outflow curves in the terminal ('-' reads CSV from standard input).\v"
            "As wide as the terminal, or COLUMNS; plain ASCII unless the locale is UTF-8; colours "
            "unless NO_COLOR is set.",
    };
    draw_arguments arguments = { .n_paths = 0 };
    bf_error err = { 0 };

    argp_parse(&parser, argc, argv, 0, NULL, &arguments);
    bf_status status = cmd_draw_curves(arguments.paths, arguments.n_paths, arguments.column, &err);
    return status == BF_OK ? CMD_DONE : (int)cmd_fail(argv[0], &err);
}
