#include "core/advice/layout.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/scene/mix.h"
#include "core/scene/surroundings.h"

#include <math.h>

enum {
    AHEAD_STEPS = 2,    ///< in a radius, in which the next belt is looked for
    HALVINGS = 24,      ///< of a step, until the border in it is found
    CORNERS = 4,        ///< of a piece with its thickness
    LINK_SAMPLES = 16,  ///< places of a link between two bodies at which belts are looked for
    WALL_SAMPLES = 256, ///< places of a wall at which belts are looked for
};

/// Most steps, of a few nanoseconds each, in which belts are looked for between bodies.
#define STEPS_MAX 1e8

/// Directions whose cosine with another is within this are at right angles to it.
#define RIGHT_ANGLE 1e-6

/// Velocities are equal where they differ by this share.
#define ROUNDING 1e-6

/// A straight piece of a plate, as far as it lies in the domain, or beyond a side where cargo flows in.
typedef struct piece {
    size_t obstacle;       ///< whose it is
    size_t index;          ///< in its path
    vec2 start;            ///< of its path, m
    vec2 end;              ///< of its path, m
    vec2 along;            ///< unit tangent from start to end
    vec2 upstream;         ///< unit normal of the upstream side
    vec2 belt;             ///< velocity of the belt in its middle in the domain, m/s
    bool deflects;         ///< the belt moves, and not along it
    vec2 corners[CORNERS]; ///< with its thickness, counter-clockwise, m
} piece;

typedef struct measuring {
    const scene *s;
    surroundings around;
    double closed_gap;  ///< of a gap at a wall, m
    double radius;      ///< of the largest part, m
    double least_width; ///< of a gap that the narrowest part fits through, m
    size_t n;           ///< pieces
    piece *pieces;      ///< n of them
    size_t *groups;     ///< of the pieces and then the sides: another of the same body, or itself
    layout_figure opening;  ///< the narrowest found so far that a part fits through
    layout_figure gap;      ///< the narrowest of the others
    double steps_of_lookup; ///< to find the belt under a point
    double steps;           ///< that samples of links took
} measuring;

/// The velocity of the belt under a point; zero off every belt.
static vec2 belt_under(const measuring *m, vec2 at)
{
    return surroundings_velocity_under(&m->around, at);
}

/// Cut a piece at the domain. With over_inflow not where cargo flows in: nothing comes from there but what
/// the caller has placed, so that a plate is as good as closed where it is beyond. False: nothing is left.
static bool clip(const scene *s, bool over_inflow, vec2 *start, vec2 *end)
{
    const scene_rect *d = &s->domain;
    vec2 lower = { d->x_min, d->y_min }, upper = { d->x_max, d->y_max };

    if (over_inflow) {
        lower.x = s->edges[SCENE_WEST] == SCENE_EDGE_INFLOW ? -INFINITY : lower.x;
        upper.x = s->edges[SCENE_EAST] == SCENE_EDGE_INFLOW ? INFINITY : upper.x;
        lower.y = s->edges[SCENE_SOUTH] == SCENE_EDGE_INFLOW ? -INFINITY : lower.y;
        upper.y = s->edges[SCENE_NORTH] == SCENE_EDGE_INFLOW ? INFINITY : upper.y;
    }
    return polygon_clip_segment(start, end, lower, upper) &&
           vec2_length(vec2_sub(*end, *start)) > SCENE_LENGTH_MIN;
}

/// False: the piece does not lie in the domain.
static bool make_piece(const measuring *m, size_t obstacle, size_t index, piece *ret_piece)
{
    const scene_obstacle *o = &m->s->obstacles[obstacle];
    piece p = {
        .obstacle = obstacle, .index = index, .start = o->path[index], .end = o->path[index + 1]
    };
    const vec2 whole = vec2_sub(p.end, p.start);
    vec2 inner[2] = { p.start, p.end };

    if (!clip(m->s, true, &p.start, &p.end))
        return false;
    p.along = vec2_scale(whole, 1.0 / vec2_length(whole));
    if (clip(m->s, false, &inner[0], &inner[1]))
        p.belt = belt_under(m, vec2_scale(vec2_add(inner[0], inner[1]), 0.5));
    p.upstream = surroundings_upstream(p.along, p.belt);
    p.deflects = !surroundings_is_guide(p.along, p.belt);
    surroundings_piece cut = surroundings_piece_of(&m->around, o, index);
    cut.start = p.start;
    cut.end = p.end;
    surroundings_piece_corners(&cut, p.corners);
    *ret_piece = p;
    return true;
}

// ---- bodies: what touches

static size_t body_of(const measuring *m, size_t item)
{
    while (m->groups[item] != item)
        item = m->groups[item];
    return item;
}

static size_t body_of_side(const measuring *m, scene_side side)
{
    return body_of(m, m->n + side);
}

/// The lower index leads, so that a body's name does not depend on the order of joining.
static void join(measuring *m, size_t a, size_t b)
{
    const size_t body_a = body_of(m, a), body_b = body_of(m, b);
    const size_t first = body_a < body_b ? body_a : body_b;

    m->groups[body_a] = m->groups[body_b] = m->groups[a] = m->groups[b] = first;
}

/// Lower bound of the distance of two pieces, by their bounds along one axis.
static double bounds_gap(const piece *a, const piece *b, bool is_y)
{
    double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };

    for (int k = 0; k < CORNERS; k++) {
        const double at[2] = { is_y ? a->corners[k].y : a->corners[k].x,
                               is_y ? b->corners[k].y : b->corners[k].x };
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], at[i]);
            high[i] = fmax(high[i], at[i]);
        }
    }
    return fmax(low[0] - high[1], low[1] - high[0]);
}

static bool may_be_within(const piece *a, const piece *b, double distance)
{
    return bounds_gap(a, b, false) <= distance && bounds_gap(a, b, true) <= distance;
}

/// Distance of a piece from the wall at a side, m, and the corner that is nearest.
static double wall_gap(const measuring *m, const piece *p, scene_side side, vec2 *ret_corner)
{
    double gap = INFINITY;

    for (int k = 0; k < CORNERS; k++) {
        const double own = -surroundings_excess(&m->around, side, p->corners[k]);
        if (own < gap) {
            gap = own;
            *ret_corner = p->corners[k];
        }
    }
    return fmax(gap, 0.0);
}

static bool is_wall(const measuring *m, scene_side side)
{
    return m->around.edges[side] == SCENE_EDGE_WALL;
}

/// Join what is that near to a wall or to another piece, m.
static void join_bodies(measuring *m, double to_wall, double to_piece)
{
    vec2 on_a, on_b;

    for (size_t k = 0; k < m->n + SCENE_SIDE_COUNT; k++)
        m->groups[k] = k;
    for (size_t k = 0; k < m->n; k++) {
        const piece *p = &m->pieces[k];
        for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
            if (is_wall(m, side) && wall_gap(m, p, side, &on_a) <= to_wall)
                join(m, k, m->n + side);
        }
        for (size_t i = 0; i < k; i++) {
            const piece *q = &m->pieces[i];
            if (body_of(m, k) != body_of(m, i) && may_be_within(p, q, to_piece) &&
                polygon_distance(p->corners, CORNERS, q->corners, CORNERS, &on_a, &on_b) <=
                    to_piece)
                join(m, k, i);
        }
    }
}

// ---- openings: the distances of bodies

/// True if two segments cross; with touching also if an end of one lies on the other's line.
static bool segments_cross(vec2 a, vec2 b, vec2 c, vec2 d, bool touching)
{
    const vec2 along = vec2_sub(b, a), other = vec2_sub(d, c);
    const double least = touching ? SCENE_TOLERANCE : 0.0;

    return vec2_cross(along, vec2_sub(c, a)) * vec2_cross(along, vec2_sub(d, a)) < least &&
           vec2_cross(other, vec2_sub(a, c)) * vec2_cross(other, vec2_sub(b, c)) < least;
}

static bool is_plate_between(const measuring *m, vec2 a, vec2 b, bool touching)
{
    for (size_t k = 0; k < m->n; k++) {
        if (m->pieces[k].deflects &&
            segments_cross(a, b, m->pieces[k].start, m->pieces[k].end, touching))
            return true;
    }
    return false;
}

/// True if the belt runs against a wall somewhere ahead of a point.
static bool is_wall_ahead(const measuring *m, vec2 belt)
{
    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        if (is_wall(m, side) && vec2_dot(belt, surroundings_side(&m->around, side).inward) <
                                    -SURROUNDINGS_GUIDE_SINE * vec2_length(belt))
            return true;
    }
    return false;
}

/// True if a plate keeps off what the belt would bring to a point, and nothing ahead of it would hold cargo back, so
/// that it spread to there.
static bool is_behind_plate(measuring *m, vec2 at, vec2 belt)
{
    const scene_rect *d = &m->s->domain;
    const double far = (d->x_max - d->x_min) + (d->y_max - d->y_min);
    const vec2 way = vec2_scale(belt, far / vec2_length(belt));

    m->steps += 2.0 * (double)m->n;
    return is_plate_between(m, vec2_sub(at, way), at, false) &&
           !is_plate_between(m, at, vec2_add(at, way), true) && !is_wall_ahead(m, belt);
}

/// True if cargo starts or enters on the line along which the belt carries it past a point.
static bool is_supplied(const measuring *m, vec2 at, vec2 belt)
{
    const scene_rect *d = &m->s->domain;
    const double far = (d->x_max - d->x_min) + (d->y_max - d->y_min);
    const vec2 ahead = vec2_scale(belt, 1.0 / vec2_length(belt));
    const vec2 from = vec2_sub(at, vec2_scale(ahead, far)),
               to = vec2_add(at, vec2_scale(ahead, far));
    const scene_placement *parts = &m->s->placement;

    // Parts are not placed yet in a scene that was not checked.
    if (parts->n == 0 && m->s->n_feeds == 0)
        return true;
    for (size_t k = 0; k < m->s->n_feeds; k++) {
        if (segments_cross(from, to, m->s->feeds[k].line[0], m->s->feeds[k].line[1], true))
            return true;
    }
    for (size_t k = 0; k < parts->n; k++) {
        const vec2 place = vec2_sub((vec2){ parts->poses[k].x, parts->poses[k].y }, at);
        if (fabs(vec2_cross(place, ahead)) < m->radius)
            return true;
    }
    return false;
}

/// True if some of the way from a to b lies on a moving belt and not behind a plate, and, between two guides, not along
/// the belt, as the joint between two rails is no opening, and where the belt brings cargo.
static bool is_passage(measuring *m, vec2 a, vec2 b, bool are_guides)
{
    const vec2 to = vec2_sub(b, a);

    for (int k = 0; k < LINK_SAMPLES; k++) {
        const vec2 at = vec2_add(a, vec2_scale(to, (k + 0.5) / LINK_SAMPLES));
        const vec2 belt = belt_under(m, at);
        const double speed = vec2_length(belt);
        m->steps += m->steps_of_lookup;
        if (!surroundings_is_inside(&m->s->domain, at) || speed == 0.0 ||
            is_behind_plate(m, at, belt))
            continue;
        if (!are_guides ||
            (fabs(vec2_cross(to, belt)) > SURROUNDINGS_GUIDE_SINE * speed * vec2_length(to) &&
             is_supplied(m, at, belt)))
            return true;
    }
    return false;
}

double layout_least_width(double inner_radius)
{
    return 2.0 * inner_radius - SCENE_LENGTH_MIN;
}

static void consider_opening(measuring *m, const piece *p, vec2 a, vec2 b, double width,
                             bool are_guides)
{
    layout_figure *narrowest = width >= m->least_width ? &m->opening : &m->gap;

    if (width < narrowest->value && m->steps <= STEPS_MAX && is_passage(m, a, b, are_guides))
        *narrowest = (layout_figure){ width, p->obstacle };
}

static void measure_openings(measuring *m)
{
    vec2 on_p, on_q;

    for (size_t k = 0; k < m->n; k++) {
        const piece *p = &m->pieces[k];
        for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
            if (!is_wall(m, side) || body_of(m, k) == body_of_side(m, side))
                continue;
            const double width = wall_gap(m, p, side, &on_p);
            const vec2 inward = surroundings_side(&m->around, side).inward;
            on_q = vec2_sub(on_p, vec2_scale(inward, width));
            consider_opening(m, p, on_p, on_q, width, !p->deflects);
        }
        for (size_t i = 0; i < k; i++) {
            const piece *q = &m->pieces[i];
            if (body_of(m, k) == body_of(m, i) || !may_be_within(p, q, m->opening.value))
                continue;
            const double width =
                polygon_distance(p->corners, CORNERS, q->corners, CORNERS, &on_p, &on_q);
            consider_opening(m, p, on_p, on_q, width, !p->deflects && !q->deflects);
        }
    }
}

/// True if a body joins two opposite walls.
static bool closes_domain(const measuring *m, size_t body)
{
    return (is_wall(m, SCENE_SOUTH) && is_wall(m, SCENE_NORTH) &&
            body_of_side(m, SCENE_SOUTH) == body && body_of_side(m, SCENE_NORTH) == body) ||
           (is_wall(m, SCENE_WEST) && is_wall(m, SCENE_EAST) &&
            body_of_side(m, SCENE_WEST) == body && body_of_side(m, SCENE_EAST) == body);
}

// ---- angles and corners

/// True if something that goes on from the downstream end of a piece in a direction keeps cargo there.
static bool holds_cargo(const piece *p, vec2 arm)
{
    const double length = vec2_length(arm);

    return vec2_dot(arm, p->belt) < -RIGHT_ANGLE * length * vec2_length(p->belt) &&
           vec2_dot(arm, p->upstream) > RIGHT_ANGLE * length;
}

/// True if the other piece goes on from the tip of p to one of its own ends and keeps cargo there.
static bool meets_piece(const measuring *m, const piece *p, vec2 tip, const piece *other)
{
    const bool is_next = other->obstacle == p->obstacle &&
                         (other->index + 1 == p->index || p->index + 1 == other->index);
    const double thickness = m->s->obstacles[other->obstacle].thickness;
    const double nearest = SCENE_LENGTH_MIN + (is_next ? 0.0 : thickness);
    const vec2 arms[2] = { vec2_sub(other->start, tip), vec2_sub(other->end, tip) };

    if (!polygon_holds(other->corners, CORNERS, tip, SCENE_LENGTH_MIN))
        return false;
    for (int k = 0; k < 2; k++) {
        if (vec2_length(arms[k]) > nearest && holds_cargo(p, arms[k]))
            return true;
    }
    return false;
}

/// True if cargo that slides along the piece ends in a corner.
static bool ends_in_corner(const measuring *m, const piece *p)
{
    const double slide = vec2_dot(p->along, p->belt);
    const vec2 tip = slide > 0.0 ? p->end : p->start;

    if (fabs(slide) <= RIGHT_ANGLE * vec2_length(p->belt))
        return false;
    for (size_t k = 0; k < m->n; k++) {
        if (&m->pieces[k] != p && meets_piece(m, p, tip, &m->pieces[k]))
            return true;
    }
    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        const vec2 arm = vec2_turn_left(surroundings_side(&m->around, side).inward);
        if (is_wall(m, side) && -surroundings_excess(&m->around, side, tip) <= m->closed_gap &&
            (holds_cargo(p, arm) || holds_cargo(p, vec2_scale(arm, -1.0))))
            return true;
    }
    return false;
}

static double angle_of(vec2 direction, vec2 belt)
{
    return atan2(fabs(vec2_cross(direction, belt)), fabs(vec2_dot(direction, belt))) * 180.0 / M_PI;
}

/// After measure_plates().
static void measure_bends(const measuring *m, layout *out)
{
    double n_bends = 0.0;

    for (size_t k = 1; k < m->n; k++) {
        const piece *p = &m->pieces[k], *before = p - 1;
        const bool is_next = before->obstacle == p->obstacle && before->index + 1 == p->index;
        if (before->obstacle != p->obstacle)
            n_bends = 0.0;
        if (is_next && (fabs(vec2_cross(p->along, before->along)) > SURROUNDINGS_GUIDE_SINE ||
                        vec2_dot(p->along, before->along) < 0.0))
            n_bends++;
        if (n_bends > out->bends.value)
            out->bends = (layout_figure){ n_bends, p->obstacle };
        if (out->n_plates > 0 && p->obstacle == out->least.index)
            out->least_bends = n_bends;
    }
}

/// True if plates leave nothing but gaps between two opposite walls that no part fits through.
static bool closes_but_for_gaps(measuring *m)
{
    bool closes = false;

    join_bodies(m, fmax(m->least_width, m->closed_gap), fmax(m->least_width, SCENE_LENGTH_MIN));
    for (size_t k = 0; k < m->n && !closes; k++)
        closes = m->pieces[k].deflects && closes_domain(m, body_of(m, k));
    return closes;
}

/// The way along a belt to the side where it leaves the domain, m; INFINITY: a wall is there.
static double way_out(const measuring *m, vec2 from, vec2 belt)
{
    const vec2 ahead = vec2_scale(belt, 1.0 / vec2_length(belt));
    double nearest = INFINITY;
    bool is_open = false;

    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        const double approach = -vec2_dot(ahead, surroundings_side(&m->around, side).inward);
        const double distance = fmax(-surroundings_excess(&m->around, side, from), 0.0);
        if (approach <= RIGHT_ANGLE || distance >= nearest * approach)
            continue;
        nearest = distance / approach;
        is_open = !is_wall(m, side);
    }
    return is_open ? nearest : INFINITY;
}

static bool is_same_velocity(vec2 a, vec2 b)
{
    return vec2_length(vec2_sub(a, b)) <= ROUNDING * vec2_length(b);
}

/// The way along a belt to where a straight one of another velocity begins, m; INFINITY: farther than LAYOUT_NEXT_BELT, or there is
/// none before an arc or the end of the belts or the domain.
static double way_to_next_belt(const measuring *m, vec2 tip, vec2 belt)
{
    const double step = m->radius / AHEAD_STEPS;
    const vec2 ahead = vec2_scale(belt, 1.0 / vec2_length(belt));
    const vec2 from = vec2_sub(tip, vec2_scale(ahead, SCENE_LENGTH_MIN));
    const vec2 own = belt_under(m, from);

    for (int k = 1; k <= 2 * LAYOUT_NEXT_BELT * AHEAD_STEPS; k++) {
        double low = (k - 1) * step, high = k * step;
        const vec2 at = vec2_add(from, vec2_scale(ahead, high));
        const size_t next = surroundings_belt_at(&m->around, at);
        if (!surroundings_is_inside(&m->s->domain, at) || next == m->around.n_belts ||
            m->around.belts[next].arc.is_given)
            return INFINITY;
        if (is_same_velocity(m->around.belts[next].velocity, own))
            continue;
        for (int i = 0; i < HALVINGS; i++) {
            const double middle = 0.5 * (low + high);
            if (is_same_velocity(belt_under(m, vec2_add(from, vec2_scale(ahead, middle))), own))
                low = middle;
            else
                high = middle;
        }
        return fmax(high - SCENE_LENGTH_MIN, 0.0);
    }
    return INFINITY;
}

/// How far the downstream end of piece k stands off the wall that its plate begins at, m; either end of one at right angles to the belt.
/// INFINITY: the plate begins at none, the end is at one, or a piece that deflects goes on from it.
static double off_its_wall(const measuring *m, size_t k)
{
    const piece *p = &m->pieces[k];
    const double slide = vec2_dot(p->along, p->belt), level = RIGHT_ANGLE * vec2_length(p->belt);
    const struct {
        vec2 at;
        bool is_downstream;
        size_t next; // beyond all pieces before the first one
    } ends[] = { { p->start, slide <= level, k - 1 }, { p->end, slide >= -level, k + 1 } };
    double least = INFINITY;

    for (int e = 0; e < 2; e++) {
        const piece *next = ends[e].next < m->n ? &m->pieces[ends[e].next] : NULL;
        const bool goes_on = next != NULL && next->obstacle == p->obstacle && next->deflects;
        double off = INFINITY;
        for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++)
            if (is_wall(m, side) && body_of(m, k) == body_of_side(m, side))
                off = fmin(off, -surroundings_excess(&m->around, side, ends[e].at));
        if (ends[e].is_downstream && !goes_on && off > m->closed_gap)
            least = fmin(least, off);
    }
    return least;
}

static void measure_plates(const measuring *m, layout *out)
{
    size_t last = SIZE_MAX, last_of_all = SIZE_MAX;

    for (size_t k = 0; k < m->n; k++) {
        const piece *p = &m->pieces[k];
        out->n_guides += p->obstacle != last_of_all;
        last_of_all = p->obstacle;
        if (!p->deflects)
            continue;
        out->n_plates += p->obstacle != last;
        last = p->obstacle;
        const bool closes = closes_domain(m, body_of(m, k));
        const double acute = angle_of(p->along, p->belt);
        const bool is_corner = !closes && ends_in_corner(m, p);
        const double angle = is_corner ? 180.0 - acute : acute;
        const vec2 tip = vec2_dot(p->along, p->belt) > 0.0 ? p->end : p->start;
        const double way = way_out(m, tip, p->belt);
        if (closes)
            out->opening = (layout_figure){ 0.0, p->obstacle };
        if (angle < out->least.value)
            out->least = (layout_figure){ angle, p->obstacle };
        if (angle > out->greatest.value)
            out->greatest = (layout_figure){ angle, p->obstacle };
        if (closes || is_corner)
            continue;
        if (way < out->run_out.value)
            out->run_out = (layout_figure){ way, p->obstacle };
        const double off = off_its_wall(m, k);
        if (off < out->short_end.value)
            out->short_end = (layout_figure){ off, p->obstacle };
        const double next = way_to_next_belt(m, tip, p->belt);
        if (next < out->next_belt.value)
            out->next_belt = (layout_figure){ next, p->obstacle };
    }
    out->n_guides -= out->n_plates;
}

static bool is_beside_wall(const measuring *m, const piece *p)
{
    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++)
        for (int k = 0; k < CORNERS && is_wall(m, side); k++)
            if (-surroundings_excess(&m->around, side, p->corners[k]) < m->least_width)
                return true;
    return false;
}

static void measure_free_ends(const measuring *m, layout *out)
{
    for (size_t k = 0; k < m->n; k++) {
        const piece *p = &m->pieces[k];
        bool is_free = p->deflects;
        for (size_t i = 0; i < m->n && is_free; i++)
            is_free = body_of(m, i) != body_of(m, k) || !is_beside_wall(m, &m->pieces[i]);
        const double angle = angle_of(p->along, p->belt);
        if (is_free && angle > out->free_ends.value)
            out->free_ends = (layout_figure){ angle, p->obstacle };
    }
}

static void measure_stagger(const measuring *m, layout *out)
{
    double nearest = INFINITY;
    vec2 on_p, on_q;

    for (size_t k = 0; k < m->n; k++) {
        const piece *p = &m->pieces[k];
        for (size_t i = 0; i < k; i++) {
            const piece *q = &m->pieces[i];
            if (!p->deflects || !q->deflects || body_of(m, k) == body_of(m, i) ||
                !may_be_within(p, q, nearest))
                continue;
            const double way =
                polygon_distance(p->corners, CORNERS, q->corners, CORNERS, &on_p, &on_q);
            const double along =
                fabs(vec2_dot(vec2_sub(on_q, on_p), p->belt)) / vec2_length(p->belt);
            if (way < nearest)
                out->stagger = (layout_figure){ along, p->obstacle };
            nearest = fmin(nearest, way);
        }
    }
}

static void measure_walls(const measuring *m, layout *out)
{
    const scene_rect *d = &m->s->domain;

    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        const surroundings_line line = surroundings_side(&m->around, side);
        const vec2 step = line.inward.x != 0.0
                              ? (vec2){ 0.0, (d->y_max - d->y_min) / WALL_SAMPLES }
                              : (vec2){ (d->x_max - d->x_min) / WALL_SAMPLES, 0.0 };
        for (int k = 0; is_wall(m, side) && k < WALL_SAMPLES; k++) {
            const vec2 belt = belt_under(m, vec2_add(line.at, vec2_scale(step, k + 0.5)));
            const double angle = angle_of(step, belt);
            if (vec2_dot(belt, line.inward) < -SURROUNDINGS_GUIDE_SINE * vec2_length(belt) &&
                angle > out->wall_angle.value)
                out->wall_angle = (layout_figure){ angle, side };
        }
    }
}

bf_status layout_measure(const scene *s, layout *ret_layout, bf_error *err)
{
    measuring m = { .s = s,
                    .radius = mix_radii_of(s).largest,
                    .least_width = layout_least_width(mix_inner_radii_of(s).smallest),
                    .around = surroundings_of(s),
                    .closed_gap = fmax(0.5 * scene_cell_edge(s), SCENE_LENGTH_MIN),
                    .opening = { INFINITY, 0 },
                    .gap = { INFINITY, 0 } };
    layout out = { .least = { INFINITY, 0 },
                   .greatest = { -INFINITY, 0 },
                   .stagger = { INFINITY, 0 },
                   .run_out = { INFINITY, 0 },
                   .next_belt = { INFINITY, 0 },
                   .short_end = { INFINITY, 0 } };

    for (size_t k = 0; k < s->n_obstacles; k++)
        out.n_pieces += s->obstacles[k].n_points - 1;
    for (size_t k = 0; k < s->n_sections; k++)
        m.steps_of_lookup += 1.0 + (double)s->belts[k].n_points;
    out.opening = out.gap = m.opening;
    out.is_measured = out.n_pieces <= LAYOUT_PIECES_MAX;
    if (!out.is_measured) {
        *ret_layout = out;
        return BF_OK;
    }
    m.pieces = memory_alloc(out.n_pieces, sizeof *m.pieces);
    m.groups = memory_alloc(out.n_pieces + SCENE_SIDE_COUNT, sizeof *m.groups);
    if (m.pieces != NULL && m.groups != NULL) {
        for (size_t k = 0; k < s->n_obstacles; k++)
            for (size_t i = 0; i + 1 < s->obstacles[k].n_points; i++)
                m.n += make_piece(&m, k, i, &m.pieces[m.n]);
        join_bodies(&m, m.closed_gap, SCENE_LENGTH_MIN);
        measure_openings(&m);
        out.opening = m.opening;
        out.gap = m.gap;
        measure_plates(&m, &out);
        measure_bends(&m, &out);
        measure_free_ends(&m, &out);
        measure_stagger(&m, &out);
        measure_walls(&m, &out);
        if (out.opening.value > 0.0 && isfinite(out.gap.value) &&
            (isinf(out.opening.value) || closes_but_for_gaps(&m)))
            out.opening = out.gap;
        out.is_measured = m.steps <= STEPS_MAX;
        *ret_layout = out;
    }
    const bool has_memory = m.pieces != NULL && m.groups != NULL;
    memory_free(m.pieces);
    memory_free(m.groups);
    return has_memory
               ? BF_OK
               : bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for %zu pieces", out.n_pieces);
}
