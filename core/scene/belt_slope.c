#include "core/scene/belt_slope.h"

#include "core/scene/belt.h"

#include <math.h>

// The direction of a belt that is not level.
static vec2 direction_of(const scene_belt *belt)
{
    return vec2_scale(belt->velocity, 1.0 / vec2_length(belt->velocity));
}

static double friction_of(const scene_belt *belt, const scene_contact *conveyor)
{
    return belt_friction_ratio(belt, conveyor) * conveyor->friction;
}

vec2 belt_slope_pull(const scene_belt *belt, double gravity)
{
    return belt->incline == 0.0 ? (vec2){ 0.0, 0.0 }
                                : vec2_scale(direction_of(belt), -gravity * sin(belt->incline));
}

double belt_slope_ratio(const scene_belt *belt, const scene_contact *conveyor)
{
    return belt->incline == 0.0 ? 0.0 : tan(belt->incline) / friction_of(belt, conveyor);
}

vec2 belt_slope_hold(const scene_belt *belt, const scene_contact *conveyor)
{
    const double ratio =
        fmin(fmax(belt_slope_ratio(belt, conveyor), -BELT_SLOPE_HELD), BELT_SLOPE_HELD);

    return ratio == 0.0 ? (vec2){ 0.0, 0.0 }
                        : vec2_scale(direction_of(belt), atanh(ratio) / conveyor->tanh_linear);
}

double belt_slope_drive(const scene_belt *belt, const scene_contact *conveyor)
{
    return friction_of(belt, conveyor) * cos(belt->incline) - sin(belt->incline);
}

double belt_slope_largest_drive(size_t n_belts, const scene_belt *belts,
                                const scene_contact *conveyor)
{
    double largest = n_belts > 0 ? 0.0 : conveyor->friction;

    for (size_t k = 0; k < n_belts; k++)
        largest = fmax(largest, friction_of(&belts[k], conveyor) * cos(belts[k].incline) +
                                    fabs(sin(belts[k].incline)));
    return largest;
}

double belt_slope_least_drive(size_t n_belts, const scene_belt *belts,
                              const scene_contact *conveyor)
{
    double least = n_belts > 0 ? INFINITY : conveyor->friction;

    for (size_t k = 0; k < n_belts; k++)
        least = fmin(least, friction_of(&belts[k], conveyor) * cos(belts[k].incline) -
                                fabs(sin(belts[k].incline)));
    return fmax(least, 0.0);
}
