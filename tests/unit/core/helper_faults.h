/// What scene_check() says of scenes.

#pragma once

#include "core/base/faults.h"
#include "core/scene/scene.h"

/// Something that makes a scene faulty, the place that is reported, and words of the report.
typedef struct helper_faults_case {
    void (*spoil)(scene *s);
    const char *pointer;
    const char *words;
} helper_faults_case;

/// Resolve, check and free a scene. The faults are valid until the next call.
const bf_faults *helper_faults_of(scene *s);

/// The same for a scene that has none.
void helper_faults_none(scene *s);

/// The same for a scene with one, at a place and with words.
void helper_faults_one(scene *s, const char *pointer, const char *words);

/// The same for n scenes that make() makes and the cases spoil.
void helper_faults_each(void (*make)(scene *s), const helper_faults_case *cases, size_t n);
