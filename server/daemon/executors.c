#include "server/daemon/executors.h"

#include "server/base/cores.h"
#include "server/pull/pull_executor.h"
#include "server/run/confinement.h"
#include "server/run/local_executor.h"
#include "server/run/supervisor.h"
#include "server/store/work.h"

bf_status executors_create(executors *e, const config *c, bf_error *err)
{
    e->kind = config_find_executor(c);
    if (e->kind == CONFIG_LOCAL) {
        confinement_report();
        return local_executor_create(c->program, &e->executor, err);
    }
    BF_TRY(pull_executor_create(&e->executor, err));
    pull_executor_set_check_every(e->executor, (uint32_t)c->check_every);
    e->leases = pull_executor_leases(e->executor);
    return BF_OK;
}

static void suspect(void *context, const char *run_id, uint64_t token)
{
    store_begin_suspecting(context, run_id, token);
}

bf_status executors_start(executors *e, const config *c, store *s, bf_error *err)
{
    const slurm_options options = { .settings = executors_slurm_settings(c),
                                    .pull = e->executor,
                                    .store = s,
                                    .n_threads = c->threads };

    if (e->kind != CONFIG_LOCAL)
        pull_executor_set_suspecting(e->executor, suspect, s);
    return e->kind == CONFIG_SLURM ? slurm_start(&options, &e->slurm, err) : BF_OK;
}

void executors_set_predictor(executors *e, predictor *p)
{
    if (e->kind != CONFIG_LOCAL)
        pull_executor_set_predictor(e->executor, p);
}

void executors_stop(executors *e)
{
    e->slurm = slurm_stop(e->slurm);
}

void executors_destroy(executors *e)
{
    e->executor = e->kind == CONFIG_LOCAL ? local_executor_destroy(e->executor)
                                          : pull_executor_destroy(e->executor);
}

unsigned executors_count_workers(const config *c)
{
    const unsigned n = cores_count();

    if (config_find_executor(c) != CONFIG_LOCAL)
        return SUPERVISOR_WORKERS_MAX; // for studies: the executor knows how many there are
    if (c->workers > 0)
        return (unsigned)c->workers;
    return n > SUPERVISOR_WORKERS_MAX ? SUPERVISOR_WORKERS_MAX : n;
}

slurm_settings executors_slurm_settings(const config *c)
{
    return (slurm_settings){ .url = c->slurm_url,
                             .token_file = c->slurm_token_file,
                             .program = c->slurm_program,
                             .template_file = c->slurm_template,
                             .n_workers_max = c->slurm_workers,
                             .cores = c->slurm_cores,
                             .walltime_s = c->slurm_walltime_s,
                             .idle_s = c->slurm_idle_s,
                             .interval_s = c->slurm_interval_s };
}
