#include "core/world/belt_stops.h"

#include "core/base/digest.h"
#include "core/base/draws.h"

#include <math.h>
#include <string.h>

_Static_assert(sizeof(belt_stops_failure) == 3 * sizeof(double), "no padding");

// Time n of a kind of failure, s.
static double draw(const scene_stops *stops, const scene_failure *f, uint64_t n,
                   draws_purpose purpose)
{
    const scene_drawn_time *time = purpose == DRAWS_REPAIR ? &f->repair : &f->between;
    const draws from = { 0, stops->substream, digest_add(DIGEST_START, f->id, strlen(f->id)) };

    if (time->law == SCENE_TIME_FIXED)
        return time->mean;
    return time->mean *
           draws_weibull(&from, n, purpose, time->law == SCENE_TIME_WEIBULL ? time->shape : 1.0);
}

// When border n of an entry of the breaks is: the begin of a break, or its end if n is odd.
static double border_of(const scene_break *b, uint64_t n)
{
    const double begin = n < 2 ? b->start : b->start + (double)(n / 2) * b->every;

    return n % 2 == 0 ? begin : begin + b->duration;
}

static bool is_down(const belt_stops_failure *f)
{
    return f->until < INFINITY;
}

unsigned belt_stops_now(const scene_stops *stops, const belt_stops_state *state)
{
    unsigned now = 0;

    for (size_t k = 0; k < stops->n_failures; k++)
        now |= is_down(&state->failures[k]) ? 1U << k : 0U;
    for (size_t k = 0; k < stops->n_breaks; k++)
        now |= state->n_borders[k] % 2 == 1 ? BELT_STOPS_BREAK : 0U;
    return now;
}

belt_stops_cause belt_stops_cause_of(unsigned now)
{
    if (now == 0)
        return BELT_STOPS_BY_NOTHING;
    return (now & BELT_STOPS_FAILED) != 0 ? BELT_STOPS_BY_FAILURE : BELT_STOPS_BY_BREAK;
}

// When a listed failure that is not down begins next.
static double next_listed(const scene_failure *f, const belt_stops_failure *state)
{
    return state->n < f->n_times ? f->times[state->n] : INFINITY;
}

static void begin(const scene_stops *stops, size_t k, belt_stops_state *state)
{
    const scene_failure *f = &stops->failures[k];
    belt_stops_failure *of = &state->failures[k];

    if (f->type == SCENE_FAILURE_LISTED) {
        of->until = f->times[of->n] + f->durations[of->n];
        of->n++;
        return;
    }
    of->until = state->t + draw(stops, f, of->n, DRAWS_REPAIR);
    of->n++;
    of->left = draw(stops, f, of->n, DRAWS_BETWEEN);
}

// All that begins or ends at the state's time: repairs and breaks first.
static void pass(const scene_stops *stops, bool runs, belt_stops_state *state)
{
    for (size_t k = 0; k < stops->n_failures; k++)
        if (state->failures[k].until <= state->t)
            state->failures[k].until = INFINITY;
    for (size_t k = 0; k < stops->n_breaks; k++)
        while (border_of(&stops->breaks[k], state->n_borders[k]) <= state->t)
            state->n_borders[k]++;
    for (size_t k = 0; k < stops->n_failures; k++)
        if (stops->failures[k].type == SCENE_FAILURE_LISTED && !is_down(&state->failures[k]) &&
            next_listed(&stops->failures[k], &state->failures[k]) <= state->t)
            begin(stops, k, state);
    for (size_t k = 0; k < stops->n_failures && runs && belt_stops_now(stops, state) == 0; k++)
        if (stops->failures[k].type == SCENE_FAILURE_DRAWN && state->failures[k].left <= 0.0)
            begin(stops, k, state);
}

belt_stops_state belt_stops_start(const scene_stops *stops)
{
    belt_stops_state state = { .t = 0.0 };

    for (size_t k = 0; k < stops->n_failures; k++) {
        const scene_failure *f = &stops->failures[k];
        state.failures[k].until = INFINITY;
        state.failures[k].left =
            f->type == SCENE_FAILURE_DRAWN ? draw(stops, f, 0, DRAWS_BETWEEN) : 0.0;
    }
    pass(stops, false, &state);
    return state;
}

void belt_stops_go_on(const scene_stops *stops, bool runs, double until, belt_stops_state *state)
{
    const bool operates = runs && belt_stops_now(stops, state) == 0;
    double next = until;
    size_t fails = SCENE_FAILURES_MAX;

    for (size_t k = 0; k < stops->n_breaks; k++)
        next = fmin(next, border_of(&stops->breaks[k], state->n_borders[k]));
    for (size_t k = 0; k < stops->n_failures; k++) {
        const scene_failure *f = &stops->failures[k];
        const belt_stops_failure *of = &state->failures[k];
        if (is_down(of))
            next = fmin(next, of->until);
        else if (f->type == SCENE_FAILURE_LISTED)
            next = fmin(next, next_listed(f, of));
        else if (operates && state->t + of->left < next) {
            next = state->t + of->left;
            fails = k;
        }
    }
    // Of the one that fails exactly nothing is left, however the sum of times was rounded.
    for (size_t k = 0; k < stops->n_failures && operates; k++)
        state->failures[k].left = k == fails && next == state->t + state->failures[k].left
                                      ? 0.0
                                      : fmax(state->failures[k].left - (next - state->t), 0.0);
    state->t = next;
    if (next < INFINITY) // else nothing is left that begins or ends
        pass(stops, runs, state);
}

// Failures of a kind that begin until stops->until if the belt always runs.
static size_t count_failures(const scene_stops *stops, const scene_failure *f)
{
    size_t n = 0;

    if (f->type == SCENE_FAILURE_LISTED)
        return f->n_times;
    for (double t = draw(stops, f, 0, DRAWS_BETWEEN); t <= stops->until; n++)
        t += draw(stops, f, n, DRAWS_REPAIR) + draw(stops, f, n + 1, DRAWS_BETWEEN);
    return n + 1; // rounding may let one more begin
}

size_t belt_stops_count(const scene_stops *stops)
{
    size_t n = 0;

    for (size_t k = 0; k < stops->n_failures; k++)
        n += count_failures(stops, &stops->failures[k]);
    for (size_t k = 0; k < stops->n_breaks; k++) {
        const scene_break *b = &stops->breaks[k];
        n += 1 + (size_t)(fmax(stops->until - b->start, 0.0) / b->every);
    }
    return 2 * n + 1; // and the first one past the end
}
