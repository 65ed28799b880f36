#include "core/world/belt_speeds.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "core/base/search.h"
#include "core/scene/belt_range.h"

#include <math.h>
#include <string.h>

// Of a ramp its beginning, where it comes to rest between two directions, and its end.
enum { RAMP_KNOTS = 3 };

// A knot at the start, and a ramp.
enum { COMMAND_KNOTS = 1 + RAMP_KNOTS };

// A commandable curve in a checkpoint.
typedef struct saved_curve {
    uint64_t n; // 0: never commanded
    belt_speeds_knot knots[COMMAND_KNOTS];
} saved_curve;

static void add_knot(belt_speeds_curve *c, double t, double factor)
{
    const belt_speeds_knot *last = c->n > 0 ? &c->knots[c->n - 1] : NULL;

    if (last == NULL || last->t != t || last->factor != factor)
        c->knots[c->n++] = (belt_speeds_knot){ t, factor };
}

// The ramp to a target of the same direction, or to rest, from t on, which ends at `until` at the latest. Returns when it ends
// if nothing else does.
static double add_way(double t, double target, double until, belt_speeds_curve *c)
{
    const double from = c->knots[c->n - 1].factor;
    const double rate = fabs(target) > fabs(from) ? c->acceleration : c->deceleration;
    const double end = t + fabs(target - from) * c->speed / rate;

    add_knot(c, t, from);
    if (!(end > t))
        add_knot(c, t, target);
    else if (end <= until)
        add_knot(c, end, target);
    else
        add_knot(c, until, from + (target - from) * ((until - t) / (end - t)));
    return end;
}

// The ramp to a target from t on, which ends at `until` at the latest: over rest, if that is the other direction.
static void add_ramp(double t, double target, double until, belt_speeds_curve *c)
{
    const bool reverses = c->knots[c->n - 1].factor * target < 0.0;
    const double begin = reverses ? add_way(t, 0.0, until, c) : t;

    if (begin < until)
        (void)add_way(begin, target, until, c);
}

// Go on to the next time at which the target may change, but to `until` at most.
static void go_on(const scene_belt *belt, double until, belt_speeds_origin *at)
{
    const scene_speed_schedule *s = &belt->speed_schedule;
    const double next = at->next < s->n_times ? s->times[at->next] : INFINITY;

    belt_stops_go_on(&belt->stops, at->target != 0.0, fmin(next, until), &at->stops);
    for (; at->next < s->n_times && s->times[at->next] <= at->stops.t; at->next++)
        at->target = s->factors[at->next];
}

// The knots, and what stops the belt, from the curve's origin on.
static void fill(const scene_belt *belt, belt_speeds_curve *c)
{
    const double end = c->belt != NULL ? belt->stops.until : INFINITY;
    belt_speeds_origin at = c->origin;

    c->n = c->n_stops = 0;
    add_knot(c, at.stops.t, at.factor);
    for (size_t k = 0; k < c->n_segments && at.stops.t <= end && at.stops.t < INFINITY; k++) {
        const double from = at.stops.t, told = at.target;
        const unsigned now = belt_stops_now(&belt->stops, &at.stops);
        if (c->belt != NULL) {
            belt_speeds_stop *last = c->n_stops > 0 ? &c->stops[c->n_stops - 1] : NULL;
            if (last != NULL && last->t == from)
                last->now = now;
            else if (last == NULL || last->now != now)
                c->stops[c->n_stops++] = (belt_speeds_stop){ from, now };
        }
        go_on(belt, INFINITY, &at);
        add_ramp(from, now == 0 ? told : 0.0, at.stops.t, c);
    }
}

static bf_status make_curve(const scene_belt *belt, belt_speeds_curve *c)
{
    const scene_speed_schedule *s = &belt->speed_schedule;
    const bool begins = s->n_times > 0 && s->times[0] == 0.0;
    const bool has_stops = belt_range_may_stop(belt);
    const double target = begins ? s->factors[0] : 1.0;
    const belt_stops_state start = belt_stops_start(&belt->stops);
    const bool is_stopped = belt_stops_now(&belt->stops, &start) != 0;

    *c = (belt_speeds_curve){
        .speed = vec2_length(belt->velocity),
        .acceleration = belt->acceleration,
        .deceleration = belt->deceleration,
        .is_commandable = belt->is_commanded,
        .first_section = belt->first_section,
        .n_more = belt->n_more,
        .belt = has_stops ? belt : NULL,
        .n_segments = 1 + s->n_times + (has_stops ? belt_stops_count(&belt->stops) : 0),
        .origin = { start, is_stopped ? 0.0 : target, target, begins ? 1 : 0 }
    };
    c->knots = memory_alloc(1 + RAMP_KNOTS * c->n_segments, sizeof *c->knots);
    c->stops = has_stops ? memory_alloc(c->n_segments, sizeof *c->stops) : NULL;
    if (c->knots == NULL || (has_stops && c->stops == NULL))
        return BF_ENOMEM;
    fill(belt, c);
    return BF_OK;
}

static void command(belt_speeds *speeds, size_t belt, double t, double factor)
{
    static const scene_belt plain = { .acceleration = INFINITY }; // without schedule and stops
    belt_speeds_curve *c = &speeds->curves[belt];
    const scene_belt *of = c->belt != NULL ? c->belt : &plain;
    belt_speeds_origin *at = &c->origin;

    BF_CHECK(c->is_commandable);
    c->was_commanded = true;
    at->factor = belt_speeds_at(speeds, belt, t);
    while (at->stops.t < t)
        go_on(of, t, at);
    at->target = factor;
    at->next = of->speed_schedule.n_times;
    fill(of, c);
}

void belt_speeds_command(belt_speeds *speeds, size_t belt, double t, double factor)
{
    const belt_speeds_curve *c = &speeds->curves[belt];

    command(speeds, belt, t, factor);
    for (size_t k = 0; k < c->n_more; k++)
        command(speeds, c->first_section + k, t, factor);
}

void belt_speeds_save(const belt_speeds *speeds, checkpoint_writer *w)
{
    for (size_t k = 0; k < speeds->n_belts; k++) {
        const belt_speeds_curve *c = &speeds->curves[k];
        saved_curve saved = { .n = c->was_commanded ? c->n : 0 };
        if (!c->is_commandable)
            continue;
        for (size_t i = 0; i < saved.n && c->belt == NULL; i++)
            saved.knots[i] = c->knots[i];
        checkpoint_write(w, &saved, sizeof saved);
        if (c->belt != NULL)
            checkpoint_write(w, &c->origin, sizeof c->origin);
    }
}

bool belt_speeds_load(belt_speeds *speeds, checkpoint_reader *r)
{
    saved_curve saved;

    for (size_t k = 0; k < speeds->n_belts; k++) {
        belt_speeds_curve *c = &speeds->curves[k];
        if (!c->is_commandable)
            continue;
        if (!checkpoint_read(r, &saved, sizeof saved) ||
            (c->belt == NULL && saved.n > COMMAND_KNOTS))
            return false;
        c->was_commanded = saved.n > 0;
        if (c->belt != NULL) {
            if (!checkpoint_read(r, &c->origin, sizeof c->origin) ||
                c->origin.next > c->belt->speed_schedule.n_times)
                return false;
            fill(c->belt, c); // what follows from the origin
            continue;
        }
        if (!c->was_commanded)
            continue;
        memcpy(c->knots, saved.knots, sizeof saved.knots);
        c->n = saved.n;
    }
    return true;
}

bf_status belt_speeds_init(belt_speeds *ret_speeds, size_t n_belts, const scene_belt *belts,
                           bf_error *err)
{
    belt_speeds speeds = { .curves = memory_alloc(n_belts, sizeof *speeds.curves),
                           .are_constant = belt_range_is_constant(n_belts, belts) };
    bf_status status = speeds.curves != NULL ? BF_OK : BF_ENOMEM;

    for (size_t k = 0; k < n_belts && status == BF_OK; k++) {
        status = make_curve(&belts[k], &speeds.curves[k]);
        speeds.n_belts++;
    }
    if (status != BF_OK) {
        belt_speeds_fini(&speeds);
        (void)bf_fail(err, status, "/belts", "no memory for the speeds of the belts");
    }
    *ret_speeds = speeds;
    return status;
}

void belt_speeds_fini(belt_speeds *speeds)
{
    for (size_t k = 0; k < speeds->n_belts; k++) {
        memory_free(speeds->curves[k].knots);
        memory_free(speeds->curves[k].stops);
    }
    memory_free(speeds->curves);
    *speeds = (belt_speeds){ .n_belts = 0 };
}

// The last knot at or before t, or the first.
static size_t find_knot(const belt_speeds_curve *c, double t)
{
    return search_last(&c->knots->t, sizeof *c->knots, c->n, t);
}

// f at t, which lies between knot k and the next one.
static double value_after(const belt_speeds_curve *c, size_t k, double t)
{
    const belt_speeds_knot *a = &c->knots[k], *b = &c->knots[k + 1];

    return k + 1 == c->n ? a->factor
                         : a->factor + (b->factor - a->factor) * ((t - a->t) / (b->t - a->t));
}

double belt_speeds_at(const belt_speeds *speeds, size_t belt, double t)
{
    if (belt >= speeds->n_belts)
        return 1.0;
    const belt_speeds_curve *c = &speeds->curves[belt];
    return value_after(c, find_knot(c, t), t);
}

bool belt_speeds_stands(const belt_speeds *speeds, size_t belt, double t, double *ret_until)
{
    const belt_speeds_curve *c = &speeds->curves[belt];
    const size_t k = find_knot(c, t);
    const bool is_last = k + 1 == c->n;

    *ret_until = is_last ? INFINITY : c->knots[k + 1].t;
    return c->knots[k].factor == 0.0 && (is_last || c->knots[k + 1].factor == 0.0);
}

unsigned belt_speeds_stopped_by(const belt_speeds *speeds, size_t belt, double t, double *ret_until)
{
    const belt_speeds_curve *c = &speeds->curves[belt];
    const size_t k =
        c->n_stops > 0 ? search_last(&c->stops->t, sizeof *c->stops, c->n_stops, t) : 0;

    *ret_until = k + 1 < c->n_stops ? c->stops[k + 1].t : INFINITY;
    return c->n_stops > 0 ? c->stops[k].now : 0;
}

double belt_speeds_mean(const belt_speeds *speeds, size_t belt, double from, double to)
{
    if (belt >= speeds->n_belts)
        return 1.0;
    const belt_speeds_curve *c = &speeds->curves[belt];
    size_t k = find_knot(c, from);
    double t = from, factor = value_after(c, k, from), sum = 0.0;

    if (k + 1 == c->n || c->knots[k + 1].t >= to)
        return 0.5 * (factor + value_after(c, k, to));
    for (; k + 1 < c->n && c->knots[k + 1].t < to; k++) {
        const belt_speeds_knot *next = &c->knots[k + 1];
        sum += 0.5 * (factor + next->factor) * (next->t - t);
        t = next->t;
        factor = next->factor;
    }
    return (sum + 0.5 * (factor + value_after(c, k, to)) * (to - t)) / (to - from);
}

void belt_speeds_in_step(const belt_speeds *speeds, uint64_t step, double dt, double *ret_factors)
{
    const double from = (double)step * dt, to = (double)(step + 1) * dt;

    for (size_t k = 0; k < speeds->n_belts; k++)
        ret_factors[k] = belt_speeds_mean(speeds, k, from, to);
    ret_factors[speeds->n_belts] = 1.0;
}
