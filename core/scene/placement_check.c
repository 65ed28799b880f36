#include "core/scene/placement.h"

#include "core/base/vec2.h"
#include "core/scene/mix.h"
#include "core/scene/overlap_grid.h"
#include "core/scene/placement_priv.h"

#include <stdio.h>

enum { TOLD_MAX = 4 }; ///< faults of one kind that are told of

/// What the check has found so far.
typedef struct findings {
    const scene *s;
    const placement *p;
    shape_footprint footprints[SCENE_KINDS_MAX];
    bf_faults *faults;
    size_t n_outside;
    size_t n_overlaps;
} findings;

size_t placement__limit_told(const scene *s)
{
    return s->initial.type == SCENE_INITIAL_POSITIONS ? TOLD_MAX : 1;
}

static const shape_footprint *footprint_of(const findings *f, size_t k)
{
    return &f->footprints[mix_kind(f->p->kinds, k)];
}

const char *placement__point_at(const scene *s, size_t k, char *room)
{
    if (s->initial.type == SCENE_INITIAL_HEXAGONAL)
        return "/initial/hexagonal";
    if (s->initial.type == SCENE_INITIAL_RANDOM)
        return "/initial/random";
    snprintf(room, BF_POINTER_SIZE, "/initial/positions_m/%zu", k);
    return room;
}

/// Note a part that reaches over a side of the domain. Returns true if it does not.
static bool check_inside(findings *f, size_t k)
{
    static const char *const words[SCENE_SIDE_COUNT] = { "west", "east", "south", "north" };
    char room[BF_POINTER_SIZE];
    scene_pose at = f->p->poses[k];

    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        double excess = placement__excess(f->s, footprint_of(f, k), at, side);
        if (excess <= SCENE_TOLERANCE)
            continue;
        f->n_outside++;
        if (f->s->edges[side] == SCENE_EDGE_WALL)
            faults_add(f->faults, placement__point_at(f->s, k, room),
                       "part %zu at (%g, %g) m reaches %g m over the %s wall", k, at.x, at.y,
                       excess, words[side]);
        else
            faults_add(f->faults, placement__point_at(f->s, k, room),
                       "part %zu at (%g, %g) m lies %g m outside the domain in the %s", k, at.x,
                       at.y, excess, words[side]);
        return false;
    }
    return true;
}

/// Note an overlap of part k with another. Returns true if there is none.
static bool check_free(findings *f, const crowd *c, size_t k)
{
    scene_pose at = f->p->poses[k];
    char room[BF_POINTER_SIZE];
    size_t other;

    if (!overlap_grid_overlaps(c, k, at, &other))
        return true;
    scene_pose with = f->p->poses[other];
    double distance = vec2_length((vec2){ at.x - with.x, at.y - with.y });
    const char *pointer = placement__point_at(f->s, k, room);
    f->n_overlaps++;
    const shape_footprint *own = footprint_of(f, k), *its = footprint_of(f, other);
    if (own->n_corners == 0 && its->n_corners == 0)
        faults_add(f->faults, pointer,
                   "part %zu at (%g, %g) m overlaps part %zu: they are %g m apart, the least is "
                   "%g m",
                   k, at.x, at.y, other, distance, own->reach + its->reach);
    else
        faults_add(f->faults, pointer, "part %zu at (%g, %g) m overlaps part %zu, %g m away", k,
                   at.x, at.y, other, distance);
    return false;
}

bf_status placement_check(const scene *s, const placement *p, bf_faults *faults)
{
    findings f = { .s = s, .p = p, .faults = faults };
    size_t limit = placement__limit_told(s);
    crowd c;

    mix_footprints(s, f.footprints);
    bf_status status =
        overlap_grid_init(&c, f.footprints, s->n_cargo, p->kinds, p->poses, p->n, NULL);
    if (status != BF_OK)
        return status;
    for (size_t k = 0; k < p->n && f.n_outside < limit && f.n_overlaps < limit; k++) {
        if (check_inside(&f, k) && check_free(&f, &c, k))
            overlap_grid_add(&c, k);
    }
    overlap_grid_fini(&c);
    return BF_OK;
}
