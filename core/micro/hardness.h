/// How hard contacts must be so that parts hardly overlap, from the loads that a definition can have.
///
/// A line of parts from a plate or wall up to where its belt begins is pushed by the friction of the belt, and stops with
/// its first part. A mass M that a force F = mu g M pushes is stopped from a speed v by a spring k within an overlap
///
///     delta = (F + sqrt(F^2 + k M v^2)) / k,     k = (M v^2 + 2 F delta) / delta^2,
///
/// since k delta^2/2 = M v^2/2 + F delta. M is the mass of the longest line, times 2, as arches gather
/// several lines in one contact, and at most that of all parts; v is the largest speed of a belt or of the parts at the
/// start. A plate that moves at u strikes a line's first part, of mass m, and the impact goes on from part to part: each
/// of its contacts takes up m u^2, times 2 as above, which counts instead of M v^2 where it is more. k is the stiffness
/// (4b) of the softest pair of materials, in space that of a corner (manifold.h).
/// A dashpot d by a part of mass m couples velocities by d/m, which grows without bound as parts become light while k/m does
/// not: the loads above go with the mass. At more than 4 times critical damping, 2 sqrt(k m), a contact closes and opens
/// without bouncing anyway, so that d need not be more.
/// Measured on lines of cans, jars, kegs, bottles and cartons before plates (tests/validation/README.md).

#pragma once

#include "core/micro/micro.h"

/// The largest overlap to expect with def->modulus_reduction, as a share of the smallest radius (micro_totals).
double hardness_expected_overlap(const micro_def *def);

/// The largest modulus_reduction, 1 to 10^6, with which that is at most hardness_goal; 1 if none is.
double hardness_reduction(const micro_def *def);

/// The next one while a run is pressed harder than foreseen: contacts are twice as stiff, at most as materials are.
double hardness_harder(double reduction);

/// A dashpot, N s/m, between parts whose inverse masses, 1/kg, sum to inverse_mass, with a stiffness, N/m: where the program
/// chooses the hardness of implicit steps at most 4 times critical damping.
double hardness_dashpot(const micro_def *def, double dashpot, double stiffness,
                        double inverse_mass);

/// The modulus_reduction that a solver uses now.
double micro_reduction(const micro_solver *s);

/// The overlap that hardness_reduction() aims at, as a share of the smallest radius.
extern const double hardness_goal;

/// Of kinds of parts whose masses have a larger ratio light ones are squeezed by heavy ones faster than contacts follow: runs may fail, or
/// take so long that they do not end. Up to it overlaps are at most 7 % of a radius at the defaults.
extern const double hardness_masses_most;

enum { HARDNESS_STEPS = 32 }; ///< after so many steps a run may become harder
