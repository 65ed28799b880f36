#include "core/scene/plate_range.h"

#include "core/base/polygon.h"
#include "core/scene/scene.h"

#include <math.h>

// Calls a function for each shift that an obstacle is told.
static void visit_shifts(const scene_obstacle *obstacles, size_t k, size_t n_actions,
                         const scene_action *actions, void (*visit)(plate_range *r, vec2 shift),
                         plate_range *r)
{
    for (size_t m = 0; m < obstacles[k].n_shifts; m++)
        visit(r, obstacles[k].shifts[m]);
    for (size_t m = 0; m < n_actions; m++)
        if (actions[m].type == SCENE_ACTION_SHIFT && actions[m].target == k)
            visit(r, actions[m].shift);
}

static void include_angle(plate_range *r, double angle)
{
    r->least = fmin(r->least, angle);
    r->most = fmax(r->most, angle);
}

static void include_shift(plate_range *r, vec2 shift)
{
    r->low = (vec2){ fmin(r->low.x, shift.x), fmin(r->low.y, shift.y) };
    r->high = (vec2){ fmax(r->high.x, shift.x), fmax(r->high.y, shift.y) };
}

static void take_farther(plate_range *r, vec2 shift)
{
    if (vec2_length(vec2_sub(shift, r->ends[0])) > vec2_length(vec2_sub(r->ends[1], r->ends[0])))
        r->ends[1] = shift;
}

static void compare_with_line(plate_range *r, vec2 shift)
{
    r->is_line =
        r->is_line && polygon_segment_distance(shift, r->ends[0], r->ends[1]) <= SCENE_TOLERANCE;
}

plate_range plate_range_of(const scene_obstacle *obstacles, size_t k, size_t n_actions,
                           const scene_action *actions)
{
    const scene_obstacle *o = &obstacles[k];
    const double angle = o->turn.n_values > 0 ? o->turn.values[0] : 0.0;
    const vec2 shift = o->n_shifts > 0 ? o->shifts[0] : (vec2){ 0.0, 0.0 };
    plate_range r = { .moves = o->turn.n_times > 0,
                      .is_shifted = o->n_shifts > 0,
                      .least = angle,
                      .most = angle,
                      .low = shift,
                      .high = shift,
                      .ends = { shift, shift },
                      .is_line = true };

    for (size_t m = 0; m < o->turn.n_values; m++)
        include_angle(&r, o->turn.values[m]);
    for (size_t m = 0; m < n_actions; m++) {
        if (actions[m].target != k)
            continue;
        if (actions[m].type == SCENE_ACTION_TURN)
            include_angle(&r, actions[m].value);
        r.is_shifted = r.is_shifted || actions[m].type == SCENE_ACTION_SHIFT;
        r.moves = r.moves || r.is_shifted || actions[m].type == SCENE_ACTION_TURN;
    }
    visit_shifts(obstacles, k, n_actions, actions, include_shift, &r);
    // The one farthest from the first, and the one farthest from that: the ends of a line.
    visit_shifts(obstacles, k, n_actions, actions, take_farther, &r);
    r.ends[0] = r.ends[1];
    take_farther(&r, shift);
    visit_shifts(obstacles, k, n_actions, actions, take_farther, &r);
    compare_with_line(&r, shift);
    visit_shifts(obstacles, k, n_actions, actions, compare_with_line, &r);
    return r;
}

double plate_range_radius(const scene_obstacle *obstacle)
{
    double radius = 0.0;

    for (size_t k = 0; k < obstacle->n_points; k++)
        radius = fmax(radius, vec2_length(vec2_sub(obstacle->path[k], obstacle->pivot)));
    return radius + obstacle->thickness;
}

double plate_range_distance(const plate_range *range, vec2 pivot, vec2 at)
{
    const vec2 to = vec2_sub(at, pivot);

    return vec2_length((vec2){ to.x - fmin(fmax(to.x, range->low.x), range->high.x),
                               to.y - fmin(fmax(to.y, range->low.y), range->high.y) });
}

// How far it is from one time of a schedule to another, rad or m.
typedef double way_fn(const scene_obstacle *o, size_t from, size_t to);

static double turned(const scene_obstacle *o, size_t from, size_t to)
{
    return fabs(o->turn.values[to] - o->turn.values[from]);
}

static double shifted(const scene_obstacle *o, size_t from, size_t to)
{
    return vec2_length(vec2_sub(o->shifts[to], o->shifts[from]));
}

// The fastest by a schedule of n values, rad/s or m/s; 0 of one that is not sound.
static double fastest_scheduled(const scene_obstacle *o, size_t n, way_fn *way)
{
    const double *times = o->turn.times;
    double largest = 0.0;

    if (n != o->turn.n_times)
        return 0.0;
    for (size_t k = 1; k < n; k++)
        largest = fmax(largest, way(o, k - 1, k) / (times[k] - times[k - 1]));
    if (n > 1 && o->turn.repeat < INFINITY && way(o, n - 1, 0) > 0.0)
        largest = fmax(largest, way(o, n - 1, 0) / (times[0] + o->turn.repeat - times[n - 1]));
    return largest;
}

plate_range_speed plate_range_fastest(const scene_obstacle *obstacles, size_t k, size_t n_actions,
                                      const scene_action *actions)
{
    const scene_obstacle *o = &obstacles[k];
    const plate_range r = plate_range_of(obstacles, k, n_actions, actions);
    double spin = fastest_scheduled(o, o->turn.n_values, turned);
    double shifting = fastest_scheduled(o, o->n_shifts, shifted);

    for (size_t m = 0; m < n_actions; m++) {
        const scene_action *a = &actions[m];
        if (a->target != k)
            continue;
        if (a->type == SCENE_ACTION_TURN)
            spin = fmax(spin, fmax(r.most - a->value, a->value - r.least) / a->over);
        if (a->type == SCENE_ACTION_SHIFT) {
            const vec2 farthest = { fmax(r.high.x - a->shift.x, a->shift.x - r.low.x),
                                    fmax(r.high.y - a->shift.y, a->shift.y - r.low.y) };
            shifting = fmax(shifting, vec2_length(farthest) / a->over);
        }
    }
    return (plate_range_speed){ spin > 0.0 ? spin * plate_range_radius(o) : 0.0, shifting };
}

double plate_range_largest_speed(const scene_obstacle *obstacles, size_t k, size_t n_actions,
                                 const scene_action *actions)
{
    const plate_range_speed speed = plate_range_fastest(obstacles, k, n_actions, actions);

    return speed.turning + speed.shifting;
}
