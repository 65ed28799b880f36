#include "core/scene/plate_schedule.h"

#include "core/base/search.h"

#include <math.h>

// The time within a round.
static double time_in_round(const scene_series *s, double t)
{
    return s->repeat < INFINITY ? fmod(t, s->repeat) : t;
}

// How many times of a series are at or before t.
static size_t count_times(const scene_series *s, double t)
{
    return search_count(s->times, sizeof *s->times, s->n_times, t, true);
}

// Two times of a series, and the part of the way from the first to the second at which a time lies.
typedef struct span {
    size_t before;
    size_t after;
    double part;
} span;

// n_times > 0.
static span find_span(const scene_series *s, double t)
{
    const double in_round = time_in_round(s, t);
    const size_t n = s->n_times, k = count_times(s, in_round);

    if (k == 0 && t < s->repeat)
        return (span){ 0, 0, 0.0 };
    if (k == n && s->repeat == INFINITY)
        return (span){ n - 1, n - 1, 0.0 };
    const double from = k > 0 ? s->times[k - 1] : s->times[n - 1] - s->repeat;
    const double to = k < n ? s->times[k] : s->times[0] + s->repeat;
    return (span){ k > 0 ? k - 1 : n - 1, k < n ? k : 0, (in_round - from) / (to - from) };
}

plate_displacement plate_schedule_displacement(const scene_obstacle *o, double t)
{
    plate_displacement displacement = { .angle = 0.0 };

    if (o->turn.n_times == 0)
        return displacement;
    const span at = find_span(&o->turn, t);
    const double before = o->turn.values[at.before], after = o->turn.values[at.after];
    displacement.angle = before + (after - before) * at.part;
    if (o->n_shifts > 0)
        displacement.shift = vec2_between(o->shifts[at.before], o->shifts[at.after], at.part);
    return displacement;
}

bool plate_schedule_is_present(const scene_obstacle *o, double t, double *ret_came)
{
    const scene_series *s = &o->presence;
    const double in_round = time_in_round(s, t);
    double round = s->repeat < INFINITY ? rint((t - in_round) / s->repeat) : 0.0;
    size_t k = count_times(s, in_round);

    *ret_came = -INFINITY;
    // Back in time to where it was not there.
    for (size_t n_seen = 0; s->n_times > 0; k--, n_seen++) {
        if (k == 0 && round <= 0.0) {
            *ret_came = -INFINITY;
            return true;
        }
        if (k == 0) {
            k = s->n_times;
            round -= 1.0;
        }
        if (s->values[k - 1] == 0.0)
            return n_seen > 0;
        *ret_came = (round > 0.0 ? round * s->repeat : 0.0) + s->times[k - 1];
        if (n_seen > s->n_times || t - *ret_came > PLATE_SCHEDULE_COMING)
            return true;
    }
    return true;
}
