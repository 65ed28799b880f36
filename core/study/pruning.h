/// Pruning: a run whose key figure cannot become better than the best one known any more need not go on.
///
/// Some figures only rise while a run goes on, since they are counts, sums or largest values, and one only falls; so their
/// value now bounds the one at the end. Since when the domain is drained cannot be before now while it is not.

#pragma once

#include "core/observe/figure.h"

#include <stdbool.h>

/// A key figure of a run that goes on.
typedef struct pruning_state {
    figure_id figure;  ///< of the objective
    bool is_maximized; ///< more is better; else less is
    double t;          ///< time of the last sample, s
    double value;      ///< until then; NAN: none yet
} pruning_state;

/// True if the value at the end will be worse than `best`, whatever happens. False if that is not known, or best is NAN.
bool pruning_is_hopeless(const pruning_state *now, double best);
