#include "core/study/search.h"

#include "core/base/memory.h"

#include <nlopt.h>

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

// Stands for an unknown value; finite, so that the algorithms take it for one.
static const double far_value = 1e30;

// One run of the algorithm, over what is known.
typedef struct replay {
    const search_known *known;
    size_t at;            // where the next point asked for is expected among the known ones
    nlopt_opt optimizer;  // to be stopped
    double unknown_value; // what is answered for points that are not known
    double *points;       // those, in the order in which they were asked for
    size_t n;             // how many there are
    size_t n_room;        // how many are wanted
} replay;

static bool is_same(const double *a, const double *b, size_t d)
{
    for (size_t k = 0; k < d; k++)
        if (a[k] != b[k])
            return false;
    return true;
}

// Index of a point in a list, tried first at *at; n if it is not there.
static size_t find(const double *points, size_t n, size_t d, const double *point, size_t at)
{
    if (at < n && is_same(points + at * d, point, d))
        return at;
    for (size_t k = 0; k < n; k++)
        if (is_same(points + k * d, point, d))
            return k;
    return n;
}

static double evaluate(unsigned n_parameters, const double *point, double *gradient, void *data)
{
    replay *r = data;
    const size_t d = n_parameters;
    (void)gradient;

    const size_t k = find(r->known->points, r->known->n, d, point, r->at);
    if (k < r->known->n) {
        r->at = k + 1;
        return r->known->values[k];
    }
    if (find(r->points, r->n, d, point, 0) < r->n)
        return r->unknown_value;
    if (r->n == r->n_room) {
        nlopt_force_stop(r->optimizer);
        return r->unknown_value;
    }
    memcpy(r->points + r->n++ * d, point, d * sizeof *point);
    return r->unknown_value;
}

static bool set_up(const search *s, const search_known *known, nlopt_opt o, replay *r)
{
    // Points that are asked for again count for NLopt; the limit that holds is that of points to evaluate.
    const size_t n_asked = 4 * (s->n_max + known->n) + 100;

    return nlopt_set_min_objective(o, evaluate, r) == NLOPT_SUCCESS &&
           nlopt_set_lower_bounds1(o, 0.0) == NLOPT_SUCCESS &&
           nlopt_set_upper_bounds1(o, 1.0) == NLOPT_SUCCESS &&
           nlopt_set_maxeval(o, (int)n_asked) == NLOPT_SUCCESS &&
           (s->algorithm == SEARCH_GLOBAL ||
            (nlopt_set_xtol_abs1(o, s->tolerance) == NLOPT_SUCCESS &&
             nlopt_set_initial_step1(o, s->step) == NLOPT_SUCCESS));
}

// Fill *ret_points with what is asked for, up to n_room points, if unknown values are `value`.
static bf_status run(const search *s, const search_known *known, double value, size_t n_room,
                     double *ret_points, size_t *ret_n, bf_error *err)
{
    const nlopt_algorithm algorithm =
        s->algorithm == SEARCH_GLOBAL ? NLOPT_GN_DIRECT_L : NLOPT_LN_SBPLX;
    nlopt_opt o = nlopt_create(algorithm, (unsigned)s->d);
    double *x = memory_alloc(s->d, sizeof *x);
    replay r = { .known = known,
                 .optimizer = o,
                 .unknown_value = value,
                 .points = ret_points,
                 .n_room = n_room };
    nlopt_result result = NLOPT_OUT_OF_MEMORY;

    if (o != NULL && x != NULL && set_up(s, known, o, &r)) {
        double least;
        if (s->start != NULL)
            memcpy(x, s->start, s->d * sizeof *x);
        result = nlopt_optimize(o, x, &least);
    }
    nlopt_destroy(o);
    memory_free(x);
    if (result == NLOPT_OUT_OF_MEMORY)
        return bf_fail_memory(err);
    *ret_n = r.n;
    return BF_OK;
}

bf_status search_next(const search *s, const search_known *known, size_t n_begun, size_t n_room,
                      double *ret_points, size_t *ret_n, bf_error *err)
{
    const size_t n_left = s->n_max > n_begun ? s->n_max - n_begun : 0;
    const size_t n_wanted = n_left < n_room ? n_left : n_room;
    size_t n_low, n_high, n = 0;
    bf_status status;

    if (n_wanted == 0) {
        *ret_n = 0;
        return BF_OK;
    }
    double *other = memory_alloc(n_wanted, s->d * sizeof *other);
    if (other == NULL)
        return bf_fail_memory(err);
    if ((status = run(s, known, -far_value, n_wanted, ret_points, &n_low, err)) == BF_OK &&
        (status = run(s, known, far_value, n_wanted, other, &n_high, err)) == BF_OK) {
        const size_t n_both = n_low < n_high ? n_low : n_high;
        while (n < n_both && is_same(ret_points + n * s->d, other + n * s->d, s->d))
            n++;
        *ret_n = n;
    }
    memory_free(other);
    return status;
}
