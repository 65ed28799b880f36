/// What gravity does to cargo on a belt that rises or falls.
///
/// Places, velocities and outlines are those on the surface of the belts, laid out flat. A belt of incline alpha rises by
/// sin(alpha) for each metre in the direction b of its velocity, and falls where alpha is negative. A part of mass m there
///
///     is pulled along the belt by    -m g sin(alpha) b
///     is pressed onto it by           m g cos(alpha)
///
/// and does not slide off a belt of friction mu while |tau| < 1, tau = tan(alpha)/mu.
///
/// Choice   the friction (7) is 0 where nothing slips, so that all cargo would creep down. Its slip u is therefore counted from a
///          velocity beside the belt's, v_T + h with h = artanh(tau)/lambda b: friction then bears the pull on what moves
///          with its belt. |tau| counts as BELT_SLOPE_HELD at most; on steeper belts cargo slides.
/// Units    SI.

#pragma once

#include "core/scene/types.h"

/// Largest |tau| at which cargo is held without slip.
#define BELT_SLOPE_HELD 0.95

/// The acceleration -g sin(alpha) b, m/s2; zero on a level belt.
vec2 belt_slope_pull(const scene_belt *belt, double gravity);

/// tau: 0 on a level belt, infinite on one without friction. The conveyor's friction counts where the belt has none of its own.
double belt_slope_ratio(const scene_belt *belt, const scene_contact *conveyor);

/// The velocity h, m/s; zero on a level belt.
vec2 belt_slope_hold(const scene_belt *belt, const scene_contact *conveyor);

/// What a belt accelerates slower cargo by, in units of g: mu cos(alpha) - sin(alpha).
double belt_slope_drive(const scene_belt *belt, const scene_contact *conveyor);

/// What any of these belts changes the speed of cargo by, in units of g: the largest, mu cos(alpha) + |sin(alpha)|, and the
/// least, mu cos(alpha) - |sin(alpha)|, at least 0. Without belts the conveyor's mu.
double belt_slope_largest_drive(size_t n_belts, const scene_belt *belts,
                                const scene_contact *conveyor);
double belt_slope_least_drive(size_t n_belts, const scene_belt *belts,
                              const scene_contact *conveyor);
