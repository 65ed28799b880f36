/// The scenario document (JSON) to and from core's struct.
///
/// Reading is strict: unknown members, duplicate keys, wrong types, numbers out of range, NaN and
/// too deep nesting are faults with the JSON pointer of their place. All faults of a document are
/// found in one pass where that is possible. Angles are degrees in the document.

#pragma once

#include "api/json/json_in.h"
#include "core/base/buffer.h"
#include "core/base/faults.h"
#include "core/run/run.h"
#include "core/scene/scene.h"

#include <stddef.h>

enum {
    SCENARIO_BYTES_MAX = 64 * 1024 * 1024 ///< bytes of a document on the command line
};

/// Read a document, fill in every default (scene_resolve) and check it (scene_check). Faults are
/// noted in *faults. BF_OK: *ret_scene is the caller's, scene_fini(). Else the status of the first
/// fault, or BF_ENOMEM, and *ret_scene is untouched. Text that is not JSON is one fault with
/// pointer "" and line and column in its text.
BF_MUST_CHECK bf_status scenario_read(const char *json, size_t n, scene *ret_scene,
                                      bf_faults *faults, bf_error *err);

/// Read a tree of json_in_parse() in the same way, at the reading's present place, and check it for a model. False: faults
/// were noted, or there is no memory, and *ret_scene is untouched.
bool scenario_read_tree(json_in *in, const struct json_t *tree, run_model model, scene *ret_scene);

/// Read a resolved document that was checked before it was stored: types and units alone are looked at.
/// BF_OK: *ret_scene is resolved and the caller's, scene_fini(). BF_ECORRUPT: the document is damaged;
/// BF_ENOMEM.
BF_MUST_CHECK bf_status scenario_read_resolved(const char *json, size_t n, scene *ret_scene,
                                               bf_error *err);

/// The same from a tree of json_in_parse(); NULL: damaged.
BF_MUST_CHECK bf_status scenario_read_resolved_tree(const struct json_t *tree, scene *ret_scene,
                                                    bf_error *err);

/// Append the resolved document, every default filled in, one line, members in a fixed order.
/// Reading it gives the same scene again, bit by bit.
BF_MUST_CHECK bf_status scenario_write(const scene *s, bf_buffer *out, bf_error *err);

/// Append the columns of the scenario's curve (core/observe/columns.h) as "id,...,left_domain,...".
BF_MUST_CHECK bf_status scenario_columns(const scene *s, bf_buffer *out, bf_error *err);
