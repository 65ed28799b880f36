#include "core/observe/figures_priv.h"

#include "core/base/memory.h"
#include "core/scene/belt_range.h"
#include "core/scene/counter.h"

#include <math.h>

// Of divisible parts, what rounding may take from a whole one.
static const double whole_part = 1.0 - 1e-6;

// What counts as nothing inside: the density thins out without end.
static const double empty_domain = 0.5;

static bf_status init_items(figures *f, bf_error *err)
{
    bf_status status = quantiles_init(&f->residence, err);

    if (status == BF_OK && f->has_exits)
        status = quantiles_init(&f->ages, err);
    if (status == BF_OK && f->has_exits)
        status = quantiles_init(&f->ages_first, err);
    for (size_t k = 0; status == BF_OK && k < f->s->n_feeds; k++)
        status = quantiles_init(&f->waits[k], err);
    for (size_t k = 0; status == BF_OK && f->has_parts && k < f->s->n_eyes; k++)
        status = quantiles_init(&f->gaps[k], err);
    if (status == BF_OK && !f->has_exits)
        status = fifo_init(&f->inside, err);
    for (size_t k = 0; status == BF_OK && !f->has_parts && k < f->s->n_feeds; k++)
        status = fifo_init(&f->queues[k], err);
    if (status == BF_OK && f->s->n_feeds == 0)
        status = thinned_init(&f->outflow, err);
    if (status == BF_OK && f->n_flows > 0 &&
        (f->flows = memory_alloc(f->n_flows, sizeof *f->flows)) == NULL)
        status = bf_fail(err, BF_ENOMEM, "", "no memory for key figures");
    return status;
}

// The warm-up is over.
static void begin(figures *f, const figures_now *now)
{
    f->run.is_warm = 1;
    f->run.t_start = now->t;
    f->run.exited_start = now->exited;
    f->run.jam.since = now->t;
    f->run.jam.since_exited = now->exited;
    if (f->has_exits && f->ages.bins != NULL)
        quantiles_copy(&f->ages_first, &f->ages);
    const scene_regime regime = scene_regime_of(f->s, !f->has_parts);
    f->run.batches =
        steady_from(&regime, f->s->steady_precision,
                    &(steady_levels){ now->t, now->entered - now->fallen, now->exited });
}

bf_status figures_create(const scene *s, bool has_parts, figures **ret_figures, bf_error *err)
{
    figures *f = memory_alloc(1, sizeof *f);

    if (f == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for key figures");
    f->s = s;
    f->has_parts = has_parts;
    f->has_exits = s->n_feeds > 0;
    f->run.drained_at = f->run.jam.first = f->run.stall.first = f->run.peak = (double)NAN;
    for (size_t k = 0; k < s->n_eyes; k++)
        f->eyes[k].last_end = (double)NAN;
    f->n_belts = figure_items(s, FIGURE_OF_BELT);
    for (size_t k = 0; k < s->n_belts; k++)
        f->n_stops = belt_range_may_stop(&s->belts[k]) ? f->n_belts : f->n_stops;
    f->n_failures = figure_items(s, FIGURE_OF_FAILURE);
    f->n_through = f->has_exits ? s->n_counters + figure_items(s, FIGURE_OF_OUTLET) : 0;
    f->n_flows = f->n_through + s->n_sinks;
    f->queue = queue_of(s);
    if (s->warmup <= 0.0)
        begin(f, &(figures_now){ .t = 0.0 });
    const bf_status status = init_items(f, err);
    if (status == BF_OK)
        *ret_figures = f;
    else
        figures_destroy(f);
    return status;
}

figures *figures_destroy(figures *f)
{
    if (f == NULL)
        return NULL;
    quantiles_fini(&f->residence);
    quantiles_fini(&f->ages);
    quantiles_fini(&f->ages_first);
    fifo_fini(&f->inside);
    thinned_fini(&f->outflow);
    memory_free(f->flows);
    for (size_t k = 0; k < SCENE_FEEDS_MAX; k++) {
        quantiles_fini(&f->waits[k]);
        fifo_fini(&f->queues[k]);
    }
    for (size_t k = 0; k < SCENE_EYES_MAX; k++)
        quantiles_fini(&f->gaps[k]);
    memory_free(f);
    return NULL;
}

// Ages are those of one sample.
static void forget_ages(figures *f)
{
    if (f->has_exits && f->are_ages_old)
        quantiles_clear(&f->ages);
    f->are_ages_old = false;
}

void figures_forget_ages(figures *f)
{
    f->are_ages_old = true;
    forget_ages(f);
}

void figures_add_age(figures *f, double age, double parts)
{
    if (f->has_exits)
        quantiles_add(&f->ages, age, parts);
}

bool figures_ends_warmup(const figures *f, double t)
{
    return !f->run.is_warm && t >= f->s->warmup;
}

void figures_add_cargo(figures *f, const figures_cargo *cargo, const double *fractions)
{
    const queue_state state = queue_state_of(cargo->speed, cargo->belt_speed);

    forget_ages(f);
    if (!isnan(cargo->age))
        figures_add_age(f, cargo->age, cargo->parts);
    f->run.has_cargo = 1;
    for (size_t k = 0; k < f->s->n_counters; k++) {
        const scene_counter *c = &f->s->counters[k];
        if (!counter_holds(c, cargo->at))
            continue;
        f->counters[k].states[state] += c->kind == SCENE_KIND_ANY || fractions == NULL
                                            ? cargo->parts
                                            : cargo->parts * fractions[c->kind];
    }
    if (state != QUEUE_FREE)
        queue_add(&f->queue, cargo->at, cargo->parts);
}

// The mean height of a trapezoid times its width.
static double area(double dt, double from, double to)
{
    return dt * (0.5 * (from + to));
}

// What an outlet lets through, or a sink takes, it does not hold: as much enters as leaves.
static void sample_flow(figures *f, size_t k, bool was_warm, const figures_now *now)
{
    flow_sums *flow = &f->flows[k];
    const bool is_sink = k >= f->n_through;
    const double left = is_sink ? now->taken[k - f->n_through] : now->flows[k];
    const double held = !is_sink && k < f->s->n_counters ? now->counters[k] : 0.0;
    const steady_levels levels = { now->t, left + held, left };

    flow->left = left;
    if (was_warm && flow->batches.length > 0.0) {
        steady_sample(&flow->batches, &levels);
    } else if (f->run.is_warm) {
        const scene_regime regime = scene_regime_of(f->s, !f->has_parts);
        flow->left_start = left;
        flow->batches = steady_from(&regime, f->s->steady_precision, &levels);
    }
}

static void sample_feed(figures *f, size_t k, bool was_warm, double t, const feed_balance *b)
{
    feed_sums *sums = &f->feeds[k];

    if (f->run.is_warm)
        sums->waiting_max = fmax(sums->waiting_max, b->waiting);
    if (!f->has_parts) {
        // Those that are dropped have waited longest.
        const double dropped = b->discarded - sums->balance.discarded;
        if (dropped > 0.0)
            fifo_sample(&f->queues[k], t, b->offered, f->queues[k].out.level + dropped, NULL);
        fifo_sample(&f->queues[k], t, b->offered, b->admitted + b->discarded,
                    was_warm ? &f->waits[k] : NULL);
    }
    sums->balance = *b;
}

// held: what could have left and was kept from it.
static void sample_jam(jam_sums *jam, double jam_time, double held, const figures_now *now)
{
    if (now->exited - jam->since_exited >= whole_part || held < whole_part) {
        jam->total += jam->is_jam ? now->t - jam->since : 0.0;
        jam->is_jam = 0;
        jam->since = now->t;
        jam->since_exited = now->exited;
    } else if (!jam->is_jam && now->t - jam->since >= jam_time) {
        jam->first = jam->count == 0.0 ? jam->since : jam->first;
        jam->count += 1.0;
        jam->is_jam = 1;
    }
}

static bool is_drained(const figures *f, const figures_now *now)
{
    double waiting = 0.0;

    if (now->entered < empty_domain) // a feed that begins later
        return false;
    for (size_t k = 0; k < f->s->n_feeds; k++)
        waiting += now->feeds[k].waiting;
    return now->inside < empty_domain && waiting < empty_domain;
}

void figures_sample(figures *f, const figures_now *now)
{
    const bool was_warm = f->run.is_warm;

    forget_ages(f);
    f->are_ages_old = true;
    if (figures_ends_warmup(f, now->t))
        begin(f, now);
    for (size_t k = 0; k < f->s->n_counters; k++) {
        counter_sums *c = &f->counters[k];
        const double dt = now->t - f->run.t;
        const double content = now->counters[k];
        for (int state = 0; state < QUEUE_STATES; state++) {
            c->states_integral[state] +=
                was_warm ? area(dt, c->states_before[state], c->states[state]) : 0.0;
            c->states_before[state] = c->states[state];
            c->states[state] = 0.0;
        }
        c->content_integral += was_warm ? area(dt, c->content, content) : 0.0;
        c->content_max = f->run.is_warm ? fmax(c->content_max, content) : 0.0;
        c->content = content;
    }
    for (size_t k = 0; k < f->n_flows; k++)
        sample_flow(f, k, was_warm, now);
    for (size_t k = 0; k < f->s->n_feeds; k++)
        sample_feed(f, k, was_warm, now->t, &now->feeds[k]);
    if (!f->has_exits) {
        // What falls goes without a time in the domain, as if it were what had been there for longest.
        const double gone = now->exited + now->fallen;
        const double fallen = fmin(now->fallen - f->run.fallen, gone - f->inside.out.level);
        if (fallen > 0.0)
            fifo_sample(&f->inside, now->t, now->entered, f->inside.out.level + fallen, NULL);
        fifo_sample(&f->inside, now->t, now->entered, gone, was_warm ? &f->residence : NULL);
        f->run.fallen = now->fallen;
    }
    if (f->run.is_warm)
        f->run.queue_end = fmax(f->run.queue_end, queue_length(&f->queue));
    if (f->run.is_warm && f->s->n_feeds == 0)
        thinned_add(&f->outflow, now->t, now->counters[0] + now->fallen_in_first);
    if (was_warm) {
        sample_jam(&f->run.jam, f->s->jam_time, f->run.has_cargo ? f->queue.parts : now->inside,
                   now);
        steady_sample(&f->run.batches,
                      &(steady_levels){ now->t, now->entered - now->fallen, now->exited });
    }
    queue_clear(&f->queue);
    if (!is_drained(f, now))
        f->run.drained_at = (double)NAN;
    else if (isnan(f->run.drained_at))
        f->run.drained_at = now->t;
    f->run.t = now->t;
    f->run.entered = now->entered;
    f->run.exited = now->exited;
}

void figures_peak(figures *f, double density)
{
    if (f->run.is_warm)
        f->run.peak = fmax(f->run.peak, density);
}

void figures_exit(figures *f, double residence, double parts)
{
    if (f->run.is_warm)
        quantiles_add(&f->residence, residence, parts);
}

void figures_wait(figures *f, size_t feed, double wait)
{
    if (f->run.is_warm)
        quantiles_add(&f->waits[feed], wait, 1.0);
}

void figures_eye_begin(figures *f, size_t eye, double travel)
{
    eye_sums *e = &f->eyes[eye];
    const bool is_alone = e->n_inside == 0;

    if (f->run.is_warm) {
        e->n += 1.0;
        if (!is_alone)
            e->n_doubles += e->is_noted ? 1.0 : 2.0;
        else if (!isnan(e->last_end))
            quantiles_add(&f->gaps[eye], fmax(travel - e->last_end, 0.0), 1.0);
    }
    e->is_noted = !is_alone || !f->run.is_warm;
    e->n_inside++;
}

void figures_eye_end(figures *f, size_t eye, double travel)
{
    f->eyes[eye].n_inside--;
    f->eyes[eye].last_end = travel;
}

void figures_eye_state(figures *f, size_t eye, double t, bool is_blocked)
{
    eye_sums *e = &f->eyes[eye];

    if (e->is_blocked && !is_blocked && f->run.is_warm) {
        const double lasted = t - fmax(e->blocked_since, f->run.t_start);
        e->n_blocked += 1.0;
        e->blocked_total += lasted;
        e->blocked_longest = fmax(e->blocked_longest, lasted);
    }
    e->blocked_since = t;
    e->is_blocked = is_blocked;
}

// What stopped a belt from one time to another.
static void add_stops(figures *f, const belt_speeds *speeds, size_t k, double from, double to)
{
    const size_t belt = figure_belt(f->s, FIGURE_OF_BELT, k);
    stop_sums *sums = &f->stops[k];
    size_t first = 0; // kind of failure of the belt
    double until;

    for (size_t i = 0; i < belt; i++)
        first += f->s->belts[i].stops.n_failures;
    for (double at = from; at < to; at = until) {
        const unsigned now = belt_speeds_stopped_by(speeds, belt, at, &until);
        const uint64_t before = sums->now;
        const double lasted = fmin(until, to) - at;
        const bool is_break = (now & BELT_STOPS_BREAK) != 0;
        sums->now = now;
        if (!f->run.is_warm)
            continue;
        for (size_t i = 0; i < f->s->belts[belt].stops.n_failures; i++) {
            failure_sums *of = &f->failures[first + i];
            const bool is_down = (now & 1U << i) != 0;
            of->n += is_down && (before & 1U << i) == 0 ? 1.0 : 0.0;
            of->total += is_down && !is_break ? lasted : 0.0;
        }
        sums->planned += is_break ? lasted : 0.0;
        sums->failed += !is_break && (now & BELT_STOPS_FAILED) != 0 ? lasted : 0.0;
    }
}

void figures_belts(figures *f, const belt_speeds *speeds, double t)
{
    for (size_t k = 0; k < f->n_belts; k++) {
        belt_sums *b = &f->belts[k];
        const size_t belt = figure_belt(f->s, FIGURE_OF_BELT, k);
        double until;
        if (k < f->n_stops)
            add_stops(f, speeds, k, b->known_until, t);
        for (double at = b->known_until; at < t; at = until) {
            const bool stands = belt_speeds_stands(speeds, belt, at, &until);
            if (b->stands && !stands && f->run.is_warm) {
                const double lasted = at - fmax(b->since, f->run.t_start);
                b->n += 1.0;
                b->total += lasted;
                b->longest = fmax(b->longest, lasted);
            }
            b->since = b->stands && stands ? b->since : at;
            b->stands = stands;
        }
        b->known_until = t;
    }
}

void figures_stall(figures *f, double t, bool is_stopped)
{
    stall_sums *s = &f->run.stall;

    if (f->run.is_warm) {
        s->total += (double)s->n_now * (t - fmax(s->since, f->run.t_start));
        if (is_stopped && s->count == 0.0)
            s->first = t;
        s->count += is_stopped ? 1.0 : 0.0;
    }
    s->n_now = is_stopped ? s->n_now + 1 : s->n_now - 1;
    s->since = t;
}

double figures_time(const figures *f)
{
    return f->run.t;
}

bool figures_is_steady(const figures *f)
{
    return f->run.is_warm && !isnan(f->run.batches.reached_at);
}
