#include "server/cli/cmd.h"

#include "api/json/json_in.h"
#include "api/json/number.h"
#include "api/scenario/scenario.h"
#include "core/observe/frame.h"
#include "core/run/run.h"
#include "server/base/file_io.h"
#include "server/run/confinement.h"
#include "server/run/run_control.h"

#include <argp.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <unistd.h>

// An address sanitizer maps terabytes of shadow memory: a limit on address space would end it.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CAN_LIMIT_MEMORY 0
#else
#define CAN_LIMIT_MEMORY 1
#endif

enum {
    REPORT_MS = 50,
    FLUSH_BYTES = 256 * 1024,
    CPU_GRACE_S = 5, // from SIGXCPU, which identifies the cause, to SIGKILL
    KEY_MEMORY = 256,
    KEY_CPU,
    KEY_PARENT,
    KEY_CHECKPOINT,
};

typedef struct worker_arguments {
    uint64_t memory_bytes; // 0: unlimited
    uint64_t cpu_s;        // 0: unlimited
    uint64_t parent;       // 0: none
    uint64_t checkpoint_ms;
} worker_arguments;

// A run being solved: its frames wait in out and leave together.
typedef struct working {
    bf_buffer out;
    run_control run_control;
    bool is_without_snapshots;
    bool is_reader_gone;
} working;

static bool flush_frames(working *w)
{
    bool ok = file_io_write_fd(STDOUT_FILENO, w->out.bytes, w->out.n);

    w->is_reader_gone = !ok;
    w->out.n = 0;
    return ok;
}

static bf_status put_frame(working *w, const frame *f, bool is_urgent, bf_error *err)
{
    BF_TRY(frame_encode(f, &w->out, err));
    if ((is_urgent || w->out.n >= FLUSH_BYTES) && !flush_frames(w))
        return bf_fail(err, BF_ESYSTEM, "", "frames cannot be written: %s", strerror(errno));
    return BF_OK;
}

static bf_status on_frame(void *context, const frame *f, bf_error *err)
{
    const working *w = context;
    const bool is_snapshot = f->type == FRAME_SNAPSHOT || f->type == FRAME_PARTS;
    const bool is_urgent = f->type != FRAME_CURVE && !is_snapshot;
    frame slice;

    if (is_snapshot && w->is_without_snapshots)
        return BF_OK;
    for (uint64_t at = 0; frame_slice_at(f, at, &slice); at += slice.slice.n)
        BF_TRY(put_frame(context, &slice, false, err));
    return put_frame(context, f, is_urgent, err);
}

static unsigned find_requested(void *context)
{
    working *w = context;

    return run_control_requested(&w->run_control);
}

// A run that goes on from the checkpoint in *in. Without one, or from one that does not fit (of another version), it starts
// from t = 0.
static bf_status begin(const scene *s, const frame_job *job, const bf_buffer *in, run **ret_run,
                       bf_error *err)
{
    const run_model model = (run_model)job->model;
    const int n_threads = (int)job->n_threads;
    frame f = { .type = FRAME_RESUME };
    size_t used = 0;

    if (in->n == 0)
        return run_create(s, model, n_threads, ret_run, err);
    BF_TRY(frame_decode_input(in->bytes, in->n, FRAME_RESUME, &f, &used, err));
    bf_status status = run_resume(s, model, n_threads, f.bytes.bytes, f.bytes.n, ret_run, err);
    if (status != BF_ECORRUPT)
        return status;
    fprintf(stderr, "starting again from t = 0: %s\n", err->text);
    return run_create(s, model, n_threads, ret_run, err);
}

static bf_status solve(working *w, const scene *s, const frame_job *job, bf_buffer *rest,
                       bf_error *err)
{
    run *r = NULL;
    run_sink sink = { .context = w, .on_frame = on_frame, .requested = find_requested };

    if (job->model >= RUN_MODEL_COUNT || job->n_threads < 1 || job->n_threads > INT16_MAX)
        return bf_fail(err, BF_ECORRUPT, "", "the job names no model or no threads");
    w->is_without_snapshots = job->is_without_snapshots != 0;
    bf_status status = begin(s, job, rest, &r, err);
    buffer_fini(rest);
    if (status == BF_OK)
        status = run_execute(r, &sink, err);
    run_destroy(r);
    return status;
}

// Nothing of the job is known before the confinement. It may come a while after the start: from then on reports and
// checkpoints are timed, and SIGTERM asks for one; before, there is nothing to be saved.
static bf_status read_job(working *w, int64_t checkpoint_ms, bf_buffer *in, bf_error *err)
{
    bf_status status = BF_OK;
    size_t seed = 0; // of hash tables: behind the confinement nothing can be opened to draw it

    if (getrandom(&seed, sizeof seed, 0) != (ssize_t)sizeof seed)
        status = bf_fail(err, BF_ESYSTEM, "", "no random bytes: %s", strerror(errno));
    else
        json_in_seed(seed);
    if (status == BF_OK)
        status = confinement_enter(err);
    if (status == BF_OK)
        status = file_io_read_fd(STDIN_FILENO, "the job", FRAME_PAYLOAD_MAX, in, err);
    run_control_catch(SIGTERM, RUN_CONTROL_CATCH_ALL);
    w->run_control = run_control_init(REPORT_MS, checkpoint_ms);
    return status;
}

static bf_status work(working *w, int64_t checkpoint_ms, bf_error *err)
{
    bf_buffer in = { 0 };
    bf_faults faults = { 0 };
    frame f = { .type = FRAME_JOB };
    size_t used = 0;
    scene s;

    bf_status status = read_job(w, checkpoint_ms, &in, err);
    if (status == BF_OK)
        status = frame_decode_input(in.bytes, in.n, FRAME_JOB, &f, &used, err);
    if (status == BF_OK)
        status = scenario_read(f.job.document, f.job.n_document, &s, &faults, err);
    if (status == BF_OK) {
        buffer_drop(&in, used); // so that the checkpoint is aligned
        status = solve(w, &s, &f.job, &in, err);
        scene_fini(&s);
    } else if (faults.n > 0) {
        status = faults_status(&faults, err);
    }
    buffer_fini(&in);
    return status;
}

static void set_limit(int resource, uint64_t soft, uint64_t hard)
{
    struct rlimit limit = { .rlim_cur = soft, .rlim_max = hard };

    if (setrlimit(resource, &limit) != 0)
        fprintf(stderr, "a limit cannot be set: %s\n", strerror(errno));
}

// The out-of-memory killer is to choose this process, not the daemon.
static void prefer_for_memory_killer(void)
{
    FILE *file = fopen("/proc/self/oom_score_adj", "we");

    if (file == NULL)
        return;
    fputs("500\n", file);
    fclose(file);
}

// Tie this process to its parent and limit what it may use. False: the parent has already exited.
static bool limit_process(const worker_arguments *a)
{
    prefer_for_memory_killer();
    if (!confinement_leave_root())
        fputs("the solver keeps the privileges of root\n", stderr);
    if (a->parent != 0 &&
        (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || (uint64_t)getppid() != a->parent))
        return false;
    if (a->memory_bytes != 0 && CAN_LIMIT_MEMORY)
        set_limit(RLIMIT_AS, a->memory_bytes, a->memory_bytes);
    if (a->cpu_s != 0)
        set_limit(RLIMIT_CPU, a->cpu_s, a->cpu_s + CPU_GRACE_S);
    set_limit(RLIMIT_CORE, 0, 0);
    signal(SIGPIPE, SIG_IGN);
    return true;
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    worker_arguments *a = state->input;
    uint64_t *target = key == KEY_MEMORY       ? &a->memory_bytes
                       : key == KEY_CPU        ? &a->cpu_s
                       : key == KEY_PARENT     ? &a->parent
                       : key == KEY_CHECKPOINT ? &a->checkpoint_ms
                                               : NULL;

    if (target == NULL)
        return ARGP_ERR_UNKNOWN;
    if (!number_read_digits(argument, 0, UINT64_MAX, target))
        argp_error(state, "'%s' is not a number", argument);
    return 0;
}

int cmd_worker(int argc, char **argv)
{
    static const struct argp_option options[] = {
        { "memory-bytes", KEY_MEMORY, "N", 0, "Limit of address space (default 0: none)", 0 },
        { "cpu-s", KEY_CPU, "N", 0, "Limit of CPU time (default 0: none)", 0 },
        { "parent", KEY_PARENT, "PID", 0, "Die with this parent (default 0: none)", 0 },
        { "checkpoint-ms", KEY_CHECKPOINT, "N", 0, "Between checkpoints (default 5000; 0: none)",
          0 },
        { 0 },
    };
    static const struct argp parser = {
        .options = options,
        .parser = parse_option,
        .doc = "Solve one job: a job frame and perhaps a checkpoint on standard input, frames of "
               "the results on standard output (core/observe/frame.h).\v"
               "SIGTERM lets it write a checkpoint and end.",
    };
    worker_arguments arguments = { .checkpoint_ms = 5000 };
    working w = { .is_reader_gone = false };
    frame failure = { .type = FRAME_ERROR };

    argp_parse(&parser, argc, argv, 0, NULL, &arguments);
    if (!limit_process(&arguments))
        return CMD_FAILED;
    bf_status status = work(&w, (int64_t)arguments.checkpoint_ms, &failure.error);
    if (status != BF_OK && !w.is_reader_gone) {
        // The error stands on stderr too, for when there is no memory left to make a frame of it.
        fprintf(stderr, "%s\n", failure.error.text);
        if (on_frame(&w, &failure, NULL) != BF_OK)
            fputs("the error frame could not be written\n", stderr);
    }
    buffer_fini(&w.out);
    return status == BF_OK ? CMD_DONE : CMD_FAILED;
}
