/// A scenario as plain data: belts, walls, obstacles and cargo, and how to solve it.
///
/// The document that users write is JSON; api/scenario/scenario.h turns it into this struct and back. Here it
/// has its defaults (scene_init) and its checks (scene_check); what the solvers need is
/// derived from it by surroundings.h (belts, plates, edges), placement.h (where the parts are) and density.h;
/// mix.h says which part is of which kind of cargo.
///
/// Units    SI: m, s, kg, m/s, Pa. Angles are radians in structs, degrees in documents.
/// Source   Goettlich et al. 2014, sections 2 to 4; defaults are the paper's or this project's choice.
/// Owns     the arrays of types.h; scene_fini() frees them.
/// Errors   scene_check() notes every fault with its JSON pointer in the document. Beyond the names
///          of the struct members with their unit: cargo/shape/outline_m (prism) and vertices_m
///          (hull), contacts/cargo_cargo/{length_m, damping_n_s_m, friction, tanh_linear_s_m,
///          tanh_spin_s}, micro/{damping_per_s, gravity_m_s2, spin_friction_radius_m},
///          initial/random/{count, region/x_m, region/y_m, seed}. Members of a kind of a mix stand
///          below cargo/<n> instead of cargo. The pointer of a fault of a path is that of the
///          whole obstacle if it has two points, else that of the point.

#pragma once

#include "core/base/faults.h"
#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/scene/types.h"

#include <stdbool.h>
#include <stddef.h>

/// Fill *s with the defaults that depend on nothing else: one kind of cargo, no belts, obstacles,
/// counters or parts yet. Numbers whose default is derived are NAN until scene_resolve(); what has no default is NAN
/// or, the type of the source of cargo, SCENE_INITIAL_COUNT. Arrays that the caller adds come from
/// memory.h.
void scene_init(scene *s);

/// Fill the struct with its defaults; derived ones are NAN, and ids "", until scene_resolve().
void scene_cargo_init(scene_cargo *k);
void scene_belt_init(scene_belt *b);
void scene_obstacle_init(scene_obstacle *o);
void scene_counter_init(scene_counter *c);
void scene_feed_init(scene_feed *f);
void scene_photo_eye_init(scene_photo_eye *e);
void scene_sink_init(scene_sink *sink);
void scene_action_init(scene_action *a);
void scene_lane_init(scene_lane *lane);
void scene_merge_init(scene_merge *merge);
void scene_output_window_init(scene_output_window *w);

/// Fill in the derived values: every NAN that has a default in terms of other members,
/// empty ids, the belt and the counter if there are none. BF_ENOMEM: *s is as before.
BF_MUST_CHECK bf_status scene_resolve(scene *s, bf_error *err);

/// The part of it for one obstacle, with sigma of the macroscopic model, 1/m2.
void scene_resolve_obstacle(scene_obstacle *o, double mollifier);

/// True if an obstacle turns, comes or goes at any time, by itself or because an action may command it.
bool scene_obstacle_moves(const scene_obstacle *o);

/// True if any obstacle does.
bool scene_has_moving_obstacles(const scene *s);

/// Check a resolved scenario, whatever the model: ranges, ids, geometry, sizes, cargo outside or
/// overlapping. The limits of one model are checked by run_check() (core/run/run.h). Adds every fault it can
/// find, of each kind of cargo fault a few. No memory is noted like a fault, with BF_ENOMEM. The places of
/// the parts are then in s->placement, so that they are computed once; after a change to cargo or its
/// source the scene must be checked again.
void scene_check(scene *s, bf_faults *faults);

/// Free what *s owns and zero it. NULL is fine.
void scene_fini(scene *s);

/// The macroscopic grid, by cells.h. Valid after scene_check().
bf_grid scene_grid(const scene *s);

/// The shorter edge of its cells, m.
double scene_cell_edge(const scene *s);

/// Density of close packing rho_max, parts/m2: macro.packing. By default it is the packing of the
/// shape (cylinder: 1/(2 sqrt(3) r^2); box: 1/(length width); prism and hull: pi/(2 sqrt(3)) divided by
/// the area of the footprint; a mix: 1/(sum of share_i/packing_i)) cut to four digits: the paper
/// calculates with 2004 parts/m2 for the 2004.69 of its cylinders, and its results depend on it.
double scene_packing_density(const scene *s);

/// True if what happens, or is told, depends on the kinds of the parts: the density then has one for each kind.
bool scene_tells_kinds(const scene *s);

/// True if something is commanded for parts of one kind: feeds then let the density in part by part.
bool scene_acts_by_kind(const scene *s);

/// Mean area of the footprint of a part, by the shares of the kinds, m2.
double scene_mean_footprint(const scene *s);

/// Largest |v_T| of all belts, m/s: the speed of the fastest belt at the factor 1.
double scene_belt_speed(const scene *s);

/// True if text may be the id of a belt, an obstacle or a counter: 1 to SCENE_ID_SIZE - 1 letters,
/// digits, '_', '.' and '-'.
bool scene_is_id(const char *text);

/// How many parts there are at the start.
size_t scene_parts(const scene *s);

/// Most samples of the curve and most snapshots that a run gives.
double scene_samples(const scene *s);
double scene_snapshots(const scene *s);

/// True if a feed lies on this side of the domain: then nothing leaves over it, in both models.
bool scene_is_fed(const scene *s, scene_side side);

/// True if the convolution sees the density mirrored at wall and fed edges instead of zero outside: when
/// no obstacle has one of the paper's own treatments.
bool scene_mirrors_walls(const scene *s);

/// The rule for the step "auto" of both models: the largest step that is at most `most` (is_below: less
/// than it), not longer than the run, and, where output.curve_every is longer, fits a whole number of
/// times into it; s.
double scene_fit_step(const scene *s, double most, bool is_below);

/// Time step of the macroscopic model, s: macro.step, or for "auto", by scene_fit_step(), the largest that is
/// stable and positive.
double scene_macro_step(const scene *s);

/// Largest dt that satisfies CFL, dt n (max|v_stat| + eps) <= dx, and the largest below which rho stays >= 0, half of
/// it; s. n is the number of axes whose fluxes act at the same time: 1 for roe, 2 for muscl (core/macro/README.md). With the
/// largest factors that the speed schedules of the belts allow. With the congested closure
/// the largest is 2 n dt max|v_stat| = dx, half of it where several belts may run in either direction, or two run apart and there
/// are obstacles (roe), and rho stays >= 0 up to it: the second is INFINITY.
double scene_step_stable(const scene *s);
double scene_step_positive(const scene *s);

/// The largest step in which no point of an obstacle that turns moves by more than a cell, s; INFINITY: none turns.
double scene_step_turning(const scene *s);

/// The least rectangle that holds n >= 1 points.
scene_rect scene_rect_around(const vec2 *points, size_t n);
