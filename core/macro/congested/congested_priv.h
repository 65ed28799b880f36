/// Inside of the congested closure (core/macro/congested.h).
///
/// Cells are coloured like a chessboard, red where i + j is even, so that all cells of a colour can be relaxed at once. Each colour
/// has rows of its own, "half rows": cell k of row j is cell i = 2 k + (j & 1) of the red ones, i = 2 k + 1 - (j & 1) of the black
/// ones. Half rows -1 and n2 and margins on both sides hold zeros. Each face has exactly one red cell, so what belongs to faces
/// stands in half rows of red cells too: one array for their west faces, one each for east, south and north.
///
/// Every step is made by a team of threads that meet at barriers. What a thread writes depends on nothing that another one writes
/// between the same barriers, so the bits are the same for any number of threads.

#pragma once

#include "core/base/team.h"
#include "core/macro/congested.h"
#include "core/macro/macro_priv.h"
#include "core/scene/belt.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    CONGESTED_UNIT = 16, ///< half cells that are relaxed or skipped together: a register of floats
    CONGESTED_GROUP = 8, ///< half cells that have the law `uniform` together: half a unit
    CONGESTED_SWEEPS = 130, ///< most sweeps of a step
    CONGESTED_PRESSED_STEPS =
        3 ///< this step and those before it whose pressures a flux or gradient may still show
};

/// Part of its cargo that a cell may lose in a step.
#define CONGESTED_MOST_LOST (1.0 - 1e-9)

/// Factor of the over-relaxation.
#define CONGESTED_OMEGA 1.75

/// Rate at which a density above rho_j relaxes to it, 1/s.
#define CONGESTED_RELAXING_RATE 10.0

/// The faces of a red cell.
typedef enum congested_side {
    CONGESTED_WEST,
    CONGESTED_EAST,
    CONGESTED_SOUTH,
    CONGESTED_NORTH,
    CONGESTED_SIDES
} congested_side;

/// The law of the correction (see congested.h) at the faces on one side of the red cells, in half rows. With e the
/// face's normal, towards rising x, b the belt's direction and q its left normal. Fluxes are times dx1/dx2 at x2-faces.
typedef struct congested_law {
    float *slope;     ///< k, of G.b beyond G0 = max(0, rho_j (v_T - v_stat.b))
    float *offset;    ///< (1 - k) G0: beyond G0, G.b = k g.b + (1 - k) G0
    float *most;      ///< most G.b: G0 + B
    float *least;     ///< least G.b, below 0; 0 where the face is closed, and only there
    float *threshold; ///< of G.q, by internal friction; changes with every step
    float *lower;     ///< least G.q
    float *upper;     ///< most G.q
    float *along;     ///< e.b; NULL in a forward solver, and so are the next two
    float *across;    ///< e.q
    float *crosswise; ///< the pressure gradient along the face, g.(left of e), of the step before
    float *inner;     ///< G.b by g.b up to G0; NULL without has_drives, and so is the next one
    float *sideways;  ///< G.q by g.q beyond the threshold
    float *full_slip; ///< rho_j v_T of the belt under the face; itself also at x2-faces
    float *gain;      ///< threshold per slip: a quarter of tan phi of the belt's speed
    float *at_rest;   ///< full_slip where the face is closed, else 0
    float *flux;      ///< G.e after the iteration
} congested_law;
/// The law (above) of open faces where v_stat is the first belt's velocity, as in most of a jam. Its offset is 0.
typedef struct congested_uniform {
    float slope; ///< of x1-faces
    float most;  ///< of x1-faces
    float least; ///< of x1-faces
    float lower; ///< of x2-faces
    float upper; ///< of x2-faces
} congested_uniform;

/// Cells first <= k < last of both half rows of a row, in whole units, or faces of a row.
typedef struct congested_range {
    ptrdiff_t first; ///< of cells a multiple of CONGESTED_UNIT
    ptrdiff_t last;  ///< first where the row has none
} congested_range;

/// A thread's result of a phase, each on a cache line of its own.
typedef struct congested_slot {
    float residual;   ///< largest in the sweep
    bool is_limited;  ///< a cell would lose more than it has
    char padding[56]; ///< to the size of a cache line
} congested_slot;

/// A thread's rows of the scheme muscl. Arrays with two places are used in turn, row & 1.
typedef struct congested_rows {
    macro_face_states states1;    ///< along x1 of the present row
    macro_face_states states2[2]; ///< along x2 of the present row and of the one before
    double *flux1;                ///< x1 fluxes of the present row
    double *flux2[2];             ///< x2 fluxes into and out of the row before
} congested_rows;

/// A stage of the transport by the scheme muscl, as one thread makes it.
typedef struct congested_stage {
    const macro_state *from;  ///< density that it reads
    macro_state *to;          ///< density that it writes
    const macro_state *begin; ///< that before the step, to take the mean with it; NULL: none
    congested_rows *rows;     ///< the thread's
} congested_stage;

/// One build of the loops for an instruction set.
typedef struct congested_kernels {
    /// Relax red cells of rows first <= row < last, black ones of rows between, or black ones of one: largest change; sets is_unforced first.
    float (*relax)(const congested *c, ptrdiff_t first, ptrdiff_t last, bool is_first);
    float (*relax_black)(const congested *c, ptrdiff_t row, bool is_first);
    /// Fill the fluxes of the faces of these red cells of a row, and of its black ones on the sides of the grid.
    void (*make_flux)(const macro_solver *s, const congested *c, ptrdiff_t row,
                      congested_range cells);
    /// Transport of a row's cells i_min <= i < i_max by v_stat: rho* = rho - dt div(rho v_stat), upwind.
    void (*transport)(const macro_solver *s, ptrdiff_t row, ptrdiff_t i_min, ptrdiff_t i_max,
                      double *ret_rho);
    /// The same by the scheme muscl. The states of row r at its x2-faces, in states2; without effect outside the grid.
    void (*muscl_states_x2)(const macro_solver *s, const congested_stage *stage, ptrdiff_t r,
                            block_span span);
    /// The flux through the x2-faces south of row r, 0 <= r <= n2, in flux2, by the states of the rows beside them.
    void (*muscl_flux_x2)(const macro_solver *s, const congested_stage *stage, ptrdiff_t r,
                          block_span span);
    /// The stage of a row by flux2 and the fluxes along x1, which it makes.
    void (*muscl_update)(const macro_solver *s, const congested_stage *stage, ptrdiff_t row,
                         block_span span);
    /// The excess of a row's active cells, both colours; of those outside the grid it is negative.
    void (*set_excess)(const macro_solver *s, const congested *c, ptrdiff_t row);
    /// rho = rho* - dt div G of these cells of a row, both colours, in place in `next`.
    void (*correct)(const macro_solver *s, const congested *c, ptrdiff_t row,
                    congested_range cells);
    /// True if G takes more out of one of these cells than the part CONGESTED_MOST_LOST of what it holds in `next`.
    bool (*is_overdrawn)(const macro_solver *s, const congested *c, ptrdiff_t row,
                         congested_range cells);
    /// Bring the thresholds inside the grid of a row's red cells, where they may change, to the slip of this step; forward solvers only.
    void (*make_thresholds)(const macro_solver *s, const congested *c, ptrdiff_t row);
    /// Bring thresholds and crosswise gradients of the west and south faces of a row's cells, where they may change, to this step,
    /// but for those on the sides of the grid; for solvers that are not forward.
    void (*make_coupling)(const macro_solver *s, const congested *c, ptrdiff_t row);
} congested_kernels;

/// A belt at its present speed. What it drives cargo by, of what a level one does, is times chi of congested.h.
typedef struct congested_belt {
    double slower, faster, across; ///< cos(alpha) times 1 - tau, 1 + tau, 1
    double factor;                 ///< on its velocity
    double speed, grip,
        lateral; ///< if it does not turn: v_T, tanh(lambda v_T/2), most speed of cargo across it
} congested_belt;

/// The closure's state and what it precomputes.
struct congested {
    congested_kernels kernels; ///< of this processor
    bool is_forward; ///< belts are level and run along +x1: each direction has a law of its own
    bool has_drives; ///< a belt is not level, or runs onto another one across it
    bool has_standing, has_moving; ///< a belt stands, and one moves
    double jam_density, slip_rate; ///< rho_j; lambda, s/m
    double *aperture[2];           ///< open fraction of the x1- and x2-faces, layout of grid.h
    double *transverse[2];         ///< v_stat along these faces: its other component, m/s
    double *slide[2]; ///< v_stat across these faces times the aperture, at the factor 1, m/s
    double *loose[2]; ///< same for loose cargo, v_T in slide zones
    congested_range *sliding[2]; ///< per row: its faces from first to last where they differ
    bool *is_stale[2];           ///< per row: its faces have changed, and their laws have not
    uint16_t *belt[2];           ///< belt under these faces
    size_t n_belts;              ///< belts
    scene_belt *belts; ///< each, without corners and schedule, and one at rest off every belt
    double *fastest;   ///< largest speed on each of them at the factor 1, m/s
    double *slope_ratio,
        *onto; ///< tau of each (belt_slope.h); speed across one that it runs onto, at the factor 1, m/s
    congested_belt *present; ///< of each now
    bool *is_changed;        ///< these have, since the laws of their faces were made
    uint8_t closed_edge[4];  ///< west, east, south, north: nothing is corrected across it
    ptrdiff_t half_width;    ///< floats of a half row, with its margins
    ptrdiff_t half_stride;   ///< floats from half row to half row of an array
    float *storage;          ///< of all half rows: those of a row of all arrays lie together
    float *pressure[2];      ///< p/dx1 of red and black cells, m/s: a difference is -dp/dx1
    float *excess[2];        ///< rho* - C of them
    congested_law law[CONGESTED_SIDES]; ///< of the faces
    congested_uniform uniform;          ///< of a forward solver
    bool *is_uniform;       ///< per row, colour and group: all faces have the law `uniform`
    bool *is_unforced;      ///< same of registers: only a pressure beside its cells gives them one
    congested_range *range; ///< per row: the active cells of this step
    congested_range *found; ///< per row: those that the row itself asks for
    /// Per row: cells with a pressure, and some beside them; after this step, the one before it and so on.
    congested_range *pressed[CONGESTED_PRESSED_STEPS];
    congested_range *disturbed; ///< per row: cells beyond have no flux nor gradient along a face
    bool *is_unsettled;         ///< of units of a row: a threshold changed in the last step
    int n_unskipped; ///< next steps in which all active cells count as disturbed: laws or pressures are new
    double relaxed;                ///< congested_relaxed()
    ptrdiff_t first_row, last_row; ///< first row with active cells, and the one after the last
    double density_limit;          ///< density at which the run fails
    float ratio, steepness;        ///< dx1/dx2, and its square, by which pressures count along x2
    float relaxation, lambda;      ///< omega dx1/(2 (1 + ratio^2) dt); dt/dx1
    float *relaxations[2]; ///< with has_drives, of cells: omega over the slopes of their laws
    congested_slot *slots; ///< two of each thread, used in turn
    macro_state stage;     ///< density after the first stage and its spans (muscl; else NULL)
    double *stage_storage; ///< of all rows below (muscl; else NULL)
    congested_rows *rows;  ///< of each thread (muscl; else NULL)
};

#ifdef CPU_BUILD
/// Each build's table has a name of its own.
#define congested__kernels CPU_NAME(congested__kernels)
extern const congested_kernels congested__kernels;
#endif
