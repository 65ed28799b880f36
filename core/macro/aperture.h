/// How much of the outlet beside a plate's free end, and of a lane between guides, is lost to cargo: apertures of faces, for the
/// congested closure.
///
/// Parts that come along a plate turn around its end and pass it at a distance, rub against each other, and have to be
/// brought to the belt's speed again. So the outlet is as if the plate went on across the belt by
///
///     delta = w (l - o/sqrt(1 + 0.9 v_T^2/(mu_b g o) sqrt(2 r/o)))
///     o = m (1 - exp(-n m/s))     s = 10 r e sqrt(mu_c/0.15) (1 + 2.5 min(cos^2(theta), 0.5))
///     m = l - r (1.2 c + 2 a + 0.4 b)                   c = sin^2(theta) (1 - f)
///           - r (0.9 c + 0.7 a + 0.4 b)                 if a wall, a guide or a plate's side is opposite
///     a = sqrt(mu_c) - sqrt(0.15)     b = sqrt(mu_h) - sqrt(0.19)     w = min(1, 4 sin(theta))
///     e = sqrt(R/r - 1)     f = max(1 - 2 e, 0) min(2 cos^4(theta), 1) if another plate's end is opposite, else 0
///
/// but not below 0, nor by more than 90 % of l, which is the way to what is opposite, half of it to another end. An end that is nearer to
/// a wall or another plate than r is no end but a part of these. r is the
/// radius of a disk with the mean footprint of the parts, theta the angle between plate and belt, v_T^2/(2 mu_b g) the
/// length in which the belt brings a part to its speed; mu_b, mu_c and mu_h are the frictions of cargo on belts, on
/// cargo and on what handles it, for a wall that of walls. e is the mean over the kinds of parts, R the radius about a part
/// and r that of a disk with its own footprint, 0 for cylinders. Parts with corners lie face to face
/// and arch over an outlet, n m wide with n = 2 between two plates' ends, else 1: arches close a share exp(-n m/s) of it, most of a
/// narrow one, nothing of a wide one. Their span s rises with the friction that holds them and as plates get shallower. Where
/// nothing is opposite there are none, and o is m. In a funnel the streams along both plates meet in the outlet and push each other
/// along, f, the more the shallower the plates are; parts with corners do not shear. w lets delta go to 0 at guides, whose ends cost nothing.
/// The root is 1 where nothing is opposite. It makes what a fast belt carries off independent of its speed, as o^(7/4)
/// sqrt(mu_b g): nearly as grains leave a hopper, o^(3/2) sqrt(g), whose speed is what they gain within the width of its outlet.
///
/// A plate that bends by more than 6 degrees into a guide along the belt, and along an axis of the grid, opens a lane: parts that were
/// brought together before it keep some room from the guide as far as it goes. There the guide is thicker by delta with
///
///     m = l - r (0.5 sin^2(theta) + 0.95 a + 0.63 b),   and r (0.95 a + 0.63 b) less if a wall is opposite
///
/// theta the angle of the piece before the bend, l half the way to another plate, or all of it to a wall; and v_T^2 is less by
/// (v_T cos^2(theta))^2, as what slides along the plate has that speed along the belt. So the lane's width is
/// exact, too, wherever in its cells the guide lies, but for what cells whose centres the guide covers lack.
///
/// Fitted to the microscopic model (tests/validation/lines.py, core/macro/congested/README.md). The plate's own end
/// is exact as well: of a face that plate and extension cover in part, the rest stays open.
///
/// Units    SI.

#pragma once

#include "core/base/status.h"
#include "core/macro/velocity_field.h"

/// Radius of a disk with the mean footprint of the cargo, by the shares of its kinds, m.
double aperture_radius(const scene *s);

/// Fill the apertures of a field whose closed faces are complete, and reopen closed ones that plates cover in
/// part only. The arrays are all 1 before, and 0 on closed faces after.
void aperture_apply(const scene *s, velocity_field *f);
