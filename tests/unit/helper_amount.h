/// How much of the same a test does: less where a sanitizer watches.
///
/// A sanitizer finds a bad access when a line is executed at all. Long runs, many starts and many repetitions are for
/// statements about numbers and chance, which the release build proves; with a sanitizer they take 5 to 20 times as long.

#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HELPER_AMOUNT_IS_LESS 1
#else
#define HELPER_AMOUNT_IS_LESS 0
#endif

/// `all`, or `less` under a sanitizer. A constant if both are.
#define HELPER_AMOUNT(all, less) (HELPER_AMOUNT_IS_LESS ? (less) : (all))
