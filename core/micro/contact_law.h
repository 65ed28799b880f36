/// The contact law (4)-(8) of a pair of materials, ready for the inner loops.

#pragma once

#include "core/scene/scene.h"

/// Constants of one pair.
typedef struct micro_law {
    double stiffness;   ///< k, N/m
    double damping;     ///< d, N s/m
    double friction;    ///< mu
    double tanh_linear; ///< lambda_lin, s/m
    double tanh_spin;   ///< lambda_ang, s
} micro_law;

/// The compliance (1 - nu^2)/E of a material with E divided by reduction, 1/Pa.
double contact_law_compliance(const scene_material *m, double reduction);

/// 1/E* = (1 - nu_a^2)/E_a + (1 - nu_b^2)/E_b, both E divided by reduction; Pa.
double contact_law_modulus(const scene_material *a, const scene_material *b, double reduction);

/// Cargo against cargo, obstacles and walls: k = pi/4 E* l (4b).
micro_law contact_law_of_line(const scene_contact *contact, const scene_material *a,
                              const scene_material *b, double reduction);

/// Cargo of radius r, m, on a belt: k = 2 E* r (5).
micro_law contact_law_of_disk(const scene_contact *contact, const scene_material *cargo,
                              const scene_material *conveyor, double reduction, double r);
