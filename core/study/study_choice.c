#include "core/study/study_choice.h"

#include "core/base/memory.h"
#include "core/base/statistics.h"
#include "core/study/study_priv.h"
#include "core/study/subset.h"

#include <math.h>
#include <string.h>

static const double confidence_of_second = 0.95;

// The points that are compared, and what is known of them.
typedef struct candidates {
    size_t n;
    size_t *points;
    subset_system *systems; // of each; less is better
    bool *are_in;           // of each
    double *values;         // of all replications
} candidates;

bool study_has_chance(const study *s, size_t point)
{
    return s->definition.has_chance && s->points[point].model != STUDY_MACRO;
}

// The model whose points are compared: of a screening the microscopic one as soon as it has said something.
static size_t first_compared(const study *s)
{
    if (s->definition.method != STUDY_SCREEN || s->n_first_stage == 0)
        return 0;
    for (size_t point = s->n_first_stage; point < s->n_points; point++)
        if (isfinite(study_cost(s, point)))
            return s->n_first_stage;
    return 0;
}

static size_t end_compared(const study *s, size_t first)
{
    return s->definition.method == STUDY_SCREEN && first == 0 && s->n_first_stage > 0
               ? s->n_first_stage
               : s->n_points;
}

static bf_status make_candidates(const study *s, candidates *ret_c, bf_error *err)
{
    candidates c = { .points = memory_alloc(s->n_points, sizeof *c.points),
                     .systems = memory_alloc(s->n_points, sizeof *c.systems),
                     .are_in = memory_alloc(s->n_points, sizeof *c.are_in),
                     .values = memory_alloc(s->n_trials, sizeof *c.values) };
    const double sign = s->definition.is_maximized ? -1.0 : 1.0;
    const size_t first = first_compared(s);
    size_t n_values = 0;

    *ret_c = c;
    if (c.points == NULL || c.systems == NULL || c.are_in == NULL || c.values == NULL)
        return bf_fail_memory(err);
    for (size_t point = first; point < end_compared(s, first); point++) {
        if (isinf(study_cost(s, point)))
            continue;
        const size_t start = n_values;
        for (size_t t = s->points[point].first_trial; t != SIZE_MAX; t = s->trials[t].next)
            c.values[n_values++] = sign * study_values(s, t)[0];
        c.systems[c.n] = (subset_system){ c.values + start, n_values - start };
        c.points[c.n++] = point;
    }
    *ret_c = c;
    return BF_OK;
}

static bool is_known(const study *s, const candidates *c)
{
    bool is = s->definition.method <= STUDY_SOBOL || s->definition.method == STUDY_SCREEN;

    for (size_t k = 0; k < c->n; k++)
        is = is && (c->systems[k].n >= 2 || !study_has_chance(s, c->points[k]));
    return is;
}

// Take those out of the set whose second value is worse.
static void drop_second_worse(const study *s, candidates *c)
{
    const double sign = s->definition.is_second_maximized ? -1.0 : 1.0;
    double least = (double)INFINITY, width = 0.0;

    if (s->definition.n_values < 2)
        return;
    for (size_t k = 0; k < c->n; k++) {
        const statistics_sample sample = study_sample(s, c->points[k], 1);
        if (!c->are_in[k] || sample.n == 0 || sign * sample.mean >= least)
            continue;
        least = sign * sample.mean;
        const double half = statistics_half_width(&sample, confidence_of_second);
        width = fmax(CHOICE_RELATIVE * fabs(least), isfinite(half) ? half : 0.0);
    }
    for (size_t k = 0; k < c->n && isfinite(least); k++) {
        const statistics_sample sample = study_sample(s, c->points[k], 1);
        c->are_in[k] = c->are_in[k] && sample.n > 0 && sign * sample.mean <= least + width;
    }
}

// The point nearest to the mean of those that are left.
static size_t middle_of(const study *s, const candidates *c)
{
    const size_t d = s->definition.d;
    double middle[STUDY_PARAMETERS] = { 0 }, least = (double)INFINITY;
    size_t n = 0, best = SIZE_MAX;

    for (size_t k = 0; k < c->n; k++) {
        n += c->are_in[k];
        for (size_t i = 0; i < d; i++)
            middle[i] += c->are_in[k] ? s->at[c->points[k] * d + i] : 0.0;
    }
    for (size_t k = 0; k < c->n; k++) {
        double square = 0.0;
        for (size_t i = 0; i < d; i++) {
            const double x = s->at[c->points[k] * d + i] - middle[i] / (double)n;
            square += x * x;
        }
        if (c->are_in[k] && square < least - 1e-12) {
            least = square;
            best = c->points[k];
        }
    }
    return best;
}

static void choose(const study *s, candidates *c, bool *ret_is_in, study_choice *choice)
{
    double least = (double)INFINITY;

    for (size_t k = 0; k < c->n; k++) {
        const double cost = study_cost(s, c->points[k]);
        if (cost < least) {
            least = cost;
            choice->best = c->points[k];
        }
    }
    const double given = s->definition.indifference;
    choice->indifference = given > 0.0 ? given : CHOICE_RELATIVE * fabs(least);
    choice->is_known = c->n > 0 && is_known(s, c);
    if (!choice->is_known)
        return;
    const subset question = { c->n, s->definition.confidence, choice->indifference };
    (void)subset_find(&question, c->systems, c->are_in);
    for (size_t k = 0; k < c->n; k++) {
        ret_is_in[c->points[k]] = c->are_in[k];
        choice->n_set += c->are_in[k];
    }
    drop_second_worse(s, c);
    choice->best = middle_of(s, c);
}

// Whether a point meets the demand, with as much confidence as all k together need.
static bool meets(const study *s, size_t point, size_t k, bool is_known)
{
    const statistics_sample sample = study_sample(s, point, 0);
    const double tail = (1.0 - s->definition.confidence) / (double)k;
    double width = 0.0;

    if (is_known && study_has_chance(s, point))
        width = statistics_student(tail, (double)(sample.n - 1)) * statistics_deviation(&sample) /
                sqrt((double)sample.n);
    return sample.mean - width >= s->definition.demand;
}

static void choose_least(const study *s, candidates *c, bool *ret_is_in, study_choice *choice)
{
    double least = (double)INFINITY, cost = (double)INFINITY;

    choice->is_known = c->n > 0 && is_known(s, c);
    for (size_t k = 0; k < c->n; k++) {
        const size_t point = c->points[k];
        const bool is_met = meets(s, point, c->n, choice->is_known);
        const double at = is_met ? s->at[point * s->definition.d] : (double)INFINITY;
        if (at < least || (at <= least && study_cost(s, point) < cost)) {
            least = at;
            cost = study_cost(s, point);
            choice->best = point;
            choice->is_met = is_met;
        }
        ret_is_in[point] = is_met && choice->is_known;
        choice->n_set += ret_is_in[point];
    }
}

bf_status study_choose(const study *s, bool *ret_is_in, study_choice *ret_choice, bf_error *err)
{
    const size_t first = first_compared(s);
    study_choice choice = { .best = SIZE_MAX, .first = first, .end = end_compared(s, first) };
    candidates c = { 0 };

    memset(ret_is_in, 0, s->n_points * sizeof *ret_is_in);
    if (s->definition.method == STUDY_CALIBRATE || s->n_points == 0) {
        choice.best = study_best(s);
        *ret_choice = choice;
        return BF_OK;
    }
    bf_status status = make_candidates(s, &c, err);
    if (status == BF_OK) {
        (s->definition.has_demand ? choose_least : choose)(s, &c, ret_is_in, &choice);
        choice.n_candidates = c.n;
        *ret_choice = choice;
    }
    memory_free(c.points);
    memory_free(c.systems);
    memory_free(c.are_in);
    memory_free(c.values);
    return status;
}
