#include "core/scene/placement.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/scene/mix.h"
#include "core/scene/placement_priv.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <stdlib.h>

/// A part by its place along x.
typedef struct place {
    double x;
    uint32_t part;
} place;

/// What the check knows.
typedef struct findings {
    const scene *s;
    const placement *p;
    shape_footprint footprints[SCENE_KINDS_MAX];
    double reach; ///< of the part that reaches farthest, m
    place *places;
    bf_faults *faults;
    size_t n_told;
} findings;

/// One straight piece of a plate: its corners, counter-clockwise.
typedef struct piece {
    vec2 corners[4];
} piece;

static int compare_places(const void *a, const void *b)
{
    const place *of_a = a, *of_b = b;
    if (of_a->x != of_b->x)
        return of_a->x < of_b->x ? -1 : 1;
    return of_a->part < of_b->part ? -1 : of_a->part > of_b->part;
}

static piece piece_of(const surroundings *around, const scene_obstacle *obstacle, size_t k)
{
    surroundings_piece p = surroundings_piece_of(around, obstacle, k);
    vec2 through = vec2_scale(p.upstream, -p.thickness);
    vec2 back_start = vec2_add(p.start, through), back_end = vec2_add(p.end, through);

    if (vec2_cross(vec2_sub(p.end, p.start), p.upstream) > 0.0)
        return (piece){ { p.end, p.start, back_start, back_end } };
    return (piece){ { p.start, p.end, back_end, back_start } };
}

static bool is_overlapping(const findings *f, size_t k, const piece *plate)
{
    const shape_footprint *footprint = &f->footprints[mix_kind(f->p->kinds, k)];
    vec2 corners[SCENE_VERTICES_MAX + 1];
    scene_pose at = f->p->poses[k];

    if (footprint->n_corners == 0)
        return polygon_overlaps_disk((vec2){ at.x, at.y }, footprint->reach, plate->corners, 4,
                                     SCENE_TOLERANCE);
    shape_place(footprint, at, corners);
    return polygon_overlaps(corners, footprint->n_corners, plate->corners, 4, SCENE_TOLERANCE);
}

/// The first place at or beyond x.
static size_t find_first(const findings *f, double x)
{
    size_t low = 0, high = f->p->n;

    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (f->places[middle].x < x)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void check_piece(findings *f, const scene_obstacle *obstacle, const piece *plate)
{
    scene_rect box = { INFINITY, -INFINITY, INFINITY, -INFINITY };
    size_t limit = placement__limit_told(f->s);
    char room[BF_POINTER_SIZE];

    for (int k = 0; k < 4; k++) {
        box.x_min = fmin(box.x_min, plate->corners[k].x - f->reach);
        box.x_max = fmax(box.x_max, plate->corners[k].x + f->reach);
        box.y_min = fmin(box.y_min, plate->corners[k].y - f->reach);
        box.y_max = fmax(box.y_max, plate->corners[k].y + f->reach);
    }
    for (size_t i = find_first(f, box.x_min);
         i < f->p->n && f->places[i].x <= box.x_max && f->n_told < limit; i++) {
        size_t k = f->places[i].part;
        scene_pose at = f->p->poses[k];
        if (at.y < box.y_min || at.y > box.y_max || !is_overlapping(f, k, plate))
            continue;
        f->n_told++;
        faults_add(f->faults, placement__point_at(f->s, k, room),
                   "part %zu at (%g, %g) m overlaps the plate of obstacle '%s', %g m thick", k,
                   at.x, at.y, obstacle->id, obstacle->thickness);
    }
}

bf_status placement_check_plates(const scene *s, const placement *p, bf_faults *faults)
{
    const surroundings around = surroundings_of(s);
    findings f = { .s = s, .p = p, .faults = faults };

    f.places = memory_alloc(p->n, sizeof *f.places);
    if (f.places == NULL)
        return BF_ENOMEM;
    mix_footprints(s, f.footprints);
    for (size_t k = 0; k < s->n_cargo; k++)
        f.reach = fmax(f.reach, f.footprints[k].reach);
    for (uint32_t k = 0; k < p->n; k++)
        f.places[k] = (place){ p->poses[k].x, k };
    qsort(f.places, p->n, sizeof *f.places, compare_places);
    for (size_t k = 0; k < s->n_obstacles; k++) {
        for (size_t m = 0; m + 1 < s->obstacles[k].n_points; m++) {
            piece plate = piece_of(&around, &s->obstacles[k], m);
            check_piece(&f, &s->obstacles[k], &plate);
        }
    }
    memory_free(f.places);
    return BF_OK;
}
