/// For the files of api that read a scenario as part of something else.

#pragma once

#include "api/json/json_in.h"
#include "core/run/run.h"
#include "core/scene/scene.h"

/// Resolve and check a scenario whose members were read. Faults are pointed at from the reading's
/// present place. False: faults were noted, or there is no memory.
bool scenario__complete(json_in *in, scene *s);

/// Check a complete scenario for a model; faults as above.
void scenario__check_model(json_in *in, const scene *s, run_model model);
