#include "server/cli/cmd.h"

#include "api/json/number.h"
#include "api/study/study_best.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/cores.h"
#include "server/base/file_io.h"
#include "server/cli/study_files.h"
#include "server/cli/study_round.h"
#include "server/run/run_control.h"

#include <argp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { DOCUMENT_BYTES_MAX = 64 * 1024 * 1024, KEY_OUT = 'o', KEY_WORKERS = 'j' };

typedef struct study_arguments {
    const char *document;
    const char *out;
    int n_workers; // 0: as the document says
} study_arguments;

// A study under way.
typedef struct studying {
    study_document document;
    study_columns columns; // of its trials
    study *study;
    study_files *files;
    bf_buffer header; // of trials.csv
    bf_buffer line;   // of a trial
    size_t *pending;  // trials of a round that are to be solved
    bool has_bar;     // stderr is a terminal
    double shown_s;   // when the progress line was drawn
    size_t n_ended;
    size_t n_solved; // in this session
} studying;

static void show_progress(studying *s, bool is_last)
{
    const double now = clock_monotonic_s();

    if (!s->has_bar || (!is_last && now - s->shown_s < 0.1))
        return;
    s->shown_s = now;
    fprintf(stderr, "\r%zu of %zu trials, at most %llu\033[K%s", s->n_ended, study_trials(s->study),
            (unsigned long long)s->document.trials_max, is_last ? "\n" : "");
}

static bf_status on_trial(void *context, const api_trial *trial, bf_error *err)
{
    studying *s = context;

    s->line.n = 0;
    BF_TRY(study_trial_csv_line(trial, &s->line, err));
    BF_TRY(study_files_add(s->files, trial->number, &s->line, err));
    study_tell(s->study, trial->number, trial->values);
    s->n_ended++;
    s->n_solved++;
    show_progress(s, false);
    return BF_OK;
}

// Tell what earlier sessions know of a round, and solve the rest.
static bf_status solve_round(studying *s, size_t from, int n_workers, bf_error *err)
{
    const size_t n = study_trials(s->study) - from;
    double values[STUDY_VALUES];
    size_t n_pending = 0;

    memory_free(s->pending);
    s->pending = memory_alloc(n, sizeof *s->pending);
    if (s->pending == NULL)
        return bf_fail_memory(err);
    for (size_t trial = from; trial < from + n; trial++) {
        if (study_files_find(s->files, &s->columns, trial, values)) {
            study_tell(s->study, trial, values);
            s->n_ended++;
        } else {
            s->pending[n_pending++] = trial;
        }
    }
    study_round round = { .document = &s->document,
                          .study = s->study,
                          .trials = s->pending,
                          .n = n_pending,
                          .n_workers = n_workers,
                          .context = s,
                          .ended = on_trial };
    return n_pending == 0 ? BF_OK : study_round_solve(&round, err);
}

static bf_status run_rounds(studying *s, int n_workers, bf_error *err)
{
    bf_status status = BF_OK;

    while (status == BF_OK && !run_control_is_stopped()) {
        const size_t from = study_trials(s->study);
        status = study_advance(s->study, err);
        if (status != BF_OK || study_trials(s->study) == from)
            break;
        status = solve_round(s, from, n_workers, err);
    }
    show_progress(s, true);
    return status;
}

static bf_status finish(studying *s, bf_error *err)
{
    bf_buffer best = { 0 };

    bf_status status = study_best_write(&s->document, s->study, &best, err);
    if (status == BF_OK && buffer_append(&best, "\n", 1) != BF_OK)
        status = bf_fail_memory(err);
    if (status == BF_OK)
        status = study_files_finish(s->files, &s->header, &best, err);
    if (status == BF_OK)
        fwrite(best.bytes, 1, best.n, stdout);
    buffer_fini(&best);
    return status;
}

static int cores(void)
{
    const unsigned n = cores_count();

    return n > STUDY_DOCUMENT_WORKERS ? STUDY_DOCUMENT_WORKERS : (int)n;
}

static cmd_exit perform(studying *s, const study_arguments *a, const bf_buffer *text,
                        const char *command)
{
    const study_definition definition = study_document_definition(&s->document);
    const int asked = a->n_workers > 0 ? a->n_workers : s->document.workers;
    bf_error err = { 0 };

    study_columns_of(&s->document, &s->columns);
    bf_status status = study_create(&definition, &s->study, &err);
    if (status == BF_OK)
        status = study_trial_csv_header(&s->columns, &s->header, &err);
    if (status == BF_OK)
        status = study_files_open(a->out, text->bytes, text->n, &s->files, &err);
    if (status == BF_OK)
        status = study_files_resume(s->files, &s->columns, &s->header, &err);
    if (status == BF_OK)
        status = run_rounds(s, asked > 0 ? asked : cores(), &err);
    if (status == BF_OK)
        status = finish(s, &err);
    if (status != BF_OK)
        return cmd_fail(command, &err);
    return study_is_ended(s->study) ? CMD_DONE : CMD_INTERRUPTED;
}

static cmd_exit read_document(const char *command, const study_arguments *a, bf_buffer *text,
                              study_document *ret_document)
{
    bf_faults *faults = memory_alloc(1, sizeof *faults);
    bf_error err = { 0 };

    bf_status status = faults == NULL
                           ? bf_fail_memory(&err)
                           : file_io_read(a->document, NULL, DOCUMENT_BYTES_MAX, text, &err);
    if (status == BF_OK)
        status = study_document_read(text->bytes, text->n, ret_document, faults, &err);
    cmd_exit code = CMD_DONE;
    if (faults != NULL && faults->n > 0)
        code = cmd_print_faults(command, faults);
    else if (status != BF_OK)
        code = cmd_fail(command, &err);
    memory_free(faults);
    return code;
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    study_arguments *a = state->input;
    uint64_t n = 0;

    switch (key) {
    case KEY_OUT:
        a->out = argument;
        return 0;
    case KEY_WORKERS:
        if (!number_read_digits(argument, 1, STUDY_DOCUMENT_WORKERS, &n))
            argp_failure(state, CMD_BAD_INPUT, 0, "--workers is a number from 1 to %d",
                         STUDY_DOCUMENT_WORKERS);
        a->n_workers = (int)n;
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num > 0)
            argp_usage(state);
        a->document = argument;
        return 0;
    case ARGP_KEY_END:
        if (a->document == NULL || a->out == NULL)
            argp_usage(state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int cmd_study(int argc, char **argv)
{
    static const struct argp_option options[] = {
        { "out", KEY_OUT, "DIR", 0, "Where results go; created if missing", 0 },
        { "workers", KEY_WORKERS, "N", 0,
          "Trials at a time (default: as the document says, else one for each core); results do "
          "not depend on it",
          0 },
        { 0 },
    };
    static const struct argp parser = {
        .options = options,
        .parser = parse_option,
        .args_doc = "STUDY.json --out DIR",
        .doc = "Make a study ('-' reads standard input): vary numbers of a scenario, solve each, "
               "and say which is best. Writes study.json, trials.csv and best.json into DIR.\v"
               "Ctrl-C stops it with the exit code 130; the same command goes on, with the same "
               "trials.",
    };
    study_arguments arguments = { .n_workers = 0 };
    studying s = { .has_bar = isatty(STDERR_FILENO) == 1 };
    bf_buffer text = { 0 };

    argp_parse(&parser, argc, argv, 0, NULL, &arguments);
    cmd_exit code = read_document(argv[0], &arguments, &text, &s.document);
    if (code == CMD_DONE) {
        run_control_catch(SIGINT, RUN_CONTROL_CATCH_FIRST);
        run_control_catch(SIGTERM, RUN_CONTROL_CATCH_FIRST);
        code = perform(&s, &arguments, &text, argv[0]);
    }
    study_files_close(s.files);
    study_destroy(s.study);
    study_document_fini(&s.document);
    memory_free(s.pending);
    buffer_fini(&s.header);
    buffer_fini(&s.line);
    buffer_fini(&text);
    return code;
}
