#include "server/cli/cmd.h"

#include "core/advice/advice.h"

#include <argp.h>
#include <stdio.h>
#include <stdlib.h>

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    return cmd_take_subject(key, argument, state, state->input);
}

static cmd_exit print_warnings(const char *command, const scene *s, run_model model)
{
    advice *given = calloc(1, sizeof *given);
    bf_error err = { 0 };

    if ((given == NULL ? bf_fail_memory(&err) : advice_of(s, model, given, &err)) != BF_OK) {
        free(given);
        return cmd_fail(command, &err);
    }
    for (size_t k = 0; k < given->warnings.n; k++) {
        const review_warning *item = &given->warnings.items[k];
        fprintf(stderr, "warning: %s: %s. %s%s%s\n", item->pointer, item->title, item->meaning,
                item->detail[0] == '\0' ? "" : " ", item->detail);
    }
    if (given->validity.like.n > 0)
        fprintf(stderr, "%s\n", given->validity.like.text);
    free(given);
    return CMD_DONE;
}

int cmd_check(int argc, char **argv)
{
    static const struct argp_option options[] = {
        { "model", CMD_KEY_MODEL, "macro|micro", 0, "The model to check for (default macro)", 0 },
        { 0 },
    };
    static const struct argp parser = {
        .options = options,
        .parser = parse_option,
        .args_doc = "SCENARIO.json",
        .doc =
            "Check a scenario ('-' reads standard input) without solving it.\v"
            "Exits with 0 if it can be solved; else prints one line per fault on stderr, "
            "'JSON-pointer: what is wrong', and exits with 2. What would make the results doubtful "
            "is printed on stderr, too, 'warning: JSON-pointer: why', and is no fault. So is how "
            "far "
            "off the model was in scenes like this one.",
    };
    cmd_subject subject = { .model = RUN_MACRO };
    scene s;

    argp_parse(&parser, argc, argv, 0, NULL, &subject);
    cmd_exit code = cmd_read_scenario(argv[0], &subject, &s);
    if (code != CMD_DONE)
        return code;
    code = print_warnings(argv[0], &s, subject.model);
    scene_fini(&s);
    return code;
}
