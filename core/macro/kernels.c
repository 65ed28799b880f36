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

static void upwind_sharp(const double *v, const double *push, const double *near, const double *far,
                         ptrdiff_t b_min, ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES) {
        lanes rho = lanes_load_any(near + i), next = lanes_load_any(far + i);
        lanes_store(flux + i,
                    upwind_flux(lanes_load(v + i), rho, next) +
                        upwind_flux(lanes_load(push + i), lanes_packed(rho), lanes_packed(next)));
    }
}

// What is found out about blocks that share a word of a set.
typedef struct marks {
    uint64_t any, first;
} marks;

// Adds what a register of new densities at cell i tells about its block.
static inline marks mark(marks m, lanes rho, ptrdiff_t i)
{
    const uint64_t bits = lanes_packed_bits(rho);
    const ptrdiff_t place = (i / BLOCK_CELLS + 1) % 64;

    m.any |= (uint64_t)(bits != 0) << place;
    if (i % BLOCK_CELLS == 0)
        m.first |= (bits & 1) << place;
    return m;
}

// Puts the marks of the blocks from low to high, which share a word, into the sets.
static inline void put_marks(marks m, ptrdiff_t low, ptrdiff_t high, uint64_t *packed,
                             uint64_t *packed_first)
{
    const ptrdiff_t w = (low + 1) / 64;
    const uint64_t range = block_set_span_word((block_span){ low, high }, (size_t)w);

    packed[w] = (packed[w] & ~range) | m.any;
    packed_first[w] = (packed_first[w] & ~range) | m.first;
}

// The end of the blocks from low on that share a word of a set.
static inline ptrdiff_t end_of_word(ptrdiff_t low, ptrdiff_t b_max)
{
    const ptrdiff_t end = (low + 1) / 64 * 64 + 63;

    return end < b_max ? end : b_max;
}

static void update(const double *rho, double lambda, const double *after, const double *before,
                   ptrdiff_t b_min, ptrdiff_t b_max, double *out, uint64_t *packed,
                   uint64_t *packed_first)
{
    for (ptrdiff_t low = b_min, high; low < b_max; low = high) {
        marks m = { 0, 0 };
        high = end_of_word(low, b_max);
        for (ptrdiff_t i = low * BLOCK_CELLS; i < high * BLOCK_CELLS; i += LANES) {
            lanes flux = lanes_load_any(after + i) - lanes_load_any(before + i);
            lanes updated = lanes_load(rho + i) - lambda * flux;
            m = mark(m, updated, i);
            lanes_store(out + i, updated);
        }
        put_marks(m, low, high, packed, packed_first);
    }
}

static void update_uniform(const double *rho, double lambda, double v, ptrdiff_t b_min,
                           ptrdiff_t b_max, double *out, uint64_t *packed, uint64_t *packed_first)
{
    for (ptrdiff_t low = b_min, high; low < b_max; low = high) {
        marks m = { 0, 0 };
        high = end_of_word(low, b_max);
        for (ptrdiff_t i = low * BLOCK_CELLS; i < high * BLOCK_CELLS; i += LANES) {
            lanes here = lanes_load(rho + i);
            lanes updated = here - lambda * (v * here - v * lanes_load_any(rho + i - 1));
            m = mark(m, updated, i);
            lanes_store(out + i, updated);
        }
        put_marks(m, low, high, packed, packed_first);
    }
}

extern const kernels KERNELS_TABLE;

const kernels KERNELS_TABLE = {
    .name = KERNELS_NAME,
    .convolve_x1 = convolve_x1,
    .push = push,
    .upwind = upwind,
    .upwind_add = upwind_add,
    .upwind_sharp = upwind_sharp,
    .update = update,
    .update_uniform = update_uniform,
};
