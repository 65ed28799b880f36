#include "core/scene/feed_line.h"

#include "core/base/polygon.h"
#include "core/scene/mix.h"
#include "core/scene/plate_pieces.h"

#include <math.h>

enum { HALVINGS = 40 }; // of a way, until its end is found

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

// Whether a plate stands on a part of the way from an end of a feed's line: at a side on what lies within a radius behind it.
static bool is_closed(const scene_feed *feed, const surroundings *around, const vec2 *way,
                      double part, double radius, const vec2 *plate)
{
    const vec2 end = vec2_between(way[0], way[1], part);
    vec2 ways[] = { way[0], end, way[0], end }, hull[5];
    size_t n = 2;

    if (feed->is_edge) {
        const vec2 behind = vec2_scale(surroundings_side(around, feed->edge).inward, radius);
        ways[2] = vec2_add(way[0], behind);
        ways[3] = vec2_add(end, behind);
        n = 4;
    }
    n = polygon_convex_hull(ways, n, hull);
    return polygon_overlaps(hull, n, plate, 4, SCENE_TOLERANCE);
}

// The place on a way from an end of a feed's line up to which no plate stands at t = 0.
static vec2 end_of_way(const scene *s, const scene_feed *feed, vec2 from, vec2 to, double radius)
{
    const surroundings around = surroundings_of(s);
    const vec2 way[] = { from, to };
    double part = 1.0;
    vec2 plate[4];

    for (size_t k = 0; k < s->n_obstacles; k++) {
        for (size_t m = 0; m + 1 < s->obstacles[k].n_points; m++) {
            double low = 0.0;
            if (!plate_pieces_get(&around, &s->obstacles[k], m, plate) ||
                !is_closed(feed, &around, way, part, radius, plate))
                continue;
            for (int i = 0; i < HALVINGS; i++) {
                const double middle = 0.5 * (low + part);
                if (is_closed(feed, &around, way, middle, radius, plate))
                    part = middle;
                else
                    low = middle;
            }
            part = low;
        }
    }
    return part < 1.0 ? vec2_between(from, to, part) : to;
}

void feed_line_widened(const scene *s, const scene_feed *feed, vec2 ret_line[2])
{
    const vec2 along = vec2_sub(feed->line[1], feed->line[0]);
    const double length = vec2_length(along), radius = mix_inner_radii_of(s).smallest;
    const double beyond = length > 0.0 ? 0.5 * (2.0 * radius / length - 1.0) : 0.0;

    for (int k = 0; k < 2; k++) {
        ret_line[k] = feed->line[k];
        if (!(beyond > 0.0))
            continue;
        vec2 to = vec2_add(feed->line[k], vec2_scale(along, k == 0 ? -beyond : beyond));
        to.x = fmin(fmax(to.x, s->domain.x_min), s->domain.x_max);
        to.y = fmin(fmax(to.y, s->domain.y_min), s->domain.y_max);
        ret_line[k] = end_of_way(s, feed, feed->line[k], to, radius);
    }
}
