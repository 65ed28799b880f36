/// The velocity of a belt with lanes (core/scene/belt.h), an arc or a straight of a path aslant, at faces, such that what it carries
/// stays on it and a uniform density stays uniform. "Arc" stands for either below.
///
/// The velocity is the curl of the stream function psi of the place q across the belt, of a belt that turns its distance to the centre,
///
///     v1 = -(psi_north - psi_south)/d2,    v2 = (psi_east - psi_west)/d1
///
/// with psi at the corners of the grid: at the face centre this is v_T. Borders and guides are stairs on the grid, which v_T
/// crosses. So psi is that of the border at each corner of a cell that lies beside it, beyond one of the circles, and that of
/// the guide at both corners of each face that a guide on the arc closes; a guide nearer than a cell to a border counts as that border.
/// Cells have their centres on either side of a border, and a guide is a polyline beside it: so that nothing is pushed through between
/// both, faces on a border with a guide nearer than a cell are closed.
/// Differences of psi sum up to 0 around a cell, whatever psi is: no flux crosses border or guide, and the field is free of
/// divergence to rounding.
///
/// The q' that counts for psi at any other corner is its own, as far as that differs from the q of each of these
/// corners by at most ARC_LANES_SPREAD times their distance; else the nearest one that does. So what the stairs lack is spread over
/// some cells, and velocities are at most those of core/scene/arc_lanes.h.

#pragma once

#include "core/base/status.h"
#include "core/macro/velocity_field.h"
#include "core/scene/surroundings.h"

/// The corners of the grid on an arc and two cells around it.
typedef struct arc_corners {
    size_t arc;     ///< index of the belt
    size_t i_first; ///< first column of corners
    size_t j_first; ///< first row
    size_t n1;      ///< columns
    size_t n2;      ///< rows
    double *lane;   ///< n2 rows of q', m
    double *own;    ///< of each corner q of its border or guide, else its own, m
    uint8_t *line;  ///< nonzero: the corner has the q of a border or guide
    double *before; ///< scratch: q' before an update
    scene_rect box; ///< that holds the arc and two cells around it, m
} arc_corners;

/// The arcs of a scene; zero-initialise.
typedef struct arc_faces {
    size_t n;          ///< arcs
    arc_corners *arcs; ///< of each, by rising index of the belt
} arc_faces;

/// Lay out the corners of all arcs. The caller owns them: arc_faces_fini(). BF_ENOMEM: *ret_faces is empty.
BF_MUST_CHECK bf_status arc_faces_init(arc_faces *ret_faces, const scene *s, const bf_grid *g);

/// Free what *faces owns and zero it.
void arc_faces_fini(arc_faces *faces);

/// Bring q' of all corners to the closed faces of *f, which differ from those of the last time within these n rectangles, m, alone.
/// Writes rectangles that hold all faces whose velocities change by that, at most one for each arc, and returns how
/// many. Never allocates.
size_t arc_faces_update(arc_faces *faces, const velocity_field *f, const scene *s,
                        const surroundings *around, size_t n, const scene_rect *changed,
                        scene_rect *ret_due);

/// True if x1-face (axis 0) or x2-face (axis 1) i, j lies on a curved border of an arc that a guide holds.
bool arc_faces_is_held(const velocity_field *f, const scene *s, const surroundings *around,
                       size_t arc, int axis, size_t i, size_t j);

/// The velocity across x1-face (axis 0) or x2-face (axis 1) i, j of an arc, m/s.
double arc_faces_velocity(const arc_faces *faces, const bf_grid *g, const scene_belt *belts,
                          size_t arc, int axis, size_t i, size_t j);
