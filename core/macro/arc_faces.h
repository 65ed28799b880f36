/// The velocity of an arc (core/scene/belt.h) at faces, such that what it carries stays on it and a uniform density stays uniform.
///
/// The velocity of a belt that turns is the curl of a stream function of the distance r to its centre,
///
///     psi = turn r^2/2,    v1 = -(psi_north - psi_south)/d2,    v2 = (psi_east - psi_west)/d1
///
/// with psi at the corners of the grid: at the face centre this is v_T. Borders and guides are stairs on the grid, which v_T
/// crosses. So psi is that of the border at each corner of a cell that lies beside it, beyond one of the circles, and that of
/// the guide at both corners of each face that a guide on the arc closes; a guide nearer than a cell to a border counts as that border.
/// Cells have their centres on either side of a border, and a guide is a polyline beside it: so that nothing is pushed through between
/// both, faces on a border with a guide nearer than a cell are closed.
/// Differences of psi sum up to 0 around a cell, whatever psi is: no flux crosses border or guide, and the field is free of
/// divergence to rounding. A velocity beside a border is at most ARC_FACES_SPEEDUP times v_T at it.

#pragma once

#include "core/macro/velocity_field.h"
#include "core/scene/surroundings.h"

/// Of a face next to a corner: that corner lies at most 0.71 cells inside of the border, the other one a cell further in.
#define ARC_FACES_SPEEDUP 1.71

/// True if x1-face (axis 0) or x2-face (axis 1) i, j lies on a curved border of an arc that a guide holds.
bool arc_faces_is_held(const velocity_field *f, const scene *s, const surroundings *around,
                       size_t arc, int axis, size_t i, size_t j);

/// The velocity across x1-face (axis 0) or x2-face (axis 1) i, j of an arc, m/s, by the closed faces of *f.
double arc_faces_velocity(const velocity_field *f, const scene *s, const surroundings *around,
                          size_t arc, int axis, size_t i, size_t j);
