#include "core/feed/capacity.h"

#include "core/scene/belt_range.h"
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
