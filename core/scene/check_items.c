#include "core/scene/check_priv.h"

#include "core/base/polygon.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ROOM_FOR_INDEX = 24 }; ///< bytes of "/" and an index

/// The id of an item of a list.
typedef const char *id_of(const scene *s, size_t k);

static const char *belt_id(const scene *s, size_t k)
{
    return s->belts[k].id;
}

static const char *obstacle_id(const scene *s, size_t k)
{
    return s->obstacles[k].id;
}

static const char *counter_id(const scene *s, size_t k)
{
    return s->counters[k].id;
}

bool scene_is_id(const char *text)
{
    size_t n = strnlen(text, SCENE_ID_SIZE);

    return n >= 1 && n < SCENE_ID_SIZE &&
           strspn(text, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-") == n;
}

static void check_id(const scene *s, id_of *get, const char *list, size_t k, bf_faults *faults)
{
    const char *id = get(s, k);
    char pointer[BF_POINTER_SIZE];

    snprintf(pointer, sizeof pointer, "/%s/%zu/id", list, k);
    if (!scene_is_id(id)) {
        faults_add(faults, pointer, "must be 1 to %d letters, digits, '_', '.' and '-'",
                   SCENE_ID_SIZE - 1);
        return;
    }
    for (size_t m = 0; m < k; m++) {
        if (strncmp(id, get(s, m), SCENE_ID_SIZE) == 0) {
            faults_add(faults, pointer, "'%s' is the id of /%s/%zu too", id, list, m);
            return;
        }
    }
}

static bool is_place(vec2 at)
{
    return fabs(at.x) <= SCENE_LENGTH_MAX && fabs(at.y) <= SCENE_LENGTH_MAX;
}

/// Note the first point that is no number or repeats the one before it; whole: point at the pointer
/// itself instead of at the point. Returns true if there is none.
static bool check_points(const vec2 *points, size_t n, const char *pointer, bool whole,
                         bf_faults *faults)
{
    char at[BF_POINTER_SIZE + ROOM_FOR_INDEX];

    for (size_t k = 0; k < n; k++) {
        bool is_good = is_place(points[k]);
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

static void check_polygon(const scene_belt *belt, const char *pointer, bf_faults *faults)
{
    size_t n = belt->n_points;
    char last[BF_POINTER_SIZE + ROOM_FOR_INDEX];

    if (n < 3 || n > SCENE_POINTS_MAX) {
        faults_add(faults, pointer, "must have 3 to %d points, not %zu", SCENE_POINTS_MAX, n);
        return;
    }
    if (!check_points(belt->polygon, n, pointer, false, faults))
        return;
    if (vec2_length(vec2_sub(belt->polygon[n - 1], belt->polygon[0])) <= SCENE_LENGTH_MIN) {
        snprintf(last, sizeof last, "%s/%zu", pointer, n - 1);
        faults_add(faults, last, "repeats the first point; a polygon closes itself");
    } else if (!polygon_is_simple(belt->polygon, n, SCENE_TOLERANCE)) {
        faults_add(faults, pointer, "must be a simple polygon: its sides cross or touch");
    }
}

static void check_belts(const scene *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    if (s->n_belts < 1 || s->n_belts > SCENE_BELTS_MAX) {
        faults_add_limit(faults, "/belts", "%zu belts, the limits are 1 and %d", s->n_belts,
                         SCENE_BELTS_MAX);
        return;
    }
    for (size_t k = 0; k < s->n_belts; k++) {
        const scene_belt *belt = &s->belts[k];
        check_id(s, belt_id, "belts", k, faults);
        snprintf(pointer, sizeof pointer, "/belts/%zu/velocity_m_s", k);
        if (!(vec2_length(belt->velocity) <= SCENE_SPEED_MAX))
            faults_add(faults, pointer, "must be a velocity of at most %g m/s", SCENE_SPEED_MAX);
        snprintf(pointer, sizeof pointer, "/belts/%zu/polygon_m", k);
        if (belt->n_points != 0)
            check_polygon(belt, pointer, faults);
    }
}

static void check_width(double width, size_t k, const char *member, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    if (width > 0.0 && width <= SCENE_LENGTH_MAX)
        return;
    snprintf(pointer, sizeof pointer, "/obstacles/%zu/%s", k, member);
    faults_add(faults, pointer, "must be above 0 and at most %g, not %g", SCENE_LENGTH_MAX, width);
}

static void check_path(const scene_obstacle *obstacle, size_t k, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];
    size_t n = obstacle->n_points;
    // Two points may come from another form than a path.
    bool whole = n == 2;

    snprintf(pointer, sizeof pointer, "/obstacles/%zu%s", k, whole ? "" : "/path_m");
    if (n < 2 || n > SCENE_POINTS_MAX)
        faults_add(faults, pointer, "must have 2 to %d points, not %zu", SCENE_POINTS_MAX, n);
    else
        (void)check_points(obstacle->path, n, pointer, whole, faults);
}

static void check_obstacles(const scene *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    if (s->n_obstacles > SCENE_OBSTACLES_MAX) {
        faults_add_limit(faults, "/obstacles", "%zu obstacles, the limit is %d", s->n_obstacles,
                         SCENE_OBSTACLES_MAX);
        return;
    }
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *obstacle = &s->obstacles[k];
        check_id(s, obstacle_id, "obstacles", k, faults);
        check_path(obstacle, k, faults);
        check_width(obstacle->thickness, k, "thickness_m", faults);
        check_width(obstacle->band, k, "band_m", faults);
        check_width(obstacle->slide_width, k, "slide_width_m", faults);
        snprintf(pointer, sizeof pointer, "/obstacles/%zu/treatment", k);
        if ((unsigned)obstacle->treatment >= SCENE_TREATMENT_COUNT)
            faults_add(faults, pointer, "is not a treatment");
    }
}

static void check_interval(double low, double high, size_t k, const char *member, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    if (fabs(low) <= SCENE_LENGTH_MAX && fabs(high) <= SCENE_LENGTH_MAX && low < high)
        return;
    snprintf(pointer, sizeof pointer, "/counters/%zu/%s", k, member);
    faults_add(faults, pointer, "must be [from, to] with from < to, within %g m", SCENE_LENGTH_MAX);
}

static void check_counters(const scene *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    if (s->n_counters < 1 || s->n_counters > SCENE_COUNTERS_MAX) {
        faults_add_limit(faults, "/counters", "%zu counters, the limits are 1 and %d",
                         s->n_counters, SCENE_COUNTERS_MAX);
        return;
    }
    for (size_t k = 0; k < s->n_counters; k++) {
        const scene_counter *counter = &s->counters[k];
        check_id(s, counter_id, "counters", k, faults);
        snprintf(pointer, sizeof pointer, "/counters/%zu/id", k);
        if (strcmp(counter->id, "t_s") == 0 || strcmp(counter->id, "left_domain") == 0)
            faults_add(faults, pointer, "'%s' is a column of every curve", counter->id);
        check_interval(counter->rect.x_min, counter->rect.x_max, k, "x_m", faults);
        check_interval(counter->rect.y_min, counter->rect.y_max, k, "y_m", faults);
    }
}

void scene_check__items(const scene *s, bf_faults *faults)
{
    check_belts(s, faults);
    check_obstacles(s, faults);
    check_counters(s, faults);
}
