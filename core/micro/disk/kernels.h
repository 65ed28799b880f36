/// The data of the inner loops of disks, and their tables of functions.
///
/// explicit_kernels.c and implicit_kernels.c are compiled once per instruction set (core/CMakeLists.txt). All
/// builds give the same bits, see core/base/simd.h. Tables that are read in lanes have rows of
/// SIMD_ROW or SIMD_QUAD doubles (core/base/simd_rows.h), aligned to their size.

#pragma once

#include "core/base/cpu.h"
#include "core/base/memory.h"
#include "core/base/vec2.h"
#include "core/micro/driver.h"
#include "core/scene/limits.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    DISK_GROUP = 8,         ///< slots that are handled together
    DISK_BLOCK_GROUPS = 16, ///< groups whose pairs are handled together
    DISK_PAIR_DOUBLES = 8,  ///< doubles in the forces of a pair, see disk_list
    DISK_DOUBLES = 8,       ///< doubles in a disk, a face and an arc
    IMPLICIT_WIDTH = 8,     ///< pairs in a block
};

/// Coordinate of padding, m: beyond what a scene may hold.
#define DISK_FAR 1e7

typedef struct disk_state disk_state; ///< core/micro/disk/disk_priv.h

/// A part.
typedef struct disk {
    double x;          ///< m
    double y;          ///< m
    double vx;         ///< m/s, of the last half step
    double vy;         ///< same
    double spin;       ///< rad/s, counter-clockwise
    double radius;     ///< m
    double compliance; ///< (1 - nu^2)/E with E divided by modulus_reduction, 1/Pa
    double inv_mass;   ///< 1/kg
} disk;

/// A straight piece of the boundary: a side of a plate, an end of one, or a wall. A part with centre c is in
/// contact if from <= (c - p).t < to, t = n turned right, and -depth < (c - p).n < r; its overlap is
/// r - (c - p).n, along n. The upstream side of a plate also acts on centres inside the plate, through
/// its whole thickness; other sides act from outside only.
typedef struct disk_face {
    double px;       ///< a point of it, m
    double py;       ///< same
    double nx;       ///< unit normal out of the plate or wall
    double ny;       ///< same
    double from;     ///< m along t
    double to;       ///< same
    double depth;    ///< m, how deep a centre may be inside
    double friction; ///< mu
} disk_face;

/// A round corner of the boundary: where it is the arc of radius `radius` around p (0: a sharp edge). A
/// part is in contact if (c - p).e >= 0, (c - p).f > 0 and 0 < |c - p| - radius < r.
typedef struct disk_arc {
    double px;       ///< centre of the arc, m
    double py;       ///< same
    double radius;   ///< m
    double ex;       ///< bound of the sector
    double ey;       ///< same
    double fx;       ///< other bound of it
    double fy;       ///< same
    double friction; ///< mu
} disk_arc;

/// How a face or an arc moves in a step, where plates move: its velocity in p is spin x (p - pivot) + v + growth n, n
/// its normal there.
typedef struct disk_surface {
    double px;      ///< pivot in this step, m
    double py;      ///< same
    double spin;    ///< rad/s, counter-clockwise
    double recess;  ///< how far it is behind its place, m; DISK_FAR: it is not there
    double growth;  ///< at which that decreases, m/s
    double vx;      ///< velocity of the pivot, m/s
    double vy;      ///< same
    double padding; ///< to a cache line
} disk_surface;

/// The belt under a part, at a time: its velocity is (vx - turn y, vy + turn x).
typedef struct disk_belt {
    double vx;             ///< at the origin, m/s; in a step with the hold
    double vy;             ///< same
    double turn;           ///< angular velocity, rad/s
    double friction_ratio; ///< belt_friction_ratio() times cos(incline), 0 off every belt
    vec2 pull;             ///< belt_slope_pull(), m/s2
    vec2 hold;             ///< belt_slope_hold(), m/s
} disk_belt;

/// All belts at a time, by index; the one after the last stands for places off every belt.
typedef struct disk_belts {
    disk_belt of[SCENE_BELTS_MAX + 1]; ///< see there
} disk_belts;

/// The list of neighbours, by groups: row r of group g is the DISK_GROUP entries from
/// neighbour[(first[g] + r) * DISK_GROUP] on, one for each part of the group: slots of neighbours times
/// DISK_DOUBLES, which is where they begin; void_slot where a part has fewer. Group g has
/// first[g + 1] - first[g] rows. Each part's neighbours are sorted by their ids; every pair stands twice.
///
/// For MICRO_VERLET block b, of DISK_BLOCK_GROUPS groups, has the pairs pair_first[b] .. pair_first[b + 1] - 1, a
/// multiple of DISK_GROUP. In a step pair k of a block leaves x, y and torque on either part, 4 doubles each, from
/// (1 + k) DISK_PAIR_DOUBLES of `forces` on; those before are 0. Where `neighbour` has a neighbour, `force` has
/// where its force on the part stands.
typedef struct disk_list {
    uint32_t *first;      ///< number of a row, by group and one more
    uint32_t *neighbour;  ///< see above; in disk_state.scratch, implicit: until a step is made
    size_t rows_capacity; ///< room in neighbour, rows
    uint32_t *force;      ///< see above, doubles
    uint32_t *pair_first; ///< by block and one more
    uint32_t *pair[2];    ///< where the two parts begin, doubles
    double *forces;       ///< forces_size for each partition
    size_t forces_size;   ///< doubles
    memory_block pairs;   ///< where force, pair and forces are
} disk_list;

/// The numbers of an explicit step.
typedef struct explicit_step {
    const disk_state *state; ///< laws and lists; its now and next do not count here
    const disk_belt *belts;  ///< in this step, by index; see disk__belts_in_step()
    const disk *now;         ///< parts before the step
    disk *next; ///< after it; before, in groups near the boundary, the forces of that: x, y, torque
    double *heading;            ///< by slot, updated
    double *forces;             ///< scratch, of one thread: see disk_list
    double dt;                  ///< s, for positions and headings
    double dt_force;            ///< s, for forces: dt, or 0 in the first step
    double damping_factor;      ///< 1 - D dt, or 1 in the first step
    double spin_damping_factor; ///< (1 - D)^dt, or 1 in the first step
} explicit_step;

/// Extremes of the parts of one thread, in cache lines of their own.
typedef struct disk_extremes_line {
    _Alignas(64) driver_extremes of; ///< see there
    char padding[64];                ///< the next line is often fetched along with it
} disk_extremes_line;

/// Explicit steps for one instruction set.
typedef struct explicit_kernels {
    /// Forces of the boundary on the candidates first <= k < last, left in step->next for advance(): all
    /// candidates of a group must be among them. Raises the overlaps of *extremes.
    void (*add_boundary_forces)(const explicit_step *step, size_t first, size_t last,
                                driver_extremes *extremes);

    /// One step for groups first <= g < last, whole blocks: contacts, belt, integration. Raises *extremes.
    void (*advance)(const explicit_step *step, size_t first, size_t last,
                    driver_extremes *extremes);

    /// ret_y = tanh(x), relative error within 1e-12, for n numbers, n a multiple of 8.
    void (*tanh_of)(size_t n, const double *x, double *ret_y);
} explicit_kernels;

/// The build for an instruction set.
const explicit_kernels *disk__explicit_kernels(cpu_level level);

/// Pairs of bodies that may touch, and their impulses, which outlive a step. Normals point from bodies 0 to bodies 1,
/// impulses are those on bodies 1. Lanes without a pair have a static body at both ends and no impulses.
typedef struct implicit_block {
    uint32_t row
        [2]
        [IMPLICIT_WIDTH]; ///< where bodies begin in their table, doubles; see implicit_state.is_current
    double normal[IMPLICIT_WIDTH];  ///< J of the last step, or so far, N s
    double sliding[IMPLICIT_WIDTH]; ///< same along the tangent, the normal turned left
} implicit_block;

/// Where the bodies of a block touch in this step; zeros in lanes without a pair.
typedef struct implicit_contacts {
    double nx[IMPLICIT_WIDTH];      ///< unit normal
    double ny[IMPLICIT_WIDTH];      ///< same
    double overlap[IMPLICIT_WIDTH]; ///< m; negative: a gap
} implicit_contacts;

/// What the contacts of a block have from the kinds of their bodies, h the step:
/// J = max(lower_bound, scale (joint overlap - damping max(overlap, 0)) - gain v), v = parting speed without J.
typedef struct implicit_law {
    double joint[IMPLICIT_WIDTH];       ///< E = h k + d, N s/m
    double damping[IMPLICIT_WIDTH];     ///< d, N s/m
    double scale[IMPLICIT_WIDTH];       ///< 1/(1 + h E (sum of inv_mass))
    double gain[IMPLICIT_WIDTH];        ///< h E scale, N s per m/s
    double lower_bound[IMPLICIT_WIDTH]; ///< 0, or -infinity where contacts may pull
    double friction[IMPLICIT_WIDTH];    ///< mu
    double rate[IMPLICIT_WIDTH];        ///< lambda, s/m
    double radius[2][IMPLICIT_WIDTH];   ///< m; 0 for the boundary
    double inv_mass[2][IMPLICIT_WIDTH]; ///< 1/kg; 0 for the boundary
} implicit_law;

/// Blocks that follow one another.
typedef struct implicit_blocks {
    size_t n;                          ///< see there
    implicit_block *pairs;             ///< n
    const implicit_contacts *contacts; ///< n
    const implicit_law *laws;          ///< n, or one for all of them
    bool is_one_law;                   ///< see there
    double excess;                     ///< of an iteration: over-relaxation less 1
} implicit_blocks;

/// Velocity of a body within a step, and how impulses turn it. The rows of slots are followed by those of static
/// bodies and of the boundary.
typedef struct solver_body {
    double vx;          ///< m/s
    double vy;          ///< same
    double spin;        ///< rad/s
    double inv_inertia; ///< inverse of the effective inertia for an impulse, 1/(kg m2)
} solver_body;

/// The bodies, and by slot the changes of their velocities by the belt in this step.
typedef struct implicit_bodies {
    solver_body *rows; ///< see there
    double *belt_dvx;  ///< m/s
    double *belt_dvy;  ///< same
} implicit_bodies;

/// The numbers of an implicit step.
typedef struct implicit_step {
    const disk_belt *belts; ///< in this step, by index; see disk__belts_in_step()
    double damping_factor;  ///< factor by which the damping D reduces a velocity
    double belt_secant;     ///< h mu g lambda of the belts
} implicit_step;

/// Implicit steps for one instruction set.
typedef struct implicit_kernels {
    /// Where the pairs of parts of a block would touch, all in *ret. Bit k of what is returned is set where the
    /// surfaces of pair k are nearer than `margin`, m, of two parts that had not left when the list was made.
    unsigned (*find_contacts)(const disk_state *s, const implicit_block *block, double margin,
                              implicit_contacts *ret);

    /// Apply the impulses of the blocks to their bodies.
    void (*warm_start)(solver_body *bodies, const implicit_blocks *blocks);

    /// One iteration over the blocks.
    void (*solve)(solver_body *bodies, const implicit_blocks *blocks);

    /// Bodies of the slots first .. last - 1, both multiples of IMPLICIT_WIDTH, as they would move in a
    /// step without contacts. Returns their extremes, before and after.
    driver_extremes (*predict)(const disk_state *s, const implicit_step *step,
                               const implicit_bodies *bodies, size_t first, size_t last);

    /// Update the friction of the belts to the current velocities.
    void (*apply_belt_friction)(const disk_state *s, const implicit_step *step,
                                const implicit_bodies *bodies, size_t first, size_t last);

    /// Parts and headings at the end of the step. Returns their extremes.
    driver_extremes (*move)(disk_state *s, const solver_body *bodies, size_t first, size_t last);
} implicit_kernels;

/// The build for an instruction set.
const implicit_kernels *disk__implicit_kernels(cpu_level level);
