/// The scenario document as tables; the README of api lists them.

#pragma once

#include "api/json/members.h"

/// The words of the closures of the macroscopic model; NULL-terminated.
extern const char *const scenario_closure_words[];

/// The whole document; its struct is scene.
extern const member_table scenario_members;

/// An obstacle; its struct is scene_obstacle.
extern const member_table scenario_members_obstacle;
