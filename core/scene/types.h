/// A scenario as plain data; see scene.h for the functions on it.
///
/// Units    SI: m, s, kg, m/s, Pa. Angles are radians.

#pragma once

#include "core/base/vec2.h"
#include "core/scene/belt_types.h"
#include "core/scene/equipment_types.h"
#include "core/scene/feed_types.h"
#include "core/scene/goods_types.h"
#include "core/scene/limits.h"
#include "core/scene/parameters.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// A rectangle with its sides along the axes.
typedef struct scene_rect {
    double x_min; ///< m
    double x_max; ///< m, > x_min
    double y_min; ///< m
    double y_max; ///< m, > y_min
} scene_rect;

/// What a side of the domain is.
typedef enum scene_edge {
    SCENE_EDGE_INFLOW,  ///< density 0 outside (11a)
    SCENE_EDGE_OUTFLOW, ///< open: cargo leaves
    SCENE_EDGE_WALL,    ///< solid: no flux crosses it (11b)
    SCENE_EDGE_COUNT
} scene_edge;

/// How the macroscopic model holds cargo back at an obstacle.
typedef enum scene_treatment {
    SCENE_SEALED, ///< line closed, outward field upstream of it: agrees best with the microscopic model
    SCENE_FIELD, ///< the paper's field alone (sections 3.1, 4.2): cargo leaks through
    SCENE_WALL,  ///< line closed (11b), slide zone only
    SCENE_TREATMENT_COUNT
} scene_treatment;

/// A deflector ("singularizer"): a polyline plate standing on the belt.
typedef struct scene_obstacle {
    char id[SCENE_ID_SIZE];    ///< unique among obstacles (default "obstacle-<n>", n from 1)
    size_t n_points;           ///< >= 2
    vec2 *path;                ///< corners, m
    double thickness;          ///< of the plate, m, > 0: see surroundings.h (default 0.005)
    scene_treatment treatment; ///< (default SCENE_SEALED)
    double band; ///< SCENE_SEALED: width of the outward field B, m, > 0 (default 8/sqrt(sigma))
    double slide_width; ///< width of the slide zone C, m, > 0 (default 3/sqrt(sigma); 0.02 for
                        ///< SCENE_FIELD and SCENE_WALL)
    vec2 pivot;         ///< about which it turns, m (default the start of its path)
    scene_series turn;  ///< angle by which its path is turned, counter-clockwise, rad: linear
                        ///< between the times, constant outside; 0 where only shifts were given
    size_t n_shifts;    ///< 0: none; else as many as `turn` has times
    vec2 *shifts;       ///< by which its path, turned, and its pivot are shifted at those times, m
    scene_series presence; ///< 1: it stands there, 0: it does not; from each time to the next,
                           ///< 1 before the first
    double force_limit;    ///< of its drive, see plate_drive.h, N, > 0; 0: chosen (default 0)
    bool is_commanded;     ///< an action moves it or lets it come and go; set by scene_resolve()
} scene_obstacle;

/// Shapes of cargo.
typedef enum scene_shape_type {
    SCENE_CYLINDER, ///< upright cylinder
    SCENE_BOX,      ///< cuboid
    SCENE_PRISM,    ///< convex outline, upright
    SCENE_HULL,     ///< convex hull of points
    SCENE_SHAPE_COUNT
} scene_shape_type;

/// The shape of a part, in its own frame.
typedef struct scene_shape {
    scene_shape_type type; ///< (default SCENE_CYLINDER)
    double radius;         ///< cylinder, m, > 0 (default 0.012)
    double height;         ///< cylinder, box, prism, m, > 0 (default 0.008)
    double length;         ///< box along x, m, > 0
    double width;          ///< box along y, m, > 0
    size_t n_vertices;     ///< prism: 3 to 64 corners; hull: 4 to 64 points
    double (*vertices)[3]; ///< prism: counter-clockwise corners (z unused); hull: points, m
} scene_shape;

/// A kind of parts that are transported.
typedef struct scene_cargo {
    char id[SCENE_ID_SIZE]; ///< unique among kinds (default where there are feeds "cargo", then
                            ///< "cargo-<n>", n from 2; else none)
    scene_goods goods; ///< whose shape, mass and surface it began with; a name, the numbers count
                       ///< (default SCENE_GOODS_COUNT: none)
    double share;      ///< parts of it in proportion to all shares, > 0 (default 1)
    scene_shape shape; ///< see there
    double mass;       ///< kg, > 0 (default: steel, 7850 kg/m3 times the volume)
    scene_surface surface;   ///< its frictions follow from it (default SCENE_SURFACE_COUNT: none)
    scene_material material; ///< (default 210e9 Pa, 0.28)
    double spin_friction_radius; ///< m, >= 0 (default that of micro if given, else 2/3 of the
                                 ///< footprint's radius)
} scene_cargo;

/// When a run ends before its duration.
typedef enum scene_until {
    SCENE_UNTIL_DURATION, ///< never
    SCENE_UNTIL_DRAINED,  ///< when no feed will deliver any more part and the domain is empty
    SCENE_UNTIL_STEADY,   ///< when the throughput is known well enough: core/observe/steady.h
    SCENE_UNTIL_COUNT
} scene_until;

/// Where the parts are at the start.
typedef enum scene_initial_type {
    SCENE_INITIAL_POSITIONS,
    SCENE_INITIAL_HEXAGONAL,
    SCENE_INITIAL_RANDOM,
    SCENE_INITIAL_EMPTY, ///< no parts; only where there is a feed, and then the default
    SCENE_INITIAL_COUNT
} scene_initial_type;

/// One part's place.
typedef struct scene_pose {
    double x;       ///< m
    double y;       ///< m
    double heading; ///< rad, counter-clockwise from the x axis
} scene_pose;

/// The places of all parts at t = 0.
typedef struct scene_placement {
    size_t n;          ///< parts; 0: not placed yet
    scene_pose *poses; ///< n of them
    uint32_t *kinds;   ///< kind of each; NULL: all are of kind 0
    bool is_borrowed;  ///< the arrays are owned by another struct
} scene_placement;

/// The source of cargo at t = 0. Only the members of its type are used.
typedef struct scene_initial {
    scene_initial_type type; ///< (no default)
    size_t n_poses;          ///< positions: how many
    scene_pose *poses;       ///< positions: where
    uint32_t n_rows;         ///< hexagonal: rows, each along the belt, >= 1
    uint32_t n_columns;      ///< hexagonal: parts a row, >= 1
    vec2 first;              ///< hexagonal: first centre of the first row, m
    double spacing;    ///< hexagonal: between neighbours, m, > 0; odd rows are shifted by half
                       ///< of it along the belt, rows are spacing * sqrt(3)/2 apart
    uint32_t n_random; ///< random: how many, >= 1
    scene_rect region; ///< random: centres lie in it, m
    uint64_t seed;     ///< random: of the generator (default 1), < 2^53
} scene_initial;

/// Counts the parts inside a rectangle: U(t) of the paper.
typedef struct scene_counter {
    char id[SCENE_ID_SIZE]; ///< unique, a column of the curve (default "upstream", "upstream-<n>")
    scene_rect rect;        ///< x_min <= x < x_max, same in y (default the domain's)
    uint32_t kind;          ///< index of a kind, counted alone (default SCENE_KIND_ANY: all)
} scene_counter;

/// A span of time in which results are taken at other periods.
typedef struct scene_output_window {
    double from;           ///< s, >= 0
    double to;             ///< s, > from
    double curve_every;    ///< s, > 0 (default that of the output)
    double snapshot_every; ///< s, > 0 (default that of the output)
} scene_output_window;

/// When results are taken.
typedef struct scene_output {
    double curve_every;           ///< s, > 0 (default 0.01)
    double snapshot_every;        ///< s, > 0 (default 0.1)
    size_t n_windows;             ///< (default none)
    scene_output_window *windows; ///< from <= t < to; they rise and do not overlap
} scene_output;

/// The whole scenario. Begin with scene_init().
typedef struct scene {
    char name[SCENE_NAME_SIZE];         ///< a free text (default "")
    double duration;                    ///< s, > 0 (no default)
    scene_rect domain;                  ///< (no default)
    scene_edge edges[SCENE_SIDE_COUNT]; ///< (default inflow, outflow, wall, wall)
    size_t n_belts;                     ///< (default one, "main")
    size_t n_sections;  ///< n_belts, and the sections of paths but their first ones, which come
                        ///< after those: belt_path.h; set by scene_resolve()
    scene_belt *belts;  ///< n_belts as given, n_sections once resolved
    bool may_drop;      ///< some of the domain is under no belt: parts may fall; set by
                        ///< scene_resolve()
    size_t n_obstacles; ///< (default none)
    scene_obstacle *obstacles;          ///< see there
    size_t n_cargo;                     ///< kinds of cargo, >= 1 (default 1)
    scene_cargo cargo[SCENE_KINDS_MAX]; ///< see there
    bool is_mix;                        ///< the document lists kinds; true where n_cargo > 1
    uint64_t cargo_seed;   ///< of the order in which parts get their kinds, < 2^53 (default 1)
    scene_initial initial; ///< see there
    size_t n_feeds;        ///< (default none)
    scene_feed *feeds;     ///< see there
    uint64_t substream;    ///< of all draws of feeds and failures, < 2^53 (default 0); replications
                           ///< differ in it
    size_t n_eyes;         ///< (default none)
    scene_photo_eye *eyes; ///< see there
    size_t n_sinks;        ///< (default none)
    scene_sink *sinks;     ///< see there
    size_t n_actions;      ///< (default none)
    scene_action *actions; ///< see there
    size_t n_merges;       ///< (default none)
    scene_merge *merges;   ///< see there
    double warmup;         ///< s that key figures leave out, >= 0 (default 0)
    double jam_time;       ///< s without an exit that count as a jam, > 0 (default 5)
    scene_until until;     ///< (default SCENE_UNTIL_DURATION)
    double steady_precision;   ///< SCENE_UNTIL_STEADY: half width of the throughput's confidence
                               ///< interval, relative to the throughput, > 0 (default 0.05)
    scene_placement placement; ///< of initial; filled in by scene_check()
    size_t n_counters;         ///< (default one)
    scene_counter *counters;   ///< (default "upstream": the domain)
    scene_output output;       ///< see there
    scene_macro macro;         ///< see there
    scene_micro micro;         ///< see there
    scene_surfaces surfaces;   ///< see there
} scene;
