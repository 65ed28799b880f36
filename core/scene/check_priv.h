/// What the files of scene_check() share.

#pragma once

#include "core/base/faults.h"
#include "core/scene/scene.h"

/// Which ends of a range do not belong to it.
enum { SCENE_CHECK__OPEN_LOW = 1, SCENE_CHECK__OPEN_HIGH = 2 };

/// A number of a struct and the range it must keep to.
typedef struct scene_check__rule {
    const char *pointer; ///< below that of the struct
    size_t offset;       ///< of the double in the struct
    double low;          ///< least
    double high;         ///< most
    unsigned open;       ///< SCENE_CHECK__OPEN_LOW, SCENE_CHECK__OPEN_HIGH
} scene_check__rule;

/// Rules of a struct's member: above 0; from low to high; from 0 to below 0.5.
#define SCENE_CHECK__ABOVE_0(pointer, type, member, high)                                          \
    {                                                                                              \
        pointer, offsetof(type, member), 0.0, high, SCENE_CHECK__OPEN_LOW                          \
    }
#define SCENE_CHECK__FROM(pointer, type, member, low, high)                                        \
    {                                                                                              \
        pointer, offsetof(type, member), low, high, 0                                              \
    }
#define SCENE_CHECK__BELOW_HALF(pointer, type, member)                                             \
    {                                                                                              \
        pointer, offsetof(type, member), 0.0, 0.5, SCENE_CHECK__OPEN_HIGH                          \
    }

/// Note numbers of a struct that are out of range; pointer is that of the struct.
void scene_check__numbers(const void *item, const char *pointer, const scene_check__rule *rules,
                          size_t n, bf_faults *faults);

/// Note numbers of the kinds of cargo that are out of range, and a path of the microscopic model that
/// is not for their shapes.
void scene_check__cargo(const scene *s, bf_faults *faults);

/// Note what placing the parts needs to be sound: every fault of the kinds' shares and shapes, and kinds
/// too unlike in size.
void scene_check__shapes(const scene *s, bf_faults *faults);

/// Note sizes beyond their limits and steps beyond stability. Needs sound domain, belts and numbers.
void scene_check__sizes(const scene *s, bf_faults *faults);

/// Note every fault of belts, obstacles and counters: ids, paths, polygons, rectangles.
void scene_check__items(const scene *s, bf_faults *faults);
