// Workers: who there is, and what they and their leases look like to others.

#include "server/pull/pull_priv.h"

#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/solver.h"

#include <string.h>

static void count_cores(pull_executor *e)
{
    const int64_t now_ms = clock_monotonic_ms();

    e->n_cores = 0;
    for (size_t k = 0; k < e->n_workers; k++)
        if (e->workers[k].suspended_until_ms <= now_ms)
            e->n_cores += e->workers[k].about.cores;
}

pull__worker *pull__find_worker(pull_executor *e, uint64_t token, const char *name)
{
    lock_assert_held(&e->lock);
    for (size_t k = 0; k < e->n_workers; k++)
        if (e->workers[k].about.token == token && strcmp(e->workers[k].about.name, name) == 0)
            return &e->workers[k];
    return NULL;
}

bf_status pull__check_version(const char *name, const char *solver, bf_error *err)
{
    char ours[SOLVER_NAME_SIZE];

    if (strcmp(solver, solver_name(ours)) == 0)
        return BF_OK;
    return bf_fail(err, BF_ECONFLICT, "",
                   "worker %s has the solver %s, but this service has %s, and results must not "
                   "depend on who solves a run",
                   name, solver, ours);
}

bf_status pull__meet_worker(pull_executor *e, const api_worker *who, pull__worker **ret_worker,
                            bf_error *err)
{
    pull__worker *worker = pull__find_worker(e, who->token, who->name);

    BF_TRY(pull__check_version(who->name, who->solver, err));
    if (worker == NULL && e->n_workers == API_WORKERS_MAX)
        return bf_fail(err, BF_EBUSY, "", "there are %d workers, as many as may be",
                       API_WORKERS_MAX);
    if (worker == NULL) {
        worker = &e->workers[e->n_workers++];
        *worker = (pull__worker){ .n_faults = 0 };
    }
    worker->about = *who;
    worker->seen_ms = clock_monotonic_ms();
    count_cores(e);
    *ret_worker = worker;
    return BF_OK;
}

static bool has_lease(const pull_executor *e, const pull__worker *worker)
{
    for (size_t k = 0; k < e->n_leases; k++)
        if (pull__is_of(e->leases[k], worker->about.token, worker->about.name))
            return true;
    return false;
}

void pull__drop_workers(pull_executor *e, int64_t now_ms)
{
    for (size_t k = e->n_workers; k > 0; k--) {
        const pull__worker *worker = &e->workers[k - 1];
        // One that is suspended is remembered, so that it does not come back as a new one.
        if (now_ms >= worker->seen_ms + API_LEASE_EXPIRES_S * 1000 &&
            worker->suspended_until_ms <= now_ms && !has_lease(e, worker))
            e->workers[k - 1] = e->workers[--e->n_workers];
    }
    count_cores(e);
}

static size_t list_leases(const pull_executor *e, const api_worker *who, api_lease_view *ret_leases)
{
    const int64_t now_ms = clock_monotonic_ms();
    size_t n = 0;

    for (size_t k = 0; k < e->n_leases; k++) {
        const pull__lease *lease = e->leases[k];
        if (!pull__is_of(lease, who->token, who->name))
            continue;
        const int64_t silent_ms = now_ms - lease->seen_ms;
        api_lease_view view = { .n_jobs = lease->n_jobs, .n_done = lease->n_done };
        view.expires_in_s = 1e-3 * (double)(API_LEASE_EXPIRES_S * 1000 - silent_ms);
        memcpy(view.id, lease->id, sizeof view.id);
        ret_leases[n++] = view;
    }
    return n;
}

bf_status pull__list(pull_executor *e, uint64_t token, api_worker_list *ret_list, bf_error *err)
{
    api_worker_list list = { .n = 0 };
    size_t n_leases = 0;

    lock_assert_held(&e->lock);
    list.workers = memory_alloc(e->n_workers, sizeof *list.workers);
    list.leases = memory_alloc(e->n_leases, sizeof *list.leases);
    if (list.workers == NULL || list.leases == NULL) {
        api_worker_list_fini(&list);
        return bf_fail_memory(err);
    }
    for (size_t k = 0; k < e->n_workers; k++) {
        const pull__worker *worker = &e->workers[k];
        if (token != API_ANY_TOKEN && worker->about.token != token)
            continue;
        api_lease_view *leases = list.leases + n_leases;
        const size_t n = list_leases(e, &worker->about, leases);
        list.workers[list.n++] = (api_worker_view){
            .about = worker->about,
            .seen_s = 1e-3 * (double)(clock_monotonic_ms() - worker->seen_ms),
            .n_leases = n,
            .leases = leases,
        };
        n_leases += n;
    }
    *ret_list = list;
    return BF_OK;
}
