#include "server/store/idempotency.h"

#include <sodium.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

enum {
    KEYS_MAX = 100000, // answers of a route that are stored for an owner's requests that come again
    TRIM_EVERY = 64,   // between counts, where owners take turns
    ROUTE_SIZE = 32,   // bytes of a route with its terminator
};

// A key that a request uses at the moment; on its caller's stack.
struct store__key {
    char route[ROUTE_SIZE + API_OWNER_SIZE];  // and after a space the owner, if there is one
    const char *text;                         // the key; "": none
    unsigned char digest[STORE__DIGEST_SIZE]; // of the request's body
    store__key *next;                         // in the store's list
};

// BF_ECONFLICT: another request uses it at the moment.
static bf_status use_key(store *s, store__key *key, const store__request *request, bf_error *err)
{
    const api_sender *sender = request->sender;

    key->text = sender->key;
    if (key->text[0] == '\0')
        return BF_OK;
    (void)snprintf(key->route, sizeof key->route, "%s%s%s", request->route,
                   sender->owner[0] == '\0' ? "" : " ", sender->owner);
    (void)crypto_hash_sha256(key->digest, (const unsigned char *)sender->body, sender->n_body);
    lock_acquire(&s->lock);
    const store__key *used = s->keys;
    while (used != NULL &&
           !(strcmp(used->text, key->text) == 0 && strcmp(used->route, key->route) == 0))
        used = used->next;
    if (used == NULL) {
        key->next = s->keys;
        s->keys = key;
    }
    lock_release(&s->lock);
    if (used == NULL)
        return BF_OK;
    return bf_fail(err, BF_ECONFLICT, "",
                   "a request with this Idempotency-Key is being answered: try again");
}

static void free_key(store *s, store__key *key)
{
    if (key->text[0] == '\0')
        return;
    lock_acquire(&s->lock);
    store__key **at = &s->keys;
    while (*at != key)
        at = &(*at)->next;
    *at = key->next;
    lock_release(&s->lock);
}

bf_status store__expire_keys(store__connection *writer, int64_t before_ms, bf_error *err)
{
    return store__exec(writer, STORE__SQL_EXPIRE_KEYS, err, INTEGER(before_ms));
}

static bf_status read_answer(const store__query *q, const store__key *key, api_acceptance *accepted,
                             bf_error *err)
{
    const void *digest = sqlite3_column_blob(q->statement, 0);

    if (digest == NULL || sqlite3_column_bytes(q->statement, 0) != STORE__DIGEST_SIZE ||
        memcmp(digest, key->digest, STORE__DIGEST_SIZE) != 0)
        return bf_fail(err, BF_EINPUT, "",
                       "the Idempotency-Key was used before with another body: take a new one");
    (void)snprintf(accepted->id, sizeof accepted->id, "%s",
                   (const char *)sqlite3_column_text(q->statement, 1));
    accepted->revision = (uint64_t)sqlite3_column_int64(q->statement, 2);
    accepted->is_replay = true;
    return store__column_bytes(q, 3, &accepted->answer, err);
}

// accepted->is_replay: there is one. BF_EINPUT: it was to another body.
static bf_status find_answer(store__connection *writer, const store *s, const store__key *key,
                             int64_t now_ms, api_acceptance *accepted, bf_error *err)
{
    if (key->text[0] == '\0')
        return BF_OK;
    BF_TRY(store__expire_keys(writer, now_ms - s->idempotency_ms, err));
    bf_status status = BF_OK;
    store__query q = store__start(writer, STORE__SQL_FIND_KEY, TEXT(key->route), TEXT(key->text));
    if (store__next(&q, &status, err))
        status = read_answer(&q, key, accepted, err);
    store__end(&q);
    return status;
}

// The oldest of the same owner go when there are too many. Counting takes as long as there are, so it is done only where
// the numbers, which rise without gaps over all owners, allow too many, and then not each time.
static bf_status trim_keys(store__connection *writer, const store__key *key, bf_error *err)
{
    const int64_t last = sqlite3_last_insert_rowid(writer->db);
    int64_t first = 0;

    BF_TRY(store__find_number(writer, STORE__SQL_OLDEST_KEY, &first, err, TEXT(key->route)));
    const int64_t n_beyond = last - first + 1 - KEYS_MAX;
    if (n_beyond <= 0 || (n_beyond >= TRIM_EVERY && n_beyond % TRIM_EVERY != 0))
        return BF_OK;
    return store__exec(writer, STORE__SQL_TRIM_KEYS, err, TEXT(key->route), INTEGER(KEYS_MAX));
}

static bf_status insert_answer(store__connection *writer, const store__key *key, int64_t at_ms,
                               const api_acceptance *accepted, bf_error *err)
{
    if (key->text[0] == '\0')
        return BF_OK;
    BF_TRY(store__exec(writer, STORE__SQL_INSERT_KEY, err, TEXT(key->route), TEXT(key->text),
                       BLOB(key->digest, sizeof key->digest), TEXT(accepted->id),
                       INTEGER(accepted->revision), INTEGER(at_ms),
                       TEXT_OF(accepted->answer.bytes, accepted->answer.n)));
    return trim_keys(writer, key, err);
}

typedef struct accept_context {
    const store__request *request;
    store__insert_fn *insert;
    void *context;
    const store *store;
    store__key key;
    api_acceptance accepted;
} accept_context;

static bf_status apply_accept(store__connection *writer, store__operation *operation, bf_error *err)
{
    accept_context *a = operation->context;
    const store__request *request = a->request;

    BF_TRY(find_answer(writer, a->store, &a->key, request->now_ms, &a->accepted, err));
    if (a->accepted.is_replay)
        return BF_OK;
    BF_TRY(store__check_room(a->store, err));
    BF_TRY(a->insert(writer, a->context, &a->accepted, err));
    memcpy(a->accepted.id, request->id, API_ID_SIZE);
    memcpy(operation->changed, request->id, API_ID_SIZE);
    return insert_answer(writer, &a->key, request->now_ms, &a->accepted, err);
}

bf_status store__accept(store *s, const store__request *request, store__insert_fn *insert,
                        void *context, api_acceptance *ret_acceptance, bf_error *err)
{
    accept_context a = { .request = request, .insert = insert, .context = context, .store = s };

    BF_TRY(use_key(s, &a.key, request, err));
    bf_status status = store__write(s, apply_accept, &a, err);
    free_key(s, &a.key);
    if (status == BF_OK)
        *ret_acceptance = a.accepted;
    else
        buffer_fini(&a.accepted.answer);
    if (status == BF_ELIMIT)
        ret_acceptance->retry_after_s = a.accepted.retry_after_s;
    return status;
}
