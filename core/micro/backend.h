/// The interface between micro.c and a path of the microscopic solver: one table for planar, one for spatial.

#pragma once

#include "core/base/checkpoint.h"
#include "core/micro/micro.h"
#include "core/micro/press.h"
#include "core/scene/surroundings.h"
#include "core/world/world.h"

/// What a handle stands for.
enum {
    MICRO_HERE, ///< a part in the domain
    MICRO_LEFT, ///< one that has left it
    MICRO_FREE, ///< one whose departure was reported
    MICRO_FELL, ///< one that has fallen off the belts
    MICRO_PRESENCE_COUNT
};

/// What every path's state begins with.
typedef struct micro_common {
    uint8_t *
        presence; ///< by handle: MICRO_HERE etc.; micro.c frees those of parts that have left, then forget_gone()
    surroundings around;    ///< a copy: belts and edges
    const bf_world *world;  ///< borrowed; that of the definition, or one in which nothing moves
    uint64_t steps;         ///< made since t = 0
    double largest_overlap; ///< of any contact since the start, m
    double overlap_share;   ///< see micro_totals
    double recent_overlap;  ///< the largest of these since micro.c set it to 0
} micro_common;

/// The functions of a path; state is what create() made. Meanings as in micro.h.
typedef struct micro_backend {
    /// Largest stable step of MICRO_VERLET, s; def is checked but for dt
    double (*dt_stable)(const micro_def *def);
    /// micro_create()
    bf_status (*create)(const micro_def *def, micro_common **ret_state, bf_error *err);
    /// micro_destroy()
    void (*destroy)(void *state);
    /// micro_advance()
    bf_status (*advance)(void *state, uint64_t n, bf_error *err);
    /// micro_part_of()
    micro_part (*part)(const void *state, size_t k);
    /// Where part k is on the belt
    micro_extent (*extent)(const void *state, size_t k);
    /// Add a part with the handle k: one that is free, or as many as there are. BF_ENOMEM: as before
    bf_status (*admit)(void *state, size_t k, const micro_arrival *arrival, bf_error *err);
    /// micro_take_out()
    void (*take_out)(void *state, size_t k);
    /// Erase what is stored from step to step of contacts with parts that have left
    void (*forget_gone)(void *state);
    /// micro_measure()
    micro_totals (*measure)(const void *state);
    /// Of the largest overlap of a step that was beyond overlap_limit: the handles as the ids, and where. The overlap is
    /// set by the caller.
    void (*press)(const void *state, micro_press *ret_press);
    /// Compute contacts with this modulus_reduction from now on. MICRO_IMPLICIT only; NULL: it never does.
    void (*harden)(void *state, double reduction);
    /// What parts do to an obstacle that moves now, by the springs of their contacts
    plate_load (*load_on)(void *state, size_t obstacle);
    /// Write the state but for what micro_common counts.
    void (*save)(const void *state, checkpoint_writer *w);
    /// Take a state with n handles that save() wrote, to the payload's end, after micro_common and before the first step;
    /// else as micro_load().
    bf_status (*load)(void *state, size_t n, checkpoint_reader *r, bf_error *err);
    checkpoint_kind kind; ///< of its checkpoints
} micro_backend;

/// Take over the largest overlap of some steps, m, and the largest overlap_share.
static inline void micro__take_overlaps(micro_common *c, double overlap, double relative)
{
    c->largest_overlap = overlap > c->largest_overlap ? overlap : c->largest_overlap;
    c->overlap_share = relative > c->overlap_share ? relative : c->overlap_share;
    c->recent_overlap = relative > c->recent_overlap ? relative : c->recent_overlap;
}

/// Whether an overlap since the start was beyond overlap_limit.
static inline bool micro__is_pressed(double overlap_share, const micro_def *def)
{
    return overlap_share > def->overlap_limit;
}

/// The fastest speed of any point of a plate, m/s, and whose it is.
double micro__plate_speed(const micro_def *def, size_t *ret_obstacle);

/// The velocity with which a part of the definition starts whose centre is there and that bridges gaps by its radius, m, and
/// its spin: those of the belt under it.
vec2 micro__start_velocity(const micro_def *def, const micro_common *of, vec2 at, double radius,
                           double *ret_spin);

/// The definition's world, or one in which nothing moves.
bf_world *micro__world(const micro_def *def);

/// For how many parts steps and iterations are chosen.
static inline size_t micro__n_expected(const micro_def *def)
{
    return def->n_parts_expected > 0 ? def->n_parts_expected : def->n_parts;
}

/// The definition without its arrays, which stay the caller's.
micro_def micro__without_arrays(const micro_def *def);

/// The definition's domain, edges and belts, copied: surroundings_fini(). BF_ENOMEM.
BF_MUST_CHECK bf_status micro__copy_surroundings(const micro_def *def, surroundings *ret_copy,
                                                 bf_error *err);

/// Upright cylinders on belts: disk/.
extern const micro_backend micro__disk;

/// Rigid bodies in 3-D: body/.
extern const micro_backend micro__body;
