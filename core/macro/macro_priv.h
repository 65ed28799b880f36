/// Inside of the macroscopic solver.
///
/// A step has one stage or more. A stage reads the density `now` and writes `next`, in one pass over the rows in rising
/// order; then the two change places. By the scheme roe, whose step is one stage (muscl: sweep_muscl.c):
///
///     row r:  I at row r where H may not be zero (the x1 part of the convolution of rows r-S .. r+S waits
///             in a ring, so each is made once);
///             x1 sweep of row r, from now into next;
///             flux between rows r-1 and r; x2 sweep of row r-1, in place in next.
///
/// Rows have `margin` doubles before cell 0 and room for the S cells of the mollifier behind the last cell.
/// Outside the grid they hold zeros, or the mirrored density, which only the convolution sees: the
/// faces of a mirroring edge are closed.
///
/// Threads each take a band of rows and repeat the x1 sweep of the rows next to it for themselves, so
/// they share no data and every bit is the same for any number of bands.

#pragma once

#include "core/base/cpu.h"
#include "core/macro/active_blocks.h"
#include "core/macro/macro.h"
#include "core/macro/mollifier.h"

/// Faces of one direction, in rows. Face i of a row is (i + 1/2, row) for x1, -1 <= i < n1; for x2 row
/// r holds the faces (i, r - 1/2), 0 <= r <= n2.
typedef struct macro_faces {
    double *v;               ///< static velocity; 0 on closed faces and where there is no face
    uint64_t *mixed;         ///< per row the blocks with another velocity than the uniform one
    uint64_t *closable;      ///< per row the blocks with at least one closed face
    uint64_t *closed_blocks; ///< per row the blocks with only closed faces
    uint8_t *closed;         ///< per row and block: bit k is set if face 8 b + k is closed
    double *v_full;          ///< like v, at the factor 1 of every belt; NULL if no speed changes
    uint16_t *belt;          ///< like v: index of the belt under the face; NULL if no speed changes
} macro_faces;

/// The density at one time.
typedef struct macro_state {
    double *rho;            ///< n2 rows
    block_span *span;       ///< per row: what is not zero lies within
    uint64_t *active;       ///< per row: blocks in which H may not be zero
    uint64_t *active_first; ///< per row: those of them in whose first cell it may not be
} macro_state;

/// A row after its x1 sweep.
typedef struct macro_row_after_x1 {
    const double *rho;      ///< cell 0
    uint64_t *active;       ///< blocks in which H may not be zero
    uint64_t *active_first; ///< those of them in whose first cell it may not be
    block_span span;        ///< what is not zero lies within
} macro_row_after_x1;

/// A row of I.
typedef struct macro_dispersion_row {
    ptrdiff_t row;  ///< which row of the grid
    double *i1;     ///< I1 at its x1-faces
    double *i2;     ///< I2 at its northern x2-faces
    uint64_t *done; ///< blocks that were made in this step
} macro_dispersion_row;

/// States at the faces of a row of cells (muscl.h): along x1 element i belongs to face i + 1/2, along x2 to cell i.
typedef struct macro_face_states {
    double *left;  ///< of the cell before the face; at the cell's northern face
    double *right; ///< of the cell behind the face; at the cell's southern face
} macro_face_states;

/// A row of the ring: the x1 part of the convolution of a row of the grid.
typedef struct macro_ring_row {
    double *gradient1; ///< sums with gradient weights
    double *integral1; ///< sums with integral weights
    uint64_t *done;    ///< blocks that were made in this step
} macro_ring_row;

/// A thread's rows and what it needs for them. Arrays of two are used in turn, row & 1.
typedef struct macro_band {
    const macro_solver *solver; ///< whose
    ptrdiff_t first;            ///< first row
    ptrdiff_t last;             ///< row after the last
    macro_swept swept;          ///< by its sweeps
    char *bytes;                ///< of all that follows
    uint64_t *expected;   ///< per row of the grid: blocks whose I this step will probably need
    uint64_t *near;       ///< at j + S: blocks that the rows within S of row j expect
    macro_ring_row *ring; ///< n_ring of them; row r of the grid is row r mod n_ring
    ptrdiff_t ring_end;   ///< rows below have been through the ring
    const double **gradient_ring; ///< gradient1 of all rows of the ring, twice over: any window
                                  ///< of consecutive rows stands together
    const double **integral_ring; ///< same for integral1
    const double **gradient_rows; ///< scratch: such a window where rows are mirrored or missing
    const double **integral_rows; ///< same
    macro_dispersion_row dispersion[2]; ///< I of the current row and of the one before
    macro_row_after_x1 after_x1[2];     ///< the current row and the one before after their x1 sweep
    double *outside[2];                 ///< x1 sweeps of the rows before and after the band
    uint64_t *outside_active[2];        ///< their sets
    uint64_t *outside_first[2];         ///< same
    macro_face_states states1;          ///< along x1 of the current row (MUSCL)
    macro_face_states states2[2]; ///< along x2 of the current row and of the one before (MUSCL)
    double *flux1;                ///< x1 fluxes of the current row
    double *flux2[2];             ///< x2 fluxes into and out of the row before; 0 outside flux2_set
    uint64_t *flux2_set[2];       ///< blocks with such a flux
    uint64_t *ahead;              ///< blocks with a flux into the row ahead (MUSCL)
    uint64_t *active_faces;       ///< x1-faces of the current row with H not zero on a side
    uint64_t *wanted;             ///< blocks whose I is requested
    uint64_t *missing;            ///< of them, those that macro__dispersion_make() has to make
    uint64_t *unexpected;         ///< of them, those that band->expected lacks
    uint64_t *todo;               ///< scratch
    uint64_t *special;            ///< blocks of cells whose x1 fluxes are made one by one
    uint64_t *empty;              ///< an empty set
} macro_band;

/// Make a stage of a step for the band's rows.
typedef void macro_sweep_fn(macro_band *band);

/// The sweep of a scheme as built for an instruction set, and for grids whose sets of blocks are a single
/// word (is_narrow: there the loops over words vanish, which are a third of the work of a small grid) or
/// have any number. All builds give the same bits.
macro_sweep_fn *macro__sweep_of(scene_scheme scheme, cpu_level level, bool is_narrow);

/// The solver.
struct macro_solver {
    macro_def def;               ///< without its arrays
    struct congested *congested; ///< of SCENE_CONGESTED; else NULL
    struct tracers *tracers;     ///< of tracer_portion; else NULL
    macro_sweep_fn *sweep;       ///< macro__sweep_of()
    int n_stages;                ///< of a step
    int stage;                   ///< the present one, from 0
    bool records;                ///< it records velocities of cargo (cargo_velocity.h)
    mollifier along;             ///< weights along x1
    mollifier across;            ///< weights along x2
    double lambda1;              ///< dt/dx1
    double lambda2;              ///< dt/dx2
    double uniform1;             ///< velocity of most x1-faces, >= 0; that of most x2-faces is 0
    double uniform1_full;        ///< same at the factor 1
    uint16_t uniform_belt;       ///< belt under these x1-faces, if a speed changes
    const belt_speeds *speeds;   ///< of the definition's belts; NULL: none changes
    double *
        factors; ///< sizes of those of each belt, and off every belt, as they are in v and uniform1
    double *factors_next; ///< scratch of macro__faces_update()
    ptrdiff_t n1;         ///< cells of a row
    ptrdiff_t n2;         ///< rows
    ptrdiff_t n_blocks;   ///< blocks of a row
    size_t n_words;       ///< words of a set of blocks
    ptrdiff_t margin;     ///< doubles before cell 0, a multiple of BLOCK_CELLS
    ptrdiff_t stride;     ///< doubles from row to row, a multiple of BLOCK_CELLS
    ptrdiff_t n_ring;     ///< rows of a ring
    macro_faces faces1;   ///< n2 rows
    macro_faces faces2;   ///< n2 + 1 rows
    double *open1;     ///< n2 rows of cells: 0 beside a closed x1-face, else 1 (MUSCL; else NULL)
    double *open2;     ///< same for the x2-faces
    macro_state now;   ///< at the present time
    macro_state next;  ///< what a step writes
    double *zero_row;  ///< a row of zeros
    double *cost;      ///< per row: estimated work in the step before
    int n_bands;       ///< bands, one per thread
    macro_band *bands; ///< n_bands of them
    uint8_t *off;      ///< of the definition, or NULL
    double *fallen; ///< of each cell: sum of the densities that fell since t = 0; NULL without off
    struct kinds *kinds; ///< NULL: kinds are not told apart
    uint64_t steps;      ///< made since t = 0
    uint64_t n_fields;   ///< given by macro_set_field()
};

/// Cell 0 of row j of rows.
static inline double *macro__row(const macro_solver *s, double *rows, ptrdiff_t j)
{
    return rows + j * s->stride + s->margin;
}

/// Set of row j of per-row sets.
static inline uint64_t *macro__set(const macro_solver *s, uint64_t *sets, ptrdiff_t j)
{
    return sets + j * (ptrdiff_t)s->n_words;
}

/// Closed masks of row j; block b is element b.
static inline const uint8_t *macro__closed(const macro_solver *s, const macro_faces *faces,
                                           ptrdiff_t j)
{
    return faces->closed + j * (s->n_blocks + 1) + 1;
}

/// Belts under the faces of row j; face i is element i. Only where a speed changes.
static inline uint16_t *macro__belts(const macro_solver *s, const macro_faces *faces, ptrdiff_t j)
{
    return faces->belt + j * s->stride + s->margin;
}

/// Allocate both sets of faces and fill them from the definition's arrays. BF_ENOMEM.
BF_MUST_CHECK bf_status macro__faces_init(macro_solver *s, const macro_def *def);
void macro__faces_fini(macro_solver *s);

/// Bring the velocities of all faces to the step that begins now. True if they have changed.
bool macro__faces_update(macro_solver *s);

/// Fill the cells of a row outside the grid: zeros or the mirrored density.
void macro__fill_margins(const macro_solver *s, double *row);

#if defined(CPU_BUILD) && defined(MACRO_IS_NARROW)
/// For the files that are compiled once per instruction set, and for narrow and wide grids: each build's
/// functions have names of their own.
#if MACRO_IS_NARROW
#define macro__dispersion_begin CPU_NAME(macro__dispersion_begin_narrow)
#define macro__dispersion_make  CPU_NAME(macro__dispersion_make_narrow)
#define macro__sweep_roe        CPU_NAME(macro__sweep_roe_narrow)
#define macro__sweep_muscl      CPU_NAME(macro__sweep_muscl_narrow)
#else
#define macro__dispersion_begin CPU_NAME(macro__dispersion_begin_wide)
#define macro__dispersion_make  CPU_NAME(macro__dispersion_make_wide)
#define macro__sweep_roe        CPU_NAME(macro__sweep_roe_wide)
#define macro__sweep_muscl      CPU_NAME(macro__sweep_muscl_wide)
#endif

/// Words of a set of blocks, known to the compiler where it is one.
static inline size_t macro__words(const macro_solver *s)
{
    return MACRO_IS_NARROW ? 1 : s->n_words;
}

/// A new step begins: nothing of I is made, and band->expected is worked out for its rows.
void macro__dispersion_begin(macro_band *band);

/// Make I of row r for the blocks in band->wanted that were not made yet; -1 <= r < n2.
void macro__dispersion_make(macro_band *band, ptrdiff_t r);

/// A stage of a step for the band's rows, by scheme.
void macro__sweep_roe(macro_band *band);
void macro__sweep_muscl(macro_band *band);
#endif
