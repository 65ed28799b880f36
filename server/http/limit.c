#include "server/http/limit.h"

#include "core/base/digest.h"
#include "core/base/memory.h"
#include "server/base/lock.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// A bucket's level is counted in parts of a token, of which a quota of q gives q in a millisecond.
enum { NONE = -1, WINDOW_MS = 1000 * HTTP_LIMIT_WINDOW_S };
#define TOKEN ((int64_t)WINDOW_MS)

// A client in the table; neighbours by their places.
typedef struct limit_client {
    uint8_t key[HTTP_LIMIT_KEY_SIZE];
    int64_t levels[HTTP_LIMIT_COUNT]; // below 0: a debt
    int64_t seen_ms;
    int next;         // in its chain
    int newer, older; // by the last request
} limit_client;

struct http_limit {
    int64_t quotas[HTTP_LIMIT_COUNT];
    uint64_t seed;         // of the chains
    size_t n_clients;      // room
    size_t n_used;         // clients in it
    lock lock;             // guards all of it
    int newest, oldest;    // by the last request
    int *chains;           // first client of each, n_clients of them
    limit_client *clients; // n_clients
};

static const char *const names[HTTP_LIMIT_COUNT] = {
#define X(kind, name, token_ms) [kind] = name,
    HTTP_LIMIT_LIST(X)
#undef X
};

static const int64_t token_ns[HTTP_LIMIT_COUNT] = {
#define X(kind, name, token_ms) [kind] = (token_ms)*INT64_C(1000000),
    HTTP_LIMIT_LIST(X)
#undef X
};

static void forget_all(http_limit *l)
{
    l->n_used = 0;
    l->newest = l->oldest = NONE;
    for (size_t i = 0; i < l->n_clients; i++)
        l->chains[i] = NONE;
}

// True if they differ from what they were.
static bool set_quotas(http_limit *l, const uint64_t quotas[HTTP_LIMIT_COUNT])
{
    bool has_changed = false;

    for (int k = 0; k < HTTP_LIMIT_COUNT; k++) {
        has_changed = has_changed || l->quotas[k] != (int64_t)quotas[k];
        l->quotas[k] = (int64_t)quotas[k];
    }
    return has_changed;
}

bf_status http_limit_create(const uint64_t quotas[HTTP_LIMIT_COUNT], size_t n_clients,
                            http_limit **ret_limit, bf_error *err)
{
    http_limit *l = memory_alloc(1, sizeof *l);
    int *chains = memory_alloc(n_clients, sizeof *chains);
    limit_client *clients = memory_alloc(n_clients, sizeof *clients);

    if (l == NULL || chains == NULL || clients == NULL) {
        memory_free(l);
        memory_free(chains);
        memory_free(clients);
        return bf_fail(err, BF_ENOMEM, "", "no memory for the limits of %zu clients", n_clients);
    }
    set_quotas(l, quotas);
    l->seed = DIGEST_START ^ (uint64_t)(uintptr_t)l;
    l->n_clients = n_clients;
    l->chains = chains;
    l->clients = clients;
    forget_all(l);
    lock_init(&l->lock);
    *ret_limit = l;
    return BF_OK;
}

http_limit *http_limit_destroy(http_limit *limit)
{
    if (limit == NULL)
        return NULL;
    lock_fini(&limit->lock);
    memory_free(limit->chains);
    memory_free(limit->clients);
    memory_free(limit);
    return NULL;
}

void http_limit_change(http_limit *limit, const uint64_t quotas[HTTP_LIMIT_COUNT])
{
    lock_acquire(&limit->lock);
    if (set_quotas(limit, quotas))
        forget_all(limit);
    lock_release(&limit->lock);
}

static int *chain_of(http_limit *l, const uint8_t *key)
{
    return &l->chains[digest_add(l->seed, key, HTTP_LIMIT_KEY_SIZE) % l->n_clients];
}

// Takes a client out of the order of last requests, and puts one in as the newest.
static void unlink_client(http_limit *l, int place)
{
    limit_client *c = &l->clients[place];

    *(c->newer == NONE ? &l->newest : &l->clients[c->newer].older) = c->older;
    *(c->older == NONE ? &l->oldest : &l->clients[c->older].newer) = c->newer;
}

static void link_newest(http_limit *l, int place)
{
    limit_client *c = &l->clients[place];

    c->newer = NONE;
    c->older = l->newest;
    *(c->older == NONE ? &l->oldest : &l->clients[c->older].newer) = place;
    l->newest = place;
}

// A place for a new client: a free one, or that of the oldest.
static int make_room(http_limit *l)
{
    if (l->n_used < l->n_clients)
        return (int)l->n_used++;
    int place = l->oldest;
    int *from = chain_of(l, l->clients[place].key);
    while (*from != place)
        from = &l->clients[*from].next;
    *from = l->clients[place].next;
    unlink_client(l, place);
    return place;
}

static limit_client *add(http_limit *l, const uint8_t *key, int64_t now_ms)
{
    int place = make_room(l);
    int *chain = chain_of(l, key);
    limit_client *c = &l->clients[place];

    memcpy(c->key, key, sizeof c->key);
    c->seen_ms = now_ms;
    for (int k = 0; k < HTTP_LIMIT_COUNT; k++)
        c->levels[k] = l->quotas[k] * TOKEN;
    c->next = *chain;
    *chain = place;
    link_newest(l, place);
    return c;
}

// The client of a key, with the tokens that it has gained since its last request.
static limit_client *refill(http_limit *l, const uint8_t *key, int64_t now_ms)
{
    int place = *chain_of(l, key);
    while (place != NONE && memcmp(l->clients[place].key, key, HTTP_LIMIT_KEY_SIZE) != 0)
        place = l->clients[place].next;

    if (place == NONE)
        return add(l, key, now_ms);
    limit_client *c = &l->clients[place];
    unlink_client(l, place);
    link_newest(l, place);
    int64_t passed_ms = now_ms - c->seen_ms < WINDOW_MS ? now_ms - c->seen_ms : WINDOW_MS;
    c->seen_ms = now_ms;
    for (int k = 0; k < HTTP_LIMIT_COUNT; k++) {
        int64_t full = l->quotas[k] * TOKEN;
        int64_t level = c->levels[k] + l->quotas[k] * passed_ms;
        c->levels[k] = level < full ? level : full;
    }
    return c;
}

// Seconds, rounded up, in which a bucket gains what it lacks.
static unsigned time_to_gain(int64_t lacking, int64_t quota)
{
    int64_t per_s = quota * 1000;
    return (unsigned)((lacking + per_s - 1) / per_s);
}

http_limit_verdict http_limit_take(http_limit *limit, const uint8_t key[HTTP_LIMIT_KEY_SIZE],
                                   bool creates_work, int64_t now_ms)
{
    http_limit_verdict verdict = { .is_refused = false };
    int n_kinds = creates_work ? HTTP_LIMIT_COUNT : HTTP_LIMIT_WORK;

    lock_acquire(&limit->lock);
    limit_client *c = refill(limit, key, now_ms);
    for (int k = 0; k < n_kinds; k++) {
        int64_t quota = limit->quotas[k];
        if (quota == 0 || c->levels[k] >= TOKEN)
            continue;
        unsigned wait_s = time_to_gain(TOKEN - c->levels[k], quota);
        verdict.is_refused = true;
        if (wait_s > verdict.retry_after_s)
            verdict.retry_after_s = wait_s;
    }
    for (int k = 0; k < n_kinds; k++) {
        int64_t quota = limit->quotas[k];
        if (quota == 0)
            continue;
        c->levels[k] -= verdict.is_refused ? 0 : TOKEN;
        verdict.quotas[k] = (uint64_t)quota;
        verdict.left[k] = c->levels[k] > 0 ? (uint64_t)(c->levels[k] / TOKEN) : 0;
        verdict.reset_s[k] = time_to_gain(quota * TOKEN - c->levels[k], quota);
    }
    lock_release(&limit->lock);
    return verdict;
}

// CPU time beyond what a token is good for, ns; at most what the debt of a whole window takes, so that nothing overflows.
static int64_t beyond_token(int64_t cpu_ns, int kind, int64_t quota)
{
    const int64_t most = 2 * quota * token_ns[kind];
    const int64_t beyond = cpu_ns - token_ns[kind];

    return beyond < 0 ? 0 : beyond < most ? beyond : most;
}

void http_limit_charge(http_limit *limit, const uint8_t key[HTTP_LIMIT_KEY_SIZE], bool creates_work,
                       int64_t before_ns, int64_t after_ns, int64_t now_ms)
{
    int n_kinds = creates_work ? HTTP_LIMIT_COUNT : HTTP_LIMIT_WORK;

    if (after_ns <= token_ns[HTTP_LIMIT_REQUESTS])
        return;
    lock_acquire(&limit->lock);
    limit_client *c = refill(limit, key, now_ms);
    for (int k = 0; k < n_kinds; k++) {
        int64_t quota = limit->quotas[k];
        int64_t more_us =
            (beyond_token(after_ns, k, quota) - beyond_token(before_ns, k, quota)) / 1000;
        c->levels[k] -= more_us * TOKEN / (token_ns[k] / 1000);
        if (c->levels[k] < -quota * TOKEN)
            c->levels[k] = -quota * TOKEN;
    }
    lock_release(&limit->lock);
}

void http_limit_write_headers(const http_limit_verdict *verdict, api_response *response)
{
    char policy[API_HEADER_SIZE] = "", state[API_HEADER_SIZE] = "";
    size_t n_policy = 0, n_state = 0;

    for (int k = 0; k < HTTP_LIMIT_COUNT; k++) {
        const char *comma = n_policy == 0 ? "" : ", ";
        if (verdict->quotas[k] == 0)
            continue;
        n_policy += (size_t)snprintf(policy + n_policy, sizeof policy - n_policy,
                                     "%s\"%s\";q=%" PRIu64 ";w=%d", comma, names[k],
                                     verdict->quotas[k], HTTP_LIMIT_WINDOW_S);
        n_state +=
            (size_t)snprintf(state + n_state, sizeof state - n_state, "%s\"%s\";r=%" PRIu64 ";t=%u",
                             comma, names[k], verdict->left[k], verdict->reset_s[k]);
    }
    if (n_policy == 0)
        return;
    api_response_set(response, "RateLimit-Policy", policy);
    api_response_set(response, "RateLimit", state);
    if (verdict->is_refused) {
        (void)snprintf(state, sizeof state, "%u", verdict->retry_after_s);
        api_response_set(response, "Retry-After", state);
    }
}
