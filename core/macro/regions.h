/// The rules of the static velocity field at a point: regions A, B and C of velocity_field.h.
///
/// A plate that runs along its belt, or has been turned into its direction, holds nothing back: it has neither B nor C. On a belt
/// that turns the direction in the middle of the piece counts, as it is a chord of a circle there. On a slope cargo that rests on
/// the plate is slower uphill and faster downhill by what friction on the belt then bears, at most as fast as the belt.

#pragma once

#include "core/scene/scene.h"
#include "core/scene/surroundings.h"

/// A straight piece of an obstacle.
typedef struct regions_segment {
    surroundings_piece piece;      ///< see there
    const scene_contact *conveyor; ///< of the scene
    double level[3]; ///< borders of the regions by their distance d upstream of the line: B from
                     ///< level[0] to [1], C from there to [2], m
} regions_segment;

/// The regions of section 3.1; the larger value takes precedence.
typedef enum regions_region {
    REGIONS_FREE,   ///< A: the belt's velocity
    REGIONS_SLIDE,  ///< C: along the obstacle
    REGIONS_OUTWARD ///< B: away from it
} regions_region;

/// v_stat at a point for the segments considered so far.
typedef struct regions_velocity {
    regions_region region;   ///< of these segments
    size_t belt_index;       ///< of the belt under the point, n_belts off every belt
    const scene_belt *under; ///< that belt; NULL off every belt
    vec2 belt;               ///< v_T under the point, m/s
    vec2 velocity;           ///< v_stat, m/s
} regions_velocity;

/// Piece k of an obstacle with the widths of its regions.
regions_segment regions_segment_of(const scene *s, const surroundings *around,
                                   const scene_obstacle *obstacle, size_t k);

/// How far a segment's regions reach from its line, m.
double regions_extent(const regions_segment *g);

/// v_stat without any obstacle where this belt is, n_belts of the surroundings: off every one (surroundings_belt_at()).
regions_velocity regions_begin(const surroundings *around, size_t belt, vec2 at);

/// Consider one more segment; earlier ones take precedence within a region. Its upstream side follows from the
/// belt under the point.
void regions_consider(regions_velocity *v, const regions_segment *g, vec2 at);
