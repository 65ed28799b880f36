#include "server/store/tokens_rows.h"

#include "server/store/page_sums.h"

#include "server/base/file_io.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <sodium.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

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

// Files of versions without grants lack their column. Another process may add it at this moment.
static bf_status add_resource(store__connection *c, bf_error *err)
{
    int64_t n = 0;

    bf_status status = store__read_number(c, STORE__SQL_HAS_TOKEN_RESOURCE, &n, err);
    if (status != BF_OK || n > 0)
        return status;
    status = store__run_plain(c, STORE__SQL_BEGIN_WRITE, err);
    if (status != BF_OK)
        return status;
    status = store__read_number(c, STORE__SQL_HAS_TOKEN_RESOURCE, &n, err);
    if (status == BF_OK && n == 0)
        status = store__run_plain(c, STORE__SQL_ADD_TOKEN_RESOURCE, err);
    return store__end_transaction(c, status, err);
}

bf_status store__open_tokens(const char *directory, bool is_new, store__connection *c,
                             bf_error *err)
{
    char path[STORE__TOKENS_PATH_SIZE + 16];

    if (strlen(directory) >= STORE__TOKENS_PATH_SIZE)
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
    if (status != BF_OK)
        return status;
    status = create_table(c, err);
    if (status == BF_OK)
        status = add_resource(c, err);
    if (status != BF_OK)
        store__disconnect(c);
    return status;
}

static bf_status read_entry(const store__query *q, store__token *ret_token, bf_error *err)
{
    const void *hash = sqlite3_column_blob(q->statement, 3);
    char scopes[API_SCOPES_SIZE];
    store__token e = { .about = { .id = (uint64_t)sqlite3_column_int64(q->statement, 0),
                                  .created_ms = sqlite3_column_int64(q->statement, 5),
                                  .expires_ms = sqlite3_column_int64(q->statement, 6),
                                  .used_ms = sqlite3_column_int64(q->statement, 7),
                                  .revoked_ms = sqlite3_column_int64(q->statement, 8) } };

    store__column_text(q, 1, e.about.name, sizeof e.about.name);
    store__column_text(q, 2, e.about.owner, sizeof e.about.owner);
    store__column_text(q, 4, scopes, sizeof scopes);
    store__column_text(q, 9, e.about.resource, sizeof e.about.resource);
    // A word that this version does not know allows nothing.
    if (!api_access_read_scopes(scopes, &e.about.scopes))
        e.about.scopes = 0;
    // NULL is also what SQLite gives when it has no memory.
    if (hash == NULL || sqlite3_column_bytes(q->statement, 3) != STORE__TOKEN_HASH_BYTES)
        return bf_fail(err, BF_ESYSTEM, "", "token %" PRIu64 " cannot be read", e.about.id);
    memcpy(e.hash, hash, STORE__TOKEN_HASH_BYTES);
    *ret_token = e;
    return BF_OK;
}

bf_status store__read_tokens(store__connection *c, store__token *ret_tokens, size_t *ret_n,
                             bf_error *err)
{
    bf_status status = BF_OK;
    size_t n = 0;

    store__query q = store__begin(c, STORE__SQL_LIST_TOKENS);
    while (n < TOKENS_MAX && store__next(&q, &status, err)) {
        status = read_entry(&q, &ret_tokens[n], err);
        n += status == BF_OK;
    }
    store__end(&q);
    *ret_n = n;
    return status;
}

void store__hash_token(const char *text, unsigned char ret_hash[STORE__TOKEN_HASH_BYTES])
{
    (void)crypto_generichash(ret_hash, STORE__TOKEN_HASH_BYTES, (const unsigned char *)text,
                             strlen(text), NULL, 0);
}
