/// Inside of the kinds of a density (core/macro/kinds.h).
///
/// A step works on rows of one kind each, laid out like rows of the density (macro_priv.h): n planes of n2 rows. Between steps the
/// fractions stand cell by cell. Faces have the layout of macro_faces.
///
/// Phases of a step; each row's is its owner's, and a barrier is between two of them:
///
///     split     the fractions as planes; F_stat' and G' of the row's x1-faces and of the x2-faces south of it
///     prepare   densities after F_stat', and the slopes of the cells along both axes
///     carry     the fractions after F_stat'
///     correct   those after G', cell by cell again

#pragma once

#include "core/macro/kinds.h"
#include "core/macro/macro_priv.h"

/// Rows of one thread.
typedef struct kinds_rows {
    double *lean;     ///< of faces of a row: scale of the slope of the cell that cargo comes from
    double *sum;      ///< of the present row's masses over the kinds
    double *flux1;    ///< of a kind across the x1-faces of the present row
    double *flux2[2]; ///< of all kinds across the x2-faces south of a row, by row & 1
} kinds_rows;

/// The loops of the phases over row j, one build for each instruction set.
typedef struct kinds_kernels {
    void (*split)(const macro_solver *s, ptrdiff_t j);   ///< row n2, too, which has x2-faces alone
    void (*prepare)(const macro_solver *s, ptrdiff_t j); ///< see above
    /// Before the first row of a thread's carry(), which then takes rising rows: what crosses the faces south of it.
    void (*begin)(const macro_solver *s, ptrdiff_t j, kinds_rows *rows);
    void (*carry)(const macro_solver *s, ptrdiff_t j, kinds_rows *rows);   ///< see above
    void (*correct)(const macro_solver *s, ptrdiff_t j, kinds_rows *rows); ///< see above
} kinds_kernels;

/// The fractions and what a step needs.
struct kinds {
    size_t n;              ///< kinds
    double *fractions;     ///< of each cell n, layout of grid.h
    double *fallen;        ///< of each cell n: densities that fell since t = 0; NULL: nothing may
    ptrdiff_t plane;       ///< doubles of a plane
    double *before;        ///< n planes: with which the step began
    double *carried;       ///< n planes: after F_stat'
    double *flux[2];       ///< F_stat' across x1- and x2-faces, times dt/dx: densities
    double *correction[2]; ///< G' across them
    bool *flows[2];        ///< per row of faces: a flux is not 0
    bool *corrects[2];     ///< same for correction
    double *density;       ///< after F_stat'
    double *inverse;       ///< 1/rho with which the step began; 1 where that is 0
    double *slope[2];      ///< along both axes theta/2, as far as what stays allows; 0: none
    kinds_rows *rows;      ///< of each thread
    double *storage;       ///< of all rows above
    kinds_kernels kernels; ///< of this processor
};

/// Columns of a row in which a step may have moved cargo, in whole blocks; none of rows outside the grid.
static inline block_span kinds__columns(const macro_solver *s, ptrdiff_t j)
{
    return j < 0 || j >= s->n2 ? (block_span){ 0, 0 }
                               : block_span_hull(s->now.span[j], s->next.span[j]);
}

#ifdef CPU_BUILD
#define kinds__kernels CPU_NAME(kinds__kernels)
extern const kinds_kernels kinds__kernels;
#endif
