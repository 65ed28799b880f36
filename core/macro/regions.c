#include "core/macro/regions.h"

#include "core/macro/aperture.h"
#include "core/scene/belt_slope.h"

#include <math.h>

/// Width of the slide zone of the congested closure in radii of parts; fitted to the microscopic model.
static const double congested_slide = 6.0;

regions_segment regions_segment_of(const scene *s, const surroundings *around,
                                   const scene_obstacle *obstacle, size_t k)
{
    regions_segment g = { .piece = surroundings_piece_of(around, obstacle, k),
                          .conveyor = &s->micro.contact[SCENE_CONVEYOR_CARGO] };
    const bool is_sealed = obstacle->treatment == SCENE_SEALED;

    if (s->macro.closure == SCENE_CONGESTED) {
        g.level[2] = congested_slide * aperture_radius(s);
        return g;
    }
    g.level[0] = obstacle->treatment == SCENE_FIELD ? -obstacle->thickness : 0.0;
    g.level[1] = is_sealed ? obstacle->band : 0.0;
    g.level[2] = g.level[1] + obstacle->slide_width;
    return g;
}

double regions_extent(const regions_segment *g)
{
    return fmax(fabs(g->level[0]), g->level[2]);
}

static regions_region find_region(const regions_segment *g, vec2 upstream, vec2 at)
{
    vec2 to = vec2_sub(at, g->piece.start);
    double a = vec2_dot(to, g->piece.along), d = vec2_dot(to, upstream);

    if (a < -SCENE_TOLERANCE || a > g->piece.length + SCENE_TOLERANCE)
        return REGIONS_FREE;
    if (d < g->level[0] - SCENE_TOLERANCE || d > g->level[2] + SCENE_TOLERANCE)
        return REGIONS_FREE;
    return d < g->level[1] - SCENE_TOLERANCE ? REGIONS_OUTWARD : REGIONS_SLIDE;
}

regions_velocity regions_begin(const surroundings *around, size_t belt, vec2 at)
{
    regions_velocity v = { .region = REGIONS_FREE, .belt_index = belt };

    v.belt = surroundings_velocity_at(around, v.belt_index, at);
    v.under = v.belt_index < around->n_belts ? &around->belts[v.belt_index] : NULL;
    v.velocity = v.belt;
    return v;
}

void regions_consider(regions_velocity *v, const regions_segment *g, vec2 at)
{
    const vec2 along = g->piece.along, upstream = surroundings_upstream(along, v->belt);
    const double speed = vec2_length(v->belt);

    const bool turns = v->under != NULL && v->under->turn != 0.0;
    const vec2 middle = vec2_add(g->piece.start, vec2_scale(along, 0.5 * g->piece.length));

    if (surroundings_is_guide(along, turns ? belt_velocity(v->under, middle) : v->belt))
        return;
    const regions_region found = find_region(g, upstream, at);
    if (found <= v->region)
        return;
    v->region = found;
    if (found == REGIONS_OUTWARD) {
        v->velocity = vec2_scale(upstream, speed);
        return;
    }
    v->velocity = vec2_scale(along, vec2_dot(v->belt, along));
    if (v->under == NULL || v->under->incline == 0.0)
        return;
    // What rests on the plate slips on its belt by u, which bears the pull along the plate: of the angle theta to the belt
    // u/sqrt(u^2 + (v_T sin theta)^2) = tau cos theta.
    const double cosine = fabs(vec2_dot(v->belt, along)) / speed;
    const double borne = belt_slope_ratio(v->under, g->conveyor) * cosine;
    const double sine = sqrt(1.0 - cosine * cosine);
    const double slip = speed * sine * borne / sqrt(1.0 - borne * borne);
    const double slides = fmin(fmax(speed * cosine - slip, 0.0), speed);
    v->velocity = vec2_scale(along, copysign(slides, vec2_dot(v->belt, along)));
}
