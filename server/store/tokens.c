// Access tokens. The daemon keeps them all in memory and reads them again when that is TOKENS_FRESH_MS old.
//
// Threads  the lock guards what was read; a reader's connection is used under it. Last uses are written by another
//          connection, so that no request waits for the disk to sync.

#include "server/store/tokens.h"

#include "server/store/tokens_rows.h"

#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/lock.h"
#include "server/base/log.h"

#include <inttypes.h>
#include <sodium.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

enum { USE_MS = 60000 }; // a later use is noted again

struct tokens {
    char directory[STORE__TOKENS_PATH_SIZE];
    store__connection reader;
    lock lock;                     // guards what follows
    int64_t read_ms;               // monotonic, when it was read last
    size_t n;                      // tokens
    store__token all[TOKENS_MAX];  // by rising id
    store__token next[TOKENS_MAX]; // while they are read
};

static store__token *find_id(store__token *entries, size_t n, uint64_t id)
{
    for (size_t i = 0; i < n; i++) {
        if (entries[i].about.id == id)
            return &entries[i];
    }
    return NULL;
}

static void log_change(const char *event, const tokens_record *about)
{
    char scopes[API_SCOPES_SIZE];

    log_event(LOG_LEVEL_INFO, event, "token=%" PRIu64 " name=%s owner=%s scopes=%s%s%s", about->id,
              about->name, about->owner, api_access_write_scopes(about->scopes, scopes),
              about->resource[0] == '\0' ? "" : " resource=", about->resource);
}

// A file that cannot be read, or that another process is writing to at this moment, leaves all as it was.
static void refresh(tokens *t)
{
    int64_t now_ms = clock_monotonic_ms();
    char quoted[LOG_QUOTED_SIZE];
    bf_error err = { 0 };
    size_t n = 0;

    lock_assert_held(&t->lock);
    if (now_ms - t->read_ms < TOKENS_FRESH_MS)
        return;
    bf_status status = store__read_tokens(&t->reader, t->next, &n, &err);
    if (status == BF_OK) {
        t->read_ms = now_ms;
        // What was read takes the place of what was there; uses that are only in memory stay.
        for (size_t i = 0; i < n; i++) {
            store__token *now = &t->next[i];
            const store__token *before = find_id(t->all, t->n, now->about.id);
            if (before == NULL)
                log_change("token_added", &now->about);
            else if (before->about.revoked_ms == 0 && now->about.revoked_ms != 0)
                log_change("token_revoked", &now->about);
            if (before != NULL && before->about.used_ms > now->about.used_ms) {
                now->about.used_ms = before->about.used_ms;
                now->is_unsaved = before->is_unsaved;
            }
        }
        memcpy(t->all, t->next, n * sizeof *t->all);
        t->n = n;
    } else if ((sqlite3_errcode(t->reader.db) & 0xff) != SQLITE_BUSY) {
        t->read_ms = now_ms;
        log_event(LOG_LEVEL_ERROR, "tokens_unreadable", "error=%s", log_quote(err.text, quoted));
    }
}

bf_status tokens_open(const char *directory, tokens **ret_tokens, bf_error *err)
{
    tokens *t = memory_alloc(1, sizeof *t);

    if (t == NULL)
        return bf_fail_memory(err);
    bf_status status = store__open_tokens(directory, true, &t->reader, err);
    if (status == BF_OK && (status = store__read_tokens(&t->reader, t->all, &t->n, err)) != BF_OK)
        store__disconnect(&t->reader);
    if (status != BF_OK) {
        memory_free(t);
        return status;
    }
    // From now on no request waits for another process that is writing.
    (void)sqlite3_busy_timeout(t->reader.db, 0);
    (void)snprintf(t->directory, sizeof t->directory, "%s", directory);
    t->read_ms = clock_monotonic_ms();
    lock_init(&t->lock);
    *ret_tokens = t;
    return BF_OK;
}

tokens *tokens_close(tokens *t)
{
    if (t == NULL)
        return NULL;
    tokens_save_uses(t);
    store__disconnect(&t->reader);
    lock_fini(&t->lock);
    memory_free(t);
    return NULL;
}

bool tokens_exist(tokens *t)
{
    lock_acquire(&t->lock);
    refresh(t);
    bool has_some = t->n > 0;
    lock_release(&t->lock);
    return has_some;
}

size_t tokens_copy(tokens *t, tokens_record *ret_tokens)
{
    lock_acquire(&t->lock);
    refresh(t);
    const size_t n = t->n;
    for (size_t i = 0; i < n; i++)
        ret_tokens[i] = t->all[i].about;
    lock_release(&t->lock);
    return n;
}

bool tokens_find(tokens *t, uint64_t id, tokens_record *ret_token)
{
    lock_acquire(&t->lock);
    refresh(t);
    const store__token *found = find_id(t->all, t->n, id);
    if (found != NULL)
        *ret_token = found->about;
    lock_release(&t->lock);
    return found != NULL;
}

// All are compared, so that the time does not tell which one it was.
static store__token *find_text(tokens *t, const char *text)
{
    unsigned char hash[STORE__TOKEN_HASH_BYTES];
    store__token *found = NULL;

    if (strnlen(text, API_TOKEN_SIZE) != API_TOKEN_SIZE - 1)
        return NULL;
    store__hash_token(text, hash);
    for (size_t i = 0; i < t->n; i++) {
        if (sodium_memcmp(t->all[i].hash, hash, STORE__TOKEN_HASH_BYTES) == 0)
            found = &t->all[i];
    }
    return found;
}

bool tokens_counts(const tokens_record *token, int64_t now_ms)
{
    return token->revoked_ms == 0 && (token->expires_ms == 0 || token->expires_ms > now_ms);
}

const char *tokens_directory(const tokens *t)
{
    return t->directory;
}

void tokens_read_again(tokens *t)
{
    lock_acquire(&t->lock);
    t->read_ms = INT64_MIN / 2;
    refresh(t);
    lock_release(&t->lock);
}

static api_credential judge(store__token *e, int64_t now_ms, api_identity *ret_who)
{
    tokens_record *about = &e->about;

    if (about->revoked_ms != 0)
        return API_CREDENTIAL_REVOKED;
    if (about->expires_ms != 0 && about->expires_ms <= now_ms)
        return API_CREDENTIAL_EXPIRED;
    if (about->used_ms <= now_ms - USE_MS) {
        about->used_ms = now_ms;
        e->is_unsaved = true;
    }
    *ret_who = (api_identity){ .token = about->id, .scopes = about->scopes };
    memcpy(ret_who->owner, about->owner, sizeof ret_who->owner);
    memcpy(ret_who->resource, about->resource, sizeof ret_who->resource);
    return API_CREDENTIAL_VALID;
}

api_credential tokens_identify(tokens *t, const char *text, api_identity *ret_who)
{
    api_credential credential = API_CREDENTIAL_UNUSED;

    lock_acquire(&t->lock);
    refresh(t);
    if (t->n > 0 && text == NULL) {
        credential = API_CREDENTIAL_MISSING;
    } else if (t->n > 0) {
        store__token *found = find_text(t, text);
        credential =
            found == NULL ? API_CREDENTIAL_UNKNOWN : judge(found, clock_unix_ms(), ret_who);
    }
    lock_release(&t->lock);
    return credential;
}

api_credential tokens_identify_by_id(tokens *t, uint64_t id, api_identity *ret_who)
{
    api_credential credential = API_CREDENTIAL_UNUSED;

    lock_acquire(&t->lock);
    refresh(t);
    if (t->n > 0) {
        store__token *found = find_id(t->all, t->n, id);
        credential =
            found == NULL ? API_CREDENTIAL_UNKNOWN : judge(found, clock_unix_ms(), ret_who);
    }
    lock_release(&t->lock);
    return credential;
}

// The id and time of a use that is to be written down, which then counts as written. 0: there is none.
static uint64_t take_unsaved(tokens *t, int64_t *ret_used_ms)
{
    uint64_t id = 0;

    lock_acquire(&t->lock);
    for (size_t i = 0; id == 0 && i < t->n; i++) {
        if (!t->all[i].is_unsaved)
            continue;
        t->all[i].is_unsaved = false;
        id = t->all[i].about.id;
        *ret_used_ms = t->all[i].about.used_ms;
    }
    lock_release(&t->lock);
    return id;
}

void tokens_save_uses(tokens *t)
{
    store__connection c = { 0 };
    char quoted[LOG_QUOTED_SIZE];
    bf_error err = { 0 };
    bf_status status = BF_OK;
    int64_t used_ms = 0;
    uint64_t id;

    while (status == BF_OK && (id = take_unsaved(t, &used_ms)) != 0) {
        if (c.db == NULL)
            status = store__open_tokens(t->directory, false, &c, &err);
        if (status == BF_OK)
            status = store__exec(&c, STORE__SQL_USE_TOKEN, &err, INTEGER(id), INTEGER(used_ms));
    }
    store__disconnect(&c);
    if (status != BF_OK)
        log_event(LOG_LEVEL_WARN, "token_use_not_saved", "error=%s", log_quote(err.text, quoted));
}
