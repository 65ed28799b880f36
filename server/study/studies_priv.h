/// What the files of studies have in common: studies.c (the thread, and which studies are at work), study_task.c (one of
/// them), outcome.c (what the run of a trial found).

#pragma once

#include "api/study/study_document.h"
#include "server/base/liveness.h"
#include "server/base/lock.h"
#include "server/study/studies.h"

#include <pthread.h>
#include <stdatomic.h>

enum {
    STUDIES_AT_WORK = 8,    ///< studies that take turns; others wait
    STUDIES_OPEN_MAX = 256, ///< trials of a study that wait or run
    STUDIES_TURN_MS = 200,  ///< that a study may take until others have their turn
};

/// A trial that has not ended.
typedef struct study__open {
    api_trial trial; ///< as it began
    bool is_changed; ///< under the lock: its run is to be looked at
    bool is_pruned;  ///< its run was cancelled because it cannot be the best any more
} study__open;

/// A study at work. The thread's, but for what stands under the lock of its `owner`.
typedef struct study__task {
    studies *owner;                  ///< whose it is
    char id[API_ID_SIZE];            ///< of the study
    char owner_name[API_OWNER_SIZE]; ///< whose the study is
    study_document document;         ///< what it is
    study *core;                     ///< its points, and what was told
    uint64_t n_begun;                ///< trials in the store
    uint64_t n_told;                 ///< of them, told to core
    double best;                     ///< the best value of the first objective; NAN: none
    bool has_news;                   ///< something was told since the best was last written
    int64_t best_ms;                 ///< when that was, clock_monotonic_ms()
    struct study__turn *turn;        ///< what it writes, empty between turns
    size_t n_open;                   ///< under the lock
    study__open *open; ///< under the lock where others may look; room for STUDIES_OPEN_MAX
} study__task;

/// The studies.
struct studies {
    studies_options options;             ///< n_workers and age_ms are under the lock
    pthread_t thread;                    ///< runs the loop
    lock lock;                           ///< guards what follows
    lock_condition woken;                ///< has_news, has_changes or is_stopping
    bool has_news;                       ///< something is asked of studies
    bool has_changes;                    ///< runs of trials have changed
    bool is_stopping;                    ///< the thread is to end
    _Atomic bool is_abandoned;           ///< checks of scenarios are to end early
    liveness liveness;                   ///< of the thread
    size_t n_tasks;                      ///< studies at work
    study__task *tasks[STUDIES_AT_WORK]; ///< n_tasks
    size_t n_removals;                   ///< the thread's: counts turns of those that are removed
    int64_t again_ms; ///< the thread's: when to look again without being woken; -1: never
};

/// Between two things that take time: say that the thread lives. False: it is to end, and what is left is left.
bool studies__goes_on(studies *s);

/// Look at all studies again after this time, or before.
void studies__look_again(studies *s, int64_t after_ms);

/// Bring a study from what the store has of it. The caller owns *ret_task: study__task_destroy(). BF_ECORRUPT: its
/// trials are not those that it would make.
BF_MUST_CHECK bf_status study__task_create(studies *s, const api_study *about,
                                           study__task **ret_task, bf_error *err);

/// Free a study. NULL is fine.
void study__task_destroy(study__task *t);

/// Take what trials found, and begin others while it is running, for STUDIES_TURN_MS and one trial. *ret_is_over: it has
/// ended, or rests without a trial that runs; *ret_has_more: there may be more to begin. On failure the study is to be
/// brought again.
BF_MUST_CHECK bf_status study__task_turn(study__task *t, bool *ret_is_over, bool *ret_has_more,
                                         bf_error *err);

/// True if the failure is of the machine, not of the study.
bool study__may_work_later(bf_status code);

/// Look at the run of an open trial. *ret_has_ended: trial->state, values and fault are set; else it goes on, and if it is
/// hopeless it was cancelled.
BF_MUST_CHECK bf_status study__look(study__task *t, study__open *open, bool *ret_has_ended,
                                    bf_error *err);

/// Make the submission of a trial. BF_EINPUT, BF_ELIMIT: it is infeasible, *err says why.
BF_MUST_CHECK bf_status study__submission(study__task *t, const api_study *about,
                                          const api_trial *trial, api_submission *ret_submission,
                                          bf_error *err);
