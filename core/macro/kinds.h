/// Kinds of cargo in one density: of each cell the fraction c_k of each kind, sum_k c_k = 1, so that rho_k = c_k rho.
///
/// The density, its closure and its pressure know nothing of kinds: rho has the bits that it has without them. The fractions
/// are carried with the fluxes F by which a step of the congested closure with the scheme roe moved it,
///
///     d(rho c_k)/dt + div(F c_k) = 0,    c_k at a face that of the cell which the cargo comes from
///
/// F = F_stat + G is parted so that what the correction G pushes back does not mix: of both, where they have different signs at
/// a face, only their sum is carried, by the one that is larger; then, as the density itself,
///
///     1  by F_stat' from the density and the fractions with which the step began,
///     2  by G' from those after 1.
///
/// As F_stat takes at most what a cell had out of it, and G at most what it has after F_stat, so do F_stat' and G': all fractions are
/// means of such that were near. 0 <= c_k <= 1, and the mass of each kind is conserved to rounding.
///
/// Slopes    in 1 the fraction at a face is c + (1 - nu)/2 theta (c_after - c_before), nu the part of the cell that leaves over the
///           face. theta is the least over the kinds of the limiter superbee, which keeps a change of kinds a few cells wide
///           (upwind it is sqrt(v dx t) wide after t); the sum of the fractions stays 1. Where cargo leaves
///           over several faces, all slopes of the cell are scaled by min(1, (1 - N)/sum(nu (1 - nu))), N = sum nu, so that
///           what stays has no fraction below 0. Beside a cell without cargo, and where none comes through, there is no slope.
/// Counts    fractions are of parts, not of area: rho_max of a mix is that of its mean, and a cell of parts of one kind that are larger
///           than it holds, for the same density, as many parts as any other.
/// Threads   each makes rows of its own between barriers: the same bits for any number.
/// Source    superbee: P. L. Roe, Characteristic-based schemes for the Euler equations, Annu. Rev. Fluid Mech. 18 (1986).

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/macro/macro.h"

/// The fractions of a solver's cells; opaque, on the heap.
typedef struct kinds kinds;

/// Begin with n kinds, all fractions of the first one. The caller owns *ret_kinds: kinds_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status kinds_create(const macro_solver *s, size_t n, kinds **ret_kinds);

/// Free them. NULL is fine. Always returns NULL.
kinds *kinds_destroy(kinds *k);

/// A step was made, and nothing was done to the density since: carry the fractions.
void kinds_follow(macro_solver *s);

/// A density of these fractions is about to be added to what a cell holds.
void kinds_mix(macro_solver *s, size_t cell, double density, const double *fractions);

/// A density falls out of a cell.
void kinds_drop(macro_solver *s, size_t cell, double density);

/// Append the fractions to a checkpoint, and take them from one; false: it is damaged.
void kinds_save(const macro_solver *s, checkpoint_writer *w);
BF_MUST_CHECK bool kinds_load(macro_solver *s, checkpoint_reader *r);
