/// Solvers with the congested closure, from scenes.

#pragma once

#include "core/macro/macro.h"
#include "core/macro/velocity_field.h"
#include "core/scene/scene.h"

/// The definition that a run makes of a resolved scene and its field, for one thread.
macro_def helper_congested_def(const scene *s, const velocity_field *f);

/// An empty solver of a resolved scene; macro_destroy().
macro_solver *helper_congested_create(const scene *s, int n_threads);

/// The same with the scene's cargo.
macro_solver *helper_congested_start(const scene *s, int n_threads);

/// Set the density of the cells whose centres are in a rectangle, 0 elsewhere, at t = 0.
void helper_congested_fill(const scene *s, scene_rect where, double density, macro_solver *solver);

/// Make n steps.
void helper_congested_advance(macro_solver *solver, int n_steps);

/// The paper's Example with a plate at this angle, by the congested closure in cells of 1 cm.
void helper_congested_example(scene *s, double angle_deg);

/// The same with 40 columns of parts: its outlet of 10 cm is saturated.
void helper_congested_saturated(scene *s, double angle_deg);
