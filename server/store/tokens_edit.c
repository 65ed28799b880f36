// Tokens that are added, revoked and listed, beside a daemon that may be running.

#include "server/store/tokens_rows.h"

#include "core/base/memory.h"
#include "server/base/clock.h"

#include <inttypes.h>
#include <sodium.h>
#include <sqlite3.h>
#include <string.h>

enum { SECRET_BYTES = 32 };

static const char prefix[] = "bft_";

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
    (void)sodium_bin2base64(ret_text + n_prefix, API_TOKEN_SIZE - n_prefix, secret, sizeof secret,
                            sodium_base64_VARIANT_URLSAFE_NO_PADDING);
    sodium_memzero(secret, sizeof secret);
}

// Where there are too many, the oldest that does not count any more makes room.
static bf_status make_room(store__connection *c, int64_t now_ms, bf_error *err)
{
    int64_t n = 0;

    BF_TRY(store__read_number(c, STORE__SQL_COUNT_TOKENS, &n, err));
    if (n < TOKENS_MAX)
        return BF_OK;
    BF_TRY(store__exec(c, STORE__SQL_FORGET_TOKEN, err, INTEGER(now_ms)));
    if (sqlite3_changes(c->db) == 0)
        return bf_fail(err, BF_ELIMIT, "", "%d tokens are stored, the limit: revoke some first",
                       TOKENS_MAX);
    return BF_OK;
}

// Grants are made by whoever may submit: they leave room for tokens that an operator adds.
static bf_status check_grants(store__connection *c, const char *owner, int64_t now_ms,
                              bf_error *err)
{
    int64_t n_own = 0, n_all = 0;

    BF_TRY(
        store__find_number(c, STORE__SQL_COUNT_GRANTS, &n_own, err, INTEGER(now_ms), TEXT(owner)));
    BF_TRY(store__find_number(c, STORE__SQL_COUNT_GRANTS, &n_all, err, INTEGER(now_ms), TEXT("")));
    if (n_own >= API_GRANTS_MAX)
        return bf_fail(err, BF_ELIMIT, "", "%d grants of yours count, the limit: revoke some first",
                       API_GRANTS_MAX);
    if (n_all >= TOKENS_GRANTS_MAX)
        return bf_fail(err, BF_ELIMIT, "", "%d grants are stored, the limit", TOKENS_GRANTS_MAX);
    return BF_OK;
}

static bf_status insert(store__connection *c, tokens_record *token, const char *text, bf_error *err)
{
    unsigned char hash[STORE__TOKEN_HASH_BYTES];
    char scopes[API_SCOPES_SIZE];

    store__hash_token(text, hash);
    (void)api_access_write_scopes(token->scopes, scopes);
    if (token->resource[0] != '\0')
        BF_TRY(check_grants(c, token->owner, token->created_ms, err));
    BF_TRY(make_room(c, token->created_ms, err));
#define X(kind, column, member) , kind(token->member)
    BF_TRY(store__exec(c, STORE__SQL_INSERT_TOKEN, err, BLOB(hash, sizeof hash),
                       TEXT(scopes) STORE__TOKEN_FIXED(X)));
#undef X
    token->id = (uint64_t)sqlite3_last_insert_rowid(c->db);
    return BF_OK;
}

bf_status tokens_add(const char *directory, tokens_record *token, char *ret_text, bf_error *err)
{
    store__connection c = { 0 };

    if (!is_name(token->name) || !is_name(token->owner))
        return bf_fail(err, BF_EINPUT, "",
                       "names and owners are 1 to %d letters, digits and .-_+@, not '%.64s'",
                       TOKENS_NAME_SIZE - 1, is_name(token->name) ? token->owner : token->name);
    BF_TRY(store__open_tokens(directory, true, &c, err));
    make_text(ret_text);
    token->created_ms = clock_unix_ms();
    bf_status status = store__run_plain(&c, STORE__SQL_BEGIN_WRITE, err);
    if (status == BF_OK)
        status = store__end_transaction(&c, insert(&c, token, ret_text, err), err);
    store__disconnect(&c);
    return status;
}

static bf_status find_valid(store__connection *c, uint64_t id, int64_t now_ms,
                            tokens_record *ret_token, bf_error *err)
{
    store__token *entries = memory_alloc(TOKENS_MAX, sizeof *entries);
    bool is_found = false;
    size_t n = 0;

    bf_status status =
        entries == NULL ? bf_fail_memory(err) : store__read_tokens(c, entries, &n, err);
    for (size_t i = 0; status == BF_OK && i < n; i++) {
        const tokens_record *about = &entries[i].about;
        if (about->id == id && tokens_counts(about, now_ms)) {
            *ret_token = *about;
            is_found = true;
        }
    }
    memory_free(entries);
    if (status == BF_OK && !is_found)
        status = bf_fail(err, BF_ENOTFOUND, "", "there is no token %" PRIu64 " that counts", id);
    return status;
}

static bf_status replace(store__connection *c, uint64_t id, int64_t overlap_ms,
                         tokens_record *ret_token, const char *text, bf_error *err)
{
    const int64_t now_ms = clock_unix_ms();
    tokens_record token;

    BF_TRY(find_valid(c, id, now_ms, &token, err));
    token.expires_ms = token.expires_ms == 0 ? 0 : now_ms + token.expires_ms - token.created_ms;
    token.created_ms = now_ms;
    token.used_ms = 0;
    BF_TRY(insert(c, &token, text, err));
    bf_status status =
        store__exec(c, STORE__SQL_END_TOKEN, err, INTEGER(id), INTEGER(now_ms + overlap_ms));
    *ret_token = token;
    return status;
}

bf_status tokens_rotate(const char *directory, uint64_t id, int64_t overlap_ms,
                        tokens_record *ret_token, char *ret_text, bf_error *err)
{
    store__connection c = { 0 };

    BF_TRY(store__open_tokens(directory, false, &c, err));
    make_text(ret_text);
    bf_status status = store__run_plain(&c, STORE__SQL_BEGIN_WRITE, err);
    if (status == BF_OK)
        status =
            store__end_transaction(&c, replace(&c, id, overlap_ms, ret_token, ret_text, err), err);
    store__disconnect(&c);
    return status;
}

bf_status tokens_revoke(const char *directory, uint64_t id, bf_error *err)
{
    store__connection c = { 0 };

    BF_TRY(store__open_tokens(directory, false, &c, err));
    bf_status status =
        store__exec(&c, STORE__SQL_REVOKE_TOKEN, err, INTEGER(id), INTEGER(clock_unix_ms()));
    if (status == BF_OK && sqlite3_changes(c.db) == 0)
        status = bf_fail(err, BF_ENOTFOUND, "", "there is no token %" PRIu64 " that counts", id);
    store__disconnect(&c);
    return status;
}

bf_status tokens_list(const char *directory, tokens_visit_fn *on_token, void *context,
                      bf_error *err)
{
    store__connection c = { 0 };
    size_t n = 0;

    BF_TRY(store__open_tokens(directory, false, &c, err));
    store__token *entries = memory_alloc(TOKENS_MAX, sizeof *entries);
    bf_status status =
        entries == NULL ? bf_fail_memory(err) : store__read_tokens(&c, entries, &n, err);
    store__disconnect(&c);
    for (size_t i = 0; status == BF_OK && i < n; i++)
        on_token(context, &entries[i].about);
    memory_free(entries);
    return status;
}
