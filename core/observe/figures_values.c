#include "core/observe/figures_priv.h"

#include "core/compare/compare.h"
#include "core/observe/survival.h"

#include <math.h>

enum { N_PERCENTILES = 4 }; // of residence, in the order of the table

static const double s_per_h = 3600.0;

// Of divisible parts, what rounding may take from a whole one.
static const double whole_part = 1.0 - 1e-6;

static double ratio(double a, double b)
{
    return b > 0.0 ? a / b : (double)NAN;
}

static void fill_quantiles(const figures *f, const quantiles *q, size_t item, figure_id mean,
                           const double *p, size_t n, double *ret_values)
{
    ret_values[figure_at(f->s, mean, item)] = quantiles_mean(q);
    for (size_t k = 0; k < n; k++)
        ret_values[figure_at(f->s, mean + 1 + (figure_id)k, item)] = quantiles_at(q, p[k]);
}

// While the middle 80 % of what passed the first counter did, parts/s; NAN: there is no time yet.
static double outflow_rate(const figures *f)
{
    const compare_curve curve = thinned_curve(&f->outflow);
    compare_figures of_curve;

    if (compare_figures_of(&curve, &of_curve, NULL) != BF_OK || of_curve.t_end <= of_curve.t_start)
        return (double)NAN;
    return isnan(of_curve.throughput) ? 0.0 : of_curve.throughput;
}

static void fill_run(const figures *f, double *ret_values)
{
    static const double p[N_PERCENTILES] = { 0.5, 0.9, 0.95, 0.99 };
    const run_sums *run = &f->run;
    const jam_sums *jam = &run->jam;
    const stall_sums *stall = &run->stall;

    if (f->residence.weight >= whole_part && f->ages.weight + f->ages_first.weight > 0.0)
        survival_find(&(survival){ &f->residence, &f->ages, &f->ages_first }, p, N_PERCENTILES,
                      &ret_values[FIGURE_RESIDENCE_MEAN], &ret_values[FIGURE_RESIDENCE_P50]);
    else if (f->residence.weight >= whole_part)
        fill_quantiles(f, &f->residence, 0, FIGURE_RESIDENCE_MEAN, p, N_PERCENTILES, ret_values);
    ret_values[FIGURE_DRAINED_AT] = run->drained_at;
    ret_values[FIGURE_ENTERED] = run->entered;
    ret_values[FIGURE_LEFT] = run->exited;
    ret_values[FIGURE_PEAK] = run->peak;
    if (!run->is_warm)
        return;
    const steady_estimate known = steady_estimate_of(&run->batches);
    const double throughput = ratio(run->exited - run->exited_start, run->t - run->t_start);
    ret_values[FIGURE_THROUGHPUT] = s_per_h * throughput;
    ret_values[FIGURE_THROUGHPUT_ERROR] = s_per_h * known.half_width;
    ret_values[FIGURE_THROUGHPUT_NEEDS] = run->t_start + known.needs;
    ret_values[FIGURE_STEADY_AT] = run->batches.reached_at;
    ret_values[FIGURE_SUSTAINED] = s_per_h * (f->s->n_feeds > 0 ? throughput : outflow_rate(f));
    ret_values[FIGURE_JAM_COUNT] = jam->count;
    ret_values[FIGURE_JAM_FIRST] = jam->first;
    ret_values[FIGURE_JAM_TOTAL] = jam->total + (jam->is_jam ? run->t - jam->since : 0.0);
    if (scene_has_moving_obstacles(f->s)) {
        const double lasted = fmax(run->t - fmax(stall->since, run->t_start), 0.0);
        ret_values[FIGURE_STALL_COUNT] = stall->count;
        ret_values[FIGURE_STALL_FIRST] = stall->first;
        ret_values[FIGURE_STALL_TOTAL] = stall->total + (double)stall->n_now * lasted;
    }
    ret_values[FIGURE_QUEUE_END] = run->has_cargo ? run->queue_end : (double)NAN;
}

static void fill_feed(const figures *f, size_t k, double *ret_values)
{
    static const double p[] = { 0.95 };
    const feed_sums *sums = &f->feeds[k];

    ret_values[figure_at(f->s, FIGURE_OFFERED, k)] = sums->balance.offered;
    ret_values[figure_at(f->s, FIGURE_ADMITTED, k)] = sums->balance.admitted;
    ret_values[figure_at(f->s, FIGURE_DISCARDED, k)] = sums->balance.discarded;
    if (f->run.is_warm)
        ret_values[figure_at(f->s, FIGURE_WAITING_MAX, k)] = sums->waiting_max;
    fill_quantiles(f, &f->waits[k], k, FIGURE_WAIT_MEAN, p, 1, ret_values);
    if (f->waits[k].weight > 0.0)
        ret_values[figure_at(f->s, FIGURE_WAIT_MAX, k)] = f->waits[k].max;
}

static void fill_counter(const figures *f, size_t k, double *ret_values)
{
    const counter_sums *c = &f->counters[k];
    double all = 0.0;

    if (!f->run.is_warm)
        return;
    ret_values[figure_at(f->s, FIGURE_CONTENT_MEAN, k)] =
        ratio(c->content_integral, f->run.t - f->run.t_start);
    ret_values[figure_at(f->s, FIGURE_CONTENT_MAX, k)] = c->content_max;
    for (int state = 0; state < QUEUE_STATES; state++)
        all += c->states_integral[state];
    for (int state = 0; state < QUEUE_STATES; state++)
        ret_values[figure_at(f->s, FIGURE_STATE_FREE + (figure_id)state, k)] =
            ratio(c->states_integral[state], all);
}

// Where a queue comes and goes out of sight of a counter, its own batches do not show it: the interval is never narrower
// than that of the throughput, in proportion.
static void fill_flow(const figures *f, size_t k, double *ret_values)
{
    const flow_sums *flow = &f->flows[k];
    const bool is_sink = k >= f->n_through, is_counter = !is_sink && k < f->s->n_counters;
    const size_t item = is_sink ? k - f->n_through : is_counter ? k : k - f->s->n_counters;
    const figure_id first = is_sink ? FIGURE_SINK_FLOW : is_counter ? FIGURE_FLOW : FIGURE_OUTFLOW;
    const double through = ret_values[FIGURE_THROUGHPUT];

    if (is_sink)
        ret_values[figure_at(f->s, FIGURE_TAKEN, item)] = flow->left;
    if (flow->batches.length == 0.0)
        return;
    const double rate = s_per_h * ratio(flow->left - flow->left_start, f->run.t - f->run.t_start);
    const steady_estimate known = steady_estimate_of(&flow->batches);
    ret_values[figure_at(f->s, first, item)] = rate;
    if (isnan(ret_values[FIGURE_THROUGHPUT_ERROR]))
        ret_values[figure_at(f->s, first + 2, item)] = ret_values[FIGURE_THROUGHPUT_NEEDS];
    else
        ret_values[figure_at(f->s, first + 2, item)] = f->run.t_start + known.needs;
    if (!isnan(known.half_width) && !isnan(ret_values[FIGURE_THROUGHPUT_ERROR]))
        ret_values[figure_at(f->s, first + 1, item)] = fmax(
            s_per_h * known.half_width, ratio(rate, through) * ret_values[FIGURE_THROUGHPUT_ERROR]);
}

// 12 significant digits, and nothing below 1e-9: what is behind them is the rounding of sums and products.
static double rounded(double x)
{
    const double magnitude = fabs(x);

    if (magnitude < 1e-9)
        return 0.0;
    if (!(magnitude < 1e11))
        return x;
    const double scale = pow(10.0, 11.0 - floor(log10(magnitude)));
    return nearbyint(x * scale) / scale;
}

void figures_fill(const figures *f, double *ret_values)
{
    const size_t n = figure_values(f->s);

    for (size_t k = 0; k < n; k++)
        ret_values[k] = (double)NAN;
    fill_run(f, ret_values);
    for (size_t k = 0; k < f->s->n_feeds; k++)
        fill_feed(f, k, ret_values);
    for (size_t k = 0; k < f->s->n_counters; k++)
        fill_counter(f, k, ret_values);
    for (size_t k = 0; k < f->n_flows; k++)
        fill_flow(f, k, ret_values);
    for (size_t k = 0; k < f->s->n_eyes && f->has_parts; k++) {
        const quantiles *gaps = &f->gaps[k];
        ret_values[figure_at(f->s, FIGURE_GAP_MIN, k)] =
            gaps->weight > 0.0 ? gaps->min : (double)NAN;
        ret_values[figure_at(f->s, FIGURE_GAP_P05, k)] = quantiles_at(gaps, 0.05);
        ret_values[figure_at(f->s, FIGURE_GAP_MEAN, k)] = quantiles_mean(gaps);
        ret_values[figure_at(f->s, FIGURE_DOUBLES, k)] = ratio(f->eyes[k].n_doubles, f->eyes[k].n);
    }
    // Of beams and belts with the time that goes on.
    for (size_t k = 0; k < f->s->n_eyes && f->run.is_warm; k++) {
        const eye_sums *e = &f->eyes[k];
        const double now =
            e->is_blocked ? fmax(f->run.t - fmax(e->blocked_since, f->run.t_start), 0.0) : 0.0;
        ret_values[figure_at(f->s, FIGURE_BLOCKED_COUNT, k)] = e->n_blocked + (double)e->is_blocked;
        ret_values[figure_at(f->s, FIGURE_BLOCKED_TOTAL, k)] = e->blocked_total + now;
        ret_values[figure_at(f->s, FIGURE_BLOCKED_LONGEST, k)] = fmax(e->blocked_longest, now);
    }
    for (size_t k = 0; k < f->n_belts && f->run.is_warm; k++) {
        const belt_sums *b = &f->belts[k];
        const double now = b->stands ? fmax(f->run.t - fmax(b->since, f->run.t_start), 0.0) : 0.0;
        ret_values[figure_at(f->s, FIGURE_STOPPED_COUNT, k)] = b->n + (double)b->stands;
        ret_values[figure_at(f->s, FIGURE_STOPPED_TOTAL, k)] = b->total + now;
        ret_values[figure_at(f->s, FIGURE_STOPPED_LONGEST, k)] = fmax(b->longest, now);
    }
    const double lasted = f->run.t - f->run.t_start;
    for (size_t k = 0; k < f->n_stops && f->run.is_warm; k++) {
        const stop_sums *of = &f->stops[k];
        const double planned = lasted - of->planned;
        if (f->s->belts[figure_belt(f->s, FIGURE_OF_BELT, k)].stops.n_failures > 0)
            ret_values[figure_at(f->s, FIGURE_AVAILABILITY, k)] =
                ratio(planned - of->failed, planned);
    }
    for (size_t k = 0; k < f->n_failures && f->run.is_warm; k++) {
        ret_values[figure_at(f->s, FIGURE_FAILED_COUNT, k)] = f->failures[k].n;
        ret_values[figure_at(f->s, FIGURE_FAILED_TOTAL, k)] = f->failures[k].total;
    }
    for (size_t k = 0; k < n; k++)
        ret_values[k] = rounded(ret_values[k]);
}

void figures_save(const figures *f, checkpoint_writer *w)
{
    checkpoint_write(w, &f->run, sizeof f->run);
    checkpoint_write(w, f->counters, f->s->n_counters * sizeof *f->counters);
    checkpoint_write(w, f->feeds, f->s->n_feeds * sizeof *f->feeds);
    checkpoint_write(w, f->eyes, f->s->n_eyes * sizeof *f->eyes);
    checkpoint_write(w, f->belts, f->n_belts * sizeof *f->belts);
    checkpoint_write(w, f->stops, f->n_stops * sizeof *f->stops);
    checkpoint_write(w, f->failures, f->n_failures * sizeof *f->failures);
    checkpoint_write(w, f->flows, f->n_flows * sizeof *f->flows);
    quantiles_save(&f->residence, w);
    if (f->has_exits) {
        quantiles_save(&f->ages, w);
        quantiles_save(&f->ages_first, w);
    }
    for (size_t k = 0; k < f->s->n_feeds; k++)
        quantiles_save(&f->waits[k], w);
    for (size_t k = 0; f->has_parts && k < f->s->n_eyes; k++)
        quantiles_save(&f->gaps[k], w);
    if (!f->has_exits)
        fifo_save(&f->inside, w);
    if (f->s->n_feeds == 0)
        thinned_save(&f->outflow, w);
    for (size_t k = 0; !f->has_parts && k < f->s->n_feeds; k++)
        fifo_save(&f->queues[k], w);
}

bool figures_load(figures *f, checkpoint_reader *r)
{
    bool is_good = checkpoint_read(r, &f->run, sizeof f->run) &&
                   checkpoint_read(r, f->counters, f->s->n_counters * sizeof *f->counters) &&
                   checkpoint_read(r, f->feeds, f->s->n_feeds * sizeof *f->feeds) &&
                   checkpoint_read(r, f->eyes, f->s->n_eyes * sizeof *f->eyes) &&
                   checkpoint_read(r, f->belts, f->n_belts * sizeof *f->belts) &&
                   checkpoint_read(r, f->stops, f->n_stops * sizeof *f->stops) &&
                   checkpoint_read(r, f->failures, f->n_failures * sizeof *f->failures) &&
                   checkpoint_read(r, f->flows, f->n_flows * sizeof *f->flows) &&
                   quantiles_load(&f->residence, r) && f->run.batches.n < STEADY_BATCHES_MAX;

    for (size_t k = 0; is_good && k < f->n_flows; k++)
        is_good = f->flows[k].batches.n < STEADY_BATCHES_MAX;
    if (is_good && f->has_exits)
        is_good = quantiles_load(&f->ages, r) && quantiles_load(&f->ages_first, r);
    f->are_ages_old = true;
    for (size_t k = 0; is_good && k < f->s->n_feeds; k++)
        is_good = quantiles_load(&f->waits[k], r);
    for (size_t k = 0; is_good && f->has_parts && k < f->s->n_eyes; k++)
        is_good = quantiles_load(&f->gaps[k], r);
    if (is_good && !f->has_exits)
        is_good = fifo_load(&f->inside, r);
    if (is_good && f->s->n_feeds == 0)
        is_good = thinned_load(&f->outflow, r);
    for (size_t k = 0; is_good && !f->has_parts && k < f->s->n_feeds; k++)
        is_good = fifo_load(&f->queues[k], r);
    return is_good;
}
