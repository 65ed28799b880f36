// Unit tests of the locks.

#include "server/base/lock.h"

#include "server/base/clock.h"
#include "tests/unit/helper_cmocka.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

enum { N_THREADS = 4, N_ROUNDS = 2000 };

/// Data common to the threads of a test.
typedef struct shared {
    lock lock;
    lock_condition changed;
    int value;
} shared;

static void init_shared(shared *s)
{
    lock_init(&s->lock);
    lock_condition_init(&s->changed);
    s->value = 0;
}

static void fini_shared(shared *s)
{
    lock_condition_fini(&s->changed);
    lock_fini(&s->lock);
}

static void *count(void *context)
{
    shared *s = context;

    for (int i = 0; i < N_ROUNDS; i++) {
        lock_acquire(&s->lock);
        lock_assert_held(&s->lock);
        s->value++;
        lock_release(&s->lock);
    }
    return NULL;
}

static void one_thread_at_a_time_holds_a_lock(void **state)
{
    pthread_t threads[N_THREADS];
    shared s;

    init_shared(&s);
    for (int i = 0; i < N_THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, count, &s), 0);
    for (int i = 0; i < N_THREADS; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    assert_int_equal(s.value, N_THREADS * N_ROUNDS);
    fini_shared(&s);
}

static void *set_and_wake(void *context)
{
    shared *s = context;

    lock_acquire(&s->lock);
    s->value = 1;
    lock_wake_all(&s->changed);
    lock_release(&s->lock);
    return NULL;
}

static void waiting_gives_the_lock_away_and_takes_it_again(void **state)
{
    pthread_t thread;
    shared s;

    init_shared(&s);
    lock_acquire(&s.lock);
    assert_int_equal(pthread_create(&thread, NULL, set_and_wake, &s), 0);
    while (s.value == 0)
        assert_true(lock_wait(&s.changed, &s.lock, -1));
    lock_assert_held(&s.lock);
    lock_release(&s.lock);
    assert_int_equal(pthread_join(thread, NULL), 0);
    fini_shared(&s);
}

static void waiting_ends_at_its_deadline(void **state)
{
    shared s;
    bool was_woken = true;

    init_shared(&s);
    lock_acquire(&s.lock);
    int64_t deadline_ms = clock_monotonic_ms() + 20;
    while (was_woken)
        was_woken = lock_wait(&s.changed, &s.lock, deadline_ms);
    assert_true(clock_monotonic_ms() >= deadline_ms);
    lock_assert_held(&s.lock);
    lock_release(&s.lock);
    fini_shared(&s);
}

static void take_twice(lock *l)
{
    lock_acquire(l);
    lock_acquire(l);
}

static void fini_held(lock *l)
{
    lock_acquire(l);
    lock_fini(l);
}

// The signal that ends a child which makes this mistake with a lock.
static int die_of(void (*mistake)(lock *))
{
    int status = 0;

    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        lock l;
        signal(SIGABRT, SIG_DFL);
        close(STDERR_FILENO);
        lock_init(&l);
        mistake(&l);
        _exit(0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

static void assert_held(lock *l)
{
    lock_assert_held(l);
}

static void mistakes_with_a_lock_stop_the_process(void **state)
{
    assert_int_equal(die_of(take_twice), SIGABRT);
    assert_int_equal(die_of(lock_release), SIGABRT);
    assert_int_equal(die_of(assert_held), SIGABRT);
    assert_int_equal(die_of(fini_held), SIGABRT);
}

static void the_clocks_agree_with_each_other(void **state)
{
    int64_t before_ms = clock_monotonic_ms();
    double now_s = clock_monotonic_s();
    int64_t after_ms = clock_monotonic_ms();

    // Milliseconds are cut off, not rounded.
    assert_true(now_s * 1000.0 >= (double)before_ms);
    assert_true(now_s * 1000.0 < (double)(after_ms + 1));
    // 2020-01-01 as a Unix time: any clock that is set shows more.
    assert_true(clock_unix_ms() > INT64_C(1577836800000));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_thread_at_a_time_holds_a_lock),
        cmocka_unit_test(waiting_gives_the_lock_away_and_takes_it_again),
        cmocka_unit_test(waiting_ends_at_its_deadline),
        cmocka_unit_test(mistakes_with_a_lock_stop_the_process),
        cmocka_unit_test(the_clocks_agree_with_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
