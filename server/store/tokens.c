// Access tokens. The daemon keeps them all in memory and reads them again when that is TOKENS_FRESH_MS old.
//
// Threads  the lock guards what was read; a reader's connection is used under it. Last uses are written by another
//          connection, so that no request waits for the disk to sync.

#include "server/store/tokens.h"

#include "server/store/connection.h"
#include "server/store/page_sums.h"

#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/file_io.h"
#include "server/base/lock.h"
#include "server/base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <sodium.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum {
    SECRET_BYTES = 32,
    HASH_BYTES = 32,
    PATH_SIZE = 1100,
    USE_MS = 60000, // a later use is noted again
};

static const char prefix[] = "bft_";

// A token as it is in memory.
typedef struct entry {
    tokens_record about;
    unsigned char hash[HASH_BYTES];
    bool is_unsaved; // about.used_ms is not in the file yet
} entry;

struct tokens {
    char directory[PATH_SIZE];
    store__connection reader;
    lock lock;              // guards what follows
    int64_t read_ms;        // monotonic, when it was read last
    size_t n;               // tokens
    entry all[TOKENS_MAX];  // by rising id
    entry next[TOKENS_MAX]; // while they are read
};

static bf_status create_file(const char *directory, const char *path, bf_error *err)
{
    if (!file_io_make_directories(directory, 0700, FILE_IO_NOW))
        return bf_fail(err, BF_ESYSTEM, "", "cannot make the data directory %.400s: %s", directory,
                       strerror(errno));
    int file = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file < 0 && errno != EEXIST)
        return bf_fail(err, BF_ESYSTEM, "", "cannot create %.400s: %s", path, strerror(errno));
    if (file >= 0)
        (void)close(file);
    return BF_OK;
}

static bf_status create_table(store__connection *c, bf_error *err)
{
    int64_t n = 0;

    bf_status status = store__read_number(c, STORE__SQL_HAS_TOKENS, &n, err);
    if (status != BF_OK || n > 0)
        return status;
    status = store__reserve_page_sums(c->db, err);
    return status == BF_OK ? store__run_plain(c, STORE__SQL_CREATE_TOKENS, err) : status;
}

// Without is_new a missing file is BF_EINPUT.
static bf_status connect_to(const char *directory, bool is_new, store__connection *c, bf_error *err)
{
    char path[PATH_SIZE + 16];

    if (strlen(directory) >= PATH_SIZE)
        return bf_fail(err, BF_EINPUT, "", "the data directory's path is too long");
    if (sodium_init() < 0)
        return bf_fail(err, BF_ESYSTEM, "", "libsodium cannot be used on this machine");
    (void)snprintf(path, sizeof path, "%s/access.db", directory);
    bf_status status = BF_OK;
    if (is_new)
        status = create_file(directory, path, err);
    else if (access(path, F_OK) != 0)
        status = bf_fail(err, BF_EINPUT, "", "there are no tokens in %.400s", directory);
    if (status == BF_OK)
        status = store__connect(path, STORE__READ_WRITE, c, err);
    if (status == BF_OK && (status = create_table(c, err)) != BF_OK)
        store__disconnect(c);
    return status;
}

static bf_status read_entry(const store__query *q, entry *ret_entry, bf_error *err)
{
    const void *hash = sqlite3_column_blob(q->statement, 3);
    char scopes[API_SCOPES_SIZE];
    entry e = { .about = { .id = (uint64_t)sqlite3_column_int64(q->statement, 0),
                           .created_ms = sqlite3_column_int64(q->statement, 5),
                           .expires_ms = sqlite3_column_int64(q->statement, 6),
                           .used_ms = sqlite3_column_int64(q->statement, 7),
                           .revoked_ms = sqlite3_column_int64(q->statement, 8) } };

    store__column_text(q, 1, e.about.name, sizeof e.about.name);
    store__column_text(q, 2, e.about.owner, sizeof e.about.owner);
    store__column_text(q, 4, scopes, sizeof scopes);
    // A word that this version does not know allows nothing.
    if (!api_access_read_scopes(scopes, &e.about.scopes))
        e.about.scopes = 0;
    // NULL is also what SQLite gives when it has no memory.
    if (hash == NULL || sqlite3_column_bytes(q->statement, 3) != HASH_BYTES)
        return bf_fail(err, BF_ESYSTEM, "", "token %" PRIu64 " cannot be read", e.about.id);
    memcpy(e.hash, hash, HASH_BYTES);
    *ret_entry = e;
    return BF_OK;
}

static bf_status read_all(store__connection *c, entry *ret_entries, size_t *ret_n, bf_error *err)
{
    bool has_row = true;
    bf_status status = BF_OK;
    size_t n = 0;

    store__query q = store__begin(c, STORE__SQL_LIST_TOKENS);
    while (status == BF_OK && n < TOKENS_MAX) {
        status = store__next(&q, &has_row, err);
        if (status != BF_OK || !has_row)
            break;
        status = read_entry(&q, &ret_entries[n], err);
        n += status == BF_OK;
    }
    store__end(&q);
    *ret_n = n;
    return status;
}

static entry *find_id(entry *entries, size_t n, uint64_t id)
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

    log_event(LOG_LEVEL_INFO, event, "token=%" PRIu64 " name=%s owner=%s scopes=%s", about->id,
              about->name, about->owner, api_access_write_scopes(about->scopes, scopes));
}

// What was read takes the place of what was there; uses that are only in memory stay.
static void take_over(tokens *t, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        entry *now = &t->next[i];
        const entry *before = find_id(t->all, t->n, now->about.id);
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
    bf_status status = read_all(&t->reader, t->next, &n, &err);
    if (status == BF_OK) {
        t->read_ms = now_ms;
        take_over(t, n);
    } else if ((sqlite3_errcode(t->reader.db) & 0xff) != SQLITE_BUSY) {
        t->read_ms = now_ms;
        log_event(LOG_LEVEL_ERROR, "tokens_unreadable", "error=%s", log_quote(err.text, quoted));
    }
}

bf_status tokens_open(const char *directory, tokens **ret_tokens, bf_error *err)
{
    tokens *t = memory_alloc(1, sizeof *t);

    if (t == NULL)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    bf_status status = connect_to(directory, true, &t->reader, err);
    if (status == BF_OK && (status = read_all(&t->reader, t->all, &t->n, err)) != BF_OK)
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

static void hash_text(const char *text, unsigned char ret_hash[HASH_BYTES])
{
    (void)crypto_generichash(ret_hash, HASH_BYTES, (const unsigned char *)text, strlen(text), NULL,
                             0);
}

// All are compared, so that the time does not tell which one it was.
static entry *find_text(tokens *t, const char *text)
{
    unsigned char hash[HASH_BYTES];
    entry *found = NULL;

    if (strnlen(text, TOKENS_TEXT_SIZE) != TOKENS_TEXT_SIZE - 1)
        return NULL;
    hash_text(text, hash);
    for (size_t i = 0; i < t->n; i++) {
        if (sodium_memcmp(t->all[i].hash, hash, HASH_BYTES) == 0)
            found = &t->all[i];
    }
    return found;
}

static api_credential judge(entry *e, int64_t now_ms, api_identity *ret_who)
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
        entry *found = find_text(t, text);
        credential =
            found == NULL ? API_CREDENTIAL_UNKNOWN : judge(found, clock_unix_ms(), ret_who);
    }
    lock_release(&t->lock);
    return credential;
}

api_credential tokens_recall(tokens *t, uint64_t id, api_identity *ret_who)
{
    api_credential credential = API_CREDENTIAL_UNUSED;

    lock_acquire(&t->lock);
    refresh(t);
    if (t->n > 0) {
        entry *found = find_id(t->all, t->n, id);
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

static bf_status save_use(store__connection *c, uint64_t id, int64_t used_ms, bf_error *err)
{
    store__query q = store__begin(c, STORE__SQL_USE_TOKEN);
    store__bind_integer(&q, (int64_t)id);
    store__bind_integer(&q, used_ms);
    return store__run(&q, err);
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
            status = connect_to(t->directory, false, &c, &err);
        if (status == BF_OK)
            status = save_use(&c, id, used_ms, &err);
    }
    store__disconnect(&c);
    if (status != BF_OK)
        log_event(LOG_LEVEL_WARN, "token_use_not_saved", "error=%s", log_quote(err.text, quoted));
}

// Names are written as they are into logs and lists.
static bool is_name(const char *text)
{
    size_t n = strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._@+-");

    return n > 0 && n < TOKENS_NAME_SIZE && text[n] == '\0';
}

static void make_text(char *ret_text)
{
    unsigned char secret[SECRET_BYTES];
    const size_t n_prefix = sizeof prefix - 1;

    randombytes_buf(secret, sizeof secret);
    memcpy(ret_text, prefix, n_prefix);
    (void)sodium_bin2base64(ret_text + n_prefix, TOKENS_TEXT_SIZE - n_prefix, secret, sizeof secret,
                            sodium_base64_VARIANT_URLSAFE_NO_PADDING);
    sodium_memzero(secret, sizeof secret);
}

// Where there are too many, the oldest that does not count any more makes room.
static bf_status make_room(store__connection *c, int64_t now_ms, bf_error *err)
{
    int64_t n = 0;

    bf_status status = store__read_number(c, STORE__SQL_COUNT_TOKENS, &n, err);
    if (status != BF_OK || n < TOKENS_MAX)
        return status;
    store__query q = store__begin(c, STORE__SQL_FORGET_TOKEN);
    store__bind_integer(&q, now_ms);
    status = store__run(&q, err);
    if (status == BF_OK && sqlite3_changes(c->db) == 0)
        return bf_fail(err, BF_ELIMIT, "", "%d tokens are stored, the limit: revoke some first",
                       TOKENS_MAX);
    return status;
}

static bf_status insert(store__connection *c, tokens_record *token, const char *text, bf_error *err)
{
    unsigned char hash[HASH_BYTES];
    char scopes[API_SCOPES_SIZE];

    hash_text(text, hash);
    (void)api_access_write_scopes(token->scopes, scopes);
    bf_status status = make_room(c, token->created_ms, err);
    if (status != BF_OK)
        return status;
    store__query q = store__begin(c, STORE__SQL_INSERT_TOKEN);
    store__bind_text(&q, token->name, strlen(token->name));
    store__bind_text(&q, token->owner, strlen(token->owner));
    store__bind_blob(&q, hash, sizeof hash);
    store__bind_text(&q, scopes, strlen(scopes));
    store__bind_integer(&q, token->created_ms);
    store__bind_integer(&q, token->expires_ms);
    status = store__run(&q, err);
    if (status == BF_OK)
        token->id = (uint64_t)sqlite3_last_insert_rowid(c->db);
    return status;
}

bf_status tokens_add(const char *directory, tokens_record *token, char *ret_text, bf_error *err)
{
    store__connection c = { 0 };

    if (!is_name(token->name) || !is_name(token->owner))
        return bf_fail(err, BF_EINPUT, "",
                       "names and owners are 1 to %d letters, digits and .-_+@, not '%.64s'",
                       TOKENS_NAME_SIZE - 1, is_name(token->name) ? token->owner : token->name);
    bf_status status = connect_to(directory, true, &c, err);
    if (status != BF_OK)
        return status;
    make_text(ret_text);
    token->created_ms = clock_unix_ms();
    status = store__run_plain(&c, STORE__SQL_BEGIN_WRITE, err);
    if (status == BF_OK)
        status = store__end_transaction(&c, insert(&c, token, ret_text, err), err);
    store__disconnect(&c);
    return status;
}

bf_status tokens_revoke(const char *directory, uint64_t id, bf_error *err)
{
    store__connection c = { 0 };

    bf_status status = connect_to(directory, false, &c, err);
    if (status != BF_OK)
        return status;
    store__query q = store__begin(&c, STORE__SQL_REVOKE_TOKEN);
    store__bind_integer(&q, (int64_t)id);
    store__bind_integer(&q, clock_unix_ms());
    status = store__run(&q, err);
    if (status == BF_OK && sqlite3_changes(c.db) == 0)
        status = bf_fail(err, BF_ENOTFOUND, "", "there is no token %" PRIu64 " that counts", id);
    store__disconnect(&c);
    return status;
}

bf_status tokens_list(const char *directory, tokens_take_fn *take, void *context, bf_error *err)
{
    store__connection c = { 0 };
    size_t n = 0;

    bf_status status = connect_to(directory, false, &c, err);
    if (status != BF_OK)
        return status;
    entry *entries = memory_alloc(TOKENS_MAX, sizeof *entries);
    status = entries == NULL ? bf_fail(err, BF_ENOMEM, "", "out of memory")
                             : read_all(&c, entries, &n, err);
    store__disconnect(&c);
    for (size_t i = 0; status == BF_OK && i < n; i++)
        take(context, &entries[i].about);
    memory_free(entries);
    return status;
}
