#include "core/scene/overlap_grid.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/scene/mix.h"

#include <math.h>
#include <string.h>

#define NO_PART UINT32_MAX

// Steps of a search: to begin it, for a cell, for a part in it, for a corner of two outlines.
enum { STEPS_BEGIN = 10, STEPS_CELL = 2, STEPS_PART = 2, STEPS_CORNER = 4 };

/// A part whose place is tried.
typedef struct candidate {
    const shape_footprint *footprint;
    vec2 centre;
    vec2 corners[SCENE_VERTICES_MAX + 1]; ///< where it would lie
} candidate;

static bool are_disks(const overlap_grid *c, size_t n_kinds)
{
    bool are = true;

    for (size_t k = 0; k < n_kinds; k++)
        are = are && c->footprints[k].n_corners == 0;
    return are;
}

bf_status overlap_grid_init(overlap_grid *ret_grid, const shape_footprint *footprints,
                            size_t n_kinds, const uint32_t *kinds, const scene_pose *poses,
                            size_t n, bf_error *err)
{
    overlap_grid c = { .footprints = footprints, .kinds = kinds, .poses = poses };
    const bool needs_directions = !are_disks(&c, n_kinds);

    // Kinds go to the level whose cells are their diameter to twice it.
    double largest = 0.0;
    for (size_t k = 0; k < n_kinds; k++)
        largest = fmax(largest, c.footprints[k].bounding_radius);
    c.radius_max = largest;
    for (size_t k = 0; k < n_kinds; k++) {
        const double radius = c.footprints[k].bounding_radius;
        const double halvings = fmin(floor(log2(largest / radius)), OVERLAP_LEVELS_MAX - 1);
        overlap_level *level = &c.levels[(size_t)halvings];
        c.level_of[k] = (uint8_t)halvings;
        level->cell = 2.0 * largest / exp2(halvings);
        level->radius = fmax(level->radius, radius);
    }
    c.n_buckets = 16;
    while (c.n_buckets < 2 * n)
        c.n_buckets *= 2;
    c.buckets = memory_alloc(c.n_buckets, sizeof *c.buckets);
    c.entries = memory_alloc(n, sizeof *c.entries);
    if (needs_directions)
        c.directions = memory_alloc(n, sizeof *c.directions);
    if (c.buckets == NULL || c.entries == NULL || (needs_directions && c.directions == NULL)) {
        overlap_grid_fini(&c);
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", n);
    }
    memset(c.buckets, 0xff, c.n_buckets * sizeof *c.buckets);
    *ret_grid = c;
    return BF_OK;
}

void overlap_grid_fini(overlap_grid *c)
{
    if (c == NULL)
        return;
    memory_free(c->buckets);
    memory_free(c->entries);
    memory_free(c->directions);
    *c = (overlap_grid){ 0 };
}

// Neighbours in a row are neighbours in memory.
static size_t find_bucket(const overlap_grid *c, size_t level, int64_t column, int64_t row)
{
    uint64_t mixed = ((uint64_t)row * OVERLAP_LEVELS_MAX + level) * UINT64_C(0x9e3779b97f4a7c15);

    return (size_t)((mixed ^ mixed >> 32) + (uint64_t)column) & (c->n_buckets - 1);
}

static int64_t cell_at(const overlap_level *level, double place)
{
    return (int64_t)floor(place / level->cell);
}

/// shape_overlaps(), with the directions that are known.
static bool overlaps_part(overlap_grid *c, const candidate *own, size_t k)
{
    const shape_footprint *other = &c->footprints[c->entries[k].kind];
    const vec2 at = c->entries[k].centre;
    vec2 corners[SCENE_VERTICES_MAX + 1];

    c->steps += STEPS_PART;
    if (vec2_length(vec2_sub(at, own->centre)) >=
        own->footprint->bounding_radius + other->bounding_radius - SCENE_TOLERANCE)
        return false;
    if (own->footprint->n_corners == 0 && other->n_corners == 0)
        return true;
    c->steps += STEPS_CORNER * (own->footprint->n_corners + other->n_corners);
    if (other->n_corners == 0)
        return polygon_overlaps_disk(at, other->bounding_radius, own->corners,
                                     own->footprint->n_corners, SCENE_TOLERANCE);
    shape_place_along(other, at, c->directions[k], corners);
    if (own->footprint->n_corners == 0)
        return polygon_overlaps_disk(own->centre, own->footprint->bounding_radius, corners,
                                     other->n_corners, SCENE_TOLERANCE);
    return polygon_overlaps(own->corners, own->footprint->n_corners, corners, other->n_corners,
                            SCENE_TOLERANCE);
}

// True if the first part of the bucket is too far away for certain, whatever it is and however its place was rounded.
static bool is_far(const overlap_grid *c, const candidate *own, const overlap_bucket *bucket)
{
    const double radii = own->footprint->bounding_radius + c->radius_max;
    const double slack = 1e-6 * (fabs(own->centre.x) + fabs(own->centre.y) + radii);
    const double dx = (double)bucket->x - own->centre.x, dy = (double)bucket->y - own->centre.y;

    return dx * dx + dy * dy > (radii + slack) * (radii + slack);
}

static bool overlaps_in_bucket(overlap_grid *c, const candidate *own, const overlap_bucket *bucket,
                               size_t *ret_other)
{
    uint32_t k = bucket->first;

    if (k != NO_PART && is_far(c, own, bucket)) {
        c->steps += STEPS_PART; // as if it had been looked at
        k = bucket->next;
    }
    for (; k != NO_PART; k = c->entries[k].next) {
        if (overlaps_part(c, own, k)) {
            *ret_other = k;
            return true;
        }
    }
    return false;
}

static bool overlaps_in_level(overlap_grid *c, size_t level, const candidate *own,
                              size_t *ret_other)
{
    const overlap_level *l = &c->levels[level];
    const double range = own->footprint->bounding_radius + l->radius;
    const int64_t column_end = cell_at(l, own->centre.x + range);
    const int64_t row_end = cell_at(l, own->centre.y + range);

    for (int64_t row = cell_at(l, own->centre.y - range); row <= row_end; row++) {
        for (int64_t i = cell_at(l, own->centre.x - range); i <= column_end; i++) {
            c->steps += STEPS_CELL;
            if (overlaps_in_bucket(c, own, &c->buckets[find_bucket(c, level, i, row)], ret_other))
                return true;
        }
    }
    return false;
}

bool overlap_grid_overlaps(overlap_grid *c, size_t part, scene_pose pose, size_t *ret_other)
{
    candidate own;

    own.footprint = &c->footprints[mix_kind(c->kinds, part)];
    own.centre = (vec2){ pose.x, pose.y };
    shape_place(own.footprint, pose, own.corners);
    c->steps += STEPS_BEGIN + own.footprint->n_corners;
    for (size_t level = 0; level < OVERLAP_LEVELS_MAX; level++) {
        if (c->levels[level].radius > 0.0 && overlaps_in_level(c, level, &own, ret_other))
            return true;
    }
    return false;
}

void overlap_grid_add(overlap_grid *c, size_t k)
{
    const uint32_t kind = (uint32_t)mix_kind(c->kinds, k);
    const size_t level = c->level_of[kind];
    const overlap_level *l = &c->levels[level];
    overlap_bucket *bucket =
        &c->buckets[find_bucket(c, level, cell_at(l, c->poses[k].x), cell_at(l, c->poses[k].y))];

    if (c->directions != NULL)
        c->directions[k] = shape_direction(c->poses[k].heading);
    c->entries[k] = (overlap_entry){ { c->poses[k].x, c->poses[k].y }, bucket->first, kind };
    *bucket =
        (overlap_bucket){ (uint32_t)k, bucket->first, (float)c->poses[k].x, (float)c->poses[k].y };
}
