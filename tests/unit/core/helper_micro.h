/// The four microscopic solvers, from definitions. All of these assert that all goes well.

#pragma once

#include "core/micro/micro.h"

enum { HELPER_MICRO_SOLVERS = 4 };

/// A solver with a step that suits small contacts of cylinders of 12 mm.
typedef struct helper_micro_solver {
    micro_path path;
    micro_integrator integrator;
    double dt; ///< s
} helper_micro_solver;

/// Disks explicit, implicit, bodies explicit, implicit.
extern const helper_micro_solver helper_micro_solvers[HELPER_MICRO_SOLVERS];

/// micro_def_default() for one of them, without damping, with moduli that are divided by 1e4.
micro_def helper_micro_def(int solver);

/// The solver of a definition, with a world of its own if the definition has none; micro_destroy().
micro_solver *helper_micro_start(const micro_def *def);

/// Steps up to time t, s.
void helper_micro_advance_to(micro_solver *s, double t);
