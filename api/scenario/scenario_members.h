/// The scenario document as tables; the README of api lists them.

#pragma once

#include "api/json/members.h"

/// The whole document; its struct is scene.
extern const member_table scenario_members;

/// An obstacle; its struct is scene_obstacle.
extern const member_table scenario_members_obstacle;
