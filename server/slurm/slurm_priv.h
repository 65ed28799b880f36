/// What the files of Slurm have in common: slurm.c (the loop), queue.c (what Slurm's queue shows), script.c (the batch script),
/// command.c (programs of Slurm).

#pragma once

#include "server/base/lock.h"
#include "server/slurm/slurm.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

enum {
    SLURM_NAME_SIZE = 48,          ///< bytes of a task's name, "JOB_TASK", with its terminator
    SLURM_COMMENT_SIZE = 600,      ///< bytes of a comment with its terminator
    SLURM_OUTPUT_MAX = 4194304,    ///< bytes that a command may print
    SLURM_COMMAND_MS = 30000,      ///< that a command may take
    SLURM_CANCELLED_AT_ONCE = 100, ///< tasks in one command
};

/// Where a task is.
typedef enum slurm__state {
    SLURM_PENDING, ///< waits for a node
    SLURM_HELD,    ///< waits until whoever holds it releases it
    SLURM_FAILED,  ///< could not be launched, and is held by Slurm for that
    SLURM_STARTED, ///< on a node
    SLURM_OVER,    ///< it ends or has ended
} slurm__state;

/// A task of ours in Slurm's queue.
typedef struct slurm__task {
    char name[SLURM_NAME_SIZE]; ///< "JOB_TASK"
    slurm__state state;         ///< where it is
    int64_t runs_s;             ///< since its start
} slurm__task;

/// What Slurm's queue shows of us.
typedef struct slurm__queue {
    size_t n;           ///< tasks
    slurm__task *tasks; ///< memory_free()
} slurm__queue;

/// What counts workers and submits jobs.
struct slurm {
    slurm_options options;            ///< as given
    char comment[SLURM_COMMENT_SIZE]; ///< of our jobs
    bf_buffer script;                 ///< of each of them
    atomic_bool is_stopping;          ///< ends commands, too
    lock lock;                        ///< of the condition
    lock_condition stopped;           ///< it is stopping
    pthread_t thread;                 ///< of slurm_start(); the only one that uses what follows
    bool is_failing;                  ///< the last command did
    bool has_looked;                  ///< at Slurm's queue, with success, since the last submission
    int64_t look_ms;                  ///< then it is looked at again
    uint64_t n_tasks;                 ///< that the queue showed, or were submitted since
    uint64_t n_pending;               ///< of them, wait for a node
    uint64_t n_there;                 ///< of them, count as workers
};

/// As slurm_start() and slurm_stop(), without a thread.
BF_MUST_CHECK bf_status slurm__create(const slurm_options *o, slurm **ret_slurm, bf_error *err);
void slurm__destroy(slurm *s);

/// What the thread does at a time of clock_monotonic_ms(), once a second: compare, look, submit.
void slurm__take_turn(slurm *s, int64_t now_ms);

/// A program of Slurm.
typedef struct slurm__command {
    const char *const *argv;      ///< the program, found by PATH, and its arguments; ends with NULL
    const bf_buffer *input;       ///< for its standard input; NULL: none
    const atomic_bool *must_stop; ///< end it as soon as this is true
} slurm__command;

/// Run a program of Slurm and append what it printed. BF_ESYSTEM: it cannot be run, failed (with what it said), or took too
/// long; BF_ELIMIT: it printed too much; BF_ENOMEM.
BF_MUST_CHECK bf_status slurm__run(const slurm__command *c, bf_buffer *out, bf_error *err);

/// The format of `squeue` that slurm__read_queue() reads: array job, task, state, time, reason, comment.
#define SLURM_QUEUE_FORMAT "--format=%F|%K|%T|%M|%r|%k"

/// The tasks in squeue's output whose comment is this one. What is no line of ours is passed over. BF_ENOMEM.
BF_MUST_CHECK bf_status slurm__read_queue(const char *text, const char *comment,
                                          slurm__queue *ret_queue, bf_error *err);

/// Seconds of squeue's "[days-][[hours:]minutes:]seconds"; 0 if it is none.
int64_t slurm__read_time(const char *text);
