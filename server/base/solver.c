#include "server/base/solver.h"

#include "core/run/run.h"

#include <stdio.h>

const char *solver_name(char *ret_name)
{
    (void)snprintf(ret_name, SOLVER_NAME_SIZE, "%s/%d", BELTFLOW_VERSION, RUN_VERSION);
    return ret_name;
}
