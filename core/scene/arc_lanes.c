#include "core/scene/arc_lanes.h"

#include "core/scene/belt.h"
#include "core/scene/surroundings.h"

#include <math.h>

enum { LINES_MAX = 64 }; // of an arc that are looked at

// Radii of borders and guides, rising.
typedef struct arc_lines {
    double radius[LINES_MAX];
    size_t n;
} arc_lines;

static void add_line(arc_lines *to, double radius)
{
    size_t k = to->n++;

    for (; k > 0 && to->radius[k - 1] > radius; k--)
        to->radius[k] = to->radius[k - 1];
    to->radius[k] = radius;
}

static bool is_near(const arc_lines *lines, double radius, double cell)
{
    bool is_near = false;

    for (size_t k = 0; k < lines->n; k++)
        is_near = is_near || fabs(lines->radius[k] - radius) < cell;
    return is_near;
}

static void add_guides(const scene *s, const scene_belt *belt, double cell, arc_lines *to)
{
    for (size_t k = 0; k < s->n_obstacles; k++)
        for (size_t m = 0; m + 1 < s->obstacles[k].n_points && to->n < LINES_MAX; m++) {
            const vec2 start = s->obstacles[k].path[m],
                       way = vec2_sub(s->obstacles[k].path[m + 1], start);
            const vec2 middle = vec2_add(start, vec2_scale(way, 0.5));
            const double radius = belt_lane_at(belt, start), length = vec2_length(way);
            if (length > 0.0 && belt_holds(belt, middle) && !is_near(to, radius, cell) &&
                surroundings_is_guide(vec2_scale(way, 1.0 / length), belt_velocity(belt, middle)))
                add_line(to, radius);
        }
}

double arc_lanes_speedup(const scene *s, const scene_belt *belt, double cell)
{
    arc_lines lines = { .n = 0 };
    double speedup = ARC_LANES_SPREAD;

    add_line(&lines, belt_lane_low(belt));
    add_line(&lines, belt_lane_high(belt));
    add_guides(s, belt, cell, &lines);
    for (size_t k = 1; k < lines.n; k++) {
        const double width = (lines.radius[k] - lines.radius[k - 1]) / cell;
        if (width > M_SQRT2)
            speedup = fmax(speedup, fmin(width / M_SQRT2, width / (width - M_SQRT2)));
    }
    return lines.n < LINES_MAX ? speedup : 2.0;
}
