/// The start of the macroscopic model: the density (18) of the parts that are there, and of which kinds they are in each cell.
///
/// Parts whose centres are off every belt give their density to cells that are so, the others to the others. Where kinds are told
/// apart a cell has them in proportion to the densities (18) of the parts of each.

#pragma once

#include "core/macro/macro.h"
#include "core/scene/scene.h"

/// Set a solver of a scenario to t = 0. *ret_n_parts is the number of its parts. BF_ENOMEM, and errors of placement_of().
BF_MUST_CHECK bf_status macro_start(const scene *s, macro_solver *solver, uint64_t *ret_n_parts,
                                    bf_error *err);
