// The times of a task: how long a stop may take, and how long a run may stand still or take at all.

#include "server/run/supervisor_priv.h"

#include "server/base/clock.h"

#include <inttypes.h>

static void kill_by(supervisor__task *task, int64_t at_ms)
{
    if (task->kill_at_ms < 0 || at_ms < task->kill_at_ms)
        task->kill_at_ms = at_ms;
}

// When a run that goes on has used up a time, ms of the monotonic clock; INT64_MAX: never. While a batch is
// stored its job is not read, and may have gone on.
static int64_t find_stalled_ms(const supervisor__task *task)
{
    const uint64_t stall_s = task->supervisor->options.stall_s;

    return stall_s == 0 ? INT64_MAX : task->moved_ms + (int64_t)stall_s * 1000;
}

static int64_t find_overdue_ms(const supervisor__task *task)
{
    const uint64_t wall_s = task->supervisor->options.wall_s;
    const double left_s = (double)wall_s - task->claimed.wall_s;

    return wall_s == 0 ? INT64_MAX : (int64_t)((task->start_s + left_s) * 1000);
}

static bool is_timed(const supervisor__task *task)
{
    return task->phase == SUPERVISOR_SOLVING && task->requested == SUPERVISOR_STOP_NONE &&
           task->state == EXECUTOR_RUNNING && !task->has_ended && !task->failed &&
           !task->write.is_pending;
}

// A run that stands still or takes too long fails, and what is stored of it stays.
static void enforce_times(supervisor__task *task)
{
    const supervisor_options *options = &task->supervisor->options;
    const int64_t now_ms = clock_monotonic_ms();
    bf_error err = { 0 };

    if (!is_timed(task))
        return;
    if (now_ms >= find_overdue_ms(task))
        (void)bf_fail(&err, BF_ELIMIT, "",
                      "the run was not over after %" PRIu64 " s, its limit of time (run_wall_s)",
                      options->wall_s);
    else if (now_ms >= find_stalled_ms(task))
        (void)bf_fail(&err, BF_ELIMIT, "",
                      "the solver stood still: no step for %" PRIu64 " s, the limit (run_stall_s)",
                      options->stall_s);
    else
        return;
    task->timed_out = true;
    supervisor__fail(task, &err);
}

// Forward the requested stop to the job, stop it by force after the grace period, and declare it lost if
// that has no effect.
static void enforce_stop(supervisor__task *task, int64_t grace_ms)
{
    supervisor *s = task->supervisor;
    executor *e = s->executor;
    int64_t now_ms = clock_monotonic_ms();

    if (task->phase != SUPERVISOR_SOLVING)
        return;
    if (task->requested > task->signalled) {
        if (task->requested == SUPERVISOR_STOP_KILL)
            kill_by(task, now_ms);
        else if (task->signalled == SUPERVISOR_STOP_NONE)
            e->functions->stop(e, task->job, EXECUTOR_STOP_GRACEFUL);
        kill_by(task,
                now_ms + (task->requested == SUPERVISOR_STOP_HAND_BACK ? grace_ms
                                                                       : s->options.stop_grace_ms));
        task->signalled = task->requested;
    }
    // While a batch is stored the job is not polled: it may have ended long ago.
    if ((task->has_ended || task->failed) && !task->write.is_pending)
        kill_by(task, now_ms + s->options.stop_grace_ms);
    if (task->kill_at_ms >= 0 && task->kill_at_ms <= now_ms) {
        e->functions->stop(e, task->job, EXECUTOR_STOP_NOW);
        task->timed_out =
            task->timed_out || (task->requested != SUPERVISOR_STOP_KILL && !task->failed);
        task->kill_at_ms = INT64_MAX;
        task->lost_at_ms = now_ms + s->options.lost_ms;
    }
    if (task->lost_at_ms >= 0 && task->lost_at_ms <= now_ms && !task->write.is_pending &&
        task->state != EXECUTOR_ENDED)
        task->state = EXECUTOR_LOST;
}

void supervisor__enforce(supervisor__task *task, int64_t grace_ms)
{
    enforce_times(task);
    enforce_stop(task, grace_ms);
}

static int sooner(int64_t at_ms, int64_t now_ms, int timeout_ms)
{
    int64_t left_ms = at_ms <= now_ms ? 0 : at_ms - now_ms;

    if (left_ms > INT32_MAX)
        return timeout_ms;
    return timeout_ms < 0 || left_ms < timeout_ms ? (int)left_ms : timeout_ms;
}

// How long poll() may block: indefinitely, unless a timer is set or there is data to read.
int supervisor__find_timeout(const supervisor *s)
{
    int64_t now_ms = clock_monotonic_ms();
    int timeout_ms = -1;

    for (size_t i = 0; i < s->n_tasks; i++) {
        const supervisor__task *task = s->tasks[i];
        if (task->phase != SUPERVISOR_SOLVING)
            continue;
        if ((task->has_more || task->state == EXECUTOR_LOST) && !task->write.is_pending)
            return 0;
        if (is_timed(task)) {
            timeout_ms = sooner(find_stalled_ms(task), now_ms, timeout_ms);
            timeout_ms = sooner(find_overdue_ms(task), now_ms, timeout_ms);
        }
        if (task->kill_at_ms >= 0)
            timeout_ms = sooner(task->kill_at_ms, now_ms, timeout_ms);
        if (task->lost_at_ms >= 0 && !task->write.is_pending)
            timeout_ms = sooner(task->lost_at_ms, now_ms, timeout_ms);
    }
    if (s->claim_at_ms != 0 && supervisor__has_room(s))
        timeout_ms = sooner(s->claim_at_ms, now_ms, timeout_ms);
    else if (s->held_until_ms != 0 && supervisor__has_room(s))
        timeout_ms = sooner(s->held_until_ms, now_ms, timeout_ms);
    return timeout_ms;
}
