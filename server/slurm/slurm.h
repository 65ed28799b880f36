/// Workers that Slurm starts: as many `beltflow worker --pull` as the runs that wait would keep busy.
///
/// Slurm never solves a run by itself and is never asked what became of one: workers lease runs of the daemon like any
/// others (server/pull/pull_executor.h), and the daemon's database is the truth. What Slurm forgets or loses is therefore
/// submitted again as soon as its queue no longer shows it.
///
/// Commands  `squeue` once an interval while there is work or a job of ours; then at most one `sbatch`, of one job array,
///           and only while none of our tasks is pending; `scancel` for tasks that failed to be launched and are held.
/// Counting  a job is this daemon's by its comment, which holds the URL that its workers ask. A task that runs counts as a
///           worker for SLURM_BEGIN_S, and from then on while a worker of its name (slurm-JOB_TASK) is heard of.
/// Restart   nothing is stored: Slurm's queue shows what was submitted before.
/// Threads   one of its own; the functions may be called from any thread.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"
#include "server/run/executor.h"
#include "server/store/store.h"

#include <stdint.h>

enum {
    SLURM_ARRAY_MAX = 500, ///< tasks of an array; Slurm allows 1,000 by default
    SLURM_BEGIN_S = 600,   ///< for a task that runs, until its worker must have been heard of
    SLURM_LEAD_S = 120,    ///< before the end of the time limit workers hand back what they solve
    SLURM_TEMPLATE_BYTES_MAX = 16 * 1024, ///< of the template
};

/// What workers are started with.
typedef struct slurm_settings {
    const char *url;           ///< of this daemon, as compute nodes reach it
    const char *token_file;    ///< on the compute nodes, with a token of the scope `work`; "": none
    const char *program;       ///< `beltflow` on the compute nodes
    const char *template_file; ///< of the batch script; "": slurm_template
    uint64_t n_workers_max;    ///< tasks at once
    uint64_t cores;            ///< of each task
    uint64_t walltime_s;       ///< time limit of a task
    uint64_t idle_s;           ///< a worker ends after so long without a job
    uint64_t interval_s;       ///< between looks at Slurm's queue
} slurm_settings;

/// What demand follows from. All outlive the use.
typedef struct slurm_options {
    slurm_settings settings; ///< texts are borrowed until slurm_stop()
    executor *pull;          ///< whose jobs workers lease
    store *store;            ///< with the runs that wait
    uint64_t n_threads;      ///< cores of a run
} slurm_options;

/// A running one; opaque.
typedef struct slurm slurm;

/// The batch script that is used without a template. In it, and in a template, these stand for settings, texts quoted for
/// the shell: {program}, {url}, {token} (`--token-file FILE` or nothing), {cores}, {minutes} (time limit), {lifetime_s},
/// {idle_s}.
extern const char slurm_template[];

/// Append the batch script. BF_EINPUT: no URL, or the template is empty or holds a zero; BF_ELIMIT: it is too long;
/// BF_ENOMEM.
BF_MUST_CHECK bf_status slurm_write_script(const slurm_settings *s, bf_buffer *out, bf_error *err);

/// Start the thread. As slurm_write_script(); BF_ESYSTEM.
BF_MUST_CHECK bf_status slurm_start(const slurm_options *o, slurm **ret_slurm, bf_error *err);

/// Stop the thread and free. Workers and jobs go on: a daemon that is started again finds them. NULL is fine. Always
/// returns NULL.
slurm *slurm_stop(slurm *s);
