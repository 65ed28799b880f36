// Restoring: everything that can fail for what the copy is comes before the first file is moved, and each file gets its
// name when it is whole and on disk.

#include "server/store/restore.h"

#include "server/store/backup.h"
#include "server/store/store_priv.h"

#include "server/base/clock.h"
#include "server/base/file_io.h"

#include <errno.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { COPY_BYTES = 1 << 20 };

static bf_status fail_errno(const char *what, const char *path, bf_error *err)
{
    return bf_fail(err, BF_ESYSTEM, "", "%s %.300s: %s", what, path, strerror(errno));
}

static const char *join(const char *directory, const char *name, char *ret_path)
{
    (void)snprintf(ret_path, STORE__PATH_SIZE + 64, "%.*s%s", STORE__PATH_SIZE - 1, directory,
                   name);
    return ret_path;
}

static void note_first(void *context, const char *name, const char *claim, const char *finding)
{
    char *found = context;

    if (finding != NULL && found[0] == '\0')
        (void)snprintf(found, BF_TEXT_SIZE, "%s: %s: %s", name, claim, finding);
}

// Of a copy of an older version only the file can be checked.
static bf_status check_file(sqlite3 *db, const char *path, bf_error *err)
{
    sqlite3_stmt *statement = NULL;
    bf_status status = BF_OK;

    int code = sqlite3_prepare_v2(db, "PRAGMA integrity_check(1)", -1, &statement, NULL);
    if (code == SQLITE_OK)
        code = sqlite3_step(statement);
    const char *text =
        code == SQLITE_ROW ? (const char *)sqlite3_column_text(statement, 0) : sqlite3_errmsg(db);
    if (code != SQLITE_ROW || strcmp(text, "ok") != 0)
        status = bf_fail(err, BF_EINPUT, "", "%.200s is damaged: %.200s", path, text);
    sqlite3_finalize(statement);
    return status;
}

static bf_status check_database(const char *file, bool is_store, int *ret_version, bf_error *err)
{
    store__connection c;

    bf_status status = store__connect(file, STORE__READ_ONLY, &c, err);
    if (status != BF_OK)
        return bf_fail(err, BF_EINPUT, "", "%.300s cannot be read as a store", file);
    if (is_store)
        status = store__identify(c.db, file, ret_version, err);
    if (status == BF_OK && is_store && *ret_version == 0)
        status = bf_fail(err, BF_EINPUT, "", "%.300s is empty", file);
    if (status == BF_OK)
        status = check_file(c.db, file, err);
    store__disconnect(&c);
    return status == BF_OK ? BF_OK : BF_EINPUT;
}

static bf_status check_copy(const char *file, bf_error *err)
{
    char log[STORE__PATH_SIZE + 64], found[BF_TEXT_SIZE] = "";
    bool is_sound = true;
    struct stat facts;
    int version = 0;

    if (strlen(file) >= STORE__PATH_SIZE)
        return bf_fail(err, BF_EINPUT, "", "the file's path is too long");
    if (stat(file, &facts) != 0 || !S_ISREG(facts.st_mode))
        return bf_fail(err, BF_EINPUT, "", "there is no file %.300s", file);
    if (stat(join(file, "-wal", log), &facts) == 0 && facts.st_size > 0)
        return bf_fail(err, BF_EINPUT, "",
                       "%.300s has a log beside it, so it is in use: restore a copy that "
                       "beltflowd backup made",
                       file);
    BF_TRY(check_database(file, true, &version, err));
    if (version == store__version)
        BF_TRY(store_verify(file, note_first, found, &is_sound, err));
    if (!is_sound)
        return bf_fail(err, BF_EINPUT, "", "%.100s is damaged: %.200s", file, found);
    if (access(join(file, ".access", log), F_OK) == 0)
        BF_TRY(check_database(log, false, &version, err));
    return BF_OK;
}

// Nobody else may have the directory from here on; the lock goes with the descriptor.
static bf_status hold(const char *directory, int *ret_lock, bf_error *err)
{
    char path[STORE__PATH_SIZE + 64];
    struct stat whose;

    if (!file_io_make_directories(directory, 0700, FILE_IO_NOW))
        return fail_errno("cannot make", directory, err);
    *ret_lock = open(join(directory, "/beltflow.lock", path),
                     O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (*ret_lock < 0)
        return fail_errno("cannot open", path, err);
    // The daemon opens it, too.
    if (geteuid() == 0 &&
        (stat(directory, &whose) != 0 || fchown(*ret_lock, whose.st_uid, whose.st_gid) != 0))
        return fail_errno("cannot set the owner of", path, err);
    if (flock(*ret_lock, LOCK_EX | LOCK_NB) == 0)
        return BF_OK;
    return errno == EWOULDBLOCK
               ? bf_fail(err, BF_ECONFLICT, "",
                         "a daemon is using %.300s: stop it first (systemctl stop beltflow)",
                         directory)
               : fail_errno("cannot lock", path, err);
}

static bf_status copy_bytes(int from, int to, const char *path, bf_error *err)
{
    static char bytes[COPY_BYTES];
    ssize_t n;

    while ((n = read(from, bytes, sizeof bytes)) > 0)
        if (!file_io_write_fd(to, bytes, (size_t)n))
            return fail_errno("cannot write", path, err);
    return n == 0 ? BF_OK : fail_errno("cannot read the copy for", path, err);
}

// A copy under a temporary name, his who has the directory.
static bf_status copy_file(const char *file, const char *directory, char *ret_path, bf_error *err)
{
    struct stat whose;

    (void)join(directory, "/restored.XXXXXX", ret_path);
    const int from = open(file, O_RDONLY | O_CLOEXEC);
    if (from < 0)
        return fail_errno("cannot open", file, err);
    const int to = mkstemp(ret_path);
    bf_status status = to < 0 ? fail_errno("cannot write in", directory, err)
                              : copy_bytes(from, to, ret_path, err);
    if (status == BF_OK && (stat(directory, &whose) != 0 || fchmod(to, 0600) != 0))
        status = fail_errno("cannot set the mode of", ret_path, err);
    if (status == BF_OK && geteuid() == 0 && fchown(to, whose.st_uid, whose.st_gid) != 0)
        status = fail_errno("cannot set the owner of", ret_path, err);
    if (status == BF_OK && fsync(to) != 0)
        status = fail_errno("cannot sync", ret_path, err);
    (void)close(from);
    if (to >= 0)
        (void)close(to);
    if (status != BF_OK && to >= 0)
        (void)unlink(ret_path);
    return status;
}

// What was there before goes into a directory of its own.
static bf_status move_away(const char *directory, bool with_tokens, store_restored *restored,
                           bf_error *err)
{
    static const char *const names[] = { "/beltflow.db", "/beltflow.db-wal", "/beltflow.db-shm",
                                         "/access.db", "/access.db-journal" };
    const size_t n = with_tokens ? 5 : 3;
    char from[STORE__PATH_SIZE + 64], to[STORE__PATH_SIZE + 64], name[48];
    struct stat whose;

    for (size_t i = 0; i < n; i++) {
        if (access(join(directory, names[i], from), F_OK) != 0)
            continue;
        if (restored->replaced[0] == '\0') {
            (void)snprintf(name, sizeof name, "/replaced-%lld", (long long)clock_unix_ms());
            (void)snprintf(restored->replaced, sizeof restored->replaced, "%s",
                           join(directory, name, to));
            if (mkdir(to, 0700) != 0)
                return fail_errno("cannot make", to, err);
            if (geteuid() == 0 &&
                (stat(directory, &whose) != 0 || chown(to, whose.st_uid, whose.st_gid) != 0))
                return fail_errno("cannot set the owner of", to, err);
        }
        if (rename(from, join(restored->replaced, names[i], to)) != 0)
            return fail_errno("cannot move", from, err);
    }
    return BF_OK;
}

static bf_status put_in_place(const char *directory, const char *store_copy, const char *tokens,
                              store_restored *restored, bf_error *err)
{
    char path[STORE__PATH_SIZE + 64];

    BF_TRY(move_away(directory, tokens != NULL, restored, err));
    // The tokens first: a store with tokens is not served without them.
    if (tokens != NULL)
        BF_TRY(file_io_publish(tokens, join(directory, "/access.db", path), err));
    restored->has_tokens = tokens != NULL;
    return file_io_publish(store_copy, join(directory, "/beltflow.db", path), err);
}

static bf_status restore(const char *directory, const char *file, store_restored *restored,
                         bf_error *err)
{
    char of_store[STORE__PATH_SIZE + 64] = "", of_tokens[STORE__PATH_SIZE + 64] = "";
    char tokens[STORE__PATH_SIZE + 64];
    const bool has_tokens = access(join(file, ".access", tokens), F_OK) == 0;

    bf_status status = copy_file(file, directory, of_store, err);
    if (status == BF_OK && has_tokens)
        status = copy_file(tokens, directory, of_tokens, err);
    if (status == BF_OK)
        status = put_in_place(directory, of_store, has_tokens ? of_tokens : NULL, restored, err);
    if (status != BF_OK) { // those that have their name are not there any more
        (void)unlink(of_store);
        (void)unlink(of_tokens);
    }
    return status;
}

bf_status store_restore(const char *directory, const char *file, store_restored *ret_restored,
                        bf_error *err)
{
    int held = -1;

    *ret_restored = (store_restored){ .has_tokens = false };
    bf_status status = check_copy(file, err);
    if (status == BF_OK)
        status = hold(directory, &held, err);
    if (status == BF_OK)
        status = restore(directory, file, ret_restored, err);
    if (held >= 0)
        (void)close(held);
    return status;
}
