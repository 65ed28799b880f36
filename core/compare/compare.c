#include "core/compare/compare.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

static const double drained_fraction = 0.01; // of the first value

// Throughput counts between these fractions of what leaves.
static const double ramp_fraction = 0.1, tail_fraction = 0.9;

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
    size_t k; // last sample at or before the current time
} cursor;

static double read_at(cursor *c, double t)
{
    const compare_curve *curve = c->curve;

    while (c->k + 1 < curve->n && curve->t[c->k + 1] <= t)
        c->k++;
    if (c->k + 1 == curve->n || t <= curve->t[c->k])
        return curve->parts[c->k];
    double fraction = (t - curve->t[c->k]) / (curve->t[c->k + 1] - curve->t[c->k]);
    return curve->parts[c->k] + fraction * (curve->parts[c->k + 1] - curve->parts[c->k]);
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
    const bool rises = c->parts[c->n - 1] > c->parts[0];

    for (size_t k = 0; k < c->n && !rises; k++)
        if (c->parts[k] <= drained_fraction * c->parts[0])
            return c->t[k];
    return NAN;
}

static double mean_rate(const compare_curve *c, double t_start, double t_end)
{
    cursor at = { .curve = c };
    double first = read_at(&at, t_start), last = read_at(&at, t_end);

    return t_end > t_start ? (first - last) / (t_end - t_start) : 0.0;
}

// What a curve does on an interval.
typedef struct passage {
    double t10, t90, throughput; // NAN: nothing leaves
} passage;

// The first time from t on at which the curve has gone this fraction of its way from first to last,
// which differ. *at stays at or before it, to be read on from there.
static double find_fraction(cursor *at, double t, double t_end, double first, double last,
                            double fraction)
{
    double gone = (read_at(at, t) - first) / (last - first);

    while (gone < fraction && t < t_end) {
        cursor ahead = *at;
        double next = next_time(at, at, t, t_end);
        double next_gone = (read_at(&ahead, next) - first) / (last - first);
        if (next_gone >= fraction)
            return t + (fraction - gone) / (next_gone - gone) * (next - t);
        *at = ahead;
        t = next;
        gone = next_gone;
    }
    return t;
}

static passage measure_passage(const compare_curve *c, double t_start, double t_end)
{
    cursor at = { .curve = c }, end = { .curve = c };
    double first = read_at(&at, t_start), last = read_at(&end, t_end);
    passage p = { NAN, NAN, NAN };

    if (first == last)
        return p;
    p.t10 = find_fraction(&at, t_start, t_end, first, last, ramp_fraction);
    p.t90 = find_fraction(&at, p.t10, t_end, first, last, tail_fraction);
    if (p.t90 > p.t10)
        p.throughput = (tail_fraction - ramp_fraction) * fabs(last - first) / (p.t90 - p.t10);
    return p;
}

// The integral of |gap| over an interval of a width on which the gap goes linearly from one value to
// another; exact where it crosses zero, too.
static double integrate_gap(double width, double gap, double next_gap)
{
    double low = fabs(gap), high = fabs(next_gap);

    if (gap * next_gap < 0.0)
        return 0.5 * width * (low * low + high * high) / (low + high);
    return 0.5 * width * (low + high);
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
        area += integrate_gap(next - t, gap, next_gap);
        // The integral of the square of a line, exact.
        square += (next - t) * (gap * gap + gap * next_gap + next_gap * next_gap) / 3.0;
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

bf_status compare_figures_of(const compare_curve *curve, compare_figures *ret_figures,
                             bf_error *err)
{
    bf_status status = check_curve(curve, "", err);

    if (status != BF_OK)
        return status;
    compare_figures f = { .t_start = curve->t[0],
                          .t_end = curve->t[curve->n - 1],
                          .parts_start = curve->parts[0],
                          .parts_end = curve->parts[curve->n - 1],
                          .drain_time = drain_time(curve) };
    passage p = measure_passage(curve, f.t_start, f.t_end);
    f.t10 = p.t10;
    f.t90 = p.t90;
    f.throughput = p.throughput;
    *ret_figures = f;
    return BF_OK;
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
                       "the curves have no time in common: %.9g s to %.9g s and %.9g s to %.9g s",
                       a->t[0], a->t[a->n - 1], b->t[0], b->t[b->n - 1]);
    measure_gap((cursor){ .curve = a }, (cursor){ .curve = b }, &m);
    m.drain_time_a = drain_time(a);
    m.drain_time_b = drain_time(b);
    m.drain_gap = m.drain_time_b - m.drain_time_a;
    m.rate_a = mean_rate(a, m.t_start, m.t_end);
    m.rate_b = mean_rate(b, m.t_start, m.t_end);
    m.throughput_a = measure_passage(a, m.t_start, m.t_end).throughput;
    m.throughput_b = measure_passage(b, m.t_start, m.t_end).throughput;
    m.throughput_gap = m.throughput_b - m.throughput_a;
    *ret_measures = m;
    return BF_OK;
}

void compare_figures_of_content(compare_figures *figures)
{
    figures->drain_time = figures->t10 = figures->t90 = figures->throughput = NAN;
}

void compare_measures_of_content(compare_measures *measures, bool is_a, bool is_b)
{
    if (is_a)
        measures->drain_time_a = measures->rate_a = measures->throughput_a = NAN;
    if (is_b)
        measures->drain_time_b = measures->rate_b = measures->throughput_b = NAN;
    if (is_a || is_b)
        measures->drain_gap = measures->throughput_gap = NAN;
}

// Where the mass of a density lies along the axes, in units of cells.
typedef struct marginals {
    double *x; // n1 columns
    double *y; // n2 rows
    double mass;
} marginals;

static void gather(const bf_grid *grid, const float *rho, marginals *m)
{
    for (size_t j = 0; j < grid->n2; j++) {
        const float *row = rho + j * grid->n1;
        double sum = 0.0;
        for (size_t i = 0; i < grid->n1; i++) {
            m->x[i] += (double)row[i];
            sum += (double)row[i];
        }
        m->y[j] = sum;
        m->mass += sum;
    }
}

// The integral of the distance of both fractions over n cells of width d. Within a cell each fraction is a
// line, as the density is constant there.
static double carry(const double *a, double mass_a, const double *b, double mass_b, size_t n,
                    double d)
{
    double cumulative_a = 0.0, cumulative_b = 0.0, gap = 0.0, sum = 0.0;

    if (!(mass_a > 0.0) || !(mass_b > 0.0))
        return NAN;
    for (size_t k = 0; k < n; k++) {
        cumulative_a += a[k] / mass_a;
        cumulative_b += b[k] / mass_b;
        double next_gap = cumulative_a - cumulative_b;
        sum += integrate_gap(d, gap, next_gap);
        gap = next_gap;
    }
    return sum;
}

bf_status compare_densities(const bf_grid *grid, const float *a, const float *b,
                            compare_distance *ret_distance, bf_error *err)
{
    size_t n1 = grid->n1, n2 = grid->n2;
    double *sums = memory_alloc(2 * (n1 + n2), sizeof *sums);
    compare_distance d;

    if (sums == NULL)
        return bf_fail_memory(err);
    marginals of_a = { .x = sums, .y = sums + n1 };
    marginals of_b = { .x = sums + n1 + n2, .y = sums + 2 * n1 + n2 };
    gather(grid, a, &of_a);
    gather(grid, b, &of_b);
    const size_t n = grid_cells(grid);
    double gaps = 0.0, all = 0.0;
    for (size_t k = 0; k < n; k++) {
        gaps += fabs((double)a[k] - (double)b[k]);
        all += fabs((double)a[k]) + fabs((double)b[k]);
    }
    d.mean_abs = gaps / (double)n;
    d.l1 = all > 0.0 ? gaps / all : (double)NAN;
    d.emd_x = carry(of_a.x, of_a.mass, of_b.x, of_b.mass, n1, grid->d1);
    d.emd_y = carry(of_a.y, of_a.mass, of_b.y, of_b.mass, n2, grid->d2);
    memory_free(sums);
    *ret_distance = d;
    return BF_OK;
}

bool compare_is_same_grid(const bf_grid *a, const bf_grid *b)
{
    const double near = 1e-9 * (a->d1 + a->d2);

    return a->n1 == b->n1 && a->n2 == b->n2 && fabs(a->lower1 - b->lower1) <= near &&
           fabs(a->lower2 - b->lower2) <= near && fabs(a->d1 - b->d1) * (double)a->n1 <= near &&
           fabs(a->d2 - b->d2) * (double)a->n2 <= near;
}

static double time_at(const compare_times *times, size_t k)
{
    double t;

    memcpy(&t, (const char *)times->first + k * times->stride, sizeof t);
    return t;
}

bool compare_next_common(const compare_times *a, const compare_times *b, size_t *i, size_t *k)
{
    while (*i < a->n && *k < b->n) {
        const double t_a = time_at(a, *i), t_b = time_at(b, *k);
        if (fabs(t_a - t_b) <= 1e-9 * (1.0 + fabs(t_a)))
            return true;
        if (t_a < t_b)
            (*i)++;
        else
            (*k)++;
    }
    return false;
}

size_t compare_count_common(const compare_times *a, const compare_times *b)
{
    size_t n = 0;

    for (size_t i = 0, k = 0; compare_next_common(a, b, &i, &k); i++, k++)
        n++;
    return n;
}

static void add_known(double value, double *sum, size_t *n)
{
    if (isfinite(value)) {
        *sum += value;
        (*n)++;
    }
}

void compare_mean_add(compare_mean *mean, const compare_distance *d)
{
    add_known(d->mean_abs, &mean->sum.mean_abs, &mean->n_mean_abs);
    add_known(d->l1, &mean->sum.l1, &mean->n_l1);
    add_known(d->emd_x, &mean->sum.emd_x, &mean->n_emd_x);
    add_known(d->emd_y, &mean->sum.emd_y, &mean->n_emd_y);
}

compare_distance compare_mean_of(const compare_mean *mean)
{
    return (compare_distance){ .mean_abs = mean->sum.mean_abs / (double)mean->n_mean_abs,
                               .l1 = mean->sum.l1 / (double)mean->n_l1,
                               .emd_x = mean->sum.emd_x / (double)mean->n_emd_x,
                               .emd_y = mean->sum.emd_y / (double)mean->n_emd_y };
}
