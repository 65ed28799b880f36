/// Private to core/scene: what the checks of a scenario share.

#pragma once

#include "core/base/range.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    REPORTED_MAX = 4,    ///< bad items of a list that are reported
    ROOM_FOR_INDEX = 24, ///< bytes of "/" and an index
};

/// A number of a struct and its valid range.
typedef struct number_rule {
    const char *pointer;   ///< below that of the struct
    size_t offset;         ///< of the double in the struct
    const bf_range *range; ///< of the number
} number_rule;

#define RULE(pointer, type, member, range)                                                         \
    {                                                                                              \
        pointer, offsetof(type, member), &(range)                                                  \
    }

/// Note numbers of a struct that are out of range; pointer is that of the struct.
void scene__check_numbers(const void *item, const char *pointer, const number_rule *rules, size_t n,
                          bf_faults *faults);

/// Note a list of more than n_max items ("feeds"); pointer is that of the list. Returns true if it has no more.
bool scene__check_count(size_t n, size_t n_max, const char *pointer, const char *items,
                        bf_faults *faults);

/// Note a number of parts that is not whole, or below 1; INFINITY, no limit, is none of these.
void scene__check_limit(double n_parts, const char *pointer, bf_faults *faults);

/// What an id is, with the most characters as %d.
#define ID_TEXT "must be 1 to %d letters, digits, '_', '.' and '-'"

/// Note the id of item k of a list ("belts") if it is none, or that of an item before it. The structs begin
/// with their ids; items points at the first one, and size is that of a struct.
void scene__check_id(const void *items, size_t size, const char *list, size_t k, bf_faults *faults);

/// True if both coordinates are numbers within SCENE_LENGTH_MAX.
bool scene__is_place(vec2 at);

/// Note the first point that is no number or repeats the one before it; whole: point at the pointer
/// itself instead of at the point. Returns true if there is none.
bool scene__check_points(const vec2 *points, size_t n, const char *pointer, bool whole,
                         bf_faults *faults);

/// Note what is wrong with an outline: its corners, or sides that cross or touch. Returns true if nothing is.
bool scene__check_polygon(const vec2 *polygon, size_t n, const char *pointer, bf_faults *faults);

/// Note times that are out of range or do not rise (may_repeat: fall); pointer is that of the list. Returns true
/// if there are none.
bool scene__check_times(const double *times, size_t n, const char *pointer, bool may_repeat,
                        bf_faults *faults);

/// Note what is wrong with a function of time at pointer: its times, its values, which are the member of that
/// name, and when it begins again. Returns true if nothing is.
bool scene__check_series(const scene_series *series, const char *pointer, const char *values,
                         const bf_range *range, bf_faults *faults);

/// The checks by subject.
void scene__check_belts(const scene *s, bf_faults *faults);
void scene__check_obstacles(const scene *s, bf_faults *faults);
void scene__check_photo_eyes(const scene *s, bf_faults *faults);
void scene__check_sinks(const scene *s, bf_faults *faults);
void scene__check_actions(const scene *s, bf_faults *faults);
void scene__check_merges(const scene *s, bf_faults *faults);
void scene__check_feeds(const scene *s, bf_faults *faults);

/// Where feeds lie: on belts that carry their parts away, clear of plates and of each other, and with room for every
/// kind. Needs a scene without a fault.
void scene__check_feed_lines(const scene *s, bf_faults *faults);

/// How many faults of one kind about places are reported: 1 for a pattern, which is reported as a whole.
size_t placement__reported_max(const scene *s);

/// The pointer of part k, in room of BF_POINTER_SIZE bytes where it must be made.
const char *placement__point_at(const scene *s, size_t k, char *room);
