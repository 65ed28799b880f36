#include "server/cli/cmd.h"

#include <argp.h>

enum { KEY_MODEL = 'm' };

typedef struct check_arguments {
    const char *scenario;
    run_model model;
} check_arguments;

static error_t take_option(int key, char *argument, struct argp_state *state)
{
    check_arguments *a = state->input;

    switch (key) {
    case KEY_MODEL:
        a->model = cmd_take_model(argument, state);
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num > 0)
            argp_usage(state);
        a->scenario = argument;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_usage(state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int cmd_check(int argc, char **argv)
{
    static const struct argp_option options[] = {
        { "model", KEY_MODEL, "macro|micro", 0, "The model to check for (default macro)", 0 },
        { 0 },
    };
    static const struct argp parser = {
        .options = options,
        .parser = take_option,
        .args_doc = "SCENARIO.json",
        .doc =
            "Check a scenario ('-' reads standard input) without solving it.\v"
            "Prints nothing and exits with 0 if it can be solved; else prints one line per fault "
            "on stderr, 'JSON-pointer: what is wrong', and exits with 2.",
    };
    check_arguments arguments = { .model = RUN_MACRO };
    scene s;

    argp_parse(&parser, argc, argv, 0, NULL, &arguments);
    cmd_exit code = cmd_read_scenario(argv[0], arguments.scenario, arguments.model, &s);
    if (code == CMD_DONE)
        scene_fini(&s);
    return code;
}
