/// How the parts of feeds enter the macroscopic model: as a density in the cells of their lines.
///
/// With Lambda of arrivals.h, at a time t a feed has offered Lambda(t) parts, of which S were admitted or discarded.
/// The rest, Lambda(t) - S, is spread over the cells that its line, as wide as a part at least (feed_line_widened()), crosses in proportion to the line's length w_k in
/// each. Cell k takes at most its room; what some cannot take goes to the others in proportion ("water filling"), so
/// that it gets min(room_k, w_k h) with the h at which everything, or all room, is used:
///
///     line inside      room = rho_p - rho                      rho_p: density of packed cargo
///     line on a side   room = min(rho_p - rho + rho_p - rho', rho_p v_n dt/dx c)
///
/// On a side the cells are those beside it, and rho' is the density of the cell behind, which takes what the outer one
/// cannot: where steps have several stages, a cell that is packed when a step begins hands on less than rho_p v_n in it.
/// The bound is what the belt carries into the domain in a step: v_n is its speed across the side, and c the part of the
/// cell's side that the line covers.
///
/// What finds no room waits. Parts are served in the order of their arrival: those that enter next arrived when Lambda
/// was S, so that waits follow from the curves of what was offered, admitted and discarded. Of a feed that discards, what was offered until t - max_wait and is left is dropped. A feed that is held admits
/// nothing, while parts go on to arrive. Within a call each feed has its turn once, and the one that is first changes
/// from call to call, so that none starves where two share cells.
///
/// Of which kind: where kinds are told apart (scene_tells_kinds()) what enters while S grows from k - 1 to k is of the kind of
/// part k, so that kinds come in the order in which they come as parts.
///
/// Part by part: where something is commanded for a kind (scene_acts_by_kind()), in place of Lambda(t) a feed has offered the parts that
/// are due at t. Each enters as fast as there is room, as a strip about as long as the part. By Lambda it would be as long as the way
/// to the next part, and of what an eye commands for a part too much of it would be past, and too much of the next one there.
///
/// rho_p is jam_density with the congested closure. With the dispersive one it is 1 - 1e-12: from a density of 1 on cargo
/// disperses, and a feed alone must not start that.
///
/// Bits     the same for the same calls, also after save and load.
/// Units    SI; densities normalised by rho_max = scene_packing_density().

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/feed/balance.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/// The model that the density enters, as a table of functions that get its context.
typedef struct feed_field {
    void *context; ///< of the functions
    /// The density of a cell, layout of grid.h.
    double (*density)(const void *context, size_t cell);
    /// The factor on the velocity of a belt in the step that begins now, below 0: it runs backwards and takes nothing from a
    /// feed on a side; n_belts: off every belt.
    double (*factor)(const void *context, size_t belt);
    /// Add a density > 0 to a cell; it enters at a place on the feed's line, m, and has these fractions of the kinds of cargo; NULL: they are
    /// not told apart.
    void (*add)(void *context, size_t cell, double density, vec2 at, const double *fractions);
} feed_field;

/// The entry of all feeds of a scene; opaque. It borrows the scene, which must outlive it.
typedef struct feed_density feed_density;

/// Begin before the first part, for steps of dt, s. The caller owns *ret_density: feed_density_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status feed_density_create(const scene *s, double dt, feed_density **ret_density,
                                            bf_error *err);

/// Free it. NULL is fine. Always returns NULL.
feed_density *feed_density_destroy(feed_density *d);

/// Let in what is due at t, s, not before that of the last call: once before each step.
void feed_density_advance(feed_density *d, double t, const feed_field *field);

/// Hold a feed, or release it.
void feed_density_hold(feed_density *d, size_t feed, bool is_held);

/// The balance of a feed at the last call of feed_density_advance().
feed_balance feed_density_balance(const feed_density *d, size_t feed);

/// Parts that entered, of all feeds.
double feed_density_admitted(const feed_density *d);

/// Parts that all feeds offer until a time, s, by Lambda.
double feed_density_offered(const feed_density *d, double t);

/// True if less than a millionth of a part waits at each feed and as little will arrive.
bool feed_density_is_exhausted(const feed_density *d);

/// Append the state to a checkpoint, and take it from one of the same scene. False: it is damaged, and *d undefined.
void feed_density_save(const feed_density *d, checkpoint_writer *w);
BF_MUST_CHECK bool feed_density_load(feed_density *d, checkpoint_reader *r);
