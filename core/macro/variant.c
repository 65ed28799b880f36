#include "core/macro/variant.h"

#include <pthread.h>
#include <stddef.h>

extern const variant variant_base;

#if defined(__x86_64__)

extern const variant variant_avx2;
extern const variant variant_avx512;

enum { VARIANTS = 3 };

static const variant *available[VARIANTS + 1];

static void find_available(void)
{
    size_t n = 0;

    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f"))
        available[n++] = &variant_avx512;
    if (__builtin_cpu_supports("avx2"))
        available[n++] = &variant_avx2;
    available[n++] = &variant_base;
}

const variant *const *variant_available(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;

    pthread_once(&once, find_available);
    return available;
}

#else

const variant *const *variant_available(void)
{
    static const variant *const only[] = { &variant_base, NULL };

    return only;
}

#endif

const variant *variant_best(void)
{
    return variant_available()[0];
}
