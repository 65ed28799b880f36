#include "core/base/team.h"

#include <sched.h>
#include <stdatomic.h>

#ifdef _OPENMP
#include <omp.h>
#endif

enum { SPINS = 2000 }; // before a waiting thread lets others run

void team_for(int n_threads, size_t n_items, team_body *body, void *context)
{
    if (n_threads <= 1 || n_items <= 1) {
        for (size_t item = 0; item < n_items; item++)
            body(context, item);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for num_threads(n_threads) schedule(static, 1)
#endif
    for (size_t item = 0; item < n_items; item++)
        body(context, item);
}

int team_processors(void)
{
#ifdef _OPENMP
    return omp_get_num_procs();
#else
    return 1;
#endif
}

struct team_gate {
    int n_members;
    _Alignas(64) atomic_int n_here;
    _Alignas(64) atomic_uint round;
};

void team_run(int n_threads, team_member *body, void *context)
{
    team_gate gate = { .n_members = 1 };

    if (n_threads <= 1) {
        body(context, 0, 1, &gate);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel num_threads(n_threads)
    {
#pragma omp single
        gate.n_members = omp_get_num_threads();
        body(context, omp_get_thread_num(), gate.n_members, &gate);
    }
#else
    body(context, 0, 1, &gate);
#endif
}

void team_relax(int n_waits)
{
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
    if (n_waits > SPINS)
        (void)sched_yield();
}

void team_wait(team_gate *gate)
{
    if (gate->n_members == 1)
        return;
    unsigned round = atomic_load_explicit(&gate->round, memory_order_relaxed);
    if (atomic_fetch_add_explicit(&gate->n_here, 1, memory_order_acq_rel) + 1 == gate->n_members) {
        atomic_store_explicit(&gate->n_here, 0, memory_order_relaxed);
        atomic_store_explicit(&gate->round, round + 1, memory_order_release);
        return;
    }
    for (int k = 1; atomic_load_explicit(&gate->round, memory_order_acquire) == round; k++)
        team_relax(k);
}
