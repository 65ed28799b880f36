#include "core/feed/capacity.h"

#include "core/scene/belt_speeds.h"
#include "core/scene/surroundings.h"

#include <math.h>

// Speed of the belt at a point of a line across it, m/s; of the belt itself for a line without length.
static double speed_across(const surroundings *around, vec2 at, vec2 line, double length)
{
    const size_t belt = surroundings_belt_at(around, at);

    if (belt >= around->n_belts)
        return 0.0;
    const vec2 velocity =
        vec2_scale(around->belts[belt].velocity, belt_speeds_largest(&around->belts[belt]));
    return length > 0.0 ? fabs(vec2_cross(line, velocity)) / length : vec2_length(velocity);
}

double feed_capacity(const scene *s, const scene_feed *feed)
{
    const surroundings around = surroundings_of(s);
    const vec2 line = vec2_sub(feed->line[1], feed->line[0]);
    const double packing = scene_packing_density(s), length = vec2_length(line);
    double mean = 0.0;

    for (int k = 0; k < CAPACITY_POINTS; k++) {
        const vec2 at = vec2_add(feed->line[0], vec2_scale(line, (k + 0.5) / CAPACITY_POINTS));
        mean += speed_across(&around, at, line, length) / CAPACITY_POINTS;
    }
    return packing * mean * (length + 1.0 / sqrt(packing));
}
