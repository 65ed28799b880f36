/// The predictor: says of runs that have not ended how long they will take (core/advice/prediction.h).
///
/// It measures how fast this machine is with each kind of solver when it is first needed, some 30 ms, and with all of them when
/// it is first asked for the speed, or after five seconds. Whenever it is asked, it learns from what the runs that have ended
/// since then took (core/advice/prediction_learn.h), at first from the newest PREDICTOR_LEARNED in the store. Of the trials of a
/// study it learns from one that ended after a run that was not of it. A run is predicted when somebody asks for the first
/// time, which takes some 10 to 100 milliseconds; so one that nobody looks at costs nothing. What was found is kept in memory, of
/// the PREDICTOR_RUNS_MAX runs and studies that were asked for last. Where measuring fails it is tried again for the next run.
///
/// Trials of a study are taken to be alike: what is predicted of the first one stands for all of them, until
/// predictor_learn() has told what they took.
///
/// Threads  one of its own, at a low priority. The functions may be called from any thread.

#pragma once

#include "core/advice/prediction.h"
#include "server/store/store.h"

#include <stdbool.h>

enum {
    PREDICTOR_RUNS_MAX = 16384, ///< whose predictions are kept
    PREDICTOR_SAMPLE = 64,      ///< runs of the queue that are looked at
    PREDICTOR_LEARNED = 64,     ///< runs that have ended, at a time
};

/// A running predictor; opaque.
typedef struct predictor predictor;

/// Start the thread; it reads scenarios from the store. BF_ENOMEM, BF_ESYSTEM.
BF_MUST_CHECK bf_status predictor_start(store *s, predictor **ret_predictor, bf_error *err);

/// CPU time that a run will take, s; NAN: not known yet, or it has ended. study_id: whose trial it is, "" if it is a run by
/// itself. Does not wait.
double predictor_seconds(predictor *p, const char *run_id, const char *study_id);

/// A trial of the study took this CPU time, s.
void predictor_learn(predictor *p, const char *study_id, double seconds);

/// CPU time that n runs in the queue will take, s: n times the mean of the oldest PREDICTOR_SAMPLE of them. NAN: nothing is
/// known of any of these yet, or the store cannot be read. Does not wait for predictions.
double predictor_queue_seconds(predictor *p, uint64_t n);

/// How fast this machine is. False: not known yet; it is then measured, which takes a fifth of a second of CPU time.
bool predictor_speed(predictor *p, prediction_speed *ret_speed);

/// Stop the thread and free. NULL is fine. Always returns NULL.
predictor *predictor_stop(predictor *p);
