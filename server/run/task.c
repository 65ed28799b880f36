#include "server/run/supervisor_priv.h"

#include "api/results/results.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/log.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

enum { NUMBER_TEXT = 24 };

static bf_status encode_job(const store_job *job, unsigned n_threads, bf_buffer *out, bf_error *err)
{
    frame f = { .type = FRAME_JOB,
                .job = { .model = (uint32_t)job->run.model,
                         .n_threads = n_threads,
                         .n_document = job->scenario.n,
                         .document = job->scenario.bytes } };
    frame resume = {
        .type = FRAME_RESUME,
        .bytes = { .step = job->step, .n = job->checkpoint.n, .bytes = job->checkpoint.bytes }
    };

    bf_status status = frame_encode(&f, out, err);
    return status != BF_OK || job->checkpoint.n == 0 ? status : frame_encode(&resume, out, err);
}

static bf_status start_child(const supervisor_options *options, bf_buffer *input, child *ret_child,
                             bf_error *err)
{
    char memory[NUMBER_TEXT], cpu[NUMBER_TEXT], parent[NUMBER_TEXT], checkpoint[NUMBER_TEXT];
    char *argv[] = { (char[]){ "beltflow" },
                     (char[]){ "worker" },
                     (char[]){ "--memory-bytes" },
                     memory,
                     (char[]){ "--cpu-s" },
                     cpu,
                     (char[]){ "--parent" },
                     parent,
                     (char[]){ "--checkpoint-ms" },
                     checkpoint,
                     NULL };

    snprintf(memory, sizeof memory, "%" PRIu64, options->memory_bytes);
    snprintf(cpu, sizeof cpu, "%" PRIu64, options->cpu_s);
    snprintf(parent, sizeof parent, "%ld", (long)getpid());
    snprintf(checkpoint, sizeof checkpoint, "%" PRId64, options->checkpoint_ms);
    return child_start(options->program, argv, input, ret_child, err);
}

bf_status supervisor__task_start(const supervisor_options *options, store_job *job,
                                 supervisor__task **ret_task, bf_error *err)
{
    bf_buffer input = { 0 };
    supervisor__task *task = memory_alloc(1, sizeof *task);

    bf_status status = task == NULL ? bf_fail(err, BF_ENOMEM, "", "no memory to start a run")
                                    : encode_job(job, options->n_threads, &input, err);
    if (status == BF_OK)
        status = start_child(options, &input, &task->child, err);
    buffer_fini(&input);
    if (status != BF_OK) {
        memory_free(task);
        return status;
    }
    buffer_fini(&job->checkpoint); // the child's from now on
    task->job = *job;
    *job = (store_job){ .step = 0 };
    task->n_columns = api_count_columns(&task->job.columns);
    task->kill_at_ms = -1;
    task->start_s = clock_monotonic_s();
    for (int source = 0; source < SUPERVISOR_SOURCE_COUNT; source++)
        task->watches[source] = (supervisor__watch){ (supervisor__source)source, task };
    *ret_task = task;
    return BF_OK;
}

double supervisor__wall_s(const supervisor__task *task)
{
    return task->job.wall_s + clock_monotonic_s() - task->start_s;
}

static run_state state_for(supervisor__wish asked)
{
    return asked == SUPERVISOR_CANCEL || asked == SUPERVISOR_KILL ? RUN_CANCELLED : RUN_QUEUED;
}

store_ending supervisor__judge(supervisor__task *task, int status, supervisor__wish asked,
                               const supervisor_options *options)
{
    store_ending ending = { .run_id = task->job.run.id, .state = RUN_FAILED };
    int number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    bool has_moved = task->has_ended && task->end.n_steps > task->begin.first_step;

    if (asked == SUPERVISOR_KILL)
        ending.state = RUN_CANCELLED;
    else if (task->is_doomed)
        ending.error = task->error;
    else if (task->has_ended && !task->end.stopped)
        ending.state = RUN_SUCCEEDED;
    else if (task->has_ended && (asked != SUPERVISOR_GO_ON || has_moved))
        ending.state = state_for(asked);
    else if (task->has_ended)
        (void)bf_fail(&ending.error, BF_ESYSTEM, "", "the solver stopped without being asked to");
    else if (number == SIGTERM || (number == SIGKILL && asked != SUPERVISOR_GO_ON))
        ending.state =
            state_for(asked); // ended before it could catch the signal, or did not heed it
    else if (number == 0 && task->child.output.n > 0)
        (void)bf_fail(&ending.error, BF_ECORRUPT, "", "the solver's output ends inside a frame");
    else
        child_describe_end(&task->child, status, options->memory_bytes, options->cpu_s,
                           &ending.error);
    return ending;
}

metrics_reason supervisor__exit_reason(const supervisor__task *task, int status)
{
    if (task->is_late || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU))
        return METRICS_EXIT_TIMEOUT;
    if (WIFSIGNALED(status))
        return METRICS_EXIT_SIGNAL;
    if (WEXITSTATUS(status) == EXIT_SUCCESS)
        return METRICS_EXIT_OK;
    return task->error.code == BF_EINPUT || task->error.code == BF_ELIMIT ? METRICS_EXIT_INPUT
                                                                          : METRICS_EXIT_ERROR;
}

// The summary of a run that told its figures; *out stays empty where it did not.
static bf_status write_summary(const supervisor__task *task, unsigned n_threads, bf_buffer *out,
                               bf_error *err)
{
    const results_timing timing = { .wall_s = supervisor__wall_s(task), .n_threads = n_threads };

    if (!task->has_begun || !task->has_ended)
        return BF_OK;
    return results_summary(task->job.run.model, task->job.scenario.bytes, task->job.scenario.n,
                           &task->begin, &task->end, &timing, out, err);
}

static void log_end(const supervisor__task *task, const store_ending *ending)
{
    char quoted[LOG_QUOTED_SIZE];

    if (ending->state == RUN_FAILED)
        log_event(LOG_LEVEL_WARN, "run_ended", "run=%s state=failed wall_s=%.3f error=%s",
                  task->job.run.id, supervisor__wall_s(task),
                  log_quote(ending->error.text, quoted));
    else
        log_event(LOG_LEVEL_INFO, "run_ended", "run=%s state=%s wall_s=%.3f", task->job.run.id,
                  run_state_word(ending->state), supervisor__wall_s(task));
}

bool supervisor__finish(supervisor__task *task, store *s, store_ending *ending, unsigned n_threads)
{
    bf_buffer summary = { 0 };
    api_run after;
    bf_error err = { 0 };
    char quoted[LOG_QUOTED_SIZE];
    bf_status status = BF_OK;

    if (ending->state == RUN_SUCCEEDED || ending->state == RUN_CANCELLED)
        status = write_summary(task, n_threads, &summary, &err);
    ending->summary = summary.n == 0 ? NULL : summary.bytes;
    ending->n_summary = summary.n;
    if (status == BF_OK)
        status = store_finish(s, ending, &after, &err);
    if (status != BF_OK) {
        *ending = (store_ending){ .run_id = ending->run_id, .state = RUN_FAILED, .error = err };
        status = store_finish(s, ending, &after, &err);
    }
    if (status != BF_OK) {
        *ending = (store_ending){ .run_id = ending->run_id, .state = RUN_QUEUED };
        status = store_finish(s, ending, &after, &err);
    }
    buffer_fini(&summary);
    if (status == BF_OK)
        log_end(task, ending);
    else
        log_event(LOG_LEVEL_ERROR, "run_not_stored", "run=%s error=%s", task->job.run.id,
                  log_quote(err.text, quoted));
    return status == BF_OK;
}

void supervisor__task_free(supervisor__task *task)
{
    if (task == NULL)
        return;
    supervisor__free_items(task);
    memory_free(task->items);
    child_fini(&task->child);
    store_job_fini(&task->job);
    memory_free(task);
}
