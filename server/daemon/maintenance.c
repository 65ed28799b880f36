#include "server/daemon/maintenance.h"

#include "server/base/clock.h"
#include "server/store/backup.h"
#include "server/store/tokens.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

enum {
    EXIT_ARGUMENTS = 2,
    PATH_SIZE = 1100,
    HOUR_MS = 3600 * 1000,
    EXPIRY_MAX = 36500, // days or hours
    TIME_SIZE = 24,     // bytes of a time with its terminator
};

static int complain(const bf_error *err)
{
    (void)fprintf(stderr, "beltflowd: %s\n", err->text);
    return err->code == BF_EINPUT ? EXIT_ARGUMENTS : EXIT_FAILURE;
}

int maintenance_backup(const char *directory, const char *file)
{
    bf_error err = { 0 };
    struct stat facts;

    if (store_backup(directory, file, &err) != BF_OK)
        return complain(&err);
    if (stat(file, &facts) == 0)
        (void)printf("%s: %lld bytes\n", file, (long long)facts.st_size);
    return EXIT_SUCCESS;
}

static void print_outcome(void *context, const char *name, const char *claim, const char *finding)
{
    (void)context;
    if (finding == NULL)
        (void)printf("ok      %-10s %s\n", name, claim);
    else
        (void)printf("FAILED  %-10s %s: %s\n", name, claim, finding);
    (void)fflush(stdout);
}

int maintenance_verify(const char *directory, const char *file)
{
    char path[PATH_SIZE];
    bool is_sound = false;
    bf_error err = { 0 };

    (void)snprintf(path, sizeof path, "%s%s", file == NULL ? directory : file,
                   file == NULL ? "/beltflow.db" : "");
    if (store_verify(path, print_outcome, NULL, &is_sound, &err) != BF_OK)
        return complain(&err);
    (void)printf("%s is %s\n", path, is_sound ? "sound" : "damaged");
    return is_sound ? EXIT_SUCCESS : EXIT_FAILURE;
}

// "90d" or "12h", from now on; NULL is never, 0.
static bf_status read_expiry(const char *text, int64_t *ret_at_ms, bf_error *err)
{
    char *end = NULL;

    *ret_at_ms = 0;
    if (text == NULL)
        return BF_OK;
    unsigned long n = strspn(text, "0123456789") == 0 ? 0 : strtoul(text, &end, 10);
    bool is_days = n > 0 && strcmp(end, "d") == 0;
    bool is_hours = n > 0 && strcmp(end, "h") == 0;
    if ((!is_days && !is_hours) || n > EXPIRY_MAX)
        return bf_fail(err, BF_EINPUT, "",
                       "--expires wants 1 to %d days or hours, such as 90d or 12h, not '%.40s'",
                       EXPIRY_MAX, text);
    *ret_at_ms = clock_unix_ms() + (int64_t)n * HOUR_MS * (is_days ? 24 : 1);
    return BF_OK;
}

static bf_status copy_name(const char *text, char *ret_name, size_t size, bf_error *err)
{
    if (strlen(text) >= size)
        return bf_fail(err, BF_EINPUT, "", "names and owners have at most %zu characters",
                       size - 1);
    memcpy(ret_name, text, strlen(text) + 1);
    return BF_OK;
}

static bf_status read_wanted(const maintenance_token *wanted, tokens_record *token, bf_error *err)
{
    const char *scopes = wanted->scopes == NULL ? "read,submit" : wanted->scopes;
    const char *owner = wanted->owner == NULL ? wanted->name : wanted->owner;

    if (!api_access_read_scopes(scopes, &token->scopes))
        return bf_fail(err, BF_EINPUT, "",
                       "--scopes wants words of read,submit,work,admin,priority, not '%.40s'",
                       scopes);
    bf_status status = copy_name(wanted->name, token->name, sizeof token->name, err);
    if (status == BF_OK)
        status = copy_name(owner, token->owner, sizeof token->owner, err);
    return status == BF_OK ? read_expiry(wanted->expires, &token->expires_ms, err) : status;
}

int maintenance_token_add(const char *directory, const maintenance_token *wanted)
{
    tokens_record token = { 0 };
    char text[TOKENS_TEXT_SIZE], scopes[API_SCOPES_SIZE];
    bf_error err = { 0 };

    bf_status status = read_wanted(wanted, &token, &err);
    if (status == BF_OK)
        status = tokens_add(directory, &token, text, &err);
    if (status != BF_OK)
        return complain(&err);
    (void)fprintf(stderr, "token %" PRIu64 " of %s (%s); it is shown only now:\n", token.id,
                  token.owner, api_access_write_scopes(token.scopes, scopes));
    (void)printf("%s\n", text);
    return fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

static const char *write_time(int64_t at_ms, const char *none, char *storage)
{
    time_t seconds = (time_t)(at_ms / 1000);
    struct tm parts;

    if (at_ms == 0 || gmtime_r(&seconds, &parts) == NULL ||
        strftime(storage, TIME_SIZE, "%Y-%m-%dT%H:%M:%SZ", &parts) == 0)
        return none;
    return storage;
}

static const char *state_of(const tokens_record *token)
{
    if (token->revoked_ms != 0)
        return "revoked";
    return token->expires_ms != 0 && token->expires_ms <= clock_unix_ms() ? "expired" : "valid";
}

static void print_token(void *context, const tokens_record *token)
{
    char scopes[API_SCOPES_SIZE], created[TIME_SIZE], expires[TIME_SIZE], used[TIME_SIZE];

    (void)context;
    (void)printf(
        "%-4" PRIu64 " %-8s %-16s %-16s %-18s %-20s %-20s %s\n", token->id, state_of(token),
        token->name, token->owner, api_access_write_scopes(token->scopes, scopes),
        write_time(token->created_ms, "-", created),
        write_time(token->expires_ms, "never", expires), write_time(token->used_ms, "never", used));
}

int maintenance_token_list(const char *directory)
{
    bf_error err = { 0 };

    (void)printf("%-4s %-8s %-16s %-16s %-18s %-20s %-20s %s\n", "id", "state", "name", "owner",
                 "scopes", "created", "expires", "last use");
    if (tokens_list(directory, print_token, NULL, &err) != BF_OK)
        return complain(&err);
    return fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int maintenance_token_revoke(const char *directory, const char *id)
{
    bf_error err = { 0 };
    char *end = NULL;
    bf_status status;
    uint64_t number = strtoull(id, &end, 10);

    if (*id < '0' || *id > '9' || *end != '\0' || number > INT64_MAX)
        status =
            bf_fail(&err, BF_EINPUT, "", "token revoke wants an id of token list, not '%.40s'", id);
    else
        status = tokens_revoke(directory, number, &err);
    if (status != BF_OK)
        return complain(&err);
    (void)printf("token %" PRIu64 " is revoked\n", number);
    return EXIT_SUCCESS;
}
