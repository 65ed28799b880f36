#include "core/run/schedule.h"

#include <math.h>

uint64_t schedule_steps_until(double t, double dt)
{
    double steps = t / dt;
    double nearest = nearbyint(steps);
    bool is_whole = fabs(steps - nearest) <= 1e-9 + 1e-12 * steps;

    return (uint64_t)(is_whole ? nearest : ceil(steps));
}

// The due times first + k every, k = 0, 1, ..., with from <= t < to; s.
typedef struct span {
    double first;
    double every;
    double from;
    double to;
} span;

static uint64_t due(const span *s, double k, double dt)
{
    return schedule_steps_until(s->first + k * s->every, dt);
}

// The first step after `step` at which something of a span is due; UINT64_MAX: none is.
static uint64_t next_of(const span *s, uint64_t step, double dt)
{
    if (s->to <= (double)step * dt)
        return UINT64_MAX;
    const double from = fmax(s->from, (double)step * dt);
    const double slack = 1e-9 * s->every; // for rounding
    double k = fmax(floor((from - s->first) / s->every) - 1.0, 0.0);
    while (s->first + k * s->every < s->from - slack || due(s, k, dt) <= step)
        k++;
    return s->first + k * s->every < s->to - slack ? due(s, k, dt) : UINT64_MAX;
}

uint64_t schedule_next(const scene_output *output, schedule_of of, uint64_t step, double dt)
{
    const bool is_curve = of == SCHEDULE_CURVE;
    span between = { .every = is_curve ? output->curve_every : output->snapshot_every };
    uint64_t next = UINT64_MAX;

    for (size_t k = 0; k < output->n_windows && next == UINT64_MAX; k++) {
        const scene_output_window *w = &output->windows[k];
        const span within = { w->from, is_curve ? w->curve_every : w->snapshot_every, w->from,
                              w->to };
        between.to = w->from;
        next = next_of(&between, step, dt);
        if (next == UINT64_MAX)
            next = next_of(&within, step, dt);
        between.from = w->to;
    }
    between.to = INFINITY;
    return next == UINT64_MAX ? next_of(&between, step, dt) : next;
}
