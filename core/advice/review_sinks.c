#include "core/advice/review_sinks.h"

#include "core/scene/sink.h"
#include "core/scene/surroundings.h"

#include <math.h>

enum { PLACES_ALONG = 64, PLACES_ACROSS = 17 }; // of the rectangle about a sink that are looked at

/// Most steps, of a few nanoseconds each, in which belts are looked for; what takes more is left out.
#define STEPS_MAX 3e7

typedef struct search {
    surroundings around;
    const scene_rect *domain;
    bf_grid places;
    bool is_left_out; // it took too long
    bool is_crossed;  // a belt moves over one of the places
    double steps;
    double steps_of_place;
} search;

static bool look_at(void *context, size_t j, size_t first, size_t last)
{
    search *f = context;

    for (size_t i = first; i < last && !f->is_crossed; i++) {
        const vec2 at = { grid_x1(&f->places, i), grid_x2(&f->places, j) };
        f->steps += f->steps_of_place;
        f->is_left_out = f->steps > STEPS_MAX;
        if (f->is_left_out)
            return false;
        f->is_crossed = surroundings_is_inside(f->domain, at) &&
                        vec2_length(surroundings_velocity_under(&f->around, at)) > 0.0;
    }
    return !f->is_crossed;
}

// Places over the rectangle about a sink.
static bf_grid places_of(const scene_sink *sink)
{
    vec2 lower = sink->polygon[0], upper = sink->polygon[0];

    for (size_t k = 1; k < sink->n_points; k++) {
        lower = (vec2){ fmin(lower.x, sink->polygon[k].x), fmin(lower.y, sink->polygon[k].y) };
        upper = (vec2){ fmax(upper.x, sink->polygon[k].x), fmax(upper.y, sink->polygon[k].y) };
    }
    return (bf_grid){ .n1 = PLACES_ALONG,
                      .n2 = PLACES_ACROSS,
                      .d1 = (upper.x - lower.x) / PLACES_ALONG,
                      .d2 = (upper.y - lower.y) / PLACES_ACROSS,
                      .lower1 = lower.x,
                      .lower2 = lower.y };
}

bf_status review_sinks(const scene *s, review_warnings *ret_warnings, bf_error *err)
{
    search f = { .around = surroundings_of(s), .domain = &s->domain, .steps_of_place = 1.0 };

    for (size_t k = 0; k < s->n_sections; k++)
        f.steps_of_place += 1.0 + (double)s->belts[k].n_points;
    for (size_t k = 0; k < s->n_sinks && !f.is_left_out; k++) {
        f.places = places_of(&s->sinks[k]);
        f.is_crossed = false;
        if (sink_visit_cells(&s->sinks[k], &f.places, look_at, &f) != BF_OK)
            return bf_fail(err, BF_ENOMEM, "", "no memory for the review of sinks");
        if (f.is_crossed || f.is_left_out)
            continue;
        review_explain(
            review_add(ret_warnings, "No belt carries goods to a sink", "/sinks/%zu/polygon_m", k),
            "No belt moves under the sink '%s': it takes what is pushed there, if anything.",
            s->sinks[k].id);
    }
    return BF_OK;
}
