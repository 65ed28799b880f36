/// Macroscopic solvers, from scenes and from definitions. All of these assert that all goes well.

#pragma once

#include "core/macro/macro.h"
#include "core/macro/velocity_field.h"
#include "core/scene/scene.h"

/// The field of a resolved scene; velocity_field_destroy().
velocity_field *helper_macro_field(const scene *s);

/// True if the arrays of two fields of one grid are the same, bit by bit.
bool helper_macro_is_same_field(const velocity_field *a, const velocity_field *b);

/// The definition that a run makes of a resolved scene and its field, for one thread.
macro_def helper_macro_def(const scene *s, const velocity_field *f);

/// An empty solver of a resolved scene; macro_destroy().
macro_solver *helper_macro_create(const scene *s, int n_threads);

/// The same with the scene's cargo.
macro_solver *helper_macro_start(const scene *s, int n_threads);

/// A solver of a definition with a density for each cell; macro_destroy().
macro_solver *helper_macro_start_with(const macro_def *def, const double *rho);

/// Copy its densities, layout of grid.h.
void helper_macro_copy(const macro_solver *solver, double *ret_rho);

/// v_stat at one point by the rules of velocity_field.h, for the whole scene at v_T; m/s.
vec2 helper_macro_velocity_at(const scene *s, vec2 at);

/// True if the link between two neighbouring cell centres crosses a closed line (`wall`, `sealed`).
bool helper_macro_is_closed(const scene *s, vec2 from, vec2 to);

/// Make n steps.
void helper_macro_advance(macro_solver *solver, int n_steps);

/// The digest of a run whose first n steps one solver makes, and the other ones up to n_steps a second one of the same scene, from what the
/// first one saved.
uint64_t helper_macro_digest_of_both(macro_solver *first, int n, macro_solver *second, int n_steps);

/// A Gaussian about the origin with a peak of 0.8, which is packed nowhere.
double helper_macro_bump(double x1, double x2, double deviation);

/// Create the field and the solver of a resolved scene with every allocation failing in turn: each is reported as
/// BF_ENOMEM, and the last attempt succeeds.
void helper_macro_lack_memory(const scene *s);
