/// Mutex and condition that record their owner; no other file uses pthread mutexes.

#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

/// A mutex with its owner.
typedef struct lock {
    pthread_mutex_t mutex; ///< error-checking
    pthread_t owner;       ///< valid while is_held
    bool is_held;          ///< written under mutex
} lock;

/// A condition on CLOCK_MONOTONIC.
typedef struct lock_condition {
    pthread_cond_t condition; ///< waits with the lock that is named in each call
} lock_condition;

/// Ready for use, free; lock_fini() before its storage goes.
void lock_init(lock *l);
void lock_fini(lock *l);

/// Wait until it is free and hold it; release it. The owner must not acquire it again.
void lock_acquire(lock *l);
void lock_release(lock *l);

/// Assert that this thread holds the lock.
void lock_assert_held(const lock *l);

/// Ready for use; lock_condition_fini() before its storage goes.
void lock_condition_init(lock_condition *c);
void lock_condition_fini(lock_condition *c);

/// Wake every thread that waits on the condition.
void lock_wake_all(lock_condition *c);

/// Wake one thread that waits on the condition, for what any one of them can do.
void lock_wake_one(lock_condition *c);

/// Wait with the lock held; false if deadline_ms (clock_monotonic_ms(), or -1: none) passed.
bool lock_wait(lock_condition *c, lock *l, int64_t deadline_ms);
