/// Internal interface of micro.c and check.c.

#pragma once

#include "core/micro/micro.h"

enum { MICRO__COOKIE = 0x62656c75 }; ///< what micro_def_default() leaves in a definition

/// The fastest speed of any point of a plate, m/s, and whose it is.
double micro__plate_speed(const micro_def *def, size_t *ret_obstacle);

/// Check all members of a definition but dt.
BF_MUST_CHECK bf_status micro__check(const micro_def *def, bf_error *err);

/// Whether a part's centre may be there: in the domain, with a finite heading.
bool micro__is_inside(const scene_rect *domain, const scene_pose *pose);
