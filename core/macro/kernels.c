#include "core/macro/kernels.h"

#include "core/macro/block_set.h"
#include "core/macro/lanes.h"

// KERNELS_TABLE and KERNELS_NAME come from the build, which compiles this file once per instruction
// set.

enum { UNROLL = 4 }; // registers that share one load of a weight

// The sums of n neighbouring registers; a constant n unrolls.
static inline __attribute__((always_inline)) void convolve_registers(const double *rho,
                                                                     const mollifier *m,
                                                                     ptrdiff_t i, int n,
                                                                     double *slope1, double *share1)
{
    const double *first = rho + i - m->reach;
    lanes slope[UNROLL], share[UNROLL];

    for (int k = 0; k < n; k++)
        slope[k] = share[k] = lanes_all(0.0);
    for (int tap = 0; tap <= 2 * m->reach; tap++) {
        lanes slope_weight = lanes_all(m->slope[tap]);
        lanes share_weight = lanes_all(m->share[tap]);
        for (int k = 0; k < n; k++) {
            lanes x = lanes_held(lanes_load_any(first + tap + k * LANES));
            slope[k] += slope_weight * x;
            share[k] += share_weight * x;
        }
    }
    for (int k = 0; k < n; k++) {
        lanes_store(slope1 + i + k * LANES, slope[k]);
        lanes_store(share1 + i + k * LANES, share[k]);
    }
}

static void convolve_x1(const double *rho, const mollifier *m, ptrdiff_t b_min, ptrdiff_t b_max,
                        double *slope1, double *share1)
{
    ptrdiff_t i = b_min * BLOCK_CELLS;

    for (; i + UNROLL * LANES <= b_max * BLOCK_CELLS; i += UNROLL * LANES)
        convolve_registers(rho, m, i, UNROLL, slope1, share1);
    for (; i < b_max * BLOCK_CELLS; i += LANES)
        convolve_registers(rho, m, i, 1, slope1, share1);
}

static inline __attribute__((always_inline)) void push_registers(
    const double *const *slope1, const double *const *share1, const mollifier *m, double dispersion,
    ptrdiff_t i, int n, double *push1, double *push2)
{
    lanes d1[UNROLL], d2[UNROLL];

    for (int k = 0; k < n; k++)
        d1[k] = d2[k] = lanes_all(0.0);
    for (int tap = 0; tap <= 2 * m->reach; tap++) {
        lanes share_weight = lanes_all(m->share[tap]);
        lanes slope_weight = lanes_all(m->slope[tap]);
        const double *slope_row = slope1[tap] + i;
        const double *share_row = share1[tap] + i;
        for (int k = 0; k < n; k++) {
            d1[k] += share_weight * lanes_load(slope_row + k * LANES);
            d2[k] += slope_weight * lanes_load(share_row + k * LANES);
        }
    }
    for (int k = 0; k < n; k++) {
        lanes scale = -dispersion / lanes_sqrt(1.0 + d1[k] * d1[k] + d2[k] * d2[k]);
        lanes_store(push1 + i + k * LANES, d1[k] * scale);
        lanes_store(push2 + i + k * LANES, d2[k] * scale);
    }
}

static void push(const double *const *slope1, const double *const *share1, const mollifier *m,
                 double dispersion, ptrdiff_t b_min, ptrdiff_t b_max, double *push1, double *push2)
{
    ptrdiff_t i = b_min * BLOCK_CELLS;

    for (; i + UNROLL * LANES <= b_max * BLOCK_CELLS; i += UNROLL * LANES)
        push_registers(slope1, share1, m, dispersion, i, UNROLL, push1, push2);
    for (; i < b_max * BLOCK_CELLS; i += LANES)
        push_registers(slope1, share1, m, dispersion, i, 1, push1, push2);
}

// One of the two products is zero, so their sum is the upwind flux to the bit.
static inline lanes upwind_flux(lanes v, lanes near, lanes far)
{
    return lanes_positive(v) * near + lanes_negative(v) * far;
}

static void upwind(const double *v, const double *near, const double *far, ptrdiff_t b_min,
                   ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES)
        lanes_store(flux + i, upwind_flux(lanes_load(v + i), lanes_load_any(near + i),
                                          lanes_load_any(far + i)));
}

static void upwind_add(const double *v, const double *near, const double *far, ptrdiff_t b_min,
                       ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES)
        lanes_store(flux + i,
                    lanes_load(flux + i) + upwind_flux(lanes_load(v + i), lanes_load_any(near + i),
                                                       lanes_load_any(far + i)));
}

static void upwind_add_packed(const double *v, const double *near, const double *far,
                              ptrdiff_t b_min, ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES)
        lanes_store(flux + i,
                    lanes_load(flux + i) + upwind_flux(lanes_load(v + i),
                                                       lanes_packed(lanes_load_any(near + i)),
                                                       lanes_packed(lanes_load_any(far + i))));
}

static void upwind_uniform(double v, const double *rho, ptrdiff_t b_min, ptrdiff_t b_max,
                           double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES)
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

    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES) {
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

    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES) {
        lanes here = lanes_load(rho + i);
        lanes updated = here - lambda * (v * here - v * lanes_load_any(rho + i - 1));
        largest = lanes_max(updated, largest);
        lanes_store(out + i, updated);
    }
    return largest_lane(largest);
}

// Bit k is set where cell k of a block is packed.
static inline unsigned packed_bits(const double *block)
{
    unsigned bits = 0;

    for (int k = 0; k < BLOCK_CELLS; k += LANES)
        bits |= lanes_packed_bits(lanes_load(block + k)) << k;
    return bits;
}

static void find_packed(const double *rho, ptrdiff_t b_min, ptrdiff_t b_max, uint64_t *any,
                        uint64_t *first)
{
    for (ptrdiff_t w = (b_min + 1) / 64; w <= b_max / 64; w++) {
        const ptrdiff_t low = w * 64 - 1 > b_min ? w * 64 - 1 : b_min;
        const ptrdiff_t high = w * 64 + 63 < b_max ? w * 64 + 63 : b_max;
        uint64_t any_word = any[w], first_word = first[w];
        for (ptrdiff_t b = low; b < high; b++) {
            uint64_t bit = UINT64_C(1) << (b + 1) % 64;
            uint64_t bits = packed_bits(rho + b * BLOCK_CELLS);
            any_word = bits != 0 ? any_word | bit : any_word & ~bit;
            first_word = (bits & 1) != 0 ? first_word | bit : first_word & ~bit;
        }
        any[w] = any_word;
        first[w] = first_word;
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
