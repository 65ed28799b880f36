/// The document of a study: a base, which of its numbers are parameters, what is best, and how points are chosen.
///
///     {"base": {"scenario": {...}, "model": "macro"},
///      "parameters": [{"pointer": "/obstacles/0/angle_deg", "range": [30, 90]}],
///      "objectives": [{"figure": "throughput_per_h", "goal": "maximize"}],
///      "method": {"type": "direct"}, "limits": {"trials": 60}}
///
/// Pointers (RFC 6901) lead into the scenario as it is given, before its defaults are filled in. A trial is the base with
/// the numbers of its point and the substream of its replication. A number that makes the scenario invalid makes the
/// trial infeasible, not the study.

#pragma once

#include "api/json/members.h"
#include "api/measurements.h"
#include "core/base/faults.h"
#include "core/observe/figure.h"
#include "core/run/run.h"
#include "core/scene/scene.h"
#include "core/study/study.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    STUDY_DOCUMENT_NAME = 101,      ///< bytes of a name with its terminator
    STUDY_DOCUMENT_VALUES = 10000,  ///< values of a parameter
    STUDY_DOCUMENT_CURVES = 16,     ///< measured curves
    STUDY_DOCUMENT_SAMPLES = 10000, ///< samples of one
    STUDY_DOCUMENT_WORKERS = 256,   ///< workers
};

/// How a parameter is given.
typedef enum study_document_form {
    STUDY_BY_RANGE, ///< from one number to another
    STUDY_BY_VALUES ///< a list
} study_document_form;

/// A parameter.
typedef struct study_document_parameter {
    char pointer[BF_POINTER_SIZE]; ///< into the scenario
    study_document_form form;      ///< which of the others count
    double range[2];               ///< least and largest number
    bool is_log;                   ///< equal ratios are equally far
    uint32_t steps;                ///< of a grid: numbers from the least to the largest
    const double *values;          ///< STUDY_BY_VALUES
    size_t n_values;               ///< how many
    struct json_t *number;         ///< where it stands in the base; borrowed
} study_document_parameter;

/// An objective.
typedef struct study_document_objective {
    figure_id figure; ///< which key figure
    /// Of which feed, counter or photo eye; "": of the run, or the only one
    char of[SCENE_ID_SIZE];
    bool is_maximized; ///< more is better
    double demand;     ///< of the first: at least so much; INFINITY: what is offered, until it
                       ///< is known; NAN: none
    bool is_offered;   ///< the demand is what feeds offer
    size_t item;       ///< which one `of` is, of its scope
} study_document_objective;

/// A measured curve.
typedef struct study_document_curve {
    char counter[SCENE_ID_SIZE]; ///< whose column it is compared with
    unsigned form;               ///< 0: its samples are given
    const double *t;             ///< rising times, s
    size_t n_t;                  ///< how many
    const double *count;         ///< parts in the counter, one for each
    size_t n_count;              ///< how many
    size_t column;               ///< index of the column
} study_document_curve;

/// How points are chosen.
typedef struct study_document_method {
    study_method type;    ///< see core/study/study.h
    study_method sweep;   ///< of STUDY_SCREEN
    uint32_t points;      ///< of sweeps but grid and list; starts of STUDY_CALIBRATE
    uint32_t confirm;     ///< STUDY_SCREEN: points for the microscopic model
    double confidence;    ///< of the set of best points, of a selection, of profiles
    double indifference;  ///< in units of the first objective; NAN: not given
    double tolerance;     ///< of searches, relative to the ranges
    bool is_pruning;      ///< sweeps: runs that cannot be the best any more are stopped
    double n_independent; ///< STUDY_CALIBRATE
} study_document_method;

/// The document. study_document_read(), study_document_fini().
typedef struct study_document {
    char name[STUDY_DOCUMENT_NAME]; ///< for people
    char line[API_LABEL_SIZE];      ///< in the service: the line that it belongs to
    struct json_t *scenario;        ///< of the base; owned
    run_model model;                ///< of the base
    study_document_parameter parameters[STUDY_PARAMETERS]; ///< n_parameters
    size_t n_parameters;                                   ///< 0: the base is repeated
    study_document_objective objectives[STUDY_VALUES];     ///< n_objectives; the first is optimised
    size_t n_objectives; ///< 0 with STUDY_CALIBRATE, else at least 1
    bool has_own_second; ///< the second one was given, and is not that which decides between equals
    study_document_curve curves[STUDY_DOCUMENT_CURVES]; ///< n_curves
    size_t n_curves;                                    ///< STUDY_CALIBRATE: at least 1, else 0
    study_document_method method;                       ///< how points are chosen
    uint64_t replications;                              ///< of each point, where there is chance
    bool has_chance; ///< in runs of the base that are not a sweep of a screening; follows from it
    uint64_t seed;   ///< of what is drawn
    uint64_t substream;  ///< of the base: that of the first replication
    uint64_t trials_max; ///< limit
    int workers;         ///< at a time; 0: as many as there are cores
    int priority;        ///< in the service, see API_PRIORITY_MAX
} study_document;

/// The document as a table, and the words of methods.
extern const member_table study_document_members;
extern const char *const study_document_methods[];

/// Read a document and check it, its base, too. All faults that can be found are noted in *faults. BF_OK: *ret_document is
/// the caller's, study_document_fini(). Else the status of the first fault, or BF_ENOMEM, and *ret_document is untouched.
BF_MUST_CHECK bf_status study_document_read(const char *json, size_t n,
                                            study_document *ret_document, bf_faults *faults,
                                            bf_error *err);

/// Free what a document owns and zero it. NULL is fine.
void study_document_fini(study_document *document);

/// What core/study is to do.
study_definition study_document_definition(const study_document *document);

/// The value of a parameter at a coordinate of the unit cube.
double study_document_value(const study_document_parameter *parameter, double coordinate);

/// The model that solves a point.
run_model study_document_model(const study_document *document, study_model model);

/// The scenario of a trial, resolved and checked for its model; faults have pointers into the scenario. BF_OK: *ret_scene is
/// the caller's, scene_fini(). Changes the document's base, so that it belongs to one thread at a time.
BF_MUST_CHECK bf_status study_document_scene(study_document *document, const double *point,
                                             uint32_t substream, run_model model, scene *ret_scene,
                                             bf_faults *faults, bf_error *err);

/// The column of values of a trial, "throughput_per_h", "wait_s.p95:infeed" or "mse:upstream", into ret_name.
enum { STUDY_DOCUMENT_COLUMN = 128 };
void study_document_column(const study_document *document, size_t value, char *ret_name);

/// The values of a trial from the key figures of its run, or of STUDY_CALIBRATE from the curve: n samples at times t, the
/// columns row by row. NAN: the run cannot say. BF_ENOMEM.
typedef struct study_document_outcome {
    const scene *scene;    ///< that was solved
    const double *figures; ///< figure_values() values
    size_t n;              ///< samples of the curve
    const double *t;       ///< their times, s
    size_t n_columns;      ///< of the curve
    const double *columns; ///< n rows
} study_document_outcome;
BF_MUST_CHECK bf_status study_document_values(const study_document *document,
                                              const study_document_outcome *outcome,
                                              double *ret_values, bf_error *err);

/// The better one of two values of the first objective; NAN: there is none.
double study_document_better(const study_document *document, double a, double b);

/// True if trials of this study may be pruned, and one whose run has these key figures, until the time t of its scene, will
/// be worse than `best`, a value of the first objective, whatever happens. False if best is NAN.
bool study_document_is_hopeless(const study_document *document, const scene *s, double t,
                                const double *figures, double best);
