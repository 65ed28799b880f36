/// Parts that lie on the belt, and the question whether one more overlaps any of them, answered by a
/// hashed grid of cells: in constant time, however many there are.

#pragma once

#include "core/scene/scene.h"
#include "core/scene/shape.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// The parts. Free with overlap_grid_fini().
typedef struct crowd {
    const shape_footprint *footprints; ///< of every kind; borrowed
    const uint32_t *kinds;             ///< of parts 0, 1, ..., NULL: all are of kind 0; borrowed
    const scene_pose *poses;           ///< places of parts 0, 1, ...; borrowed
    double cell;                       ///< edge of a grid cell, m
    size_t n_buckets;                  ///< a power of two
    uint32_t *heads;                   ///< first part of each bucket
    uint32_t *next;                    ///< next part of the same bucket
} crowd;

/// An empty crowd with room for n parts of n_kinds kinds, whose places will stand in poses.
/// BF_ENOMEM.
BF_MUST_CHECK bf_status overlap_grid_init(crowd *ret_crowd, const shape_footprint *footprints,
                                          size_t n_kinds, const uint32_t *kinds,
                                          const scene_pose *poses, size_t n, bf_error *err);

/// Free the crowd; NULL is fine.
void overlap_grid_fini(crowd *c);

/// True if the part of that number, put at pose, would overlap one of the crowd by more than
/// SCENE_TOLERANCE; *ret_other is then which one.
bool overlap_grid_overlaps(const crowd *c, size_t part, scene_pose pose, size_t *ret_other);

/// Put part k, with its place in poses, into the crowd.
void overlap_grid_add(crowd *c, size_t k);
