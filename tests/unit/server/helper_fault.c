#include "tests/unit/server/helper_fault.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static atomic_size_t fault_at; // 0: none is planned
static atomic_size_t n_calls;  // since the plan
static atomic_int fault_errno; // of the call that fails

void helper_fault_plan(size_t n, int error)
{
    atomic_store(&fault_at, 0);
    atomic_store(&n_calls, 0);
    atomic_store(&fault_errno, error);
    atomic_store(&fault_at, n);
}

size_t helper_fault_calls(void)
{
    return atomic_load(&n_calls);
}

bool helper_fault_is_due(void)
{
    const size_t call = atomic_fetch_add(&n_calls, 1) + 1;
    const size_t due = atomic_load(&fault_at);

    if (due == 0 || call != due)
        return false;
    errno = atomic_load(&fault_errno);
    return true;
}

void helper_fault_next(const char *name, void *ret_function)
{
    void *const function = dlsym(RTLD_NEXT, name);

    if (function == NULL)
        abort();
    memcpy(ret_function, &function, sizeof function);
}
