/// The straight pieces of plates as they stand at t = 0.

#pragma once

#include "core/base/status.h"
#include "core/scene/plate_motion.h"
#include "core/scene/surroundings.h"

#include <stdbool.h>
#include <stddef.h>

/// The plates of a scene at t = 0. Begin with plate_pieces_init().
typedef struct plate_pieces {
    const scene *s;      ///< borrowed
    surroundings around; ///< of the scene
    plate_motion motion; ///< of its obstacles
} plate_pieces;

/// BF_ENOMEM; *ret_pieces is then empty. The caller owns it: plate_pieces_fini(). The scene must outlive it.
BF_MUST_CHECK bf_status plate_pieces_init(plate_pieces *ret_pieces, const scene *s, bf_error *err);

/// Free what *pieces owns.
void plate_pieces_fini(plate_pieces *pieces);

/// The corners of piece k of an obstacle's plate, counter-clockwise. False: the obstacle is not there.
bool plate_pieces_get(const plate_pieces *pieces, size_t obstacle, size_t k, vec2 ret_corners[4]);

/// Same of an obstacle at a place, whether it is there or not.
void plate_pieces_placed(const plate_pieces *pieces, size_t obstacle, size_t k,
                         plate_motion_place place, vec2 ret_corners[4]);
