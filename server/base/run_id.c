#include "server/base/run_id.h"

#include "server/base/clock.h"

#include <errno.h>
#include <inttypes.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>

enum { COUNTER_BITS = 12 };

// Milliseconds and counter of the newest id as one number, so that one compare-and-swap keeps
// order.
static _Atomic uint64_t newest;

static bf_status draw_random(void *bytes, size_t n, bf_error *err)
{
    ssize_t got = 0;

    do
        got = getrandom(bytes, n, 0);
    while (got < 0 && errno == EINTR);
    if (got != (ssize_t)n)
        return bf_fail(err, BF_ESYSTEM, "", "no random bytes for an id: %s", strerror(errno));
    return BF_OK;
}

// The time of a new id. A counter that overflows runs into the next millisecond.
static uint64_t advance(uint64_t random)
{
    // The upper half of the counter's range stays free, for the ids of the same millisecond.
    uint64_t now = (uint64_t)clock_unix_ms() << COUNTER_BITS | (random & 0x7ff);
    uint64_t before = atomic_load(&newest);
    uint64_t next;

    do
        next = now > before ? now : before + 1;
    while (!atomic_compare_exchange_weak(&newest, &before, next));
    return next;
}

bf_status run_id_make(char *ret_id, bf_error *err)
{
    uint64_t random[2];

    BF_TRY(draw_random(random, sizeof random, err));
    uint64_t time = advance(random[0]);
    uint64_t ms = time >> COUNTER_BITS;
    uint64_t tail = (random[1] & UINT64_C(0x3fffffffffffffff)) | UINT64_C(1) << 63;
    snprintf(ret_id, API_ID_SIZE,
             "%08" PRIx64 "-%04" PRIx64 "-7%03" PRIx64 "-%04" PRIx64 "-%012" PRIx64,
             ms >> 16 & 0xffffffff, ms & 0xffff, time & 0xfff, tail >> 48,
             tail & UINT64_C(0xffffffffffff));
    return BF_OK;
}
