#include "core/base/parallel.h"

#ifdef _OPENMP
#include <omp.h>
#endif

void parallel_for(int n_threads, size_t n_items, parallel_body *body, void *context)
{
    if (n_threads <= 1 || n_items <= 1) {
        for (size_t item = 0; item < n_items; item++)
            body(context, item);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for num_threads(n_threads) schedule(static, 1)
#endif
    for (size_t item = 0; item < n_items; item++)
        body(context, item);
}

int parallel_processors(void)
{
#ifdef _OPENMP
    return omp_get_num_procs();
#else
    return 1;
#endif
}
