#include "core/feed/arrivals.h"

#include "core/base/digest.h"
#include "core/base/draws.h"
#include "core/base/memory.h"
#include "core/base/search.h"

#include <math.h>
#include <string.h>

// A corner of the rate; towards the next one it is linear.
typedef struct knot {
    double t;     // s after the feed's start
    double rate;  // parts/s
    double total; // parts until there
} knot;

struct feed_arrivals {
    const scene_feed *feed;
    draws from;
    double sum_of_weights; // of the mix
    size_t n_knots;        // 0: a list
    knot *knots;           // the first at 0; the last, if there is a period, at its end
    double period;         // s, INFINITY: none
    size_t first;          // of a list: its first entry that counts
    size_t n_entries;      // and how many do
    uint64_t *totals;      // parts of these entries, added up
};

static void add_knot(feed_arrivals *a, double t, double rate)
{
    double total = 0.0;

    if (a->n_knots > 0) {
        const knot *last = &a->knots[a->n_knots - 1];
        total = last->total + (t - last->t) * 0.5 * (last->rate + rate);
    }
    a->knots[a->n_knots++] = (knot){ t, rate, total };
}

static bf_status make_knots(feed_arrivals *a)
{
    const scene_series *p = &a->feed->profile;
    const bool is_constant = a->feed->demand == SCENE_DEMAND_RATE;
    const size_t n = is_constant ? 0 : p->n_times;

    // One more at each end.
    if ((a->knots = memory_alloc(n + 2, sizeof *a->knots)) == NULL)
        return BF_ENOMEM;
    a->period = is_constant ? INFINITY : p->repeat;
    if (is_constant || p->times[0] > 0.0)
        add_knot(a, 0.0, is_constant ? a->feed->rate : p->values[0]);
    for (size_t k = 0; k < n; k++)
        add_knot(a, p->times[k], p->values[k]);
    if (isfinite(a->period) && p->times[n - 1] < a->period)
        add_knot(a, a->period, p->values[n - 1]);
    return BF_OK;
}

static bf_status make_totals(feed_arrivals *a)
{
    const scene_arrival_list *list = &a->feed->schedule;
    size_t last = list->n;

    while (a->first < last && list->times[a->first] < a->feed->start)
        a->first++;
    while (last > a->first && list->times[last - 1] > a->feed->end)
        last--;
    a->n_entries = last - a->first;
    if ((a->totals = memory_alloc(a->n_entries, sizeof *a->totals)) == NULL)
        return BF_ENOMEM;
    for (size_t k = 0; k < a->n_entries; k++)
        a->totals[k] = (k > 0 ? a->totals[k - 1] : 0) +
                       (list->counts != NULL ? list->counts[a->first + k] : 1);
    return BF_OK;
}

bf_status feed_arrivals_create(const scene_feed *feed, uint64_t substream,
                               feed_arrivals **ret_arrivals, bf_error *err)
{
    feed_arrivals *a = memory_alloc(1, sizeof *a);

    if (a != NULL) {
        *a = (feed_arrivals){ .feed = feed };
        a->from =
            (draws){ feed->seed, substream, digest_add(DIGEST_START, feed->id, strlen(feed->id)) };
        for (size_t k = 0; k < feed->n_cargo; k++)
            a->sum_of_weights += feed->cargo[k].share;
    }
    if (a == NULL ||
        (feed->demand == SCENE_DEMAND_SCHEDULE ? make_totals(a) : make_knots(a)) != BF_OK) {
        feed_arrivals_destroy(a);
        return bf_fail(err, BF_ENOMEM, "/feeds", "no memory for the arrivals of feed %s", feed->id);
    }
    *ret_arrivals = a;
    return BF_OK;
}

feed_arrivals *feed_arrivals_destroy(feed_arrivals *a)
{
    if (a != NULL) {
        memory_free(a->knots);
        memory_free(a->totals);
    }
    memory_free(a);
    return NULL;
}

// The slope of the rate behind a knot, parts/s2.
static double slope_behind(const feed_arrivals *a, size_t k)
{
    const knot *at = &a->knots[k];

    return k + 1 < a->n_knots ? (at[1].rate - at->rate) / (at[1].t - at->t) : 0.0;
}

// Parts in the first t seconds of a period.
static double knots_until(const feed_arrivals *a, double t)
{
    const size_t k = search_last(&a->knots->t, sizeof *a->knots, a->n_knots, t);
    const knot *at = &a->knots[k];
    const double past = t - at->t;
    // Without further knots and without a rate nothing more arrives, however long it takes.
    return at->rate == 0.0 && k + 1 == a->n_knots
               ? at->total
               : at->total + past * (at->rate + 0.5 * slope_behind(a, k) * past);
}

static double parts_in_period(const feed_arrivals *a)
{
    return a->knots[a->n_knots - 1].total;
}

// Lambda without the feed's count.
static double uncounted_until(const feed_arrivals *a, double t)
{
    const double past = fmin(t, a->feed->end) - a->feed->start;

    if (a->n_knots == 0) {
        // The parts of a list whose time is at most t.
        const double *times = a->feed->schedule.times + a->first;
        const size_t n = search_count(times, sizeof *times, a->n_entries, t, true);
        return n > 0 ? (double)a->totals[n - 1] : 0.0;
    }
    if (!(past > 0.0))
        return 0.0;
    if (!isfinite(a->period))
        return knots_until(a, past);
    if (!isfinite(past))
        return parts_in_period(a) > 0.0 ? INFINITY : 0.0;
    const double in_period = fmod(past, a->period);
    return round((past - in_period) / a->period) * parts_in_period(a) + knots_until(a, in_period);
}

double feed_arrivals_until(const feed_arrivals *a, double t)
{
    return fmin(uncounted_until(a, t), a->feed->count);
}

// Lambda between two times.
static double mean_between(const feed_arrivals *a, double from, double to)
{
    return feed_arrivals_until(a, to) - feed_arrivals_until(a, from);
}

// Parts that are due between two times.
static double drawn_between(const feed_arrivals *a, double from, double to)
{
    double parts = 0.0;

    for (feed_cursor at = feed_arrivals_first(a); at.due <= to; feed_arrivals_next(a, &at))
        parts += at.due > from ? 1.0 : 0.0;
    return parts;
}

static bf_status sum_up(const scene *s, double (*between)(const feed_arrivals *, double, double),
                        double from, double to, double *ret_parts, bf_error *err)
{
    double parts = 0.0;

    for (size_t k = 0; k < s->n_feeds; k++) {
        feed_arrivals *arrivals = NULL;
        const bf_status status = feed_arrivals_create(&s->feeds[k], s->substream, &arrivals, err);
        if (status != BF_OK)
            return status;
        parts += between(arrivals, from, to);
        feed_arrivals_destroy(arrivals);
    }
    *ret_parts = parts;
    return BF_OK;
}

bf_status feed_offered(const scene *s, double from, double to, double *ret_parts, bf_error *err)
{
    return sum_up(s, mean_between, from, to, ret_parts, err);
}

bf_status feed_drawn(const scene *s, double from, double to, double *ret_parts, bf_error *err)
{
    return sum_up(s, drawn_between, from, to, ret_parts, err);
}

static double list_time(const feed_arrivals *a, double level)
{
    size_t low = 0, high = a->n_entries;

    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if ((double)a->totals[middle] < level)
            low = middle + 1;
        else
            high = middle;
    }
    return low < a->n_entries ? a->feed->schedule.times[a->first + low] : INFINITY;
}

// Seconds of a period until it has brought `level` parts.
static double knots_time(const feed_arrivals *a, double level)
{
    const size_t n = search_count(&a->knots->total, sizeof *a->knots, a->n_knots, level, false);
    const size_t k = n > 0 ? n - 1 : 0; // the level is above that of this knot
    const knot *at = &a->knots[k];
    const double missing = fmax(level - at->total, 0.0);
    // missing = rate s + slope s^2/2, with the root of the quadratic that has no difference of like numbers.
    const double square = at->rate * at->rate + 2.0 * slope_behind(a, k) * missing;
    const double divisor = at->rate + sqrt(fmax(square, 0.0));
    const double t = at->t + (divisor > 0.0 ? 2.0 * missing / divisor : INFINITY);
    return k + 1 < a->n_knots ? fmin(t, at[1].t) : t;
}

double feed_arrivals_time(const feed_arrivals *a, double level)
{
    double periods = 0.0, t;

    if (a->n_knots == 0)
        return list_time(a, level);
    if (isfinite(a->period)) {
        const double each = parts_in_period(a);
        if (!(each > 0.0))
            return INFINITY;
        // The end of a period belongs to it: the first time is asked for, and the next may begin with a rate of 0.
        periods = fmax(ceil(level / each) - 1.0, 0.0);
        if (level - periods * each <= 0.0 && periods > 0.0)
            periods--;
        level = fmin(level - periods * each, each);
        t = a->feed->start + periods * a->period + knots_time(a, level);
    } else {
        t = a->feed->start + knots_time(a, level);
    }
    return t <= a->feed->end ? t : INFINITY;
}

double feed_arrivals_largest_rate(const feed_arrivals *a)
{
    double largest = 0.0;

    if (a->n_knots == 0) {
        const double *times = a->feed->schedule.times + a->first;
        const size_t n = a->n_entries;
        const double lasts = n > 0 ? times[n - 1] - times[0] : 0.0;
        return lasts > 0.0 ? (double)(a->totals[n - 1] - a->totals[0]) / lasts : 0.0;
    }
    for (size_t k = 0; k < a->n_knots; k++)
        largest = fmax(largest, a->knots[k].rate);
    return largest;
}

// Adds the gap before the cursor's part to its level, which gets no less exact as parts add up.
static void add_gap(const feed_arrivals *a, feed_cursor *c, uint32_t shape)
{
    const double gap = draws_gap(&a->from, c->number, shape) - c->residue;
    const double level = c->level + gap;

    c->residue = (level - c->level) - gap;
    c->level = level;
}

static void find_level(const feed_arrivals *a, feed_cursor *c)
{
    const scene_feed *f = a->feed;

    switch (f->arrivals) {
    case SCENE_ARRIVALS_POISSON:
        add_gap(a, c, 1);
        break;
    case SCENE_ARRIVALS_ERLANG:
        add_gap(a, c, f->shape);
        break;
    case SCENE_ARRIVALS_BATCH:
        c->level = ((double)((c->number - 1) / f->batch_size) + 0.5) * f->batch_size;
        break;
    default:
        c->level = (double)c->number - 0.5;
    }
}

static void next_of_list(const feed_arrivals *a, feed_cursor *c)
{
    const scene_arrival_list *list = &a->feed->schedule;

    c->level += 1.0;
    if (c->left > 0) {
        c->left--;
        return;
    }
    c->entry = c->number == 1 ? a->first : c->entry + 1;
    if (c->entry == a->first + a->n_entries) {
        c->due = INFINITY;
        return;
    }
    c->due = list->times[c->entry];
    c->left = list->counts != NULL ? list->counts[c->entry] - 1 : 0;
}

void feed_arrivals_next(const feed_arrivals *a, feed_cursor *cursor)
{
    cursor->number++;
    if ((double)cursor->number > a->feed->count) {
        cursor->due = INFINITY;
    } else if (a->n_knots == 0) {
        next_of_list(a, cursor);
    } else {
        find_level(a, cursor);
        cursor->due = feed_arrivals_time(a, cursor->level);
    }
}

feed_cursor feed_arrivals_first(const feed_arrivals *a)
{
    feed_cursor cursor = { .number = 0 };

    feed_arrivals_next(a, &cursor);
    return cursor;
}

static uint32_t draw_kind(const feed_arrivals *a, uint64_t number)
{
    const scene_feed *f = a->feed;
    double left = draws_unit(&a->from, number, DRAWS_KIND, 0) * a->sum_of_weights;
    size_t k = 0;

    while (k + 1 < f->n_cargo && left >= f->cargo[k].share)
        left -= f->cargo[k++].share;
    return f->cargo[k].kind;
}

double feed_arrivals_place(const feed_arrivals *a, uint64_t number, uint32_t attempt)
{
    return draws_unit(&a->from, number, DRAWS_PLACE, attempt);
}

feed_part feed_arrivals_part(const feed_arrivals *a, const feed_cursor *cursor)
{
    const scene_feed *f = a->feed;
    const scene_arrival_list *list = a->n_knots == 0 ? &f->schedule : NULL;
    const double place = list != NULL && list->places != NULL ? list->places[cursor->entry] : NAN;
    const double heading =
        list != NULL && list->headings != NULL ? list->headings[cursor->entry] : NAN;
    const double drawn = f->has_random_heading
                             ? 2.0 * M_PI * draws_unit(&a->from, cursor->number, DRAWS_HEADING, 0)
                             : f->heading;

    return (feed_part){
        .number = cursor->number,
        .due = cursor->due,
        .kind = list != NULL && list->kinds != NULL ? list->kinds[cursor->entry]
                                                    : draw_kind(a, cursor->number),
        .place = isnan(place) ? feed_arrivals_place(a, cursor->number, 0) : place,
        .is_placed = !isnan(place),
        .heading = isnan(heading) ? drawn : heading,
    };
}
