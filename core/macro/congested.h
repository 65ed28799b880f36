/// The congested closure of the macroscopic model: packing as a constraint.
///
///     d(rho)/dt + div(rho v + G) = 0,   rho <= rho_j
///     p >= 0,   p (rho_j - rho) = 0,    G = F(-grad p/chi)
///     v = v_stat + w (v_T - v_stat),    w = min(1, max(0, rho_j - rho_ahead)/rho)
///
/// v differs from v_stat in slide zones alone: rho_ahead is the density of the next cell the way that the belt goes, and w the part
/// of the cargo that finds room there, none behind a closed face. So what is loose goes on with its belt until it meets the plate or
/// packed cargo, and what lies beside the plate slides along it, however little it is.
/// G, the correction, is what cargo moves relative to v because it has no room. It is driven by a pressure that
/// acts only where cargo is packed. This is the crowd model of Maury, Roudneff-Chupin and Santambrogio (2010), in
/// which F is the identity, with a law F of parts on a belt. With b the direction of the belt, q its left normal, v_T
/// its speed, g = -grad p/chi:
///
///     along   G.b = g.b                                       while cargo is slower than its belt,
///                   G0 + min(k (g.b - G0), B)                 beyond,  G0 = rho_j (v_T - v_stat.b)
///                   at least -L - rho_j v_stat.b
///     across  G.q = soft(g.q, tan(phi) s)  within  -L - rho_j v_stat.q .. L - rho_j v_stat.q and 0
///
///     k = slope/(lambda v_T) at most 1    the belt's friction mu tanh(lambda |slip|) brakes what is faster than it
///     B = beyond rho_j v_T                most of that
///     L = rho_j max(lateral v_T, v_X)     most speed across the belt; v_X the fastest of another belt across it,
///                                         which brings cargo as fast
///     tan(phi) = friction tanh(lambda v_T/2), s = slip of cargo against its belt, 0 .. rho_j v_T:
///                                         internal friction of cargo that is held back
///     soft(x, a) = sgn(x) max(|x| - a, 0)
///     chi = lambda v_O/tanh(lambda v_O) of a belt that runs onto another one, across which it moves with v_O; else 1:
///                                         friction rises less than slip, and little slip drives what slips fast across that one
///
/// On a slope, whose belt drives slower cargo by cos(alpha) (1 - tau) of what a level one does, brakes faster cargo by
/// cos(alpha) (1 + tau), and holds it across by cos(alpha) (core/scene/belt_slope.h), g is divided by each of these in its law; s by
/// the last, after it was multiplied by the first.
///
/// The constants are fitted to the microscopic model; core/macro/congested/README.md has their table.
///
/// Step     rho* = rho - dt div(rho v), unsplit, by the scheme, w by the densities before; then p by red-black relaxation
///          from the last p until, as each cell had its turn, none was more than 6e-3 above max(rho_j, rho), or below it under a pressure (at most 130
///          sweeps: in transients more may be left, and the density then exceeds rho_j by it); then
///          rho = rho* - dt div G with the fluxes of that p. So mass is exact whatever is left of the iteration, and
///          what leaves a cell is limited to what it has: rho >= 0.
/// Schemes  roe: upwind, first order. muscl: the states of muscl.h and Heun's method; where no cargo is packed and no
///          plate is near the density has the bits of the dispersive closure's with eps = 0.
/// Bound    in dt no cell loses more than it holds, whatever w: with v the larger of v_stat and v_T out over each of
///          its faces, dt sum(max(v, 0)/dx) is at most 1 (roe), dt sum of max(|v|)/dx along both axes at most 1/2 (muscl); a longer step is refused. So rho* >= 0
///          in any field.
/// Source   B. Maury, A. Roudneff-Chupin, F. Santambrogio: A macroscopic crowd motion model of gradient flow type,
///          Math. Models Methods Appl. Sci. 20 (2010).
/// Units    SI; rho normalised, p in m2/s.

#pragma once

#include "core/base/buffer.h"
#include "core/base/checkpoint.h"
#include "core/macro/macro.h"

/// The closure's part of a solver.
typedef struct congested congested;

/// Build it for a solver whose density and faces are there. The caller owns *ret_congested:
/// congested_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status congested_create(macro_solver *s, const macro_def *def,
                                         congested **ret_congested);

/// Free it and what it owns. NULL is fine. Always returns NULL.
congested *congested_destroy(congested *c);

/// One step, from `now` to `next` of the solver.
void congested_step(macro_solver *s);

/// The density was set anew at t = 0: no pressure, no slip.
void congested_reset(macro_solver *s);

/// BF_ENUMERIC if cargo is packed to more than twice what it can be: it has no way out.
BF_MUST_CHECK bf_status congested_check(const macro_solver *s, bf_error *err);

/// Bring the laws of the faces to the belts' speeds, where those or the faces have changed.
void congested_update(macro_solver *s);

/// Let the faces have the apertures, transverse velocities and belts of *def, after the solver's own were set.
void congested_set_faces(macro_solver *s, const macro_def *def);

/// Cells whose pressure was relaxed since the solver was made, each time that one was.
double congested_relaxed(const macro_solver *s);

/// Bytes of the state beside the density in a checkpoint.
size_t congested_state_size(const macro_solver *s);

/// Append it to a checkpoint, and take it from one before the first step. False: it is damaged, and the state undefined.
void congested_save(const macro_solver *s, checkpoint_writer *w);
BF_MUST_CHECK bool congested_load(macro_solver *s, checkpoint_reader *r);
