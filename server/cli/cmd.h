/// The subcommands of the program `beltflow` and what they share.
///
/// A subcommand gets its arguments with its full name ("beltflow solve") as the first, prints its
/// results on stdout and errors on stderr, and returns the exit code.

#pragma once

#include "core/base/buffer.h"
#include "core/base/faults.h"
#include "core/base/status.h"
#include "core/run/run.h"
#include "core/scene/scene.h"

struct argp_state;

/// Exit codes of the program.
typedef enum cmd_exit {
    CMD_DONE = 0,         ///< as asked
    CMD_FAILED = 1,       ///< anything that is not the input's fault
    CMD_BAD_INPUT = 2,    ///< the arguments or the documents are at fault
    CMD_INTERRUPTED = 130 ///< stopped by Ctrl-C, the exit code that shells use
} cmd_exit;

/// Largest curve.csv that is read, bytes.
#define CMD_CURVE_BYTES_MAX ((size_t)1 << 30)

int cmd_solve(int argc, char **argv);
int cmd_study(int argc, char **argv);
int cmd_check(int argc, char **argv);
int cmd_compare(int argc, char **argv);
int cmd_draw(int argc, char **argv);
int cmd_openapi(int argc, char **argv);
int cmd_worker(int argc, char **argv);
int cmd_pull(int argc, char **argv); // `worker --pull`, of `beltflow` alone

/// Print the error as "<pointer>: <text>", or, where it has no place in a document, as
/// "<command>: <text>". Returns the exit code for it.
cmd_exit cmd_fail(const char *command, const bf_error *err);

/// Print the faults of a document, one "<pointer>: <text>" a line. Returns the exit code for them.
cmd_exit cmd_print_faults(const char *command, const bf_faults *faults);

/// The scenario that a command is about, and the model for it.
typedef struct cmd_subject {
    const char *scenario; ///< path; "-": standard input
    run_model model;      ///< to solve it with, or to check it for
} cmd_subject;

enum { CMD_KEY_MODEL = 'm' }; ///< of the option --model

/// Take --model or the path of the scenario from the command line, for a parser of argp; what is wrong, also a
/// missing path, ends the program with usage. ARGP_ERR_UNKNOWN: key is of neither.
int cmd_take_subject(int key, const char *argument, const struct argp_state *state,
                     cmd_subject *subject);

/// Read the scenario and check it for the model. CMD_DONE: *ret_scene is
/// the caller's, scene_fini(). Else its faults were printed, one "<pointer>: <text>" a line.
cmd_exit cmd_read_scenario(const char *command, const cmd_subject *subject, scene *ret_scene);

/// A curve read from a CSV file or from curve.csv of a results directory.
typedef struct cmd_curve {
    bf_buffer t;     ///< n doubles, s
    bf_buffer parts; ///< n doubles
    size_t n;        ///< samples
} cmd_curve;

/// Read the column (NULL: the first) of the curve at path. BF_EINPUT, BF_ELIMIT, BF_ENOMEM: the text
/// names path. *ret_curve is the caller's: cmd_curve_fini().
BF_MUST_CHECK bf_status cmd_read_curve(const char *path, const char *column, cmd_curve *ret_curve,
                                       bf_error *err);

/// Free what the curve owns and zero it. NULL is fine.
void cmd_curve_fini(cmd_curve *curve);

/// Draw the curves at n_paths paths for the terminal at hand on standard output.
BF_MUST_CHECK bf_status cmd_draw_curves(char *const *paths, size_t n_paths, const char *column,
                                        bf_error *err);
