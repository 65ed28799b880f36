// Answers that wait for a run, without a thread: the connection of such a request, suspended since a
// request thread took it, stays so and is parked.
//
//     WORKING --answer says what it waits for--> WAITING --look, nothing yet--> parked
//                                                   ^                             |
//                                                   '--- a commit of the run, the deadline,
//                                                        a client that left, the end
//
// Each look is made by a request thread, as it may wait for the disk. The request is in http.waits
// from its first look to its last, so that no commit goes unnoticed: notices are counted under
// http.lock, and who parks a request after a look during which one came makes it due again at once.
// A parked request belongs to whoever hands it back to the pool under http.lock; is_parked says
// whether it still can be.
//
// A run that computes commits many times a second, and many may wait for its end: looks at one
// request are WAIT_PACE_MS apart. The watching thread does those that were put off.

#include "server/http/http_priv.h"

#include "core/base/check.h"
#include "server/base/clock.h"

#include <string.h>

enum { WAIT_PACE_MS = 20 };

// Joins those that wait. False: there are too many.
static bool begin(http_request *r)
{
    http *h = r->server;
    http_wait *w = &r->wait;

    lock_take(&h->lock);
    bool is_welcome = h->n_waits < h->options.wait_limit;
    if (is_welcome) {
        w->deadline_ms = clock_monotonic_ms() + 1000 * (int64_t)r->response.wait.seconds;
        w->is_waiting = true;
        w->next = h->waits;
        if (w->next != NULL)
            w->next->wait.previous = r;
        h->waits = r;
        h->n_waits++;
    }
    lock_give(&h->lock);
    return is_welcome;
}

void http__wait_end(http_request *r)
{
    http *h = r->server;
    http_wait *w = &r->wait;

    if (!w->is_waiting)
        return;
    lock_take(&h->lock);
    BF_CHECK(!w->is_parked);
    if (w->previous != NULL)
        w->previous->wait.next = w->next;
    else
        h->waits = w->next;
    if (w->next != NULL)
        w->next->wait.previous = w->previous;
    h->n_waits--;
    w->is_waiting = false;
    lock_give(&h->lock);
}

// What a request is told that would have waited.
static void refuse(http_request *r)
{
    bf_error err = { 0 };

    r->response.wait.seconds = 0;
    api_response_drop(&r->response, "Preference-Applied");
    if (strcmp(r->method, "POST") == 0)
        return; // it was accepted; waiting was only preferred
    (void)bf_fail(&err, BF_EBUSY, "", "there are %u requests that wait, which is the limit",
                  r->server->options.wait_limit);
    http__respond_refuse(r, 503, &err);
}

// Is it over, whatever the run does? *ret_seen is how many notices came so far.
static bool is_over_by_itself(http_request *r, uint64_t *ret_seen)
{
    http *h = r->server;

    lock_take(&h->lock);
    *ret_seen = r->wait.n_notified;
    bool is_over =
        h->is_stopping || r->wait.has_left || clock_monotonic_ms() >= r->wait.deadline_ms;
    lock_give(&h->lock);
    return is_over;
}

// False: the server stops, it cannot be parked any more. After true the request is not this
// thread's any more.
static bool park(http_request *r, uint64_t seen)
{
    http *h = r->server;
    http_wait *w = &r->wait;

    lock_take(&h->lock);
    bool can_park = !h->is_stopping;
    if (can_park) {
        w->looked_ms = clock_monotonic_ms();
        w->due_ms = w->n_notified == seen ? w->deadline_ms : w->looked_ms + WAIT_PACE_MS;
        w->is_parked = true;
        if (w->n_notified != seen)
            lock_wake_all(&h->changed);
    }
    lock_give(&h->lock);
    return can_park;
}

bool http__wait_goes_on(http_request *r)
{
    uint64_t seen = 0;

    if (r->response.wait.seconds == 0)
        return false;
    if (r->stage == HTTP_STAGE_WORKING && !begin(r)) {
        refuse(r);
        return false;
    }
    r->stage = HTTP_STAGE_WAITING;
    if (!is_over_by_itself(r, &seen) &&
        !api_wait_is_over(&r->server->services, &r->response.wait) && park(r, seen))
        return true;
    http__wait_end(r);
    if (!r->wait.has_left)
        http__request_handle_again(r);
    return false;
}

static void hand_back(http *h, http_request *r)
{
    lock_assert_held(&h->lock);
    r->wait.is_parked = false;
    http__pool_take_back(h->pool, r);
}

void http__wait_notify(http *h, const char *run_id)
{
    int64_t now_ms = h->waits == NULL ? 0 : clock_monotonic_ms();

    lock_assert_held(&h->lock);
    for (http_request *r = h->waits; r != NULL; r = r->wait.next) {
        http_wait *w = &r->wait;
        if (strcmp(r->response.wait.run, run_id) != 0)
            continue;
        w->n_notified++;
        if (!w->is_parked)
            continue;
        int64_t due_ms = w->looked_ms + WAIT_PACE_MS;
        if (due_ms <= now_ms) {
            hand_back(h, r);
        } else if (due_ms < w->due_ms) {
            w->due_ms = due_ms;
            lock_wake_all(&h->changed);
        }
    }
}

int64_t http__wait_watch(http *h, int64_t now_ms, bool looks_for_the_gone)
{
    int64_t next_ms = INT64_MAX;

    lock_assert_held(&h->lock);
    for (http_request *r = h->waits; r != NULL; r = r->wait.next) {
        http_wait *w = &r->wait;
        if (!w->is_parked)
            continue;
        if (looks_for_the_gone)
            w->has_left = http__connection_has_hung_up(r->connection->fd);
        if (w->has_left || now_ms >= w->due_ms)
            hand_back(h, r);
        else if (w->due_ms < next_ms)
            next_ms = w->due_ms;
    }
    return next_ms;
}

void http__wait_end_all(http *h)
{
    lock_take(&h->lock);
    BF_CHECK(h->is_stopping);
    for (http_request *r = h->waits; r != NULL; r = r->wait.next) {
        if (r->wait.is_parked)
            hand_back(h, r);
    }
    lock_give(&h->lock);
}
