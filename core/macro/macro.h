/// Macroscopic belt model: cargo as a density on a uniform grid, carried by a given velocity field
/// and dispersed where it is saturated (a non-local conservation law; section 4, (10)-(16)).
///
///     d(rho)/dt + div( rho (H(rho - 1) I + v) ) = 0
///     I = -eps grad(eta * rho) / sqrt(1 + |grad(eta * rho)|^2)
///     eta(x) = sigma/(2 pi) exp(-sigma |x|^2 / 2)
///
/// Where the speeds of belts change, v and I are multiplied by the size of the factor of the belt under the face in the step
/// (core/world/belt_speeds.h): a belt that stands neither carries nor disperses. Of a belt that runs backwards v is that of
/// the other direction (moving_field.h).
///
/// Static and dynamic flux are upwinded separately (Roe). SCENE_SCHEME_ROE: first order, an x1 sweep and then an
/// x2 sweep with one field I per step. SCENE_SCHEME_MUSCL: second order, both axes at once from limited slopes, two
/// stages with a field I each (core/macro/README.md). The convolution is summed with the exact cell integrals of the Gaussian,
/// which separate into one factor along x1 and one along x2 (mollifier.h).
///
/// Steps    with A_d = (max |v_d| + eps)/d_d the largest stable dt is 1/max(A_1, A_2) (roe) or
///          1/(A_1 + A_2) (muscl). Below half of it rho stays >= 0.
/// Units    SI. rho is normalised: 1 is close packing. Velocities m/s, sigma 1/m2.
/// Layout   as in core/base/grid.h.
/// Threads  a solver belongs to one thread at a time and uses n_threads itself; the result has the
///          same bits for any number of them, and with every instruction set (no contraction to FMA).
/// Errors   what can fail returns bf_status, fills *err (NULL: not required) and leaves every ret_
///          output as it was. The pointer of *err is the JSON pointer of the member in a scenario.

#pragma once

#include "core/base/buffer.h"
#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/macro/velocity_field.h"
#include "core/scene/scene.h"
#include "core/world/world.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// How to build a solver: numbers of a checked scenario. Begin with macro_def_default(). Arrays are read during macro_create()
/// only and stay the caller's.
typedef struct macro_def {
    bf_grid grid;              ///< cells (default 200 x 120 of 5 mm, lower corner 0, 0)
    double dt;                 ///< step, s, > 0, stable (default 1.25e-3)
    double dispersion;         ///< eps, largest dispersion speed, m/s, >= 0 (default 0.79)
    scene_scheme scheme;       ///< (default SCENE_SCHEME_ROE)
    double mollifier;          ///< sigma, 1/m2, > 0 (default 10000)
    scene_heaviside heaviside; ///< H (default SCENE_HEAVISIDE_SHARP)
    double heaviside_width;    ///< xi of SCENE_HEAVISIDE_SMOOTH, > 0 (default 0.05)
    /// Borrowed; apertures, transverse and loose velocities are SCENE_CONGESTED's (default NULL: velocity 0, nothing closed,
    /// loose cargo as fast as other).
    velocity_field_faces faces[2];
    scene_closure
        closure;        ///< (default SCENE_DISPERSIVE); the next four are SCENE_CONGESTED's, which
                        ///< needs belts, also of the faces, and square cells (congested.h)
    double jam_density; ///< rho_j, in (0, 1] (default 0.93)
    double slip_rate;   ///< lambda of the belt's friction, s/m, > 0 (default 10)
    double friction;    ///< mu of cargo on slopes that name none, > 0 (default 1)
    bool one_way[4];    ///< west, east, south, north: packed cargo is not moved back over this edge
    size_t n_belts;     ///< (default 0: v and I are constant in time)
    const scene_belt *belts; ///< with checked speed schedules, which scale v and I
    const bf_world *world; ///< of these belts, borrowed; NULL: their speeds are constant (default)
    const uint8_t *off; ///< nonzero: what is in this cell after a step falls (default NULL: none)
    double
        tracer_portion; ///< that a tracer stands for, in densities of a cell; 0: none (tracers.h; default 0)
    size_t
        n_kinds; ///< of cargo that are told apart, with SCENE_CONGESTED and SCENE_SCHEME_ROE alone (kinds.h); default 0: none
    bool mirror[4]; ///< west, east, south, north: the convolution sees the density mirrored at
                    ///< this edge instead of zero outside (default false)
    int n_threads;  ///< threads to use, >= 1 (default 1)
} macro_def;

/// A running solver; opaque, on the heap.
typedef struct macro_solver macro_solver;

/// Cells that the sweeps of the closure `dispersive` went over since the solver was made, in whole blocks, each time that they did.
typedef struct macro_swept {
    double all;       ///< cells, those without cargo between others included
    double varied;    ///< of them, those whose fluxes along x1 are not those of one velocity
    double dispersed; ///< cells whose I was made
} macro_swept;

/// Mass and peak of the density at one time, and what took time since the solver was made.
typedef struct macro_totals {
    double mass;       ///< integral of rho over the grid, m2
    double peak;       ///< largest rho
    double fallen;     ///< integral of what fell since t = 0, m2
    double relaxed;    ///< cells whose pressure was relaxed, each time that one was
    double n_fields;   ///< times that it was given another field
    macro_swept swept; ///< zeros with the closure `congested`
} macro_totals;

/// A point that moves with the cargo and stands for a portion of it (tracers.h).
typedef struct macro_tracer {
    double at1;      ///< place in its cell along x1, 0 to 1
    double at2;      ///< same along x2
    double entered;  ///< when it did, s
    uint32_t column; ///< of its cell
    uint32_t row;    ///< same
} macro_tracer;

/// A tracer that left the grid in a step.
typedef struct macro_exit {
    double entered; ///< when, s
    double left;    ///< same
} macro_exit;

/// The defaults above.
macro_def macro_def_default(void);

/// Build a solver with rho = 0. The caller owns *ret_solver: macro_destroy().
/// BF_EINPUT: dt is unstable; BF_ENOMEM.
BF_MUST_CHECK bf_status macro_create(const macro_def *def, macro_solver **ret_solver,
                                     bf_error *err);

/// Free a solver and what it owns. NULL is fine. Always returns NULL.
macro_solver *macro_destroy(macro_solver *s);

/// Copy n1 * n2 densities in, finite and not negative.
void macro_set_density(macro_solver *s, const double *rho);

/// Add a density to a cell, layout of grid.h, between two steps; one below 0 takes some of what there is. Of kinds it has the
/// given fractions, n_kinds of the sum 1; NULL: those of the cell.
void macro_add(macro_solver *s, size_t cell, double density, const double *fractions);

/// Let the cargo of a cell have these fractions of kinds, n_kinds of the sum 1.
void macro_set_fractions(macro_solver *s, size_t cell, const double *fractions);

/// Take a density of one kind, at most what there is of it, from a cell.
void macro_take_kind(macro_solver *s, size_t cell, size_t kind, double density);

/// The fractions of the kinds in a cell, n_kinds of the sum 1, also where there is no cargo. Borrowed until the next non-const call. NULL:
/// kinds are not told apart.
const double *macro_fractions(const macro_solver *s, size_t cell);

/// A density, in that of a cell, which was added enters now at a place, m: tracers are placed there for it. Without tracers
/// no effect.
void macro_trace(macro_solver *s, vec2 at, double density);

/// Move the tracers of a cell into another one.
void macro_move_tracers(macro_solver *s, size_t from, size_t to);

/// Cargo was taken out of cells after a step, of which a share, 0 to 1, was kept in each cell: tracers leave as likely.
void macro_let_leave(macro_solver *s, const double *kept);

/// The tracers in the grid, and those that left in the last step, *ret_n of them, each for *ret_portion. Borrowed until the
/// next non-const call.
const macro_tracer *macro_tracers(const macro_solver *s, size_t *ret_n, double *ret_portion);
const macro_exit *macro_exits(const macro_solver *s, size_t *ret_n, double *ret_portion);

/// How fast the cargo of each cell of a row leaves it, m/s, by the last step or one of the few before it; 0 without
/// tracers, and before the first step.
void macro_speeds(const macro_solver *s, size_t row, double *ret_speeds);

/// How much leaves cell i of row j over a side, net, by the last step or one of the few before it, in densities times m/s;
/// nearly what the density moved by. 0 without tracers, and before the first step.
double macro_flux(const macro_solver *s, size_t i, size_t j, scene_side side);

/// How many steps one flux stands for: the first of every so many that are made.
uint64_t macro_flux_steps(const macro_solver *s);

/// True if what is in a cell falls.
bool macro_is_off(const macro_solver *s, size_t cell);

/// The factor of a belt of the definition in the step that begins now, below 0 if it runs backwards; 1 off every belt.
double macro_belt_factor(const macro_solver *s, size_t belt);

/// Let the steps from now on have another velocity field of the same grid: one of the same scene whose obstacles have
/// moved, or some of whose belts, which are then given, run backwards (belts: NULL if none may). Never allocates.
void macro_set_field(macro_solver *s, const velocity_field *field, const scene_belt *belts);

/// Advance by dt. Never allocates. A step itself cannot fail; see macro_check().
void macro_step(macro_solver *s);

/// BF_ENUMERIC if a cell is not finite, with step, time and place in the text.
BF_MUST_CHECK bf_status macro_check(const macro_solver *s, bf_error *err);

/// Borrowed view of row j's n1 densities, valid until the next non-const call on s.
const double *macro_row(const macro_solver *s, size_t j);

/// The density of a cell, layout of grid.h.
double macro_density(const macro_solver *s, size_t cell);

/// Copy the n1 * n2 densities out, layout of grid.h.
void macro_copy_density_float(const macro_solver *s, float *rho);

/// Mass and peak; the sum runs along rows, then over rows, for any number of threads.
macro_totals macro_measure(const macro_solver *s);

/// Integral of rho over columns i_min <= i < i_max of rows j_min <= j < j_max, m2.
double macro_mass_in(const macro_solver *s, size_t i_min, size_t i_max, size_t j_min, size_t j_max);

/// Integral of what fell since t = 0 in the same cells, m2.
double macro_fallen_in(const macro_solver *s, size_t i_min, size_t i_max, size_t j_min,
                       size_t j_max);

/// The same of one kind.
double macro_kind_mass_in(const macro_solver *s, size_t kind, size_t i_min, size_t i_max,
                          size_t j_min, size_t j_max);
double macro_kind_fallen_in(const macro_solver *s, size_t kind, size_t i_min, size_t i_max,
                            size_t j_min, size_t j_max);

/// Steps made since rho was set at t = 0.
uint64_t macro_steps(const macro_solver *s);

/// Simulated time, s: steps times dt.
double macro_time(const macro_solver *s);

/// Digest of step count and the bits of the density and fractions of kinds.
uint64_t macro_digest(const macro_solver *s);

/// Append the state to *out, so that macro_load() into a solver of the same def goes on with the
/// same bits. BF_ENOMEM.
BF_MUST_CHECK bf_status macro_save(const macro_solver *s, bf_buffer *out, bf_error *err);

/// Take a state that macro_save() wrote of the same definition, into a solver without steps. BF_ECORRUPT: damaged; s can then
/// only be destroyed.
BF_MUST_CHECK bf_status macro_load(macro_solver *s, const void *bytes, size_t n, bf_error *err);
