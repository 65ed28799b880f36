/// Inside of the planar path: upright cylinders on belts, each a disk with place, heading, velocity
/// and spin in the plane.
///
///     contact   delta = r_i + r_j - dist, f = max(k delta - d v_n, 0) (no clamp with tension)
///               v_n = relative velocity along n, n from i to j
///     friction  -mu |f| tanh(lambda u), u = relative velocity along the tangent of the surfaces in the
///               contact point, spins included; the point is the middle of the overlap, so its
///               levers r - delta/2 add up to dist and angular momentum is conserved
///     belt      a = -mu g tanh(lambda |s|) s/|s|, s = velocity relative to the belt under the centre
///     spin      w+ = w~ / (1 + dt A tanh(lambda |w~|)/|w~|), w~ = (1 - D)^dt w + dt Theta^-1 (torque),
///               A = mu r_spin m g / Theta: (8), implicit and never past zero
///
/// Velocity is that of the last half step, (x - x-)/dt: (12) is then v+ = (1 - D dt) v + dt F(x, v)/m,
/// x+ = x + dt v+, the same numbers with less rounding, and the first step by forward Euler is the one
/// without forces and torques.
///
/// Places   parts live in the solver's own order, sorted in space whenever the list of neighbours is
///          made; places come in groups of DISK_GROUP. Live parts are at 0 .. n_live - 1; then pads
///          up to n_padded (far away, of no effect); then the rows of parts that are gone, as they left.
/// List     valid while travel <= skin/2. Everything that depends on where parts are (neighbours,
///          touches, watches, belts) is made together by disk__rebuild().
/// Pushes   of solids on parts, N and N m, wait in x, y and spin of the parts' own rows of `next` until a
///          step writes these.
/// Sums     over features of solids first, in their order, then over neighbours by their numbers, so
///          that results depend neither on the order of places nor on when a list was made.

#pragma once

#include "core/base/buffer.h"
#include "core/base/checkpoint.h"
#include "core/micro/disk/disk_types_priv.h"

/// The planar solver.
typedef struct disk_state {
    micro_def def;            ///< without its arrays
    disk_law cargo;           ///< cargo on cargo
    disk_law handling;        ///< cargo on obstacles and walls
    double handling_softness; ///< as in disk_row
    micro_law belt;           ///< cargo on belts; its stiffness does not count here
    double spin_damping;      ///< (1 - D)^dt
    bool is_plain;            ///< one kind, one belt (or none) under the whole domain, no tension
    disk_belt plain_belt;     ///< if is_plain
    double plain_brake;       ///< A if is_plain, rad/s2
    size_t n;                 ///< parts, gone ones included
    size_t n_live;            ///< live ones when the list was made; places below are theirs
    size_t n_padded;          ///< n_live rounded up to a multiple of DISK_GROUP
    uint32_t void_place;      ///< a place far away from everything, the last one
    disk_row *now;            ///< state at the present time, by place
    disk_row *next;           ///< where a step writes (disk__swap() afterwards)
    double *heading;          ///< rad, by place
    double *brake;            ///< A of (8), rad/s2, by place; NULL if is_plain
    disk_belt *belt_under;    ///< by place; NULL if is_plain
    double *scratch;          ///< by place: of a rebuild, or headings before a tile
    uint8_t *is_touched;      ///< by group: nonzero where the list has touches of its parts
    uint32_t *number;         ///< number of the part in each place; UINT32_MAX in pads
    uint32_t *place;          ///< place of each part
    uint8_t *is_gone;         ///< by number
    size_t n_kinds;           ///< kinds of parts
    disk_kind *kinds;         ///< see there
    uint32_t *kind_of;        ///< by number; NULL: all of kind 0
    disk_list list;           ///< neighbours
    double skin;              ///< m
    double travel;            ///< m, no part has moved farther since the list was made
    double move;              ///< m, the farthest in the last explicit step; INFINITY: not known
    double radius_max;        ///< m, of any kind
    double radius_min;        ///< m, of any kind
    size_t n_faces;           ///< faces of solids
    disk_face *faces;         ///< see there
    size_t n_arcs;            ///< round corners of solids
    disk_arc *arcs;           ///< see there
    size_t n_touches;         ///< sorted by place, then by feature
    size_t touches_capacity;  ///< room
    disk_touch *touches;      ///< see there
    size_t n_watches;         ///< sorted by place
    size_t watches_capacity;  ///< room
    disk_watch *watches;      ///< see there
    surroundings around;      ///< a copy: belts and edges
    neighbours_cells cells;   ///< storage of the grid
    int n_shares;             ///< threads that take part
    disk_share shares[DISK_SHARES_MAX]; ///< one each
    const struct disk_kernels *kernels; ///< of explicit steps
    disk_extremes_line *extremes;       ///< scratch: of two explicit steps, DISK_SHARES_MAX each
    disk_tiles tiles;                   ///< of explicit steps
    uint64_t steps;                     ///< made since t = 0
    double largest_overlap;             ///< m, of any contact since the start
    double overlap_share;               ///< see micro_totals
    uint64_t n_builds;                  ///< how often the list was made
    void *implicit;                     ///< what disk_implicit.c keeps between steps; NULL at first
} disk_state;

/// Make the list and all that depends on places from the rows in `now`: sorts parts, files away those
/// that are gone or whose centre is outside, sets travel = 0. Any place may change, and now and next may
/// trade their storage. BF_ENOMEM: the list is unusable until a call succeeds.
BF_MUST_CHECK bf_status disk__rebuild(disk_state *s, bf_error *err);

/// After a step was written into rows (and headings): look at the watches watch_first .. watch_last - 1;
/// parts that left are frozen in their watch, which then says `left`, and moved far away and to rest in
/// rows, parts at the border of a belt learn what is under them. Touches nothing of other parts.
void disk__look(disk_state *s, disk_row *rows, size_t watch_first, size_t watch_last,
                disk_presence left);

/// Belt under a point.
disk_belt disk__belt_at(const disk_state *s, double x, double y);

/// Kind of the part with a number.
static inline const disk_kind *disk__kind_of(const disk_state *s, size_t number)
{
    return &s->kinds[s->kind_of != NULL ? s->kind_of[number] : 0];
}

/// Belt under the part in a place as of the last rebuild or look.
static inline disk_belt disk__belt_under(const disk_state *s, size_t place)
{
    return s->is_plain ? s->plain_belt : s->belt_under[place];
}

/// A of (8) for the part in a place.
static inline double disk__brake(const disk_state *s, size_t place)
{
    return s->is_plain ? s->plain_brake : s->brake[place];
}

/// Slots of a group, and slot `slot` of the part in a place.
static inline size_t disk__slots(const disk_state *s, size_t place)
{
    size_t g = place / DISK_GROUP;
    return s->list.first[g + 1] - s->list.first[g];
}

/// The neighbour in a slot; void_place if there is none.
static inline uint32_t disk__neighbour(const disk_state *s, size_t place, size_t slot)
{
    size_t g = place / DISK_GROUP;
    return s->list.neighbour[(s->list.first[g] + slot) * DISK_GROUP + place % DISK_GROUP] /
           DISK_ROW;
}

/// `next` becomes `now`.
static inline void disk__swap(disk_state *s)
{
    disk_row *rows = s->now;
    s->now = s->next;
    s->next = rows;
}

/// A part's overlap with a face or arc, m; 0 or less, or any value with *ret_counts false, where they
/// are not in touch.
double disk__overlap(const disk_state *s, const disk_row *part, uint32_t feature, bool *ret_counts);

/// Lay out faces and arcs of the definition's walls and obstacles; s->around must be there. BF_ENOMEM.
BF_MUST_CHECK bf_status disk__solids_init(disk_state *s, const micro_def *def, bf_error *err);
void disk__solids_fini(disk_state *s);

/// Find the touches, or the watches and belts, of the live places. BF_ENOMEM.
BF_MUST_CHECK bf_status disk__find_touches(disk_state *s);
BF_MUST_CHECK bf_status disk__find_watches(disk_state *s);

/// Put all parts into the places of their numbers, with what belongs to their kinds and without place
/// and velocity; disk__rebuild() must follow.
void disk__place_parts(disk_state *s);

/// Members of micro_backend.
micro_part disk__part(const void *state, size_t k);
micro_totals disk__measure(const void *state);
void disk__save(const void *state, checkpoint_writer *w);
BF_MUST_CHECK bf_status disk__load(void *state, checkpoint_reader *r, bf_error *err);

/// A row far away and at rest, of its own for each place, in touch with nothing.
disk_row disk__pad(const disk_state *s, size_t place);

/// Have what tiles need, from the next rebuild on. BF_ENOMEM: steps will be made one by one.
BF_MUST_CHECK bf_status disk__tiles_init(disk_state *s);
void disk__tiles_fini(disk_state *s);

/// Lay tiles over the present list, if disk__tiles_init() was called.
void disk__cut_tiles(disk_state *s);

/// BF_ENUMERIC with step, time and part, if a live part of `now` is not finite or moves by more than
/// half the smallest radius in a step; else BF_OK. To be called when the largest speed of a step, which
/// the caller knows, is suspect.
BF_MUST_CHECK bf_status disk__check(const disk_state *s, bf_error *err);

/// Make n steps with MICRO_VERLET.
BF_MUST_CHECK bf_status disk__advance_verlet(disk_state *s, uint64_t n, bf_error *err);

/// Make n steps with MICRO_IMPLICIT: counts s->steps, keeps now, heading, travel, watches and the
/// overlaps; calls disk__rebuild() before a step on a stale list. Its first call finds parts with
/// their start velocities in `now`, as every later one, possibly after a load, finds the state it left:
/// rows, headings and steps are all that is saved.
BF_MUST_CHECK bf_status disk__advance_implicit(disk_state *s, uint64_t n, bf_error *err);

/// Free s->implicit; NULL is fine.
void disk__implicit_fini(disk_state *s);

/// Write what MICRO_IMPLICIT needs beyond rows, headings and steps (the impulses of the last step, and
/// which pairs it looks at); nothing if s->implicit is NULL.
void disk__implicit_save(const disk_state *s, checkpoint_writer *w);

/// Take that back, to the end of the payload; nothing makes s->implicit as at first. Looks at nothing in s that changes with time, so
/// the order of this and of taking the rows is free. BF_ECORRUPT or BF_ENOMEM: s is as before.
BF_MUST_CHECK bf_status disk__implicit_load(disk_state *s, checkpoint_reader *r, bf_error *err);

/// Largest stable step of MICRO_VERLET for a checked definition of cylinders, s.
double disk__dt_stable_verlet(const micro_def *def);
