// What the checks of a scenario share: numbers, ids, points, times.

#include "core/base/polygon.h"
#include "core/scene/ranges.h"
#include "core/scene/scene_priv.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void scene__check_numbers(const void *item, const char *pointer, const number_rule *rules, size_t n,
                          bf_faults *faults)
{
    char at[2 * BF_POINTER_SIZE];

    for (size_t k = 0; k < n; k++) {
        snprintf(at, sizeof at, "%s%s", pointer, rules[k].pointer);
        range_check(rules[k].range, *(const double *)((const char *)item + rules[k].offset), at,
                    faults);
    }
}

bool scene_is_id(const char *text)
{
    size_t n = strnlen(text, SCENE_ID_SIZE);

    return n >= 1 && n < SCENE_ID_SIZE &&
           strspn(text, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-") == n;
}

void scene__check_id(const void *items, size_t size, const char *list, size_t k, bf_faults *faults)
{
    const char *first = items, *id = first + k * size;
    char pointer[BF_POINTER_SIZE];

    snprintf(pointer, sizeof pointer, "/%s/%zu/id", list, k);
    if (!scene_is_id(id)) {
        faults_add(faults, pointer, ID_TEXT, SCENE_ID_SIZE - 1);
        return;
    }
    for (size_t m = 0; m < k; m++) {
        if (strncmp(id, first + m * size, SCENE_ID_SIZE) == 0) {
            faults_add(faults, pointer, "'%s' is the id of /%s/%zu too", id, list, m);
            return;
        }
    }
}

bool scene__is_place(vec2 at)
{
    return fabs(at.x) <= SCENE_LENGTH_MAX && fabs(at.y) <= SCENE_LENGTH_MAX;
}

bool scene__check_points(const vec2 *points, size_t n, const char *pointer, bool whole,
                         bf_faults *faults)
{
    char at[BF_POINTER_SIZE + ROOM_FOR_INDEX];

    for (size_t k = 0; k < n; k++) {
        bool is_good = scene__is_place(points[k]);
        if (is_good &&
            (k == 0 || vec2_length(vec2_sub(points[k], points[k - 1])) > SCENE_LENGTH_MIN))
            continue;
        if (whole)
            snprintf(at, sizeof at, "%s", pointer);
        else
            snprintf(at, sizeof at, "%s/%zu", pointer, k);
        if (is_good)
            faults_add(faults, at, "point %zu repeats the one before it", k);
        else
            faults_add(faults, at, "must be numbers within %g m", SCENE_LENGTH_MAX);
        return false;
    }
    return true;
}

bool scene__check_polygon(const vec2 *polygon, size_t n, const char *pointer, bf_faults *faults)
{
    const size_t n_before = faults->n;
    char last[BF_POINTER_SIZE + ROOM_FOR_INDEX];

    if (n < 3 || n > SCENE_POINTS_MAX) {
        faults_add(faults, pointer, "must have 3 to %d points, not %zu", SCENE_POINTS_MAX, n);
        return false;
    }
    if (!scene__check_points(polygon, n, pointer, false, faults))
        return false;
    if (vec2_length(vec2_sub(polygon[n - 1], polygon[0])) <= SCENE_LENGTH_MIN) {
        snprintf(last, sizeof last, "%s/%zu", pointer, n - 1);
        faults_add(faults, last, "repeats the first point; a polygon closes itself");
    } else if (!polygon_is_simple(polygon, n, SCENE_TOLERANCE)) {
        faults_add(faults, pointer, "must be a simple polygon: its sides cross or touch");
    }
    return faults->n == n_before;
}

bool scene__check_count(size_t n, size_t n_max, const char *pointer, const char *items,
                        bf_faults *faults)
{
    if (n <= n_max)
        return true;
    faults_add_limit(faults, pointer, "%zu %s, the limit is %zu", n, items, n_max);
    return false;
}

void scene__check_limit(double n_parts, const char *pointer, bf_faults *faults)
{
    if (n_parts != INFINITY && !(n_parts >= scene_range_count.minimum &&
                                 n_parts <= scene_range_seed.maximum && n_parts == floor(n_parts)))
        faults_add(faults, pointer, "must be a whole number of at least %g, not %.15g",
                   scene_range_count.minimum, n_parts);
}

bool scene__check_times(const double *times, size_t n, const char *pointer, bool may_repeat,
                        bf_faults *faults)
{
    const size_t n_before = faults->n;
    char at[BF_POINTER_SIZE + ROOM_FOR_INDEX];

    for (size_t k = 0; k < n && faults->n == n_before; k++) {
        snprintf(at, sizeof at, "%s/%zu", pointer, k);
        range_check(&scene_range_instant, times[k], at, faults);
        if (faults->n > n_before || k == 0 || times[k] > times[k - 1])
            continue;
        if (!may_repeat)
            faults_add(faults, at, "%.15g s do not come after the %.15g s before them", times[k],
                       times[k - 1]);
        else if (times[k] < times[k - 1])
            faults_add(faults, at, "%.15g s come before the %.15g s before them", times[k],
                       times[k - 1]);
    }
    return faults->n == n_before;
}

static void check_values(const scene_series *series, const char *pointer, const bf_range *range,
                         bf_faults *faults)
{
    const size_t n_before = faults->n;
    char at[2 * BF_POINTER_SIZE + ROOM_FOR_INDEX];

    for (size_t k = 0; k < series->n_values && faults->n < n_before + REPORTED_MAX; k++) {
        snprintf(at, sizeof at, "%s/%zu", pointer, k);
        range_check(range, series->values[k], at, faults);
    }
}

bool scene__check_series(const scene_series *series, const char *pointer, const char *values,
                         const bf_range *range, bf_faults *faults)
{
    const size_t n_before = faults->n, n = series->n_times;
    char at[2 * BF_POINTER_SIZE];

    if (!scene__check_count(n, SCENE_SERIES_MAX, pointer, "times", faults))
        return false;
    snprintf(at, sizeof at, "%s/t_s", pointer);
    scene__check_times(series->times, n, at, false, faults);
    snprintf(at, sizeof at, "%s/%s", pointer, values);
    if (series->n_values != n)
        faults_add(faults, at, "has %zu items, but t_s has %zu", series->n_values, n);
    check_values(series, at, range, faults);
    snprintf(at, sizeof at, "%s/repeat_s", pointer);
    if (series->repeat != INFINITY)
        range_check(&scene_range_time, series->repeat, at, faults);
    if (n > 0 && faults->n == n_before && !(series->repeat >= series->times[n - 1]))
        faults_add(faults, at, "must be at least the last time, %.15g s, not %.15g s",
                   series->times[n - 1], series->repeat);
    return faults->n == n_before;
}
