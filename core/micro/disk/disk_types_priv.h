/// The pieces of the planar solver's state: parts, what they may touch, and the lists of both. What they
/// are for, and how they work together, is in disk_priv.h.

#pragma once

#include "core/micro/contact_law.h"
#include "core/micro/driver.h"
#include "core/micro/micro.h"
#include "core/micro/neighbours.h"
#include "core/scene/surroundings.h"

enum {
    DISK_GROUP = 8,       ///< places that are handled together
    DISK_ROW = 8,         ///< doubles in a disk_row
    DISK_SHARES_MAX = 64, ///< threads that share a step
};

/// Coordinate of pads, m: beyond what a scene may hold.
#define DISK_FAR 1e7

/// A part. Rows are aligned to their size.
typedef struct disk_row {
    double x;            ///< m
    double y;            ///< m
    double vx;           ///< m/s, of the last half step
    double vy;           ///< same
    double spin;         ///< rad/s, counter-clockwise
    double radius;       ///< m
    double softness;     ///< (1 - nu^2)/E with E divided by modulus_reduction, 1/Pa
    double inverse_mass; ///< 1/kg
} disk_row;

/// What a contact needs beyond the parts: k = line / (softness of one + softness of the other).
typedef struct disk_law {
    double line;        ///< pi/4 l, m
    double damping;     ///< d, N s/m
    double friction;    ///< mu
    double tanh_linear; ///< lambda_lin, s/m
} disk_law;

/// Belt under a part.
typedef struct disk_belt {
    double vx;   ///< m/s
    double vy;   ///< m/s
    double grip; ///< 1 on a belt, 0 off every belt
} disk_belt;

/// A straight piece of the surface of a solid: a side of a plate, an end of one, or a wall. A part with
/// centre c is in touch if from <= (c - p).t < to, t = n turned right, and -depth < (c - p).n < r; its
/// overlap is r - (c - p).n, along n. The upstream side of a plate holds centres that were pressed into
/// it, all through the plate; other sides count from outside only.
typedef struct disk_face {
    double px;       ///< a point of it, m
    double py;       ///< same
    double nx;       ///< unit normal out of the solid
    double ny;       ///< same
    double from;     ///< m along t
    double to;       ///< same
    double depth;    ///< m, how deep a centre may be inside
    double friction; ///< mu; 0 for walls, which slip freely
} disk_face;

/// A round corner of a solid: where the surface is the arc of radius `radius` around p (0: a sharp
/// edge). A part is in touch if (c - p).e >= 0, (c - p).f > 0 and 0 < |c - p| - radius < r.
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

/// A part that may touch a face or an arc before the list is made anew.
typedef struct disk_touch {
    uint32_t place;   ///< of the part
    uint32_t feature; ///< face, or n_faces + arc
} disk_touch;

/// Where a watched part is.
typedef enum disk_presence {
    DISK_HERE,  ///< in the domain
    DISK_GONE,  ///< it left
    DISK_GOING, ///< it left in a step that may be taken back
} disk_presence;

/// A part near an open edge or the border of a belt: looked at after each step.
typedef struct disk_watch {
    uint32_t place;     ///< of the part
    disk_presence gone; ///< unless DISK_HERE, row and heading are what it left with
    double heading;     ///< rad
    disk_row row;       ///< see gone
} disk_watch;

/// The part of the places that one thread advances.
typedef struct disk_share {
    size_t group_first; ///< groups group_first <= g < group_last
    size_t group_last;  ///< see there
    size_t touch_first; ///< touches of its parts
    size_t touch_last;  ///< see there
    size_t watch_first; ///< watches of its parts
    size_t watch_last;  ///< see there
} disk_share;

/// Extremes of a share, in cache lines of their own.
typedef struct disk_extremes_line {
    _Alignas(64) driver_extremes of; ///< see there
    char padding[64];                ///< the next line is often fetched along with it
} disk_extremes_line;

/// Groups that make a step together when several steps are under way, and where their touches and
/// watches begin; all end where those of the next block begin.
typedef struct disk_block {
    size_t group_first; ///< groups
    size_t touch_first; ///< touches of its parts
    size_t watch_first; ///< watches of its parts
    size_t reach;       ///< the last block with neighbours of its parts
} disk_block;

/// A part before a tile's first step; its heading is in disk_state.scratch.
typedef struct disk_kept {
    double x;    ///< m
    double y;    ///< m
    double vx;   ///< m/s
    double vy;   ///< m/s
    double spin; ///< rad/s
} disk_kept;

/// What several steps in one pass need, see explicit.c.
typedef struct disk_tiles {
    disk_kept *kept;     ///< by place; NULL: steps are made one by one
    disk_block *blocks;  ///< n_blocks of the present list, and one more
    size_t n_blocks;     ///< see there
    size_t lead;         ///< how far a step may be ahead of the next one, blocks
    int n_steps;         ///< of a tile; fewer than 2: none fits
    uint64_t n_made;     ///< tiles that counted
    uint64_t n_put_back; ///< tiles that did not
} disk_tiles;

/// The list of neighbours, by groups: slot s of the parts of group g is the DISK_GROUP entries from
/// neighbour[(first[g] + s) * DISK_GROUP] on, one for each part of the group: places of neighbours
/// times DISK_ROW, which is where their rows begin; void_place where a part has fewer. Number of slots
/// of g: first[g + 1] - first[g]. Each part's neighbours are sorted by their numbers (not places); every
/// pair stands twice.
typedef struct disk_list {
    uint32_t *first;       ///< a slot number per group and one more
    uint32_t *neighbour;   ///< see above
    size_t slots_capacity; ///< room in neighbour, slots
    uint32_t *scratch;     ///< by place
} disk_list;

/// What the planar path needs of a kind of part.
typedef struct disk_kind {
    disk_row row;  ///< radius, softness and inverse mass; the rest is 0
    double brake;  ///< A, rad/s2
    double height; ///< m
} disk_kind;
