#include "server/store/queue_share.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/lock.h"

#include <stdio.h>
#include <string.h>

// A run and who submitted it.
typedef struct share_entry {
    char client[API_CLIENT_SIZE];
    char run_id[API_ID_SIZE]; // "": about to be submitted
} share_entry;

struct queue_share {
    size_t per_client; // as given
    size_t n_max;      // entries from which on those that do not wait are dropped
    lock lock;         // guards what follows
    size_t n;          // entries
    size_t capacity;   // room
    share_entry *entries;
};

bf_status queue_share_create(size_t per_client, size_t queue_limit, queue_share **ret_share,
                             bf_error *err)
{
    queue_share *s = memory_alloc(1, sizeof *s);

    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the shares of the queue");
    s->per_client = per_client;
    // At most queue_limit runs wait, so that each clearing makes room for as many.
    s->n_max = 2 * queue_limit;
    lock_init(&s->lock);
    *ret_share = s;
    return BF_OK;
}

queue_share *queue_share_destroy(queue_share *share)
{
    if (share == NULL)
        return NULL;
    lock_fini(&share->lock);
    memory_free(share->entries);
    memory_free(share);
    return NULL;
}

static bool is_of(const share_entry *entry, const char *client)
{
    return strcmp(entry->client, client) == 0;
}

static size_t count(const queue_share *s, const char *client)
{
    size_t n = 0;

    for (size_t i = 0; i < s->n; i++)
        n += is_of(&s->entries[i], client);
    return n;
}

// Drops entries of runs that do not wait: of one client, or of all (NULL).
static void clear(queue_share *s, const char *client, queue_share_ask *ask, void *context)
{
    size_t n_left = 0;

    for (size_t i = 0; i < s->n; i++) {
        const share_entry *entry = &s->entries[i];
        bool is_meant = client == NULL || is_of(entry, client);
        if (is_meant && entry->run_id[0] != '\0' && !ask(context, entry->run_id))
            continue;
        s->entries[n_left++] = *entry;
    }
    s->n = n_left;
}

static bf_status take(queue_share *s, const char *client, bf_error *err)
{
    if (count(s, client) >= s->per_client)
        return bf_fail(err, BF_ELIMIT, "", "%zu runs of %s wait already, its share of the queue",
                       s->per_client, client);
    if (memory_reserve(&s->entries, &s->capacity, s->n + 1, sizeof *s->entries) != 0)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    share_entry *entry = &s->entries[s->n++];
    (void)snprintf(entry->client, sizeof entry->client, "%s", client);
    entry->run_id[0] = '\0';
    return BF_OK;
}

bf_status queue_share_take(queue_share *share, const char *client, queue_share_ask *ask,
                           void *context, bf_error *err)
{
    lock_take(&share->lock);
    if (share->n >= share->n_max)
        clear(share, NULL, ask, context);
    if (count(share, client) >= share->per_client)
        clear(share, client, ask, context);
    bf_status status = take(share, client, err);
    lock_give(&share->lock);
    return status;
}

void queue_share_settle(queue_share *share, const char *client, const char *run_id)
{
    size_t i = 0;

    lock_take(&share->lock);
    while (i < share->n &&
           (share->entries[i].run_id[0] != '\0' || !is_of(&share->entries[i], client)))
        i++;
    BF_CHECK(i < share->n);
    if (run_id != NULL)
        (void)snprintf(share->entries[i].run_id, API_ID_SIZE, "%s", run_id);
    else
        share->entries[i] = share->entries[--share->n];
    lock_give(&share->lock);
}
