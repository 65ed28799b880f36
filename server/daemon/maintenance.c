#include "server/daemon/maintenance.h"

#include "api/json/number.h"
#include "server/base/clock.h"
#include "server/base/file_io.h"
#include "server/store/backup.h"
#include "server/store/restore.h"
#include "server/store/tokens.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define COPY_PREFIX "beltflow-"
#define COPY_ENDING ".db"

enum {
    SETTINGS_BYTES = 1 << 20,
    COPIES_MAX = 10000,
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

// readers: a directory whose group may read what root writes; NULL: nobody else may.
static bf_status copy_settings(const char *from, const char *to, const char *readers, bf_error *err)
{
    bf_buffer text = { 0 };
    struct stat whose;

    bf_status status = file_io_read(from, NULL, SETTINGS_BYTES, &text, err);
    const int fd = status == BF_OK ? open(to, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600) : -1;
    if (status == BF_OK && (fd < 0 || !file_io_write_fd(fd, text.bytes, text.n) || fsync(fd) != 0))
        status = bf_fail(err, BF_ESYSTEM, "", "cannot write %.200s: %s", to, strerror(errno));
    if (status == BF_OK && readers != NULL && geteuid() == 0 &&
        (stat(readers, &whose) != 0 || fchown(fd, 0, whose.st_gid) != 0 || fchmod(fd, 0640) != 0))
        status =
            bf_fail(err, BF_ESYSTEM, "", "cannot set the owner of %.200s: %s", to, strerror(errno));
    if (fd >= 0)
        (void)close(fd);
    buffer_fini(&text);
    return status;
}

static int is_copy(const struct dirent *entry)
{
    const char *name = entry->d_name;

    return strncmp(name, COPY_PREFIX, strlen(COPY_PREFIX)) == 0 &&
           strlen(name) == strlen(COPY_PREFIX "20000101T000000Z" COPY_ENDING) &&
           strcmp(name + strlen(name) - strlen(COPY_ENDING), COPY_ENDING) == 0;
}

// Remove the oldest copies of a directory with what belongs to them; their names are in the order of time.
static bf_status thin_out(const char *folder, size_t n_most, bf_error *err)
{
    static const char *const endings[] = { "", ".access", ".conf" };
    struct dirent **entries = NULL;
    char path[PATH_SIZE];
    bf_status status = BF_OK;

    const int n = scandir(folder, &entries, is_copy, alphasort);
    if (n < 0)
        return bf_fail(err, BF_ESYSTEM, "", "cannot read %.200s: %s", folder, strerror(errno));
    for (int i = 0; i < n; i++) {
        for (size_t k = 0; (size_t)i + n_most < (size_t)n && k < 3; k++) {
            (void)snprintf(path, sizeof path, "%.800s/%.200s%s", folder, entries[i]->d_name,
                           endings[k]);
            if (unlink(path) != 0 && errno != ENOENT)
                status =
                    bf_fail(err, BF_ESYSTEM, "", "cannot remove %.200s: %s", path, strerror(errno));
        }
        free(entries[i]);
    }
    free(entries);
    return status;
}

static bf_status back_up(const char *directory, const char *settings, const char *file,
                         bf_error *err)
{
    char path[PATH_SIZE];
    struct stat facts;

    bf_status status = store_backup(directory, file, err);
    if (status != BF_OK)
        return status;
    (void)snprintf(path, sizeof path, "%.1000s.conf", file);
    if (settings != NULL && (status = copy_settings(settings, path, NULL, err)) != BF_OK) {
        (void)unlink(file);
        (void)snprintf(path, sizeof path, "%.1000s.access", file);
        (void)unlink(path);
        return status;
    }
    if (stat(file, &facts) == 0)
        (void)printf("%s: %lld bytes\n", file, (long long)facts.st_size);
    return BF_OK;
}

int maintenance_backup(const char *directory, const char *settings, const char *file,
                       const char *copies)
{
    const time_t now = (time_t)(clock_unix_ms() / 1000);
    char path[PATH_SIZE], name[48];
    uint64_t n_most = COPIES_MAX;
    bf_status status = BF_OK;
    struct stat facts;
    struct tm parts;
    bf_error err = { 0 };

    const bool is_folder = stat(file, &facts) == 0 && S_ISDIR(facts.st_mode);
    if (copies != NULL && !number_read_digits(copies, 1, COPIES_MAX, &n_most))
        status =
            bf_fail(&err, BF_EINPUT, "", "--copies wants 1 to %d, not '%.40s'", COPIES_MAX, copies);
    else if (copies != NULL && !is_folder)
        status =
            bf_fail(&err, BF_EINPUT, "", "--copies wants a directory, and %.200s is none", file);
    (void)strftime(name, sizeof name, COPY_PREFIX "%Y%m%dT%H%M%SZ" COPY_ENDING,
                   gmtime_r(&now, &parts));
    (void)snprintf(path, sizeof path, "%.1000s%s%s", file, is_folder ? "/" : "",
                   is_folder ? name : "");
    if (status == BF_OK)
        status = back_up(directory, settings, path, &err);
    if (status == BF_OK && copies != NULL)
        status = thin_out(file, n_most, &err);
    return status == BF_OK ? EXIT_SUCCESS : complain(&err);
}

int maintenance_restore(const char *directory, const char *settings, const char *file)
{
    store_restored restored;
    char path[PATH_SIZE];
    bf_error err = { 0 };

    bf_status status = store_restore(directory, file, &restored, &err);
    (void)snprintf(path, sizeof path, "%.1000s.conf", file);
    const bool has_settings = access(path, F_OK) == 0;
    const bool wants_settings = has_settings && settings != NULL && access(settings, F_OK) != 0;
    if (status == BF_OK && wants_settings)
        status = copy_settings(path, settings, directory, &err);
    if (status != BF_OK)
        return complain(&err);
    (void)printf("%s is the store in %s now, %s\n", file, directory,
                 restored.has_tokens ? "with its tokens" : "and the copy has no tokens");
    if (restored.replaced[0] != '\0')
        (void)printf("what was there before is in %s\n", restored.replaced);
    if (wants_settings)
        (void)printf("its settings are in %s now\n", settings);
    else if (has_settings)
        (void)printf("its settings are in %s, and were not put in place\n", path);
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

// "90d" or "12h" of a flag.
static bf_status read_time(const char *flag, const char *text, int64_t *ret_ms, bf_error *err)
{
    char *end = NULL;

    unsigned long n = strspn(text, "0123456789") == 0 ? 0 : strtoul(text, &end, 10);
    bool is_days = n > 0 && strcmp(end, "d") == 0;
    bool is_hours = n > 0 && strcmp(end, "h") == 0;
    if ((!is_days && !is_hours) || n > EXPIRY_MAX)
        return bf_fail(err, BF_EINPUT, "",
                       "%s wants 1 to %d days or hours, such as 90d or 12h, not '%.40s'", flag,
                       EXPIRY_MAX, text);
    *ret_ms = (int64_t)n * HOUR_MS * (is_days ? 24 : 1);
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
    int64_t after_ms = 0; // until it expires; 0: never

    if (!api_access_read_scopes(scopes, &token->scopes) || (token->scopes & API_SCOPE_GRANTED) != 0)
        return bf_fail(
            err, BF_EINPUT, "",
            "--scopes wants words of read,submit,work,admin,priority,metrics, not '%.40s'", scopes);
    BF_TRY(copy_name(wanted->name, token->name, sizeof token->name, err));
    BF_TRY(copy_name(owner, token->owner, sizeof token->owner, err));
    if (wanted->expires != NULL)
        BF_TRY(read_time("--expires", wanted->expires, &after_ms, err));
    token->expires_ms = after_ms == 0 ? 0 : clock_unix_ms() + after_ms;
    return BF_OK;
}

static int print_new(const tokens_record *token, const char *text)
{
    char scopes[API_SCOPES_SIZE];

    (void)fprintf(stderr, "token %" PRIu64 " of %s (%s); it is shown only now:\n", token->id,
                  token->owner, api_access_write_scopes(token->scopes, scopes));
    (void)printf("%s\n", text);
    return fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int maintenance_token_add(const char *directory, const maintenance_token *wanted)
{
    tokens_record token = { 0 };
    char text[API_TOKEN_SIZE];
    bf_error err = { 0 };

    bf_status status = read_wanted(wanted, &token, &err);
    if (status == BF_OK)
        status = tokens_add(directory, &token, text, &err);
    if (status != BF_OK)
        return complain(&err);
    if (token.id == 1)
        (void)fprintf(stderr, "from now on every request needs a token, those of Prometheus for "
                              "/metrics, too: token add prometheus --scopes metrics\n");
    return print_new(&token, text);
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
    return tokens_counts(token, clock_unix_ms()) ? "valid" : "expired";
}

static void print_token(void *context, const tokens_record *token)
{
    char scopes[API_SCOPES_SIZE], created[TIME_SIZE], expires[TIME_SIZE], used[TIME_SIZE];

    (void)context;
    (void)printf("%-4" PRIu64 " %-8s %-16s %-16s %-18s %-20s %-20s %-20s %s\n", token->id,
                 state_of(token), token->name, token->owner,
                 api_access_write_scopes(token->scopes, scopes),
                 write_time(token->created_ms, "-", created),
                 write_time(token->expires_ms, "never", expires),
                 write_time(token->used_ms, "never", used), token->resource);
}

int maintenance_token_list(const char *directory)
{
    bf_error err = { 0 };

    (void)printf("%-4s %-8s %-16s %-16s %-18s %-20s %-20s %-20s %s\n", "id", "state", "name",
                 "owner", "scopes", "created", "expires", "last use", "reads only");
    if (tokens_list(directory, print_token, NULL, &err) != BF_OK)
        return complain(&err);
    return fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

static bf_status read_id(const char *word, const char *id, uint64_t *ret_id, bf_error *err)
{
    if (number_read_digits(id, 0, INT64_MAX, ret_id))
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "", "token %s wants an id of token list, not '%.40s'", word, id);
}

int maintenance_token_rotate(const char *directory, const char *id, const char *overlap)
{
    char text[API_TOKEN_SIZE];
    int64_t overlap_ms = 0;
    tokens_record token;
    uint64_t number = 0;
    bf_error err = { 0 };

    bf_status status = read_id("rotate", id, &number, &err);
    if (status == BF_OK)
        status = read_time("--overlap", overlap == NULL ? "7d" : overlap, &overlap_ms, &err);
    if (status == BF_OK)
        status = tokens_rotate(directory, number, overlap_ms, &token, text, &err);
    return status == BF_OK ? print_new(&token, text) : complain(&err);
}

int maintenance_token_revoke(const char *directory, const char *id)
{
    uint64_t number = 0;
    bf_error err = { 0 };

    bf_status status = read_id("revoke", id, &number, &err);
    if (status == BF_OK)
        status = tokens_revoke(directory, number, &err);
    if (status != BF_OK)
        return complain(&err);
    (void)printf("token %" PRIu64 " is revoked\n", number);
    return EXIT_SUCCESS;
}
