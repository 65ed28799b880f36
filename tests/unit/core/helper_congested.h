/// Scenes for the congested closure.

#pragma once

#include "core/macro/macro.h"
#include "core/macro/velocity_field.h"
#include "core/scene/scene.h"

/// Set the density of the cells whose centres are in a rectangle, 0 elsewhere, at t = 0.
void helper_congested_fill(const scene *s, scene_rect where, double density, macro_solver *solver);

/// The paper's Example with a plate at this angle, by the congested closure in cells of 1 cm.
void helper_congested_example(scene *s, double angle_deg);

/// The same with 40 columns of parts: its outlet of 10 cm is saturated.
void helper_congested_saturated(scene *s, double angle_deg);
