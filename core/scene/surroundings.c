#include "core/scene/surroundings.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/scene/mix.h"

#include <float.h>
#include <math.h>
#include <string.h>

surroundings surroundings_of(const scene *s)
{
    surroundings around = { .domain = s->domain, .n_belts = s->n_sections, .belts = s->belts };
    bool has_border = false; // else radii do not matter

    for (size_t k = 0; k < s->n_sections; k++)
        has_border = has_border || s->belts[k].n_points > 0;
    around.bridge = has_border ? mix_inner_radii_of(s).smallest : 0.0;
    memcpy(around.edges, s->edges, sizeof around.edges);
    return around;
}

bf_status surroundings_copy(const surroundings *from, surroundings *ret_copy, bf_error *err)
{
    scene_belt *belts = memory_alloc(from->n_belts, sizeof *belts);

    *ret_copy = *from;
    ret_copy->n_belts = 0;
    ret_copy->belts = belts;
    for (size_t k = 0; belts != NULL && k < from->n_belts; k++) {
        const size_t n_points = from->belts[k].n_points;
        belts[k] = from->belts[k];
        belts[k].speed_schedule = (scene_speed_schedule){ .n_times = 0 };
        belts[k].stops = (scene_stops){ .n_failures = 0 };
        belts[k].polygon = memory_alloc(n_points, sizeof *belts[k].polygon);
        if (belts[k].polygon == NULL)
            break;
        if (n_points > 0)
            memcpy(belts[k].polygon, from->belts[k].polygon, n_points * sizeof *belts[k].polygon);
        ret_copy->n_belts++;
    }
    if (belts != NULL && ret_copy->n_belts == from->n_belts)
        return BF_OK;
    surroundings_fini(ret_copy);
    return bf_fail(err, BF_ENOMEM, "/belts", "no memory for the belts");
}

void surroundings_fini(surroundings *copy)
{
    for (size_t k = 0; k < copy->n_belts; k++)
        memory_free(copy->belts[k].polygon);
    memory_free((void *)copy->belts);
    *copy = (surroundings){ .n_belts = 0 };
}

size_t surroundings_belt_below(const surroundings *around, vec2 at)
{
    for (size_t k = around->n_belts; k-- > 0;)
        if (belt_holds(&around->belts[k], at))
            return k;
    return around->n_belts;
}

/// The directions in a convex cone with its tip in a point; once they span half a turn or more, the point is in their
/// hull.
typedef struct cone {
    bool has_any;
    bool is_hull; ///< the rest does not count any more
    vec2 right;   ///< its sides, less than half a turn apart
    vec2 left;
} cone;

static bool cone_holds(const cone *c, vec2 to)
{
    const double from_right = vec2_cross(c->right, to), to_left = vec2_cross(to, c->left);

    // Of a cone that is a ray, the opposite direction is not in it.
    return from_right >= 0.0 && to_left >= 0.0 &&
           (from_right > 0.0 || to_left > 0.0 || vec2_dot(c->right, to) > 0.0);
}

static void cone_add(cone *c, vec2 to)
{
    if (!c->has_any) {
        *c = (cone){ .has_any = true, .right = to, .left = to };
    } else if (!cone_holds(c, to)) {
        c->is_hull = c->is_hull || cone_holds(c, vec2_scale(to, -1.0));
        if (vec2_cross(c->left, to) > 0.0)
            c->left = to;
        else
            c->right = to;
    }
}

/// Add what of a segment is nearer to a point than a radius. A segment's directions are between those of its ends.
static void cone_add_segment(cone *c, vec2 at, double radius, vec2 start, vec2 end)
{
    const vec2 way = vec2_sub(end, start), to = vec2_sub(start, at);
    const double a = vec2_dot(way, way), b = vec2_dot(way, to);
    const double root = b * b - a * (vec2_dot(to, to) - radius * radius);

    if (!(root > 0.0) || c->is_hull)
        return;
    const double first = fmax((-b - sqrt(root)) / a, 0.0), last = fmin((-b + sqrt(root)) / a, 1.0);
    if (first > last)
        return;
    cone_add(c, vec2_add(to, vec2_scale(way, first)));
    cone_add(c, vec2_add(to, vec2_scale(way, last)));
}

static vec2 mirror(const surroundings_line *side, vec2 at)
{
    const double height = vec2_dot(vec2_sub(at, side->at), side->inward);

    return vec2_add(at, vec2_scale(side->inward, -2.0 * height));
}

/// Add a border of a belt, and its images beyond the sides of the domain.
static void cone_add_border(cone *c, const surroundings *around, vec2 at, double radius, vec2 start,
                            vec2 end)
{
    cone_add_segment(c, at, radius, start, end);
    for (int k = 0; k < SCENE_SIDE_COUNT; k++) {
        const surroundings_line side = surroundings_side(around, (scene_side)k);
        if (surroundings_excess(around, (scene_side)k, at) > -radius)
            cone_add_segment(c, at, radius, mirror(&side, start), mirror(&side, end));
    }
}

/// True if a point is in the hull of what of the belts is nearer than a radius.
static bool is_held(const surroundings *around, vec2 at, double radius)
{
    cone c = { .has_any = false };

    for (size_t k = 0; k < around->n_belts && !c.is_hull; k++) {
        const vec2 *polygon = around->belts[k].polygon;
        const bool is_far = belt_arc_is_far(&around->belts[k], at, radius);
        const size_t n = is_far ? 0 : around->belts[k].n_points;
        for (size_t m = 0, last = n - 1; m < n; last = m++)
            if (!polygon_segment_is_far(at, polygon[last], polygon[m], radius + SCENE_TOLERANCE) &&
                polygon_segment_distance(at, polygon[last], polygon[m]) < radius)
                cone_add_border(&c, around, at, radius, polygon[last], polygon[m]);
    }
    return c.is_hull;
}

/// The nearest belt to a point, if it is nearer than a radius, and its nearest point.
static size_t find_nearest(const surroundings *around, vec2 at, double radius, vec2 *ret_foot)
{
    double nearest = radius;
    size_t belt = around->n_belts;

    for (size_t k = 0; k < around->n_belts; k++) {
        const vec2 *polygon = around->belts[k].polygon;
        const bool is_far = belt_arc_is_far(&around->belts[k], at, radius);
        const size_t n = is_far ? 0 : around->belts[k].n_points;
        for (size_t m = 0, last = n - 1; m < n; last = m++) {
            if (polygon_segment_is_far(at, polygon[last], polygon[m], nearest + SCENE_TOLERANCE))
                continue;
            const vec2 foot = polygon_segment_nearest(at, polygon[last], polygon[m]);
            const double distance = vec2_length(vec2_sub(at, foot));
            if (distance > nearest || distance >= radius)
                continue;
            nearest = distance;
            belt = k;
            *ret_foot = foot;
        }
    }
    return belt;
}

/// The belt that carries over a gap at a point that is under no belt.
static size_t find_bridge(const surroundings *around, vec2 at, double radius)
{
    vec2 foot = at;
    const size_t belt = find_nearest(around, at, radius, &foot);

    if (belt == around->n_belts)
        return belt;
    const vec2 way = vec2_sub(at, foot);
    const double beyond = fmin(1.0, 2.0 * SCENE_TOLERANCE / vec2_length(way));
    return is_held(around, at, radius) &&
                   is_held(around, vec2_add(foot, vec2_scale(way, beyond)), radius)
               ? belt
               : around->n_belts;
}

size_t surroundings_belt_under(const surroundings *around, vec2 at, double radius)
{
    const size_t belt = surroundings_belt_below(around, at);

    return belt < around->n_belts ? belt : find_bridge(around, at, radius);
}

size_t surroundings_belt_at(const surroundings *around, vec2 at)
{
    return surroundings_belt_under(around, at, around->bridge);
}

vec2 surroundings_velocity_under(const surroundings *around, vec2 at)
{
    return surroundings_velocity_at(around, surroundings_belt_at(around, at), at);
}

double surroundings_border_distance(const surroundings *around, vec2 at)
{
    double nearest = DBL_MAX;

    for (size_t k = 0; k < around->n_belts; k++)
        nearest = fmin(nearest, belt_border_distance(&around->belts[k], at));
    return nearest;
}

/// Most steps, of a few nanoseconds each, in which places under no belt are looked for.
#define COVER_STEPS_MAX 3e6

/// A straight border, and where its present piece, between two crossings with others, begins and ends on it, 0 to 1.
typedef struct border_walk {
    vec2 start;
    vec2 way;
    double from;
    double to;
} border_walk;

/// Let the piece end where the border crosses a segment, if that is in it.
static void cut_piece(border_walk *w, vec2 start, vec2 end)
{
    const vec2 along = vec2_sub(end, start), apart = vec2_sub(start, w->start);
    const double sine = vec2_cross(w->way, along);
    const double at = vec2_cross(apart, along) / sine, there = vec2_cross(apart, w->way) / sine;
    const double slit = SURROUNDINGS_SLIT / vec2_length(w->way);

    if (there >= -SURROUNDINGS_SLIT && there <= 1.0 + SURROUNDINGS_SLIT && at > w->from + slit)
        w->to = fmin(w->to, at);
}

static bool is_bare(const surroundings *around, vec2 at)
{
    double excess = -INFINITY;

    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        excess = fmax(excess, surroundings_excess(around, (scene_side)side, at));
    return excess < 0.0 && surroundings_belt_below(around, at) == around->n_belts;
}

/// True if a place beside a border is under no belt. Beside a piece all places are alike.
static bool is_bare_beside(const surroundings *around, vec2 start, vec2 end, double *steps,
                           double steps_of_piece)
{
    border_walk w = { .start = start, .way = vec2_sub(end, start) };
    const vec2 aside =
        vec2_scale(vec2_turn_left(w.way), 0.5 * SURROUNDINGS_SLIT / vec2_length(w.way));

    for (w.from = 0.0; w.from < 1.0; w.from = w.to) {
        // Find the end of the piece that begins at w->from.
        const scene_rect *d = &around->domain;
        w.to = 1.0;
        for (size_t k = 0; k < around->n_belts; k++) {
            const vec2 *polygon = around->belts[k].polygon;
            const size_t n = around->belts[k].n_points;
            for (size_t m = 0, last = n - 1; m < n; last = m++)
                cut_piece(&w, polygon[last], polygon[m]);
        }
        cut_piece(&w, (vec2){ d->x_min, d->y_min }, (vec2){ d->x_max, d->y_min });
        cut_piece(&w, (vec2){ d->x_min, d->y_max }, (vec2){ d->x_max, d->y_max });
        cut_piece(&w, (vec2){ d->x_min, d->y_min }, (vec2){ d->x_min, d->y_max });
        cut_piece(&w, (vec2){ d->x_max, d->y_min }, (vec2){ d->x_max, d->y_max });
        const vec2 middle = vec2_add(start, vec2_scale(w.way, 0.5 * (w.from + w.to)));
        *steps += steps_of_piece;
        if (*steps > COVER_STEPS_MAX || is_bare(around, vec2_add(middle, aside)) ||
            is_bare(around, vec2_sub(middle, aside)))
            return true;
    }
    return false;
}

// Where some of the domain is under no belt, all of it is, or a belt ends beside that.
bool surroundings_may_drop(const surroundings *around)
{
    const scene_rect *d = &around->domain;
    const vec2 middle = { 0.5 * (d->x_min + d->x_max), 0.5 * (d->y_min + d->y_max) };
    double steps = 0.0, steps_of_piece = 0.0;

    for (size_t k = 0; k < around->n_belts; k++) {
        if (around->belts[k].n_points == 0)
            return false;
        steps_of_piece += 3.0 * (double)around->belts[k].n_points;
    }
    if (around->n_belts > 0 && is_bare(around, middle))
        return true;
    for (size_t k = 0; k < around->n_belts; k++) {
        const vec2 *polygon = around->belts[k].polygon;
        const size_t n = around->belts[k].n_points;
        for (size_t m = 0, last = n - 1; m < n; last = m++)
            if (is_bare_beside(around, polygon[last], polygon[m], &steps, steps_of_piece))
                return true;
    }
    return false;
}

bool surroundings_is_guide(vec2 along, vec2 belt)
{
    return fabs(vec2_cross(along, belt)) <= SURROUNDINGS_GUIDE_SINE * vec2_length(belt);
}

vec2 surroundings_upstream(vec2 along, vec2 belt)
{
    vec2 left = vec2_turn_left(along);
    bool is_downstream = !surroundings_is_guide(along, belt) && vec2_dot(left, belt) > 0.0;

    return is_downstream ? vec2_scale(left, -1.0) : left;
}

/// A straight piece of a path.
typedef struct stretch {
    vec2 along;    ///< unit tangent
    double length; ///< m
    vec2 middle;   ///< m
    vec2 belt;     ///< velocity of the belt in its middle, m/s
} stretch;

static stretch stretch_of(const surroundings *around, vec2 start, vec2 end)
{
    const vec2 to = vec2_sub(end, start);
    const double length = vec2_length(to);
    const vec2 middle = vec2_add(start, vec2_scale(to, 0.5));

    return (stretch){ vec2_scale(to, 1.0 / length), length, middle,
                      surroundings_velocity_under(around, middle) };
}

/// The upstream side of a piece: 1 left, -1 right, 0 of a guide.
static int side_of(const stretch *piece)
{
    if (surroundings_is_guide(piece->along, piece->belt))
        return 0;
    return vec2_cross(piece->along, piece->belt) > 0.0 ? -1 : 1;
}

/// The same of piece k of a path.
static int side_of_piece(const surroundings *around, const scene_obstacle *obstacle, size_t k)
{
    const stretch piece = stretch_of(around, obstacle->path[k], obstacle->path[k + 1]);

    return side_of(&piece);
}

/// The side of the piece that is no guide and nearest to an end of a path, and the piece; 0: the pieces there are all guides.
static int find_end_side(const surroundings *around, const scene_obstacle *obstacle, bool is_last,
                         stretch *ret_piece)
{
    const size_t n = obstacle->n_points - 1;
    int side = 0;

    for (size_t m = 0; m <= SURROUNDINGS_JOINED && m < n && side == 0; m++) {
        const size_t k = is_last ? n - 1 - m : m;
        *ret_piece = stretch_of(around, obstacle->path[k], obstacle->path[k + 1]);
        side = side_of(ret_piece);
    }
    return side;
}

/// The upstream side of a path as a whole; 0: the pieces at its ends are all guides.
static int find_path_side(const surroundings *around, const scene_obstacle *obstacle)
{
    stretch first, last;
    const int side = find_end_side(around, obstacle, false, &first);
    const int other = find_end_side(around, obstacle, true, &last);

    if (side * other >= 0)
        return side != 0 ? side : other;
    return vec2_dot(vec2_sub(last.middle, first.middle), vec2_add(first.belt, last.belt)) < 0.0
               ? other
               : side;
}

/// The side that a guide between two points of a path takes from the other pieces; 0: it is centred.
static int find_side(const surroundings *around, const scene_obstacle *obstacle, size_t first,
                     size_t last)
{
    int side = find_path_side(around, obstacle);

    for (size_t k = 1; k <= SURROUNDINGS_JOINED && side == 0; k++) {
        if (k <= first)
            side = side_of_piece(around, obstacle, first - k);
        if (side == 0 && last + k < obstacle->n_points)
            side = side_of_piece(around, obstacle, last + k - 1);
    }
    return side;
}

surroundings_piece surroundings_span_of(const surroundings *around, const scene_obstacle *obstacle,
                                        size_t first, size_t last)
{
    const vec2 start = obstacle->path[first], end = obstacle->path[last];
    const stretch way = stretch_of(around, start, end);
    surroundings_piece piece = { .start = start,
                                 .end = end,
                                 .along = way.along,
                                 .upstream = surroundings_upstream(way.along, way.belt),
                                 .length = way.length,
                                 .thickness = obstacle->thickness };

    if (side_of(&way) != 0) {
        if (side_of(&way) * find_path_side(around, obstacle) < 0)
            piece.lift = piece.thickness;
        return piece;
    }
    const int side = find_side(around, obstacle, first, last);
    if (side < 0)
        piece.upstream = vec2_scale(piece.upstream, -1.0);
    if (side == 0)
        piece.lift = 0.5 * piece.thickness;
    return piece;
}

surroundings_piece surroundings_piece_of(const surroundings *around, const scene_obstacle *obstacle,
                                         size_t k)
{
    return surroundings_span_of(around, obstacle, k, k + 1);
}

void surroundings_piece_corners(const surroundings_piece *piece, vec2 ret_corners[4])
{
    const vec2 up = vec2_scale(piece->upstream, piece->lift);
    const vec2 through = vec2_scale(piece->upstream, -piece->thickness);
    const bool is_left = vec2_cross(piece->along, piece->upstream) > 0.0;

    ret_corners[0] = vec2_add(is_left ? piece->end : piece->start, up);
    ret_corners[1] = vec2_add(is_left ? piece->start : piece->end, up);
    ret_corners[2] = vec2_add(ret_corners[1], through);
    ret_corners[3] = vec2_add(ret_corners[0], through);
}

// How much of a side lies along a polygon that is convex there, m: between the least and the largest place at which its
// border meets the side.
static double length_along(const surroundings *around, scene_side side, size_t n,
                           const vec2 *polygon)
{
    const scene_rect *d = &around->domain;
    const bool is_upright = side == SCENE_WEST || side == SCENE_EAST;
    const double start = is_upright ? d->y_min : d->x_min, end = is_upright ? d->y_max : d->x_max;
    double least = end, most = start;

    for (size_t m = 0, last = n - 1; m < n; last = m++) {
        const vec2 a = polygon[last], b = polygon[m];
        const double beyond = surroundings_excess(around, side, a);
        const double next = surroundings_excess(around, side, b);
        const bool is_on = fabs(next) <= SCENE_TOLERANCE;
        if (!is_on && (beyond > 0.0) == (next > 0.0))
            continue;
        const vec2 at = is_on ? b : vec2_between(a, b, beyond / (beyond - next));
        const double place = fmin(fmax(is_upright ? at.y : at.x, start), end);
        least = fmin(least, place);
        most = fmax(most, place);
    }
    return most - least;
}

bool surroundings_is_outlet(const surroundings *around, size_t belt)
{
    const scene_belt *b = &around->belts[belt];
    bool is_found = false;

    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        is_found |= around->edges[side] == SCENE_EDGE_OUTFLOW &&
                    (b->n_points == 0 || length_along(around, (scene_side)side, b->n_points,
                                                      b->polygon) > SURROUNDINGS_SLIT);
    return is_found;
}

surroundings_line surroundings_side(const surroundings *around, scene_side side)
{
    const scene_rect *d = &around->domain;

    switch (side) {
    case SCENE_WEST:
        return (surroundings_line){ { d->x_min, d->y_min }, { 1.0, 0.0 } };
    case SCENE_EAST:
        return (surroundings_line){ { d->x_max, d->y_min }, { -1.0, 0.0 } };
    case SCENE_SOUTH:
        return (surroundings_line){ { d->x_min, d->y_min }, { 0.0, 1.0 } };
    default:
        return (surroundings_line){ { d->x_min, d->y_max }, { 0.0, -1.0 } };
    }
}
