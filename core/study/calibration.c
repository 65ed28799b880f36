#include "core/study/calibration.h"

#include "core/base/memory.h"
#include "core/study/search.h"
#include "core/study/study_priv.h"

#include <math.h>
#include <string.h>

enum {
    STAGES = 4,
    PLACES =
        1 + CALIBRATION_PLACES, // of a profile on each side; the first one is next to the answer
    NONE = -1,                  // no curve is left out, no parameter is held
    FITS_MAX = CALIBRATION_STARTS + STUDY_VALUES + 2 * PLACES * STUDY_PARAMETERS,
    ROUND_MAX = 2 * STUDY_PARAMETERS, // points that a search evaluates at a time
};

// How far the other places of a profile are on the way to the end of the range.
static const double ways[CALIBRATION_PLACES] = { 0.125, 0.5, 1.0 };

// First lengths of subplex: from a point of the first stage, and from the answer.
static const double far_step = 0.1, near_step = 0.03;

// A profile needs less precision than the answer.
static const double profile_tolerance = 0.01;

static const double rounding_variance = 1.0 / 12.0;

// A subplex search.
typedef struct calibration_fit {
    int left_out;                   // curve, or NONE
    int held;                       // parameter, or NONE; it stays at its start
    double start[STUDY_PARAMETERS]; // in the cube
    double step;                    // first length
    size_t n_max;                   // points
    size_t n_asked;                 // points until now
    bool is_over;
} calibration_fit;

// The stages begin with 1; the searches are those of the present one.
struct calibration {
    int stage;
    size_t answer; // the best point when stage 2 ended
    size_t n;
    calibration_fit fits[FITS_MAX];
};

// The mean of mse_j over all curves but one. INFINITY where a trial has none.
static double cost_without(const study *s, size_t point, int left_out)
{
    const size_t n_values = s->definition.n_values;

    if (left_out == NONE || isinf(s->costs[point]))
        return s->costs[point];
    const double all = s->costs[point] * (double)n_values;
    return (all - study_sample(s, point, (size_t)left_out).mean) / (double)(n_values - 1);
}

static size_t best_without(const study *s, int left_out)
{
    double least = (double)INFINITY;
    size_t best = SIZE_MAX;

    for (size_t point = 0; point < s->n_points; point++) {
        const double cost = cost_without(s, point, left_out);
        if (cost < least) {
            least = cost;
            best = point;
        }
    }
    return best;
}

// Copy a point without the parameter that is held.
static void leave_held(const double *point, size_t d, int held, double *ret_point)
{
    for (size_t i = 0, k = 0; i < d; i++)
        if ((int)i != held)
            ret_point[k++] = point[i];
}

// The next points of a search, in all parameters; *ret_n is 0 when it is over.
static bf_status ask(const study *s, const calibration_fit *fit, double *scratch,
                     double *ret_points, size_t *ret_n, bf_error *err)
{
    const size_t d = s->definition.d, d_own = fit->held == NONE ? d : d - 1;
    double start[STUDY_PARAMETERS], own[ROUND_MAX * STUDY_PARAMETERS];
    double *points = scratch, *values = scratch + s->n_points * d;
    size_t n = 0;
    bf_status status;

    // What the search knows, in its own parameters: points at the value that is held.
    for (size_t point = 0; point < s->n_points; point++) {
        const double *at = s->at + point * d;
        if (fit->held != NONE && at[fit->held] != fit->start[fit->held])
            continue;
        leave_held(at, d, fit->held, points + n * d_own);
        values[n++] = cost_without(s, point, fit->left_out);
    }
    if (d_own == 0) {
        *ret_n = n == 0;
        ret_points[0] = fit->start[0];
        return BF_OK;
    }
    leave_held(fit->start, d, fit->held, start);
    status = search_next(
        &(search){ .algorithm = SEARCH_LOCAL,
                   .d = d_own,
                   .n_max = fit->n_max,
                   .start = start,
                   .step = fit->step,
                   .tolerance = fit->held == NONE ? s->definition.tolerance : profile_tolerance },
        &(search_known){ n, points, values }, fit->n_asked, ROUND_MAX, own, ret_n, err);
    for (size_t k = 0; status == BF_OK && k < *ret_n; k++)
        for (size_t i = 0, from = k * d_own; i < d; i++)
            ret_points[k * d + i] = (int)i == fit->held ? fit->start[i] : own[from++];
    return status;
}

static bool is_added(const study *s, size_t from, const double *point)
{
    const size_t d = s->definition.d;

    for (size_t k = from; k < s->n_points; k++)
        if (memcmp(s->at + k * d, point, d * sizeof *point) == 0)
            return true;
    return false;
}

// Ask the searches of the stage and add what they ask for, each point once; nothing is added when all are over.
static bf_status ask_all(study *s, bf_error *err)
{
    const size_t d = s->definition.d, from = s->n_points;
    struct calibration *c = s->calibration;
    double *scratch = memory_alloc(s->n_points, (d + 1) * sizeof *scratch);
    double *points = memory_alloc(c->n * ROUND_MAX, d * sizeof *points);
    size_t n[FITS_MAX] = { 0 }, n_all = 0;
    bf_status status = scratch == NULL || points == NULL ? bf_fail_memory(err) : BF_OK;

    for (size_t k = 0; status == BF_OK && k < c->n; k++) {
        if (!c->fits[k].is_over)
            status = ask(s, &c->fits[k], scratch, points + k * ROUND_MAX * d, &n[k], err);
        n_all += n[k];
    }
    if (status == BF_OK)
        status = study_reserve(s, n_all, n_all * s->definition.n_replications, err);
    for (size_t k = 0; status == BF_OK && k < c->n; k++) {
        c->fits[k].n_asked += n[k];
        c->fits[k].is_over = n[k] == 0;
        for (size_t i = 0; i < n[k]; i++) {
            const double *point = points + (k * ROUND_MAX + i) * d;
            if (!is_added(s, from, point) && study_points_left(s, s->definition.n_replications) > 0)
                study_add_trials(s, study_add_point(s, point, STUDY_AS_SUBMITTED),
                                 s->definition.n_replications);
        }
    }
    memory_free(scratch);
    memory_free(points);
    return status;
}

static calibration_fit *begin_fit(struct calibration *c, const double *start, size_t d, double step,
                                  size_t n_max)
{
    calibration_fit *fit = &c->fits[c->n++];

    *fit = (calibration_fit){
        .left_out = NONE, .held = NONE, .step = step, .n_max = n_max > 0 ? n_max : 1
    };
    memcpy(fit->start, start, d * sizeof *start);
    return fit;
}

// Subplex from the best points of the first stage.
static void begin_fits(study *s, size_t n_max)
{
    const size_t d = s->definition.d;

    for (size_t k = 0; k < CALIBRATION_STARTS && k < s->definition.n_points; k++) {
        const size_t best = study_least(s->costs, s->definition.n_points);
        if (isinf(s->costs[best]))
            break;
        begin_fit(s->calibration, s->at + best * d, d, far_step, n_max / CALIBRATION_STARTS);
        s->costs[best] = (double)INFINITY;
    }
    for (size_t point = 0; point < s->n_points; point++)
        s->costs[point] = study_cost(s, point);
}

// A place of the profile of a parameter; side 0 is below the answer, 1 above.
static double place_of(const study *s, size_t parameter, int side, size_t place)
{
    const double at = s->at[s->calibration->answer * s->definition.d + parameter];

    if (place == 0)
        return fmin(fmax(at + (2 * side - 1) * CALIBRATION_NEAR, 0.0), 1.0);
    if (place == PLACES - 1)
        return side;
    return at + ways[place - 1] * (side - at);
}

static void begin_profiles(study *s, size_t n_max)
{
    const size_t d = s->definition.d;
    const double *answer = s->at + s->calibration->answer * d;

    for (size_t i = 0; i < d; i++)
        for (int side = 0; side < 2; side++)
            for (size_t k = 0; k < PLACES; k++) {
                // Next to the answer the others stay.
                calibration_fit *fit = begin_fit(s->calibration, answer, d, near_step,
                                                 k == 0 ? 1 : n_max / (2 * PLACES * d));
                fit->held = (int)i;
                fit->start[i] = place_of(s, i, side, k);
            }
}

// The root of n ln((cost + v)/(least + v)); 0 where cost is INFINITY.
static double distance_of(const study *s, double cost, double least)
{
    if (isinf(cost) || cost <= least)
        return 0.0;
    return sqrt(s->definition.n_independent *
                log((cost + rounding_variance) / (least + rounding_variance)));
}

// True if a fit of a profile found a point that is better than the answer by more than rounding; it becomes the answer.
static bool is_answer_better(study *s)
{
    struct calibration *c = s->calibration;
    const size_t best = best_without(s, NONE);

    if (c->answer == SIZE_MAX || distance_of(s, s->costs[c->answer], s->costs[best]) < 1.0)
        return false;
    c->answer = best;
    return true;
}

// Begin the next stage. Half of the trials that the first one leaves are for the second, a quarter for the third, and what
// is left for the last, which begins again when it has found a better answer.
static void begin_stage(study *s)
{
    struct calibration *c = s->calibration;
    const size_t n_all = s->definition.n_trials_max / s->definition.n_replications;
    const size_t n_fits = n_all - s->definition.n_points;
    const size_t n_left = study_points_left(s, s->definition.n_replications);

    if (c->stage < STAGES || n_left == 0 || !is_answer_better(s))
        c->stage++;
    if (c->stage > STAGES)
        return;
    c->n = 0;
    if (c->stage == 2)
        begin_fits(s, n_fits / 2);
    else if (c->stage == 3)
        c->answer = best_without(s, NONE);
    if (c->answer == SIZE_MAX)
        return;
    const size_t n_values = s->definition.n_values, d = s->definition.d;
    for (size_t j = 0; c->stage == 3 && n_values > 1 && j < n_values; j++)
        begin_fit(c, s->at + c->answer * d, d, near_step, n_fits / 4 / n_values)->left_out = (int)j;
    if (c->stage == STAGES)
        begin_profiles(s, n_left);
}

bf_status study_calibrate(study *s, bf_error *err)
{
    const size_t n_before = s->n_points;

    if (s->calibration == NULL) {
        struct calibration *c = memory_alloc(1, sizeof *c);
        if (c == NULL)
            return bf_fail_memory(err);
        *c = (struct calibration){ .stage = 1, .answer = SIZE_MAX };
        s->calibration = c;
    }
    if (s->n_points == 0)
        return study_sweep(s, STUDY_SOBOL, STUDY_AS_SUBMITTED, s->definition.n_replications, err);
    while (s->n_points == n_before && s->calibration->stage <= STAGES) {
        bf_status status = ask_all(s, err);
        if (status != BF_OK)
            return status;
        if (s->n_points == n_before)
            begin_stage(s);
    }
    s->is_ended = s->n_points == n_before;
    return BF_OK;
}

// The mean cost of the answer and of the points next to it.
static double near_cost(const study *s)
{
    const struct calibration *c = s->calibration;
    statistics_sample sample = { 0 };

    statistics_add(&sample, s->costs[c->answer]);
    for (size_t k = 0; c->stage >= STAGES && k < c->n; k += PLACES)
        for (size_t point = 0; point < s->n_points; point++)
            if (memcmp(s->at + point * s->definition.d, c->fits[k].start,
                       s->definition.d * sizeof *s->at) == 0 &&
                isfinite(s->costs[point]))
                statistics_add(&sample, s->costs[point]);
    return sample.mean;
}

// The distance at a place of a profile; 0 where its fit has not converged: it ran out of points, and the later half of
// them made the distance smaller by a tenth or more.
static double distance_at(const study *s, size_t k, size_t parameter, double near)
{
    const struct calibration *c = s->calibration;
    double half = (double)INFINITY, least = (double)INFINITY;

    if (c->stage < STAGES || k >= c->n || !c->fits[k].is_over)
        return 0.0;
    const calibration_fit *fit = &c->fits[k];
    for (size_t point = 0, n = 0; point < s->n_points; point++) {
        if (s->at[point * s->definition.d + parameter] != fit->start[parameter])
            continue;
        least = fmin(least, s->costs[point]);
        half = ++n <= fit->n_asked / 2 ? least : half;
    }
    const bool is_cut = s->definition.d > 1 && fit->n_asked >= fit->n_max;
    if (is_cut && (isinf(half) || distance_of(s, least, near) < 0.9 * distance_of(s, half, near)))
        return 0.0;
    return distance_of(s, least, near);
}

// Where the distance passes the limit on the way to the end of the range; NAN: it does not.
static double edge_of(const study *s, size_t parameter, int side, double limit)
{
    const double near = near_cost(s);
    double last = s->at[s->calibration->answer * s->definition.d + parameter], last_distance = 0.0;

    for (size_t k = 1; k < PLACES; k++) {
        const double place = place_of(s, parameter, side, k);
        // In the order in which begin_profiles() begins them.
        const size_t fit = (2 * parameter + (size_t)side) * PLACES + k;
        const double distance = distance_at(s, fit, parameter, near);
        if (distance > limit)
            return last + (place - last) * (limit - last_distance) / (distance - last_distance);
        last = place;
        last_distance = distance;
    }
    return (double)NAN;
}

calibration_profile calibration_profile_of(const study *s, size_t parameter)
{
    const double limit = statistics_normal(0.5 * (1.0 - s->definition.confidence));
    const double low = edge_of(s, parameter, 0, limit), high = edge_of(s, parameter, 1, limit);
    const double near = near_cost(s);
    calibration_profile profile = { .low = isnan(low) ? 0.0 : low,
                                    .high = isnan(high) ? 1.0 : high };

    for (size_t point = 0; point < s->n_points; point++) {
        const double at = s->at[point * s->definition.d + parameter];
        if (isfinite(s->costs[point]) && distance_of(s, s->costs[point], near) <= limit) {
            profile.low = fmin(profile.low, at);
            profile.high = fmax(profile.high, at);
        }
    }
    profile.is_identifiable = profile.low > 0.0 && profile.high < 1.0;
    return profile;
}

size_t calibration_without(const study *s, size_t curve)
{
    if (s->definition.n_values < 2 || s->calibration == NULL || s->calibration->stage < 3)
        return SIZE_MAX;
    return best_without(s, (int)curve);
}
