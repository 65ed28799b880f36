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

/// The ready scenarios by rising name, made by the build from the files of api/scenario/examples; the
/// last one has no name.
extern const example examples__list[];
