/// Whether a scene is left to chance, and whether what it does in the long run is always the same.
///
/// Chance are the draws of feeds, which depend on the substream: times of Poisson and Erlang arrivals, kinds of a mix,
/// places on a line, headings; and those of failures of belts, which both models have. The density is fed by rates, and has chance only where photo eyes that draw the gaps between its
/// parts (density_ratio "auto") or their kinds command something, or where kinds of a mix are told apart. Two runs of a scene without chance are the same run.
///
/// Rates, speeds and plates are constant, or repeat with a common period, the cycle; or they change, and no time of the
/// run is like another.

#pragma once

#include "core/scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

/// What there is.
typedef struct scene_regime {
    bool has_chance; ///< see above
    bool
        is_constant; ///< after the warm-up nothing changes but by cycles and by photo eyes, and feeds deliver until the end
    double cycle;    ///< s; 0: nothing repeats
} scene_regime;

/// The stages of the random gaps between the parts that photo eyes of the density draw: those of the feeds, if all are Erlang
/// or regular, the fewest; 0: gaps are 1, as all feeds are regular, or let the density in part by part (scene_acts_by_kind()); else 1, exponential ones.
uint32_t scene_gap_shape(const scene *s);

/// True if runs with other substreams are other runs, of the density or of parts.
bool scene_has_chance(const scene *s, bool is_density);

/// The regime of a checked scene with feeds; without any it is not constant.
scene_regime scene_regime_of(const scene *s, bool is_density);
