/// How much of the outlet beside a plate's free end is lost to cargo: apertures of faces, for the congested closure.
///
/// Parts that come along a plate turn around its end, and the first ones pass it at a distance: the outlet is as if
/// the plate went on across the belt by
///
///     delta = tip r sin^2(theta)
///
/// with r the radius of the parts' footprint and theta the angle between plate and belt. In the microscopic
/// model the rate through funnels of openings w is kappa rho_max v_T (w - 2 delta): a line through four openings
/// gives delta, which is that of a single plate of the angle too (core/macro/congested/README.md). The plate's own end is
/// exact as well: of a face that plate and extension cover in part, the rest stays open.
///
/// Units    SI.

#pragma once

#include "core/base/status.h"
#include "core/macro/velocity_field.h"

/// Radius of the footprint of the largest kind of cargo, m.
double aperture_radius(const scene *s);

/// Fill the apertures of a field whose closed faces are complete, and reopen closed ones that plates cover in
/// part only. The arrays are all 1 before, and 0 on closed faces after.
void aperture_apply(const scene *s, velocity_field *f);
