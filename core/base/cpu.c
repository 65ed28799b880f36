#include "core/base/cpu.h"

cpu_level cpu_best(void)
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2"))
        return __builtin_cpu_supports("avx512f") ? CPU_AVX512 : CPU_AVX2;
#endif
    return CPU_BASE;
}

const char *cpu_level_name(cpu_level level)
{
    static const char *const names[] = {
#define X(suffix) #suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    return names[level];
}
