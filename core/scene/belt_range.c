#include "core/scene/belt_range.h"

#include "core/scene/ranges.h"
#include "core/scene/scene_priv.h"

#include <math.h>
#include <stdio.h>

bool belt_range_may_stop(const scene_belt *belt)
{
    return belt->stops.n_failures > 0 || belt->stops.n_breaks > 0;
}

bool belt_range_stops_by_chance(const scene_belt *belt)
{
    const scene_stops *stops = &belt->stops;
    bool are_drawn = false;

    for (size_t k = 0; k < stops->n_failures; k++) {
        const scene_failure *f = &stops->failures[k];
        are_drawn |= f->type == SCENE_FAILURE_DRAWN &&
                     (f->between.law != SCENE_TIME_FIXED || f->repair.law != SCENE_TIME_FIXED);
    }
    return are_drawn;
}

bool belt_range_may_change(const scene_belt *belt)
{
    return belt->speed_schedule.n_times > 0 || belt->is_commanded || belt_range_may_stop(belt);
}

bool belt_range_is_constant(size_t n_belts, const scene_belt *belts)
{
    bool are_constant = true;

    for (size_t k = 0; k < n_belts; k++)
        are_constant = are_constant && !belt_range_may_change(&belts[k]);
    return are_constant;
}

double belt_range_largest(const scene_belt *belt)
{
    const scene_speed_schedule *s = &belt->speed_schedule;
    double largest = s->n_times > 0 && s->times[0] == 0.0 ? 0.0 : 1.0;

    for (size_t k = 0; k < s->n_factors; k++)
        largest = fmax(largest, fabs(s->factors[k]));
    return belt->is_commanded ? fmax(largest, belt->command_factor) : largest;
}

bool belt_range_may_reverse(const scene_belt *belt)
{
    const scene_speed_schedule *s = &belt->speed_schedule;
    bool may = belt->is_commanded && belt->command_reverses;

    for (size_t k = 0; k < s->n_factors; k++)
        may = may || s->factors[k] < 0.0;
    return may;
}

bool belt_range_may_reverse_any(size_t n_belts, const scene_belt *belts)
{
    bool may = false;

    for (size_t k = 0; k < n_belts; k++)
        may = may || belt_range_may_reverse(&belts[k]);
    return may;
}

static void check_acceleration(double acceleration, const char *belt, const char *member,
                               bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    snprintf(pointer, sizeof pointer, "%s/%s", belt, member);
    if (acceleration != INFINITY)
        range_check(&scene_range_acceleration, acceleration, pointer, faults);
}

static void check_factors(const scene_belt *belt, const char *at, bf_faults *faults)
{
    const scene_speed_schedule *s = &belt->speed_schedule;
    const double speed = vec2_length(belt->velocity);
    const size_t n_before = faults->n;
    char pointer[BF_POINTER_SIZE];

    for (size_t k = 0; k < s->n_factors && faults->n == n_before; k++) {
        snprintf(pointer, sizeof pointer, "%s/speed_schedule/factor/%zu", at, k);
        range_check(&scene_range_speed_factor, s->factors[k], pointer, faults);
        // A speed that is too large by itself is reported there.
        if (faults->n == n_before && speed <= SCENE_SPEED_MAX &&
            speed * fabs(s->factors[k]) > SCENE_SPEED_MAX)
            faults_add(faults, pointer, "makes the belt move at %g m/s, the limit is %g",
                       speed * fabs(s->factors[k]), SCENE_SPEED_MAX);
    }
}

static void check_drawn_time(const scene_drawn_time *time, const char *at, const char *mean,
                             const char *shape, bf_faults *faults)
{
    char pointer[2 * BF_POINTER_SIZE + ROOM_FOR_INDEX];

    snprintf(pointer, sizeof pointer, "%s/%s", at, mean);
    range_check(&scene_range_time, time->mean, pointer, faults);
    snprintf(pointer, sizeof pointer, "%s/%s", at, shape);
    if (time->law == SCENE_TIME_WEIBULL)
        range_check(&scene_range_weibull_shape, time->shape, pointer, faults);
}

static void check_list(const scene_failure *f, const char *at, bf_faults *faults)
{
    const size_t n_before = faults->n;
    char pointer[2 * BF_POINTER_SIZE + ROOM_FOR_INDEX];

    if (!scene__check_count(f->n_times, SCENE_STOPS_MAX, at, "times", faults))
        return;
    if (f->n_durations != f->n_times) {
        faults_add(faults, at, "has %zu durations for %zu times", f->n_durations, f->n_times);
        return;
    }
    snprintf(pointer, sizeof pointer, "%s/t_s", at);
    if (!scene__check_times(f->times, f->n_times, pointer, false, faults))
        return;
    for (size_t k = 0; k < f->n_times && faults->n == n_before; k++) {
        snprintf(pointer, sizeof pointer, "%s/duration_s/%zu", at, k);
        range_check(&scene_range_time, f->durations[k], pointer, faults);
    }
    for (size_t k = 1; k < f->n_times && faults->n == n_before; k++) {
        const double end = f->times[k - 1] + f->durations[k - 1];
        snprintf(pointer, sizeof pointer, "%s/t_s/%zu", at, k);
        if (f->times[k] <= end)
            faults_add(faults, pointer,
                       "%.15g s do not come after the end of the failure before, at %.15g s",
                       f->times[k], end);
    }
}

static void check_break(const scene_break *b, const char *at, bf_faults *faults)
{
    const size_t n_before = faults->n;
    char pointer[2 * BF_POINTER_SIZE + ROOM_FOR_INDEX];

    snprintf(pointer, sizeof pointer, "%s/start_s", at);
    range_check(&scene_range_instant, b->start, pointer, faults);
    snprintf(pointer, sizeof pointer, "%s/duration_s", at);
    range_check(&scene_range_time, b->duration, pointer, faults);
    snprintf(pointer, sizeof pointer, "%s/every_s", at);
    if (b->every != INFINITY)
        range_check(&scene_range_time, b->every, pointer, faults);
    if (faults->n == n_before && !(b->every > b->duration))
        faults_add(faults, pointer, "must be more than the duration, %.15g s, not %.15g s",
                   b->duration, b->every);
}

static void check_number(const scene_stops *stops, const char *at, bf_faults *faults)
{
    double expected = 0.0;

    for (size_t k = 0; k < stops->n_failures; k++) {
        const scene_failure *f = &stops->failures[k];
        if (f->type == SCENE_FAILURE_DRAWN)
            expected += stops->until / (f->between.mean + f->repair.mean);
    }
    for (size_t k = 0; k < stops->n_breaks; k++)
        expected += stops->until / stops->breaks[k].every;
    if (expected > SCENE_STOPS_MAX)
        faults_add_limit(faults, at,
                         "about %.6g failures and breaks are to be expected, the limit is %d",
                         expected, SCENE_STOPS_MAX);
}

static void check_stops(const scene_stops *stops, const char *pointer, bf_faults *faults)
{
    const size_t n_before = faults->n;
    char at[BF_POINTER_SIZE + 2 * ROOM_FOR_INDEX];

    snprintf(at, sizeof at, "%s/failures", pointer);
    const bool are_few =
        scene__check_count(stops->n_failures, SCENE_FAILURES_MAX, at, "kinds", faults);
    snprintf(at, sizeof at, "%s/breaks", pointer);
    if (!scene__check_count(stops->n_breaks, SCENE_BREAKS_MAX, at, "entries", faults) || !are_few)
        return;
    for (size_t k = 0; k < stops->n_failures; k++) {
        const scene_failure *f = &stops->failures[k];
        snprintf(at, sizeof at, "%s/failures/%zu", pointer, k);
        if (f->type == SCENE_FAILURE_LISTED) {
            check_list(f, at, faults);
            continue;
        }
        check_drawn_time(&f->between, at, "mtbf_s", "mtbf_shape", faults);
        check_drawn_time(&f->repair, at, "mttr_s", "mttr_shape", faults);
    }
    for (size_t k = 0; k < stops->n_breaks; k++) {
        snprintf(at, sizeof at, "%s/breaks/%zu", pointer, k);
        check_break(&stops->breaks[k], at, faults);
    }
    snprintf(at, sizeof at, "%s/%s", pointer, stops->n_failures > 0 ? "failures" : "breaks");
    if (faults->n == n_before)
        check_number(stops, at, faults);
}

void belt_range_check(const scene_belt *belt, const char *pointer, bf_faults *faults)
{
    const scene_speed_schedule *s = &belt->speed_schedule;
    char at[BF_POINTER_SIZE];

    check_acceleration(belt->acceleration, pointer, "acceleration_m_s2", faults);
    check_acceleration(belt->deceleration, pointer, "deceleration_m_s2", faults);
    snprintf(at, sizeof at, "%s/speed_schedule", pointer);
    if (!scene__check_count(s->n_times, SCENE_SPEEDS_MAX, at, "times", faults))
        return;
    if (s->n_factors != s->n_times)
        faults_add(faults, at, "has %zu factors for %zu times", s->n_factors, s->n_times);
    snprintf(at, sizeof at, "%s/speed_schedule/t_s", pointer);
    scene__check_times(s->times, s->n_times, at, false, faults);
    check_factors(belt, pointer, faults);
    check_stops(&belt->stops, pointer, faults);
}
