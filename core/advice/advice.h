/// What is said about the results of a scenario: before it is solved, and of a run.

#pragma once

#include "core/advice/review.h"
#include "core/advice/validity.h"
#include "core/base/status.h"
#include "core/run/run.h"
#include "core/scene/scene.h"

/// What is to be said before a scenario is solved. It is large: on the heap.
typedef struct advice {
    run_model model;          ///< with which it would be solved
    validity validity;        ///< of the model
    review_warnings warnings; ///< reasons to doubt the results
} advice;

/// Advise on a resolved and checked scenario for a model. Warnings are those of the files review_*.h, of the macroscopic model a
/// step at which densities may become negative, see scene_step_positive(), and what lies outside its validity. BF_ENOMEM.
BF_MUST_CHECK bf_status advice_of(const scene *s, run_model model, advice *ret_advice,
                                  bf_error *err);

/// Above this density (1 is close packing) the macroscopic model differs noticeably from the microscopic
/// one.
extern const double advice_density_trusted;

/// Above this overlap, relative to the radius, parts are too soft: the outflow depends on their stiffness.
extern const double advice_overlap_trusted;

/// Warnings about the results of a run beyond those of advice_of(); flags.
typedef enum advice_doubt {
    ADVICE_DOUBT_DENSITY = 1, ///< the density rose above advice_density_trusted
    ADVICE_DOUBT_OVERLAP = 2, ///< overlaps rose above advice_overlap_trusted
} advice_doubt;

/// The warnings about a run with a model, as advice_doubt flags.
unsigned advice_doubts(run_model model, const frame_end *end);
