#include "core/macro/kernels.h"

#include <pthread.h>

extern const kernels kernels_base;

#if defined(__x86_64__)

extern const kernels kernels_avx2;
extern const kernels kernels_avx512;

enum { VARIANTS = 3 };

static const kernels *available[VARIANTS + 1];

static void find_available(void)
{
    size_t n = 0;

    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f"))
        available[n++] = &kernels_avx512;
    if (__builtin_cpu_supports("avx2"))
        available[n++] = &kernels_avx2;
    available[n++] = &kernels_base;
}

const kernels *const *kernels_available(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;

    pthread_once(&once, find_available);
    return available;
}

#else

const kernels *const *kernels_available(void)
{
    static const kernels *const only[] = { &kernels_base, NULL };

    return only;
}

#endif

const kernels *kernels_best(void)
{
    return kernels_available()[0];
}
