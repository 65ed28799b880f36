/// The length of a step of MICRO_IMPLICIT, and its number of iterations; in the plane
/// and in space.
///
/// The equations of a step couple parts by stiffness and by dashpots, in terms of their inertia,
///
///     2 h^2 k / m   and   2 h d / m,
///
/// and impulses spread over about as many parts in a step as the square roots of these. The number of
/// iterations grows with the number of layers of a jam, through which loads are transmitted;
/// less with dashpots, whose forces decay. Measured on Examples 1
/// and 2 and on jams of up to 40,000 parts for reductions of 1e2 to 1e6 and steps of 0.2 to 4 ms,
///
///     iterations^2 = 0.03 sqrt(N) 2 h^2 k / m + 0.4 2 h d / m
///
/// keep the outflow curve within 1 % of N of the explicit one and the kinetic energy of jams about the same: the
/// residual is reduced in the next step, which starts from the impulses of this one.
///
/// In the plane normal impulses are over-relaxed (successive over-relaxation, Young 1950) by 1.4 in all iterations but
/// the last one, so that a contact by itself is solved exactly. Then 0.008 instead of 0.03 does the same, measured on
/// the Examples, on Example 1 enlarged to 3,072 and 9,408 parts, and on a jam of 10,000 in a box, with steps of 2 ms.
///
/// The step that is chosen is the shortest of
///
///     2 ms
///     0.08 r / v            parts move by less than a twelfth of a radius: directions of contacts remain valid;
///                           in space 0.02 r / v, as corners and faces of bodies that turn take over
///                           each other's load
///     2.5 sqrt(m / k)       in space: a body of the smallest mass that the stiffest contact throws back turns, and comes
///                           to lie on other corners before the next step knows of them
///     0.2 / (lambda mu g), or 0.05 v / (mu g) if that is longer: the belt accelerates parts over many steps
///     where iterations(h) = 16 without over-relaxation: stiffer contacts take shorter steps instead of more
///                           iterations
///
/// with v the largest speed of a belt or of a plate at any time or of the parts at the start, and r the radius of a cylinder or
/// half the least width of another footprint.

#pragma once

#include "core/micro/micro.h"

/// Iterations in a step, in the plane or in space, for n_parts of a mass, kg, whose contacts have a stiffness, N/m, and a
/// dashpot, N s/m, in steps of h, s.
int implicit_step_iterations(bool is_planar, size_t n_parts, double h, double stiffness,
                             double damping, double mass);

/// About the iterations in a step of a checked definition: those of its extremes.
int implicit_step_effort(const micro_def *def, bool is_planar);

/// Over-relaxation, less 1, of an iteration in the plane: 0 <= iteration < n_iterations.
double implicit_step_excess(int iteration, int n_iterations);

/// r of a shape, m.
double implicit_step_radius_of(const scene_shape *shape);

/// The smallest r of any kind, m.
double implicit_step_radius(const micro_def *def);

/// Largest step that is allowed for a checked definition, s.
double implicit_step_stable(const micro_def *def);

/// The step that is chosen in the plane or in space, s.
double implicit_step_chosen(const micro_def *def, bool is_planar);
