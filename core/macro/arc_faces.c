#include "core/macro/arc_faces.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/scene/arc_lanes.h"
#include "core/scene/belt.h"

#include <math.h>
#include <string.h>

/// What the velocities of an arc, or of another belt with lanes, follow from.
typedef struct arc_grid {
    const velocity_field *f;
    const scene *s;
    const surroundings *around;
    const scene_belt *belt;
    double edge; ///< the longer one of a cell, m
} arc_grid;

/// A corner of the grid, plus parts of a cell.
static vec2 place_of(const bf_grid *g, size_t i, size_t j, double part1, double part2)
{
    return (vec2){ g->lower1 + ((double)i + part1) * g->d1,
                   g->lower2 + ((double)j + part2) * g->d2 };
}

/// q of the nearest guide on the arc to a place, and how far that is, m; NAN: the nearest piece of a plate is none.
static double guide_lane(const arc_grid *a, vec2 at, double *ret_distance)
{
    const scene_obstacle *nearest = NULL;
    size_t piece_of_nearest = 0;

    *ret_distance = INFINITY;
    for (size_t k = 0; k < a->s->n_obstacles; k++) {
        const scene_obstacle *o = &a->s->obstacles[k];
        for (size_t m = 0; m + 1 < o->n_points; m++) {
            const double distance = polygon_segment_distance(at, o->path[m], o->path[m + 1]);
            if (distance >= *ret_distance)
                continue;
            *ret_distance = distance;
            nearest = o;
            piece_of_nearest = m;
        }
    }
    if (nearest == NULL)
        return (double)NAN;
    const surroundings_piece piece = surroundings_piece_of(a->around, nearest, piece_of_nearest);
    const vec2 middle = vec2_scale(vec2_add(piece.start, piece.end), 0.5);
    return surroundings_is_guide(piece.along, belt_velocity(a->belt, middle))
               ? belt_lane_at(a->belt, piece.start)
               : (double)NAN;
}

/// True if a guide on the arc may have closed one of the faces that meet in a corner inside the grid.
static bool meets_closed(const velocity_field *f, size_t i, size_t j)
{
    const size_t n1 = f->grid.n1, n2 = f->grid.n2;

    if (i == 0 || i == n1 || j == 0 || j == n2)
        return false;
    return f->faces[0].closed[(j - 1) * (n1 + 1) + i] || f->faces[0].closed[j * (n1 + 1) + i] ||
           f->faces[1].closed[j * n1 + i - 1] || f->faces[1].closed[j * n1 + i];
}

/// True if the centre of a cell is beyond a border of the arc, between its ends.
static bool is_beyond(const arc_grid *a, vec2 cell)
{
    const double q = belt_lane_at(a->belt, cell);

    return (q < belt_lane_low(a->belt) || q > belt_lane_high(a->belt)) &&
           belt_lanes_span(a->belt, cell, a->edge);
}

/// q of the border or guide beside a corner; NAN: there is none.
static double line_lane(const arc_grid *a, size_t i, size_t j)
{
    const bf_grid *g = &a->f->grid;
    const double low = belt_lane_low(a->belt), high = belt_lane_high(a->belt);
    double distance;

    for (int k = 0; k < 4; k++) {
        const vec2 cell = place_of(g, i, j, (k & 1) - 0.5, (k >> 1) - 0.5);
        if (is_beyond(a, cell))
            return belt_lane_at(a->belt, cell) < low ? low : high;
    }
    if (!meets_closed(a->f, i, j))
        return (double)NAN;
    const double q = guide_lane(a, place_of(g, i, j, 0.0, 0.0), &distance);
    // A guide nearer than a cell to a border counts as that; NAN stays.
    if (q < low + a->edge)
        return low;
    return q > high - a->edge ? high : q;
}

/// A range of corners along an axis: those from low to high, m, and two more on either side.
static void find_range(double low, double high, double lower, double edge, size_t n,
                       size_t *ret_first, size_t *ret_count)
{
    *ret_first = grid_clamp(floor((low - lower) / edge) - 2.0, n);
    const size_t last = grid_clamp(ceil((high - lower) / edge) + 2.0, n);
    *ret_count = (last > *ret_first ? last - *ret_first : 0) + 1;
}

static bf_status init_corners(arc_corners *c, const scene_belt *belt, const bf_grid *g)
{
    vec2 low = belt->polygon[0], high = low;

    for (size_t k = 1; k < belt->n_points; k++) {
        low = (vec2){ fmin(low.x, belt->polygon[k].x), fmin(low.y, belt->polygon[k].y) };
        high = (vec2){ fmax(high.x, belt->polygon[k].x), fmax(high.y, belt->polygon[k].y) };
    }
    find_range(low.x, high.x, g->lower1, g->d1, g->n1, &c->i_first, &c->n1);
    find_range(low.y, high.y, g->lower2, g->d2, g->n2, &c->j_first, &c->n2);
    // The polygon of an arc lies within it.
    const double beyond1 = 2.0 * g->d1 + 1e-3 * belt->arc.outer_radius;
    const double beyond2 = 2.0 * g->d2 + 1e-3 * belt->arc.outer_radius;
    c->box = (scene_rect){ low.x - beyond1, high.x + beyond1, low.y - beyond2, high.y + beyond2 };
    c->lane = memory_alloc(c->n1 * c->n2, sizeof *c->lane);
    c->own = memory_alloc(c->n1 * c->n2, sizeof *c->own);
    c->line = memory_alloc(c->n1 * c->n2, sizeof *c->line);
    c->before = memory_alloc(c->n1 * c->n2, sizeof *c->before);
    return c->lane != NULL && c->own != NULL && c->line != NULL && c->before != NULL ? BF_OK
                                                                                     : BF_ENOMEM;
}

bf_status arc_faces_init(arc_faces *ret_faces, const scene *s, const bf_grid *g)
{
    arc_faces faces = { .arcs = memory_alloc(s->n_sections, sizeof *faces.arcs) };
    bf_status status = faces.arcs != NULL ? BF_OK : BF_ENOMEM;

    for (size_t k = 0; status == BF_OK && k < s->n_sections; k++) {
        if (!belt_has_lanes(&s->belts[k]))
            continue;
        faces.arcs[faces.n] = (arc_corners){ .arc = k };
        status = init_corners(&faces.arcs[faces.n++], &s->belts[k], g);
    }
    if (status != BF_OK)
        arc_faces_fini(&faces);
    *ret_faces = faces;
    return status;
}

void arc_faces_fini(arc_faces *faces)
{
    for (size_t k = 0; k < faces->n; k++) {
        memory_free(faces->arcs[k].lane);
        memory_free(faces->arcs[k].own);
        memory_free(faces->arcs[k].line);
        memory_free(faces->arcs[k].before);
    }
    memory_free(faces->arcs);
    *faces = (arc_faces){ .n = 0 };
}

/// Let the corners around one that has the q of a line, in column m and row n, differ from it no more than they may: those
/// of smaller q where it lies within its line (sign 1), those of larger ones where it lies beyond (-1).
static void spread(arc_corners *c, const bf_grid *g, size_t m, size_t n, double excess, double sign)
{
    const double far_sqr = 0.999 * ARC_LANES_SPREAD * ARC_LANES_SPREAD;
    const double q = c->lane[n * c->n1 + m];
    // Beyond this the corner's own q differs less, as that changes by at most the way.
    const double reach = sign * excess / (ARC_LANES_SPREAD - 1.0);
    const size_t across1 = (size_t)(reach / g->d1), across2 = (size_t)(reach / g->d2);
    const size_t m_end = m + across1 < c->n1 ? m + across1 + 1 : c->n1;
    const size_t n_end = n + across2 < c->n2 ? n + across2 + 1 : c->n2;

    for (size_t row = n > across2 ? n - across2 : 0; row < n_end; row++) {
        const double way2 = ((double)row - (double)n) * g->d2;
        const double *lanes = c->lane + row * c->n1;
        for (size_t column = m > across1 ? m - across1 : 0; column < m_end; column++) {
            const double way1 = ((double)column - (double)m) * g->d1;
            const double way_sqr = way1 * way1 + way2 * way2;
            const double differs = sign * (q - lanes[column]);
            // Most corners are far from their bound: these need no root.
            if (differs <= 0.0 || differs * differs < far_sqr * way_sqr)
                continue;
            const size_t at = row * c->n1 + column;
            const double most = ARC_LANES_SPREAD * sqrt(way_sqr);
            if (c->line[at] == 0 && differs > most)
                c->lane[at] = q - sign * most;
        }
    }
}

static void spread_all(arc_corners *c, const arc_grid *a, double sign)
{
    for (size_t n = 0; n < c->n2; n++)
        for (size_t m = 0; m < c->n1; m++) {
            const size_t at = n * c->n1 + m;
            if (c->line[at] == 0)
                continue;
            const double excess =
                c->lane[at] - belt_lane_at(a->belt, place_of(&a->f->grid, c->i_first + m,
                                                             c->j_first + n, 0.0, 0.0));
            if (sign * excess > 0.0)
                spread(c, &a->f->grid, m, n, excess, sign);
        }
}

/// The corners low <= k < high along an axis that lie from first to last, m; the arc's begin with `at` and are n.
static void find_corners(double first, double last, double lower, double edge, size_t at, size_t n,
                         size_t ret_range[2])
{
    const double low = floor((first - lower) / edge) - (double)at;
    const double high = ceil((last - lower) / edge) + 1.0 - (double)at;

    ret_range[0] = grid_clamp(low, n);
    ret_range[1] = grid_clamp(high, n);
}

/// Bring the own q of the corners within a rectangle, and which of them have that of a line, to the closed faces. True if one has
/// changed.
static bool find_lines(arc_corners *c, const arc_grid *a, const scene_rect *within)
{
    const bf_grid *g = &a->f->grid;
    const double low = belt_lane_low(a->belt), high = belt_lane_high(a->belt);
    size_t columns[2], rows[2];
    bool has_changed = false;

    find_corners(within->x_min, within->x_max, g->lower1, g->d1, c->i_first, c->n1, columns);
    find_corners(within->y_min, within->y_max, g->lower2, g->d2, c->j_first, c->n2, rows);
    for (size_t n = rows[0]; n < rows[1]; n++)
        for (size_t m = columns[0]; m < columns[1]; m++) {
            const size_t at = n * c->n1 + m, i = c->i_first + m, j = c->j_first + n;
            const double q = line_lane(a, i, j);
            const bool is_line = !isnan(q);
            const double at_corner = belt_lane_at(a->belt, place_of(g, i, j, 0.0, 0.0));
            const double own = is_line ? q : fmin(fmax(at_corner, low), high);
            has_changed = has_changed || c->line[at] != is_line || c->own[at] != own;
            c->line[at] = is_line;
            c->own[at] = own;
        }
    return has_changed;
}

/// A rectangle that holds the faces beside the corners whose q' differs from that before. False: there is none.
static bool find_moved(const arc_corners *c, const bf_grid *g, scene_rect *ret_moved)
{
    size_t m_low = c->n1, m_high = 0, n_low = c->n2, n_high = 0;

    for (size_t n = 0; n < c->n2; n++)
        for (size_t m = 0; m < c->n1; m++) {
            if (c->lane[n * c->n1 + m] == c->before[n * c->n1 + m])
                continue;
            m_low = m < m_low ? m : m_low;
            m_high = m > m_high ? m : m_high;
            n_low = n < n_low ? n : n_low;
            n_high = n;
        }
    const vec2 low = place_of(g, c->i_first + m_low, c->j_first + n_low, -1.0, -1.0);
    const vec2 high = place_of(g, c->i_first + m_high, c->j_first + n_high, 1.0, 1.0);
    *ret_moved = (scene_rect){ low.x, high.x, low.y, high.y };
    return n_low < c->n2;
}

size_t arc_faces_update(arc_faces *faces, const velocity_field *f, const scene *s,
                        const surroundings *around, size_t n, const scene_rect *changed,
                        scene_rect *ret_due)
{
    size_t n_due = 0;

    for (size_t k = 0; k < faces->n; k++) {
        arc_corners *c = &faces->arcs[k];
        const arc_grid a = { f, s, around, &around->belts[c->arc], fmax(f->grid.d1, f->grid.d2) };
        const size_t n_bytes = c->n1 * c->n2 * sizeof *c->lane;
        bool has_changed = false;
        for (size_t m = 0; m < n; m++)
            has_changed = find_lines(c, &a, &changed[m]) || has_changed;
        if (!has_changed)
            continue;
        memcpy(c->before, c->lane, n_bytes);
        memcpy(c->lane, c->own, n_bytes);
        spread_all(c, &a, 1.0);
        spread_all(c, &a, -1.0);
        n_due += find_moved(c, &f->grid, &ret_due[n_due]);
    }
    return n_due;
}

bool arc_faces_is_held(const velocity_field *f, const scene *s, const surroundings *around,
                       size_t arc, int axis, size_t i, size_t j)
{
    const bf_grid *g = &f->grid;
    const arc_grid a = { f, s, around, &around->belts[arc], fmax(g->d1, g->d2) };
    const vec2 after = place_of(g, i, j, 0.5, 0.5);
    const vec2 before = place_of(g, i, j, axis == 0 ? -0.5 : 0.5, axis == 0 ? 0.5 : -0.5);
    double distance;

    if (is_beyond(&a, before) == is_beyond(&a, after))
        return false;
    const vec2 middle = vec2_scale(vec2_add(before, after), 0.5);
    return !isnan(guide_lane(&a, middle, &distance)) && distance < a.edge;
}

double arc_faces_velocity(const arc_faces *faces, const bf_grid *g, const scene_belt *belts,
                          size_t arc, int axis, size_t i, size_t j)
{
    const scene_belt *belt = &belts[arc];
    const arc_corners *c = faces->arcs;
    double q[2], own[2];

    while (c->arc != arc)
        c++;
    for (int k = 0; k < 2; k++) {
        const size_t m = i + (size_t)(k * (axis == 1)), n = j + (size_t)(k * (axis == 0));
        own[k] = belt_lane_at(belt, place_of(g, m, n, 0.0, 0.0));
        q[k] =
            m < c->i_first || n < c->j_first || m - c->i_first >= c->n1 || n - c->j_first >= c->n2
                ? own[k]
                : c->lane[(n - c->j_first) * c->n1 + m - c->i_first];
    }
    // Where no border or guide is near, the velocity in the middle has the same value with less rounding.
    if (q[0] == own[0] && q[1] == own[1]) {
        const vec2 middle = place_of(g, i, j, axis == 0 ? 0.0 : 0.5, axis == 0 ? 0.5 : 0.0);
        const vec2 v = belt_velocity(belt, middle);
        return axis == 0 ? v.x : v.y;
    }
    const double rise = belt_lane_rise(belt, q[0], q[1]);
    return axis == 0 ? -rise / g->d2 : rise / g->d1;
}
