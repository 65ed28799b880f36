#include "core/macro/arc_faces.h"

#include "core/base/polygon.h"
#include "core/scene/belt.h"

#include <math.h>

/// What the velocities of an arc follow from.
typedef struct arc_grid {
    const velocity_field *f;
    const scene *s;
    const surroundings *around;
    const scene_belt *belt;
    double edge; ///< the longer one of a cell, m
} arc_grid;

/// The way from the centre of the arc to a corner of the grid, plus parts of a cell.
static vec2 way_to(const arc_grid *a, size_t i, size_t j, double part1, double part2)
{
    const bf_grid *g = &a->f->grid;

    return (vec2){ g->lower1 + ((double)i + part1) * g->d1 - a->belt->centre.x,
                   g->lower2 + ((double)j + part2) * g->d2 - a->belt->centre.y };
}

/// The radius that counts for psi: between both borders, and that of a border which is nearer than a cell.
static double border_radius(const arc_grid *a, double radius)
{
    const scene_arc *arc = &a->belt->arc;

    if (radius < arc->inner_radius + a->edge)
        return arc->inner_radius;
    return radius > arc->outer_radius - a->edge ? arc->outer_radius : radius;
}

/// The radius of the nearest guide on the arc to a place, and how far that is, m; 0: the nearest piece of a plate is none.
static double guide_radius(const arc_grid *a, vec2 at, double *ret_distance)
{
    double nearest = INFINITY, radius = 0.0;

    for (size_t k = 0; k < a->s->n_obstacles; k++) {
        const scene_obstacle *o = &a->s->obstacles[k];
        for (size_t m = 0; m + 1 < o->n_points; m++) {
            const double distance = polygon_segment_distance(at, o->path[m], o->path[m + 1]);
            if (distance >= nearest)
                continue;
            const surroundings_piece piece = surroundings_piece_of(a->around, o, m);
            const vec2 middle = vec2_scale(vec2_add(piece.start, piece.end), 0.5);
            const bool is_guide =
                surroundings_is_guide(piece.along, belt_velocity(a->belt, middle));
            nearest = distance;
            radius = is_guide ? vec2_length(vec2_sub(piece.start, a->belt->centre)) : 0.0;
        }
    }
    *ret_distance = nearest;
    return radius;
}

/// True if a guide on the arc may have closed one of the faces that meet in a corner inside the grid.
static bool meets_closed(const velocity_field *f, size_t i, size_t j)
{
    const size_t n1 = f->grid.n1, n2 = f->grid.n2;

    if (i == 0 || i == n1 || j == 0 || j == n2)
        return false;
    return f->closed1[(j - 1) * (n1 + 1) + i] || f->closed1[j * (n1 + 1) + i] ||
           f->closed2[j * n1 + i - 1] || f->closed2[j * n1 + i];
}

/// True if a cell, seen from the centre of the arc, is beyond one of its circles, between its ends.
static bool is_beyond(const scene_arc *arc, vec2 cell)
{
    const double radius = vec2_length(cell);

    return (radius < arc->inner_radius || radius > arc->outer_radius) && belt_arc_spans(arc, cell);
}

/// The radius of which psi is taken at a corner; *ret_is_own: it is the corner's.
static double radius_at(const arc_grid *a, size_t i, size_t j, bool *ret_is_own)
{
    const scene_arc *arc = &a->belt->arc;
    const vec2 way = way_to(a, i, j, 0.0, 0.0);
    const double own = vec2_length(way);

    *ret_is_own = false;
    for (int k = 0; k < 4; k++) {
        const vec2 cell = way_to(a, i, j, (k & 1) - 0.5, (k >> 1) - 0.5);
        if (is_beyond(arc, cell))
            return vec2_length(cell) < arc->inner_radius ? arc->inner_radius : arc->outer_radius;
    }
    if (meets_closed(a->f, i, j)) {
        double distance;
        const double radius = guide_radius(a, vec2_add(a->belt->centre, way), &distance);
        if (radius > 0.0)
            return border_radius(a, radius);
    }
    const double between = fmin(fmax(own, arc->inner_radius), arc->outer_radius);
    *ret_is_own = between == own;
    return between;
}

bool arc_faces_is_held(const velocity_field *f, const scene *s, const surroundings *around,
                       size_t arc, int axis, size_t i, size_t j)
{
    const bf_grid *g = &f->grid;
    const arc_grid a = { f, s, around, &around->belts[arc], fmax(g->d1, g->d2) };
    const vec2 after = way_to(&a, i, j, 0.5, 0.5);
    const vec2 before = way_to(&a, i, j, axis == 0 ? -0.5 : 0.5, axis == 0 ? 0.5 : -0.5);
    double distance;

    if (is_beyond(&a.belt->arc, before) == is_beyond(&a.belt->arc, after))
        return false;
    const vec2 middle = vec2_scale(vec2_add(before, after), 0.5);
    return guide_radius(&a, vec2_add(a.belt->centre, middle), &distance) > 0.0 && distance < a.edge;
}

double arc_faces_velocity(const velocity_field *f, const scene *s, const surroundings *around,
                          size_t arc, int axis, size_t i, size_t j)
{
    const bf_grid *g = &f->grid;
    const arc_grid a = { f, s, around, &around->belts[arc], fmax(g->d1, g->d2) };
    bool is_own[2];
    const double from = radius_at(&a, i, j, &is_own[0]);
    const double to = radius_at(&a, i + (axis == 1), j + (axis == 0), &is_own[1]);

    // Where no border or guide is near, the velocity in the middle has the same value with less rounding.
    if (is_own[0] && is_own[1]) {
        const vec2 way = way_to(&a, i, j, axis == 0 ? 0.0 : 0.5, axis == 0 ? 0.5 : 0.0);
        return axis == 0 ? -a.belt->turn * way.y : a.belt->turn * way.x;
    }
    const double rise = 0.5 * a.belt->turn * (to - from) * (to + from);
    return axis == 0 ? -rise / g->d2 : rise / g->d1;
}
