#include "core/feed/capacity.h"

#include "core/scene/belt_range.h"
#include "core/scene/mix.h"
#include "core/scene/surroundings.h"

#include <math.h>

// The belt's velocity under a point at its largest factor, m/s; zero off every belt.
static vec2 velocity_at(const surroundings *around, vec2 at)
{
    const size_t belt = surroundings_belt_at(around, at);

    if (belt >= around->n_belts)
        return (vec2){ 0.0, 0.0 };
    return vec2_scale(belt_velocity(&around->belts[belt], at),
                      belt_range_largest(&around->belts[belt]));
}

void feed_wide_line(const scene *s, const scene_feed *feed, vec2 ret_line[2])
{
    const vec2 along = vec2_sub(feed->line[1], feed->line[0]);
    const double length = vec2_length(along), width = 2.0 * mix_inner_radii_of(s).smallest;
    const double beyond = length > 0.0 ? fmax(0.5 * (width / length - 1.0), 0.0) : 0.0;

    ret_line[0] = vec2_sub(feed->line[0], vec2_scale(along, beyond));
    ret_line[1] = vec2_add(feed->line[1], vec2_scale(along, beyond));
    for (int k = 0; k < 2; k++) {
        ret_line[k].x = fmin(fmax(ret_line[k].x, s->domain.x_min), s->domain.x_max);
        ret_line[k].y = fmin(fmax(ret_line[k].y, s->domain.y_min), s->domain.y_max);
    }
}

double feed_capacity(const scene *s, const scene_feed *feed)
{
    const surroundings around = surroundings_of(s);
    const vec2 line = vec2_sub(feed->line[1], feed->line[0]);
    const double packing = scene_packing_density(s), width = 1.0 / sqrt(packing);
    double area = 0.0; // m2/s

    for (int k = 0; k < CAPACITY_POINTS; k++) {
        const vec2 at = vec2_add(feed->line[0], vec2_scale(line, (k + 0.5) / CAPACITY_POINTS));
        const vec2 velocity = velocity_at(&around, at);
        area +=
            (fabs(vec2_cross(line, velocity)) + width * vec2_length(velocity)) / CAPACITY_POINTS;
    }
    return packing * area;
}
