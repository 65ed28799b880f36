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

    BF_TRY(store__read_number(c, STORE__SQL_HAS_TOKEN_RESOURCE, &n, err));
    if (n > 0)
        return BF_OK;
    BF_TRY(store__run_plain(c, STORE__SQL_BEGIN_WRITE, err));
    bf_status status = store__read_number(c, STORE__SQL_HAS_TOKEN_RESOURCE, &n, err);
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
    if (is_new)
        BF_TRY(create_file(directory, path, err));
    else if (access(path, F_OK) != 0)
        return bf_fail(err, BF_EINPUT, "", "there are no tokens in %.400s", directory);
    BF_TRY(store__connect(path, STORE__READ_WRITE, c, err));
    bf_status status = create_table(c, err);
    if (status == BF_OK)
        status = add_resource(c, err);
    if (status != BF_OK)
        store__disconnect(c);
    return status;
}

#define X(kind, column, member) COLUMN(kind, store__token, about.member),
static const store__column columns[] = { COLUMN(INTEGER, store__token, about.id),
                                         STORE__TOKEN_LIST(X) };
#undef X

static bf_status complete_token(const store__query *q, void *of, bool is_whole, bf_error *err)
{
    enum { SCOPES = sizeof columns / sizeof *columns, HASH };
    const void *hash = sqlite3_column_blob(q->statement, HASH);
    char scopes[API_SCOPES_SIZE];
    store__token *token = of;

    (void)is_whole; // its id is a number
    store__column_text(q, SCOPES, scopes, sizeof scopes);
    // A word that this version does not know allows nothing.
    if (!api_access_read_scopes(scopes, &token->about.scopes))
        token->about.scopes = 0;
    // NULL is also what SQLite gives when it has no memory.
    if (hash == NULL || sqlite3_column_bytes(q->statement, HASH) != STORE__TOKEN_HASH_BYTES)
        return bf_fail(err, BF_ESYSTEM, "", "token %" PRIu64 " cannot be read", token->about.id);
    memcpy(token->hash, hash, STORE__TOKEN_HASH_BYTES);
    return BF_OK;
}

static const store__record record = RECORD(columns, store__token, complete_token);

bf_status store__read_tokens(store__connection *c, store__token *ret_tokens, size_t *ret_n,
                             bf_error *err)
{
    return store__list_with(c, STORE__SQL_LIST_TOKENS, &record, ret_tokens, TOKENS_MAX, ret_n, NULL,
                            err, NULL, 0);
}

void store__hash_token(const char *text, unsigned char ret_hash[STORE__TOKEN_HASH_BYTES])
{
    (void)crypto_generichash(ret_hash, STORE__TOKEN_HASH_BYTES, (const unsigned char *)text,
                             strlen(text), NULL, 0);
}
