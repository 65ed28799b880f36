/// What field.c and field_rule.c share: the rules of the static field, segment by segment.

#pragma once

#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/// One straight piece of an obstacle, ready for the rules.
typedef struct field__segment {
    const scene_obstacle *obstacle; ///< whose it is; borrowed
    vec2 start;                     ///< m
    vec2 along;                     ///< unit tangent t
    double length;                  ///< m
} field__segment;

/// The regions of section 3.1; the larger one wins.
typedef enum field__region {
    FIELD__FREE,   ///< A: the belt's velocity
    FIELD__SLIDE,  ///< C: along the obstacle
    FIELD__OUTWARD ///< B: away from it
} field__region;

/// What the rules say of a point so far.
typedef struct field__verdict {
    field__region region; ///< of the obstacles that were looked at
    vec2 belt;            ///< v_T under the point, m/s
    vec2 velocity;        ///< v_stat, m/s
} field__verdict;

/// Where a shut line lies for the links between cell centres.
typedef struct field__line {
    vec2 start; ///< m
    vec2 end;   ///< m
} field__line;

/// Piece k (from 0) of an obstacle's path.
field__segment velocity_field__segment_of(const scene_obstacle *obstacle, size_t k);

/// Borders of the regions by their distance d upstream of the line: B from ret_levels[0] to [1], C
/// from there to [2], m.
void velocity_field__levels(const scene_obstacle *obstacle, double ret_levels[3]);

/// The verdict on a point before any obstacle is looked at.
field__verdict velocity_field__begin(const scene *s, vec2 at);

/// Look at one more segment; earlier ones win within a region.
void velocity_field__consider(field__verdict *verdict, const field__segment *segment, vec2 at);

/// True if nothing crosses the line of this obstacle.
bool velocity_field__is_shutting(const scene_obstacle *obstacle);

/// How far the line is moved for the links; see field_rule.c.
vec2 velocity_field__shift(const scene *s, const scene_obstacle *obstacle);

/// The line of a segment for the links, moved by shift and longer by the tolerance at both ends.
field__line velocity_field__line_of(const field__segment *segment, vec2 shift);

/// True if the link between two cell centres crosses the line.
bool velocity_field__crosses(const field__line *line, vec2 from, vec2 to);
