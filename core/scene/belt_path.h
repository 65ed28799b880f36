/// A belt along a path: a line of straights that arcs join, with a width.
///
/// One belt has one velocity for all its places only where it is straight. So a path is resolved into sections, each a straight
/// (scene_leg) or an arc whose reference radius is that of the centre line, which move at the belt's speed there. Its first
/// section is the belt itself; the others follow all belts of the document in scene.belts. They have its id and are told what it
/// is told: schedules, stops, commands and friction are the belt's.
///
///     what lies under a place, moves it, is bounded by a border: each of scene.n_sections
///     what a document, an action, a figure or a fault names:     one of scene.n_belts, scene_belt_of()
///
/// Where straight and arc meet, v_T jumps on all but the centre line: cargo on the outer side comes to go faster and lies less dense,
/// on the inner side slower and denser. What crosses the joint is the same on both sides.
///
/// Units    SI.

#pragma once

#include "core/base/faults.h"
#include "core/base/status.h"
#include "core/scene/scene.h"

/// Inner corners at which a path turns by less than this have no arc, rad: coordinates are rounded.
#define BELT_PATH_STRAIGHT 1e-9

/// The belt of the document that a section is of.
static inline size_t scene_belt_of(const scene *s, size_t section)
{
    return section < s->n_belts ? section : s->belts[section].of;
}

/// Lay out the sections of all paths that are sound, in the place of earlier ones, as far as SCENE_BELTS_MAX allows. BF_ENOMEM.
BF_MUST_CHECK bf_status belt_path_lay_out(scene *s, bf_error *err);

/// Give sections what they share with their belts.
void belt_path_hand_on(scene *s);

/// Note what is wrong with the path of a belt; pointer is that of the belt.
void belt_path_check(const scene_belt *belt, const char *pointer, bf_faults *faults);
