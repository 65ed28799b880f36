/// A set of parts, and whether one more would overlap any of them: by hashed grids of cells, one for each size of
/// parts, so that a large part among many small ones does not make cells that hold thousands of them.
///
/// The time of a search grows with the parts that lie near. It is counted in steps (a few nanoseconds each), by which
/// callers limit their work: the same scenario takes the same steps everywhere.

#pragma once

#include "core/scene/scene.h"
#include "core/scene/shape.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { OVERLAP_LEVELS_MAX = 8 }; ///< grids

/// A grid for parts whose size is within a factor of 2.
typedef struct overlap_level {
    double cell;   ///< edge of a cell, m
    double radius; ///< largest bounding radius of its kinds, m; 0: there are none
} overlap_level;

/// A part in the set.
typedef struct overlap_entry {
    vec2 centre;   ///< m
    uint32_t next; ///< part of the same bucket
    uint32_t kind; ///< of it
} overlap_entry;

/// The first part of a bucket with about its place, so that most searches need not look for its entry, which of a million
/// parts no cache has.
typedef struct overlap_bucket {
    uint32_t first; ///< part; UINT32_MAX: there is none
    uint32_t next;  ///< part of the same bucket
    float x;        ///< m
    float y;        ///< m
} overlap_bucket;

/// The set. Free with overlap_grid_fini().
typedef struct overlap_grid {
    const shape_footprint *footprints; ///< of every kind; borrowed
    const uint32_t *kinds;             ///< of parts 0, 1, ..., NULL: all are of kind 0; borrowed
    const scene_pose *poses;           ///< places of parts 0, 1, ...; borrowed
    overlap_level levels[OVERLAP_LEVELS_MAX]; ///< the largest parts first
    uint8_t level_of[SCENE_KINDS_MAX];        ///< of every kind
    size_t n_buckets;                         ///< a power of two
    double radius_max;                        ///< largest bounding radius, m
    overlap_bucket *buckets;                  ///< by hashes of cells
    overlap_entry *entries;                   ///< of the parts in the set, by their numbers
    vec2 *directions;                         ///< of the parts in the set; NULL: all are disks
    uint64_t steps;                           ///< that searches have taken
} overlap_grid;

/// An empty set with room for n parts of n_kinds kinds, whose places will stand in poses.
/// BF_ENOMEM.
BF_MUST_CHECK bf_status overlap_grid_init(overlap_grid *ret_grid, const shape_footprint *footprints,
                                          size_t n_kinds, const uint32_t *kinds,
                                          const scene_pose *poses, size_t n, bf_error *err);

/// Free the set; NULL is fine.
void overlap_grid_fini(overlap_grid *c);

/// True if the part of that number, placed at pose, would overlap one of the set by more than
/// SCENE_TOLERANCE; *ret_other is then which one.
bool overlap_grid_overlaps(overlap_grid *c, size_t part, scene_pose pose, size_t *ret_other);

/// Add part k, with its place in poses, to the set.
void overlap_grid_add(overlap_grid *c, size_t k);
