/// The parameters of a scenario's two models: materials, contact laws, schemes and their numbers.
///
/// Units    SI: m, s, kg, m/s, Pa.

#pragma once

#include <stdbool.h>

/// Elastic constants of a material.
typedef struct scene_material {
    double young_modulus; ///< E, Pa, > 0
    double poisson_ratio; ///< nu, 0 <= nu < 0.5
} scene_material;

/// Pairs of materials in contact in the microscopic model.
typedef enum scene_pair {
    SCENE_CARGO_CARGO,
    SCENE_CONVEYOR_CARGO,
    SCENE_HANDLING_CARGO, ///< obstacles and walls
    SCENE_PAIR_COUNT
} scene_pair;

/// Contact law of a pair (4)-(8).
typedef struct scene_contact {
    double length;      ///< l of the contact line, m, > 0 (default 0.008)
    double damping;     ///< d, N s/m, >= 0 (defaults 119, 230, 120)
    double friction;    ///< mu, >= 0 (default: goods.h; 0.15, 1.0, 0.19 without surfaces)
    double tanh_linear; ///< lambda_lin, s/m, > 0 (default 10)
    double tanh_spin;   ///< lambda_ang, s, > 0 (default 1)
} scene_contact;

/// How the macroscopic model moves cargo that is packed.
typedef enum scene_closure {
    SCENE_DISPERSIVE, ///< the paper's (10)-(11): it disperses down the gradient of the smoothed density
    SCENE_CONGESTED, ///< a pressure holds the density at that of a jam, with friction on the belt
    SCENE_CLOSURE_COUNT
} scene_closure;

/// The function H by which the dispersion acts at density rho.
typedef enum scene_heaviside {
    SCENE_HEAVISIDE_SHARP,  ///< 1 where rho >= 1, else 0
    SCENE_HEAVISIDE_SMOOTH, ///< 1/2 + atan((rho - 1)/width)/pi
    SCENE_HEAVISIDE_NONE,   ///< 1 everywhere (Example 3)
    SCENE_HEAVISIDE_COUNT
} scene_heaviside;

/// Numerical schemes of the macroscopic model.
typedef enum scene_scheme {
    SCENE_SCHEME_ROE,   ///< section 4.2, first order: an x1 sweep, then an x2 sweep
    SCENE_SCHEME_MUSCL, ///< second order: limited slopes, Heun's method
    SCENE_SCHEME_COUNT
} scene_scheme;

/// Parameters of the macroscopic model (10)-(18). Those of the other closure have no effect: with
/// SCENE_CONGESTED heaviside to mollifier, and treatment, band and slide_width of obstacles.
typedef struct scene_macro {
    double cell;           ///< cell edge that is fitted to the domain, m, > 0; 0 means "auto", by
                           ///< the size of the goods: cells.h (default 0)
    double step;           ///< dt, s, > 0; 0 means "auto" (default 0; 0.00125 with
                           ///< SCENE_DISPERSIVE and a cell)
    scene_closure closure; ///< (default SCENE_CONGESTED)
    double jam_density;    ///< rho_j of SCENE_CONGESTED, in (0, 1] (default 0.93)
    scene_scheme scheme;   ///< (default SCENE_SCHEME_ROE)
    scene_heaviside heaviside; ///< (default SCENE_HEAVISIDE_SHARP)
    double heaviside_width;    ///< xi of SCENE_HEAVISIDE_SMOOTH, > 0 (default 0.05)
    double dispersion;         ///< epsilon, m/s, >= 0 (default 2 |v_T| of the fastest belt)
    double mollifier;          ///< sigma, 1/m2, > 0 (default 10000)
    double
        initial_mollifier; ///< sigma_0, 1/m2, > 0 (default 0.36/r2 cut to four digits, r the radius of
                           ///< a disk with the mean footprint of the kinds; at most 1/cell2)
    double packing;        ///< rho_max, parts/m2 of density 1, > 0 (default: hexagonal packing of
                           ///< the shape cut to four digits, see scene_packing_density())
} scene_macro;

/// Time integration of the microscopic model.
typedef enum scene_integrator {
    SCENE_VERLET,          ///< (12)-(13), the paper's
    SCENE_IMPLICIT,        ///< dashpots and frictions implicitly, for steps of 0.2 to 2 ms
    SCENE_INTEGRATOR_AUTO, ///< SCENE_IMPLICIT
    SCENE_INTEGRATOR_COUNT
} scene_integrator;

/// Equations of motion of the microscopic model.
typedef enum scene_path {
    SCENE_PATH_AUTO,    ///< in the plane where all parts are cylinders, else in space
    SCENE_PATH_PLANAR,  ///< in the plane: upright cylinders only
    SCENE_PATH_SPATIAL, ///< in space: any shape, parts may tip
    SCENE_PATH_COUNT
} scene_path;

/// Parameters of the microscopic model (1)-(9).
typedef struct scene_micro {
    scene_integrator integrator; ///< (default SCENE_INTEGRATOR_AUTO)
    scene_path path;             ///< (default SCENE_PATH_AUTO)
    double step;                 ///< dt, s, > 0; 0: "auto" (default 0; 1e-5 if verlet)
    double modulus_reduction;    ///< all moduli are divided by it, >= 1; 0: "auto", from the loads
                                 ///< that parts may bear (core/micro/hardness.h) (default 0)
    double
        overlap_limit; ///< share of the smaller part's radius: beyond it a run fails (default 0.2)
    bool tension;      ///< contacts may pull (default false)
    double damping;    ///< D of (12)-(13), 1/s, >= 0 (default 0.1)
    double gravity;    ///< m/s2, >= 0 (default 9.81)
    double spin_friction_radius;             ///< m, >= 0 (default that of the first kind)
    scene_material conveyor;                 ///< (default 40e9 Pa, 0.05)
    scene_material handling;                 ///< (default 70e9 Pa, 0.34)
    scene_contact contact[SCENE_PAIR_COUNT]; ///< see there
    double wall_friction; ///< mu of SCENE_HANDLING_CARGO at walls of the domain, >= 0 (default that
                          ///< of the contact)
} scene_micro;
