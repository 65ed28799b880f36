/// How much of the same a test does: less where a sanitizer watches or another processor is emulated.
///
/// A sanitizer finds a bad access when a line is executed at all. Long runs, many starts and many repetitions are for
/// statements about numbers and chance, which the release build proves; they take 5 to 20 times as long with a
/// sanitizer, and longer in an emulator.

#pragma once

#if defined(TESTS_ARE_EMULATED) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HELPER_AMOUNT_IS_LESS 1
#else
#define HELPER_AMOUNT_IS_LESS 0
#endif

/// `all`, or `less` where that is so. A constant if both are.
#define HELPER_AMOUNT(all, less) (HELPER_AMOUNT_IS_LESS ? (less) : (all))

/// After the n-th allocation the next one that fails: each or, where less is done, each of the first 200 and every seventh
/// of the others, which loops over items of one kind make.
#define HELPER_AMOUNT_NEXT_FAULT(n) ((n) + ((n) < 200 ? 1 : HELPER_AMOUNT(1, 7)))
