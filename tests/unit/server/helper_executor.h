/// An executor whose jobs do what a test says: the test's thread sends frames in their place, ends or loses
/// them, while the supervisor's thread runs the real code. Nothing is started.
///
/// Samples follow from their index: sample i has t = i / 100 and the values i and 0.5 i, plus the offset of
/// its job; a snapshot's 4 x 2 cells all have its index. So what is stored shows where it came from.

#pragma once

#include "core/observe/frame.h"
#include "server/run/executor.h"

#include <stdbool.h>

enum { HELPER_JOBS_MAX = 32 }; ///< that an executor ever starts

typedef struct helper_executor helper_executor;

/// The state of a job, by helper_executor_job().
typedef struct helper_job {
    char run_id[64];     ///< of its run
    uint64_t first_step; ///< of the checkpoint that it got; 0: none
    unsigned n_graceful; ///< stops of either kind that it got
    unsigned n_now;      ///< see n_graceful
    unsigned n_blamed;   ///< times that who solves it was found at fault
    bool is_released;    ///< the supervisor has nothing more to do with it
    size_t n_unread;     ///< bytes that the supervisor has not taken
} helper_job;

/// Append the bytes of a frame as a solver sends them, its array in slices.
void helper_encode(const frame *f, bf_buffer *out);

/// Create one; destroy it after the supervisor.
helper_executor *helper_executor_create(void);
void helper_executor_destroy(helper_executor *e);

/// As the supervisor needs it.
executor *helper_executor_base(helper_executor *e);

/// The next n calls of start() fail with this status.
void helper_executor_refuse(helper_executor *e, unsigned n, bf_status status);

/// From now on jobs ignore stops of both kinds (at first they end: EXITED with a FRAME_END, or KILLED).
void helper_executor_ignore_stops(helper_executor *e);

/// From now on poll() returns at most n bytes at a time.
void helper_executor_deliver_slowly(helper_executor *e, size_t n);

/// From now on it has workers with room for n further jobs, of trials or not, who may be at fault; the first failure that
/// one tells of is not believed. First called before the
/// supervisor is started.
void helper_executor_employ(helper_executor *e, size_t n);

/// Add a job as the daemon before would have left it, named "fake:<index>". Returns its index.
size_t helper_executor_add(helper_executor *e, const char *run_id);

/// Wait until `n` jobs have been started or added, fails after a minute; the state of one.
void helper_executor_await(helper_executor *e, size_t n);
helper_job helper_executor_job(helper_executor *e, size_t index);

/// Send bytes or a frame from a job.
void helper_executor_send_bytes(helper_executor *e, size_t index, const void *bytes, size_t n);
void helper_executor_send(helper_executor *e, size_t index, const frame *f);

/// Send FRAME_BEGIN of 10 steps; samples first .. first + n - 1; snapshot `number`; a checkpoint of this
/// step; FRAME_END.
void helper_executor_begin(helper_executor *e, size_t index);
void helper_executor_samples(helper_executor *e, size_t index, uint64_t first, uint32_t n,
                             double offset);
void helper_executor_snapshot(helper_executor *e, size_t index, uint64_t number);
void helper_executor_checkpoint(helper_executor *e, size_t index, uint64_t step);
void helper_executor_finish(helper_executor *e, size_t index, bool stopped);

/// The job has used so much CPU time so far.
void helper_executor_use(helper_executor *e, size_t index, double used_s);

/// The job ends with this cause; is lost; cannot be reached for now.
void helper_executor_end(helper_executor *e, size_t index, api_job_cause cause);
void helper_executor_lose(helper_executor *e, size_t index);
void helper_executor_disconnect(helper_executor *e, size_t index);
