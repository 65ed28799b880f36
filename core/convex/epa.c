// A polytope of triangles inside a - b grows at the side that is nearest to the origin, until that
// side lies on the border of a - b: its distance is then the depth.

#include "core/convex/convex_priv.h"

#include <float.h>
#include <string.h>

enum { POINTS_MAX = 256, FACES_MAX = 1024, NO_FACE = -1 };

/// Relative to the size of the difference: a side that can be moved by less is on the border.
#define ROUNDING 1e-14

/// A triangle, counter-clockwise as seen from outside.
typedef struct side {
    int corner[3];    // points
    int neighbour[3]; // the side beyond corner[k], corner[k + 1]
    vec3 normal;
    double distance; // of its plane from the origin; DBL_MAX where it has no area
    bool is_dropped;
} side;

typedef struct polytope {
    const gjk_pair *pair;
    double size;
    int n_points, n_sides, n_rim;
    minkowski__point point[POINTS_MAX];
    side sides[FACES_MAX];
    int rim_side[FACES_MAX], rim_edge[FACES_MAX]; // the horizon: the edges of new sides, in order
} polytope;

static void set_plane(polytope *p, side *s)
{
    vec3 a = p->point[s->corner[0]].at;
    vec3 ab = vec3_sub(p->point[s->corner[1]].at, a), ac = vec3_sub(p->point[s->corner[2]].at, a);
    vec3 across = vec3_cross(ab, ac);
    double length = vec3_length(across);

    s->distance = DBL_MAX;
    s->normal = (vec3){ 0.0, 0.0, 0.0 };
    if (length <= ROUNDING * p->size * p->size)
        return;
    s->normal = vec3_scale(across, 1.0 / length);
    s->distance = vec3_dot(s->normal, a);
}

static bool is_seen(const side *s, vec3 from, double margin)
{
    return s->distance != DBL_MAX && vec3_dot(s->normal, from) - s->distance > margin;
}

/// Remove the sides that are visible from a point, starting from the one that is entered over an edge, and
/// record the edges around them (the horizon) in order.
static void drop_seen(polytope *p, int at, int entered, vec3 from, double margin)
{
    side *s = &p->sides[at];

    s->is_dropped = true;
    for (int turn = entered < 0 ? 0 : 1; turn < 3; turn++) {
        int edge = (entered < 0 ? turn : entered + turn) % 3, next = s->neighbour[edge];
        const side *beyond = &p->sides[next];
        if (beyond->is_dropped)
            continue;
        if (!is_seen(beyond, from, margin)) {
            p->rim_side[p->n_rim] = at;
            p->rim_edge[p->n_rim++] = edge;
            continue;
        }
        int entry = beyond->neighbour[0] == at ? 0 : beyond->neighbour[1] == at ? 1 : 2;
        drop_seen(p, next, entry, from, margin);
    }
}

/// True if the horizon is one closed path.
static bool is_closed(const polytope *p)
{
    for (int k = 0; k < p->n_rim; k++) {
        int next = (k + 1) % p->n_rim;
        const side *s = &p->sides[p->rim_side[k]], *t = &p->sides[p->rim_side[next]];
        if (s->corner[(p->rim_edge[k] + 1) % 3] != t->corner[p->rim_edge[next]])
            return false;
    }
    return p->n_rim >= 3;
}

/// Add new sides from the edges of the horizon to the last point.
static void close_up(polytope *p)
{
    int first = p->n_sides, n = p->n_rim;

    for (int k = 0; k < n; k++) {
        const side *old = &p->sides[p->rim_side[k]];
        int edge = p->rim_edge[k], beyond = old->neighbour[edge];
        side *s = &p->sides[first + k];
        *s = (side){ { old->corner[edge], old->corner[(edge + 1) % 3], p->n_points - 1 },
                     { beyond, first + (k + 1) % n, first + (k + n - 1) % n },
                     { 0.0, 0.0, 0.0 },
                     0.0,
                     false };
        side *there = &p->sides[beyond];
        for (int m = 0; m < 3; m++)
            if (there->corner[m] == s->corner[1] && there->corner[(m + 1) % 3] == s->corner[0])
                there->neighbour[m] = first + k;
        set_plane(p, s);
    }
    p->n_sides += n;
}

/// Add a point beyond a side. Returns false if there is no memory, or rounding makes the horizon invalid; the
/// sides are then as good as they were.
static bool grow(polytope *p, int at, minkowski__point point)
{
    double margin = ROUNDING * p->size;

    if (p->n_points == POINTS_MAX)
        return false;
    p->n_rim = 0;
    drop_seen(p, at, -1, point.at, margin);
    if (p->n_sides + p->n_rim > FACES_MAX || !is_closed(p))
        return false;
    p->point[p->n_points++] = point;
    close_up(p);
    return true;
}

static int nearest_side(const polytope *p)
{
    int found = NO_FACE;

    for (int k = 0; k < p->n_sides; k++)
        if (!p->sides[k].is_dropped && p->sides[k].distance != DBL_MAX &&
            (found == NO_FACE || p->sides[k].distance < p->sides[found].distance))
            found = k;
    return found;
}

/// Directions in which a simplex that is flat may find a point outside it.
static int list_directions(const polytope *p, vec3 *ret_directions)
{
    static const vec3 along_axes[6] = {
        { 1.0, 0.0, 0.0 },  { -1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 },
        { 0.0, -1.0, 0.0 }, { 0.0, 0.0, 1.0 },  { 0.0, 0.0, -1.0 },
    };
    vec3 a = p->point[0].at;

    if (p->n_points == 1) {
        memcpy(ret_directions, along_axes, sizeof along_axes);
        return 6;
    }
    vec3 along = vec3_sub(p->point[1].at, a);
    if (p->n_points == 3) {
        vec3 normal = vec3_unit(vec3_cross(along, vec3_sub(p->point[2].at, a)));
        ret_directions[0] = normal;
        ret_directions[1] = vec3_scale(normal, -1.0);
        return 2;
    }
    vec3 u = vec3_aside(vec3_unit(along)), v = vec3_cross(vec3_unit(along), u);
    for (int k = 0; k < 6; k++)
        ret_directions[k] = vec3_along(vec3_scale(u, cos(M_PI / 3.0 * k)), sin(M_PI / 3.0 * k), v);
    return 6;
}

/// Distance of a point from the affine hull of the points so far: a point, a line or a
/// plane.
static double measure_off(const polytope *p, vec3 at)
{
    vec3 a = p->point[0].at, to = vec3_sub(at, a);

    if (p->n_points == 1)
        return vec3_length(to);
    vec3 along = vec3_unit(vec3_sub(p->point[1].at, a));
    if (p->n_points == 2)
        return vec3_length(vec3_cross(along, to));
    return fabs(vec3_dot(vec3_unit(vec3_cross(along, vec3_sub(p->point[2].at, a))), to));
}

/// Make a tetrahedron of the points so far. Returns false if the whole difference is flat.
static bool fill_up(polytope *p)
{
    vec3 directions[6];

    while (p->n_points < 4) {
        int n = list_directions(p, directions);
        minkowski__point best = p->point[0];
        double farthest = 0.0;
        for (int k = 0; k < n; k++) {
            minkowski__point trial = minkowski__support(p->pair, directions[k]);
            double off = measure_off(p, trial.at);
            if (off > farthest) {
                farthest = off;
                best = trial;
            }
        }
        if (farthest <= 1e3 * ROUNDING * p->size)
            return false;
        p->point[p->n_points++] = best;
    }
    return true;
}

static void make_tetrahedron(polytope *p)
{
    static const int corners[4][3] = { { 0, 1, 2 }, { 0, 3, 1 }, { 1, 3, 2 }, { 0, 2, 3 } };
    static const int neighbours[4][3] = { { 1, 2, 3 }, { 3, 2, 0 }, { 1, 3, 0 }, { 0, 2, 1 } };
    vec3 a = p->point[0].at;
    vec3 normal = vec3_cross(vec3_sub(p->point[1].at, a), vec3_sub(p->point[2].at, a));

    if (vec3_dot(normal, vec3_sub(p->point[3].at, a)) > 0.0) {
        minkowski__point swap = p->point[1];
        p->point[1] = p->point[2];
        p->point[2] = swap;
    }
    p->n_sides = 4;
    for (int k = 0; k < 4; k++) {
        side *s = &p->sides[k];
        *s = (side){ { corners[k][0], corners[k][1], corners[k][2] },
                     { neighbours[k][0], neighbours[k][1], neighbours[k][2] },
                     { 0.0, 0.0, 0.0 },
                     0.0,
                     false };
        set_plane(p, s);
    }
}

/// Weights of a point in the plane of a side; returns the least of them.
static double find_weights(const polytope *p, const side *s, vec3 at, double *ret_weights)
{
    double sum = 0.0;

    for (int k = 0; k < 3; k++) {
        vec3 to_next = vec3_sub(p->point[s->corner[(k + 1) % 3]].at, at);
        vec3 to_last = vec3_sub(p->point[s->corner[(k + 2) % 3]].at, at);
        ret_weights[k] = vec3_dot(vec3_cross(to_next, to_last), s->normal);
        sum += ret_weights[k];
    }
    for (int k = 0; k < 3; k++)
        ret_weights[k] /= sum;
    return fmin(ret_weights[0], fmin(ret_weights[1], ret_weights[2]));
}

/// The contact at the projection of the origin on a side. A face of the difference may be several sides in
/// one plane: the witnesses are those of the one that contains the projection.
static gjk_result touch_at(const polytope *p, const side *best)
{
    vec3 foot = vec3_scale(best->normal, best->distance);
    double weights[3], trial[3], most = find_weights(p, best, foot, weights), slack = 1e-12;
    const side *holder = best;
    minkowski__point points[3];

    for (int k = 0; k < p->n_sides && most < 0.0; k++) {
        const side *s = &p->sides[k];
        bool is_in_plane = !s->is_dropped && s->distance - best->distance < slack * p->size &&
                           vec3_dot(s->normal, best->normal) > 1.0 - slack;
        if (is_in_plane && find_weights(p, s, foot, trial) > most) {
            holder = s;
            most = find_weights(p, s, foot, weights);
        }
    }
    for (int k = 0; k < 3; k++)
        points[k] = p->point[holder->corner[k]];
    gjk_result touch = minkowski__witnesses(p->pair, points, weights, 3);
    touch.distance = -best->distance;
    touch.normal = best->normal;
    return touch;
}

/// Points and lines that touch: depth 0; any direction at right angles to them is a valid normal.
static gjk_result touch_flat(const polytope *p, vec3 axis)
{
    double length = vec3_length(axis);
    gjk_result touch = minkowski__witnesses(p->pair, p->point, (double[]){ 1.0 }, 1);

    touch.normal = length > 0.0 ? vec3_scale(axis, 1.0 / length) : (vec3){ 1.0, 0.0, 0.0 };
    if (p->n_points == 2)
        touch.normal = vec3_aside(vec3_unit(vec3_sub(p->point[1].at, p->point[0].at)));
    if (p->n_points == 3)
        touch.normal = vec3_unit(vec3_cross(vec3_sub(p->point[1].at, p->point[0].at),
                                            vec3_sub(p->point[2].at, p->point[0].at)));
    return touch;
}

gjk_result epa__penetrate(const gjk_pair *pair, const gjk__simplex *start, vec3 axis)
{
    polytope p;

    p.pair = pair;
    p.size = minkowski__size(pair);
    p.n_points = 0;
    for (int k = 0; k < start->n; k++)
        if (p.n_points == 0 || measure_off(&p, start->point[k].at) > 1e3 * ROUNDING * p.size)
            p.point[p.n_points++] = start->point[k];
    if (!fill_up(&p))
        return touch_flat(&p, axis);
    make_tetrahedron(&p);
    side best = p.sides[nearest_side(&p)];
    for (int at = nearest_side(&p); at != NO_FACE; at = nearest_side(&p)) {
        best = p.sides[at];
        minkowski__point point = minkowski__support(pair, best.normal);
        if (!is_seen(&best, point.at, ROUNDING * p.size) || !grow(&p, at, point))
            break;
    }
    return touch_at(&p, &best);
}
