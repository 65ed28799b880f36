// Parts that overlap plates at the start. The places are sorted into horizontal strips, and in each by x, so that a
// piece of a plate is compared with the parts that lie near it alone.

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/base/search.h"
#include "core/scene/mix.h"
#include "core/scene/placement.h"
#include "core/scene/plate_pieces.h"
#include "core/scene/scene_priv.h"

#include <math.h>
#include <stdlib.h>

// Steps of the search: for a strip that a piece touches, for a part near it, for a part whose outline is looked at.
enum { STEPS_STRIP = 20, STEPS_PLACE = 1, STEPS_OUTLINE = 40 };

/// A part by its place along x.
typedef struct place {
    double x;
    uint32_t part;
} place;

/// The data of the check.
typedef struct plate_findings {
    const scene *s;
    const scene_placement *p;
    shape_footprint footprints[SCENE_KINDS_MAX];
    double radius; ///< bounding radius of the largest part, m
    double bottom; ///< of the first strip, m
    double height; ///< of a strip, m
    size_t n_strips;
    size_t *ends;  ///< index in places behind the last one of each strip
    place *places; ///< of all parts
    uint64_t steps;
    bf_faults *faults;
    size_t n_reported;
} plate_findings;

static int compare_places(const void *a, const void *b)
{
    const place *of_a = a, *of_b = b;
    if (of_a->x != of_b->x)
        return of_a->x < of_b->x ? -1 : 1;
    return of_a->part < of_b->part ? -1 : of_a->part > of_b->part;
}

/// The strip at a height; the first or the last for places outside of all.
static size_t strip_at(const plate_findings *f, double y)
{
    return (size_t)fmin(fmax(floor((y - f->bottom) / f->height), 0.0), (double)f->n_strips - 1.0);
}

/// The box about what of a plate lies at heights from y_min to y_max.
static scene_rect box_of(const vec2 plate[4], double y_min, double y_max)
{
    scene_rect box = { INFINITY, -INFINITY, INFINITY, -INFINITY };

    for (int k = 0; k < 4; k++) {
        vec2 a = plate[k], b = plate[(k + 1) % 4];
        if (!polygon_clip_segment(&a, &b, (vec2){ -INFINITY, y_min }, (vec2){ INFINITY, y_max }))
            continue;
        box.x_min = fmin(box.x_min, fmin(a.x, b.x));
        box.x_max = fmax(box.x_max, fmax(a.x, b.x));
        box.y_min = fmin(box.y_min, fmin(a.y, b.y));
        box.y_max = fmax(box.y_max, fmax(a.y, b.y));
    }
    return box;
}

static bool has_ended(const plate_findings *f)
{
    return f->n_reported >= placement__reported_max(f->s) || f->steps > SCENE_PLACEMENT_STEPS_MAX;
}

static void check_strip(plate_findings *f, const scene_obstacle *obstacle, const vec2 plate[4],
                        size_t strip)
{
    const double low = strip == 0 ? -INFINITY : f->bottom + (double)strip * f->height - f->radius;
    const double high = strip + 1 == f->n_strips
                            ? INFINITY
                            : f->bottom + (double)(strip + 1) * f->height + f->radius;
    // A tenth of the radius more than needed covers the rounding of the strips' borders.
    const double margin = 1.1 * f->radius;
    const scene_rect box = box_of(plate, low - 0.1 * f->radius, high + 0.1 * f->radius);
    char room[BF_POINTER_SIZE];

    f->steps += STEPS_STRIP;
    const size_t first = strip == 0 ? 0 : f->ends[strip - 1];
    for (size_t i = first + search_count(&f->places[first].x, sizeof *f->places,
                                         f->ends[strip] - first, box.x_min - margin, false);
         i < f->ends[strip] && f->places[i].x <= box.x_max + margin && !has_ended(f); i++) {
        size_t k = f->places[i].part;
        scene_pose at = f->p->poses[k];
        f->steps += STEPS_PLACE;
        if (at.y < box.y_min - margin || at.y > box.y_max + margin)
            continue;
        f->steps += STEPS_OUTLINE;
        if (!shape_overlaps_polygon(&f->footprints[mix_kind(f->p->kinds, k)], at, plate, 4))
            continue;
        f->n_reported++;
        faults_add(f->faults, placement__point_at(f->s, k, room),
                   "part %zu at (%g, %g) m overlaps the plate of obstacle '%s', %g m thick", k,
                   at.x, at.y, obstacle->id, obstacle->thickness);
    }
}

static void check_pieces(plate_findings *f)
{
    const scene *s = f->s;
    const surroundings around = surroundings_of(s);
    vec2 plate[4];

    for (size_t k = 0; k < s->n_obstacles; k++) {
        for (size_t m = 0; m + 1 < s->obstacles[k].n_points && !has_ended(f); m++) {
            if (!plate_pieces_get(&around, &s->obstacles[k], m, plate))
                continue;
            const scene_rect box = box_of(plate, -INFINITY, INFINITY);
            const size_t last = strip_at(f, box.y_max + f->radius);
            for (size_t i = strip_at(f, box.y_min - f->radius); i <= last && !has_ended(f); i++)
                check_strip(f, &s->obstacles[k], plate, i);
        }
    }
    if (f->steps > SCENE_PLACEMENT_STEPS_MAX)
        faults_add_limit(
            f->faults, "/obstacles",
            "to look for %zu parts in all plates takes more than %.3g steps, which is the "
            "limit",
            f->p->n, (double)SCENE_PLACEMENT_STEPS_MAX);
}

bf_status placement_check_plates(const scene *s, const scene_placement *p, bf_faults *faults)
{
    plate_findings f = { .s = s, .p = p, .faults = faults };

    if (s->n_obstacles == 0 || p->n == 0)
        return BF_OK;
    bf_status status = BF_OK;
    mix_footprints(s, f.footprints);
    for (size_t k = 0; k < s->n_cargo; k++)
        f.radius = fmax(f.radius, f.footprints[k].bounding_radius);
    // As many strips as hold about as many parts each as there are strips, but none lower than a part.
    const scene_rect *d = &f.s->domain;
    const double height = d->y_max - d->y_min, n_most = ceil(sqrt((double)f.p->n));
    f.bottom = d->y_min;
    f.height = fmax(height / fmax(n_most, 1.0), 2.0 * f.radius);
    f.n_strips = (size_t)fmax(ceil(height / f.height), 1.0);
    f.ends = memory_alloc(f.n_strips, sizeof *f.ends);
    f.places = memory_alloc(p->n, sizeof *f.places);
    if (f.ends != NULL && f.places != NULL) {
        const scene_pose *poses = f.p->poses;
        size_t first = 0;
        for (size_t k = 0; k < f.p->n; k++)
            f.ends[strip_at(&f, poses[k].y)]++;
        for (size_t strip = 0; strip < f.n_strips; strip++) {
            const size_t n = f.ends[strip];
            f.ends[strip] = first;
            first += n;
        }
        for (uint32_t k = 0; k < f.p->n; k++)
            f.places[f.ends[strip_at(&f, poses[k].y)]++] = (place){ poses[k].x, k };
        for (size_t strip = 0; strip < f.n_strips; strip++) {
            first = strip == 0 ? 0 : f.ends[strip - 1];
            if (f.ends[strip] > first)
                qsort(f.places + first, f.ends[strip] - first, sizeof *f.places, compare_places);
        }
        check_pieces(&f);
    } else {
        status = BF_ENOMEM;
    }
    memory_free(f.ends);
    memory_free(f.places);
    return status;
}
