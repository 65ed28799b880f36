// The source is read in one go, which is one read transaction: the log cannot start again meanwhile,
// and nothing that is written meanwhile makes the copy start again.

#include "server/store/backup.h"

#include "server/base/file_io.h"
#include "server/store/store_priv.h"

#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { TEMPORARY_SIZE = STORE__PATH_SIZE + 16 };

// After a failure *source is not open.
static bf_status open_source(const char *directory, store__connection *source, bf_error *err)
{
    char path[STORE__PATH_SIZE + 16];
    int version = 0;

    (void)snprintf(path, sizeof path, "%.*s/beltflow.db", STORE__PATH_SIZE - 1, directory);
    if (access(path, F_OK) != 0)
        return bf_fail(err, BF_EINPUT, "", "there is no store %s: %s", path, strerror(errno));
    bf_status status = store__connect(path, STORE__READ_ONLY, source, err);
    if (status != BF_OK)
        return status;
    status = store__identify(source->db, path, &version, err);
    if (status == BF_OK && version == 0)
        status = bf_fail(err, BF_EINPUT, "", "%s is empty", path);
    if (status != BF_OK)
        store__disconnect(source);
    return status;
}

static bf_status make_temporary(const char *file, char *ret_path, bf_error *err)
{
    if (access(file, F_OK) == 0)
        return bf_fail(err, BF_EINPUT, "", "%s is there already", file);
    if (strlen(file) >= STORE__PATH_SIZE)
        return bf_fail(err, BF_EINPUT, "", "the file's path is too long");
    (void)snprintf(ret_path, TEMPORARY_SIZE, "%s.XXXXXX", file);
    // SQLite opens it by its name, and locks of ours would be lost with a second descriptor.
    int fd = mkstemp(ret_path);
    if (fd < 0)
        return bf_fail(err, BF_ESYSTEM, "", "cannot write beside %s: %s", file, strerror(errno));
    (void)close(fd);
    return BF_OK;
}

static bf_status copy_pages(sqlite3 *from, sqlite3 *to, bf_error *err)
{
    sqlite3_backup *backup = sqlite3_backup_init(to, "main", from, "main");

    if (backup == NULL)
        return store__fail(to, sqlite3_errcode(to), err);
    (void)sqlite3_backup_step(backup, -1);
    int code = sqlite3_backup_finish(backup);
    // As one plain file: a reader of it then needs no files beside it.
    if (code == SQLITE_OK)
        code = sqlite3_exec(to, "PRAGMA journal_mode = DELETE", NULL, NULL, NULL);
    return code == SQLITE_OK ? BF_OK : store__fail(to, code, err);
}

static bf_status copy(const store__connection *source, const char *temporary, bf_error *err)
{
    sqlite3 *to = NULL;

    int code = sqlite3_open_v2(
        temporary, &to, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE, NULL);
    bf_status status =
        code == SQLITE_OK ? copy_pages(source->db, to, err) : store__fail(to, code, err);
    (void)sqlite3_close(to);
    return status;
}

bf_status store_backup(const char *directory, const char *file, bf_error *err)
{
    char temporary[TEMPORARY_SIZE];
    store__connection source;

    bf_status status = open_source(directory, &source, err);
    if (status != BF_OK)
        return status;
    status = make_temporary(file, temporary, err);
    if (status == BF_OK) {
        status = copy(&source, temporary, err);
        if (status == BF_OK)
            status = file_io_publish(temporary, file, err);
        if (status != BF_OK)
            (void)unlink(temporary);
    }
    store__disconnect(&source);
    return status;
}
