/// Liveness of threads: another thread sends a probe, and the thread answers it in its next turn; a thread that
/// hangs does not. Without a probe there is nothing to answer, so an idle thread sleeps.
///
/// Threads  any. The prober must also wake the thread.

#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/// Probes of one thread, or of a group of which one must answer. Zero-initialise.
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
