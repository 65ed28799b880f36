/// How long a run will take, before it is solved.
///
///     time = factor sum_i cost_i exp(correction_i) amount_i
///
/// The amounts follow from the scenario and from a run of it on a coarse grid (prediction_load.h), which takes
/// some 10 to 100 milliseconds. The costs are constants of the solvers, fitted on one machine. The factor is the time that a
/// small scenario takes here, divided by what the costs say of it; there is one for each kind of solver, because
/// machines differ in instruction sets and memory. The corrections are 0 at first and follow from what runs have taken here
/// (prediction_learn.h).
///
/// Meant is the CPU time on one thread, with all results, until the run has ended; s.

#pragma once

#include "core/base/status.h"
#include "core/run/run.h"
#include "core/scene/scene.h"

/// Solvers whose steps cost differently.
typedef enum prediction_kind {
    PREDICTION_ROE,       ///< dispersive closure, first order
    PREDICTION_MUSCL,     ///< dispersive closure, second order
    PREDICTION_CONGESTED, ///< congested closure
    PREDICTION_PLANAR_VERLET,
    PREDICTION_PLANAR_IMPLICIT,
    PREDICTION_SPATIAL_VERLET,
    PREDICTION_SPATIAL_IMPLICIT,
    PREDICTION_KIND_COUNT
} prediction_kind;

/// What costs time.
typedef enum prediction_term {
    PREDICTION_RUN,            ///< 1
    PREDICTION_CELLS,          ///< of the grid
    PREDICTION_SNAPSHOT_CELLS, ///< cells of all snapshots
    PREDICTION_STEPS,          ///< of time
    PREDICTION_ROW_STEPS,      ///< rows of the grid times steps
    PREDICTION_CELL_STEPS,     ///< cells times steps
    PREDICTION_COVERED_STEPS,  ///< congested closure: of them, cells that cargo covers
    PREDICTION_SWEPT, ///< dispersive closure: cells that the sweeps go over, each time that they do
    PREDICTION_VARIED, ///< same: of them, those whose fluxes are not those of one velocity
    PREDICTION_DISPERSED, ///< same: of them, those whose I is made, times the cells that the mollifier reaches over
    PREDICTION_RECORDED, ///< same, with feeds, whose velocities are recorded: cells times steps; those whose I is made eight
    ///< times more
    PREDICTION_RELAXED, ///< congested closure: cells whose pressure is relaxed, each time that one is
    PREDICTION_COUPLED,      ///< same, where belts do not all run along x1
    PREDICTION_FIELD_CELLS,  ///< cells of all fields that plates and belts have made anew
    PREDICTION_SAMPLE_CELLS, ///< with feeds, cells that cargo covers of all samples
    PREDICTION_TRACER_STEPS, ///< tracers of cargo's time, times steps
    PREDICTION_KIND_STEPS, ///< kinds that are told apart, times covered steps; cells of a jam twice
    PREDICTION_SPREAD_CELLS, ///< cells over which the mollifier spreads the parts of all snapshots
    PREDICTION_SAMPLE_PARTS, ///< parts of all samples
    PREDICTION_PART_STEPS,   ///< parts in the domain times steps
    PREDICTION_ROUND_STEPS,  ///< of them, cylinders in space, which roll
    PREDICTION_PAIR_STEPS, ///< parts times steps, each times the density around it and, implicit, iterations
    PREDICTION_LISTED_PAIRS, ///< parts, each times the density around it, each time that the fastest belt has moved by a
                             ///< part's radius: so often the lists of neighbours are made
    PREDICTION_TERM_COUNT
} prediction_term;

/// The work of a run.
typedef struct prediction_work {
    prediction_kind kind;                  ///< of solver
    double amounts[PREDICTION_TERM_COUNT]; ///< see prediction_term
} prediction_work;

/// How fast a machine is: time here, divided by the time on the machine of the costs, for each kind.
typedef struct prediction_speed {
    double factors[PREDICTION_KIND_COUNT];                            ///< > 0
    double corrections[PREDICTION_KIND_COUNT][PREDICTION_TERM_COUNT]; ///< of the costs; 0: none
} prediction_speed;

/// The words of the kinds, "roe" to "spatial_implicit"; NULL-terminated.
extern const char *const prediction_kind_words[];

/// The work of a scenario that was checked for the model. BF_ENOMEM.
BF_MUST_CHECK bf_status prediction_work_of(const scene *s, run_model model,
                                           prediction_work *ret_work, bf_error *err);

/// The time of a run, s; and what each amount has of it, s, into ret_seconds[PREDICTION_TERM_COUNT].
double prediction_seconds(const prediction_work *work, const prediction_speed *speed);
void prediction_seconds_of_terms(const prediction_work *work, const prediction_speed *speed,
                                 double *ret_seconds);

/// Solve a small scenario of a kind until least_s of CPU time have passed by the clock, and say how fast this machine is:
/// the factor of the fastest of the runs. BF_ENOMEM.
BF_MUST_CHECK bf_status prediction_measure(prediction_kind kind, double (*cpu_s)(void),
                                           double least_s, double *ret_factor, bf_error *err);
