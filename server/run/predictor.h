/// The predictor: says of runs that wait how long they will take (core/run/prediction.h).
///
/// It first measures how fast this machine is, a fifth of a second. A run is predicted when somebody asks for the first
/// time, which takes some milliseconds; so one that nobody looks at costs nothing. What was found is kept in memory, of
/// the PREDICTOR_RUNS_MAX runs that were asked for last.
///
/// Threads  one of its own, at a low priority. The functions may be called from any thread.

#pragma once

#include "core/run/prediction.h"
#include "server/store/store.h"

#include <stdbool.h>

enum { PREDICTOR_RUNS_MAX = 16384 }; ///< whose predictions are kept

/// A running predictor; opaque.
typedef struct predictor predictor;

/// Start the thread; it reads scenarios from the store. BF_ENOMEM, BF_ESYSTEM.
BF_MUST_CHECK bf_status predictor_start(store *s, predictor **ret_predictor, bf_error *err);

/// CPU time that a run that waits will take, s; NAN: not known yet, or it does not wait any more. Does not wait itself.
double predictor_seconds(predictor *p, const char *run_id);

/// How fast this machine is. False: not known yet.
bool predictor_speed(predictor *p, prediction_speed *ret_speed);

/// Stop the thread and free. NULL is fine. Always returns NULL.
predictor *predictor_stop(predictor *p);
