/// Where parts are on the belt: whether a place is free, and which parts are near a line. For feeds and photo eyes,
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

enum { PLACES_RECENT_MAX = 64 }; ///< parts that are compared one by one

/// A straight piece of a plate.
typedef struct places_piece {
    size_t obstacle; ///< index
    bool moves;      ///< scene_obstacle_moves()
    vec2 corners[4]; ///< as in the document, counter-clockwise, m
} places_piece;

/// The places. places_init(), places_fini().
typedef struct places {
    surroundings around;                ///< domain and edges only
    shape_footprint *footprints;        ///< of every kind
    double radius_max;                  ///< of the disk around any part, m
    size_t n_pieces;                    ///< of all plates
    places_piece *pieces;               ///< see there
    bool is_sorted;                     ///< cells hold
    neighbours_cells cells;             ///< of the parts in the domain, but recent ones
    size_t capacity;                    ///< room in centres
    vec2 *centres;                      ///< by handle, of the parts in cells
    size_t n_recent;                    ///< parts admitted since they were sorted
    uint32_t recent[PLACES_RECENT_MAX]; ///< their handles
} places;

/// What a part covers at its pose: `flat`, the footprint of its kind, or where it is tilted the rectangle that holds it,
/// which is made in *room.
const shape_footprint *micro_footprint(const micro_place *place, const shape_footprint *flat,
                                       shape_footprint *room);

/// The parts of a solver.
typedef struct places_parts {
    const micro_backend *backend; ///< see there
    micro_common *state;          ///< of it
    size_t n;                     ///< handles
    double t;                     ///< time, s
} places_parts;

/// Prepare the places of a definition. BF_ENOMEM: *ret_places is empty.
BF_MUST_CHECK bf_status places_init(const micro_def *def, places *ret_places, bf_error *err);

/// Free what they own and zero *p. NULL is fine.
void places_fini(places *p);

/// Note that a part of a kind was admitted.
void places_add(places *p, size_t part, uint32_t kind);

/// micro_is_free()
BF_MUST_CHECK bf_status places_find_free(places *p, const places_parts *parts, uint32_t kind,
                                         scene_pose pose, bool *ret_is_free, bf_error *err);

/// micro_visit_near()
BF_MUST_CHECK bf_status places_visit_near(places *p, const places_parts *parts, vec2 a, vec2 b,
                                          double distance, micro_visit *visit, void *context,
                                          bf_error *err);
