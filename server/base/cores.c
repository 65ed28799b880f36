#include "server/base/cores.h"

#include <sched.h>

unsigned cores_count(void)
{
    cpu_set_t set;

    // Beyond CPU_SETSIZE cores the call fails: there is no telling how many are ours.
    const int n = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
    return n < 1 ? 1 : (unsigned)n;
}
