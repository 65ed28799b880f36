/// Inside of MICRO_IMPLICIT: implicit Euler for contacts and frictions, solved by impulses.
///
///     overlap    delta+ = delta - h v+, v = speed at which the surfaces part
///     normal     impulse J = max(0, E (delta - h v+) - d max(delta, 0)), E = h k + d: for delta > 0
///                h times (4a) at the end of the step; for a gap (delta < 0), nothing until it closes
///                and then the dashpot on what it closed to
///     sliding    impulse -mu |J| lambda theta(lambda |u|) u+, at most mu |J|; theta(z) = tanh(z)/z, u
///                the slip known so far: (7), implicit by its secant
///     belt       impulse -h mu m g lambda theta(lambda |u|) u+, u the velocity relative to the belt
///     spin       the same with (8), secant of the spin before the step; on the diagonal, so it only
///                changes the inertia
///
/// The coupled equations are relaxed contact by contact (Gauss-Seidel) from the impulses of the step
/// before; each round takes the secants anew and so comes nearer to implicit Euler. Every impulse acts
/// on both parts, so momentum is kept however few rounds are made.
///
/// Order    contacts stand in groups, solved one after the other. In no group but the last one does a
///          part occur twice, so that its contacts may be solved in any order, many at once, by any
///          thread: first those with solids (a part's first touch, its second ...), then the colours
///          of a greedy colouring of the pairs of parts. The last group is for what is left over. Pieces of
///          a group are what threads share out, blocks of a piece what goes through registers together.
/// State    The pairs with their groups and impulses outlive a step and are saved; the rest is scratch.
///          Pairs are chosen anew, and disk__rebuild() is called, when `travel` says so, which is
///          saved too: when the list was made by others has no influence.

#pragma once

#include "core/base/cpu.h"
#include "core/micro/disk/disk_priv.h"

#include <stdbool.h>

enum {
    IMPLICIT_SOLIDS = 4,   ///< groups 0 .. 3: touches of solids
    IMPLICIT_COLOURS = 31, ///< groups from IMPLICIT_SOLIDS on
    IMPLICIT_REST = 35,    ///< group of what is left over, one contact a block
    IMPLICIT_GROUPS = 36,  ///< all of them
    IMPLICIT_PIECE = 1024, ///< most pairs of a piece but the last
    IMPLICIT_CHUNK = 1024, ///< places that a thread takes at a time, a multiple of IMPLICIT_WIDTH
    IMPLICIT_WIDTH = 8,    ///< contacts in a block
};

/// Two parts, or a part and a feature of a solid, that may touch before pairs are chosen anew.
typedef struct implicit_pair {
    uint32_t number[2]; ///< of the parts, rising; a feature has number n + feature
    uint32_t place[2];  ///< of the parts; void_place for a solid
    double normal;      ///< impulse of the last step, N s
    double sliding;     ///< same, along the tangent (normal turned left)
} implicit_pair;

/// Pairs that are near enough to touch in this step. The normals point from parts 0 to parts 1, impulses
/// are those on parts 1. Lanes without a pair have ground at both ends and zeros.
typedef struct implicit_block {
    uint32_t row[2][IMPLICIT_WIDTH];  ///< rows of bodies, as lanes_rows.h wants them: doubles
    uint32_t pair[IMPLICIT_WIDTH];    ///< indices of pairs; UINT32_MAX: none
    uint32_t padding[IMPLICIT_WIDTH]; ///< to a cache line
    double nx[IMPLICIT_WIDTH];        ///< unit normal
    double ny[IMPLICIT_WIDTH];        ///< same
    double bias[IMPLICIT_WIDTH];     ///< J = max(floor, bias - gain v), v = parting speed without J
    double gain[IMPLICIT_WIDTH];     ///< N s per m/s
    double floor[IMPLICIT_WIDTH];    ///< 0, or -infinity where contacts may pull
    double friction[IMPLICIT_WIDTH]; ///< mu
    double rate[IMPLICIT_WIDTH];     ///< lambda, s/m
    double lever[2][IMPLICIT_WIDTH]; ///< from the centres to the contact, m
    double turn[2][IMPLICIT_WIDTH];  ///< what a sliding impulse changes the spins by, 1/(kg m)
    double give_slip[IMPLICIT_WIDTH]; ///< what it changes the slip by, 1/kg
    double normal[IMPLICIT_WIDTH];    ///< J so far, N s
    double sliding[IMPLICIT_WIDTH];   ///< sliding impulse so far, N s
} implicit_block;

/// Velocity of a part within a step, and how impulses change it. Rows as of lanes_rows.h. Behind the
/// rows of places stand those of ground, which nothing moves.
typedef struct implicit_body {
    double vx;        ///< m/s
    double vy;        ///< same
    double spin;      ///< rad/s
    double give;      ///< 1/m, 1/kg
    double give_spin; ///< inverse of the inertia that an impulse meets, 1/(kg m2)
    double pull_x;    ///< what the belt changed the velocity by in this step, m/s
    double pull_y;    ///< same
    double padding;   ///< to a cache line
} implicit_body;

/// Pairs first .. last - 1, of one group, and the blocks of those that are near in this step.
typedef struct implicit_piece {
    size_t first;    ///< pair
    size_t last;     ///< pair
    size_t block;    ///< first block
    size_t n_blocks; ///< in this step
    uint32_t ground; ///< row of bodies that no other piece of the group uses
    bool is_rest;    ///< one contact a block
    double overlap;  ///< largest at the start of this step, m
    double share;    ///< largest overlap / smaller radius
} implicit_piece;

/// The numbers of a step.
typedef struct implicit_step {
    double keep; ///< what the damping D leaves of a velocity
    double drag; ///< h mu g lambda of the belts
} implicit_step;

/// The inner loops, compiled once per instruction set; all variants give the same bits.
typedef struct implicit_kernels {
    const char *name; ///< of the instruction set, "avx512", "avx2", "base"

    /// Fill in what spins make of the blocks' contacts, and apply their impulses to the bodies.
    void (*begin)(implicit_body *bodies, implicit_block *blocks, size_t n);

    /// One round over the blocks.
    void (*relax)(implicit_body *bodies, implicit_block *blocks, size_t n);

    /// Bodies of the places first .. last - 1, both multiples of IMPLICIT_WIDTH, as they would move in a
    /// step without contacts. Returns what is true of them before and then.
    driver_extremes (*predict)(const disk_state *s, const implicit_step *step,
                               implicit_body *bodies, size_t first, size_t last);

    /// Let the belts pull at the bodies as they move now, instead of as they did before.
    void (*pull)(const disk_state *s, const implicit_step *step, implicit_body *bodies,
                 size_t first, size_t last);

    /// Rows and headings at the end of the step. Returns what is true of them.
    driver_extremes (*move)(disk_state *s, const implicit_body *bodies, size_t first, size_t last);
} implicit_kernels;

/// What disk_state.implicit points to.
typedef struct implicit_state {
    bool is_current;                 ///< places of pairs are those of the present list
    bool is_chosen;                  ///< pairs were chosen; false at first
    double skin;                     ///< m, of the list that pairs are chosen from
    double travel;                   ///< m, no part has moved farther since they were
    double move;                     ///< m, farthest move of a part in the last step
    const implicit_kernels *kernels; ///< those of this processor
    implicit_step step;              ///< the same in every step
    int rounds;                      ///< of relaxation in a step
    size_t n_pairs;                  ///< in order of groups
    implicit_pair *pairs;            ///< see there
    size_t neighbours_capacity;      ///< room
    implicit_pair *spare;            ///< scratch: where pairs are chosen
    size_t spare_capacity;           ///< room
    uint8_t *colour;                 ///< scratch: group of each pair of spare
    size_t colour_capacity;          ///< room
    uint32_t *next;                  ///< scratch: next pair with the same first number
    size_t next_capacity;            ///< room
    uint32_t *head;                  ///< scratch, by number: first such pair
    uint32_t *first; ///< scratch, by number and one more: where its pairs begin in spare
    uint32_t *used;  ///< scratch, by place: colours taken
    size_t group[IMPLICIT_GROUPS + 1];       ///< where each group of pairs begins, and the end
    size_t group_piece[IMPLICIT_GROUPS + 1]; ///< same for pieces
    implicit_piece *pieces;                  ///< see there
    size_t pieces_capacity;                  ///< room
    implicit_block *blocks;                  ///< scratch, by pieces
    size_t blocks_capacity;                  ///< room
    implicit_body *bodies;                   ///< scratch, by place
    driver_extremes *extremes;               ///< scratch, of each chunk of places
} implicit_state;

/// Make and free the state; NULL: no memory. Destroying returns NULL and takes it.
implicit_state *disk_implicit__create(const disk_state *s);
implicit_state *disk_implicit__destroy(implicit_state *z);

/// Choose the pairs anew from the list and the touches, which must be fresh, and give those that were
/// there before their impulses. BF_ENOMEM: they are of no use until a
/// call succeeds, but keep their impulses.
BF_MUST_CHECK bf_status disk_implicit__choose(disk_state *s, implicit_state *z, bf_error *err);

/// Find the places of pairs that came from a saved state, on the present list.
void disk_implicit__locate(const disk_state *s, implicit_state *z);

/// Room for n pairs. BF_ENOMEM.
BF_MUST_CHECK bf_status disk_implicit__reserve(implicit_state *z, size_t n, bf_error *err);

/// Cut the groups of pairs into pieces, with room for their blocks. BF_ENOMEM.
BF_MUST_CHECK bf_status disk_implicit__cut(const disk_state *s, implicit_state *z, bf_error *err);

/// Blocks of a piece: pairs that come nearer than `near`, m, with the impulses of the last step, which
/// are applied to the bodies.
void disk_implicit__meet(const disk_state *s, implicit_state *z, size_t piece, double near);

/// Keep the impulses of a piece's contacts in its pairs.
void disk_implicit__keep(implicit_state *z, size_t piece);

/// The build for an instruction set.
const implicit_kernels *disk_implicit__kernels(cpu_level level);
