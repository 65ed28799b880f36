/// State of MICRO_IMPLICIT in the plane: pairs of parts and their impulses. The equations are in implicit.c.
///
/// Order    pairs stand in groups, solved one after the other. In no group but the last one does a
///          part occur twice, so that its contacts may be solved in any order, many at once, by any
///          thread: first those with the boundary (a part's first candidate, its second ...), then the
///          colours of a greedy colouring of the pairs of parts. The last group has the pairs without a
///          colour, which are solved one by one in their order. Threads divide the pieces of a group among themselves.
/// Blocks   IMPLICIT_WIDTH pairs of a piece are processed in registers together. In a step the pairs that are in contact
///          are brought to the front of their piece; the others stand at its end, behind at least one empty lane.
/// State    The pairs with their groups and impulses outlive a step and are saved; the rest is scratch, in
///          disk_state.scratch. Pairs are selected again, and disk__rebuild() is called, by their own displacement_bound,
///          which is saved too, so that other rebuilds of the list have no influence.

#pragma once

#include "core/base/memory.h"
#include "core/base/simd_rows.h"
#include "core/micro/disk/parts.h"

enum {
    IMPLICIT_BOUNDARY = 4, ///< groups 0 .. 3: contacts with the boundary
    IMPLICIT_COLOURS = 31, ///< groups from IMPLICIT_BOUNDARY on
    /// group of pairs without a colour, one contact a block
    IMPLICIT_REST = IMPLICIT_BOUNDARY + IMPLICIT_COLOURS,
    IMPLICIT_GROUPS = 36,  ///< all of them
    IMPLICIT_PIECE = 1024, ///< most pairs of a piece but the last
    IMPLICIT_CHUNK = 1024, ///< slots that a thread takes at a time, a multiple of IMPLICIT_WIDTH
    IMPLICIT_FEATURE = 1 << 30, ///< ids from here on are features of the boundary
};

_Static_assert((int)IMPLICIT_FEATURE > (int)SCENE_PARTS_MAX, "ids of parts are below");

/// Two parts, or a part and a feature of the boundary, that may touch before pairs are selected again.
typedef struct implicit_pair {
    uint32_t id[2]; ///< of the parts, rising; a feature has id IMPLICIT_FEATURE + feature
    double normal;  ///< impulse of the last step, N s
    double sliding; ///< same, along the tangent (normal turned left)
} implicit_pair;

/// True for a part and a feature of the boundary.
static inline bool implicit_is_at_boundary(const implicit_pair *pair)
{
    return pair->id[1] >= IMPLICIT_FEATURE;
}

/// Pairs of one group.
typedef struct implicit_piece {
    size_t block;         ///< first block
    size_t n_blocks;      ///< for its pairs and, but in the last group, one more
    size_t n;             ///< pairs
    size_t n_front;       ///< pairs at the front, those in contact; the others stand at the end
    size_t law;           ///< of the first block
    bool is_one_law;      ///< that of all blocks
    bool is_rest;         ///< of the last group: all pairs at the front, solved one by one
    uint32_t static_body; ///< row of bodies that no other piece of the group uses
    double overlap;       ///< largest at the start of this step, m
    double overlap_share; ///< largest overlap / smaller radius
} implicit_piece;

/// What disk_state.implicit points to.
typedef struct implicit_state {
    bool is_current; ///< rows of pairs are those of the present list, and there is scratch
    bool is_chosen;  ///< pairs were chosen; false at first
    double skin;     ///< m, of the list that pairs are chosen from
    double displacement_bound;               ///< m, no part has moved farther since they were
    double last_bound;                       ///< m, nor in the last step
    const implicit_kernels *kernels;         ///< those of this processor
    implicit_step step;                      ///< without its belts: the same in every step
    int iterations;                          ///< in a step
    size_t group[IMPLICIT_GROUPS + 1];       ///< pairs before each group, and all
    size_t group_piece[IMPLICIT_GROUPS + 1]; ///< pieces before each group, and all
    implicit_piece *pieces;                  ///< see there
    size_t pieces_capacity;                  ///< room
    implicit_block *blocks;                  ///< by pieces; rows are ids unless is_current
    size_t blocks_capacity;                  ///< room
    implicit_law *laws;          ///< scratch: that of two parts if there is one kind, and by blocks
    implicit_contacts *contacts; ///< scratch, by blocks
    implicit_bodies bodies;      ///< scratch, by slot
    size_t first_feature;        ///< rows of bodies from there on stand for the boundary
    uint32_t *features;          ///< scratch, of these rows
    driver_extremes *extremes;   ///< scratch, of each chunk of slots
} implicit_state;

/// The block and the lane of pair k of a piece.
static inline implicit_block *implicit_lane(const implicit_state *z, const implicit_piece *p,
                                            size_t k, size_t *ret_lane)
{
    const size_t at = k < p->n_front ? k : k + p->n_blocks * IMPLICIT_WIDTH - p->n;

    *ret_lane = at % IMPLICIT_WIDTH;
    return &z->blocks[p->block + at / IMPLICIT_WIDTH];
}

/// The row of a body of a pair, at end 0 or 1.
static inline size_t implicit_body(const implicit_block *block, int end, size_t lane)
{
    return block->row[end][lane] / SIMD_QUAD;
}

/// Pair k of a piece.
implicit_pair disk_implicit__pair(const disk_state *s, const implicit_state *z,
                                  const implicit_piece *p, size_t k);

/// Let the pairs be selected again before the next step.
void disk_implicit__forget_choice(implicit_state *z);

/// Erase the impulses of parts that have left.
void disk_implicit__forget_gone(const disk_state *s, implicit_state *z);

/// Make the state; NULL: no memory.
implicit_state *disk_implicit__create(const disk_state *s);

/// Select the pairs again from the list and the candidates, which must be current; pairs that existed
/// before retain their impulses. is_current must be false and stays so. BF_ENOMEM: they are of no use until a call
/// succeeds, with the same impulses.
BF_MUST_CHECK bf_status disk_implicit__choose(disk_state *s, implicit_state *z, bf_error *err);

/// Find the rows of pairs on the present list, and take disk_state.scratch for steps: is_current. BF_ENOMEM: as before.
BF_MUST_CHECK bf_status disk_implicit__locate(disk_state *s, implicit_state *z, bf_error *err);

/// Give that back before the list is rebuilt: rows become ids.
void disk_implicit__unlocate(const disk_state *s, implicit_state *z);

/// Cut groups of pairs into pieces, with room for the pairs, which disk_implicit__set_pair() must set; is_current must
/// be false. BF_ENOMEM: as before.
BF_MUST_CHECK bf_status disk_implicit__cut(const disk_state *s, implicit_state *z,
                                           const size_t group[IMPLICIT_GROUPS + 1], bf_error *err);

/// Set pair k of a piece; is_current must be false.
void disk_implicit__set_pair(implicit_state *z, const implicit_piece *p, size_t k,
                             const implicit_pair *pair);

/// Set the law of pairs of parts of the first kind, z->laws[0].
void disk_implicit__set_common_law(const disk_state *s, implicit_state *z);

/// Set the law of a pair whose bodies have a gap, m.
void disk_implicit__set_law(const disk_state *s, const implicit_state *z,
                            const implicit_block *block, size_t lane, double gap,
                            implicit_law *law);

/// Contacts of a piece: pairs whose surfaces come nearer than `margin`, m, with the impulses of the last step,
/// which are applied to the bodies.
void disk_implicit__find_contacts(const disk_state *s, implicit_state *z, size_t piece,
                                  double margin);

/// One iteration over the contacts of a piece, with an over-relaxation of 1 + excess.
void disk_implicit__solve(implicit_state *z, size_t piece, double excess);

/// Count the contacts of all pairs of parts.
void disk_implicit__count_contacts(const disk_state *s, const implicit_state *z,
                                   disk_contacts *all);

/// Write what MICRO_IMPLICIT needs beyond parts, headings and steps: the impulses of the last step, and which
/// pairs are selected; nothing if s->implicit is NULL.
void disk_implicit__save(const disk_state *s, checkpoint_writer *w);

/// Load that, to the end of the payload, for the parts of a state without s->implicit. BF_ECORRUPT, BF_ENOMEM: the state
/// can only be destroyed.
BF_MUST_CHECK bf_status disk_implicit__load(disk_state *s, checkpoint_reader *r, bf_error *err);
