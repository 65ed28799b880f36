/// What usual goods are like, and how much surfaces rub on each other: facts with their sources.
///
/// The microscopic model has one contact law for each of three pairs: part on part, belt on part, obstacle or
/// wall on part. A friction that a scenario does not give follows from the surfaces of its cargo:
///
///     no kind of cargo has a surface    the paper's: 0.15, 1 and 0.19
///     each kind has one                 the one friction that all kinds have on this surface, and on each other
///     otherwise                         a fault: there is no rule by which one number would be right
///
/// Elastic constants are the scenario's own: only the hardness that a solver can afford depends on them.

#pragma once

#include "core/base/faults.h"
#include "core/scene/types.h"

#include <stdbool.h>
#include <stddef.h>

/// Where a fact was published.
typedef struct goods_source {
    const char *title; ///< who says it, and where; "assumed": nobody does
    const char *url;   ///< NULL: none
} goods_source;

/// Goods of a name.
typedef struct goods_item {
    const char *title;          ///< "beverage can, 0.33 l, full"
    scene_shape_type type;      ///< SCENE_CYLINDER or SCENE_BOX
    double size[3];             ///< cylinder: diameter, height; box: length, width, height; m
    double mass;                ///< kg; 0: steel
    scene_surface surface;      ///< SCENE_SURFACE_COUNT: the frictions are the paper's
    const goods_source *source; ///< of sizes and mass
    const char *note;           ///< what of them is assumed, and why; "": nothing
} goods_item;

/// The friction of two surfaces, in any order.
typedef struct goods_friction {
    scene_surface a;            ///< one of them
    scene_surface b;            ///< the other
    double low;                 ///< of the range that the source gives
    double high;                ///< same
    const goods_source *source; ///< see there
    const char *note;           ///< conditions, or why it is assumed
} goods_friction;

extern const goods_item goods_items[SCENE_GOODS_COUNT];             ///< by scene_goods
extern const goods_friction goods_frictions[];                      ///< each pair once
extern const size_t goods_n_frictions;                              ///< of them
extern const char *const goods_surface_titles[SCENE_SURFACE_COUNT]; ///< "steel, tinplate"

/// The friction that is taken for a pair: the middle of its range, to four decimals.
double goods_friction_of(const goods_friction *pair);

/// Give a kind of cargo the shape, mass and surface of goods, and their name.
void goods_apply(scene_goods goods, scene_cargo *kind);

/// Fill in surfaces and frictions that are not given, as above. A friction that has no one value stays NAN, and
/// goods_check() says why.
void goods_resolve(scene *s);

/// Note frictions that are out of range or have no value, and surfaces that nothing rubs on.
void goods_check(const scene *s, bf_faults *faults);
