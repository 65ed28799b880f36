#include "core/macro/variant.h"

#include <pthread.h>
#include <stddef.h>

// The build of an instruction set: declarations of its two functions, and its table.
#define VARIANT(name)                                                                              \
    void macro__sweep_band_wide_##name(struct macro_band *band);                                   \
    void macro__sweep_band_narrow_##name(struct macro_band *band);                                 \
    static const variant name = { #name, macro__sweep_band_wide_##name,                            \
                                  macro__sweep_band_narrow_##name };

VARIANT(base)

#if defined(__x86_64__)

VARIANT(avx2)
VARIANT(avx512)

enum { VARIANTS = 3 };

static const variant *available[VARIANTS + 1];

static void find_available(void)
{
    size_t n = 0;

    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f"))
        available[n++] = &avx512;
    if (__builtin_cpu_supports("avx2"))
        available[n++] = &avx2;
    available[n++] = &base;
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
    static const variant *const only[] = { &base, NULL };

    return only;
}

#endif

const variant *variant_best(void)
{
    return variant_available()[0];
}
