/// A scenario as plain data: belts, walls, obstacles and cargo, and how to solve it.
///
/// The document that users write is JSON; api/scenario.h turns it into this struct and back. Here it
/// has its defaults (scene_init) and its complete checks (scene_check); what the solvers need is
/// derived from it by field.h (carrying velocity), placement.h (where the parts are), density.h
/// and counter.h.
///
/// Units    SI: m, s, kg, m/s, Pa. Angles are radians in structs, degrees in documents.
/// Source   Goettlich et al. 2014, sections 2 to 4; defaults are the paper's or this project's choice.
/// Owns     the arrays below; scene_fini() frees them.
/// Errors   scene_check() notes every fault with its JSON pointer in the document. Beyond the names
///          of the struct members with their unit: cargo/shape/outline_m (prism) and vertices_m
///          (hull), contacts/cargo_cargo/{length_m, damping_n_s_m, friction, tanh_linear_s_m,
///          tanh_spin_s}, micro/{damping_per_s, gravity_m_s2, spin_friction_radius_m},
///          initial/random/{count, region/x_m, region/y_m, seed}. An obstacle of two points is
///          pointed at as a whole, a longer path at its point.

#pragma once

#include "core/base/faults.h"
#include "core/base/grid.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    SCENE_NAME_SIZE = 201,          ///< bytes of a scenario's name with its terminator
    SCENE_ID_SIZE = 65,             ///< bytes of an id with its terminator
    SCENE_BELTS_MAX = 256,          ///< belts in a scenario
    SCENE_OBSTACLES_MAX = 256,      ///< obstacles in a scenario
    SCENE_POINTS_MAX = 1024,        ///< points of a polygon or a path
    SCENE_VERTICES_MAX = 64,        ///< vertices of a cargo shape
    SCENE_COUNTERS_MAX = 32,        ///< counters in a scenario
    SCENE_PARTS_MAX = 1000000,      ///< parts in a scenario
    SCENE_CELLS_MAX = 100000000,    ///< cells of the macroscopic grid
    SCENE_CELLS_SIDE_MAX = 1 << 24, ///< cells of it along one side
    SCENE_SAMPLES_MAX = 1000000,    ///< samples of the outflow curve
    SCENE_SNAPSHOTS_MAX = 20000,    ///< density snapshots of a run
    SCENE_REACH_MAX = 64,           ///< cells that a mollifier may reach over
};

/// Most steps of a run.
#define SCENE_STEPS_MAX 1e9

/// Most bytes of all density snapshots of a run together, before compression.
#define SCENE_SNAPSHOT_BYTES_MAX 8e9

/// Borders of bands and of obstacles' ends are taken with this tolerance, m, in favour of the band.
#define SCENE_TOLERANCE 1e-9

/// Largest coordinate and length, and smallest length of a part, m.
#define SCENE_LENGTH_MAX 1e5
#define SCENE_LENGTH_MIN 1e-6

/// Largest speed, m/s.
#define SCENE_SPEED_MAX 1e3

/// Most values that the density of the parts at the start may take to sum up: parts times cells
/// within the reach of initial_mollifier.
#define SCENE_INITIAL_WORK_MAX 1e12

/// A point or a vector in the plane: x along the belt, y across it.
typedef struct scene_point {
    double x; ///< x1, m (or m/s)
    double y; ///< x2, m (or m/s)
} scene_point;

/// A rectangle with its sides along the axes.
typedef struct scene_rect {
    double x_min; ///< m
    double x_max; ///< m, > x_min
    double y_min; ///< m
    double y_max; ///< m, > y_min
} scene_rect;

/// The sides of the domain.
typedef enum scene_side {
    SCENE_WEST,  ///< x = x_min
    SCENE_EAST,  ///< x = x_max
    SCENE_SOUTH, ///< y = y_min
    SCENE_NORTH, ///< y = y_max
    SCENE_SIDE_COUNT
} scene_side;

/// What a side of the domain is.
typedef enum scene_edge {
    SCENE_EDGE_INFLOW,  ///< zero density comes in (11a)
    SCENE_EDGE_OUTFLOW, ///< open: cargo leaves
    SCENE_EDGE_WALL,    ///< solid, free slip: no flux crosses it (11b)
    SCENE_EDGE_COUNT
} scene_edge;

/// A conveyor: a polygon that carries what lies on it. Where belts overlap the later one wins.
typedef struct scene_belt {
    char id[SCENE_ID_SIZE]; ///< unique among belts (default "main", then "belt-<n>", n from 2)
    scene_point velocity;   ///< v_T, m/s (default 0.395, 0)
    size_t n_points;        ///< 0: the belt covers the domain
    scene_point *polygon;   ///< simple polygon, n_points >= 3 corners, m
} scene_belt;

/// How the macroscopic model holds cargo back at an obstacle.
typedef enum scene_treatment {
    SCENE_SEALED, ///< line shut, outward field upstream of it: keeps to the microscopic model
    SCENE_FIELD,  ///< the paper's field alone (sections 3.1, 4.2): cargo leaks through
    SCENE_WALL,   ///< line shut (11b), slide zone only
    SCENE_TREATMENT_COUNT
} scene_treatment;

/// A deflector ("singularizer"): a polyline plate standing on the belt.
typedef struct scene_obstacle {
    char id[SCENE_ID_SIZE];    ///< unique among obstacles (default "obstacle-<n>", n from 1)
    size_t n_points;           ///< >= 2
    scene_point *path;         ///< corners of the upstream face, m
    double thickness;          ///< of the plate, downstream of the line, m, > 0 (default 0.005)
    scene_treatment treatment; ///< (default SCENE_SEALED)
    double band; ///< SCENE_SEALED: width of the outward field B, m, > 0 (default 8/sqrt(sigma))
    double slide_width; ///< width of the slide zone C, m, > 0 (default 3/sqrt(sigma); 0.02 for
                        ///< SCENE_FIELD and SCENE_WALL)
} scene_obstacle;

/// Shapes of cargo.
typedef enum scene_shape_type {
    SCENE_CYLINDER, ///< upright cylinder
    SCENE_BOX,      ///< cuboid
    SCENE_PRISM,    ///< convex outline, upright
    SCENE_HULL,     ///< convex hull of points
    SCENE_SHAPE_COUNT
} scene_shape_type;

/// The shape of a part, in its own frame.
typedef struct scene_shape {
    scene_shape_type type; ///< (default SCENE_CYLINDER)
    double radius;         ///< cylinder, m, > 0 (default 0.012)
    double height;         ///< cylinder, box, prism, m, > 0 (default 0.008)
    double length;         ///< box along x, m, > 0
    double width;          ///< box along y, m, > 0
    size_t n_vertices;     ///< prism: 3 to 64 corners; hull: 4 to 64 points
    double (*vertices)[3]; ///< prism: counter-clockwise corners (z unused); hull: points, m
} scene_shape;

/// Elastic constants of a material.
typedef struct scene_material {
    double young_modulus; ///< E, Pa, > 0
    double poisson_ratio; ///< nu, 0 <= nu < 0.5
} scene_material;

/// Who touches whom in the microscopic model.
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
    double friction;    ///< mu, >= 0 (defaults 0.15, 1.0, 0.19)
    double tanh_linear; ///< lambda_lin, s/m, > 0 (default 10)
    double tanh_spin;   ///< lambda_ang, s, > 0 (default 1)
} scene_contact;

/// What is transported.
typedef struct scene_cargo {
    scene_shape shape;       ///< see there
    double mass;             ///< kg, > 0 (default: steel, 7850 kg/m3 times the volume)
    scene_material material; ///< (default 210e9 Pa, 0.28)
} scene_cargo;

/// Where the parts are at the start.
typedef enum scene_initial_type {
    SCENE_INITIAL_POSITIONS,
    SCENE_INITIAL_HEXAGONAL,
    SCENE_INITIAL_RANDOM,
    SCENE_INITIAL_COUNT
} scene_initial_type;

/// One part's place.
typedef struct scene_pose {
    double x;       ///< m
    double y;       ///< m
    double heading; ///< rad, counter-clockwise from the x axis
} scene_pose;

/// The source of cargo at t = 0. Only the members of its type count.
typedef struct scene_initial {
    scene_initial_type type; ///< (no default)
    size_t n_poses;          ///< positions: how many
    scene_pose *poses;       ///< positions: where
    uint32_t n_rows;         ///< hexagonal: rows, each along the belt, >= 1
    uint32_t n_columns;      ///< hexagonal: parts a row, >= 1
    scene_point first;       ///< hexagonal: first centre of the first row, m
    double spacing;    ///< hexagonal: between neighbours, m, > 0; odd rows are shifted by half
                       ///< of it along the belt, rows are spacing * sqrt(3)/2 apart
    uint32_t n_random; ///< random: how many, >= 1
    scene_rect region; ///< random: centres lie in it, m
    uint64_t seed;     ///< random: of the generator (default 1), < 2^53
} scene_initial;

/// Counts the parts inside a rectangle: U(t) of the paper.
typedef struct scene_counter {
    char id[SCENE_ID_SIZE]; ///< unique, a column of the curve (default "upstream", "upstream-<n>")
    scene_rect rect;        ///< x_min <= x < x_max, same in y (default the domain's)
} scene_counter;

/// When results are taken.
typedef struct scene_output {
    double curve_every;    ///< s, > 0 (default 0.01)
    double snapshot_every; ///< s, > 0 (default 0.1)
} scene_output;

/// What lets the dispersion act at density rho.
typedef enum scene_heaviside {
    SCENE_HEAVISIDE_SHARP,  ///< 1 where rho >= 1, else 0
    SCENE_HEAVISIDE_SMOOTH, ///< 1/2 + atan((rho - 1)/width)/pi
    SCENE_HEAVISIDE_NONE,   ///< 1 everywhere (Example 3)
    SCENE_HEAVISIDE_COUNT
} scene_heaviside;

/// Numerical schemes of the macroscopic model.
typedef enum scene_scheme {
    SCENE_SCHEME_ROE, ///< section 4.2
    SCENE_SCHEME_COUNT
} scene_scheme;

/// Parameters of the macroscopic model (10)-(18).
typedef struct scene_macro {
    double cell;               ///< cell edge, m, > 0 (default 0.005)
    double step;               ///< dt, s, > 0; 0 means "auto" (default 0.00125)
    scene_scheme scheme;       ///< (default SCENE_SCHEME_ROE)
    scene_heaviside heaviside; ///< (default SCENE_HEAVISIDE_SHARP)
    double heaviside_width;    ///< xi of SCENE_HEAVISIDE_SMOOTH, > 0 (default 0.05)
    double dispersion;         ///< epsilon, m/s, >= 0 (default 2 |v_T| of the fastest belt)
    double mollifier;          ///< sigma, 1/m2, > 0 (default 10000)
    double initial_mollifier;  ///< sigma_0, 1/m2, > 0 (default 2500)
} scene_macro;

/// Parameters of the microscopic model (1)-(9).
typedef struct scene_micro {
    double step;                             ///< dt, s, > 0 (default 1e-5)
    double modulus_reduction;                ///< all moduli are divided by it, >= 1 (default 1e6)
    bool tension;                            ///< contacts may pull (default false)
    double damping;                          ///< D of (12)-(13), 1/s, >= 0 (default 0.1)
    double gravity;                          ///< m/s2, >= 0 (default 9.81)
    double spin_friction_radius;             ///< m, >= 0 (default 2/3 of the footprint's radius)
    scene_material conveyor;                 ///< (default 40e9 Pa, 0.05)
    scene_material handling;                 ///< (default 70e9 Pa, 0.34)
    scene_contact contact[SCENE_PAIR_COUNT]; ///< see there
} scene_micro;

/// The whole scenario. Begin with scene_init().
typedef struct scene {
    char name[SCENE_NAME_SIZE];         ///< for people (default "")
    double duration;                    ///< s, > 0 (no default)
    scene_rect domain;                  ///< (no default)
    scene_edge edges[SCENE_SIDE_COUNT]; ///< (default inflow, outflow, wall, wall)
    size_t n_belts;                     ///< (default one, "main")
    scene_belt *belts;                  ///< see there
    size_t n_obstacles;                 ///< (default none)
    scene_obstacle *obstacles;          ///< see there
    scene_cargo cargo;                  ///< see there
    scene_initial initial;              ///< see there
    size_t n_counters;                  ///< (default one)
    scene_counter *counters;            ///< (default "upstream": the domain)
    scene_output output;                ///< see there
    scene_macro macro;                  ///< see there
    scene_micro micro;                  ///< see there
} scene;

/// Fill *s with the defaults that depend on nothing else: no belts, obstacles, counters or parts
/// yet. Numbers whose default is derived are NAN until scene_resolve(); what has no default is NAN
/// or, the type of the source of cargo, SCENE_INITIAL_COUNT. Arrays that the caller adds come from
/// memory.h.
void scene_init(scene *s);

/// Fill *b, *o or *c with its defaults; derived ones are NAN, and ids "", until scene_resolve().
void scene_belt_init(scene_belt *b);
void scene_obstacle_init(scene_obstacle *o);
void scene_counter_init(scene_counter *c);

/// Fill in what was left to be derived: every NAN that has a default in terms of other members,
/// empty ids, the belt and the counter if there are none. BF_ENOMEM: *s is as before.
BF_MUST_CHECK bf_status scene_resolve(scene *s, bf_error *err);

/// Check a resolved scenario completely, for the macroscopic model too: ranges, ids, geometry,
/// sizes, stability (CFL), cargo outside or overlapping. Notes every fault it can find, of one kind
/// of cargo fault a few. No memory is noted like a fault, with BF_ENOMEM.
void scene_check(const scene *s, bf_faults *faults);

/// Free what *s owns and zero it. NULL is fine.
void scene_fini(scene *s);

/// The macroscopic grid: domain divided into cells of macro.cell. Valid after scene_check().
bf_grid scene_grid(const scene *s);

/// Density of close packing, parts/m2. Cylinder: 1/(2 sqrt(3) r^2); box: 1/(length width); prism
/// and hull: pi/(2 sqrt(3)) divided by the area of the footprint.
double scene_packing_density(const scene *s);

/// Speed |v_T| of the fastest belt, m/s.
double scene_belt_speed(const scene *s);

/// How many parts there are at the start.
size_t scene_parts(const scene *s);

/// True if the convolution sees the density mirrored at wall edges instead of zero outside: when
/// no obstacle asks for one of the paper's own treatments.
bool scene_mirrors_walls(const scene *s);

/// Time step of the macroscopic model, s: macro.step, or for "auto" the largest that is stable and
/// positive, not longer than the run, and, where output.curve_every is longer, fits a whole number
/// of times into it.
double scene_macro_step(const scene *s);

/// Largest dt that satisfies CFL, dt (max|v_stat| + eps) <= dx, and the largest below which
/// rho >= 0 is kept, dt < dx / (2 (max|v_stat| + eps)); s.
double scene_step_stable(const scene *s);
double scene_step_positive(const scene *s);
