/// Assertions that stay on in release builds: for programming errors only, never for input.

#pragma once

/// If the condition is false, print it with file and line to stderr and abort. No input may make it false.
#define BF_CHECK(condition)                                                                        \
    ((condition) ? (void)0 : bf_check_failed(#condition, __FILE__, __LINE__))

/// Print the failed condition with file and line to stderr and abort.
_Noreturn void bf_check_failed(const char *condition, const char *file, int line);
