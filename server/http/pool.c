// Request threads: work that may wait for the disk or compute for long runs here, so that the epoll
// threads never block. The pool has exclusive access to a queued request: its connection is suspended, so MHD calls
// nothing for it until MHD_resume_connection(), after which the pool does not touch it any more.
//
// Five lanes, each a queue, so that one kind of work does not stand in the way of another. Of n request
// threads that were asked for, 2 n + 3 are started:
//
//     health     1 at a time      GET /readyz, which may wait for the disk
//     figures    1 at a time      GET /metrics, which never does
//     checks     n at a time      requests with a scenario to check, which computes up to a second
//     requests   n at a time      every other request
//     chunks     n at a time      what is pulled (pull.c); requests and chunks together: n + 1
//
// So n long requests leave a thread to the streams, and n reads of a store that stalls leave one to
// requests, and neither delays the answer whether the daemon is ready; scenarios delay none of these. Requests and
// chunks that wait take turns.
//
// The queues of new requests are bounded: what does not fit is refused at once. Chunks are bounded by the
// limits of their kinds. When the pool ends, the checks that wait are refused, so that it ends within a second (those under
// way are cancelled)

#include "server/http/pool.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/thread.h"

#include <microhttpd.h>
#include <string.h>

enum { QUEUE_PER_THREAD = 16 }; // requests that may wait for a request thread

typedef enum pool_lane {
    LANE_HEALTH,
    LANE_FIGURES,
    LANE_CHECKS,
    LANE_REQUESTS,
    LANE_CHUNKS,
    N_LANES
} pool_lane;

struct http_pool {
    lock lock;                                   // guards all but the threads
    lock_condition changed;                      // something was queued, or the end
    STAILQ_HEAD(, http_request) queues[N_LANES]; // oldest first
    unsigned n_waiting[N_LANES];                 // requests in them
    unsigned n_busy[N_LANES];                    // threads that work on one
    unsigned n;                                  // request threads that were asked for
    bool is_turn_of_chunks;                      // if requests and chunks wait
    bool is_stopping;                            // nothing more is queued
    liveness liveness;                           // of those that handle requests: one must live
    unsigned n_threads;                          // started
    pthread_t threads[];                         // they
};

static pool_lane lane_of(const http_request *r)
{
    if (r->stage != HTTP_STAGE_WORKING)
        return LANE_CHUNKS;
    if (r->cost == API_COST_CHECK)
        return LANE_CHECKS;
    if (r->cost != API_COST_HEALTH)
        return LANE_REQUESTS;
    return strcmp(r->path, "/readyz") == 0 ? LANE_HEALTH : LANE_FIGURES;
}

// True if a thread may take something of this lane now.
static bool is_open(const http_pool *p, pool_lane lane)
{
    if (lane == LANE_HEALTH || lane == LANE_FIGURES)
        return p->n_busy[lane] == 0;
    if (lane == LANE_CHECKS)
        return p->n_busy[lane] < p->n;
    return p->n_busy[lane] < p->n && p->n_busy[LANE_REQUESTS] + p->n_busy[LANE_CHUNKS] < p->n + 1;
}

// The lane to take from next; N_LANES: there is nothing to do.
static pool_lane choose_lane(const http_pool *p)
{
    bool can[N_LANES];

    lock_assert_held(&p->lock);
    for (pool_lane lane = LANE_HEALTH; lane < N_LANES; lane++)
        can[lane] = p->n_waiting[lane] > 0 && is_open(p, lane);
    if (can[LANE_HEALTH])
        return LANE_HEALTH;
    if (can[LANE_FIGURES])
        return LANE_FIGURES;
    if (can[LANE_CHECKS])
        return LANE_CHECKS;
    if (can[LANE_CHUNKS] && (p->is_turn_of_chunks || !can[LANE_REQUESTS]))
        return LANE_CHUNKS;
    return can[LANE_REQUESTS] ? LANE_REQUESTS : N_LANES;
}

static bool is_empty(const http_pool *p)
{
    bool is = true;

    for (pool_lane lane = LANE_HEALTH; lane < N_LANES; lane++)
        is = is && p->n_waiting[lane] == 0;
    return is;
}

// Request threads hang if none of those that handle requests comes by: for that it need not be free, but end something.
// Those that check scenarios wait for nothing but the store, which is asked by itself.
static void answer_liveness(http_pool *p)
{
    lock_assert_held(&p->lock);
    if (p->n_busy[LANE_REQUESTS] < p->n)
        liveness_answer(&p->liveness);
}

// The next request, waiting for one. *lane is that of the request that is done (N_LANES: none), then
// that of the next; *ret_is_late: it shall not be begun any more. NULL: the pool ends and the queues are empty.
static http_request *next_request(http_pool *p, pool_lane *lane, bool *ret_is_late)
{
    http_request *r = NULL;

    lock_acquire(&p->lock);
    if (*lane != N_LANES)
        p->n_busy[*lane]--;
    answer_liveness(p);
    while ((*lane = choose_lane(p)) == N_LANES && !(p->is_stopping && is_empty(p))) {
        (void)lock_wait(&p->changed, &p->lock, -1);
        answer_liveness(p);
    }
    if (*lane != N_LANES) {
        r = STAILQ_FIRST(&p->queues[*lane]);
        STAILQ_REMOVE_HEAD(&p->queues[*lane], entry);
        p->n_waiting[*lane]--;
        p->n_busy[*lane]++;
        p->is_turn_of_chunks = *lane == LANE_REQUESTS;
    }
    *ret_is_late = p->is_stopping && *lane == LANE_CHECKS;
    if (p->is_stopping)
        lock_wake_all(&p->changed);
    lock_release(&p->lock);
    return r;
}

static void *work(void *context)
{
    http_pool *p = context;
    pool_lane lane = N_LANES;
    http_request *r;
    bool is_late;

    while ((r = next_request(p, &lane, &is_late)) != NULL) {
        struct MHD_Connection *mhd = r->mhd;
        if (is_late) {
            http__respond_refuse(r, 503, BF_EBUSY, "the service is stopping");
            r->stage = HTTP_STAGE_READY;
        }
        if (is_late || http__request_work(r))
            MHD_resume_connection(mhd);
    }
    return NULL;
}

bf_status http__pool_start(unsigned n, http_pool **ret_pool, bf_error *err)
{
    unsigned n_threads = 2 * n + 3;
    http_pool *p = memory_alloc(1, sizeof *p + n_threads * sizeof p->threads[0]);

    if (p == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %u request threads", n);
    lock_init(&p->lock);
    lock_condition_init(&p->changed);
    for (pool_lane lane = LANE_HEALTH; lane < N_LANES; lane++)
        STAILQ_INIT(&p->queues[lane]);
    p->n = n;
    for (; p->n_threads < n_threads; p->n_threads++) {
        const bf_status status = thread_start(&p->threads[p->n_threads], work, p, "requests", err);
        if (status != BF_OK) {
            http__pool_end(p);
            (void)http__pool_free(p);
            return status;
        }
    }
    *ret_pool = p;
    return BF_OK;
}

static void append(http_pool *p, http_request *r)
{
    pool_lane lane = lane_of(r);

    lock_assert_held(&p->lock);
    STAILQ_INSERT_TAIL(&p->queues[lane], r, entry);
    p->n_waiting[lane]++;
}

bool http__pool_suspend(http_pool *p, http_request *r)
{
    http_stage before = r->stage;

    r->stage = HTTP_STAGE_WORKING;
    lock_acquire(&p->lock);
    bool has_room = p->n_waiting[lane_of(r)] < p->n * QUEUE_PER_THREAD && !p->is_stopping;
    if (has_room) {
        MHD_suspend_connection(r->mhd);
        append(p, r);
    }
    lock_release(&p->lock);
    // Only now, so that the thread does not wake to wait for the lock.
    if (has_room)
        lock_wake_one(&p->changed);
    else
        r->stage = before;
    return has_room;
}

void http__pool_enqueue(http_pool *p, http_request *r)
{
    lock_acquire(&p->lock);
    BF_CHECK(!p->is_stopping && r->stage != HTTP_STAGE_WORKING);
    append(p, r);
    lock_release(&p->lock);
    lock_wake_one(&p->changed);
}

bool http__pool_is_alive(http_pool *p)
{
    bool is_alive = !liveness_is_asked(&p->liveness);

    lock_acquire(&p->lock);
    liveness_ask(&p->liveness);
    lock_wake_all(&p->changed);
    lock_release(&p->lock);
    return is_alive;
}

void http__pool_end(http_pool *p)
{
    if (p == NULL)
        return;
    lock_acquire(&p->lock);
    p->is_stopping = true;
    lock_wake_all(&p->changed);
    lock_release(&p->lock);
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
