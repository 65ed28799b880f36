/// The inner loops of the macroscopic solver: rows of cells, in blocks of 8 (lanes.h).
///
/// The same source is compiled once per instruction set (core/CMakeLists.txt); kernels_best() picks
/// at run time. All variants give the same bits.
///
/// A row pointer is the address of its cell 0, aligned to 64 bytes; rows have room on both sides
/// (macro_priv.h). Block b is cells 8 b .. 8 b + 7 and, for faces, the faces i + 1/2 east (or north)
/// of those cells; b may be -1. Ranges are b_min <= b < b_max.

#pragma once

#include "core/macro/mollifier.h"

#include <stddef.h>
#include <stdint.h>

/// The table of one instruction set.
typedef struct kernels {
    const char *name; ///< of the instruction set, "avx512", "avx2", "base"

    /// slope1_i = sum_p slope_p rho_{i-p} and share1_i = sum_p share_p rho_{i-p}: the part of D1 and D2
    /// along x1, for one row.
    void (*convolve_x1)(const double *rho, const mollifier *m, ptrdiff_t b_min, ptrdiff_t b_max,
                        double *slope1, double *share1);

    /// The part along x2, and the push I of (10):
    ///     D1 = sum_m share_m slope1[m],  D2 = sum_m slope_m share1[m]
    ///     I1 = D1 s,  I2 = D2 s,  s = -dispersion / sqrt(1 + D1^2 + D2^2)
    /// slope1[m] and share1[m] are the rows j - S + m.
    void (*push)(const double *const *slope1, const double *const *share1, const mollifier *m,
                 double dispersion, ptrdiff_t b_min, ptrdiff_t b_max, double *push1, double *push2);

    /// flux = v >= 0 ? near v : far v, where near and far are the cells before and after the face.
    void (*upwind)(const double *v, const double *near, const double *far, ptrdiff_t b_min,
                   ptrdiff_t b_max, double *flux);

    /// The same, added to flux.
    void (*upwind_add)(const double *v, const double *near, const double *far, ptrdiff_t b_min,
                       ptrdiff_t b_max, double *flux);

    /// Static and pushed flux with a sharp gate: upwind() of v and rho, and of push and H(rho - 1) rho.
    void (*upwind_sharp)(const double *v, const double *push, const double *near, const double *far,
                         ptrdiff_t b_min, ptrdiff_t b_max, double *flux);

    /// out = rho - lambda (after - before): fluxes through the faces after and before each cell; out
    /// may be rho. Marks the blocks of the range in two sets (block_set.h): those with a new density
    /// >= 1, and those whose first cell has one. Other blocks of the sets stay as they are.
    void (*update)(const double *rho, double lambda, const double *after, const double *before,
                   ptrdiff_t b_min, ptrdiff_t b_max, double *out, uint64_t *packed,
                   uint64_t *packed_first);

    /// update() along x1 with the fluxes v rho of one velocity v >= 0, in one pass.
    void (*update_uniform)(const double *rho, double lambda, double v, ptrdiff_t b_min,
                           ptrdiff_t b_max, double *out, uint64_t *packed, uint64_t *packed_first);
} kernels;

/// The fastest variant that this processor can run.
const kernels *kernels_best(void);

/// All variants that this processor can run, fastest first; NULL-terminated.
const kernels *const *kernels_available(void);
