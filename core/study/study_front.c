#include "core/study/study_front.h"

#include "core/base/memory.h"
#include "core/study/study_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// A point and what it costs: less is better. At first in the units of the values, then in whole steps above the least.
typedef struct candidate {
    size_t point;
    bool is_other; // than the one that the choice names
    double costs[2];
} candidate;

static double cost_of(const study *s, size_t point, size_t value, bool is_maximized)
{
    const statistics_sample sample = study_sample(s, point, value);

    if (sample.n == 0 || sample.n < s->points[point].n_trials)
        return (double)INFINITY;
    return is_maximized ? -sample.mean : sample.mean;
}

// Steps that are not given are CHOICE_RELATIVE of the least value.
static void round_down(candidate *candidates, size_t n, size_t value, double step)
{
    double least = (double)INFINITY;

    for (size_t k = 0; k < n; k++)
        least = fmin(least, candidates[k].costs[value]);
    const double unit = step > 0.0 ? step : CHOICE_RELATIVE * fabs(least);
    for (size_t k = 0; k < n && unit > 0.0; k++)
        candidates[k].costs[value] = floor((candidates[k].costs[value] - least) / unit);
}

static int compare(const void *x, const void *y)
{
    const candidate *a = x, *b = y;

    for (size_t value = 0; value < 2; value++)
        if (a->costs[value] != b->costs[value])
            return a->costs[value] < b->costs[value] ? -1 : 1;
    if (a->is_other != b->is_other)
        return a->is_other ? 1 : -1;
    return a->point < b->point ? -1 : 1;
}

bf_status study_front(const study *s, const study_choice *choice, bool *ret_is_on, size_t *ret_n,
                      bf_error *err)
{
    const study_definition *d = &s->definition;
    candidate *candidates = memory_alloc(choice->end - choice->first + 1, sizeof *candidates);
    size_t n = 0;

    if (candidates == NULL)
        return bf_fail_memory(err);
    memset(ret_is_on, 0, s->n_points * sizeof *ret_is_on);
    *ret_n = 0;
    for (size_t point = choice->first; point < choice->end; point++) {
        const candidate c = { point,
                              point != choice->best,
                              { cost_of(s, point, 0, d->is_maximized),
                                cost_of(s, point, 1, d->is_second_maximized) } };
        if (isfinite(c.costs[0]) && isfinite(c.costs[1]))
            candidates[n++] = c;
    }
    round_down(candidates, n, 0, d->indifference);
    round_down(candidates, n, 1, (double)NAN);
    qsort(candidates, n, sizeof *candidates, compare);
    // In the order of the first value a point is on the front if its second one is less than that of all before it.
    double least = (double)INFINITY;
    for (size_t k = 0; k < n; k++) {
        if (candidates[k].costs[1] >= least)
            continue;
        least = candidates[k].costs[1];
        ret_is_on[candidates[k].point] = true;
        (*ret_n)++;
    }
    memory_free(candidates);
    return BF_OK;
}
