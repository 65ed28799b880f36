// The loop of a worker: signals, its lifetime, children, and the exchange that goes on.

#include "server/worker/pull_worker.h"

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/run/local_executor.h"
#include "server/worker/worker_priv.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/signalfd.h>
#include <unistd.h>

enum {
    TURN_MS = 100, // while there is work: frames are sent and leases renewed to this accuracy
    IDLE_TURN_MS = 1000,
    LAST_WORK_S = 300,  // before the end of its lifetime nothing more is leased
    STAGGER_MS = 60000, // so that workers that were started together do not all end together
};

// Of the lifetime; INT64_MAX: there is none.
typedef struct term {
    int64_t last_lease_ms;
    int64_t end_ms;
} term;

static term find_term(const pull_worker_options *o, int64_t now)
{
    const int64_t life_ms = (int64_t)o->lifetime_s * 1000;
    const int64_t last_ms = life_ms < 2000 * LAST_WORK_S ? life_ms / 2 : 1000 * LAST_WORK_S;
    const int64_t most_ms = life_ms / 10 < STAGGER_MS ? life_ms / 10 : STAGGER_MS;
    uint32_t hash = 2166136261U; // FNV-1a

    if (life_ms == 0)
        return (term){ .last_lease_ms = INT64_MAX, .end_ms = INT64_MAX };
    for (const char *at = o->who.name; *at != '\0'; at++)
        hash = (hash ^ (unsigned char)*at) * 16777619U;
    const int64_t end_ms = now + life_ms - (int64_t)(hash % 1000U) * most_ms / 1000;
    return (term){ .last_lease_ms = end_ms - last_ms, .end_ms = end_ms };
}

static bf_status open_signals(int *ret_fd, bf_error *err)
{
    sigset_t set;

    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    signal(SIGPIPE, SIG_IGN);
    if (sigprocmask(SIG_BLOCK, &set, NULL) == 0)
        *ret_fd = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
    return *ret_fd >= 0
               ? BF_OK
               : bf_fail(err, BF_ESYSTEM, "", "signals cannot be waited for: %s", strerror(errno));
}

static int find_timeout(const worker *w, int64_t now)
{
    const int64_t next_ms = w->ask_ms > w->retry_ms ? w->ask_ms : w->retry_ms;

    if (!worker__is_idle(w))
        return TURN_MS;
    if (next_ms <= now || next_ms - now >= IDLE_TURN_MS)
        return IDLE_TURN_MS;
    return (int)(next_ms - now);
}

static void work(worker *w, int signals)
{
    const int fds[] = { signals, w->solver->wake_fd };
    const term t = find_term(w->options, clock_monotonic_ms());

    w->busy_ms = clock_monotonic_ms();
    for (;;) {
        const int64_t now = clock_monotonic_ms();
        struct signalfd_siginfo info;
        while (read(signals, &info, sizeof info) == (ssize_t)sizeof info) {
            log_event(LOG_LEVEL_INFO, "stopping", "signal=%" PRIu32, info.ssi_signo);
            w->must_end = w->must_end || w->is_draining;
            worker__drain(w);
        }
        const int64_t idle_ms = (int64_t)w->options->idle_s * 1000;
        if (!worker__is_idle(w))
            w->busy_ms = now;
        if (now >= t.last_lease_ms || (idle_ms > 0 && now - w->busy_ms >= idle_ms))
            w->is_leaving = true;
        if (now >= t.end_ms)
            worker__drain(w);
        if (w->is_draining && now >= w->end_ms)
            w->must_end = true;
        worker__start_jobs(w);
        worker__ask(w, now);
        const bool has_request = w->request != WORKER_REQUEST_NONE;
        if (w->must_end || (w->is_leaving && !has_request && worker__is_idle(w)))
            return;
        const http_call_answer answer =
            http_call_wait(w->call, fds, sizeof fds / sizeof *fds, find_timeout(w, now));
        worker__collect(w);
        if (answer.has_ended)
            worker__take_answer(w, &answer, clock_monotonic_ms());
    }
}

bf_status pull_worker_run(const pull_worker_options *options, bf_error *err)
{
    static worker w; // some tens of kilobytes
    int signals = -1;

    w = (worker){ .options = options };
    const http_call_options service = { .url = options->url,
                                        .token = options->token,
                                        .ca_file = options->ca_file };
    bf_status status = open_signals(&signals, err);
    if (status == BF_OK)
        status = http_call_create(&service, &w.call, err);
    if (status == BF_OK)
        status = local_executor_create(options->program, &w.solver, err);
    if (status == BF_OK) {
        log_event(LOG_LEVEL_INFO, "worker_started", "worker=%s cores=%" PRIu32, options->who.name,
                  options->who.cores);
        work(&w, signals);
        log_event(LOG_LEVEL_INFO, "worker_ended", "worker=%s", options->who.name);
    }
    for (size_t l = 0; l < WORKER_LEASES; l++)
        if (w.leases[l].id[0] != '\0')
            worker__end_lease(&w, &w.leases[l]);
    local_executor_destroy(w.solver);
    http_call_destroy(w.call);
    buffer_fini(&w.body);
    if (signals >= 0)
        close(signals);
    if (w.has_failed && err != NULL)
        *err = w.error;
    return w.has_failed ? w.error.code : status;
}
