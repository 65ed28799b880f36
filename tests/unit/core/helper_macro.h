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

/// A solver of a scene with its field and the density that it began with. Do not move it once it was made.
typedef struct helper_macro_world {
    scene s;              ///< see there
    velocity_field *f;    ///< of it
    double *rho;          ///< at the start
    macro_solver *solver; ///< see there
} helper_macro_world;

/// The density at a place at the start.
typedef double helper_macro_density(const scene *s, vec2 at);

/// Begin with w->s, which is not resolved yet, and a density; helper_macro_world_fini().
void helper_macro_world_init(helper_macro_world *w, helper_macro_density *density, int n_threads);
void helper_macro_world_fini(helper_macro_world *w); ///< Free it.

/// The area of the cells that are nearer to jam_density than to a density of 0.5, m2.
double helper_macro_jammed_area(const helper_macro_world *w);

/// The relative L1 error of a helper_macro_bump() that should be at a place by now.
double helper_macro_bump_error(const helper_macro_world *w, vec2 place, double deviation);

/// 60 steps of a scene have the same bits on 1, 2 and 3 threads, there by two solvers one after the other.
void helper_macro_check_resumes(void (*make)(scene *s), helper_macro_density *density);
