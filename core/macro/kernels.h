/// The inner loops of the macroscopic solver: rows of cells, in blocks of BLOCK_CELLS (active_blocks.h).
///
/// For the files that are compiled once per instruction set (core/CMakeLists.txt), so that the loops are
/// inlined there with the registers at hand; all variants give the same bits (core/base/simd.h).
///
/// A row pointer is the address of its cell 0, aligned to 64 bytes; rows have room on both sides
/// (macro_priv.h). Block b is cells 8 b .. 8 b + 7 and, for faces, the faces i + 1/2 east (or north) of
/// those cells; b may be -1. Ranges are b_min <= b < b_max.

#pragma once

#include "core/base/simd.h"
#include "core/macro/active_blocks.h"
#include "core/macro/mollifier.h"

#include <stddef.h>
#include <stdint.h>

enum { KERNELS_UNROLL = 4 }; ///< registers that share one load of a weight

/// The sums of n neighbouring registers; a constant n unrolls.
static inline __attribute__((always_inline)) void kernels_convolve_registers(
    const double *rho, const mollifier *m, ptrdiff_t i, int n, double *slope1, double *share1)
{
    const double *first = rho + i - m->reach;
    lanes slope[KERNELS_UNROLL], share[KERNELS_UNROLL];

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

/// slope1_i = sum_p slope_p rho_{i-p} and share1_i = sum_p share_p rho_{i-p}: the part of D1 and D2
/// along x1, for one row.
static inline void kernels_convolve_x1(const double *rho, const mollifier *m, ptrdiff_t b_min,
                                       ptrdiff_t b_max, double *slope1, double *share1)
{
    ptrdiff_t i = b_min * BLOCK_CELLS;

    for (; i + KERNELS_UNROLL * LANES <= b_max * BLOCK_CELLS; i += KERNELS_UNROLL * LANES)
        kernels_convolve_registers(rho, m, i, KERNELS_UNROLL, slope1, share1);
    for (; i < b_max * BLOCK_CELLS; i += LANES)
        kernels_convolve_registers(rho, m, i, 1, slope1, share1);
}

static inline __attribute__((always_inline)) void kernels_push_registers(
    const double *const *slope1, const double *const *share1, const mollifier *m, double dispersion,
    ptrdiff_t i, int n, double *push1, double *push2)
{
    lanes d1[KERNELS_UNROLL], d2[KERNELS_UNROLL];

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

/// The part along x2, and the push I of (10):
///     D1 = sum_m share_m slope1[m],  D2 = sum_m slope_m share1[m]
///     I1 = D1 s,  I2 = D2 s,  s = -dispersion / sqrt(1 + D1^2 + D2^2)
/// slope1[m] and share1[m] are the rows j - S + m.
static inline void kernels_push(const double *const *slope1, const double *const *share1,
                                const mollifier *m, double dispersion, ptrdiff_t b_min,
                                ptrdiff_t b_max, double *push1, double *push2)
{
    ptrdiff_t i = b_min * BLOCK_CELLS;

    for (; i + KERNELS_UNROLL * LANES <= b_max * BLOCK_CELLS; i += KERNELS_UNROLL * LANES)
        kernels_push_registers(slope1, share1, m, dispersion, i, KERNELS_UNROLL, push1, push2);
    for (; i < b_max * BLOCK_CELLS; i += LANES)
        kernels_push_registers(slope1, share1, m, dispersion, i, 1, push1, push2);
}

/// One of the two products is zero, so their sum is the upwind flux to the bit.
static inline lanes kernels_upwind_flux(lanes v, lanes near, lanes far)
{
    return lanes_positive(v) * near + lanes_negative(v) * far;
}

/// flux = v >= 0 ? near v : far v, where near and far are the cells before and after the face.
static inline void kernels_upwind(const double *v, const double *near, const double *far,
                                  ptrdiff_t b_min, ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES)
        lanes_store(flux + i, kernels_upwind_flux(lanes_load(v + i), lanes_load_any(near + i),
                                                  lanes_load_any(far + i)));
}

/// The same, added to flux.
static inline void kernels_upwind_add(const double *v, const double *near, const double *far,
                                      ptrdiff_t b_min, ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES)
        lanes_store(flux + i, lanes_load(flux + i) + kernels_upwind_flux(lanes_load(v + i),
                                                                         lanes_load_any(near + i),
                                                                         lanes_load_any(far + i)));
}

/// Static and pushed flux with a sharp gate: upwind() of v and rho, and of push and H(rho - 1) rho.
static inline void kernels_upwind_sharp(const double *v, const double *push, const double *near,
                                        const double *far, ptrdiff_t b_min, ptrdiff_t b_max,
                                        double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES) {
        lanes rho = lanes_load_any(near + i), next = lanes_load_any(far + i);
        lanes_store(flux + i, kernels_upwind_flux(lanes_load(v + i), rho, next) +
                                  kernels_upwind_flux(lanes_load(push + i), lanes_packed(rho),
                                                      lanes_packed(next)));
    }
}

/// What is found out about blocks that share a word of a set.
typedef struct kernels_marks {
    uint64_t bit;   ///< of the block at hand
    uint64_t any;   ///< blocks with a cell rho >= 1
    uint64_t first; ///< blocks whose first cell is one
} kernels_marks;

/// No marks yet; block b comes first.
static inline kernels_marks kernels_marks_from(ptrdiff_t b)
{
    return (kernels_marks){ UINT64_C(1) << (b + 1) % 64, 0, 0 };
}

/// Adds what is known of the block at hand (bit k: cell k is packed) and moves on to the next.
static inline kernels_marks kernels_mark(kernels_marks m, unsigned packed_cells)
{
    m.any |= packed_cells != 0 ? m.bit : 0;
    m.first |= (packed_cells & 1) != 0 ? m.bit : 0;
    m.bit <<= 1;
    return m;
}

/// Puts the marks of the blocks from low to high, which share a word, into the sets.
static inline void kernels_put_marks(kernels_marks m, ptrdiff_t low, ptrdiff_t high,
                                     uint64_t *packed, uint64_t *packed_first)
{
    const ptrdiff_t w = (low + 1) / 64;
    const uint64_t range = block_set_span_word((block_span){ low, high }, (size_t)w);

    packed[w] = (packed[w] & ~range) | m.any;
    packed_first[w] = (packed_first[w] & ~range) | m.first;
}

/// The end of the blocks from low on that share a word of a set.
static inline ptrdiff_t kernels_end_of_word(ptrdiff_t low, ptrdiff_t b_max)
{
    const ptrdiff_t end = (low + 1) / 64 * 64 + 63;

    return end < b_max ? end : b_max;
}

/// out = rho - lambda (after - before): fluxes through the faces after and before each cell; out may be
/// rho. Marks the blocks of the range in two sets (active_blocks.h): those with a new density >= 1, and
/// those whose first cell has one. Other blocks of the sets stay as they are.
static inline void kernels_update(const double *rho, double lambda, const double *after,
                                  const double *before, ptrdiff_t b_min, ptrdiff_t b_max,
                                  double *out, uint64_t *packed, uint64_t *packed_first)
{
    for (ptrdiff_t low = b_min, high; low < b_max; low = high) {
        kernels_marks m = kernels_marks_from(low);
        high = kernels_end_of_word(low, b_max);
        for (ptrdiff_t b = low; b < high; b++) {
            unsigned packed_cells = 0;
            for (int k = 0; k < BLOCK_CELLS; k += LANES) {
                ptrdiff_t i = b * BLOCK_CELLS + k;
                lanes flux = lanes_load_any(after + i) - lanes_load_any(before + i);
                lanes updated = lanes_load(rho + i) - lambda * flux;
                packed_cells |= lanes_packed_bits(updated) << k;
                lanes_store(out + i, updated);
            }
            m = kernels_mark(m, packed_cells);
        }
        kernels_put_marks(m, low, high, packed, packed_first);
    }
}

/// Marks the blocks of a range from their densities.
static inline void kernels_mark_range(const double *rho, ptrdiff_t b_min, ptrdiff_t b_max,
                                      uint64_t *packed, uint64_t *packed_first)
{
    for (ptrdiff_t low = b_min, high; low < b_max; low = high) {
        kernels_marks m = kernels_marks_from(low);
        high = kernels_end_of_word(low, b_max);
        for (ptrdiff_t b = low; b < high; b++) {
            unsigned packed_cells = 0;
            for (int k = 0; k < BLOCK_CELLS; k += LANES)
                packed_cells |= lanes_packed_bits(lanes_load(rho + b * BLOCK_CELLS + k)) << k;
            m = kernels_mark(m, packed_cells);
        }
        kernels_put_marks(m, low, high, packed, packed_first);
    }
}

/// update() along x1 with the fluxes v rho of one velocity v >= 0, in one pass. The sets must not hold
/// blocks of the range before.
static inline void kernels_update_uniform(const double *rho, double lambda, double v,
                                          ptrdiff_t b_min, ptrdiff_t b_max, double *out,
                                          uint64_t *packed, uint64_t *packed_first)
{
    lanes largest = lanes_all(0.0);

    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += LANES) {
        lanes here = lanes_load(rho + i);
        lanes updated = here - lambda * (v * here - v * lanes_load_any(rho + i - 1));
        largest = lanes_max(updated, largest);
        lanes_store(out + i, updated);
    }
    // Carried cargo seldom becomes packed, so that is looked for only where it happened.
    if (lanes_packed_bits(largest) != 0)
        kernels_mark_range(out, b_min, b_max, packed, packed_first);
}
