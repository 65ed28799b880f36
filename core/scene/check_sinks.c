// The checks of sinks.

#include "core/base/polygon.h"
#include "core/scene/ranges.h"
#include "core/scene/scene_priv.h"

#include <math.h>
#include <stdio.h>

/// True if a polygon has no place in common with the domain.
static bool is_outside(const scene *s, const scene_sink *sink)
{
    const scene_rect *d = &s->domain;
    const vec2 lower = { d->x_min, d->y_min }, upper = { d->x_max, d->y_max };

    for (size_t k = 0; k < sink->n_points; k++) {
        vec2 start = sink->polygon[k], end = sink->polygon[(k + 1) % sink->n_points];
        if (polygon_clip_segment(&start, &end, lower, upper))
            return false;
    }
    return !polygon_holds(sink->polygon, sink->n_points, lower, 0.0);
}

/// True if the line of a feed comes into a polygon, or touches it.
static bool is_fed(const scene_feed *feed, const scene_sink *sink)
{
    bool touches = polygon_holds(sink->polygon, sink->n_points, feed->line[0], SCENE_TOLERANCE);

    for (size_t k = 0; k < sink->n_points; k++)
        touches = touches ||
                  polygon_segments_touch(feed->line[0], feed->line[1], sink->polygon[k],
                                         sink->polygon[(k + 1) % sink->n_points], SCENE_TOLERANCE);
    return touches;
}

void scene__check_sinks(const scene *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE], at[BF_POINTER_SIZE + 2 * ROOM_FOR_INDEX];

    if (!scene__check_count(s->n_sinks, SCENE_SINKS_MAX, "/sinks", "sinks", faults))
        return;
    for (size_t k = 0; k < s->n_sinks; k++) {
        const scene_sink *sink = &s->sinks[k];
        scene__check_id(s->sinks, sizeof *s->sinks, "sinks", k, faults);
        snprintf(pointer, sizeof pointer, "/sinks/%zu", k);
        snprintf(at, sizeof at, "%s/rate_per_s", pointer);
        if (sink->rate != INFINITY)
            range_check(&scene_range_rate, sink->rate, at, faults);
        for (size_t i = 0; i < sink->n_kinds; i++) {
            size_t first = 0;
            snprintf(at, sizeof at, "%s/kinds/%zu", pointer, i);
            while (sink->kinds[first] != sink->kinds[i])
                first++;
            if (sink->kinds[i] >= s->n_cargo)
                faults_add(faults, at, "must be the id of a kind of cargo");
            else if (first < i)
                faults_add(faults, at, "names a kind for the second time");
        }
        snprintf(at, sizeof at, "%s/polygon_m", pointer);
        if (!scene__check_polygon(sink->polygon, sink->n_points, at, faults))
            continue;
        if (is_outside(s, sink))
            faults_add(faults, at, "lies outside of the domain");
        for (size_t f = 0; f < s->n_feeds && s->n_feeds <= SCENE_FEEDS_MAX; f++)
            if (is_fed(&s->feeds[f], sink))
                faults_add(faults, at,
                           "comes onto the line of the feed '%s', on which parts would be taken "
                           "as they enter",
                           s->feeds[f].id);
    }
}
