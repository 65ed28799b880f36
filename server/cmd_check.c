#include "server/cmd.h"

#include <argp.h>

static error_t take_option(int key, char *argument, struct argp_state *state)
{
    const char **path = state->input;

    if (key == ARGP_KEY_ARG && state->arg_num == 0) {
        *path = argument;
        return 0;
    }
    if (key == ARGP_KEY_ARG || key == ARGP_KEY_NO_ARGS)
        argp_usage(state);
    return ARGP_ERR_UNKNOWN;
}

int cmd_check(int argc, char **argv)
{
    static const struct argp parser = {
        .parser = take_option,
        .args_doc = "SCENARIO.json",
        .doc =
            "Check a scenario ('-' reads standard input) without solving it.\v"
            "Prints nothing and exits with 0 if it can be solved; else prints one line per fault "
            "on stderr, 'JSON-pointer: what is wrong', and exits with 2.",
    };
    const char *path = NULL;
    scene s;

    argp_parse(&parser, argc, argv, 0, NULL, &path);
    cmd_exit code = cmd_read_scenario(argv[0], path, &s);
    if (code == CMD_DONE)
        scene_fini(&s);
    return code;
}
