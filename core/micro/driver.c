#include "core/micro/driver.h"

// The work of a team; the members after n_wanted are written by its first thread.
typedef struct team_task {
    const driver_solver *solver;
    void *state;
    uint64_t n_wanted;
    uint64_t n_made;
    driver_outcome outcome;
    driver_progress progress; // before the first step, then after the last
} team_task;

void driver_split(const driver_member *m, size_t first, size_t last, driver_work *work)
{
    for (size_t item = first + (size_t)m->index; item < last; item += (size_t)m->n_members)
        work(m, item);
}

void driver_split_groups(const driver_member *m, const size_t *first, size_t n_groups, size_t slice,
                         driver_work *work)
{
    bool is_alone = true;

    for (size_t g = 0; g < n_groups; g++) {
        const size_t n = first[g + 1] - first[g];
        const bool is_short = n <= slice || g + 1 == n_groups;
        const size_t step = is_short ? n : slice;
        if (n == 0)
            continue;
        if (!is_alone || !is_short)
            driver_wait(m);
        is_alone = is_short;
        for (size_t k = (size_t)m->index * step; k < n; k += (size_t)m->n_members * step)
            for (size_t at = k; at < k + step && at < n; at++)
                work(m, first[g] + at);
    }
    driver_wait(m);
}

static void make_steps(void *context, int index, int n_members, team_barrier *barrier)
{
    team_task *task = context;
    driver_outcome outcome = DRIVER_MADE;
    driver_member m = { .state = task->state,
                        .index = index,
                        .n_members = n_members,
                        .barrier = barrier,
                        .progress = task->progress };

    while (m.n_made < task->n_wanted && outcome == DRIVER_MADE) {
        outcome = task->solver->step(&m);
        m.n_made += outcome != DRIVER_NOT_MADE;
    }
    if (index != 0)
        return;
    task->n_made = m.n_made;
    task->outcome = outcome;
    task->progress = m.progress;
}

bf_status driver_advance(const driver_solver *solver, void *state, uint64_t n, bf_error *err)
{
    bf_status status = BF_OK;

    while (n > 0) {
        bool is_suspect = false;
        uint64_t n_made = 0, n_most = n;
        if ((status = solver->refresh(state, err)) != BF_OK)
            return status;
        if (solver->advance_tile != NULL)
            n_made = solver->advance_tile(state, n, &n_most, &is_suspect);
        if (n_made == 0) {
            team_task task = { .solver = solver, .state = state, .n_wanted = n_most };
            const int n_threads = solver->begin(state, &task.progress);
            team_run(n_threads, make_steps, &task);
            solver->end(state, task.n_made, task.outcome, &task.progress);
            is_suspect = task.outcome == DRIVER_SUSPECT;
            n_made = task.n_made;
        }
        n -= n_made;
        if (is_suspect && (status = solver->check(state, err)) != BF_OK)
            return status;
    }
    return status;
}
