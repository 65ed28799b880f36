/// What a solver gives to core/run: one table of functions a model.

#pragma once

#include "core/base/buffer.h"
#include "core/base/faults.h"
#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/run/frame.h"
#include "core/scene/scene.h"

#include <stdint.h>

/// Rounding that a step at the bound of stability is forgiven.
#define RUN__STABLE_SLACK 1e-12

/// The sizes of a run.
typedef struct run_plan {
    double dt;          ///< s
    uint64_t n_steps;   ///< from t = 0 to the end
    bf_grid grid;       ///< of the snapshots
    uint64_t n_parts;   ///< parts at the start
    uint32_t n_values;  ///< values of a part in FRAME_PARTS; 0: the model has no parts
    uint64_t n_advance; ///< most steps between two questions for the caller's wish, >= 1
} run_plan;

/// What is in the domain at one time.
typedef struct run_load {
    double parts; ///< parts in the domain
    double peak;  ///< largest density; 0 where the model knows it at snapshots only
} run_load;

/// A model. solver is what create() made.
typedef struct run_backend {
    /// Note what speaks against solving a checked scenario.
    void (*check_scenario)(const scene *s, bf_faults *faults);
    /// Build the solver at t = 0. The caller owns *ret_solver: destroy().
    bf_status (*create)(const scene *s, int n_threads, void **ret_solver, run_plan *ret_plan,
                        bf_error *err);
    void (*destroy)(void *solver);
    /// Make n steps of dt. How steps are cut into calls must not change the result. BF_ENUMERIC with
    /// step, time and place where that is noticed at once.
    bf_status (*advance)(void *solver, uint64_t n, bf_error *err);
    /// BF_ENUMERIC with step, time and place if something is not finite. NULL: advance() tells.
    bf_status (*check)(const void *solver, bf_error *err);
    /// Fill one value per counter, parts.
    void (*count)(const void *solver, double *ret_parts);
    run_load (*measure)(const void *solver);
    /// Fill the density grid, n2 rows of n1, and tell what is in it.
    bf_status (*snapshot)(void *solver, float *ret_rho, run_load *ret_load, bf_error *err);
    /// Fill the rows of FRAME_PARTS. NULL: the model has no parts.
    void (*parts)(const void *solver, double *ret_rows);
    /// Fill the figures of the end that only models with parts have. NULL: they are 0.
    void (*tell_end)(const void *solver, frame_end *end);
    bf_status (*save)(const void *solver, bf_buffer *out, bf_error *err);
    bf_status (*load)(void *solver, const void *bytes, size_t n, bf_error *err);
    uint64_t (*digest)(const void *solver);
} run_backend;

/// The macroscopic model.
extern const run_backend run__macro;

/// The microscopic model.
extern const run_backend run__micro;

/// Note what speaks against solving a checked scenario with one of the models.
void run__check_macro(const scene *s, bf_faults *faults);
void run__check_micro(const scene *s, bf_faults *faults);

/// Steps until the first one at or past time t; a hair of rounding does not add a step.
uint64_t run__steps_until(double t, double dt);
