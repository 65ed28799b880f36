#include "server/store/store_priv.h"

#include "server/base/clock.h"

static bf_status apply_probe(store__connection *writer, store__operation *operation, bf_error *err)
{
    (void)operation;
    store__query q = store__begin(writer, STORE__SQL_PROBE);
    store__bind_integer(&q, clock_unix_ms());
    return store__run(&q, err);
}

static bf_status probe(store *s, bf_error *err)
{
    uint64_t n_free = 0;

    bf_status status = store__free_bytes(s, &n_free, err);
    if (status != BF_OK)
        return status;
    if (n_free < STORE__FREE_MIN)
        return bf_fail(err, BF_ESYSTEM, "",
                       "the disk of %.150s has %llu MiB left, fewer than the %d that are needed",
                       s->directory, (unsigned long long)(n_free >> 20), STORE__FREE_MIN >> 20);
    return store__write(s, apply_probe, NULL, err);
}

bf_status store_ready(store *s, bf_error *err)
{
    bf_error error = { 0 };

    // Whoever asks often learns what the last test said; two tests at once do no harm.
    lock_take(&s->lock);
    bool is_known = clock_monotonic_ms() < s->ready.until_ms;
    bf_status status = s->ready.status;
    if (is_known)
        error = s->ready.error;
    lock_give(&s->lock);
    if (!is_known) {
        status = probe(s, &error);
        lock_take(&s->lock);
        s->ready.status = status;
        s->ready.error = error;
        s->ready.until_ms = clock_monotonic_ms() + STORE__READY_MS;
        lock_give(&s->lock);
    }
    if (status != BF_OK && err != NULL)
        *err = error;
    return status;
}
