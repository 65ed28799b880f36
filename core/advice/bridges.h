/// Bridges: how likely parts that queue before a narrow opening hold each other and stop for good.
///
/// A density cannot show it. The microscopic model at its defaults was run with cylinders before openings of 1.25 to 5
/// diameters until the queue had stopped so often, or so many parts had passed (tests/validation/bridges.py); each part
/// that passes is one chance to stop, as in experiments, where the sizes of avalanches are geometric (K. To, P.-Y. Lai,
/// H. K. Pak, Phys. Rev. Lett. 86 (2001) 71; A. Janda et al., EPL 84 (2008) 44002). With the table of what was measured,
///
///     h = stops / parts that passed      where a queue stopped; else the least of half a stop by the parts that passed there,
///                                        the same over all angles and frictions of the opening, and what the next
///                                        narrower opening has times exp(-b (w^2 - w'^2))
///     probability within n parts = 1 - (1 - h)^n
///
/// and ln h linear between the openings w, angles and frictions of the table, and as at their ends beyond. Openings wider
/// than the table's are taken to have none. b is what the rows of the table fall with from 2 diameters on.
///
/// Units    openings in diameters of the largest part, angles in degrees.

#pragma once

#include "core/advice/layout.h"
#include "core/scene/scene.h"

#include <stdbool.h>

enum { BRIDGES_ANGLES = 3, BRIDGES_FRICTIONS = 3, BRIDGES_OPENINGS = 8 };

/// What was measured at an angle, a friction and an opening.
typedef struct bridges_cell {
    double passed; ///< parts; 0: not measured, as two narrower openings had no stop
    double stops;  ///< queues that stopped for good after them
} bridges_cell;

/// The table; has_two_plates, angle, friction, opening. Written by tests/validation/bridges.py --table.
extern const double bridges_angles[BRIDGES_ANGLES]; ///< of the plates to the belt, rising
extern const double
    bridges_frictions[BRIDGES_FRICTIONS]; ///< of parts on parts and on plates, their sum, rising
extern const double bridges_openings[BRIDGES_OPENINGS]; ///< rising
extern const bridges_cell bridges_table[2][BRIDGES_ANGLES][BRIDGES_FRICTIONS][BRIDGES_OPENINGS];

/// An opening before which parts queue.
typedef struct bridges_outlet {
    bool has_two_plates; ///< between the ends of two plates; else of a plate and a wall
    double opening;      ///< diameters
    double angle;        ///< of the plates to the belt, degrees
    double friction;     ///< of parts on parts and on plates, their sum
} bridges_outlet;

/// The probability that the queue stops for good while n parts would pass.
double bridges_probability(const bridges_outlet *at, double n);

/// The same of the narrowest opening of a scene with this layout and this diameter of the largest part, m; 0 where there
/// is none, where it is closed, and of parts that are no cylinders: these were not measured.
double bridges_of(const scene *s, const layout *of, double diameter, double n);
