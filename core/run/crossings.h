/// Photo eyes of the macroscopic model that see parts: from the density that crosses a beam to parts that break it.
///
/// A density is spread, and parts are not: a beam is broken while at least one part is within half its length of it. So
/// what the belts carry to the beam is counted in parts, and each one breaks the beam while it travels by the mean
/// length of its chords through the places that do:
///
///     rate     lambda = sigma rho v P      rho, v: means over the beam's line, shifted upstream by half a part
///     chord    h = A/P                     A: area within half a part of the beam, P: its width across the belt
///     N        = sigma rho A               parts that break the beam at a time, in the mean
///
/// The next part comes when lambda dt has summed up to a gap, of mean 1. Gaps follow the law of the feeds: 1 if all are
/// regular or let the density in part by part, Erlang variates if all are, else exponential ones. Parts do not lie on each other, so that of each random
/// gap c = (N/m)^m <= 1 is not random, with m parts of the length l side by side. Then the beam is free for 1 - N of the
/// time where parts pass one by one, for exp(-N) on a wide belt that is loosely covered, and never where cargo is packed.
/// A beam that was free between two steps counts as free at the second one. Where the belt stands, what breaks the beam
/// goes on breaking it. Where it runs backwards, parts come from the other side; the last one goes back as far as it has come.
///
/// Kinds    of a part that comes is drawn by the fractions of the kinds in what the belts carry to the beam then: where a fraction is 1 it
///          is that kind, and in the mean as many parts of each kind come as the density has. A part ends to break the
///          beam where the next one comes, too.
///
/// Choice   the length l of a part is its extent along the belt at the heading of the first feed; of random headings and
///          of cargo that is there at the start, the mean over all headings; of kinds, the mean by what feeds bring.
/// Bits     draws are a function of the eye's id, the scenario's substream and the number of the part (core/base/draws.h).
/// Units    SI.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/run/photo_eyes.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/// The parts that cross the beams of a scene's photo eyes; opaque. It borrows the scene.
typedef struct crossings crossings;

/// The density that crosses, as functions that get its context.
typedef struct crossings_field {
    const void *context;                                 ///< of the functions
    double (*density)(const void *context, size_t cell); ///< of a cell of scene_grid()
    double (*factor)(const void *context, size_t belt);  ///< on the velocity of a belt
    /// The fractions of the scene's kinds of cargo in a cell. NULL: they are not told apart.
    const double *(*fractions)(const void *context, size_t cell);
} crossings_field;

/// Begin at t = 0 with free beams, for steps of the macroscopic model. The caller owns *ret_crossings: crossings_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status crossings_create(const scene *s, crossings **ret_crossings, bf_error *err);

/// Free it. NULL is fine. Always returns NULL.
crossings *crossings_destroy(crossings *c);

/// Let parts cross the beam of an eye for a step. True: one breaks it at the end.
bool crossings_advance(crossings *c, size_t eye, const crossings_field *field);

/// The parts that came to the beam of an eye in the last step, or else the one that still breaks it, *ret_n of them; only where kinds are told apart. Borrowed until the next
/// call of crossings_advance().
const photo_eye_part *crossings_parts(const crossings *c, size_t eye, size_t *ret_n);

/// Parts that have left the beam of an eye since t = 0.
uint64_t crossings_left(const crossings *c, size_t eye);

/// Append the state to a checkpoint, and take it from one of the same scene. False: it is damaged, and *c undefined.
void crossings_save(const crossings *c, checkpoint_writer *w);
BF_MUST_CHECK bool crossings_load(crossings *c, checkpoint_reader *r);
