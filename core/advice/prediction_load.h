/// The load of a run: how much cargo there will be, and how much of it is saturated, over the time of the run.
///
///     A run of the same scenario by the macroscopic model on coarse cells takes some 10 to 100 milliseconds. Its closure is
///     `congested`, or the scenario's own if it is predicted for that model. Its density rho_k(t) in cells of the area a,
///     normalised as in core/scene/README.md, is integrated:
///
///     parts = int sum_k rho_k a rho_max dt,   saturated = the same over cells with rho_k >= 0.7,
///     pairs = int sum_k rho_k^2 a rho_max dt,   in proportion to the neighbours of all parts,
///     area = int sum_k a dt over cells with rho_k >= 0.01,   saturated_area = the same over those with rho_k >= 0.7,
///     relaxed, swept, varied, dispersed, fields, tracers = what that run had to do (run_work_of()); numbers of cells brought to
///     the cells and steps of the scenario
///
/// A run that would be too much work even so is followed for a part of its duration; the mean of the last third of that
/// stands for the rest.
///
/// Units    SI.

#pragma once

#include "core/run/run.h"
#include "core/scene/scene.h"

/// The load of a run.
typedef struct prediction_load {
    double time;           ///< simulated until the end, s
    double parts;          ///< in the domain, parts s
    double saturated;      ///< of them in a jam, parts s
    double pairs;          ///< each with the density around it, parts s
    double area;           ///< that cargo covers, m2 s
    double saturated_area; ///< of that a jam's, m2 s
    double relaxed;   ///< cells of the scenario whose pressure is relaxed, each time that one is
    double swept;     ///< cells of the scenario that sweeps go over, each time that they do
    double varied;    ///< of them, see macro_swept
    double dispersed; ///< same
    double fields;    ///< of the scenario that plates and belts have made anew
    double tracers;   ///< of cargo's time, tracers s
} prediction_load;

/// Predict the load of a scenario that was checked for the model. BF_ENOMEM, and errors of run_create() and
/// run_execute().
BF_MUST_CHECK bf_status prediction_load_of(const scene *s, run_model model,
                                           prediction_load *ret_load, bf_error *err);
