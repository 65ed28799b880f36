/// What a solver gives to core/run: one table of functions a model.

#pragma once

#include "core/base/buffer.h"
#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/scene/scene.h"

#include <stdint.h>

/// The sizes of a run.
typedef struct run_plan {
    double dt;        ///< s
    uint64_t n_steps; ///< from t = 0 to the end
    bf_grid grid;     ///< of the snapshots
    uint64_t n_parts; ///< parts at the start
} run_plan;

/// What is in the domain at one time.
typedef struct run_load {
    double parts; ///< parts in the domain
    double peak;  ///< largest density
} run_load;

/// A model. solver is what create() made.
typedef struct run_backend {
    /// Build the solver at t = 0. The caller owns *ret_solver: destroy().
    bf_status (*create)(const scene *s, int n_threads, void **ret_solver, run_plan *ret_plan,
                        bf_error *err);
    void (*destroy)(void *solver);
    /// Advance by dt.
    void (*step)(void *solver);
    /// BF_ENUMERIC with step, time and place if something is not finite.
    bf_status (*check)(const void *solver, bf_error *err);
    /// Fill one value per counter, parts.
    void (*count)(const void *solver, double *ret_parts);
    run_load (*measure)(const void *solver);
    /// Fill the density grid, n2 rows of n1.
    void (*snapshot)(const void *solver, float *ret_rho);
    bf_status (*save)(const void *solver, bf_buffer *out, bf_error *err);
    bf_status (*load)(void *solver, const void *bytes, size_t n, bf_error *err);
    uint64_t (*digest)(const void *solver);
} run_backend;

/// The macroscopic model.
extern const run_backend run__macro;

/// Steps until the first one at or past time t; a hair of rounding does not add a step.
uint64_t run__steps_until(double t, double dt);
