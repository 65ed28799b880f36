// The rounds of the methods. Each adds the points and trials of its next round.

#include "core/study/study_priv.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "core/study/search.h"
#include "core/study/selection.h"
#include "core/study/sweep.h"

#include <math.h>
#include <string.h>

enum { SEARCH_ROUND = 32 }; // points that a search evaluates at a time, at most

static const double local_step = 0.1; // of the cube, with which subplex begins

size_t study_sweep_points(const study_definition *definition, study_method sweep)
{
    return sweep == STUDY_GRID ? sweep_grid_points(definition->steps, definition->d)
                               : definition->n_points;
}

static void sweep_points(const study_definition *def, study_method sweep, size_t n,
                         double *ret_points)
{
    const size_t d = def->d;

    if (sweep == STUDY_LHS) {
        sweep_lhs(def->seed, n, d, ret_points);
        return;
    }
    for (size_t k = 0; k < n; k++) {
        double *point = ret_points + k * d;
        if (sweep == STUDY_GRID)
            sweep_grid(def->steps, d, k, point);
        else if (sweep == STUDY_SOBOL)
            sweep_sobol(def->seed, k, d, point);
        else
            // The k-th of n values of every parameter.
            for (size_t i = 0; i < d; i++)
                sweep_grid(&n, 1, k, point + i);
    }
}

bf_status study_sweep(study *s, study_method sweep, study_model model, size_t n_replications,
                      bf_error *err)
{
    const size_t n = study_sweep_points(&s->definition, sweep), d = s->definition.d;
    double *points = memory_alloc(n, d * sizeof *points);
    bf_status status =
        points == NULL ? bf_fail_memory(err) : study_reserve(s, n, n * n_replications, err);

    if (status == BF_OK) {
        sweep_points(&s->definition, sweep, n, points);
        for (size_t k = 0; k < n; k++)
            study_add_trials(s, study_add_point(s, points + k * d, model), n_replications);
    }
    memory_free(points);
    return status;
}

// Add n points with the replications of the definition; there being none, the study has ended.
static bf_status add_points(study *s, const double *points, size_t n, bf_error *err)
{
    const size_t n_replications = s->definition.n_replications;
    bf_status status = study_reserve(s, n, n * n_replications, err);

    if (status != BF_OK)
        return status;
    for (size_t k = 0; k < n; k++)
        study_add_trials(s, study_add_point(s, points + k * s->definition.d, STUDY_AS_SUBMITTED),
                         n_replications);
    s->is_ended = n == 0;
    return BF_OK;
}

size_t study_least(const double *costs, size_t n)
{
    size_t best = 0;

    for (size_t k = 1; k < n; k++)
        if (costs[k] < costs[best])
            best = k;
    return best;
}

// The next points by subplex from the best one of the first stage.
static bf_status search_local(const study *s, size_t n_max, double *ret_points, size_t *ret_n,
                              bf_error *err)
{
    const size_t best = study_least(s->costs, s->n_first_stage);
    double start[STUDY_PARAMETERS];

    memcpy(start, s->at + best * s->definition.d, s->definition.d * sizeof *start);
    const search local = { .algorithm = SEARCH_LOCAL,
                           .d = s->definition.d,
                           .n_max = n_max - s->n_first_stage,
                           .start = start,
                           .step = local_step,
                           .tolerance = s->definition.tolerance };
    return search_next(&local, &(search_known){ s->n_points, s->at, s->costs },
                       s->n_points - s->n_first_stage, SEARCH_ROUND, ret_points, ret_n, err);
}

bf_status study_search(study *s, bf_error *err)
{
    const study_definition *def = &s->definition;
    const size_t n_all = def->n_trials_max / def->n_replications;
    const size_t n_max = n_all < STUDY_SEARCH_MAX ? n_all : STUDY_SEARCH_MAX;
    const search global = { .algorithm = SEARCH_GLOBAL, .d = def->d, .n_max = (n_max + 1) / 2 };
    double points[SEARCH_ROUND * STUDY_PARAMETERS];
    size_t n = 0;
    bf_status status;

    if (s->n_first_stage == 0) {
        status = search_next(&global, &(search_known){ s->n_points, s->at, s->costs }, s->n_points,
                             SEARCH_ROUND, points, &n, err);
        if (status != BF_OK || n > 0)
            return status == BF_OK ? add_points(s, points, n, err) : status;
        s->n_first_stage = s->n_points;
    }
    status = search_local(s, n_max, points, &n, err);
    return status == BF_OK ? add_points(s, points, n, err) : status;
}

bf_status study_evolve(study *s, bf_error *err)
{
    const study_definition *def = &s->definition;
    const size_t lambda = cmaes_population(def->d);
    double points[CMAES_POPULATION * CMAES_DIMENSIONS];
    cmaes next = s->evolution;

    if (s->n_points > 0)
        cmaes_update(&next, s->costs + s->n_points - lambda);
    const bool is_over = study_points_left(s, def->n_replications) < lambda ||
                         cmaes_is_converged(&next, def->tolerance);
    cmaes_points(&next, points);
    bf_status status = add_points(s, points, is_over ? 0 : lambda, err);
    if (status == BF_OK)
        s->evolution = next;
    return status;
}

// Begin to confirm the n best points of the sweep.
static bf_status confirm(study *s, bf_error *err)
{
    const study_definition *def = &s->definition;
    const size_t n_left = study_points_left(s, def->n_replications);
    const size_t n = def->n_confirmed < n_left ? def->n_confirmed : n_left;
    bf_status status = study_reserve(s, n, n * def->n_replications, err);

    if (status != BF_OK)
        return status;
    s->n_first_stage = s->n_points;
    for (size_t k = 0; k < n; k++) {
        const size_t best = study_least(s->costs, s->n_first_stage);
        if (isinf(s->costs[best]))
            break;
        s->costs[best] = (double)INFINITY; // made anew with the next round
        const size_t point = study_add_point(s, s->at + best * def->d, STUDY_MICRO);
        s->points[point].confirmed = best;
        study_add_trials(s, point, def->n_replications);
    }
    s->is_ended = s->n_points == s->n_first_stage;
    return BF_OK;
}

// Drop points, and add a replication of each that is left.
static bf_status select_best(study *s, double *costs, bool *is_left, size_t n, bf_error *err)
{
    const study_definition *def = &s->definition;
    const selection choice = { .k = s->n_points - s->n_first_stage,
                               .n_first = def->n_replications,
                               .confidence = def->confidence,
                               .indifference = def->indifference };
    size_t n_left = 0;

    // The costs of the k points that are confirmed, replication by replication; those of points that a trial failed for are
    // dropped.
    const double sign = s->definition.is_maximized ? -1.0 : 1.0;
    for (size_t k = 0; k < s->n_points - s->n_first_stage; k++) {
        study_point_record *p = &s->points[s->n_first_stage + k];
        p->is_dropped = p->is_dropped || isinf(s->costs[s->n_first_stage + k]);
        is_left[k] = !p->is_dropped;
        size_t r = 0;
        for (size_t t = p->first_trial; t != SIZE_MAX && r < n; t = s->trials[t].next)
            costs[k * n + r++] = sign * study_values(s, t)[0];
    }
    const bool is_over = selection_drop(&choice, &(selection_known){ costs, n, n }, is_left);
    for (size_t k = 0; k < choice.k; k++)
        n_left += is_left[k];
    const bool is_cut = n_left > study_points_left(s, 1);
    bf_status status = study_reserve(s, 0, n_left, err);
    if (status != BF_OK)
        return status;
    for (size_t k = 0; k < choice.k; k++) {
        s->points[s->n_first_stage + k].is_dropped = !is_left[k];
        if (is_left[k] && !is_over && !is_cut)
            study_add_trials(s, s->n_first_stage + k, 1);
    }
    s->is_ended = is_over || is_cut;
    s->is_decided = is_over && n_left > 0;
    return BF_OK;
}

bf_status study_screen(study *s, bf_error *err)
{
    if (s->n_points == 0)
        return study_sweep(s, s->definition.sweep, STUDY_MACRO, 1, err);
    if (s->n_first_stage == 0)
        return confirm(s, err);
    if (!s->definition.has_chance) { // another run of a point would be the same one
        s->is_ended = true;
        s->is_decided = study_best(s) != SIZE_MAX && study_best(s) >= s->n_first_stage;
        return BF_OK;
    }
    size_t n = 0;
    for (size_t point = s->n_first_stage; point < s->n_points; point++)
        if (s->points[point].n_trials > n)
            n = s->points[point].n_trials;
    const size_t k = s->n_points - s->n_first_stage;
    double *costs = memory_alloc(k * n, sizeof *costs);
    bool *is_left = memory_alloc(k, sizeof *is_left);
    bf_status status = costs == NULL || is_left == NULL ? bf_fail_memory(err)
                                                        : select_best(s, costs, is_left, n, err);
    memory_free(costs);
    memory_free(is_left);
    return status;
}
