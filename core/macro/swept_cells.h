/// Plates push the cargo of the cells that they sweep over to the side that they move towards.
///
/// A plate that turns or is shifted from one place to another sweeps over the cells whose centres its closed line passes: in the
/// plate's own frame such a centre moves across the line. What these cells hold would be on the plate's other side.
/// It goes to the nearest cells ahead instead:
///
///     a search, cell by cell from the swept one, straight ahead first, through faces that are open (those of swept
///     cells: that were open before), over cells that are not behind the plate's line, extended beyond its ends;
///     each cell found is filled up to the density `full`; what comes to a side over which cargo leaves, and
///     towards which the plate moves, leaves there;
///     what is left after SWEPT_CELLS_SEARCH cells, or where no more can be reached, is spread evenly over all
///     that were found; where none was found, as in a gap that the plate has closed, it stays.
///
/// So nothing passes a line, the density exceeds `full` only where there is no room, and mass is conserved to
/// rounding. Cells, and plates, are taken in the order of their indices.
///
/// Units    SI; rho normalised.

#pragma once

#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/macro/closed_lines.h"
#include "core/macro/macro.h"
#include "core/macro/velocity_field.h"
#include "core/scene/plate_pose.h"

enum { SWEPT_CELLS_SEARCH = 1 << 14 };

/// A plate that has moved.
typedef struct swept_cells_plate {
    size_t n_lines;           ///< of its closed line
    const closed_line *lines; ///< as in the document
    plate_pose before;        ///< where it was
    plate_pose after;         ///< where it is
    double turned;            ///< angle between both, counter-clockwise, rad
    double moved;             ///< how far its points have moved at most, m
} swept_cells_plate;

/// Cargo as the load counts it.
typedef struct swept_cells_cargo {
    surroundings around; ///< its belts, and the radius of the narrowest part
    double full;         ///< density up to which cells take cargo
    double
        most; ///< density of a swept cell, beyond which cargo has to give way before the plate goes on
    double weight;                 ///< mu g m of a cell at density 1, mu that of *conveyor, N
    double mass;                   ///< m, kg
    double gravity;                ///< g, m/s2
    const scene_contact *conveyor; ///< of cargo on belts that name no friction
    double radius;                 ///< R, m
} swept_cells_cargo;

/// What is needed for it; opaque.
typedef struct swept_cells swept_cells;

/// Room for a grid with these edges, [SCENE_SIDE_COUNT]. The caller owns *ret_cells: swept_cells_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status swept_cells_create(const bf_grid *grid, const scene_edge *edges,
                                           swept_cells **ret_cells, bf_error *err);

/// Free it. NULL is fine. Always returns NULL.
swept_cells *swept_cells_destroy(swept_cells *c);

/// Plates are about to move: remember which faces of the field are closed, and forget all swept cells.
void swept_cells_begin(swept_cells *c, const velocity_field *f);

/// Mark the cells that a plate has swept over since.
void swept_cells_mark(swept_cells *c, const swept_cells_plate *plate);

/// What holds a plate back; INFINITY both: there is no room, or a cell holds more than `most`.
typedef struct swept_cells_load {
    double torque; ///< against its turn, N m, >= 0
    double force;  ///< against its shift, N, >= 0
} swept_cells_load;

/// What it would take to turn a plate at w, rad/s, and to shift it at v, m/s, either of which may be 0: cargo in the cells that it
/// would sweep over, and in those around them up to where there is room for the former, slides on its belts as it moves with the
/// plate. The way around its free ends counts where it is as wide as a part.
///
///     u      = w min(r, R) e: the velocity of cargo at r from the pivot, e its direction, R the plate's radius
///     s      = u - b, b the belt's velocity under it
///     torque = sum over these cells of mu g m tanh(lambda |s|) max(0, s.e)/|s| min(r, R)
///     force  = the same with u = v and e its direction, without the lever min(r, R)
///
/// Each drive bears what the other one would have to push, were it alone (**choice**). *f is the field of the plate's present place,
/// `before`. Never allocates.
swept_cells_load swept_cells_find_load(swept_cells *c, const swept_cells_plate *plate,
                                       const swept_cells_cargo *cargo, const velocity_field *f,
                                       double w, vec2 v, macro_solver *s);

/// Displace what lies in the marked cells of a plate; *f is the field of the plates' new places. Never allocates.
void swept_cells_displace(swept_cells *c, const swept_cells_plate *plate, const velocity_field *f,
                          double full, macro_solver *s);
