/// Validity: whether a scenario lies where its model was compared with what is known.
///
/// A density cannot show everything that parts do: they bridge narrow openings, and single ones matter
/// where there are few. So the macroscopic model is trusted where both models were solved for the same scenarios and
/// agreed (core/advice/README.md has the comparison), and the microscopic one where it was compared with experiments and with
/// itself at harder contacts (tests/slow/test_experiments.c, tests/validation). Every figure that a scenario has
/// (angles, openings, the heap, feeds, belts, ...) is one of
///
///     compared        within the range of the comparison
///     outside         out of that range
///     never compared  no comparison had such a figure, or its value is not known
///
/// by one table in validity_table.c, a row a figure and a column for each closure and for the microscopic model. A
/// scenario is compared if every figure of it is. What is not is no fault: it can be solved, and its results are to
/// be doubted.
///
/// Where nothing deflects the cargo it rides on its belt in both models, and only walls, belts, what moves and what
/// is commanded are looked at.

#pragma once

#include "core/advice/layout.h"
#include "core/advice/review.h"
#include "core/base/faults.h"
#include "core/base/status.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/// What is compared.
typedef enum validity_subject {
    VALIDITY_DISPERSIVE,  ///< the macroscopic model with SCENE_DISPERSIVE
    VALIDITY_CONGESTED,   ///< the same with SCENE_CONGESTED
    VALIDITY_PARTS_MODEL, ///< the microscopic model
    VALIDITY_SUBJECT_COUNT
} validity_subject;

/// The figures, each with its unit. Diameters of parts are those of the circle about the largest one.
typedef enum validity_figure {
    VALIDITY_ANGLE,   ///< of a plate to the belt, degrees (core/advice/layout.h)
    VALIDITY_OPENING, ///< the narrowest of a single plate, diameters
    VALIDITY_FUNNEL,  ///< the narrowest of several plates, diameters
    VALIDITY_LANE,    ///< the narrowest of a single plate that bends, diameters
    VALIDITY_STAGGER, ///< of two plates before which cargo queues, diameters (layout.h)
    VALIDITY_FREE_ENDS, ///< angle of a single plate with two free ends before which cargo queues, degrees (layout.h)
    VALIDITY_RUN_OUT,   ///< belt behind a plate before which cargo queues, diameters (layout.h)
    VALIDITY_NEXT_BELT, ///< belt behind a plate whose opening is full, up to a belt of another velocity, diameters (layout.h)
    VALIDITY_SHORT_END, ///< by which a plate whose opening is full stands off its wall, diameters (layout.h)
    VALIDITY_FUNNEL_ANGLE,  ///< least angle of several plates whose opening is full, degrees
    VALIDITY_SLIDING,       ///< mu of parts on plates at less than 50 degrees whose opening is full
    VALIDITY_FRICTION_FULL, ///< mu of parts on parts whose opening is nearly full
    VALIDITY_ACCELERATION_FULL, ///< v^2/(2 mu g) where the opening is nearly full, diameters
    VALIDITY_LANE_QUEUE,        ///< belt upstream of a full lane that feeds may fill, diameters
    VALIDITY_BESIDE,            ///< feeds that leave some of their belt free where cargo queues
    VALIDITY_BRIDGES, ///< queues before the narrowest opening that stop for good within 1,000 parts, % (bridges.h)
    VALIDITY_SWEPT,   ///< the narrowest that plates come to where they move, diameters
    VALIDITY_HEAP,    ///< parts at the start for each diameter of the narrowest opening
    VALIDITY_WARM_UP, ///< of a heap that no feed follows, s
    VALIDITY_LOAD,    ///< what feeds offer of what the narrowest opening passes when it is full, %
    VALIDITY_FEED,    ///< what a feed offers of what the belt under it carries when it is packed, %
    VALIDITY_QUEUE,   ///< belt upstream of an opening that feeds may fill, diameters
    VALIDITY_PARTS,   ///< parts at the start and of feeds
    VALIDITY_BATCH,   ///< parts that arrive at once
    VALIDITY_SPEED,   ///< of a belt, m/s
    VALIDITY_ACCELERATION, ///< v^2/(2 mu g): belt that the fastest one needs to bring a part to its speed, diameters
    VALIDITY_SCHEDULES, ///< belts whose speed changes in time
    VALIDITY_COMMANDS,  ///< actions of photo eyes, and merges
    VALIDITY_SINKS,     ///< sinks
    VALIDITY_BELTS,     ///< belts that differ in their velocity; one with arcs counts twice
    VALIDITY_ARCS,      ///< arcs, those of paths too
    VALIDITY_CURVE,     ///< radius of an arc's centre line, widths of its belt
    VALIDITY_CORNERING, ///< v^2/(mu g R) there: friction of the belt that turning takes, %
    VALIDITY_INCLINE,   ///< of a belt that is not level, up positive, degrees
    VALIDITY_TURN,      ///< angle between the velocities of two belts, degrees
    VALIDITY_RATIO,     ///< of the speeds of two belts
    VALIDITY_TRANSFER, ///< what feeds offer of what the narrowest or slowest of several belts carries, %
    VALIDITY_FALLS,    ///< places at which cargo gets off the belts (review_belts.h)
    VALIDITY_PLATES,   ///< plates that deflect cargo
    VALIDITY_GUIDES,   ///< plates along their belt
    VALIDITY_BENDS,    ///< of one plate
    VALIDITY_PIECES,   ///< straight pieces of all plates
    VALIDITY_WALL,     ///< angle at which a belt runs against a wall, degrees
    VALIDITY_DIAMETER, ///< of a part, m
    VALIDITY_SIZES,    ///< of the diameters of two kinds of parts, their ratio
    VALIDITY_MASS,     ///< of a part, kg
    VALIDITY_MASSES,   ///< of two kinds of parts, their ratio
    VALIDITY_SHAPE,    ///< parts that are no cylinders, %
    VALIDITY_TIPPING,  ///< mu on the belt times height over least width: above 1 a part can tip
    VALIDITY_KINDS,    ///< kinds of cargo
    VALIDITY_PLATE_FRICTION, ///< mu of parts on plates
    VALIDITY_WALL_FRICTION,  ///< mu of parts on walls
    VALIDITY_PART_FRICTION,  ///< mu of parts on parts
    VALIDITY_BELT_FRICTION,  ///< mu of parts on belts
    VALIDITY_SMOOTHING,      ///< lambda_lin of parts on belts, s/m
    VALIDITY_TREATMENT,      ///< obstacles that are not SCENE_SEALED
    VALIDITY_CELL,           ///< edge of a cell, diameters
    VALIDITY_CONSTANTS,      ///< constants of the model that are not those of the comparison
    VALIDITY_MOTIONS,        ///< obstacles that move, come or go
    VALIDITY_SHIFTS,         ///< of them, those that are shifted
    VALIDITY_OVERLAP,        ///< of parts that is to be expected, % of the smallest radius
    VALIDITY_FIGURE_COUNT
} validity_figure;

enum {
    VALIDITY_OUTSIDE_MAX = 2 * VALIDITY_FIGURE_COUNT, ///< each figure too small, and too large
    VALIDITY_NEVER_MAX = VALIDITY_FIGURE_COUNT
};

/// A figure that is out of its range, or was never compared.
typedef struct validity_item {
    validity_figure figure;        ///< which
    double value;                  ///< the value that is farthest out; NAN: it is not known
    const char *unit;              ///< of the value and the range, as documents name it; NULL: none
    double minimum;                ///< of the range, not finite: none
    double maximum;                ///< of the range, not finite: none
    char pointer[BF_POINTER_SIZE]; ///< what has that value, in the scenario's document
    char title[128];               ///< for people: the value
    const char *meaning;           ///< for people: what to expect
    char comparison[224];          ///< for people: the range
    char detail[640];              ///< for people: value, range, and what to expect
} validity_item;

/// Scenes of the comparison that are like a scenario (comparisons.h).
typedef struct validity_like {
    size_t n;       ///< how many
    double largest; ///< by which the rate of the model was off in one of them, %
    double mean;    ///< of its size in all of them, %
    char text[160]; ///< for people; empty: there are none
} validity_like;

/// What is to be said about a scenario.
typedef struct validity {
    validity_subject subject; ///< the model that would solve it
    validity_like like;       ///< how far off it was in scenes like this one
    layout layout;            ///< of plates and walls, as it was measured
    review_warnings falls;    ///< of cargo that gets off the belts (review_belts.h)
    bool is_compared;         ///< every figure was compared
    size_t n;                 ///< outside
    size_t n_never;           ///< never compared
    validity_item
        items[VALIDITY_OUTSIDE_MAX]; ///< outside, by rising figure, too small before too large
    validity_item never[VALIDITY_NEVER_MAX]; ///< never compared, by rising figure
} validity;

/// The words of the figures in documents, "angle" and so on; NULL-terminated.
extern const char *const validity_words[];

/// The values of comparisons_columns that a resolved and checked scenario has, NAN where it has none; all of them, if one
/// is not known. BF_ENOMEM.
BF_MUST_CHECK bf_status validity_values(const scene *s, validity_subject subject,
                                        double *ret_values, bf_error *err);

/// The validity of the macroscopic model for a resolved and checked scenario, with its closure. BF_ENOMEM.
BF_MUST_CHECK bf_status validity_of(const scene *s, validity *ret_validity, bf_error *err);

/// The validity of the microscopic model for it; overlap is the share of the smallest radius by which parts are expected
/// to overlap, NAN to leave that out. BF_ENOMEM.
BF_MUST_CHECK bf_status validity_of_parts(const scene *s, double overlap, validity *ret_validity,
                                          bf_error *err);
