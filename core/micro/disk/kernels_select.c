#include "core/micro/disk/kernels.h"

extern const disk_kernels disk_kernels_base;

#if defined(__x86_64__)

extern const disk_kernels disk_kernels_avx2;
extern const disk_kernels disk_kernels_avx512;

const disk_kernels *const *disk_kernels_available(void)
{
    static const disk_kernels *const all[] = { &disk_kernels_avx512, &disk_kernels_avx2,
                                               &disk_kernels_base, NULL };

    if (__builtin_cpu_supports("avx512f"))
        return all;
    return __builtin_cpu_supports("avx2") ? all + 1 : all + 2;
}

#else

const disk_kernels *const *disk_kernels_available(void)
{
    static const disk_kernels *const only[] = { &disk_kernels_base, NULL };

    return only;
}

#endif
