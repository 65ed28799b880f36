// What the supervisor calls. wake_fd is an epoll descriptor of two: an eventfd for what requests bring, and a timer for
// those who fall silent.

#include "server/pull/pull_executor.h"

#include "api/json/number.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/pull/pull_priv.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#define ID_PREFIX "pull:"

pull_executor *pull__enter(void *context)
{
    pull_executor *e = context;

    lock_acquire(&e->lock);
    return e;
}

void pull__wake(pull_executor *e)
{
    const uint64_t one = 1;

    // It can only fail when it is readable already.
    if (write(e->news_fd, &one, sizeof one) < 0)
        return;
}

static bool has_ended(pull__place place)
{
    return place == PULL_ENDED || place == PULL_LOST;
}

double pull__predict(const pull_executor *e, const executor_job *job)
{
    return e->predictor == NULL ? (double)NAN
                                : predictor_seconds(e->predictor, job->about.run, job->study);
}

void pull__move(pull_executor *e, executor_job *job, pull__place place)
{
    lock_assert_held(&e->lock);
    if (job->lease != NULL) {
        job->lease->jobs[job->about.job] = NULL;
        job->lease->n_open--;
        job->lease->n_done += place == PULL_ENDED;
        job->lease = NULL;
    }
    if (has_ended(place) && !has_ended(job->place))
        e->n_cores_used[job->about.is_trial] -= job->about.n_threads;
    e->n_at[job->place]--;
    e->n_at[place]++;
    job->place = place;
    pull__wake(e);
}

static bf_status ready(executor *base, bf_error *err)
{
    (void)base;
    (void)err;
    return BF_OK;
}

static bool has_room(executor *base, bool is_trial)
{
    pull_executor *e = pull__enter(base);
    const uint32_t n_runs = e->n_cores_used[false];
    const bool has = is_trial ? n_runs + e->n_cores_used[true] < 2 * PULL_TRIALS_A_CORE * e->n_cores
                              : n_runs < e->n_cores;

    lock_release(&e->lock);
    return has;
}

executor_job *pull__add_job(pull_executor *e, pull__place place, const char *run_id,
                            uint64_t attempt)
{
    executor_job *job = memory_alloc(1, sizeof *job);

    lock_assert_held(&e->lock);
    if (job == NULL)
        return NULL;
    snprintf(job->id, sizeof job->id, ID_PREFIX "%s:%" PRIu64, run_id, attempt);
    snprintf(job->about.run, sizeof job->about.run, "%s", run_id);
    job->about.attempt = attempt;
    job->about.n_threads = 1;
    job->place = place;
    job->started_ms = clock_monotonic_ms();
    TAILQ_INSERT_TAIL(&e->jobs, job, entry);
    e->n_at[place]++;
    return job;
}

void pull__remove_job(pull_executor *e, executor_job *job)
{
    if (!has_ended(job->place))
        pull__move(e, job, PULL_LOST);
    e->n_at[job->place]--;
    TAILQ_REMOVE(&e->jobs, job, entry);
    e->n_bytes -= job->bytes.n;
    buffer_fini(&job->input);
    buffer_fini(&job->bytes);
    job->check = pull__check_destroy(job->check);
    memory_free(job);
}

static bf_status start(executor *base, const executor_work *work, executor_job **ret_job,
                       bf_error *err)
{
    pull_executor *e = pull__enter(base);
    executor_job *job = pull__add_job(e, PULL_WAITING, work->run_id, ++e->last_attempt);

    bf_status status = job == NULL ? bf_fail(err, BF_ENOMEM, "", "no memory to start a run")
                                   : executor_encode(work, &job->input, err);
    if (status == BF_OK) {
        job->about.model = work->model;
        job->about.n_threads = work->n_threads;
        job->about.is_trial = work->is_trial;
        job->about.checkpoint_ms = (uint64_t)work->limits.checkpoint_ms;
        job->about.memory_bytes = work->limits.memory_bytes;
        job->about.cpu_s = work->limits.cpu_s;
        job->about.step = work->checkpoint->n == 0 ? 0 : work->step;
        job->about.predicted_s = (double)NAN; // until it is leased
        job->about.n_bytes = job->input.n;
        if (work->is_trial)
            snprintf(job->study, sizeof job->study, "%s", work->study_id);
        (void)pull__predict(e, job); // so that it is known when somebody leases it
        if (work->checkpoint->n == 0)
            job->check = pull__choose_check(e);
        *ret_job = job;
    }
    if (job != NULL)
        e->n_cores_used[job->about.is_trial] += job->about.n_threads;
    if (status != BF_OK && job != NULL)
        pull__remove_job(e, job);
    lock_release(&e->lock);
    return status;
}

// Reads "pull:RUN:ATTEMPT".
static bool read_id(const char *id, char *ret_run, uint64_t *ret_attempt)
{
    const size_t n_prefix = strlen(ID_PREFIX), n_run = API_ID_SIZE - 1;

    if (strncmp(id, ID_PREFIX, n_prefix) != 0 || strlen(id) < n_prefix + n_run + 2 ||
        id[n_prefix + n_run] != ':')
        return false;
    memcpy(ret_run, id + n_prefix, n_run);
    ret_run[n_run] = '\0';
    return number_read_digits(id + n_prefix + n_run + 1, 0, UINT64_MAX, ret_attempt);
}

static bf_status attach(executor *base, const char *external_id, executor_job **ret_job,
                        bf_error *err)
{
    char run_id[API_ID_SIZE];
    uint64_t attempt;
    bf_status status = BF_OK;

    if (!read_id(external_id, run_id, &attempt))
        return bf_fail(err, BF_ENOTFOUND, "", "%s is no job of a worker", external_id);
    pull_executor *e = pull__enter(base);
    executor_job *job;
    TAILQ_FOREACH(job, &e->jobs, entry)
        if (strcmp(job->id, external_id) == 0)
            break;
    if (job == NULL) {
        job = pull__add_job(e, PULL_AWAITED, run_id, attempt);
        e->n_cores_used[false] += job != NULL;
    }
    if (job == NULL)
        status = bf_fail(err, BF_ENOMEM, "", "no memory to take over a run");
    else
        *ret_job = job;
    if (job != NULL)
        job->until_ms = clock_monotonic_ms() + API_LEASE_EXPIRES_S * 1000;
    pull__wake(e);
    lock_release(&e->lock);
    return status;
}

// What no worker has yet ends at once, and by force any job does: its worker hears that it is not its own any more.
static void stop(executor *base, executor_job *job, executor_stop how)
{
    pull_executor *e = pull__enter(base);

    if (has_ended(job->place)) {
        lock_release(&e->lock);
        return;
    }
    if (job->place == PULL_LEASED && how == EXECUTOR_STOP_GRACEFUL) {
        job->stop = API_JOB_SAVE;
    } else {
        job->end.cause = how == EXECUTOR_STOP_NOW ? API_JOB_KILLED : API_JOB_STOPPED;
        (void)bf_fail(&job->end.error, BF_ESYSTEM, "", "the run was stopped");
        e->n_bytes -= job->bytes.n;
        job->bytes.n = 0;
        pull__move(e, job, PULL_ENDED);
    }
    lock_release(&e->lock);
}

static void update(executor *base)
{
    pull_executor *e = pull__enter(base);
    uint64_t n;

    (void)!read(e->news_fd, &n, sizeof n);
    if (read(e->timer_fd, &n, sizeof n) > 0)
        pull__expire(e, clock_monotonic_ms());
    pull__drop_repetitions(e, clock_monotonic_ms());
    const bool is_needed = e->n_workers > 0 || e->n_leases > 0 || e->n_at[PULL_AWAITED] > 0;
    const struct timespec period = { .tv_sec = is_needed ? PULL_TICK_MS / 1000 : 0 };
    const struct itimerspec setting = { .it_interval = period, .it_value = period };
    if (is_needed != e->is_ticking)
        (void)timerfd_settime(e->timer_fd, 0, &setting, NULL);
    e->is_ticking = is_needed;
    metrics_set(METRICS_PULL_WORKERS, 0, (int64_t)e->n_workers);
    metrics_set(METRICS_PULL_LEASES, 0, (int64_t)e->n_leases);
    metrics_set(METRICS_PULL_JOBS, METRICS_PLACE_WAITING,
                (int64_t)(e->n_at[PULL_WAITING] + e->n_at[PULL_AWAITED]));
    metrics_set(METRICS_PULL_JOBS, METRICS_PLACE_LEASED, (int64_t)e->n_at[PULL_LEASED]);
    lock_release(&e->lock);
}

static executor_state poll_job(executor *base, executor_job *job, void *bytes, size_t capacity,
                               size_t *ret_n, executor_end *ret_end)
{
    pull_executor *e = pull__enter(base);
    const size_t n = job->bytes.n < capacity ? job->bytes.n : capacity;
    executor_state state = job->has_begun ? EXECUTOR_RUNNING : EXECUTOR_WAITING;

    if (n > 0)
        memcpy(bytes, job->bytes.bytes, n);
    buffer_drop(&job->bytes, n);
    e->n_bytes -= n;
    *ret_n = n;
    if (n == 0 && job->place == PULL_LOST)
        state = EXECUTOR_LOST;
    if (n == 0 && job->place == PULL_ENDED) {
        state = EXECUTOR_ENDED;
        *ret_end = job->end;
    }
    lock_release(&e->lock);
    return state;
}

void pull__attribute_fault(pull_executor *e, const char *run_id, uint64_t token, const char *name,
                           const char *why)
{
    pull__worker *worker = pull__find_worker(e, token, name);
    char quoted[LOG_QUOTED_SIZE];

    metrics_add(METRICS_PULL_FAULTS, 0, 1);
    log_event(LOG_LEVEL_ERROR, "worker_at_fault", "run=%s worker=%s error=%s", run_id, name,
              log_quote(why, quoted));
    if (worker == NULL || ++worker->n_faults < PULL_FAULTS_MAX)
        return;
    worker->n_faults = 0;
    worker->suspended_until_ms = clock_monotonic_ms() + PULL_SUSPENDED_MS;
    log_event(LOG_LEVEL_ERROR, "worker_suspended", "worker=%s s=%d", name,
              PULL_SUSPENDED_MS / 1000);
}

static bool attribute_fault(executor *base, executor_job *job, const bf_error *why)
{
    pull_executor *e = pull__enter(base);

    pull__attribute_fault(e, job->about.run, job->token, job->worker, why->text);
    lock_release(&e->lock);
    return true;
}

static bool confirm(executor *base, const executor_job *job, const bf_error *why)
{
    pull_executor *e = pull__enter(base);
    bool counts = true;

    if (why != NULL)
        counts = pull__confirm_failure(e, job, why);
    else
        pull__refute_failures(e, job);
    lock_release(&e->lock);
    return counts;
}

static uint64_t token_of(executor *base, const executor_job *job)
{
    pull_executor *e = pull__enter(base);
    const uint64_t token = job->token;

    lock_release(&e->lock);
    return token;
}

static double cpu_s(executor *base, executor_job *job)
{
    pull_executor *e = pull__enter(base);
    const double used_s = job->used_s;

    lock_release(&e->lock);
    return used_s;
}

static const char *external_id(const executor_job *job)
{
    return job->id;
}

static void release(executor *base, executor_job *job)
{
    pull_executor *e = pull__enter(base);

    pull__remove_job(e, job);
    lock_release(&e->lock);
}

static bool watch(int epoll, int fd)
{
    struct epoll_event event = { .events = EPOLLIN };

    return epoll >= 0 && fd >= 0 && epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

// What an executor has beside its lock. False: it is not whole.
static bool open_parts(pull_executor *e)
{
    e->base.wake_fd = epoll_create1(EPOLL_CLOEXEC);
    e->news_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    e->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
    e->workers = memory_alloc(API_WORKERS_MAX, sizeof *e->workers);
    e->leases = memory_alloc(API_LEASES_MAX, sizeof *e->leases);
    e->ends = memory_alloc(PULL_ENDS_KEPT, sizeof *e->ends);
    e->doubts = memory_alloc(PULL_DOUBTS_KEPT, sizeof *e->doubts);
    return watch(e->base.wake_fd, e->news_fd) && watch(e->base.wake_fd, e->timer_fd) &&
           e->workers != NULL && e->leases != NULL && e->ends != NULL && e->doubts != NULL;
}

bf_status pull_executor_create(executor **ret_executor, bf_error *err)
{
    static const executor_functions functions = { .ready = ready,
                                                  .has_room = has_room,
                                                  .start = start,
                                                  .attach = attach,
                                                  .stop = stop,
                                                  .update = update,
                                                  .poll = poll_job,
                                                  .attribute_fault = attribute_fault,
                                                  .confirm = confirm,
                                                  .token = token_of,
                                                  .cpu_s = cpu_s,
                                                  .external_id = external_id,
                                                  .release = release };
    pull_executor *e = memory_alloc(1, sizeof *e);

    if (e == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the jobs of workers");
    e->base = (executor){ .functions = &functions, .is_elsewhere = true, .outlives_daemon = true };
    lock_init(&e->lock);
    TAILQ_INIT(&e->jobs);
    e->last_attempt = (uint64_t)clock_unix_ms(); // no job of a daemon before has it
    if (!open_parts(e)) {
        (void)bf_fail(err, BF_ESYSTEM, "", "workers cannot be waited for: %s", strerror(errno));
        (void)pull_executor_destroy(&e->base);
        return BF_ESYSTEM;
    }
    *ret_executor = &e->base;
    return BF_OK;
}

static void close_fd(int fd)
{
    if (fd >= 0)
        close(fd);
}

void pull_executor_set_predictor(executor *base, predictor *p)
{
    pull_executor *e = pull__enter(base);

    e->predictor = p;
    lock_release(&e->lock);
}

void pull_executor_set_check_every(executor *base, uint32_t n)
{
    pull_executor *e = pull__enter(base);

    e->check_every = n;
    lock_release(&e->lock);
}

void pull_executor_set_suspecting(executor *base, pull_suspecting *tell, void *context)
{
    pull_executor *e = pull__enter(base);

    e->suspect = tell;
    e->suspect_context = context;
    lock_release(&e->lock);
}

uint32_t pull_executor_count_cores(executor *base)
{
    pull_executor *e = pull__enter(base);
    const uint32_t n = e->n_cores_used[false] + e->n_cores_used[true];

    lock_release(&e->lock);
    return n;
}

bool pull_executor_has_worker(executor *base, const char *worker)
{
    pull_executor *e = pull__enter(base);
    bool is_known = false;

    for (size_t k = 0; k < e->n_workers; k++)
        is_known = is_known || strcmp(e->workers[k].about.name, worker) == 0;

    lock_release(&e->lock);
    return is_known;
}

executor *pull_executor_destroy(executor *base)
{
    pull_executor *e = (pull_executor *)base;

    if (e == NULL)
        return NULL;
    lock_acquire(&e->lock);
    while (!TAILQ_EMPTY(&e->jobs)) // attached, but not taken
        pull__remove_job(e, TAILQ_FIRST(&e->jobs));
    while (e->n_leases > 0)
        pull__end_lease(e, e->leases[0]);
    lock_release(&e->lock);
    close_fd(e->news_fd);
    close_fd(e->timer_fd);
    close_fd(e->base.wake_fd);
    lock_fini(&e->lock);
    memory_free(e->workers);
    memory_free(e->leases);
    memory_free(e->ends);
    memory_free(e->doubts);
    memory_free(e);
    return NULL;
}

static bf_status list(void *context, uint64_t token, api_worker_list *ret_list, bf_error *err)
{
    pull_executor *e = pull__enter(context);
    bf_status status = pull__list(e, token, ret_list, err);

    lock_release(&e->lock);
    return status;
}

api_leases pull_executor_leases(executor *e)
{
    return (api_leases){ .context = e,
                         .lease = pull__lease_jobs,
                         .read_jobs = pull__read_jobs,
                         .deliver = pull__deliver,
                         .renew = pull__renew,
                         .leave = pull__leave,
                         .list = list };
}
