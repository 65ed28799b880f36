/// A set of parts, and whether one more would overlap any of them: by a hashed grid of cells, in constant
/// time for any number of parts.

#pragma once

#include "core/scene/scene.h"
#include "core/scene/shape.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// The set. Free with overlap_grid_fini().
typedef struct overlap_grid {
    const shape_footprint *footprints; ///< of every kind; borrowed
    const uint32_t *kinds;             ///< of parts 0, 1, ..., NULL: all are of kind 0; borrowed
    const scene_pose *poses;           ///< places of parts 0, 1, ...; borrowed
    double cell;                       ///< edge of a grid cell, m
    size_t n_buckets;                  ///< a power of two
    uint32_t *heads;                   ///< first part of each bucket
    uint32_t *next;                    ///< next part of the same bucket
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
bool overlap_grid_overlaps(const overlap_grid *c, size_t part, scene_pose pose, size_t *ret_other);

/// Add part k, with its place in poses, to the set.
void overlap_grid_add(overlap_grid *c, size_t k);
