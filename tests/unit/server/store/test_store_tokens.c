// Unit tests of access tokens: what is stored of them, what counts, and that changes beside a daemon are seen.

#include "server/base/clock.h"
#include "server/store/tokens.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_store.h"

#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char directory[64];

static int set_up(void **state)
{
    (void)snprintf(directory, sizeof directory, "/tmp/beltflow-tokens-XXXXXX");
    return mkdtemp(directory) == NULL;
}

static int tear_down(void **state)
{
    helper_store_remove_directory(directory);
    return 0;
}

static tokens_record add(const char *name, unsigned scopes, int64_t expires_ms, char *ret_text)
{
    tokens_record token = { .scopes = scopes, .expires_ms = expires_ms };
    bf_error err = { 0 };

    (void)snprintf(token.name, sizeof token.name, "%s", name);
    (void)snprintf(token.owner, sizeof token.owner, "%s", name);
    if (tokens_add(directory, &token, ret_text, &err) != BF_OK)
        fail_msg("%s", err.text);
    return token;
}

static tokens *open_tokens(void)
{
    tokens *t = NULL;
    bf_error err = { 0 };

    if (tokens_open(directory, &t, &err) != BF_OK)
        fail_msg("%s", err.text);
    return t;
}

// Wait until a token is judged so, for as long as a change may take to count and a good deal longer.
static void await(tokens *t, const char *text, api_credential wanted)
{
    api_identity who;

    HELPER_AWAIT(tokens_identify(t, text, &who) == wanted);
}

static void run_sql(const char *sql)
{
    char path[80];
    sqlite3 *db = NULL;

    (void)snprintf(path, sizeof path, "%s/access.db", directory);
    assert_int_equal(sqlite3_open_v2(path, &db, SQLITE_OPEN_READWRITE, "beltflow-sums"), SQLITE_OK);
    assert_int_equal(sqlite3_busy_timeout(db, 5000), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static void without_tokens_nobody_needs_one(void **state)
{
    tokens *t = open_tokens();
    api_identity who = { .token = 7 };

    assert_false(tokens_exist(t));
    assert_int_equal(tokens_identify(t, NULL, &who), API_CREDENTIAL_UNUSED);
    assert_int_equal(tokens_identify(t, "bft_x", &who), API_CREDENTIAL_UNUSED);
    assert_int_equal(tokens_identify_by_id(t, 1, &who), API_CREDENTIAL_UNUSED);
    assert_int_equal(who.token, 7);
    assert_null(tokens_close(t));
}

static void a_token_tells_who_has_it(void **state)
{
    char first[API_TOKEN_SIZE], second[API_TOKEN_SIZE], other[API_TOKEN_SIZE];
    api_identity who = { 0 };

    (void)add("alice", API_SCOPE_READ | API_SCOPE_SUBMIT, 0, first);
    (void)add("bob", API_SCOPE_ADMIN, 0, second);
    assert_int_equal(strlen(first), API_TOKEN_SIZE - 1);
    assert_memory_equal(first, "bft_", 4);
    assert_string_not_equal(first, second);
    tokens *t = open_tokens();
    assert_true(tokens_exist(t));
    assert_int_equal(tokens_identify(t, NULL, &who), API_CREDENTIAL_MISSING);
    assert_int_equal(tokens_identify(t, second, &who), API_CREDENTIAL_VALID);
    assert_string_equal(who.owner, "bob");
    assert_int_equal(who.token, 2);
    assert_int_equal(who.scopes, API_SCOPE_ADMIN);
    assert_int_equal(tokens_identify(t, first, &who), API_CREDENTIAL_VALID);
    assert_string_equal(who.owner, "alice");
    // Each character counts, and so does the length.
    for (size_t i = 0; i < sizeof first - 1; i++) {
        memcpy(other, first, sizeof other);
        other[i] = other[i] == 'A' ? 'B' : 'A';
        assert_int_equal(tokens_identify(t, other, &who), API_CREDENTIAL_UNKNOWN);
    }
    other[10] = '\0';
    assert_int_equal(tokens_identify(t, other, &who), API_CREDENTIAL_UNKNOWN);
    assert_int_equal(tokens_identify(t, "", &who), API_CREDENTIAL_UNKNOWN);
    assert_null(tokens_close(t));
}

static void the_file_has_no_token_and_is_for_its_owner_alone(void **state)
{
    char text[API_TOKEN_SIZE], path[80], bytes[65536];
    struct stat info;

    (void)add("alice", API_SCOPE_READ, 0, text);
    (void)snprintf(path, sizeof path, "%s/access.db", directory);
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0600);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t n = fread(bytes, 1, sizeof bytes, file);
    assert_int_equal(fclose(file), 0);
    assert_true(n > 0 && n < sizeof bytes);
    assert_non_null(memmem(bytes, n, "alice", 5));
    assert_null(memmem(bytes, n, text + 4, 8));
}

static void what_is_expired_or_revoked_does_not_count(void **state)
{
    char old[API_TOKEN_SIZE], later[API_TOKEN_SIZE], revoked[API_TOKEN_SIZE];
    int64_t now_ms = clock_unix_ms();
    api_identity who = { 0 };

    (void)add("old", API_SCOPE_READ, now_ms - 1, old);
    (void)add("later", API_SCOPE_READ, now_ms + 3600000, later);
    const tokens_record gone = add("gone", API_SCOPE_READ, 0, revoked);
    assert_int_equal(tokens_revoke(directory, gone.id, NULL), BF_OK);
    assert_int_equal(tokens_revoke(directory, gone.id, NULL), BF_ENOTFOUND);
    assert_int_equal(tokens_revoke(directory, 99, NULL), BF_ENOTFOUND);
    tokens *t = open_tokens();
    assert_int_equal(tokens_identify(t, old, &who), API_CREDENTIAL_EXPIRED);
    assert_int_equal(tokens_identify(t, revoked, &who), API_CREDENTIAL_REVOKED);
    assert_int_equal(who.token, 0);
    assert_int_equal(tokens_identify_by_id(t, 1, &who), API_CREDENTIAL_EXPIRED);
    assert_int_equal(tokens_identify_by_id(t, gone.id, &who), API_CREDENTIAL_REVOKED);
    assert_int_equal(tokens_identify_by_id(t, 99, &who), API_CREDENTIAL_UNKNOWN);
    assert_int_equal(who.token, 0);
    assert_int_equal(tokens_identify(t, later, &who), API_CREDENTIAL_VALID);
    assert_int_equal(tokens_identify_by_id(t, 2, &who), API_CREDENTIAL_VALID);
    assert_string_equal(who.owner, "later");
    assert_null(tokens_close(t));
    // None that counts is left, and still requests need one.
    assert_int_equal(tokens_revoke(directory, 2, NULL), BF_OK);
    t = open_tokens();
    assert_true(tokens_exist(t));
    assert_int_equal(tokens_identify(t, NULL, &who), API_CREDENTIAL_MISSING);
    assert_null(tokens_close(t));
}

static void a_daemon_sees_what_is_changed_beside_it(void **state)
{
    char text[API_TOKEN_SIZE];
    tokens *t = open_tokens();

    const tokens_record token = add("alice", API_SCOPE_READ, 0, text);
    await(t, text, API_CREDENTIAL_VALID);
    assert_int_equal(tokens_revoke(directory, token.id, NULL), BF_OK);
    await(t, text, API_CREDENTIAL_REVOKED);
    assert_null(tokens_close(t));
}

// Take the first token, and that there is one.
static void take_first(void *context, const tokens_record *token)
{
    tokens_record *first = context;

    if (first->id == 0)
        *first = *token;
}

static void the_last_use_is_written_down_later(void **state)
{
    char text[API_TOKEN_SIZE];
    tokens_record before = { .id = 0 }, after = { .id = 0 };
    api_identity who;

    (void)add("alice", API_SCOPE_READ, 0, text);
    tokens *t = open_tokens();
    int64_t used_ms = clock_unix_ms();
    assert_int_equal(tokens_identify(t, text, &who), API_CREDENTIAL_VALID);
    assert_int_equal(tokens_list(directory, take_first, &before, NULL), BF_OK);
    assert_int_equal(before.used_ms, 0);
    tokens_save_uses(t);
    assert_int_equal(tokens_list(directory, take_first, &after, NULL), BF_OK);
    assert_true(after.used_ms >= used_ms);
    // A second use in the same minute is none.
    run_sql("UPDATE tokens SET used_ms = 1");
    assert_int_equal(tokens_identify(t, text, &who), API_CREDENTIAL_VALID);
    assert_null(tokens_close(t));
    after.id = 0;
    assert_int_equal(tokens_list(directory, take_first, &after, NULL), BF_OK);
    assert_int_equal(after.used_ms, 1);
}

// The token of a number, as it is stored.
static void take_wanted(void *context, const tokens_record *token)
{
    tokens_record *wanted = context;

    if (token->id == wanted->id)
        *wanted = *token;
}

static tokens_record find(uint64_t id)
{
    tokens_record found = { .id = id };

    assert_int_equal(tokens_list(directory, take_wanted, &found, NULL), BF_OK);
    assert_string_not_equal(found.name, "");
    return found;
}

// Whether a day has passed is told by moving the end, not by waiting for it.
static void a_rotated_token_counts_until_its_overlap_is_over(void **state)
{
    enum { DAY_MS = 24 * 3600 * 1000 };
    char old[API_TOKEN_SIZE], young[API_TOKEN_SIZE];
    api_identity who = { 0 };
    tokens_record made;

    const int64_t before_ms = clock_unix_ms();
    const tokens_record first = add("alice", API_SCOPE_READ, 0, old);
    tokens *t = open_tokens();
    assert_int_equal(tokens_rotate(directory, first.id, DAY_MS, &made, young, NULL), BF_OK);
    const int64_t after_ms = clock_unix_ms();
    tokens_read_again(t);
    assert_int_equal(tokens_identify(t, old, &who), API_CREDENTIAL_VALID);
    assert_int_equal(who.token, first.id);
    assert_int_equal(tokens_identify(t, young, &who), API_CREDENTIAL_VALID);
    assert_int_equal(who.token, made.id);
    assert_string_equal(who.owner, "alice");
    assert_int_equal(who.scopes, API_SCOPE_READ);
    assert_int_not_equal(made.id, first.id);
    assert_int_equal(made.expires_ms, 0);
    assert_in_range(find(first.id).expires_ms, before_ms + DAY_MS, after_ms + DAY_MS);
    run_sql("UPDATE tokens SET expires_ms = expires_ms - 86400001 WHERE id = 1");
    tokens_read_again(t);
    assert_int_equal(tokens_identify(t, old, &who), API_CREDENTIAL_EXPIRED);
    assert_int_equal(tokens_identify(t, young, &who), API_CREDENTIAL_VALID);
    assert_int_equal(tokens_rotate(directory, first.id, DAY_MS, &made, young, NULL), BF_ENOTFOUND);
    assert_null(tokens_close(t));
}

static void a_rotation_prolongs_no_token_and_gives_a_whole_life(void **state)
{
    enum { HOUR_MS = 3600 * 1000 };
    char old[API_TOKEN_SIZE], young[API_TOKEN_SIZE];
    api_identity who = { 0 };
    tokens_record made;

    const tokens_record first = add("alice", API_SCOPE_READ, clock_unix_ms() + HOUR_MS, old);
    assert_int_equal(tokens_rotate(directory, first.id, 24 * HOUR_MS, &made, young, NULL), BF_OK);
    assert_int_equal(find(first.id).expires_ms, first.expires_ms);
    assert_int_equal(made.expires_ms - made.created_ms, first.expires_ms - first.created_ms);
    assert_int_equal(find(made.id).expires_ms, made.expires_ms);
    assert_int_equal(tokens_rotate(directory, first.id, 0, &made, young, NULL), BF_OK);
    tokens *t = open_tokens();
    assert_int_equal(tokens_identify(t, old, &who), API_CREDENTIAL_EXPIRED);
    assert_int_equal(tokens_identify(t, young, &who), API_CREDENTIAL_VALID);
    assert_null(tokens_close(t));
}

static void a_scope_of_a_later_version_allows_nothing(void **state)
{
    char text[API_TOKEN_SIZE];
    api_identity who;

    (void)add("alice", API_SCOPE_ADMIN, 0, text);
    run_sql("UPDATE tokens SET scopes = 'read,fly'");
    tokens *t = open_tokens();
    assert_int_equal(tokens_identify(t, text, &who), API_CREDENTIAL_VALID);
    assert_int_equal(who.scopes, 0);
    assert_null(tokens_close(t));
}

// A token for one run or study.
static bf_status add_grant(const char *owner, const char *resource, int64_t expires_ms,
                           char *ret_text, uint64_t *ret_id)
{
    tokens_record token = { .name = "grant",
                            .scopes = API_SCOPE_GRANTED,
                            .expires_ms = expires_ms };

    (void)snprintf(token.owner, sizeof token.owner, "%s", owner);
    (void)snprintf(token.resource, sizeof token.resource, "%s", resource);
    const bf_status status = tokens_add(directory, &token, ret_text, NULL);
    *ret_id = token.id;
    return status;
}

static void a_grant_names_what_it_reads(void **state)
{
    static const char path[] = "/v1/studies/0190a0b0-0000-7000-8000-000000000001";
    char text[API_TOKEN_SIZE];
    api_identity who;
    uint64_t id = 0;

    assert_true(strlen(path) < API_RESOURCE_SIZE);
    assert_int_equal(add_grant("alice", path, INT64_MAX, text, &id), BF_OK);
    tokens *t = open_tokens();
    assert_int_equal(tokens_identify(t, text, &who), API_CREDENTIAL_VALID);
    assert_string_equal(who.resource, path);
    assert_string_equal(who.owner, "alice");
    assert_int_equal(who.scopes, API_SCOPE_GRANTED);
    assert_int_equal(tokens_revoke(directory, id, NULL), BF_OK);
    tokens_read_again(t);
    assert_int_equal(tokens_identify(t, text, &who), API_CREDENTIAL_REVOKED);
    assert_null(tokens_close(t));
}

static void grants_have_limits_and_leave_room_for_tokens(void **state)
{
    char text[API_TOKEN_SIZE];
    uint64_t id = 0;

    (void)add("first", API_SCOPE_READ, 0, text);
    for (int i = 0; i < API_GRANTS_MAX; i++)
        assert_int_equal(add_grant("alice", "/v1/runs/1", INT64_MAX, text, &id), BF_OK);
    assert_int_equal(add_grant("alice", "/v1/runs/1", INT64_MAX, text, &id), BF_ELIMIT);
    assert_int_equal(add_grant("bob", "/v1/runs/1", INT64_MAX, text, &id), BF_OK);
    assert_int_equal(tokens_revoke(directory, 2, NULL), BF_OK);
    assert_int_equal(add_grant("alice", "/v1/runs/1", INT64_MAX, text, &id), BF_OK);
    run_sql("WITH RECURSIVE k(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM k WHERE i < 749) "
            "INSERT INTO tokens (name, owner, hash, scopes, created_ms, expires_ms, resource) "
            "SELECT 'grant', 'o' || i, randomblob(32), 'granted', 1, 9e15, '/v1/runs/1' FROM k");
    assert_int_equal(add_grant("carol", "/v1/runs/1", INT64_MAX, text, &id), BF_ELIMIT);
    (void)add("operator", API_SCOPE_READ, 0, text);
}

// As a version without grants left it.
static void a_file_without_grants_gets_their_column(void **state)
{
    char text[API_TOKEN_SIZE], other[API_TOKEN_SIZE];
    api_identity who;
    uint64_t id = 0;

    (void)add("alice", API_SCOPE_READ, 0, text);
    run_sql("ALTER TABLE tokens DROP COLUMN resource");
    tokens *t = open_tokens();
    assert_int_equal(tokens_identify(t, text, &who), API_CREDENTIAL_VALID);
    assert_string_equal(who.resource, "");
    assert_int_equal(add_grant("alice", "/v1/runs/1", INT64_MAX, other, &id), BF_OK);
    tokens_read_again(t);
    assert_int_equal(tokens_identify(t, other, &who), API_CREDENTIAL_VALID);
    assert_string_equal(who.resource, "/v1/runs/1");
    assert_null(tokens_close(t));
}

static void a_row_without_a_hash_is_no_token(void **state)
{
    char text[API_TOKEN_SIZE];
    tokens *t = NULL;

    (void)add("alice", API_SCOPE_READ, 0, text);
    run_sql("PRAGMA ignore_check_constraints = ON; UPDATE tokens SET hash = x'00'");
    assert_int_equal(tokens_open(directory, &t, NULL), BF_ESYSTEM);
}

static void names_and_their_number_have_limits(void **state)
{
    static const char *const bad[] = { "", "a b", "a\nb", "a=b", "\"", "ä" };
    char text[API_TOKEN_SIZE];
    bf_error err = { 0 };

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        tokens_record token = { .name = "x", .scopes = API_SCOPE_READ };
        (void)snprintf(token.owner, sizeof token.owner, "%s", bad[i]);
        assert_int_equal(tokens_add(directory, &token, text, NULL), BF_EINPUT);
    }
    assert_int_equal(tokens_list(directory, take_first, NULL, &err), BF_EINPUT);
    (void)add("first", API_SCOPE_READ, 0, text);
    run_sql("WITH RECURSIVE k(i) AS (SELECT 2 UNION ALL SELECT i + 1 FROM k WHERE i < 1000) "
            "INSERT INTO tokens (name, owner, hash, scopes, created_ms, expires_ms) "
            "SELECT 'n', 'o', randomblob(32), 'read', 1, 0 FROM k");
    tokens_record one_more = { .name = "more", .owner = "more", .scopes = API_SCOPE_READ };
    assert_int_equal(tokens_add(directory, &one_more, text, &err), BF_ELIMIT);
    // One that does not count any more makes room; ids are not used again.
    assert_int_equal(tokens_revoke(directory, 500, NULL), BF_OK);
    assert_int_equal(tokens_add(directory, &one_more, text, &err), BF_OK);
    assert_int_equal(one_more.id, 1001);
    assert_int_equal(tokens_revoke(directory, 500, NULL), BF_ENOTFOUND);
}

static void damage_is_no_open_door(void **state)
{
    char text[API_TOKEN_SIZE], path[80];
    tokens *t = NULL;
    bf_error err = { 0 };

    (void)add("alice", API_SCOPE_READ, 0, text);
    (void)snprintf(path, sizeof path, "%s/access.db", directory);
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, 4096 + 200, SEEK_SET), 0);
    assert_int_equal(fputc(0x55, file), 0x55);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(tokens_open(directory, &t, &err), BF_ESYSTEM);
    assert_null(t);
}

#define TOKENS_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TOKENS_TEST(without_tokens_nobody_needs_one),
        TOKENS_TEST(a_token_tells_who_has_it),
        TOKENS_TEST(the_file_has_no_token_and_is_for_its_owner_alone),
        TOKENS_TEST(what_is_expired_or_revoked_does_not_count),
        TOKENS_TEST(a_daemon_sees_what_is_changed_beside_it),
        TOKENS_TEST(the_last_use_is_written_down_later),
        TOKENS_TEST(a_rotated_token_counts_until_its_overlap_is_over),
        TOKENS_TEST(a_rotation_prolongs_no_token_and_gives_a_whole_life),
        TOKENS_TEST(a_scope_of_a_later_version_allows_nothing),
        TOKENS_TEST(a_grant_names_what_it_reads),
        TOKENS_TEST(grants_have_limits_and_leave_room_for_tokens),
        TOKENS_TEST(a_file_without_grants_gets_their_column),
        TOKENS_TEST(a_row_without_a_hash_is_no_token),
        TOKENS_TEST(names_and_their_number_have_limits),
        TOKENS_TEST(damage_is_no_open_door),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
