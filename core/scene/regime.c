#include "core/scene/regime.h"

#include "core/scene/belt_range.h"

#include <math.h>

// Multiples of the longest period that are tried for a common one.
enum { MULTIPLES = 64 };

static bool are_drawn(const double *values, size_t n)
{
    if (values == NULL)
        return true;
    for (size_t k = 0; k < n; k++)
        if (isnan(values[k]))
            return true;
    return false;
}

static bool draws_kinds(const scene_feed *f)
{
    return f->n_cargo > 1 && (f->demand != SCENE_DEMAND_SCHEDULE || f->schedule.kinds == NULL);
}

static bool has_draws(const scene_feed *f)
{
    const bool is_list = f->demand == SCENE_DEMAND_SCHEDULE;
    const scene_arrival_list *list = &f->schedule;
    const bool has_places = f->line[0].x != f->line[1].x || f->line[0].y != f->line[1].y;

    if (!is_list && (f->arrivals == SCENE_ARRIVALS_POISSON || f->arrivals == SCENE_ARRIVALS_ERLANG))
        return true;
    return (has_places && (!is_list || are_drawn(list->places, list->n))) ||
           (f->has_random_heading && (!is_list || are_drawn(list->headings, list->n))) ||
           draws_kinds(f);
}

uint32_t scene_gap_shape(const scene *s)
{
    uint32_t shape = UINT32_MAX;

    if (scene_acts_by_kind(s))
        return 0;
    for (size_t k = 0; k < s->n_feeds; k++) {
        const scene_feed *f = &s->feeds[k];
        if (f->arrivals == SCENE_ARRIVALS_ERLANG)
            shape = f->shape < shape ? f->shape : shape;
        else if (f->arrivals != SCENE_ARRIVALS_REGULAR)
            return 1;
    }
    if (shape != UINT32_MAX)
        return shape;
    return s->n_feeds > 0 ? 0 : 1;
}

bool scene_has_chance(const scene *s, bool is_density)
{
    const bool draws_gaps = is_density && scene_gap_shape(s) > 0;
    const bool tells_kinds = is_density && scene_tells_kinds(s);

    for (size_t k = 0; k < s->n_belts; k++)
        if (belt_range_stops_by_chance(&s->belts[k]))
            return true;
    // An eye may command something that draws the gaps between a density's parts, or their kinds.
    for (size_t k = 0; k < s->n_actions && is_density; k++)
        if (s->actions[k].kind != SCENE_KIND_ANY ||
            (draws_gaps && s->eyes[s->actions[k].eye].density_ratio == 0.0))
            return true;
    if (s->n_merges > 0 && draws_gaps)
        return true;
    for (size_t k = 0; k < s->n_feeds; k++)
        if (is_density ? tells_kinds && draws_kinds(&s->feeds[k]) : has_draws(&s->feeds[k]))
            return true;
    return false;
}

// Take a function of time into account whose times count from t0.
static void add_series(scene_regime *r, const scene *s, double t0, size_t n, const double *times,
                       double repeat)
{
    if (n == 0)
        return;
    if (isfinite(repeat)) {
        double common = fmax(r->cycle, repeat), other = fmin(r->cycle, repeat);
        const double longest = common;
        for (int k = 1; other > 0.0 && k <= MULTIPLES; k++) {
            const double ratio = k * longest / other;
            if (fabs(ratio - nearbyint(ratio)) < 1e-9 * ratio) {
                common = k * longest;
                other = 0.0;
            }
        }
        r->is_constant = r->is_constant && (other == 0.0);
        r->cycle = common;
        return;
    }
    // Before its first time and after its last one it is constant.
    for (size_t k = 0; k < n; k++)
        if (t0 + times[k] > s->warmup && t0 + times[k] < s->duration)
            r->is_constant = false;
}

// Drawn failures are chance; those of a list, and breaks that do not repeat from the start on, change it once and for all.
static void add_stops(scene_regime *r, const scene *s, const scene_stops *stops)
{
    for (size_t i = 0; i < stops->n_failures; i++)
        for (size_t k = 0; k < stops->failures[i].n_times; k++) {
            const double t = stops->failures[i].times[k];
            const double borders[] = { t, t + stops->failures[i].durations[k] };
            add_series(r, s, 0.0, 2, borders, (double)INFINITY);
        }
    for (size_t k = 0; k < stops->n_breaks; k++) {
        const scene_break *b = &stops->breaks[k];
        const double borders[] = { b->start, b->start + b->duration };
        add_series(r, s, 0.0, 2, borders, b->start < b->every ? b->every : (double)INFINITY);
    }
}

scene_regime scene_regime_of(const scene *s, bool is_density)
{
    scene_regime r = { .has_chance = scene_has_chance(s, is_density),
                       .is_constant = s->n_feeds > 0 };

    for (size_t k = 0; k < s->n_belts; k++) {
        const scene_belt *belt = &s->belts[k];
        add_series(&r, s, 0.0, belt->speed_schedule.n_times, belt->speed_schedule.times,
                   (double)INFINITY);
        add_stops(&r, s, &belt->stops);
    }
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_series *turn = &s->obstacles[k].turn, *presence = &s->obstacles[k].presence;
        add_series(&r, s, 0.0, turn->n_times, turn->times, turn->repeat);
        add_series(&r, s, 0.0, presence->n_times, presence->times, presence->repeat);
    }
    for (size_t k = 0; k < s->n_feeds; k++) {
        const scene_feed *f = &s->feeds[k];
        if (f->start > s->warmup || f->end < s->duration || isfinite(f->count) ||
            f->demand == SCENE_DEMAND_SCHEDULE)
            r.is_constant = false;
        if (f->demand == SCENE_DEMAND_PROFILE)
            add_series(&r, s, f->start, f->profile.n_times, f->profile.times, f->profile.repeat);
        if (f->demand == SCENE_DEMAND_RATE && f->arrivals == SCENE_ARRIVALS_BATCH) {
            const double period = (double)f->batch_size / f->rate;
            add_series(&r, s, f->start, 1, &f->start, period);
        }
    }
    return r;
}
