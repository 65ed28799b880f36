/// State of MICRO_IMPLICIT in the plane: pairs of parts and their impulses. The equations are in implicit.c.
///
/// Order    contacts stand in groups, solved one after the other. In no group but the last one does a
///          part occur twice, so that its contacts may be solved in any order, many at once, by any
///          thread: first those with the boundary (a part's first candidate, its second ...), then the
///          colours of a greedy colouring of the pairs of parts. The last group has the pairs without a
///          colour. Threads divide the pieces of a group among themselves; the blocks of a piece are
///          processed in registers together.
/// State    The pairs with their groups and impulses outlive a step and are saved; the rest is scratch.
///          Pairs are selected again, and disk__rebuild() is called, by their own displacement_bound,
///          which is saved too, so that other rebuilds of the list have no influence.

#pragma once

#include "core/base/memory.h"
#include "core/micro/disk/disk_priv.h"

enum {
    IMPLICIT_BOUNDARY = 4, ///< groups 0 .. 3: contacts with the boundary
    IMPLICIT_COLOURS = 31, ///< groups from IMPLICIT_BOUNDARY on
    IMPLICIT_REST = 35,    ///< group of pairs without a colour, one contact a block
    IMPLICIT_GROUPS = 36,  ///< all of them
    IMPLICIT_PIECE = 1024, ///< most pairs of a piece but the last
    IMPLICIT_CHUNK = 1024, ///< slots that a thread takes at a time, a multiple of IMPLICIT_WIDTH
    IMPLICIT_FEATURE = 1 << 30, ///< ids from here on are features of the boundary
};

_Static_assert((int)IMPLICIT_FEATURE > (int)SCENE_PARTS_MAX, "ids of parts are below");

/// Two parts, or a part and a feature of the boundary, that may touch before pairs are selected again.
typedef struct implicit_pair {
    uint32_t id[2];   ///< of the parts, rising; a feature has id IMPLICIT_FEATURE + feature
    uint32_t slot[2]; ///< of the parts; void_slot for the boundary
    double normal;    ///< impulse of the last step, N s
    double sliding;   ///< same, along the tangent (normal turned left)
} implicit_pair;

/// True for a part and a feature of the boundary.
static inline bool implicit_is_at_boundary(const implicit_pair *pair)
{
    return pair->id[1] >= IMPLICIT_FEATURE;
}

/// Pairs first .. last - 1, of one group, and the blocks of those that are near in this step.
typedef struct implicit_piece {
    size_t first;         ///< pair
    size_t last;          ///< pair
    size_t block;         ///< first block
    size_t n_blocks;      ///< in this step
    uint32_t static_body; ///< row of bodies that no other piece of the group uses
    bool is_rest;         ///< one contact a block
    double overlap;       ///< largest at the start of this step, m
    double overlap_share; ///< largest overlap / smaller radius
} implicit_piece;

/// What disk_state.implicit points to.
typedef struct implicit_state {
    bool is_current;                         ///< slots of pairs are those of the present list
    bool is_chosen;                          ///< pairs were chosen; false at first
    double skin;                             ///< m, of the list that pairs are chosen from
    double displacement_bound;               ///< m, no part has moved farther since they were
    double last_bound;                       ///< m, nor in the last step
    const implicit_kernels *kernels;         ///< those of this processor
    implicit_step step;                      ///< without its belts: the same in every step
    int iterations;                          ///< in a step
    size_t n_pairs;                          ///< in order of groups
    implicit_pair *pairs;                    ///< see there
    size_t pairs_capacity;                   ///< room
    implicit_pair *spare;                    ///< scratch: where pairs are chosen
    size_t spare_capacity;                   ///< room
    uint8_t *colour;                         ///< scratch: group of each pair of spare
    size_t colour_capacity;                  ///< room
    uint32_t *next;                          ///< scratch: next pair with the same first id
    size_t next_capacity;                    ///< room
    uint32_t *head;                          ///< scratch, by id: first such pair
    uint32_t *first;                         ///< scratch, by id and one more: its pairs in spare
    uint32_t *used;                          ///< scratch, by slot: colours taken
    size_t group[IMPLICIT_GROUPS + 1];       ///< where each group of pairs begins, and the end
    size_t group_piece[IMPLICIT_GROUPS + 1]; ///< same for pieces
    implicit_piece *pieces;                  ///< see there
    size_t pieces_capacity;                  ///< room
    implicit_block *blocks;                  ///< scratch, by pieces
    size_t blocks_capacity;                  ///< room
    size_t first_driven;                     ///< rows of bodies from there on move with plates
    solver_body *bodies;                     ///< scratch, by slot
    size_t bodies_capacity;                  ///< room
    driver_extremes *extremes;               ///< scratch, of each chunk of slots
} implicit_state;

/// The arrays of the state as they have to be for a number of parts, at most 5. Returns how many.
size_t disk_implicit__arrays(implicit_state *z, size_t capacity, memory_array *ret_arrays);

/// Note that the arrays are for that number of parts now; the pairs will be selected again.
void disk_implicit__set_capacity(implicit_state *z, size_t capacity);

/// Let the pairs be selected again before the next step.
void disk_implicit__forget_choice(implicit_state *z);

/// Erase the impulses of parts that have left.
void disk_implicit__forget_gone(const disk_state *s, implicit_state *z);

/// Make the state; NULL: no memory.
implicit_state *disk_implicit__create(const disk_state *s);

/// Free it. NULL is fine. Always returns NULL.
implicit_state *disk_implicit__destroy(implicit_state *z);

/// Select the pairs again from the list and the candidates, which must be current; pairs that existed
/// before retain their impulses. BF_ENOMEM: they are of no use until a call succeeds, with the same impulses.
BF_MUST_CHECK bf_status disk_implicit__choose(disk_state *s, implicit_state *z, bf_error *err);

/// Find the slots of pairs that came from a saved state, on the present list.
void disk_implicit__locate(const disk_state *s, implicit_state *z);

/// Room for n pairs. BF_ENOMEM.
BF_MUST_CHECK bf_status disk_implicit__reserve(implicit_state *z, size_t n, bf_error *err);

/// Cut the groups of pairs into pieces, with room for their blocks. BF_ENOMEM.
BF_MUST_CHECK bf_status disk_implicit__cut(const disk_state *s, implicit_state *z, bf_error *err);

/// Blocks of a piece: pairs whose surfaces come nearer than `margin`, m, with the impulses of the last step,
/// which are applied to the bodies.
void disk_implicit__find_contacts(const disk_state *s, implicit_state *z, size_t piece,
                                  double margin);

/// Store the impulses of a piece's contacts in its pairs.
void disk_implicit__store_impulses(implicit_state *z, size_t piece);

/// Write what MICRO_IMPLICIT needs beyond parts, headings and steps: the impulses of the last step, and which
/// pairs are selected; nothing if s->implicit is NULL.
void disk_implicit__save(const disk_state *s, checkpoint_writer *w);

/// Load that, to the end of the payload; if there is nothing, s->implicit is reset to its initial state. Reads
/// nothing in s that changes with time, but for its capacity; n is the number of parts. BF_ECORRUPT or BF_ENOMEM: s is
/// as before.
BF_MUST_CHECK bf_status disk_implicit__load(disk_state *s, size_t n, checkpoint_reader *r,
                                            bf_error *err);
