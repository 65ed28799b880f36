/// A run as the services of the API return it, and what its users may change of it.

#pragma once

#include "api/access.h"
#include "api/event.h"
#include "api/measurements.h"
#include "api/run_state.h"
#include "api/snapshots.h"
#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/run/run.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    API_FIGURES_SIZE = 1024, ///< bytes of the run's own key figures as JSON with its terminator
    API_CLOSURE_SIZE = 16,   ///< bytes of the word of a closure with its terminator
    API_NOTES_SIZE = 501,    ///< bytes of a run's notes with their terminator
};

/// What users call a run or a study and note of it; it may change at any time. Texts are "" if there is none.
typedef struct api_annotations {
    char name[SCENE_NAME_SIZE]; ///< of a study fewer bytes: API_STUDY_NAME_SIZE
    char label[API_LABEL_SIZE]; ///< of runs
    char line[API_LABEL_SIZE];  ///< the line that it belongs to
    char notes[API_NOTES_SIZE]; ///< of runs
    bool is_starred;            ///< of runs
} api_annotations;

/// A run as the store knows it.
typedef struct api_run {
    char id[API_ID_SIZE];       ///< UUIDv7: sorts by time of creation
    run_state state;            ///< where it is in its life
    run_model model;            ///< which solver
    int priority;               ///< higher runs first
    char label[API_LABEL_SIZE]; ///< the client's, "" if none
    char name[SCENE_NAME_SIZE]; ///< at first that of the scenario
    char line[API_LABEL_SIZE];  ///< the line that it belongs to, "" if none
    /// Its scenario's number among the line's, from 1; 0: no line, or a trial
    uint64_t line_version;
    char notes[API_NOTES_SIZE]; ///< of its users, "" if none
    bool is_starred;            ///< its users want to find it again
    /// Of the macroscopic model, its word; "": not known, or the other model
    char closure[API_CLOSURE_SIZE];
    uint64_t revision;              ///< from 1, rises with every change of the row: the ETag
    double progress;                ///< 0 to 1
    int64_t created_ms;             ///< Unix time, ms
    int64_t started_ms;             ///< last start; 0: never
    int64_t finished_ms;            ///< 0: not yet
    double eta_s;                   ///< wall seconds to the end; NAN: unknown
    double predicted_s;             ///< CPU time that it will take while it waits; NAN: not known
    uint64_t n_samples;             ///< stored samples of the curve
    uint64_t n_snapshots;           ///< stored snapshots
    uint64_t last_event;            ///< id of the newest event of the run; 0: none
    bf_grid grid;                   ///< of its snapshots; n1 = 0: not known yet
    api_parts parts;                ///< of its snapshots; n_values = 0: none
    bool has_summary;               ///< summary.json is there
    char owner[API_OWNER_SIZE];     ///< whose it is; "": nobody's
    char study[API_ID_SIZE];        ///< whose trial it is; "": no study's
    bool is_cached;                 ///< its results are those of a run before it
    bool is_suspect;                ///< who sent its results sent wrong ones, or others differ
    char figures[API_FIGURES_SIZE]; ///< key figures of the run alone, a JSON object; "" if none
    bf_error error;                 ///< code BF_OK: none
} api_run;
