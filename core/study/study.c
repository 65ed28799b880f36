#include "core/study/study_priv.h"

#include "core/base/check.h"
#include "core/base/memory.h"

#include <math.h>
#include <string.h>

size_t study_first_trials(const study_definition *d)
{
    if (d->method == STUDY_DIRECT)
        return d->n_replications;
    if (d->method == STUDY_CMAES)
        return cmaes_population(d->d) * d->n_replications;
    const bool is_screen = d->method == STUDY_SCREEN;
    const size_t n_points = study_sweep_points(d, is_screen ? d->sweep : d->method);
    const size_t n_each = is_screen ? 1 : d->n_replications;
    return n_points > SIZE_MAX / n_each ? SIZE_MAX : n_points * n_each;
}

bf_status study_create(const study_definition *definition, study **ret_study, bf_error *err)
{
    const study_definition *d = definition;

    BF_CHECK((d->d >= 1 || d->method == STUDY_LIST) && d->d <= STUDY_PARAMETERS &&
             d->n_values >= 1 && d->n_values <= STUDY_VALUES && d->n_replications >= 1);
    if (d->n_trials_max > STUDY_TRIALS_MAX || study_first_trials(d) > d->n_trials_max)
        return bf_fail(err, BF_ELIMIT, "",
                       "the study begins with more than its %zu trials; at most %d are allowed",
                       d->n_trials_max, STUDY_TRIALS_MAX);
    study *s = memory_alloc(1, sizeof *s);
    if (s == NULL)
        return bf_fail_memory(err);
    s->definition = *d;
    if (d->method == STUDY_CMAES)
        s->evolution = cmaes_begin(d->seed, d->d);
    *ret_study = s;
    return BF_OK;
}

study *study_destroy(study *s)
{
    if (s != NULL) {
        memory_free(s->at);
        memory_free(s->costs);
        memory_free(s->points);
        memory_free(s->trials);
        memory_free(s->values);
        memory_free(s->calibration);
    }
    memory_free(s);
    return NULL;
}

static size_t grown(size_t room, size_t n)
{
    return n <= room ? 0 : n + room / 2;
}

bf_status study_reserve(study *s, size_t n_points, size_t n_trials, bf_error *err)
{
    const size_t points = grown(s->room_points, s->n_points + n_points);
    const size_t trials = grown(s->room_trials, s->n_trials + n_trials);
    const memory_array arrays[] = {
        { &s->at, s->definition.d * sizeof *s->at, s->n_points, points },
        { &s->costs, sizeof *s->costs, s->n_points, points },
        { &s->points, sizeof *s->points, s->n_points, points },
        { &s->trials, sizeof *s->trials, s->n_trials, trials },
        { &s->values, s->definition.n_values * sizeof *s->values, s->n_trials, trials },
    };

    if (memory_resize(arrays, sizeof arrays / sizeof *arrays) != 0)
        return bf_fail_memory(err);
    s->room_points = points > 0 ? points : s->room_points;
    s->room_trials = trials > 0 ? trials : s->room_trials;
    return BF_OK;
}

size_t study_add_point(study *s, const double *at, study_model model)
{
    const size_t point = s->n_points++;

    memcpy(s->at + point * s->definition.d, at, s->definition.d * sizeof *at);
    s->points[point] = (study_point_record){
        .model = model, .first_trial = SIZE_MAX, .last_trial = SIZE_MAX, .confirmed = SIZE_MAX
    };
    return point;
}

void study_add_trials(study *s, size_t point, size_t n)
{
    study_point_record *p = &s->points[point];

    for (size_t k = 0; k < n; k++) {
        const size_t trial = s->n_trials++;
        s->trials[trial] =
            (study_trial_record){ .trial = { .point = point, .substream = (uint32_t)p->n_trials++ },
                                  .next = SIZE_MAX };
        for (size_t v = 0; v < s->definition.n_values; v++)
            s->values[trial * s->definition.n_values + v] = (double)NAN;
        if (p->first_trial == SIZE_MAX)
            p->first_trial = trial;
        else
            s->trials[p->last_trial].next = trial;
        p->last_trial = trial;
    }
}

double study_cost(const study *s, size_t point)
{
    const study_definition *d = &s->definition;
    const size_t n_values = d->method == STUDY_CALIBRATE ? d->n_values : 1;
    double sum = 0.0;

    for (size_t v = 0; v < n_values; v++) {
        const statistics_sample sample = study_sample(s, point, v);
        if (sample.n < s->points[point].n_trials || sample.n == 0)
            return (double)INFINITY;
        sum += sample.mean;
    }
    return (d->is_maximized ? -sum : sum) / (double)n_values;
}

size_t study_points_left(const study *s, size_t n_replications)
{
    const size_t n_max = s->definition.n_trials_max;

    return s->n_trials >= n_max ? 0 : (n_max - s->n_trials) / n_replications;
}

bf_status study_advance(study *s, bf_error *err)
{
    const study_definition *d = &s->definition;

    BF_CHECK(s->n_told == s->n_trials);
    for (size_t point = 0; point < s->n_points; point++)
        s->costs[point] = study_cost(s, point);
    if (s->is_ended)
        return BF_OK;
    switch (d->method) {
    case STUDY_DIRECT:
        return study_search(s, err);
    case STUDY_CMAES:
        return study_evolve(s, err);
    case STUDY_SCREEN:
        return study_screen(s, err);
    case STUDY_CALIBRATE:
        return study_calibrate(s, err);
    default:
        s->is_ended = s->n_points > 0;
        return s->is_ended ? BF_OK
                           : study_sweep(s, d->method, STUDY_AS_SUBMITTED, d->n_replications, err);
    }
}

void study_tell(study *s, size_t trial, const double *values)
{
    BF_CHECK(trial < s->n_trials && !s->trials[trial].trial.is_told);
    memcpy(s->values + trial * s->definition.n_values, values,
           s->definition.n_values * sizeof *values);
    s->trials[trial].trial.is_told = true;
    s->n_told++;
}

size_t study_trials(const study *s)
{
    return s->n_trials;
}

size_t study_points(const study *s)
{
    return s->n_points;
}

study_trial study_trial_at(const study *s, size_t trial)
{
    BF_CHECK(trial < s->n_trials);
    return s->trials[trial].trial;
}

study_point study_point_at(const study *s, size_t point)
{
    BF_CHECK(point < s->n_points);
    const study_point_record *p = &s->points[point];
    return (study_point){ .at = s->at + point * s->definition.d,
                          .model = p->model,
                          .first_trial = p->first_trial,
                          .n_trials = p->n_trials,
                          .confirmed = p->confirmed,
                          .is_dropped = p->is_dropped };
}

const double *study_values(const study *s, size_t trial)
{
    BF_CHECK(trial < s->n_trials);
    return s->values + trial * s->definition.n_values;
}

statistics_sample study_sample(const study *s, size_t point, size_t value)
{
    statistics_sample sample = { 0 };

    for (size_t k = s->points[point].first_trial; k != SIZE_MAX; k = s->trials[k].next) {
        const double x = study_values(s, k)[value];
        if (isfinite(x))
            statistics_add(&sample, x);
    }
    return sample;
}

static size_t best_between(const study *s, size_t first, size_t end)
{
    double least = (double)INFINITY;
    size_t best = SIZE_MAX;

    for (size_t point = first; point < end; point++) {
        const double cost = study_cost(s, point);
        if (!s->points[point].is_dropped && cost < least) {
            least = cost;
            best = point;
        }
    }
    return best;
}

size_t study_best(const study *s)
{
    const size_t n_sweep = s->definition.method == STUDY_SCREEN ? s->n_first_stage : 0;
    const size_t best = best_between(s, n_sweep, s->n_points);

    return best == SIZE_MAX ? best_between(s, 0, n_sweep) : best;
}

bool study_is_ended(const study *s)
{
    return s->is_ended;
}

bool study_is_decided(const study *s)
{
    return s->is_decided;
}
