#include "core/scene/feed_line.h"

#include <math.h>

feed_line_span feed_line_usable(const surroundings *around, const scene_feed *feed,
                                const shape_footprint *footprint, double heading)
{
    const vec2 line = vec2_sub(feed->line[1], feed->line[0]);
    feed_line_span places = { 0.0, 1.0 };

    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        if (around->edges[side] != SCENE_EDGE_WALL || (feed->is_edge && side == (int)feed->edge))
            continue;
        const surroundings_line wall = surroundings_side(around, (scene_side)side);
        const double needed =
            shape_extent(footprint, heading, vec2_scale(wall.inward, -1.0)) + SCENE_TOLERANCE;
        const double rise = vec2_dot(wall.inward, line);
        const double missing = needed - vec2_dot(wall.inward, vec2_sub(feed->line[0], wall.at));
        if (rise > 0.0)
            places.low = fmax(places.low, missing / rise);
        else if (rise < 0.0)
            places.high = fmin(places.high, missing / rise);
        else if (missing > 0.0)
            places.high = -INFINITY;
    }
    return places;
}
