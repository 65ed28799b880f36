/// The layout: how plates and walls stand to the belts, and how much room they leave for cargo.
///
///     angle    between a straight piece of a plate and the velocity of the belt in its middle, 0 to 90
///              degrees; 180 degrees less it, where the piece leads cargo into a corner from which it
///              cannot slide on: a plate that leans against the belt, or a wall or another piece at its
///              downstream end that lies on the cargo's side and leads back upstream
///     opening  plates and walls that touch are one body; the narrowest opening is the smallest distance
///              of two bodies, one of them with a plate, across a moving belt. It is 0 where plates join two
///              opposite walls. A gap that no part of any kind fits through is none, but where it is all that two opposite
///              walls, joined by plates and such gaps, leave, or where there is nothing else. What lies behind a
///              plate, where no belt brings cargo and nothing ahead would spread it to, is none; nor is one
///              between guides, or a guide and a wall, to which no belt brings cargo
///     stagger  how far two bodies with plates are apart along the belt where they are nearest to each other: 0 where the ends of a
///              funnel's plates are opposite each other
///     free ends    of a body with plates that touches no wall, and leaves each of them a gap that a part fits through: cargo gets
///              past both
///     run-out  the way along the belt from the downstream end of a plate, unless that closes the belt or ends in a corner, to where
///              the domain ends
///     next belt    the way along the belt from such an end to where a straight belt of another velocity begins, half a radius of the
///              largest part long or longer
///     short end    how far the downstream end of a plate, or of what deflects cargo before a bend along the belt, stands off the wall that
///              the plate begins at
///
/// Plates are solid with their thickness, and are looked at as far as they lie in the domain, or beyond a
/// side where cargo flows in. Pieces along their belt are guides: they bound openings and deflect nothing. A gap at a wall of at most half a
/// cell is none, as the macroscopic grid closes it.
///
/// Units    SI, angles in degrees.

#pragma once

#include "core/base/status.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    LAYOUT_PIECES_MAX = 1024, ///< straight pieces of all plates up to which a layout is measured
    LAYOUT_NEXT_BELT =
        16 ///< diameters of the largest part within which the next belt is looked for
};

/// A number and what it belongs to.
typedef struct layout_figure {
    double value; ///< see where it is used
    size_t index; ///< of the obstacle or the side that it belongs to
} layout_figure;

/// Figures of a layout. Those of plates are only valid if n_plates > 0.
typedef struct layout {
    size_t n_pieces;        ///< straight pieces of all plates
    bool is_measured;       ///< pieces and steps are within limits; else nothing below is known
    size_t n_plates;        ///< obstacles with a piece that deflects cargo
    size_t n_guides;        ///< obstacles whose pieces all run along their belts
    layout_figure least;    ///< smallest angle of such a piece; index of the obstacle
    layout_figure greatest; ///< largest angle of such a piece; index of the obstacle
    layout_figure bends;    ///< most bends of an obstacle, guides too; its index
    double least_bends;     ///< bends of the plate with the smallest angle
    layout_figure opening;  ///< the narrowest, m, INFINITY: none; index of an obstacle at it
    layout_figure gap;      ///< the same of gaps that no part fits through
    layout_figure stagger;  ///< of the two nearest to each other, m, INFINITY: no two; index of one
    layout_figure
        free_ends; ///< largest angle of such a piece of a free body, 0: there is none; index of the obstacle
    layout_figure run_out; ///< the least, m, INFINITY: to walls alone; index of the obstacle
    layout_figure
        next_belt; ///< the least, m, INFINITY: beyond LAYOUT_NEXT_BELT; index of the obstacle
    layout_figure
        short_end; ///< the least, m, INFINITY: no plate begins at a wall; index of the obstacle
    layout_figure wall_angle; ///< largest angle at which a belt runs against a wall, 0: none does;
                              ///< index of the side
} layout;

/// The least width of a gap that a part whose inner radius (mix_inner_radii_of()) is this one fits through, m.
double layout_least_width(double inner_radius);

/// Measure a resolved scene whose numbers and geometry were checked. BF_ENOMEM.
BF_MUST_CHECK bf_status layout_measure(const scene *s, layout *ret_layout, bf_error *err);
