/// Subnormal numbers (below 2.3e-308 as doubles, 1.2e-38 as floats) taken for zero by the calling thread.
///
/// An upwind scheme lets the tail behind moving cargo decay by the same factor in every step until it is subnormal, where an
/// operation takes some hundred cycles on many processors, not on all. Between the two calls below, operands that are
/// subnormal count as zero, and so do results that would be: the tail stays where its fluxes are zero.
///
/// Threads    Only the calling thread is set. All threads that share a step must be, or its bits would depend on their number.
/// Processors x86-64 and AArch64; on others the calls do nothing.

#pragma once

#include <stdint.h>

#if defined(__x86_64__)

/// Flush from here on. Returns what subnormals_restore() takes.
static inline uint64_t subnormals_flush(void)
{
    const unsigned flush_results = 1U << 15, zero_operands = 1U << 6;
    const unsigned before = __builtin_ia32_stmxcsr();

    __builtin_ia32_ldmxcsr(before | flush_results | zero_operands);
    return before;
}

/// Let arithmetic be as it was before subnormals_flush(), whose result is given.
static inline void subnormals_restore(uint64_t before)
{
    __builtin_ia32_ldmxcsr((unsigned)before);
}

#elif defined(__aarch64__)

static inline void subnormals_restore(uint64_t before)
{
    __asm__ volatile("msr fpcr, %0" : : "r"(before) : "memory");
}

static inline uint64_t subnormals_flush(void)
{
    const uint64_t flush = UINT64_C(1) << 24;
    uint64_t before;

    __asm__ volatile("mrs %0, fpcr" : "=r"(before));
    subnormals_restore(before | flush);
    return before;
}

#else

static inline uint64_t subnormals_flush(void)
{
    return 0;
}

static inline void subnormals_restore(uint64_t before)
{
    (void)before;
}

#endif
