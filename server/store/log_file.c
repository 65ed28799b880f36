#include "server/store/log_file.h"

#include <sqlite3.h>
#include <string.h>

enum { GATHERED_MAX = 120 * 1024 }; // SQLite's own VFS fails at multiples of 128 KiB

// Our part of an open log; the system's part follows.
typedef struct log_file {
    sqlite3_file base;
    char *gathered;   // GATHERED_MAX bytes; NULL: nothing was written yet, or there is no memory
    int n;            // bytes gathered
    sqlite3_int64 at; // where in the file they belong
} log_file;

_Static_assert(sizeof(log_file) % _Alignof(max_align_t) == 0, "the system's part is aligned");

const size_t store__log_file_bytes = sizeof(log_file);

static log_file *ours(sqlite3_file *file)
{
    return (log_file *)(void *)file;
}

static sqlite3_file *inner(sqlite3_file *file)
{
    return (sqlite3_file *)(void *)(ours(file) + 1);
}

// What cannot be written is of a commit that fails: SQLite writes other frames in its place.
static int write_out(sqlite3_file *file)
{
    const int n = ours(file)->n;

    ours(file)->n = 0;
    return n == 0 ? SQLITE_OK
                  : inner(file)->pMethods->xWrite(inner(file), ours(file)->gathered, n,
                                                  ours(file)->at);
}

static int gather(sqlite3_file *file, const void *bytes, int n, sqlite3_int64 at)
{
    log_file *log = ours(file);
    int code = SQLITE_OK;

    if (log->gathered == NULL)
        log->gathered = sqlite3_malloc(GATHERED_MAX);
    if (at != log->at + log->n || n > GATHERED_MAX - log->n)
        code = write_out(file);
    if (code != SQLITE_OK)
        return code;
    if (log->gathered == NULL || n > GATHERED_MAX)
        return inner(file)->pMethods->xWrite(inner(file), bytes, n, at);
    if (log->n == 0)
        log->at = at;
    memcpy(log->gathered + log->n, bytes, (size_t)n);
    log->n += n;
    return SQLITE_OK;
}

// What was not synced is of no commit.
static int close_file(sqlite3_file *file)
{
    sqlite3_free(ours(file)->gathered);
    return inner(file)->pMethods->xClose(inner(file));
}

// The rest sees the file as it would be if nothing had been gathered.
#define PASS(name, parameters, arguments)                                                          \
    static int name parameters                                                                     \
    {                                                                                              \
        const int code = write_out(file);                                                          \
        return code == SQLITE_OK ? inner(file)->pMethods->name arguments : code;                   \
    }
PASS(xRead, (sqlite3_file * file, void *bytes, int n, sqlite3_int64 at),
     (inner(file), bytes, n, at))
PASS(xTruncate, (sqlite3_file * file, sqlite3_int64 n), (inner(file), n))
PASS(xSync, (sqlite3_file * file, int flags), (inner(file), flags))
PASS(xFileSize, (sqlite3_file * file, sqlite3_int64 *ret_n), (inner(file), ret_n))
PASS(xFileControl, (sqlite3_file * file, int what, void *argument), (inner(file), what, argument))
#undef PASS

static int xSectorSize(sqlite3_file *file)
{
    return inner(file)->pMethods->xSectorSize(inner(file));
}

static int xDeviceCharacteristics(sqlite3_file *file)
{
    return inner(file)->pMethods->xDeviceCharacteristics(inner(file));
}

// SQLite locks the database, not its log.
static const sqlite3_io_methods methods = {
    .iVersion = 1,
    .xClose = close_file,
    .xRead = xRead,
    .xWrite = gather,
    .xTruncate = xTruncate,
    .xSync = xSync,
    .xFileSize = xFileSize,
    .xFileControl = xFileControl,
    .xSectorSize = xSectorSize,
    .xDeviceCharacteristics = xDeviceCharacteristics,
};

int store__open_log(sqlite3_vfs *below, const char *name, sqlite3_file *file, int flags,
                    int *ret_flags)
{
    *ours(file) = (log_file){ .n = 0 };
    const int code = below->xOpen(below, name, inner(file), flags, ret_flags);

    // Where pMethods is set SQLite closes the file, also after a failure.
    if (inner(file)->pMethods != NULL)
        file->pMethods = &methods;
    return code;
}
