/// A spatial index of parts: whether a pose is free, and which parts are near a line. For feeds and photo eyes,
/// which ask between steps.
///
/// Parts are sorted into cells at the first question after they have moved; those that are admitted then
/// are compared one by one, until there are so many that all are sorted again.
///
/// Units    m.

#pragma once

#include "core/micro/backend.h"
#include "core/micro/neighbours.h"
#include "core/scene/shape.h"

enum { PART_INDEX_RECENT_MAX = 64 }; ///< parts that are compared one by one

/// A straight piece of a plate.
typedef struct part_index_piece {
    size_t obstacle; ///< index
    bool moves;      ///< scene_obstacle_moves()
    vec2 corners[4]; ///< as in the document, counter-clockwise, m
} part_index_piece;

/// The index. part_index_init(), part_index_fini().
typedef struct part_index {
    surroundings around;                    ///< domain and edges only
    shape_footprint *footprints;            ///< of every kind
    double radius_max;                      ///< of the disk around any part, m
    size_t n_pieces;                        ///< of all plates
    part_index_piece *pieces;               ///< see there
    bool is_sorted;                         ///< cells hold
    neighbours_cells cells;                 ///< of the parts in the domain, but recent ones
    size_t capacity;                        ///< room in centres
    vec2 *centres;                          ///< by handle, of the parts in cells
    size_t n_recent;                        ///< parts admitted since they were sorted
    uint32_t recent[PART_INDEX_RECENT_MAX]; ///< their handles
} part_index;

/// What a part covers at its pose: `flat`, the footprint of its kind, or where it is tilted the rectangle that holds it,
/// which is made in *room.
const shape_footprint *micro_footprint(const micro_extent *extent, const shape_footprint *flat,
                                       shape_footprint *room);

/// The parts of a solver.
typedef struct part_index_parts {
    const micro_backend *backend; ///< see there
    micro_common *state;          ///< of it
    size_t n;                     ///< handles
    double t;                     ///< time, s
} part_index_parts;

/// Prepare the index of a definition. BF_ENOMEM: *ret_index is empty.
BF_MUST_CHECK bf_status part_index_init(const micro_def *def, part_index *ret_index, bf_error *err);

/// Free what it owns and zero *p. NULL is fine.
void part_index_fini(part_index *p);

/// Note that a part of a kind was admitted.
void part_index_add(part_index *p, size_t part, uint32_t kind);

/// micro_is_free()
BF_MUST_CHECK bf_status part_index_find_free(part_index *p, const part_index_parts *parts,
                                             uint32_t kind, scene_pose pose, bool *ret_is_free,
                                             bf_error *err);

/// micro_visit_near()
BF_MUST_CHECK bf_status part_index_visit_near(part_index *p, const part_index_parts *parts, vec2 a,
                                              vec2 b, double distance, micro_visit *visit,
                                              void *context, bf_error *err);
