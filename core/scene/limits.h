/// The limits of a scenario. They bound the memory and the work that a client can cause.

#pragma once

enum {
    SCENE_NAME_SIZE = 201, ///< bytes of a scenario's name with its terminator
    SCENE_ID_SIZE = 65,    ///< bytes of an id with its terminator
    SCENE_BELTS_MAX = 256, ///< belts in a scenario, a path counting up to 2 n - 3 of its n points
    SCENE_PATH_MAX = 64,   ///< points of a belt's path
    SCENE_SPEEDS_MAX = 10000,     ///< times of a belt's speed schedule
    SCENE_SERIES_MAX = 100000,    ///< times of a profile, a list of arrivals, a motion
    SCENE_FAILURES_MAX = 8,       ///< kinds of failures of a belt
    SCENE_ALL_FAILURES_MAX = 256, ///< of all belts
    SCENE_BREAKS_MAX = 32,        ///< entries of a belt's breaks
    SCENE_STOPS_MAX =
        10000, ///< stops of a belt by failures and breaks that are to be expected in a run
    SCENE_FEEDS_MAX = 64,        ///< feeds in a scenario
    SCENE_EYES_MAX = 64,         ///< photo eyes in a scenario
    SCENE_SINKS_MAX = 64,        ///< sinks in a scenario
    SCENE_STAGES_MAX = 1000,     ///< stages of a gap of Erlang arrivals
    SCENE_ACTIONS_MAX = 256,     ///< actions in a scenario
    SCENE_MERGES_MAX = 32,       ///< merges in a scenario
    SCENE_LANES_MAX = 16,        ///< lanes of a merge
    SCENE_WINDOWS_MAX = 256,     ///< output windows in a scenario
    SCENE_OBSTACLES_MAX = 256,   ///< obstacles in a scenario
    SCENE_POINTS_MAX = 1024,     ///< points of a polygon or a path
    SCENE_VERTICES_MAX = 64,     ///< vertices of a cargo shape
    SCENE_KINDS_MAX = 32,        ///< kinds of cargo in a scenario
    SCENE_COUNTERS_MAX = 32,     ///< counters in a scenario
    SCENE_PARTS_MAX = 1000000,   ///< parts in a scenario
    SCENE_CELLS_MAX = 100000000, ///< cells of the macroscopic grid: at most some 80 bytes each
    SCENE_CONGESTED_CELLS_MAX =
        30000000,                   ///< the same with SCENE_CONGESTED: at most some 265 bytes each
    SCENE_CELLS_SIDE_MAX = 1 << 24, ///< cells of it along one side
    SCENE_SAMPLES_MAX = 1000000,    ///< samples of the outflow curve
    SCENE_SNAPSHOTS_MAX = 20000,    ///< density snapshots of a run
};

/// Most steps of a run.
#define SCENE_STEPS_MAX 1e9

/// Most bytes of all density snapshots of a run together, before compression; of all rows of parts
/// too.
#define SCENE_SNAPSHOT_BYTES_MAX 8e9

/// Borders of bands and of obstacles' ends are taken with this tolerance, m, in favour of the band.
#define SCENE_TOLERANCE 1e-9

/// Largest coordinate and length, and smallest length of a part, m.
#define SCENE_LENGTH_MAX 1e5
#define SCENE_LENGTH_MIN 1e-6

/// Largest speed, m/s.
#define SCENE_SPEED_MAX 1e3

/// Largest incline of a belt, up or down, rad: 45 degrees, and what rounding adds to them.
#define SCENE_INCLINE_MAX (0.25 * M_PI + 1e-12)

/// Most values that the density of the parts at the start may take to sum up: parts times cells
/// within the cut-off of initial_mollifier.
#define SCENE_INITIAL_WORK_MAX 1e12

/// The same for the density of the parts in all snapshots of a microscopic run.
#define SCENE_DENSITY_WORK_MAX 1e13

/// Most steps, of a few nanoseconds each, of the search for free places and overlaps of the parts at the start; of
/// looking for parts in plates; of all other checks together (check_work.h). So a check takes less than a second.
#define SCENE_PLACEMENT_STEPS_MAX 70000000
#define SCENE_CHECK_STEPS_MAX     1e8

/// Numbers of the defaults that follow from other members (scene_resolve); documents name them. Density of
/// steel, kg/m3; widths of the outward field and of the slide zone times sqrt(sigma); width of the slide
/// zone of obstacles that are not sealed, m; steps of the paper's two models, s.
#define SCENE_STEEL_DENSITY 7850
#define SCENE_BAND_FACTOR   8
#define SCENE_SLIDE_FACTOR  3
#define SCENE_SLIDE_WIDTH   0.02
#define SCENE_MACRO_STEP    0.00125
#define SCENE_MICRO_STEP    1e-5

/// Default time without an exit that counts as a jam, s.
#define SCENE_JAM_TIME 5.0
