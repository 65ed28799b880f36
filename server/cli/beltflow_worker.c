/// The program `beltflow-worker`: the one command that the daemon starts for each run. It is `beltflow worker` without the
/// libraries of the other commands, which take the dynamic loader longer than a short run takes to solve. Both have the same
/// arguments, so that the setting `program` may name either.

#include "server/cli/cmd.h"

#include <argp.h>
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv)
{
    argp_err_exit_status = CMD_BAD_INPUT;
    if (argc < 2 || strcmp(argv[1], "worker") != 0) {
        fputs("Usage: beltflow-worker worker [OPTION...]\n"
              "The solver that beltflowd starts for each run; `beltflow --help` lists commands.\n",
              stderr);
        return CMD_BAD_INPUT;
    }
    argv[1] = argv[0];
    return cmd_worker(argc - 1, argv + 1);
}
