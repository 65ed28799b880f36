/// Private to api/scenario.

#pragma once

#include "api/json/json_in.h"
#include "api/scenario/examples.h"
#include "core/run/run.h"
#include "core/scene/scene.h"

/// Resolve and check a scenario whose members were read. Faults are pointed at from the reading's
/// present place. False: faults were noted, or there is no memory.
bool scenario__complete(json_in *in, scene *s);

/// Check a complete scenario for a model; faults as above.
void scenario__check_model(json_in *in, const scene *s, run_model model);

/// The ways to say where an obstacle is: `path_m`, `from_m` with `to_m`, or `end_m` with `angle_deg` and
/// `length_m`. All become the path of scene_obstacle.
///
/// What the members of the two shorter forms are read into.
typedef struct obstacle_form {
    vec2 end;      ///< end_m, m
    double angle;  ///< angle_deg, from the x axis, degrees
    double length; ///< length_m, m, > 0
    vec2 from;     ///< from_m, m
    vec2 to;       ///< to_m, m
} obstacle_form;

/// The names of the members of each form; both lists end with NULL. The first name of a form stands
/// for it in texts.
extern const char *const *const obstacle_form__members[];

/// Read the form that the object has into the path of *obstacle, a scene_obstacle. It is a fault if
/// there is not exactly one form, or half of one.
void obstacle_form__read(json_in *in, const struct json_t *object, void *obstacle);

/// The ready scenarios by rising name, made by the build from the files of api/scenario/examples; the
/// last one has no name.
extern const example examples__list[];
