#include "core/compare/compare.h"

#include <math.h>

static const double drained_share = 0.01; // of the first value

static bf_status check_curve(const compare_curve *c, const char *pointer, bf_error *err)
{
    if (c->n == 0)
        return bf_fail(err, BF_EINPUT, pointer, "the curve has no samples");
    for (size_t k = 0; k < c->n; k++) {
        if (!isfinite(c->t[k]) || !isfinite(c->parts[k]))
            return bf_fail(err, BF_EINPUT, pointer, "sample %zu is not finite", k);
        if (k > 0 && !(c->t[k] > c->t[k - 1]))
            return bf_fail(err, BF_EINPUT, pointer,
                           "times must rise: sample %zu at %.9g s follows %.9g s", k, c->t[k],
                           c->t[k - 1]);
    }
    return BF_OK;
}

// A curve that is read at rising times.
typedef struct cursor {
    const compare_curve *curve;
    size_t k; // last sample at or before the time at hand
} cursor;

static double read_at(cursor *c, double t)
{
    const compare_curve *curve = c->curve;

    while (c->k + 1 < curve->n && curve->t[c->k + 1] <= t)
        c->k++;
    if (c->k + 1 == curve->n || t <= curve->t[c->k])
        return curve->parts[c->k];
    double share = (t - curve->t[c->k]) / (curve->t[c->k + 1] - curve->t[c->k]);
    return curve->parts[c->k] + share * (curve->parts[c->k + 1] - curve->parts[c->k]);
}

// The next time after t at which either curve has a sample, at most t_end.
static double next_time(const cursor *a, const cursor *b, double t, double t_end)
{
    double next = t_end;
    const cursor *both[] = { a, b };

    for (int k = 0; k < 2; k++)
        for (size_t m = both[k]->k; m < both[k]->curve->n; m++)
            if (both[k]->curve->t[m] > t) {
                next = fmin(next, both[k]->curve->t[m]);
                break;
            }
    return next;
}

static double drain_time(const compare_curve *c)
{
    for (size_t k = 0; k < c->n; k++)
        if (c->parts[k] <= drained_share * c->parts[0])
            return c->t[k];
    return NAN;
}

static double mean_rate(const compare_curve *c, double t_start, double t_end)
{
    cursor at = { .curve = c };
    double first = read_at(&at, t_start), last = read_at(&at, t_end);

    return t_end > t_start ? (first - last) / (t_end - t_start) : 0.0;
}

// Adds the interval from t to next, on which the gap goes linearly from gap to next_gap: the integral
// of |gap|, with its zero crossing, and of gap^2 are exact for such a line.
static void add_interval(double width, double gap, double next_gap, double *area, double *square)
{
    double low = fabs(gap), high = fabs(next_gap);

    if (gap * next_gap < 0.0)
        *area += 0.5 * width * (low * low + high * high) / (low + high);
    else
        *area += 0.5 * width * (low + high);
    *square += width * (gap * gap + gap * next_gap + next_gap * next_gap) / 3.0;
}

static void measure_gap(cursor a, cursor b, compare_measures *m)
{
    double t = m->t_start, area = 0.0, square = 0.0;
    double gap = read_at(&a, t) - read_at(&b, t);

    m->largest = fabs(gap);
    m->largest_at = t;
    while (t < m->t_end) {
        double next = next_time(&a, &b, t, m->t_end);
        double next_gap = read_at(&a, next) - read_at(&b, next);
        add_interval(next - t, gap, next_gap, &area, &square);
        if (fabs(next_gap) > m->largest) {
            m->largest = fabs(next_gap);
            m->largest_at = next;
        }
        t = next;
        gap = next_gap;
    }
    double width = m->t_end - m->t_start;
    m->l1 = width > 0.0 ? area / width : fabs(gap);
    m->l2 = width > 0.0 ? sqrt(square / width) : fabs(gap);
}

bf_status compare_curves(const compare_curve *a, const compare_curve *b,
                         compare_measures *ret_measures, bf_error *err)
{
    bf_status status;

    if ((status = check_curve(a, "/a", err)) != BF_OK ||
        (status = check_curve(b, "/b", err)) != BF_OK)
        return status;
    compare_measures m = { .t_start = fmax(a->t[0], b->t[0]),
                           .t_end = fmin(a->t[a->n - 1], b->t[b->n - 1]) };
    if (m.t_start > m.t_end)
        return bf_fail(err, BF_EINPUT, "/b",
                       "the curves have no time in common: %.9g s to %.9g s "
                       "and %.9g s to %.9g s",
                       a->t[0], a->t[a->n - 1], b->t[0], b->t[b->n - 1]);
    measure_gap((cursor){ .curve = a }, (cursor){ .curve = b }, &m);
    m.drain_time_a = drain_time(a);
    m.drain_time_b = drain_time(b);
    m.rate_a = mean_rate(a, m.t_start, m.t_end);
    m.rate_b = mean_rate(b, m.t_start, m.t_end);
    *ret_measures = m;
    return BF_OK;
}
