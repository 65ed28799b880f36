/// Studies and their trials in the store. The first half is what api_services needs; the second is for who works on
/// studies: it makes trials, whose runs the supervisor finds in the queue, and writes down how they end.
///
/// A study's trials are numbered from 0 without gaps. A trial is open until its end is written (store_step_study()), with
/// the values that it is told by; its run may have ended before, or be removed. While a trial is open, retention leaves
/// its run. Threads, errors and invariants are those of store.h.

#pragma once

#include "server/store/store.h"

enum {
    STORE_STUDIES_MAX = 10000,      ///< studies
    STORE_STUDIES_OPEN_MAX = 1000,  ///< of them, that have not ended
    STORE_STUDIES_RUNNING_MAX = 64, ///< of them, that take turns
};

/// See api_services for the meaning of each. What is asked of a study that is at work is a request, which who works on it
/// fulfils; it is on disk when these return. A study that is to be removed is not found any more.
BF_MUST_CHECK bf_status store_submit_study(store *s, const api_study_submission *submission,
                                           api_acceptance *ret_acceptance, bf_error *err);
BF_MUST_CHECK bf_status store_find_study(store *s, const char *id, api_study *ret_study,
                                         bf_error *err);
BF_MUST_CHECK bf_status store_list_studies(store *s, const api_page_query *query,
                                           api_page *ret_page, bf_error *err);
BF_MUST_CHECK bf_status store_change_study(store *s, const char *id, uint64_t revision,
                                           api_study_change change, api_study *ret_study,
                                           bf_error *err);
BF_MUST_CHECK bf_status store_annotate_study(store *s, const char *id, uint64_t revision,
                                             const api_annotations *annotations,
                                             api_study *ret_study, bf_error *err);
BF_MUST_CHECK bf_status store_remove_study(store *s, const char *id, uint64_t revision,
                                           bf_error *err);
BF_MUST_CHECK bf_status store_read_study(store *s, const char *id, api_study_text which,
                                         bf_buffer *out, bf_error *err);
/// No reader is held while on_trial() runs, so it may call the store.
BF_MUST_CHECK bf_status store_read_trials(store *s, const char *id, const api_trial_query *query,
                                          api_trial_fn *on_trial, void *context, bf_error *err);

/// A study's row.
typedef struct store_study {
    int64_t rowid;                ///< the store's own number of it
    api_study study;              ///< what others see of it
    char client[API_CLIENT_SIZE]; ///< who submitted it
    store_stop stop_request; ///< STORE_STOP_CANCEL: to be cancelled; STORE_STOP_KILL: to be removed
} store_study;

/// Which studies are to be worked on.
typedef enum store_studies {
    STORE_STUDIES_RUNNING, ///< those that are running, by priority and age
    STORE_STUDIES_QUEUED,  ///< those that wait, by priority and age
    STORE_STUDIES_TO_STOP, ///< those with a stop request
} store_studies;

/// List studies, `size` at most.
BF_MUST_CHECK bf_status store_list_work(store *s, store_studies which, size_t size,
                                        store_study *ret_studies, size_t *ret_n, bf_error *err);

/// A trial that begins.
typedef struct store_trial_begin {
    api_trial trial; ///< what it is; infeasible with its fault, or queued; run, ended: set
    const api_submission *submission; ///< of its run, NULL if it is infeasible; without key
} store_trial_begin;

/// A step of a study.
typedef struct store_study_step {
    const char *id; ///< whose
    size_t n_ends;  ///< trials that end
    /// Their numbers, states, values and faults; those that are not open are left out
    const api_trial *ends;
    size_t n_begins;           ///< trials that begin, numbered behind all that there are
    store_trial_begin *begins; ///< only of a study that is running
    const bf_buffer *best;     ///< what was found so far; NULL: as it was
    api_study_state state;     ///< where it goes; API_STUDY_STATES: where it is
    bf_error error;            ///< of API_STUDY_FAILED
    double cpu_s;              ///< that making the trials took: charged to the owner of the study
} store_study_step;

/// Write a step in one transaction. A run whose results are known is inserted with them and has ended. BF_ECONFLICT: the
/// study has ended, or trials are to begin and it is not running or has a stop request: nothing was written.
BF_MUST_CHECK bf_status store_step_study(store *s, const store_study_step *step,
                                         api_study *ret_study, bf_error *err);

/// Remove a study that has ended, or is to be removed, and has no runs any more, in small steps. BF_ECONFLICT: it has.
BF_MUST_CHECK bf_status store_forget_study(store *s, const char *id, bf_error *err);

/// Find the study that ended first, if that was before a time. BF_ENOTFOUND: there is none.
BF_MUST_CHECK bf_status store_find_old_study(store *s, int64_t before_ms, char ret_id[API_ID_SIZE],
                                             bf_error *err);

/// Remove some runs of a study that is to be removed in one commit, and ask running ones to stop. *ret_has_runs: some are left,
/// or were a moment ago. What is left of their results is deleted by and by.
BF_MUST_CHECK bf_status store_remove_runs_of_study(store *s, const char *id, bool *ret_has_runs,
                                                   bf_error *err);
