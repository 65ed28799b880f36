#include "core/study/sweep.h"

#include "core/study/sobol.h"
#include "core/study/variates.h"

size_t sweep_grid_points(const size_t *steps, size_t d)
{
    size_t n = 1;

    for (size_t k = 0; k < d; k++) {
        if (n > SIZE_MAX / steps[k])
            return SIZE_MAX;
        n *= steps[k];
    }
    return n;
}

void sweep_grid(const size_t *steps, size_t d, size_t index, double *ret_point)
{
    for (size_t k = d; k-- > 0; index /= steps[k])
        ret_point[k] = steps[k] == 1 ? 0.5 : (double)(index % steps[k]) / (double)(steps[k] - 1);
}

void sweep_lhs(uint64_t seed, size_t n, size_t d, double *ret_points)
{
    for (size_t k = 0; k < d; k++) {
        const variates_key order = { .seed = seed, .purpose = VARIATES_PERMUTATION, .set = k };
        const variates_key place = { .seed = seed, .purpose = VARIATES_PLACE, .set = k };
        for (size_t i = 0; i < n; i++)
            ret_points[i * d + k] = (double)i;
        // Fisher and Yates's shuffle; the remainder's bias is n/2^64.
        for (size_t i = n; i-- > 1;) {
            const size_t other = (size_t)(variates_bits(&order, i) % (i + 1));
            const double stratum = ret_points[i * d + k];
            ret_points[i * d + k] = ret_points[other * d + k];
            ret_points[other * d + k] = stratum;
        }
        for (size_t i = 0; i < n; i++)
            ret_points[i * d + k] = (ret_points[i * d + k] + variates_unit(&place, i)) / (double)n;
    }
}

void sweep_sobol(uint64_t seed, size_t index, size_t d, double *ret_point)
{
    for (size_t k = 0; k < d; k++) {
        const variates_key shift = { .seed = seed, .purpose = VARIATES_SHIFT };
        const uint32_t bits =
            sobol_coordinate(index, (unsigned)k) ^ (uint32_t)(variates_bits(&shift, k) >> 32);
        ret_point[k] = ((double)bits + 0.5) * 0x1p-32;
    }
}
