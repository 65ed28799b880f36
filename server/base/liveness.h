/// Checks whether a thread is alive: another thread asks, and the thread answers in its next turn. One that
/// hangs does not. A thread does not answer unasked, so an idle one sleeps.
///
/// Threads  any. Who asks also wakes the thread, in the thread's own way.

#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/// Questions to one thread, or to a group of which one must live. Zero-initialise.
typedef struct liveness {
    _Atomic uint64_t n_asked;    ///< questions
    _Atomic uint64_t n_answered; ///< the last of them that was answered
} liveness;

/// Ask.
static inline void liveness_ask(liveness *l)
{
    (void)atomic_fetch_add(&l->n_asked, 1);
}

/// True if there is a question without an answer.
static inline bool liveness_is_asked(const liveness *l)
{
    return atomic_load(&l->n_answered) != atomic_load(&l->n_asked);
}

/// Answer all questions.
static inline void liveness_answer(liveness *l)
{
    atomic_store(&l->n_answered, atomic_load(&l->n_asked));
}
