#include "server/run/supervisor_priv.h"

#include "api/results/results.h"
#include "api/scenario/scenario.h"
#include "core/advice/plausible.h"
#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/log.h"

#include <inttypes.h>
#include <stdio.h>

supervisor__task *supervisor__task_create(supervisor *s)
{
    supervisor__task *task = memory_alloc(1, sizeof *task);

    if (task == NULL)
        return NULL;
    BF_CHECK(s->n_tasks < SUPERVISOR_TASKS_MAX);
    task->supervisor = s;
    task->kill_at_ms = task->lost_at_ms = -1;
    s->tasks[s->n_tasks++] = task;
    return task;
}

void supervisor__task_destroy(supervisor__task *task)
{
    supervisor *s = task->supervisor;
    executor *e = s->executor;

    BF_CHECK(!task->write.is_pending);
    for (size_t i = 0; i < s->n_tasks; i++) {
        if (s->tasks[i] == task)
            s->tasks[i--] = s->tasks[--s->n_tasks];
    }
    if (task->job != NULL)
        e->functions->release(e, task->job);
    supervisor__free_items(task);
    snapshots_fini_items(&task->items);
    buffer_fini(&task->output);
    buffer_fini(&task->figures);
    store_job_fini(&task->claimed);
    memory_free(task);
}

static executor_limits limits_of(const supervisor *s)
{
    return (executor_limits){ .checkpoint_ms = s->options.checkpoint_ms,
                              .memory_bytes = s->options.memory_bytes,
                              .cpu_s = s->options.cpu_s };
}

void supervisor__prepare_job(supervisor *s)
{
    const executor_limits limits = limits_of(s);

    if (s->executor->functions->prepare != NULL)
        s->executor->functions->prepare(s->executor, &limits);
}

static bf_status start_job(supervisor__task *task, bf_error *err)
{
    const supervisor_options *options = &task->supervisor->options;
    executor *e = task->supervisor->executor;
    const executor_work work = { .run_id = task->claimed.run.id,
                                 .model = task->claimed.run.model,
                                 .n_threads = options->n_threads,
                                 .is_trial = task->claimed.run.study[0] != '\0',
                                 .study_id = task->claimed.run.study,
                                 .scenario = &task->claimed.scenario,
                                 .checkpoint = &task->claimed.checkpoint,
                                 .step = task->claimed.step,
                                 .limits = limits_of(task->supervisor) };

    return e->functions->start(e, &work, &task->job, err);
}

bf_status supervisor__task_start(supervisor__task *task, const char *external_id, bf_error *err)
{
    executor *e = task->supervisor->executor;

    BF_TRY(external_id == NULL ? start_job(task, err)
                               : e->functions->attach(e, external_id, &task->job, err));
    buffer_fini(&task->claimed.checkpoint); // the job has it
    snprintf(task->external_id, sizeof task->external_id, "%s",
             e->functions->external_id(task->job));
    task->n_threads = task->supervisor->options.n_threads;
    task->n_columns = api_count_columns(&task->claimed.columns);
    task->start_s = clock_monotonic_s();
    task->moved_ms = clock_monotonic_ms();
    task->state = EXECUTOR_WAITING;
    task->phase = SUPERVISOR_SOLVING;
    task->has_more = true;
    return BF_OK;
}

double supervisor__wall_s(const supervisor__task *task)
{
    return task->claimed.wall_s +
           (task->start_s == 0.0 ? 0.0 : clock_monotonic_s() - task->start_s);
}

double supervisor__cpu_s(const supervisor__task *task)
{
    executor *e = task->supervisor->executor;

    return task->claimed.cpu_s + (task->job == NULL ? 0.0 : e->functions->cpu_s(e, task->job));
}

void supervisor__fail(supervisor__task *task, const bf_error *err)
{
    executor *e = task->supervisor->executor;

    if (!task->failed)
        task->error = *err;
    task->failed = true;
    task->output.n = task->n_decoded = 0;
    task->has_frames = false;
    supervisor__free_items(task);
    e->functions->stop(e, task->job, EXECUTOR_STOP_NOW);
}

// Checkpoints, progress and key figures take each other's place; the other results stay. Unlike supervisor__fail() this
// leaves what came before, be it of the same batch: how much a batch has depends on when the supervisor read.
bool supervisor__count_output(supervisor__task *task, frame_type type, size_t n)
{
    executor *e = task->supervisor->executor;
    const uint64_t limit = task->supervisor->options.output_bytes;
    const bool is_kept = type == FRAME_CURVE || type == FRAME_SNAPSHOT || type == FRAME_PARTS ||
                         type == FRAME_CHANGE || type == FRAME_SLICE;

    task->n_sent += is_kept ? n : 0;
    if (limit == 0 || task->n_sent <= limit)
        return true;
    task->is_beyond_output = task->failed = true;
    (void)bf_fail(
        &task->error, BF_ELIMIT, "",
        "the run's results have more than %" PRIu64 " bytes, its limit (run_output_bytes)", limit);
    e->functions->stop(e, task->job, EXECUTOR_STOP_NOW);
    return false;
}

bool supervisor__attribute_fault(supervisor__task *task, const bf_error *why)
{
    executor *e = task->supervisor->executor;

    if (e->functions->attribute_fault == NULL || !e->functions->attribute_fault(e, task->job, why))
        return false;
    task->is_fault_of_worker = true;
    if (!task->failed)
        task->error = *why;
    return true;
}

bf_status supervisor__check_claims(const supervisor__task *task, bool is_end, bf_error *err)
{
    const bf_buffer *text = &task->claimed.scenario;
    const run_model model = task->claimed.run.model;
    scene s;

    if (!task->supervisor->executor->is_elsewhere)
        return BF_OK;
    if (!task->has_begun)
        return bf_fail(err, BF_ECORRUPT, "", "the run ended without a begin");
    BF_TRY(scenario_read_resolved(text->bytes, text->n, &s, err));
    bf_status status = is_end ? plausible_end(&s, model, &task->begin, &task->end, err)
                              : plausible_begin(&s, model, &task->begin, err);
    scene_fini(&s);
    return status;
}

static run_state state_for(supervisor__stop requested)
{
    return requested >= SUPERVISOR_STOP_CANCEL ? RUN_CANCELLED : RUN_QUEUED;
}

// Who solves the run elsewhere may have been stopped by others, or fail where another would not.
static store_ending end_of_worker(const supervisor__task *task)
{
    const api_job_cause cause = task->exit.cause;
    store_ending ending = { .run_id = task->claimed.run.id,
                            .state = state_for(task->requested),
                            .attempt = STORE_ATTEMPT_FAILED,
                            .error = task->is_fault_of_worker ? task->error : task->exit.error };

    if (task->state == EXECUTOR_LOST)
        (void)bf_fail(&ending.error, BF_ESYSTEM, "", "whoever solved the run is gone");
    else if (cause == API_JOB_UNSTARTED ||
             (!task->is_fault_of_worker && (cause == API_JOB_STOPPED || task->has_ended)))
        ending.attempt = STORE_ATTEMPT_HAND_BACK;
    return ending;
}

// The job came back without having been asked to, and another worker may do better. Faults of the program are the run's.
static bool may_be_workers(const supervisor__task *task)
{
    const api_job_cause cause = task->exit.cause;

    if (!supervisor__has_workers(task->supervisor))
        return false;
    return task->is_fault_of_worker || task->has_ended || task->state == EXECUTOR_LOST ||
           cause == API_JOB_STOPPED || cause == API_JOB_KILLED || cause == API_JOB_UNSTARTED ||
           cause == API_JOB_EXITED;
}

store_ending supervisor__classify_exit(const supervisor__task *task)
{
    const run_state state = state_for(task->requested); // of a run that is not at fault
    store_ending ending = { .run_id = task->claimed.run.id, .state = RUN_FAILED };
    api_job_cause cause = task->exit.cause;
    bool is_requested = task->requested != SUPERVISOR_STOP_NONE;
    bool has_moved = task->has_ended && task->end.n_steps > task->begin.first_step;

    if (task->requested == SUPERVISOR_STOP_KILL) {
        ending.state = RUN_CANCELLED;
    } else if (task->failed && !task->is_fault_of_worker) {
        ending.state = task->is_store_error ? state : RUN_FAILED;
        ending.error = task->error;
    } else if (!task->is_fault_of_worker && task->has_ended && !task->end.stopped) {
        ending.state = RUN_SUCCEEDED;
        ending.whole = task->supervisor->executor->is_elsewhere ? &task->end : NULL;
        ending.is_without_snapshots = task->claimed.run.study[0] != '\0';
    } else if (!is_requested && may_be_workers(task)) {
        ending = end_of_worker(task);
    } else if (task->is_fault_of_worker) {
        ending.state = state;
        ending.error = task->error;
    } else if (task->has_ended && (is_requested || has_moved)) {
        ending.state = state;
    } else if (task->has_ended) {
        (void)bf_fail(&ending.error, BF_ESYSTEM, "", "the solver stopped without being asked to");
    } else if (task->state == EXECUTOR_LOST) {
        ending.state = state;
        ending.attempt = is_requested ? STORE_ATTEMPT_NONE : STORE_ATTEMPT_FAILED;
    } else if (cause == API_JOB_STOPPED || (cause == API_JOB_KILLED && is_requested)) {
        ending.state = state; // it could not answer the stop, or did not
    } else if (cause == API_JOB_UNSTARTED) {
        ending.state = state;
        ending.error = task->exit.error;
    } else if ((cause == API_JOB_EXITED || cause == API_JOB_FAILED) && task->output.n > 0) {
        (void)bf_fail(&ending.error, BF_ECORRUPT, "", "the solver's output ends inside a frame");
    } else {
        ending.error = task->exit.error;
    }
    return ending;
}

metrics_reason supervisor__exit_reason(const supervisor__task *task)
{
    bool has_refused = task->error.code == BF_EINPUT || task->error.code == BF_ELIMIT;

    if (task->timed_out)
        return METRICS_EXIT_TIMEOUT;
    if (task->is_beyond_output)
        return METRICS_EXIT_OUTPUT;
    if (task->state == EXECUTOR_LOST)
        return METRICS_EXIT_ERROR;
    switch (task->exit.cause) {
    case API_JOB_TIMED_OUT:
        return METRICS_EXIT_TIMEOUT;
    case API_JOB_EXITED:
        return METRICS_EXIT_OK;
    case API_JOB_UNSTARTED:
        return METRICS_EXIT_ERROR;
    case API_JOB_FAILED:
        return has_refused ? METRICS_EXIT_INPUT : METRICS_EXIT_ERROR;
    default:
        return METRICS_EXIT_SIGNAL;
    }
}

// The summary of a run that sent its figures; *out stays empty where it did not.
static bf_status write_summary(const supervisor__task *task, bf_buffer *out, bf_error *err)
{
    const results_timing timing = { .wall_s = supervisor__wall_s(task),
                                    .n_threads = task->n_threads };
    const key_figures figures = supervisor__figures(task);

    if (!task->has_begun || !task->has_ended)
        return BF_OK;
    return results_summary(task->claimed.run.model, task->claimed.scenario.bytes,
                           task->claimed.scenario.n, &task->begin, &task->end, &figures, &timing,
                           out, err);
}

bf_status supervisor__store_ending(supervisor__task *task, bf_error *err)
{
    store *s = task->supervisor->store;
    store_ending *ending = &task->ending;
    bf_buffer summary = { 0 };
    api_run after;
    char quoted[LOG_QUOTED_SIZE];
    bf_status status = BF_OK;

    if (ending->state == RUN_SUCCEEDED)
        status = supervisor__check_claims(task, true, err);
    if (status == BF_OK && (ending->state == RUN_SUCCEEDED || ending->state == RUN_CANCELLED))
        status = write_summary(task, &summary, err);
    ending->summary = summary.n == 0 ? NULL : summary.bytes;
    ending->n_summary = summary.n;
    if (status == BF_OK)
        status = store_finish(s, ending, &after, err);
    // Only the supervisor's thread may ask who is at fault for what is damaged.
    const bool is_workers =
        status == BF_ECORRUPT && task->supervisor->executor->functions->attribute_fault != NULL;
    if (status != BF_OK && !supervisor__may_work_later(status) && !is_workers) {
        *ending = (store_ending){
            .run_id = ending->run_id, .state = RUN_FAILED, .error = *err, .cpu_s = ending->cpu_s
        };
        status = store_finish(s, ending, &after, err);
    }
    if (status != BF_OK) {
        *ending = (store_ending){ .run_id = ending->run_id,
                                  .state = RUN_QUEUED,
                                  .attempt = is_workers ? STORE_ATTEMPT_FAILED : STORE_ATTEMPT_NONE,
                                  .error = *err,
                                  .cpu_s = ending->cpu_s };
        status = store_finish(s, ending, &after, err);
    }
    buffer_fini(&summary);
    ending->summary = NULL;
    if (status == BF_OK && ending->state != after.state) { // it was the last attempt
        ending->state = after.state;
        ending->error = after.error;
    }
    if (status == BF_OK) {
        if (ending->state == RUN_FAILED)
            log_event(LOG_LEVEL_WARN, "run_ended", "run=%s state=failed wall_s=%.3f error=%s",
                      ending->run_id, supervisor__wall_s(task),
                      log_quote(ending->error.text, quoted));
        else
            log_event(LOG_LEVEL_INFO, "run_ended", "run=%s state=%s wall_s=%.3f", ending->run_id,
                      run_state_word(ending->state), supervisor__wall_s(task));
    }
    if (status == BF_OK && ending->state == RUN_SUCCEEDED) {
        metrics_add(METRICS_RUNS_SOLVED, task->claimed.run.model, 1);
        metrics_add(METRICS_RUN_TIME, task->claimed.run.model,
                    (int64_t)(1e9 * supervisor__wall_s(task)));
    }
    if (status != BF_OK)
        log_event(LOG_LEVEL_ERROR, "run_not_stored", "run=%s error=%s", ending->run_id,
                  log_quote(err->text, quoted));
    return status;
}
