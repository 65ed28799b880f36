/// Inside of the planar path: upright cylinders on belts, each a disk with position, heading, velocity
/// and spin in the plane.
///
///     contact   delta = r_i + r_j - dist, f = max(k delta - d v_n, 0) (no clamp with tension)
///               v_n = relative velocity along n, n from i to j
///     friction  -mu |f| tanh(lambda u), u = relative velocity along the tangent of the surfaces in the
///               contact point, spins included; the point is the middle of the overlap, so its
///               levers r - delta/2 add up to dist and angular momentum is conserved
///     belt      a = -mu g tanh(lambda |s|) s/|s|, s = velocity relative to the belt under the centre
///     spin      w+ = W + (w~ - W) / (1 + dt A tanh(lambda |w~ - W|)/|w~ - W|), W that of the belt under the
///               centre, w~ = (1 - D)^dt w + dt Theta^-1 (torque), A = mu r_spin m g / Theta: (8),
///               implicit and never past W
///
/// Velocity is that of the last half step, (x - x-)/dt: (12) is then v+ = (1 - D dt) v + dt F(x, v)/m,
/// x+ = x + dt v+, the same numbers with less rounding, and the first step by forward Euler is the one
/// without forces and torques.
///
/// Ids      a part has a fixed id, which is its handle in micro.h, and a slot, where it is stored. Slots are
///          sorted in space whenever the list of neighbours is made, and come in groups of DISK_GROUP:
///          live parts at 0 .. n_live - 1; then padding up to n_padded (far away, without effect); then
///          parts that have left, in their last state, and those that were admitted since.
/// List     Everything that depends on the positions of parts (neighbours, candidates for the boundary, parts
///          at borders, belts) is made together by disk__rebuild() and holds as long as
///          neighbours_holds() says of displacement_bound, to which the travel of plates that move is added.
/// Sums     over features of the boundary first, in their order, then over neighbours by their ids, so
///          that results depend neither on the order of slots nor on when a list was made.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/memory.h"
#include "core/micro/backend.h"
#include "core/micro/contact_law.h"
#include "core/micro/disk/boundary.h"
#include "core/micro/disk/kernels.h"
#include "core/micro/micro.h"
#include "core/micro/neighbours.h"
#include "core/scene/surroundings.h"

enum { DISK_PARTITIONS_MAX = 64 }; ///< threads that advance the parts together

/// Parameters of contacts besides those of the parts: k = line / (compliance of one + compliance of the other).
typedef struct disk_law {
    double line;        ///< pi/4 l, m
    double damping;     ///< d, N s/m
    double friction;    ///< mu
    double tanh_linear; ///< lambda_lin, s/m
} disk_law;

/// Parameters of a kind of part.
typedef struct disk_kind {
    disk part;                ///< radius, compliance and inverse mass; the rest is 0
    double spin_deceleration; ///< A, rad/s2
    double height;            ///< m
} disk_kind;

/// A part that may touch a face or an arc before the list is rebuilt.
typedef struct disk_candidate {
    uint32_t slot;    ///< of the part
    uint32_t feature; ///< face, or n_faces + arc
} disk_candidate;

/// Where a part near a border is.
typedef enum disk_presence {
    DISK_HERE,  ///< in the domain
    DISK_GONE,  ///< it left or fell
    DISK_GOING, ///< it did in a step that may be undone
} disk_presence;

/// A part near an open edge or the border of a belt, or under which no belt lies: checked after each step.
typedef struct disk_border_part {
    uint32_t slot;      ///< of the part
    disk_presence gone; ///< unless DISK_HERE, part and heading are what it left with
    double heading;     ///< rad
    disk part;          ///< see gone
} disk_border_part;

/// The slots that one thread advances.
typedef struct disk_partition {
    size_t group_first;     ///< groups group_first <= g < group_last
    size_t group_last;      ///< see there
    size_t candidate_first; ///< candidates of its parts
    size_t candidate_last;  ///< see there
    size_t border_first;    ///< border parts among them
    size_t border_last;     ///< see there
} disk_partition;

/// What several steps in one pass need, see explicit.c.
typedef struct disk_tiling {
    struct disk_backup *backup; ///< by slot; NULL: steps are made one by one
    disk_belts *belts;          ///< room for those of each step of a tile
    struct disk_block *blocks;  ///< n_blocks of the present list, and one more
    size_t n_blocks;            ///< see there
    size_t lead;                ///< how far a step may be ahead of the next one, blocks
    int n_steps;                ///< of a tile; fewer than 2: none fits
    uint64_t n_made;            ///< tiles whose steps were accepted
    uint64_t n_put_back;        ///< tiles that were undone
} disk_tiling;

/// The planar solver.
struct disk_state {
    micro_common common;         ///< see there
    micro_def def;               ///< without its arrays
    disk_law cargo;              ///< cargo on cargo
    disk_law handling;           ///< cargo on obstacles and walls
    double handling_compliance;  ///< as in disk
    micro_law belt;              ///< cargo on belts; its stiffness is not used
    double spin_damping;         ///< (1 - D)^dt
    bool is_uniform;             ///< one kind, one straight belt or none all over, no tension
    bool has_turning;            ///< a belt turns
    bool has_slopes;             ///< a belt is not level
    uint16_t uniform_belt;       ///< index of the belt under all parts if is_uniform
    double uniform_deceleration; ///< A if is_uniform, rad/s2
    size_t n;                    ///< parts, gone ones included
    size_t capacity;             ///< parts that there is room for
    size_t n_live;               ///< live ones when the list was made: the slots below
    size_t n_padded;             ///< n_live rounded up to a multiple of DISK_GROUP
    uint32_t void_slot;          ///< far away from everything, the last one
    disk *now;                   ///< parts at the present time, by slot
    disk *next;                  ///< where an explicit step writes (disk__swap() afterwards)
    double *heading;             ///< rad, by slot
    double *spin_deceleration;   ///< A of (8), rad/s2, by slot; NULL if is_uniform
    uint16_t *belt_under;      ///< index of a belt, by slot, n_belts of padding; NULL if is_uniform
    memory_block scratch;      ///< of a rebuild; then of implicit steps
    uint8_t *has_candidates;   ///< by group: nonzero if its parts have candidates
    uint32_t *id_of;           ///< id of the part in each slot; UINT32_MAX: padding
    uint32_t *slot_of;         ///< slot of each part
    bool is_stale;             ///< parts were admitted or taken out since the list was made
    size_t n_kinds;            ///< kinds of parts
    disk_kind *kinds;          ///< see there
    uint32_t *kind_of;         ///< by id; NULL: there is one kind
    disk_list list;            ///< neighbours
    double skin;               ///< m
    double displacement_bound; ///< m, no part has moved farther since the list was made
    double last_bound;         ///< m, nor in the last explicit step; INFINITY: not known
    double radius_max;         ///< m, of any kind
    double radius_min;         ///< m, of any kind
    size_t n_faces;            ///< of the boundary
    disk_face *faces;          ///< see there
    size_t n_arcs;             ///< of the boundary
    disk_arc *arcs;            ///< see there
    disk_plates plates;        ///< those that move
    size_t n_candidates;       ///< sorted by slot, then by feature
    size_t candidates_capacity;                     ///< room
    disk_candidate *candidates;                     ///< see there
    size_t n_border_parts;                          ///< sorted by slot
    size_t border_parts_capacity;                   ///< room
    disk_border_part *border_parts;                 ///< see there
    disk_belts belts;                               ///< at v_T
    neighbours_cells cells;                         ///< storage of the grid
    int n_partitions;                               ///< threads that take part
    disk_partition partitions[DISK_PARTITIONS_MAX]; ///< one each
    const explicit_kernels *kernels;                ///< of explicit steps
    disk_extremes_line *extremes; ///< scratch: of two explicit steps, DISK_PARTITIONS_MAX each
    disk_tiling tiling;           ///< of explicit steps
    uint64_t n_builds;            ///< how often the list was made
    void *implicit;               ///< an implicit_state; NULL at first
};

/// Make the list and all that depends on positions from the parts in `now`: sorts them, stores the final state of
/// those that have left or whose centre is outside, sets displacement_bound = 0. Any slot may change. BF_ENOMEM: the
/// list is unusable until a call succeeds.
BF_MUST_CHECK bf_status disk__rebuild(disk_state *s, bf_error *err);

/// The candidates and the border parts, with the belts under all parts, of the present cells. BF_ENOMEM: incomplete.
BF_MUST_CHECK bf_status disk__find_candidates(disk_state *s);
BF_MUST_CHECK bf_status disk__find_border_parts(disk_state *s);

/// After a step was written into `parts` (and headings): check the border parts first .. last - 1. Parts
/// that left or fell are frozen in their disk_border_part, which then says `left`, and moved far away and to rest in
/// `parts`; those at the border of a belt get the belt that is now under them. Does not modify other parts.
void disk__update_border_parts(disk_state *s, disk *parts, size_t first, size_t last,
                               disk_presence left);

/// Index of the belt that carries a part: surroundings_belt_under().
uint16_t disk__belt_under(const disk_state *s, const disk *part);

/// The belts in a step, before which n_before were made: s->belts or, where speeds change, in *room.
const disk_belt *disk__belts_in_step(const disk_state *s, uint64_t n_before, disk_belts *room);

/// A part far away and at rest, at a different place for each slot, without contacts.
disk disk__pad(const disk_state *s, size_t slot);

/// Put all parts into the slots of their ids, with what belongs to their kinds and without position and
/// velocity; disk__rebuild() must follow.
void disk__fill_slots(disk_state *s);

/// Kind of the part with an id.
static inline const disk_kind *disk__kind_of(const disk_state *s, size_t id)
{
    return &s->kinds[s->kind_of != NULL ? s->kind_of[id] : 0];
}

/// Rows of the list for the part in a slot.
static inline size_t disk__n_rows(const disk_state *s, size_t slot)
{
    size_t g = slot / DISK_GROUP;
    return s->list.first[g + 1] - s->list.first[g];
}

/// The neighbour in a row; void_slot if there is none.
static inline uint32_t disk__neighbour(const disk_state *s, size_t slot, size_t row)
{
    size_t at = (s->list.first[slot / DISK_GROUP] + row) * DISK_GROUP + slot % DISK_GROUP;
    return s->list.neighbour[at] / DISK_DOUBLES;
}

/// `next` becomes `now`.
static inline void disk__swap(disk_state *s)
{
    disk *parts = s->now;
    s->now = s->next;
    s->next = parts;
}

/// The pairs of the present list, for MICRO_VERLET. BF_ENOMEM: incomplete.
BF_MUST_CHECK bf_status disk__pair_up(disk_state *s);

/// Allocate the data of tiles, in use from the next rebuild on. BF_ENOMEM: steps will be made one by one.
BF_MUST_CHECK bf_status disk__tiling_init(disk_state *s);
void disk__tiling_fini(disk_state *s); ///< Free it.
void disk__plan_tiles(disk_state *s);  ///< Compute the tiles of the current list, if in use.

/// driver_solver.check: a part is not finite, moves by more than half the smallest radius in a step, or overlaps by
/// more than overlap_limit.
BF_MUST_CHECK bf_status disk__check(const void *state, bf_error *err);

/// micro_backend.press
void disk__press(const void *state, micro_press *ret_press);

/// The iterations in an implicit step for the present modulus_reduction.
void disk__set_iterations(disk_state *s);

/// Make n steps with MICRO_VERLET, or with MICRO_IMPLICIT. Errors as of micro_advance().
BF_MUST_CHECK bf_status disk__advance_explicit(disk_state *s, uint64_t n, bf_error *err);
BF_MUST_CHECK bf_status disk__advance_implicit(disk_state *s, uint64_t n, bf_error *err);

/// Free s->implicit; NULL is fine.
void disk__implicit_fini(disk_state *s);

/// Largest stable step of MICRO_VERLET for a checked definition of cylinders, s.
double disk__dt_stable_explicit(const micro_def *def);
