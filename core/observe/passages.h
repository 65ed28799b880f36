/// Parts that pass a photo eye: from what breaks its beam at the ticks of a run to when each began and ended to.
///
/// Between two ticks a part keeps its speed: one that breaks the beam now, and did not at the last tick, began where its
/// front crossed it; one that broke it at the last tick, and does not now, ended where its back did. Both are given to
/// core/observe as travel, the distance that the belt under the beam has moved since t = 0: gaps of parts are then
/// those on the belt, whatever its speed and stops. A part that passes between two ticks is not seen: a tick is
/// shorter than that (run_plan.n_tick).
///
/// Units    SI.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/observe/figures.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// A part that breaks a beam.
typedef struct passages_part {
    uint64_t id;  ///< unique among the parts of a run
    double since; ///< for how long its front has been behind the beam at its present speed, s, >= 0
    double left;  ///< until its back is there, s, >= 0; INFINITY: it stands
} passages_part;

/// What an eye sees at a tick.
typedef struct passages_view {
    double belt_speed;          ///< of the belt under the middle of the beam, m/s
    size_t n;                   ///< parts that break the beam
    const passages_part *parts; ///< with rising ids
} passages_view;

/// The passages of an eye. Zero-initialise; passages_fini().
typedef struct passages {
    double t;             ///< of the last tick, s
    double travel;        ///< of the belt until then, m
    double belt_speed;    ///< then, m/s
    uint64_t n_left;      ///< parts that left the beam until then
    size_t n;             ///< parts that broke the beam then
    passages_part *parts; ///< with rising ids
    size_t n_max;         ///< parts that there is room for
} passages;

/// Free what *p owns and zero it.
void passages_fini(passages *p);

/// Tell what an eye sees at a tick, t rising; the figures get what began and ended since the last one, in the order of
/// travel. *ret_free is for how long the beam was free between two parts since then, s, the longest such time; 0 of a belt that went back.
/// BF_ENOMEM.
BF_MUST_CHECK bf_status passages_see(passages *p, double t, const passages_view *view, size_t eye,
                                     figures *f, double *ret_free, bf_error *err);

/// Append the state to a checkpoint, and take it from one. BF_ECORRUPT, BF_ENOMEM: *p is then only to be freed.
void passages_save(const passages *p, checkpoint_writer *w);
BF_MUST_CHECK bf_status passages_load(passages *p, checkpoint_reader *r, bf_error *err);
