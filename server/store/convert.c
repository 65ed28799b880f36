// Page checksums for databases that were made without. SQLite sets the bytes at a page's end that are reserved when a
// database is made, so all rows are copied into a new one (VACUUM INTO), which then takes the old one's name.

#include "server/store/convert.h"

#include "server/store/page_sums.h"

#include "server/base/clock.h"
#include "server/base/file_io.h"
#include "server/base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CONVERT_BYTES_MAX = 512 * 1024 * 1024 }; // some seconds

bf_status store__copy_with_sums(sqlite3 *db, const char *file, bf_error *err)
{
    char *vacuum = sqlite3_mprintf("VACUUM INTO %Q", file);
    bf_status status = vacuum == NULL ? bf_fail(err, BF_ENOMEM, "", "the store has no memory")
                                      : store__reserve_page_sums(db, err);

    // A reader may write to the new file as well; the flags that it opened the store with still hold.
    int code = status == BF_OK
                   ? sqlite3_exec(db, "PRAGMA query_only = OFF; PRAGMA auto_vacuum = INCREMENTAL",
                                  NULL, NULL, NULL)
                   : SQLITE_OK;
    if (status == BF_OK && code == SQLITE_OK)
        code = sqlite3_exec(db, vacuum, NULL, NULL, NULL);
    sqlite3_free(vacuum);
    return code == SQLITE_OK ? status : store__fail(db, code, err);
}

// Nobody else has the database open then, and its log is gone: a log that stayed would be taken for the new one's.
static bf_status leave_log(sqlite3 *db, bf_error *err)
{
    sqlite3_stmt *statement = NULL;
    bf_status status = BF_OK;

    int code = sqlite3_prepare_v2(db, "PRAGMA journal_mode = DELETE", -1, &statement, NULL);
    if (code == SQLITE_OK)
        code = sqlite3_step(statement);
    if (code != SQLITE_ROW)
        status = store__fail(db, code, err);
    else if (strcmp((const char *)sqlite3_column_text(statement, 0), "delete") != 0)
        status = bf_fail(err, BF_EBUSY, "", "another program has the store open");
    sqlite3_finalize(statement);
    return status;
}

static bf_status check_size(const store *s, uint64_t n_bytes, bf_error *err)
{
    if (n_bytes > CONVERT_BYTES_MAX)
        return bf_fail(err, BF_ELIMIT, "",
                       "a start converts %d MiB at most: put a copy by beltflowd backup in its "
                       "place",
                       CONVERT_BYTES_MAX >> 20);
    return store__check_room_for(s, n_bytes, err);
}

static bf_status write_new(const store *s, sqlite3 *db, uint64_t n_bytes, const char *file,
                           bf_error *err)
{
    BF_TRY(check_size(s, n_bytes, err));
    // SQLite would create the file readable by others.
    int fd = open(file, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd < 0)
        return bf_fail(err, BF_ESYSTEM, "", "cannot create %.200s: %s", file, strerror(errno));
    (void)close(fd);
    (void)sqlite3_busy_timeout(db, 0);
    BF_TRY(store__copy_with_sums(db, file, err));
    return leave_log(db, err);
}

// True: it is ours, and its pages have no sums. What cannot be opened is reported by who opens it next.
static bool is_old(const store *s, sqlite3 *db)
{
    int version = 0;

    return store__identify(db, s->path, &version, NULL) == BF_OK && version > 0 &&
           !store__has_page_sums(db);
}

// True: the new database is there.
static bool convert_to(const store *s, const char *file, uint64_t n_bytes)
{
    store__connection c = { 0 };
    char quoted[LOG_QUOTED_SIZE];
    bf_error err = { 0 };

    if (store__connect(s->path, STORE__READ_WRITE, &c, NULL) != BF_OK)
        return false;
    const bool has_begun = is_old(s, c.db);
    const bool is_made = has_begun && write_new(s, c.db, n_bytes, file, &err) == BF_OK;
    store__disconnect(&c);
    if (has_begun && !is_made) {
        (void)unlink(file);
        log_event(LOG_LEVEL_WARN, "page_sums_missing", "bytes=%" PRIu64 " why=%s", n_bytes,
                  log_quote(err.text, quoted));
    }
    return is_made;
}

bf_status store__convert(const store *s, bf_error *err)
{
    const int64_t begin_ms = clock_monotonic_ms();
    char file[STORE__PATH_SIZE + 8];
    struct stat info;

    (void)snprintf(file, sizeof file, "%s.new", s->path);
    (void)unlink(file); // of a process that was killed
    const uint64_t n_bytes = stat(s->path, &info) == 0 ? (uint64_t)info.st_size : 0;
    if (!convert_to(s, file, n_bytes))
        return BF_OK;
    BF_TRY(file_io_take_place(file, s->path, err));
    log_event(LOG_LEVEL_INFO, "page_sums_added", "bytes=%" PRIu64 " ms=%" PRId64, n_bytes,
              clock_monotonic_ms() - begin_ms);
    return BF_OK;
}
