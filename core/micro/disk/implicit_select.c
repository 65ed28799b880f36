#include "core/micro/disk/implicit_priv.h"

extern const implicit_kernels disk_implicit_base;

#if defined(__x86_64__)

extern const implicit_kernels disk_implicit_avx2;
extern const implicit_kernels disk_implicit_avx512;

const implicit_kernels *const *disk_implicit__kernels(void)
{
    static const implicit_kernels *const all[] = { &disk_implicit_avx512, &disk_implicit_avx2,
                                                   &disk_implicit_base, NULL };

    if (__builtin_cpu_supports("avx512f"))
        return all;
    return __builtin_cpu_supports("avx2") ? all + 1 : all + 2;
}

#else

const implicit_kernels *const *disk_implicit__kernels(void)
{
    static const implicit_kernels *const only[] = { &disk_implicit_base, NULL };

    return only;
}

#endif
