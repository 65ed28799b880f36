// The connections that read: at most STORE__READERS_MAX, opened when they are needed.
//
// Threads  the pool's lock guards who has which; a connection belongs to the thread that took it.
// Length   a read is one transaction, so that what it puts together is of one moment; it is short,
//          because the log cannot start again while someone reads an old state of it.

#include "server/store/store_priv.h"

#include "core/base/check.h"

#include <sqlite3.h>

void store__init_pool(store__pool *pool)
{
    lock_init(&pool->lock);
    lock_condition_init(&pool->given);
}

void store__fini_pool(store__pool *pool)
{
    for (int i = 0; i < STORE__READERS_MAX; i++) {
        BF_CHECK(!pool->is_taken[i]);
        store__disconnect(&pool->readers[i]);
    }
    lock_condition_fini(&pool->given);
    lock_fini(&pool->lock);
}

// The first one that is free, so that few are opened where few are needed. -1: all are taken.
static int find_free(const store__pool *pool)
{
    lock_assert_held(&pool->lock);
    for (int i = 0; i < STORE__READERS_MAX; i++)
        if (!pool->is_taken[i])
            return i;
    return -1;
}

static store__connection *take_slot(store__pool *pool)
{
    int i = -1;

    lock_take(&pool->lock);
    while ((i = find_free(pool)) < 0)
        lock_wait(&pool->given, &pool->lock, -1);
    pool->is_taken[i] = true;
    lock_give(&pool->lock);
    return &pool->readers[i];
}

static void give_slot(store__pool *pool, const store__connection *reader)
{
    lock_take(&pool->lock);
    BF_CHECK(pool->is_taken[reader - pool->readers]);
    pool->is_taken[reader - pool->readers] = false;
    lock_wake_all(&pool->given);
    lock_give(&pool->lock);
}

bf_status store__take_reader(store *s, store__connection **ret_reader, bf_error *err)
{
    store__connection *reader = take_slot(&s->pool);
    bf_status status = BF_OK;

    if (reader->db == NULL)
        status = store__connect(s->path, STORE__READ_ONLY, reader, err);
    if (status == BF_OK)
        status = store__run_plain(reader, STORE__SQL_BEGIN_READ, err);
    if (status != BF_OK) {
        give_slot(&s->pool, reader);
        return status;
    }
    *ret_reader = reader;
    return BF_OK;
}

void store__give_reader(store *s, store__connection *reader)
{
    // A reader that cannot end its transaction would hold the log for ever: open another next time.
    bool is_ended = store__run_plain(reader, STORE__SQL_COMMIT, NULL) == BF_OK;
    if (!is_ended && sqlite3_get_autocommit(reader->db) == 0)
        store__disconnect(reader);
    give_slot(&s->pool, reader);
}
