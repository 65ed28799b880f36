#include "server/cli/cmd.h"

#include "api/results/results.h"
#include "api/scenario/scenario.h"
#include "server/base/file_io.h"

#include <argp.h>
#include <stdio.h>
#include <string.h>

// Behind its place in the document, or the command where it has none.
static void print_error(const char *command, const bf_error *err)
{
    fprintf(stderr, "%s: %s\n", err->pointer[0] != '\0' ? err->pointer : command, err->text);
}

cmd_exit cmd_fail(const char *command, const bf_error *err)
{
    bool is_input = err->code == BF_EINPUT || err->code == BF_ELIMIT;

    print_error(command, err);
    return is_input ? CMD_BAD_INPUT : CMD_FAILED;
}

cmd_exit cmd_print_faults(const char *command, const bf_faults *faults)
{
    for (size_t i = 0; i < faults_kept(faults); i++)
        print_error(command, &faults->items[i]);
    if (faults->n > faults_kept(faults))
        fprintf(stderr, "%s: %zu further faults are not shown\n", command,
                faults->n - faults_kept(faults));
    return CMD_BAD_INPUT;
}

static bf_status read_scenario(const cmd_subject *subject, scene *ret_scene, bf_faults *faults,
                               bf_error *err)
{
    bf_buffer document = { 0 };
    scene s;

    bf_status status = file_io_read(subject->scenario, NULL, SCENARIO_BYTES_MAX, &document, err);
    if (status == BF_OK)
        status = scenario_read(document.bytes, document.n, &s, faults, err);
    buffer_fini(&document);
    if (status != BF_OK)
        return status;
    run_check(&s, subject->model, faults);
    status = faults_status(faults, err);
    if (status == BF_OK)
        *ret_scene = s;
    else
        scene_fini(&s);
    return status;
}

cmd_exit cmd_read_scenario(const char *command, const cmd_subject *subject, scene *ret_scene)
{
    bf_faults faults = { 0 };
    bf_error err = { 0 };
    cmd_exit code = CMD_DONE;

    bf_status status = read_scenario(subject, ret_scene, &faults, &err);
    if (faults.n > 0) {
        code = cmd_print_faults(command, &faults);
    } else if (status != BF_OK) {
        code = cmd_fail(command, &err);
    }
    return code;
}

static run_model find_model(const char *word, const struct argp_state *state)
{
    for (int model = 0; run_model_words[model] != NULL; model++) {
        if (strcmp(word, run_model_words[model]) == 0 && run_model_is_available((run_model)model))
            return (run_model)model;
    }
    argp_failure(state, CMD_BAD_INPUT, 0, "there is no model '%s'; there are macro and micro",
                 word);
    return RUN_MACRO;
}

int cmd_take_subject(int key, const char *argument, const struct argp_state *state,
                     cmd_subject *subject)
{
    switch (key) {
    case CMD_KEY_MODEL:
        subject->model = find_model(argument, state);
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num > 0)
            argp_usage(state);
        subject->scenario = argument;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_usage(state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

bf_status cmd_read_curve(const char *path, const char *column, cmd_curve *ret_curve, bf_error *err)
{
    bf_buffer text = { 0 };
    cmd_curve curve = { 0 };
    bf_error why = { 0 };

    BF_TRY(file_io_read(path, "curve.csv", CMD_CURVE_BYTES_MAX, &text, err));
    bf_status status =
        results_read_curve_csv(text.bytes, text.n, column, &curve.t, &curve.parts, NULL, &why);
    buffer_fini(&text);
    if (status != BF_OK) {
        const char *line = strrchr(why.pointer, '/');
        cmd_curve_fini(&curve);
        if (line == NULL)
            return bf_fail(err, status, "", "%.120s: %.180s", path, why.text);
        return bf_fail(err, status, "", "%.120s: line %s: %.160s", path, line + 1, why.text);
    }
    curve.n = curve.t.n / sizeof(double);
    *ret_curve = curve;
    return BF_OK;
}

void cmd_curve_fini(cmd_curve *curve)
{
    if (curve == NULL)
        return;
    buffer_fini(&curve->t);
    buffer_fini(&curve->parts);
    *curve = (cmd_curve){ 0 };
}
