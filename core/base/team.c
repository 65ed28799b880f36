#include "core/base/team.h"

#include <limits.h>
#include <linux/futex.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/syscall.h>
#include <unistd.h>

enum {
    SPINS = 2000,            // turns of a waiting loop before it lets others run
    TURNS_AWAKE = 2 * SPINS, // turns before a waiting thread sleeps
    WORKERS_MAX = TEAM_MEMBERS_MAX - 1,
};

struct team_barrier {
    int n_members;
    int n_turns_awake; // turns before a thread that waits sleeps
    _Alignas(64) atomic_int n_here;
    _Alignas(64) atomic_uint round; ///< also the futex of the sleepers
    atomic_int n_asleep;
};

/// The state of a worker. The worker itself leaves BUSY and AWAITED, the caller leaves IDLE and ASLEEP.
enum { IDLE, ASLEEP, BUSY, AWAITED };

/// A thread of the process's set. The call that took it writes the work and then BUSY to `state`.
typedef struct worker {
    _Alignas(64) atomic_uint
        state; ///< also the futex of the sleeper: the worker when ASLEEP, the caller when AWAITED
    struct worker *next;   ///< in the list of idle workers, or of the call that took it
    team_member *body;     ///< the work
    void *context;         ///< of the work
    int member;            ///< of the work
    team_barrier *barrier; ///< of the work
} worker;

static struct {
    pthread_mutex_t lock; ///< of all members but `workers`
    worker *idle;         ///< last in, first out, so that a solver gets the same threads again
    int n_started;
    worker workers[WORKERS_MAX];
} set = { .lock = PTHREAD_MUTEX_INITIALIZER };

void team_spin_wait(int n_turns)
{
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
    if (n_turns > SPINS)
        (void)sched_yield();
}

/// Return when *state is no longer `now`: spin for some turns, then set it to `sleeping` and sleep. Returns what it is.
static unsigned wait_while(atomic_uint *state, unsigned now, unsigned sleeping, int n_turns)
{
    unsigned value = now;

    for (int k = 1; k <= n_turns; k++) {
        if ((value = atomic_load_explicit(state, memory_order_acquire)) != now)
            return value;
        team_spin_wait(k);
    }
    if (!atomic_compare_exchange_strong(state, &value, sleeping))
        return value;
    while ((value = atomic_load_explicit(state, memory_order_acquire)) == sleeping)
        (void)syscall(SYS_futex, state, FUTEX_WAIT_PRIVATE, sleeping, NULL, NULL, 0);
    return value;
}

/// Set *state to `value` and wake the thread that sleeps if it was `sleeping`.
static void set_state(atomic_uint *state, unsigned value, unsigned sleeping)
{
    if (atomic_exchange(state, value) == sleeping)
        (void)syscall(SYS_futex, state, FUTEX_WAKE_PRIVATE, 1, NULL, NULL, 0);
}

static void *work(void *context)
{
    worker *w = context;
    int n_turns = TURNS_AWAKE;

    for (;;) {
        (void)wait_while(&w->state, IDLE, ASLEEP, n_turns);
        w->body(w->context, w->member, w->barrier->n_members, w->barrier);
        n_turns = w->barrier->n_turns_awake;
        set_state(&w->state, IDLE, AWAITED);
    }
    return NULL;
}

/// Start the next worker of the set, or NULL. The set is locked.
static worker *start_worker(void)
{
    sigset_t all, before;
    pthread_t thread;

    if (set.n_started == WORKERS_MAX)
        return NULL;
    worker *w = &set.workers[set.n_started];
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    const bool is_started = pthread_create(&thread, NULL, work, w) == 0;
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (!is_started)
        return NULL;
    (void)pthread_detach(thread);
    set.n_started++;
    return w;
}

/// Take up to n workers, as a list. Returns how many.
static int take_workers(int n, worker **ret_first)
{
    worker **end = ret_first;
    int n_taken = 0;

    (void)pthread_mutex_lock(&set.lock);
    for (worker *w; n_taken < n; n_taken++, end = &w->next) {
        if ((w = set.idle) != NULL)
            set.idle = w->next;
        else if ((w = start_worker()) == NULL)
            break;
        *end = w;
    }
    *end = NULL;
    (void)pthread_mutex_unlock(&set.lock);
    return n_taken;
}

static void return_workers(worker *first)
{
    worker *last = first;

    if (first == NULL)
        return;
    while (last->next != NULL)
        last = last->next;
    (void)pthread_mutex_lock(&set.lock);
    last->next = set.idle;
    set.idle = first;
    (void)pthread_mutex_unlock(&set.lock);
}

void team_run(int n_threads, team_member *body, void *context)
{
    const int n_others = (n_threads < TEAM_MEMBERS_MAX ? n_threads : TEAM_MEMBERS_MAX) - 1;
    worker *first = NULL;
    int member = 0;

    team_barrier barrier = { .n_members = 1 + take_workers(n_others, &first) };
    // Who spins where members share processors takes the time of those that it waits for.
    const bool is_crowded = barrier.n_members > 1 && barrier.n_members > team_processors();
    const int n_turns = barrier.n_turns_awake = is_crowded ? 0 : TURNS_AWAKE;
    for (worker *w = first; w != NULL; w = w->next) {
        w->body = body;
        w->context = context;
        w->member = ++member;
        w->barrier = &barrier;
        set_state(&w->state, BUSY, ASLEEP);
    }
    body(context, 0, barrier.n_members, &barrier);
    for (worker *w = first; w != NULL; w = w->next)
        (void)wait_while(&w->state, BUSY, AWAITED, n_turns);
    return_workers(first);
}

void team_barrier_wait(team_barrier *barrier)
{
    if (barrier->n_members == 1)
        return;
    unsigned round = atomic_load_explicit(&barrier->round, memory_order_relaxed);
    if (atomic_fetch_add_explicit(&barrier->n_here, 1, memory_order_acq_rel) + 1 ==
        barrier->n_members) {
        atomic_store_explicit(&barrier->n_here, 0, memory_order_relaxed);
        // Either this sees a sleeper, or who is about to sleep sees the next round.
        atomic_store(&barrier->round, round + 1);
        if (atomic_load(&barrier->n_asleep) > 0)
            (void)syscall(SYS_futex, &barrier->round, FUTEX_WAKE_PRIVATE, INT_MAX, NULL, NULL, 0);
        return;
    }
    for (int k = 1; k <= barrier->n_turns_awake; k++) {
        if (atomic_load_explicit(&barrier->round, memory_order_acquire) != round)
            return;
        team_spin_wait(k);
    }
    atomic_fetch_add(&barrier->n_asleep, 1);
    while (atomic_load(&barrier->round) == round)
        (void)syscall(SYS_futex, &barrier->round, FUTEX_WAIT_PRIVATE, round, NULL, NULL, 0);
    atomic_fetch_sub(&barrier->n_asleep, 1);
}

/// A loop: member m does the items m, m + n_members, m + 2 n_members, ...
typedef struct loop {
    size_t n_items;
    team_body *body;
    void *context;
} loop;

static void run_items(void *context, int member, int n_members, team_barrier *barrier)
{
    const loop *l = context;

    (void)barrier;
    for (size_t item = (size_t)member; item < l->n_items; item += (size_t)n_members)
        l->body(l->context, item);
}

void team_for(int n_threads, size_t n_items, team_body *body, void *context)
{
    loop l = { .n_items = n_items, .body = body, .context = context };

    if (n_items < INT_MAX && (int)n_items < n_threads)
        n_threads = (int)n_items;
    team_run(n_threads, run_items, &l);
}

int team_processors(void)
{
    cpu_set_t mine;

    if (sched_getaffinity(0, sizeof mine, &mine) == 0)
        return CPU_COUNT(&mine);
    const long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n > 0 ? (int)n : 1;
}
