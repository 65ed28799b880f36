/// Validity: whether a scenario lies where the macroscopic model was compared with the microscopic one.
///
/// A density cannot show everything that parts do: they bridge narrow openings, and single ones matter
/// where there are few. So the model is trusted where both models were solved for the same scenarios and
/// agreed (core/README.md has the comparison). Figures of a scenario (angles, openings, the heap, ...) are
/// compared with the ranges of that comparison, which are one table in validity.c, a column for each closure. What lies outside is no
/// fault: the scenario can be solved, and its results are to be doubted.
///
/// Where nothing deflects the cargo it rides on its belt in both models, and only the walls and belts
/// themselves are looked at.

#pragma once

#include "core/base/faults.h"
#include "core/base/status.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/// The figures, each with its unit. Diameters of parts are those of the circle about the largest one.
typedef enum validity_figure {
    VALIDITY_ANGLE,          ///< of a plate to the belt, degrees (core/scene/layout.h)
    VALIDITY_OPENING,        ///< the narrowest of a single plate, diameters
    VALIDITY_FUNNEL,         ///< the narrowest of several plates, diameters
    VALIDITY_HEAP,           ///< parts for each diameter of the narrowest opening
    VALIDITY_PARTS,          ///< parts at the start
    VALIDITY_SPEED,          ///< of a belt, m/s
    VALIDITY_SCHEDULES,      ///< belts whose speed changes in time
    VALIDITY_BELTS,          ///< belts that differ in their velocity
    VALIDITY_PLATES,         ///< plates that deflect cargo
    VALIDITY_BENDS,          ///< of one plate
    VALIDITY_PIECES,         ///< straight pieces of all plates
    VALIDITY_WALL,           ///< angle at which a belt runs against a wall, degrees
    VALIDITY_DIAMETER,       ///< of a part, m
    VALIDITY_SHAPE,          ///< parts that are no cylinders, %
    VALIDITY_KINDS,          ///< kinds of cargo
    VALIDITY_PLATE_FRICTION, ///< mu of parts on plates
    VALIDITY_PART_FRICTION,  ///< mu of parts on parts
    VALIDITY_BELT_FRICTION,  ///< mu of parts on belts
    VALIDITY_TREATMENT,      ///< obstacles that are not SCENE_SEALED
    VALIDITY_CELL,           ///< edge of a cell, diameters
    VALIDITY_MOTIONS,        ///< obstacles that turn, come or go
    VALIDITY_FIGURE_COUNT
} validity_figure;

enum {
    VALIDITY_ITEMS_MAX = 2 * VALIDITY_FIGURE_COUNT ///< each figure too small, and too large
};

/// A figure that is out of its range.
typedef struct validity_item {
    validity_figure figure;        ///< which
    double value;                  ///< the value that is farthest out
    const char *unit;              ///< of the value and the range, as documents name it; NULL: none
    double minimum;                ///< of the range, -INFINITY: none
    double maximum;                ///< of the range, INFINITY: none
    char pointer[BF_POINTER_SIZE]; ///< what has that value, in the scenario's document
    char title[96];                ///< for people: the value
    const char *meaning;           ///< for people: what to expect
    char comparison[160];          ///< for people: the range
    char detail[BF_TEXT_SIZE];     ///< for people: value, range, and what to expect
} validity_item;

/// What is to be said about a scenario.
typedef struct validity {
    scene_closure closure;                   ///< of the model that would solve it
    bool is_compared;                        ///< every figure is within its range
    size_t n;                                ///< items
    validity_item items[VALIDITY_ITEMS_MAX]; ///< by rising figure, too small before too large
} validity;

/// The words of the figures in documents, "angle" and so on; NULL-terminated.
extern const char *const validity_words[];

/// The validity of the macroscopic model for a resolved and checked scenario. BF_ENOMEM.
BF_MUST_CHECK bf_status validity_of(const scene *s, validity *ret_validity, bf_error *err);
