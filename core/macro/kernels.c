#include "core/macro/kernels.h"

#include "core/macro/block_set.h"
#include "core/macro/lanes.h"

// KERNELS_TABLE and KERNELS_NAME come from the build, which compiles this file once per instruction
// set.

enum { UNROLL = 4 }; // blocks that share one load of a weight

// The sums of n_blocks neighbouring blocks; constant n_blocks unrolls.
static inline __attribute__((always_inline)) void convolve_blocks(const double *rho,
                                                                  const mollifier *m, ptrdiff_t i,
                                                                  int n_blocks, double *slope1,
                                                                  double *share1)
{
    const double *first = rho + i - m->reach;
    lanes slope[UNROLL], share[UNROLL];

    for (int k = 0; k < n_blocks; k++)
        slope[k] = share[k] = lanes_all(0.0);
    for (int tap = 0; tap <= 2 * m->reach; tap++) {
        lanes slope_weight = lanes_all(m->slope[tap]);
        lanes share_weight = lanes_all(m->share[tap]);
        for (int k = 0; k < n_blocks; k++) {
            lanes x = lanes_load_any(first + tap + k * LANES);
            slope[k] += slope_weight * x;
            share[k] += share_weight * x;
        }
    }
    for (int k = 0; k < n_blocks; k++) {
        lanes_store(slope1 + i + k * LANES, slope[k]);
        lanes_store(share1 + i + k * LANES, share[k]);
    }
}

static void convolve_x1(const double *rho, const mollifier *m, ptrdiff_t b_min, ptrdiff_t b_max,
                        double *slope1, double *share1)
{
    ptrdiff_t b = b_min;

    for (; b + UNROLL <= b_max; b += UNROLL)
        convolve_blocks(rho, m, b * LANES, UNROLL, slope1, share1);
    for (; b < b_max; b++)
        convolve_blocks(rho, m, b * LANES, 1, slope1, share1);
}

static inline __attribute__((always_inline)) void push_blocks(const double *const *slope1,
                                                              const double *const *share1,
                                                              const mollifier *m, double dispersion,
                                                              ptrdiff_t i, int n_blocks,
                                                              double *push1, double *push2)
{
    lanes d1[UNROLL], d2[UNROLL];

    for (int k = 0; k < n_blocks; k++)
        d1[k] = d2[k] = lanes_all(0.0);
    for (int tap = 0; tap <= 2 * m->reach; tap++) {
        lanes share_weight = lanes_all(m->share[tap]);
        lanes slope_weight = lanes_all(m->slope[tap]);
        const double *slope_row = slope1[tap] + i;
        const double *share_row = share1[tap] + i;
        for (int k = 0; k < n_blocks; k++) {
            d1[k] += share_weight * lanes_load(slope_row + k * LANES);
            d2[k] += slope_weight * lanes_load(share_row + k * LANES);
        }
    }
    for (int k = 0; k < n_blocks; k++) {
        lanes scale = -dispersion / lanes_sqrt(1.0 + d1[k] * d1[k] + d2[k] * d2[k]);
        lanes_store(push1 + i + k * LANES, d1[k] * scale);
        lanes_store(push2 + i + k * LANES, d2[k] * scale);
    }
}

static void push(const double *const *slope1, const double *const *share1, const mollifier *m,
                 double dispersion, ptrdiff_t b_min, ptrdiff_t b_max, double *push1, double *push2)
{
    ptrdiff_t b = b_min;

    for (; b + UNROLL <= b_max; b += UNROLL)
        push_blocks(slope1, share1, m, dispersion, b * LANES, UNROLL, push1, push2);
    for (; b < b_max; b++)
        push_blocks(slope1, share1, m, dispersion, b * LANES, 1, push1, push2);
}

// One of the two products is zero, so their sum is the upwind flux to the bit.
static inline lanes upwind_flux(lanes v, lanes near, lanes far)
{
    return lanes_positive(v) * near + lanes_negative(v) * far;
}

static void upwind(const double *v, const double *near, const double *far, ptrdiff_t b_min,
                   ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * LANES; i < b_max * LANES; i += LANES)
        lanes_store(flux + i, upwind_flux(lanes_load(v + i), lanes_load_any(near + i),
                                          lanes_load_any(far + i)));
}

static void upwind_add(const double *v, const double *near, const double *far, ptrdiff_t b_min,
                       ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * LANES; i < b_max * LANES; i += LANES)
        lanes_store(flux + i,
                    lanes_load(flux + i) + upwind_flux(lanes_load(v + i), lanes_load_any(near + i),
                                                       lanes_load_any(far + i)));
}

static void upwind_add_packed(const double *v, const double *near, const double *far,
                              ptrdiff_t b_min, ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * LANES; i < b_max * LANES; i += LANES)
        lanes_store(flux + i,
                    lanes_load(flux + i) + upwind_flux(lanes_load(v + i),
                                                       lanes_packed(lanes_load_any(near + i)),
                                                       lanes_packed(lanes_load_any(far + i))));
}

static void upwind_uniform(double v, const double *rho, ptrdiff_t b_min, ptrdiff_t b_max,
                           double *flux)
{
    for (ptrdiff_t i = b_min * LANES; i < b_max * LANES; i += LANES)
        lanes_store(flux + i, v * lanes_load(rho + i));
}

static double largest_lane(lanes x)
{
    double largest = x[0];

    for (int k = 1; k < LANES; k++)
        largest = x[k] > largest ? x[k] : largest;
    return largest;
}

static double update(const double *rho, double lambda, const double *after, const double *before,
                     ptrdiff_t b_min, ptrdiff_t b_max, double *out)
{
    lanes largest = lanes_all(0.0);

    for (ptrdiff_t i = b_min * LANES; i < b_max * LANES; i += LANES) {
        lanes flux = lanes_load_any(after + i) - lanes_load_any(before + i);
        lanes updated = lanes_load(rho + i) - lambda * flux;
        largest = lanes_max(updated, largest);
        lanes_store(out + i, updated);
    }
    return largest_lane(largest);
}

static double update_uniform(const double *rho, double lambda, double v, ptrdiff_t b_min,
                             ptrdiff_t b_max, double *out)
{
    lanes largest = lanes_all(0.0);

    for (ptrdiff_t i = b_min * LANES; i < b_max * LANES; i += LANES) {
        lanes here = lanes_load(rho + i);
        lanes updated = here - lambda * (v * here - v * lanes_load_any(rho + i - 1));
        largest = lanes_max(updated, largest);
        lanes_store(out + i, updated);
    }
    return largest_lane(largest);
}

static void find_packed(const double *rho, ptrdiff_t n_blocks, uint64_t *any, uint64_t *first)
{
    memset(any, 0, block_set_words(n_blocks) * sizeof *any);
    memset(first, 0, block_set_words(n_blocks) * sizeof *first);
    for (ptrdiff_t b = 0; b < n_blocks; b++) {
        uint64_t bits = lanes_packed_bits(lanes_load(rho + b * LANES));
        any[(b + 1) / 64] |= (uint64_t)(bits != 0) << (b + 1) % 64;
        first[(b + 1) / 64] |= (bits & 1) << (b + 1) % 64;
    }
}

extern const kernels KERNELS_TABLE;

const kernels KERNELS_TABLE = {
    .name = KERNELS_NAME,
    .convolve_x1 = convolve_x1,
    .push = push,
    .upwind = upwind,
    .upwind_add = upwind_add,
    .upwind_add_packed = upwind_add_packed,
    .upwind_uniform = upwind_uniform,
    .update = update,
    .update_uniform = update_uniform,
    .find_packed = find_packed,
};
