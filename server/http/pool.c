// Request threads: requests that may wait for the disk are handled here, so that the epoll threads
// never wait. A queued request is the pool's alone: its connection is suspended, so MHD calls
// nothing for it, until MHD_resume_connection(), after which the pool does not touch it any more.
// The queue is bounded: what does not fit is refused at once. Requests that waited come back to it
// beyond that bound, and so do those whose responses are being sent (http_download.c); both have limits
// of their own.

#include "server/http/http_priv.h"

#include "core/base/check.h"
#include "core/base/memory.h"

#include <microhttpd.h>

struct http_pool {
    lock lock;              // guards the queue
    lock_condition changed; // something was queued, or the end
    http_request *first;    // queue, oldest first
    http_request *last;     // its end
    unsigned n_waiting;     // requests in it
    unsigned n_max;         // at most
    bool is_stopping;       // nothing more is queued
    pulse pulse;            // of the threads: one must live
    unsigned n_threads;     // started
    pthread_t threads[];    // they
};

// The oldest request, waiting for one. NULL: the pool ends and the queue is empty.
static http_request *take(http_pool *p)
{
    lock_take(&p->lock);
    pulse_answer(&p->pulse);
    while (p->first == NULL && !p->is_stopping) {
        (void)lock_wait(&p->changed, &p->lock, -1);
        pulse_answer(&p->pulse);
    }
    http_request *r = p->first;
    if (r != NULL) {
        p->first = r->next;
        p->n_waiting -= r->stage == HTTP_STAGE_WORKING;
    }
    lock_give(&p->lock);
    return r;
}

// Does what the request is here for. False: it was parked, and is not this thread's any more.
static bool handle(http_request *r)
{
    if (r->stage == HTTP_STAGE_SENT) {
        http__download_make(r);
        return true;
    }
    if (r->stage == HTTP_STAGE_WORKING)
        http__request_handle(r);
    if (http__wait_goes_on(r))
        return false;
    http__finish(r);
    r->stage = HTTP_STAGE_READY;
    return true;
}

static void *work(void *context)
{
    http_request *r;

    while ((r = take(context)) != NULL) {
        struct MHD_Connection *mhd = r->mhd;
        if (handle(r))
            MHD_resume_connection(mhd);
    }
    return NULL;
}

bf_status http__pool_start(unsigned n_threads, http_pool **ret_pool, bf_error *err)
{
    http_pool *p = memory_alloc(1, sizeof *p + n_threads * sizeof p->threads[0]);

    if (p == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %u request threads", n_threads);
    lock_init(&p->lock);
    lock_condition_init(&p->changed);
    p->n_max = n_threads * HTTP_POOL_QUEUE_PER_THREAD;
    for (; p->n_threads < n_threads; p->n_threads++) {
        if (pthread_create(&p->threads[p->n_threads], NULL, work, p) != 0) {
            http__pool_end(p);
            (void)http__pool_free(p);
            return bf_fail(err, BF_ESYSTEM, "", "cannot start %u request threads", n_threads);
        }
    }
    *ret_pool = p;
    return BF_OK;
}

static void append(http_pool *p, http_request *r)
{
    lock_assert_held(&p->lock);
    r->next = NULL;
    if (p->first == NULL)
        p->first = r;
    else
        p->last->next = r;
    p->last = r;
}

bool http__pool_give(http_pool *p, http_request *r)
{
    lock_take(&p->lock);
    bool has_room = p->n_waiting < p->n_max && !p->is_stopping;
    if (has_room) {
        MHD_suspend_connection(r->mhd);
        r->stage = HTTP_STAGE_WORKING;
        append(p, r);
        p->n_waiting++;
    }
    lock_give(&p->lock);
    // Only now, so that the thread does not wake to wait for the lock.
    if (has_room)
        lock_wake_one(&p->changed);
    return has_room;
}

void http__pool_take_back(http_pool *p, http_request *r)
{
    lock_take(&p->lock);
    BF_CHECK(!p->is_stopping && r->stage == HTTP_STAGE_WAITING);
    append(p, r);
    lock_give(&p->lock);
    lock_wake_one(&p->changed);
}

bool http__pool_continue(http_pool *p, http_request *r)
{
    lock_take(&p->lock);
    bool goes_on = !p->is_stopping;
    if (goes_on) {
        MHD_suspend_connection(r->mhd);
        append(p, r);
    }
    lock_give(&p->lock);
    if (goes_on)
        lock_wake_one(&p->changed);
    return goes_on;
}

bool http__pool_is_alive(http_pool *p)
{
    bool is_alive = !pulse_is_asked(&p->pulse);

    lock_take(&p->lock);
    pulse_ask(&p->pulse);
    lock_wake_all(&p->changed);
    lock_give(&p->lock);
    return is_alive;
}

void http__pool_end(http_pool *p)
{
    if (p == NULL)
        return;
    lock_take(&p->lock);
    p->is_stopping = true;
    lock_wake_all(&p->changed);
    lock_give(&p->lock);
    for (; p->n_threads > 0; p->n_threads--)
        BF_CHECK(pthread_join(p->threads[p->n_threads - 1], NULL) == 0);
}

http_pool *http__pool_free(http_pool *p)
{
    if (p == NULL)
        return NULL;
    lock_condition_fini(&p->changed);
    lock_fini(&p->lock);
    memory_free(p);
    return NULL;
}
