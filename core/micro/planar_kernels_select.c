#include "core/micro/planar_kernels.h"

extern const planar_kernels planar_kernels_base;

#if defined(__x86_64__)

extern const planar_kernels planar_kernels_avx2;
extern const planar_kernels planar_kernels_avx512;

const planar_kernels *const *planar_kernels_available(void)
{
    static const planar_kernels *const all[] = { &planar_kernels_avx512, &planar_kernels_avx2,
                                                 &planar_kernels_base, NULL };

    if (__builtin_cpu_supports("avx512f"))
        return all;
    return __builtin_cpu_supports("avx2") ? all + 1 : all + 2;
}

#else

const planar_kernels *const *planar_kernels_available(void)
{
    static const planar_kernels *const only[] = { &planar_kernels_base, NULL };

    return only;
}

#endif
