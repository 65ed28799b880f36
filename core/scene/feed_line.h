/// The line of a feed: which places on it a part may have its centre in.

#pragma once

#include "core/scene/shape.h"
#include "core/scene/surroundings.h"

/// Places along a line, from its start, 0, to its end, 1. low > high: none.
typedef struct feed_line_span {
    double low;  ///< first one
    double high; ///< last one
} feed_line_span;

/// Where a footprint at a heading, rad, does not stick into a wall of the domain.
feed_line_span feed_line_usable(const surroundings *around, const scene_feed *feed,
                                const shape_footprint *footprint, double heading);

/// The line of a checked scene's feed, about its middle as long as the smallest kind of parts is wide at least: parts of a lane in
/// single file have their centres on a line that is shorter than they are wide. It ends at the domain's sides, and at plates that stand
/// there at t = 0.
void feed_line_widened(const scene *s, const scene_feed *feed, vec2 ret_line[2]);

/// A point of the line, m.
static inline vec2 feed_line_at(const scene_feed *feed, double place)
{
    return vec2_add(feed->line[0], vec2_scale(vec2_sub(feed->line[1], feed->line[0]), place));
}
