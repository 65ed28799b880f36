/// The program `beltflow`: the solvers from the command line, and the child of the daemon.

#include "server/cli/cmd.h"

#include <argp.h>
#include <stdio.h>
#include <string.h>

typedef struct command {
    const char *name;
    const char *title; // its name in messages
    int (*run)(int argc, char **argv);
    const char *help;
} command;

// Two things have this name: the child that solves one run, and the worker that leases runs and starts such children.
static int run_worker(int argc, char **argv)
{
    static const char pull[] = "--pull";
    const size_t n = sizeof pull - 1;

    for (int i = 1; i < argc; i++)
        if (strncmp(argv[i], pull, n) == 0 && (argv[i][n] == '\0' || argv[i][n] == '='))
            return cmd_pull(argc, argv);
    return cmd_worker(argc, argv);
}

static const command commands[] = {
    { "solve", "beltflow solve", cmd_solve, "solve a scenario and write its results" },
    { "study", "beltflow study", cmd_study, "vary numbers of a scenario, and say what is best" },
    { "check", "beltflow check", cmd_check, "say what is wrong with a scenario" },
    { "compare", "beltflow compare", cmd_compare, "say how far two outflow curves are apart" },
    { "draw", "beltflow draw", cmd_draw, "draw outflow curves in the terminal" },
    { "openapi", "beltflow openapi", cmd_openapi, "print the description of the daemon's API" },
    { "worker", "beltflow worker", run_worker,
      "solve for the daemon: frames in, frames out; --pull URL: lease its runs" },
};

enum { N_COMMANDS = sizeof commands / sizeof *commands };

static void print_help(FILE *to)
{
    fputs("Usage: beltflow COMMAND [OPTION...] ...\n"
          "Material flow on conveyor belts, without a daemon.\n\n",
          to);
    for (size_t i = 0; i < N_COMMANDS; i++)
        fprintf(to, "  %-10s %s\n", commands[i].name, commands[i].help);
    fputs("\n  --help     this text; `beltflow COMMAND --help` tells the options\n"
          "  --version  the version\n\n"
          "Exit codes: 0 done, 2 the input is at fault, 1 anything else.\n",
          to);
}

// What was printed may not have arrived: a full disk behind stdout is a failure.
static int close_output(int code)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return code;
    perror("beltflow: standard output");
    return code == CMD_DONE ? CMD_FAILED : code;
}

static int run_command(const char *name, int argc, char **argv)
{
    for (size_t i = 0; i < N_COMMANDS; i++) {
        if (strcmp(name, commands[i].name) != 0)
            continue;
        char title[32];
        snprintf(title, sizeof title, "%s", commands[i].title);
        argv[0] = title;
        return commands[i].run(argc, argv);
    }
    fprintf(stderr, "beltflow: there is no command '%s'; `beltflow --help` lists them\n", name);
    return CMD_BAD_INPUT;
}

int main(int argc, char **argv)
{
    const char *name = argc < 2 ? "" : argv[1];

    argp_err_exit_status = CMD_BAD_INPUT;
    if (argc < 2) {
        print_help(stderr);
        return CMD_BAD_INPUT;
    }
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        print_help(stdout);
        return close_output(CMD_DONE);
    }
    if (strcmp(name, "--version") == 0 || strcmp(name, "-V") == 0) {
        printf("beltflow %s\n", BELTFLOW_BUILD);
        return close_output(CMD_DONE);
    }
    return close_output(run_command(name, argc - 1, argv + 1));
}
