#include "core/scene/belt.h"

double belt_largest_speed(const scene_belt *belt)
{
    double largest = belt->turn == 0.0 || belt->n_points == 0 ? vec2_length(belt->velocity) : 0.0;

    for (size_t k = 0; belt->turn != 0.0 && k < belt->n_points; k++)
        largest = fmax(largest, vec2_length(belt_velocity(belt, belt->polygon[k])));
    return largest;
}
