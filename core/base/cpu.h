/// The choice of the instruction set, made here for all of core.
///
/// Inner loops are compiled once per level (core/CMakeLists.txt) with CPU_BUILD set to the level's suffix,
/// and each module picks the build of a level from a table made by CPU_EACH_BUILD. All builds give the
/// same bits (core/base/simd.h).

#pragma once

/// Instruction sets, each with all that the ones before it have.
typedef enum cpu_level {
    CPU_BASE,   ///< what the compiler assumes: SSE2 on x86-64
    CPU_AVX2,   ///< registers of 4 doubles
    CPU_AVX512, ///< registers of 8 doubles
} cpu_level;

/// X(suffix) for every level that is compiled, in the order of cpu_level.
#if defined(__x86_64__)
#define CPU_EACH_BUILD(X) X(base) X(avx2) X(avx512)
#else
#define CPU_EACH_BUILD(X) X(base)
#endif

/// `name` with the suffix of the level that is being compiled, e.g. name_avx2.
#define CPU_NAME(name)           CPU_NAME_(name, CPU_BUILD)
#define CPU_NAME_(name, suffix)  CPU_NAME__(name, suffix)
#define CPU_NAME__(name, suffix) name##_##suffix

/// The best level that this processor has and that is compiled. The levels below it can run as well.
cpu_level cpu_best(void);

/// The name of a level: "base", "avx2", "avx512".
const char *cpu_level_name(cpu_level level);
