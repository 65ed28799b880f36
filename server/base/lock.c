#include "server/base/lock.h"

#include "core/base/check.h"

#include <errno.h>
#include <time.h>

void lock_init(lock *l)
{
    pthread_mutexattr_t attributes;

    BF_CHECK(pthread_mutexattr_init(&attributes) == 0);
    BF_CHECK(pthread_mutexattr_settype(&attributes, PTHREAD_MUTEX_ERRORCHECK) == 0);
    BF_CHECK(pthread_mutex_init(&l->mutex, &attributes) == 0);
    pthread_mutexattr_destroy(&attributes);
    l->is_held = false;
}

void lock_fini(lock *l)
{
    BF_CHECK(!l->is_held);
    BF_CHECK(pthread_mutex_destroy(&l->mutex) == 0);
}

static void note_owner(lock *l)
{
    l->owner = pthread_self();
    l->is_held = true;
}

void lock_acquire(lock *l)
{
    BF_CHECK(pthread_mutex_lock(&l->mutex) == 0);
    note_owner(l);
}

void lock_release(lock *l)
{
    lock_assert_held(l);
    l->is_held = false;
    BF_CHECK(pthread_mutex_unlock(&l->mutex) == 0);
}

void lock_assert_held(const lock *l)
{
    BF_CHECK(l->is_held && pthread_equal(l->owner, pthread_self()));
}

void lock_condition_init(lock_condition *c)
{
    pthread_condattr_t attributes;

    BF_CHECK(pthread_condattr_init(&attributes) == 0);
    BF_CHECK(pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC) == 0);
    BF_CHECK(pthread_cond_init(&c->condition, &attributes) == 0);
    pthread_condattr_destroy(&attributes);
}

void lock_condition_fini(lock_condition *c)
{
    BF_CHECK(pthread_cond_destroy(&c->condition) == 0);
}

void lock_wake_all(lock_condition *c)
{
    BF_CHECK(pthread_cond_broadcast(&c->condition) == 0);
}

void lock_wake_one(lock_condition *c)
{
    BF_CHECK(pthread_cond_signal(&c->condition) == 0);
}

bool lock_wait(lock_condition *c, lock *l, int64_t deadline_ms)
{
    int code;

    lock_assert_held(l);
    l->is_held = false;
    if (deadline_ms < 0) {
        code = pthread_cond_wait(&c->condition, &l->mutex);
    } else {
        struct timespec deadline = { .tv_sec = (time_t)(deadline_ms / 1000),
                                     .tv_nsec = (long)(deadline_ms % 1000) * 1000000 };
        code = pthread_cond_timedwait(&c->condition, &l->mutex, &deadline);
    }
    BF_CHECK(code == 0 || code == ETIMEDOUT);
    note_owner(l);
    return code == 0;
}
