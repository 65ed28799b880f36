/// Inside core/run: a model as a table of functions.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/faults.h"
#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/feed/balance.h"
#include "core/micro/micro.h"
#include "core/observe/figures.h"
#include "core/observe/frame.h"
#include "core/observe/passages.h"
#include "core/run/photo_eyes.h"
#include "core/scene/placement.h"
#include "core/scene/scene.h"
#include "core/scene/surroundings.h"
#include "core/world/world.h"

#include <stdbool.h>
#include <stdint.h>

/// Tolerance for rounding of a step at the bound of stability.
#define RUN__STABLE_SLACK 1e-12

/// The sizes of a run.
typedef struct run_plan {
    double dt;          ///< s
    uint64_t n_steps;   ///< from t = 0 to the end
    bf_grid grid;       ///< of the snapshots
    uint64_t n_parts;   ///< parts at the start; more may enter later
    uint32_t n_values;  ///< values of a part in FRAME_PARTS; 0: the model has no parts
    uint64_t n_advance; ///< most steps between two calls of run_sink.requested, >= 1
    uint64_t n_tick;    ///< steps of a tick, >= 1; depends on the scenario alone
} run_plan;

/// What is in the domain at one time.
typedef struct run_load {
    double parts;       ///< parts in the domain
    double entered;     ///< parts that entered since t = 0
    double fallen;      ///< parts that fell off the belts since t = 0
    double peak;        ///< largest density; 0 where the model knows it at snapshots only
    double smooth_peak; ///< same by a mollifier that is no narrower than a part
    uint64_t n_rows;    ///< rows of FRAME_PARTS, see frame_parts
    double relaxed, n_fields, n_tracers; ///< of run_work; 0 where the model has none
    double swept, varied, dispersed;     ///< same
} run_load;

/// A part that left the domain, or fell off the belts.
typedef struct run_departure {
    uint64_t id;     ///< unique, rising in the order of entering
    uint32_t kind;   ///< index into scene.cargo
    uint32_t feed;   ///< index into scene.feeds; n_feeds: it was there at the start
    double entered;  ///< when it entered, s
    double left;     ///< when it left, s
    vec2 at;         ///< where, m
    bool has_fallen; ///< off the belts
} run_departure;

/// Departures, borrowed from the model until the next tick.
typedef struct run_departures {
    size_t n;                   ///< how many
    const run_departure *items; ///< in the order of their ids
} run_departures;

/// What a photo eye sees, borrowed from the model until the next question.
typedef struct run_view {
    bool is_broken;         ///< the beam
    passages_view passages; ///< of the parts that break it; models without parts leave it zero
    uint64_t n_left;        ///< parts that left it since t = 0; models with parts leave it zero
    size_t n_parts;         ///< that break it; of eyes that tell kinds alone
    const photo_eye_part *parts; ///< which
} run_view;

/// A model. solver is what create() made.
typedef struct run_backend {
    /// Add the faults for which a checked scenario cannot be solved.
    void (*check_scenario)(const scene *s, bf_faults *faults);
    /// Build the solver at t = 0, which borrows the world. The caller owns *ret_solver: destroy().
    bf_status (*create)(const scene *s, bf_world *w, int n_threads, void **ret_solver,
                        run_plan *ret_plan, bf_error *err);
    void (*destroy)(void *solver);
    /// Make n steps of dt. How steps are cut into calls must not change the result. BF_ENUMERIC with
    /// step, time and place where that is detected at once.
    bf_status (*advance)(void *solver, uint64_t n, bf_error *err);
    /// BF_ENUMERIC with step, time and place if something is not finite. NULL: advance() reports that.
    bf_status (*check)(const void *solver, bf_error *err);
    /// Fill one value per counter, parts.
    void (*count)(const void *solver, double *ret_parts);
    run_load (*measure)(const void *solver);
    /// Fill what left each counter, then each outlet, since t = 0, parts: of a sample with what count() says and what has
    /// left the domain but was not taken by a sink, parts. Only for scenes with feeds.
    void (*count_flows)(void *solver, const double *contents, double left, double *ret_flows);
    /// Fill what each sink took since t = 0, parts. Only for scenes with sinks.
    void (*taken)(const void *solver, double *ret_parts);
    /// Parts that fell in a counter since t = 0. Only for scenes without feeds whose may_drop is set.
    double (*fallen_in)(const void *solver, size_t counter);
    /// Fill the density grid, n2 rows of n1, and measure it.
    bf_status (*snapshot)(void *solver, float *ret_rho, run_load *ret_load, bf_error *err);
    /// Fill the rows of FRAME_PARTS, ret_load->n_rows of the snapshot just taken. NULL: the model has no parts.
    void (*parts)(void *solver, double *ret_rows);
    /// Fill the figures of the end that only models with parts have. NULL: they are 0.
    void (*fill_end)(const void *solver, frame_end *end);
    /// Write the model's state into the run's checkpoint, at its end the solver's own. BF_ENOMEM.
    bf_status (*save)(const void *solver, checkpoint_writer *w, bf_error *err);
    /// Take it, before the first step. BF_ECORRUPT, BF_ENOMEM: the solver can only be destroyed.
    bf_status (*load)(void *solver, checkpoint_reader *r, bf_error *err);
    uint64_t (*digest)(const void *solver);

    /// Tell the figures of all cargo, before a sample. NULL: its speed is not known.
    void (*tell_cargo)(const void *solver, figures *to);
    /// Tell the figures how long all cargo has been there. NULL: tell_cargo() says it.
    void (*tell_ages)(const void *solver, figures *to);

    // At a tick, in this order (control.h). The time is that of the steps made.
    /// Remove the cargo that the sinks accept at this tick. Only for scenes with sinks. BF_ENOMEM.
    bf_status (*remove_at_sinks)(void *solver, bf_error *err);
    /// Take the parts that left the domain or fell since the last tick. NULL: the model has no parts. BF_ENOMEM.
    bf_status (*depart)(void *solver, run_departures *ret_departures, bf_error *err);
    /// Tell the figures what left in the last step, in parts that need not be whole. NULL: depart() says it.
    void (*tell_exits)(const void *solver, figures *to);
    /// What a photo eye sees. BF_ENOMEM.
    bf_status (*look)(void *solver, size_t eye, run_view *ret_view, bf_error *err);
    /// Hold a feed, or let it go on.
    void (*hold)(void *solver, size_t feed, bool is_held);
    /// Let the parts of the feeds enter that are due and find a place, and tell their waits. BF_ENOMEM.
    bf_status (*admit)(void *solver, figures *to, bf_error *err);

    /// What became of the parts of a feed until the last tick.
    feed_balance (*balance)(const void *solver, size_t feed);
    /// True if no feed will deliver any more part, and none waits.
    bool (*is_exhausted)(const void *solver);
} run_backend;

/// The macroscopic model.
extern const run_backend run__macro;

/// The microscopic model.
extern const run_backend run__micro;
