/// The scheme of section 4.2 exactly as printed, and the scheme muscl as core/macro/README.md has it: direct sums, no
/// separation, nothing left out. Slow on purpose: an oracle for core/macro and the yardstick of its speed.

#pragma once

#include "core/macro/macro.h"

/// A density and its field. Zero-initialised by direct_create().
typedef struct direct direct;

/// A reference solver of the same definition, with rho = 0; its belts must stay. NULL: no memory.
direct *direct_create(const macro_def *def);

/// Free it. Always returns NULL.
direct *direct_destroy(direct *d);

/// Take n1 * n2 densities, layout of grid.h.
void direct_set_density(direct *d, const double *rho);

/// Advance by one step.
void direct_step(direct *d);

/// The densities, valid until the next call.
const double *direct_density(const direct *d);
