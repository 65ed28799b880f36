// Runs that are solved twice, by workers of two tokens, as a worker may send whole frames with wrong results. What the second
// one sends is compared and dropped; where the two differ the run's results are suspect, and a third one says who is at fault:
// then all is suspect that was sent with its token, as a worker's name is only what it says itself.
//
// Compared is what does not depend on when it was sent: samples, snapshots, parts, changes, and the end.

#include "server/pull/pull_priv.h"

#include "core/base/memory.h"
#include "core/observe/frame.h"
#include "server/base/clock.h"
#include "server/base/log.h"

#include <sodium.h>
#include <string.h>

enum {
    CHECKS_MAX = 16,               // at a time: each keeps the input of its run
    FRAME_BYTES_MAX = 1024 * 1024, // of a frame that is compared
    PATIENCE = 4,                  // the second one may take so many times as long as the first
};

typedef struct digest {
    unsigned char bytes[crypto_generichash_BYTES];
} digest;

// Who has solved the run, and what came of it.
typedef struct witness {
    uint64_t token;
    char worker[API_WORKER_SIZE];
    digest results;
} witness;

struct pull__check {
    bf_buffer bytes;    // of a frame that has not come whole
    uint64_t n_skipped; // bytes that are still to come of a frame that is not compared
    digest digests[FRAME_TYPE_COUNT]; // of what was compared, by type
    bool has_ended;                   // FRAME_END has come
    bool is_damaged;                  // the supervisor finds out what is wrong with it
    size_t n_witnesses;               // who have solved it before
    witness witnesses[2];             // them
    int64_t until_ms;                 // of a repetition: then it is given up
};

static bool is_compared(frame_type type)
{
    return type == FRAME_CURVE || type == FRAME_SNAPSHOT || type == FRAME_PARTS ||
           type == FRAME_SLICE || type == FRAME_CHANGE || type == FRAME_END;
}

// A chain of BLAKE2b, as who lies would find other bytes with the digest of frames.
static void add(digest *d, const void *bytes, size_t n)
{
    const digest before = *d;

    (void)crypto_generichash(d->bytes, sizeof d->bytes, bytes, n, before.bytes,
                             sizeof before.bytes);
}

// A whole frame: samples come in any number at once, other frames as they are.
static void note_frame(pull__check *c, const char *bytes, size_t n)
{
    frame f;
    size_t used;

    if (frame_decode(bytes, n, &f, &used, NULL) != BF_OK || used != n) {
        c->is_damaged = true;
        return;
    }
    digest *d = &c->digests[f.type];
    if (f.type != FRAME_CURVE)
        add(d, bytes, n);
    for (uint32_t k = 0; f.type == FRAME_CURVE && k < f.curve.n; k++) {
        add(d, &f.curve.t[k], sizeof f.curve.t[k]);
        add(d, f.curve.values + (size_t)k * f.curve.n_columns,
            f.curve.n_columns * sizeof *f.curve.values);
    }
    c->has_ended |= f.type == FRAME_END;
}

// The frame at the start of n bytes; how many of them are done with. 0: more must come.
static size_t parse_frame(pull__check *c, const char *bytes, size_t n)
{
    frame_type type = FRAME_TYPE_COUNT;

    if (n < FRAME_HEADER_BYTES)
        return 0;
    const uint64_t length = frame_length(bytes, n, &type);
    c->is_damaged |= length == 0 || (is_compared(type) && length > FRAME_BYTES_MAX);
    if (c->is_damaged || (is_compared(type) && length > n))
        return 0;
    if (is_compared(type))
        note_frame(c, bytes, (size_t)length);
    else if (length > n)
        c->n_skipped = length - n;
    return length > n ? n : (size_t)length;
}

void pull__check_bytes(pull__check *c, const char *bytes, size_t n)
{
    size_t at = 0;

    if (c == NULL || c->is_damaged)
        return;
    const size_t n_skipped = c->n_skipped < n ? (size_t)c->n_skipped : n;
    c->n_skipped -= n_skipped;
    c->is_damaged = buffer_append(&c->bytes, bytes + n_skipped, n - n_skipped) != BF_OK;
    for (size_t used = 1; used > 0 && !c->is_damaged && at < c->bytes.n; at += used)
        used = parse_frame(c, c->bytes.bytes + at, c->bytes.n - at);
    buffer_drop(&c->bytes, at);
}

pull__check *pull__check_destroy(pull__check *c)
{
    if (c != NULL)
        buffer_fini(&c->bytes);
    memory_free(c);
    return NULL;
}

pull__check *pull__choose_check(const pull_executor *e)
{
    const executor_job *job;
    size_t n = 0;

    lock_assert_held(&e->lock);
    if (e->check_every == 0 || randombytes_uniform(e->check_every) != 0)
        return NULL;
    TAILQ_FOREACH(job, &e->jobs, entry)
        n += job->check != NULL;
    return n < CHECKS_MAX ? memory_alloc(1, sizeof(pull__check)) : NULL;
}

bool pull__is_witness(const pull__check *c, uint64_t token)
{
    for (size_t k = 0; k < c->n_witnesses; k++)
        if (c->witnesses[k].token == token)
            return true;
    return false;
}

// The run of a job once more, by somebody who has not solved it yet, where there is one.
static void repeat(pull_executor *e, executor_job *job)
{
    const int64_t now_ms = clock_monotonic_ms();
    pull__check *c = job->check;
    executor_job *again = NULL;
    bool has_other = false;

    for (size_t k = 0; k < e->n_workers; k++)
        has_other = has_other || (e->workers[k].suspended_until_ms <= now_ms &&
                                  !pull__is_witness(c, e->workers[k].about.token));
    if (has_other)
        again = pull__add_job(e, PULL_WAITING, job->about.run, ++e->last_attempt);
    if (again == NULL)
        return;
    const uint64_t attempt = again->about.attempt;
    again->about = job->about;
    again->about.attempt = attempt;
    again->is_repetition = true;
    again->input = job->input;
    again->check = c;
    job->input = (bf_buffer){ 0 };
    job->check = NULL;
    buffer_drop(&c->bytes, c->bytes.n);
    memset(c->digests, 0, sizeof c->digests);
    c->has_ended = false;
    c->until_ms = now_ms + PULL_OTHERS_FIRST_MS + PATIENCE * (now_ms - job->leased_ms);
    e->n_cores_used[again->about.is_trial] += again->about.n_threads;
    pull__wake(e);
}

static bool is_equal(const witness *a, const witness *b)
{
    return memcmp(&a->results, &b->results, sizeof a->results) == 0;
}

static void suspect(const pull_executor *e, const char *run_id, uint64_t token)
{
    if (e->suspect != NULL)
        e->suspect(e->suspect_context, run_id, token);
}

void pull__check_end(pull_executor *e, executor_job *job)
{
    pull__check *c = job->check;
    size_t n_equal = 0;

    lock_assert_held(&e->lock);
    if (c == NULL || !c->has_ended || c->is_damaged || job->stop != API_JOB_GO_ON)
        return;
    witness now = { .token = job->token };
    add(&now.results, c->digests, sizeof c->digests);
    memcpy(now.worker, job->worker, sizeof now.worker);
    for (size_t k = 0; k < c->n_witnesses; k++) {
        if (is_equal(&c->witnesses[k], &now))
            n_equal++;
        else {
            const witness *before = &c->witnesses[k];
            char digests[2][2 * sizeof now.results + 1];
            sodium_bin2hex(digests[0], sizeof digests[0], now.results.bytes, sizeof now.results);
            sodium_bin2hex(digests[1], sizeof digests[1], before->results.bytes,
                           sizeof before->results);
            log_event(LOG_LEVEL_ERROR, "duplicate_unequal",
                      "run=%s worker=%s digest=%.16s first_worker=%s first_digest=%.16s",
                      job->about.run, now.worker, digests[0], before->worker, digests[1]);
        }
    }
    if (job->is_repetition)
        metrics_add(METRICS_PULL_DUPLICATES,
                    n_equal > 0 ? METRICS_MATCH_EQUAL : METRICS_MATCH_UNEQUAL, 1);
    for (size_t k = 0; k < c->n_witnesses && n_equal > 0; k++) {
        const witness *other = &c->witnesses[k];
        if (is_equal(other, &now))
            continue;
        pull__attribute_fault(e, job->about.run, other->token, other->worker,
                              "two others have the same results, and it has other ones");
        suspect(e, NULL, other->token);
    }
    if (n_equal == 0 && c->n_witnesses > 0)
        suspect(e, job->about.run, 0);
    if (n_equal > 0 || c->n_witnesses == sizeof c->witnesses / sizeof *c->witnesses)
        return;
    c->witnesses[c->n_witnesses++] = now;
    repeat(e, job);
}

void pull__drop_repetitions(pull_executor *e, int64_t now_ms)
{
    lock_assert_held(&e->lock);
    for (executor_job *job = TAILQ_FIRST(&e->jobs), *next; job != NULL; job = next) {
        const bool is_over = job->place == PULL_ENDED || job->place == PULL_LOST;
        next = TAILQ_NEXT(job, entry);
        if (job->is_repetition && (is_over || now_ms >= job->check->until_ms))
            pull__remove_job(e, job);
    }
}
