/// Studies and their trials as the services of the API take and return them. What a study is says
/// api/study/study_document.h.

#pragma once

#include "api/measurements.h"
#include "core/base/buffer.h"
#include "core/base/status.h"
#include "core/run/run.h"
#include "core/study/study.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    API_STUDY_NAME_SIZE = 101, ///< bytes of a study's name with its terminator
    API_TRIALS_PAGE_MAX = 1000 ///< trials a page of a list
};

/// State, word in the API, whether it is an end. A study is queued until the service has room for it, and again when it
/// is resumed.
#define API_STUDY_STATE_LIST(X)                                                                    \
    X(API_STUDY_QUEUED, "queued", false)                                                           \
    X(API_STUDY_RUNNING, "running", false)                                                         \
    X(API_STUDY_SUCCEEDED, "succeeded", true)                                                      \
    X(API_STUDY_FAILED, "failed", true)                                                            \
    X(API_STUDY_CANCELLED, "cancelled", true)                                                      \
    X(API_STUDY_PAUSED, "paused", false)

/// The states. The values stand in the store: never renumber.
typedef enum api_study_state {
#define X(state, word, is_end) state,
    API_STUDY_STATE_LIST(X)
#undef X
        API_STUDY_STATES
} api_study_state;

/// State, word in the API, whether it is an end. A trial that is not at an end has the state of its run.
#define API_TRIAL_STATE_LIST(X)                                                                    \
    X(API_TRIAL_QUEUED, "queued", false)                                                           \
    X(API_TRIAL_RUNNING, "running", false)                                                         \
    X(API_TRIAL_SUCCEEDED, "succeeded", true)                                                      \
    X(API_TRIAL_FAILED, "failed", true)         /* its run failed */                               \
    X(API_TRIAL_INFEASIBLE, "infeasible", true) /* its scenario is not valid */                    \
    X(API_TRIAL_PRUNED, "pruned", true)         /* it could not become the best any more */        \
    X(API_TRIAL_CANCELLED, "cancelled", true)   /* its study was, or its run by itself */

/// The states. The values stand in the store: never renumber.
typedef enum api_trial_state {
#define X(state, word, is_end) state,
    API_TRIAL_STATE_LIST(X)
#undef X
        API_TRIAL_STATES
} api_trial_state;

/// A study as the store knows it.
typedef struct api_study {
    char id[API_ID_SIZE];               ///< UUIDv7: sorts by time of creation
    api_study_state state;              ///< where it is in its life
    study_method method;                ///< how its points are chosen
    run_model model;                    ///< of its base
    int priority;                       ///< higher ones first, among studies
    char name[API_STUDY_NAME_SIZE];     ///< for people
    char line[API_LABEL_SIZE];          ///< the line that it belongs to; "": none
    char owner[API_OWNER_SIZE];         ///< whose it is; "": nobody's
    uint64_t revision;                  ///< from 1, rises with every change: the ETag
    int64_t created_ms;                 ///< Unix time, ms
    int64_t started_ms;                 ///< first start; 0: never
    int64_t finished_ms;                ///< 0: not yet
    uint64_t trials_max;                ///< its limit
    uint64_t n_trials;                  ///< made so far
    uint64_t n_ended[API_TRIAL_STATES]; ///< of them, by how they ended
    bf_error error;                     ///< of API_STUDY_FAILED; code BF_OK: none
    bool is_suspect;                    ///< the run of one of its trials is
} api_study;

/// A trial of a study.
typedef struct api_trial {
    uint64_t number;                     ///< from 0
    uint64_t point;                      ///< its replications have the same
    run_model model;                     ///< that solves it
    uint64_t substream;                  ///< of its scenario
    api_trial_state state;               ///< where it is in its life
    uint64_t ended;                      ///< its place among those that have ended, from 1; 0: none
    size_t n_parameters;                 ///< as the study has
    double parameters[STUDY_PARAMETERS]; ///< their values
    size_t n_values;                     ///< as the study has
    double values[STUDY_VALUES];         ///< NAN: its run cannot say, or has not ended
    char run[API_ID_SIZE];               ///< "": there was none; it may have been removed since
    bf_error fault;                      ///< why it failed or is infeasible; code BF_OK: none
} api_trial;

/// A study to be accepted.
typedef struct api_study_submission {
    char name[API_STUDY_NAME_SIZE]; ///< for people
    char line[API_LABEL_SIZE];      ///< see api_study
    study_method method;            ///< of the document
    run_model model;                ///< of the document
    int priority;                   ///< see api_submission
    uint64_t trials_max;            ///< of the document
    bf_buffer document; ///< what study_document_read() reads, without names of measurements
    bf_buffer columns;  ///< of its trials, from study_columns_write()
    api_sender sender;  ///< whose it will be
} api_study_submission;

/// An order of trials, and which of them are in it.
typedef enum api_trial_order {
    API_TRIALS_BY_NUMBER, ///< all, by number
    API_TRIALS_BY_END,    ///< those that have ended, in the order in which they did
    API_TRIALS_OPEN,      ///< those that have not ended, by number
} api_trial_order;

/// Which trials are read.
typedef struct api_trial_query {
    api_trial_order order; ///< in which
    uint64_t from;         ///< the first one: API_TRIALS_BY_END its place, else its number
    size_t limit;          ///< most trials, 1 .. API_TRIALS_PAGE_MAX
} api_trial_query;

/// Called with each trial that is read; not BF_OK stops the reading and is passed on.
typedef bf_status api_trial_fn(void *context, const api_trial *trial, bf_error *err);

/// What may be asked of a study that has not ended.
typedef enum api_study_change {
    API_STUDY_PAUSE,  ///< no further trial begins; those that run go on
    API_STUDY_RESUME, ///< go on
    API_STUDY_CANCEL, ///< end; trials that wait or run are cancelled
    API_STUDY_CHANGES
} api_study_change;

/// A stored text of a study.
typedef enum api_study_text {
    API_STUDY_DOCUMENT, ///< of the submission
    API_STUDY_COLUMNS,  ///< same
    API_STUDY_BEST,     ///< what was found so far: study_best_write()
    API_STUDY_BASE,     ///< scenario of the first trial, which those of all are stored against
    API_STUDY_TEXTS
} api_study_text;

/// The words of the states, ended by NULL; and that of one, never NULL.
extern const char *const api_study_state_words[API_STUDY_STATES + 1];
extern const char *const api_trial_state_words[API_TRIAL_STATES + 1];
const char *api_study_state_word(api_study_state state);
const char *api_trial_state_word(api_trial_state state);

/// True if nothing may follow.
bool api_study_state_is_end(api_study_state state);
bool api_trial_state_is_end(api_trial_state state);

/// How many trials of a study have ended.
uint64_t api_study_ended(const api_study *about);
