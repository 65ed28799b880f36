/// The n-th call that fails, for tests that put functions of their own in the place of the C library's.

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// From now on calls are counted; the n-th fails with this errno. n = 0: none does.
void helper_fault_plan(size_t n, int error);

/// Calls since the plan.
size_t helper_fault_calls(void);

/// Count a call; true with errno: it is to fail.
bool helper_fault_is_due(void);

/// What the C library has under this name, into a pointer to a function.
void helper_fault_next(const char *name, void *ret_function);
