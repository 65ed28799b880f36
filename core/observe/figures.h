/// The accumulators of a run's key figures: from samples, departures and photo eyes to the values of figure_table.
///
/// A run calls, for each sample, figures_add_cargo() for all cargo and then figures_sample(); between samples the
/// functions of events in the order of their times. Means over time take what is sampled as linear between samples.
/// The values are those until the last sample; they depend on the scenario and the order of the calls alone.
///
/// Memory   bounded: some 70 kB for each feed and photo eye, 8 kB for each counter, outlet and sink and 280 kB for the run,
///          whatever its length.
/// Units    SI.
/// Threads  figures belong to one thread at a time.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/feed/balance.h"
#include "core/observe/figure.h"
#include "core/scene/scene.h"
#include "core/world/belt_speeds.h"

#include <stdbool.h>
#include <stddef.h>

/// The accumulators; opaque, on the heap.
typedef struct figures figures;

/// What is known at a sample.
typedef struct figures_now {
    double t;       ///< s
    double inside;  ///< parts in the domain
    double entered; ///< parts that entered since t = 0, with those of the start
    double exited;  ///< parts that left since t = 0
    double fallen;  ///< parts that fell off the belts since t = 0, which do not count as left
    double fallen_in_first; ///< those of them that fell in the first counter; without feeds
    const double *counters; ///< parts in each counter
    const double
        *flows; ///< with feeds: parts that left each counter, then each outlet, since t = 0
    const double *taken;       ///< parts that each sink took since t = 0
    const feed_balance *feeds; ///< of each feed
} figures_now;

/// Cargo at a place: a part, or what is in a cell.
typedef struct figures_cargo {
    vec2 at;           ///< m
    double speed;      ///< m/s
    double belt_speed; ///< of the belt under it now, m/s; 0: it stands, or there is none
    double parts;      ///< how many
    double age;        ///< since it entered, or the start, s; NAN: figures_add_age() tells it
} figures_cargo;

/// Begin the figures of a scene, which must outlive them, at t = 0. has_parts: the model is that of parts. The caller
/// owns *ret_figures: figures_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status figures_create(const scene *s, bool has_parts, figures **ret_figures,
                                       bf_error *err);

/// Free figures. NULL is fine. Always returns NULL.
figures *figures_destroy(figures *f);

/// Cargo that is in the domain at the sample that figures_sample() takes next. Models whose cargo has no speed leave
/// it out. Of the kinds it has these fractions; NULL: they are not told apart.
void figures_add_cargo(figures *f, const figures_cargo *cargo, const double *fractions);

/// Take a sample; times rise. The first one is at t = 0.
void figures_sample(figures *f, const figures_now *now);

/// The largest density of a sample or snapshot, taken after the sample of the same time.
void figures_peak(figures *f, double density);

/// Parts, which need not be whole, of this age, s, are in the domain: those of models that do not call figures_add_cargo(),
/// of scenes with feeds, told before the sample that ends the warm-up and before the values are filled. The first
/// call of a time comes after figures_forget_ages().
void figures_forget_ages(figures *f);
void figures_add_age(figures *f, double age, double parts);

/// True if a sample at t is the one that ends the warm-up.
bool figures_ends_warmup(const figures *f, double t);

/// Parts, which need not be whole, left the domain after a time in it, s. Scenes without feeds leave it out: there
/// residence follows from the samples.
void figures_exit(figures *f, double residence, double parts);

/// A part of a feed entered after a wait, s. Models without parts leave it out: waits follow from the samples.
void figures_wait(figures *f, size_t feed, double wait);

/// A part begins, or ends, to interrupt the beam of a photo eye. travel is how far the belt under the beam has
/// moved since t = 0, m.
void figures_eye_begin(figures *f, size_t eye, double travel);
void figures_eye_end(figures *f, size_t eye, double travel);

/// The state of a photo eye becomes blocked, or clear, at t, s.
void figures_eye_state(figures *f, size_t eye, double t, bool is_blocked);

/// How the belts moved from the last call on until t, s: before a sample at t, and before a command at t.
void figures_belts(figures *f, const belt_speeds *speeds, double t);

/// A plate that was told to move is stopped by cargo, or moves again, at t, s.
void figures_stall(figures *f, double t, bool is_stopped);

/// Time of the last sample, s.
double figures_time(const figures *f);

/// True once the throughput is steady: see steady.h.
bool figures_is_steady(const figures *f);

/// Fill the figure_values() values of the table.
void figures_fill(const figures *f, double *ret_values);

/// Append the state to a checkpoint, and take it from one of the same scene and model. False: it is damaged; *f is
/// then only to be freed.
void figures_save(const figures *f, checkpoint_writer *w);
BF_MUST_CHECK bool figures_load(figures *f, checkpoint_reader *r);
