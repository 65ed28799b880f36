#include "core/scene/placement.h"

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/scene/mix.h"
#include "core/scene/overlap_grid.h"
#include "core/scene/plate_pieces.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t scene_parts(const scene *s)
{
    switch (s->initial.type) {
    case SCENE_INITIAL_POSITIONS:
        return s->initial.n_poses;
    case SCENE_INITIAL_HEXAGONAL:
        return (size_t)s->initial.n_rows * s->initial.n_columns;
    case SCENE_INITIAL_RANDOM:
        return s->initial.n_random;
    default:
        return 0;
    }
}

/// Most places that are tried for n random parts.
static size_t limit_attempts(size_t n)
{
    return 100000 + 20 * n;
}

double placement_excess(const surroundings *around, const shape_footprint *footprint,
                        scene_pose pose, scene_side side)
{
    const double excess = surroundings_excess(around, side, (vec2){ pose.x, pose.y });
    const vec2 outward = vec2_scale(surroundings_side(around, side).inward, -1.0);

    if (around->edges[side] != SCENE_EDGE_WALL)
        return excess;
    return excess + shape_extent(footprint, pose.heading, outward);
}

static void place_hexagonal(const scene_initial *initial, scene_pose *ret_poses)
{
    double row_distance = initial->spacing * (sqrt(3.0) / 2.0);

    for (size_t row = 0; row < initial->n_rows; row++) {
        double x = initial->first.x + (row % 2 == 1 ? 0.5 * initial->spacing : 0.0);
        double y = initial->first.y + (double)row * row_distance;
        for (size_t column = 0; column < initial->n_columns; column++)
            *ret_poses++ = (scene_pose){ x + (double)column * initial->spacing, y, 0.0 };
    }
}

static const shape_footprint *footprint_of(const overlap_grid *c, size_t k)
{
    return &c->footprints[mix_kind(c->kinds, k)];
}

static bool has_room(const scene *s, const overlap_grid *c, size_t k, scene_pose pose)
{
    const surroundings around = surroundings_of(s);
    size_t other;

    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        if (placement_excess(&around, footprint_of(c, k), pose, side) > 0.0)
            return false;
    }
    return !overlap_grid_overlaps(c, k, pose, &other);
}

static scene_pose draw_pose(const scene_rect *region, bool is_turned, bf_random *random)
{
    scene_pose pose = { .heading = 0.0 };

    pose.x = region->x_min + random_unit(random) * (region->x_max - region->x_min);
    pose.y = region->y_min + random_unit(random) * (region->y_max - region->y_min);
    if (is_turned)
        pose.heading = random_unit(random) * (2.0 * M_PI);
    return pose;
}

/// Place parts at random until all fit, or too many places were tried. Returns how many.
static size_t fill_region(const scene *s, overlap_grid *c, scene_pose *ret_poses)
{
    size_t n = 0;
    bf_random random;

    random_init(&random, s->initial.seed);
    for (size_t left = limit_attempts(s->initial.n_random); left > 0 && n < s->initial.n_random;
         left--) {
        bool is_turned = footprint_of(c, n)->n_corners > 0;
        scene_pose pose = draw_pose(&s->initial.region, is_turned, &random);
        if (has_room(s, c, n, pose)) {
            ret_poses[n] = pose;
            overlap_grid_add(c, n++);
        }
    }
    return n;
}

/// Largest fraction of a region that is worth a try. Random places jam near 0.55; a few parts that extend
/// over a small region's border may exceed it.
static double limit_cover(size_t n)
{
    return n < 10000 ? 1.0 : 0.6;
}

/// Fraction of the region, with the margin that parts may extend over its border, that the parts cover.
static double measure_cover(const scene *s, const shape_footprint *footprints)
{
    const scene_rect *region = &s->initial.region;
    size_t counts[SCENE_KINDS_MAX];
    double margin = 0.0, area = 0.0;

    mix_count(s, s->initial.n_random, counts);
    for (size_t k = 0; k < s->n_cargo; k++) {
        margin = fmax(margin, 2.0 * footprints[k].bounding_radius);
        area += (double)counts[k] * footprints[k].area;
    }
    return area /
           ((region->x_max - region->x_min + margin) * (region->y_max - region->y_min + margin));
}

static bf_status place_random(const scene *s, const uint32_t *kinds, scene_pose *ret_poses,
                              bf_error *err)
{
    shape_footprint footprints[SCENE_KINDS_MAX];
    size_t wanted = s->initial.n_random;
    overlap_grid c;

    mix_footprints(s, footprints);
    double cover = measure_cover(s, footprints);

    if (cover > limit_cover(wanted))
        return bf_fail(err, BF_EINPUT, "/initial/random",
                       "%zu parts would cover %.0f %% of the region, and random places without "
                       "overlap fill about half of it",
                       wanted, 100.0 * cover);
    bf_status status = overlap_grid_init(&c, footprints, s->n_cargo, kinds, ret_poses, wanted, err);
    if (status != BF_OK)
        return status;
    size_t n = fill_region(s, &c, ret_poses);
    overlap_grid_fini(&c);
    if (n < wanted)
        return bf_fail(err, BF_EINPUT, "/initial/random",
                       "only %zu of %zu parts found room without overlap in %zu attempts; all "
                       "would cover %.0f %% of the region, and random places fill about half of it",
                       n, wanted, limit_attempts(wanted), 100.0 * cover);
    return BF_OK;
}

bf_status placement_make(const scene *s, scene_placement *ret_placement, bf_error *err)
{
    scene_placement p = { .n = scene_parts(s) };

    p.poses = memory_alloc(p.n, sizeof *p.poses);
    if (p.poses == NULL)
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", p.n);
    bf_status status = mix_draw(s, p.n, &p.kinds, err);
    if (status != BF_OK) {
        placement_fini(&p);
        return status;
    }
    if (s->initial.type == SCENE_INITIAL_POSITIONS && p.n > 0)
        memcpy(p.poses, s->initial.poses, p.n * sizeof *p.poses);
    else if (s->initial.type == SCENE_INITIAL_HEXAGONAL)
        place_hexagonal(&s->initial, p.poses);
    else if (s->initial.type == SCENE_INITIAL_RANDOM)
        status = place_random(s, p.kinds, p.poses, err);
    if (status != BF_OK) {
        placement_fini(&p);
        return status;
    }
    *ret_placement = p;
    return BF_OK;
}

bf_status placement_of(const scene *s, scene_placement *ret_placement, bf_error *err)
{
    if (s->placement.n == 0)
        return placement_make(s, ret_placement, err);
    *ret_placement = s->placement;
    ret_placement->is_borrowed = true;
    return BF_OK;
}

void placement_fini(scene_placement *p)
{
    if (p == NULL)
        return;
    if (!p->is_borrowed) {
        memory_free(p->poses);
        memory_free(p->kinds);
    }
    *p = (scene_placement){ .n = 0 };
}

enum { REPORTED_MAX = 4 }; ///< faults of one kind that are reported

/// The state of the check.
typedef struct overlap_findings {
    const scene *s;
    const scene_placement *p;
    shape_footprint footprints[SCENE_KINDS_MAX];
    bf_faults *faults;
    size_t n_outside;
    size_t n_overlaps;
} overlap_findings;

/// Number of faults of one kind after which a check ends: 1 for a pattern, which is reported as a whole.
static size_t limit_reported(const scene *s)
{
    return s->initial.type == SCENE_INITIAL_POSITIONS ? REPORTED_MAX : 1;
}

static const shape_footprint *footprint_in(const overlap_findings *f, size_t k)
{
    return &f->footprints[mix_kind(f->p->kinds, k)];
}

/// The pointer of part k, in room of BF_POINTER_SIZE bytes where it must be made.
static const char *point_at(const scene *s, size_t k, char *room)
{
    if (s->initial.type == SCENE_INITIAL_HEXAGONAL)
        return "/initial/hexagonal";
    if (s->initial.type == SCENE_INITIAL_RANDOM)
        return "/initial/random";
    snprintf(room, BF_POINTER_SIZE, "/initial/positions_m/%zu", k);
    return room;
}

/// Note a part that extends over a side of the domain. Returns true if it does not.
static bool check_inside(overlap_findings *f, size_t k)
{
    static const char *const words[SCENE_SIDE_COUNT] = { "west", "east", "south", "north" };
    const surroundings around = surroundings_of(f->s);
    char room[BF_POINTER_SIZE];
    scene_pose at = f->p->poses[k];

    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        double excess = placement_excess(&around, footprint_in(f, k), at, side);
        if (excess <= SCENE_TOLERANCE)
            continue;
        f->n_outside++;
        if (f->s->edges[side] == SCENE_EDGE_WALL)
            faults_add(f->faults, point_at(f->s, k, room),
                       "part %zu at (%g, %g) m reaches %g m over the %s wall", k, at.x, at.y,
                       excess, words[side]);
        else
            faults_add(f->faults, point_at(f->s, k, room),
                       "part %zu at (%g, %g) m lies %g m outside the domain in the %s", k, at.x,
                       at.y, excess, words[side]);
        return false;
    }
    return true;
}

/// Note an overlap of part k with another. Returns true if there is none.
static bool check_free(overlap_findings *f, const overlap_grid *c, size_t k)
{
    scene_pose at = f->p->poses[k];
    char room[BF_POINTER_SIZE];
    size_t other;

    if (!overlap_grid_overlaps(c, k, at, &other))
        return true;
    scene_pose with = f->p->poses[other];
    double distance = vec2_length((vec2){ at.x - with.x, at.y - with.y });
    const char *pointer = point_at(f->s, k, room);
    f->n_overlaps++;
    const shape_footprint *own = footprint_in(f, k), *its = footprint_in(f, other);
    if (own->n_corners == 0 && its->n_corners == 0)
        faults_add(f->faults, pointer,
                   "part %zu at (%g, %g) m overlaps part %zu: they are %g m apart, the least is "
                   "%g m",
                   k, at.x, at.y, other, distance, own->bounding_radius + its->bounding_radius);
    else
        faults_add(f->faults, pointer, "part %zu at (%g, %g) m overlaps part %zu, %g m away", k,
                   at.x, at.y, other, distance);
    return false;
}

bf_status placement_check(const scene *s, const scene_placement *p, bf_faults *faults)
{
    overlap_findings f = { .s = s, .p = p, .faults = faults };
    size_t limit = limit_reported(s);
    overlap_grid c;

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
    double bounding_radius; ///< of the largest part, m
    place *places;
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

/// The first place at or beyond x.
static size_t find_first(const plate_findings *f, double x)
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

static void check_piece(plate_findings *f, const scene_obstacle *obstacle, const vec2 plate[4])
{
    scene_rect box = { INFINITY, -INFINITY, INFINITY, -INFINITY };
    size_t limit = limit_reported(f->s);
    char room[BF_POINTER_SIZE];

    for (int k = 0; k < 4; k++) {
        box.x_min = fmin(box.x_min, plate[k].x - f->bounding_radius);
        box.x_max = fmax(box.x_max, plate[k].x + f->bounding_radius);
        box.y_min = fmin(box.y_min, plate[k].y - f->bounding_radius);
        box.y_max = fmax(box.y_max, plate[k].y + f->bounding_radius);
    }
    for (size_t i = find_first(f, box.x_min);
         i < f->p->n && f->places[i].x <= box.x_max && f->n_reported < limit; i++) {
        size_t k = f->places[i].part;
        scene_pose at = f->p->poses[k];
        if (at.y < box.y_min || at.y > box.y_max ||
            !shape_overlaps_polygon(&f->footprints[mix_kind(f->p->kinds, k)], at, plate, 4))
            continue;
        f->n_reported++;
        faults_add(f->faults, point_at(f->s, k, room),
                   "part %zu at (%g, %g) m overlaps the plate of obstacle '%s', %g m thick", k,
                   at.x, at.y, obstacle->id, obstacle->thickness);
    }
}

bf_status placement_check_plates(const scene *s, const scene_placement *p, bf_faults *faults)
{
    plate_findings f = { .s = s, .p = p, .faults = faults };
    plate_pieces pieces;
    vec2 plate[4];

    bf_status status = plate_pieces_init(&pieces, s, NULL);
    f.places = status == BF_OK ? memory_alloc(p->n, sizeof *f.places) : NULL;
    if (f.places == NULL) {
        plate_pieces_fini(&pieces);
        return BF_ENOMEM;
    }
    mix_footprints(s, f.footprints);
    for (size_t k = 0; k < s->n_cargo; k++)
        f.bounding_radius = fmax(f.bounding_radius, f.footprints[k].bounding_radius);
    for (uint32_t k = 0; k < p->n; k++)
        f.places[k] = (place){ p->poses[k].x, k };
    qsort(f.places, p->n, sizeof *f.places, compare_places);
    for (size_t k = 0; k < s->n_obstacles; k++) {
        for (size_t m = 0; m + 1 < s->obstacles[k].n_points; m++) {
            if (plate_pieces_get(&pieces, k, m, plate))
                check_piece(&f, &s->obstacles[k], plate);
        }
    }
    memory_free(f.places);
    plate_pieces_fini(&pieces);
    return BF_OK;
}
