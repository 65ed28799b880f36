#include "core/study/study_front.h"

#include "core/study/study_priv.h"

#include <math.h>
#include <string.h>

typedef struct costs {
    double first, second; // less is better; INFINITY: not known
} costs;

static double cost_of(const study *s, size_t point, size_t value, bool is_maximized)
{
    const statistics_sample sample = study_sample(s, point, value);

    if (sample.n == 0 || sample.n < s->places[point].n_trials)
        return (double)INFINITY;
    return is_maximized ? -sample.mean : sample.mean;
}

static costs costs_of(const study *s, size_t point)
{
    return (costs){ cost_of(s, point, 0, s->definition.is_maximized),
                    cost_of(s, point, 1, s->definition.is_second_maximized) };
}

static bool is_better(costs a, costs b)
{
    return a.first <= b.first && a.second <= b.second && (a.first < b.first || a.second < b.second);
}

size_t study_front(const study *s, const study_choice *choice, bool *ret_is_on)
{
    size_t n = 0;

    memset(ret_is_on, 0, s->n_points * sizeof *ret_is_on);
    for (size_t point = choice->first; point < choice->end; point++) {
        const costs own = costs_of(s, point);
        bool is_on = isfinite(own.first) && isfinite(own.second);
        for (size_t other = choice->first; other < choice->end && is_on; other++)
            is_on = !is_better(costs_of(s, other), own);
        ret_is_on[point] = is_on;
        n += is_on;
    }
    return n;
}
