/// Assertions that stay on in release builds: for our own mistakes only, never for input.

#pragma once

/// If the condition is false, print it with its place to stderr and abort. No input may make it false.
#define BF_CHECK(condition)                                                                        \
    ((condition) ? (void)0 : bf_check_failed(#condition, __FILE__, __LINE__))

/// Print the broken condition with its place to stderr and abort.
_Noreturn void bf_check_failed(const char *condition, const char *file, int line);
