#include "server/cli/cmd.h"

#include <argp.h>

static error_t take_option(int key, char *argument, struct argp_state *state)
{
    return cmd_take_subject(key, argument, state, state->input);
}

int cmd_check(int argc, char **argv)
{
    static const struct argp_option options[] = {
        { "model", CMD_KEY_MODEL, "macro|micro", 0, "The model to check for (default macro)", 0 },
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
    cmd_subject subject = { .model = RUN_MACRO };
    scene s;

    argp_parse(&parser, argc, argv, 0, NULL, &subject);
    cmd_exit code = cmd_read_scenario(argv[0], &subject, &s);
    if (code == CMD_DONE)
        scene_fini(&s);
    return code;
}
