/// Signs of life of a thread: the watchdog asks, and the thread answers in its next turn. A thread that hangs
/// does not. Without a watchdog no thread is woken for it.
///
/// Threads  any. Whoever asks also wakes the thread, in the thread's own way.

#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/// The pulse of one thread, or of a group of which one must live. Zero-initialise.
typedef struct pulse {
    _Atomic uint64_t n_asked;    ///< questions
    _Atomic uint64_t n_answered; ///< the last of them that was answered
} pulse;

/// Ask.
static inline void pulse_ask(pulse *p)
{
    (void)atomic_fetch_add(&p->n_asked, 1);
}

/// True if there is something to be answered.
static inline bool pulse_is_asked(const pulse *p)
{
    return atomic_load(&p->n_answered) != atomic_load(&p->n_asked);
}

/// Answer all that was asked.
static inline void pulse_answer(pulse *p)
{
    atomic_store(&p->n_answered, atomic_load(&p->n_asked));
}
