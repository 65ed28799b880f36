#include "server/store/page_sums.h"

#include "server/store/connection.h"
#include "server/store/log_file.h"

#include <pthread.h>
#include <sodium.h>
#include <sqlite3.h>
#include <stddef.h>
#include <string.h>

enum {
    PAGE_MIN = 512, // SQLite's limits of a page
    PAGE_MAX = 65536,
    HEADER_BYTES = 100, // of a database, at the start of its first page
    RESERVED_AT = 20,   // in the header: reserved bytes at the end of each page
};

static const char magic[] = "SQLite format 3"; // with its terminator, at the start of the header

// Whether a file has sums.
typedef enum sums {
    SUMS_UNKNOWN, // it has no first page yet
    SUMS_NONE,
    SUMS_ALL,
} sums;

// Our part of an open database file; the system's part follows.
typedef struct sums_file {
    sqlite3_file base;
    sums has;
} sums_file;

_Static_assert(sizeof(sums_file) % _Alignof(max_align_t) == 0, "the system's part is aligned");

static sqlite3_vfs *below; // the system's VFS

static sqlite3_file *inner(sqlite3_file *file)
{
    return (sqlite3_file *)(void *)((sums_file *)(void *)file + 1);
}

static bool is_page(int n, sqlite3_int64 at)
{
    return n >= PAGE_MIN && n <= PAGE_MAX && (n & (n - 1)) == 0 && at % n == 0;
}

static void find_sum(const unsigned char *page, int n, sqlite3_int64 at,
                     unsigned char ret_sum[STORE__SUM_BYTES])
{
    unsigned char key[crypto_shorthash_KEYBYTES] = "beltflow";

    memcpy(key + sizeof key - sizeof at, &at, sizeof at);
    (void)crypto_shorthash(ret_sum, page, (unsigned long long)(n - STORE__SUM_BYTES), key);
}

static bool is_sound(const unsigned char *page, int n, sqlite3_int64 at)
{
    unsigned char sum[STORE__SUM_BYTES];

    find_sum(page, n, at, sum);
    return memcmp(sum, page + n - STORE__SUM_BYTES, sizeof sum) == 0;
}

static void note_header(sums_file *file, const unsigned char *header)
{
    if (memcmp(header, magic, sizeof magic) == 0)
        file->has = header[RESERVED_AT] == STORE__SUM_BYTES ? SUMS_ALL : SUMS_NONE;
}

static void look_for_header(sqlite3_file *file)
{
    unsigned char header[HEADER_BYTES];

    if (inner(file)->pMethods->xRead(inner(file), header, sizeof header, 0) == SQLITE_OK)
        note_header((sums_file *)(void *)file, header);
}

// A first page that tells of no sums but would have one if it did.
static bool has_lost_its_mark(const unsigned char *page, int n)
{
    unsigned char marked[PAGE_MAX];

    memcpy(marked, page, (size_t)n);
    marked[RESERVED_AT] = STORE__SUM_BYTES;
    return is_sound(marked, n, 0);
}

static int check_page(sqlite3_file *file, const unsigned char *page, int n, sqlite3_int64 at)
{
    sums_file *ours = (sums_file *)(void *)file;

    if (ours->has == SUMS_UNKNOWN)
        look_for_header(file);
    if (ours->has == SUMS_ALL)
        return is_sound(page, n, at) ? SQLITE_OK : SQLITE_IOERR_DATA;
    return at == 0 && has_lost_its_mark(page, n) ? SQLITE_IOERR_DATA : SQLITE_OK;
}

static int read_file(sqlite3_file *file, void *bytes, int n, sqlite3_int64 at)
{
    int code = inner(file)->pMethods->xRead(inner(file), bytes, n, at);

    return code == SQLITE_OK && is_page(n, at) ? check_page(file, bytes, n, at) : code;
}

static int write_file(sqlite3_file *file, const void *bytes, int n, sqlite3_int64 at)
{
    sums_file *ours = (sums_file *)(void *)file;
    unsigned char page[PAGE_MAX];

    if (!is_page(n, at))
        return inner(file)->pMethods->xWrite(inner(file), bytes, n, at);
    if (ours->has == SUMS_UNKNOWN && at == 0)
        note_header(ours, bytes);
    else if (ours->has == SUMS_UNKNOWN)
        look_for_header(file);
    // Without a first page the file is being made, and what is made by this VFS has sums.
    if (ours->has == SUMS_NONE)
        return inner(file)->pMethods->xWrite(inner(file), bytes, n, at);
    memcpy(page, bytes, (size_t)n);
    find_sum(page, n, at, page + n - STORE__SUM_BYTES);
    return inner(file)->pMethods->xWrite(inner(file), page, n, at);
}

// The rest goes to the system's part as it is.
#define PASS(name, parameters, arguments)                                                          \
    static int name parameters                                                                     \
    {                                                                                              \
        return inner(file)->pMethods->name arguments;                                              \
    }
PASS(xClose, (sqlite3_file * file), (inner(file)))
PASS(xTruncate, (sqlite3_file * file, sqlite3_int64 n), (inner(file), n))
PASS(xSync, (sqlite3_file * file, int flags), (inner(file), flags))
PASS(xFileSize, (sqlite3_file * file, sqlite3_int64 *ret_n), (inner(file), ret_n))
PASS(xLock, (sqlite3_file * file, int level), (inner(file), level))
PASS(xUnlock, (sqlite3_file * file, int level), (inner(file), level))
PASS(xCheckReservedLock, (sqlite3_file * file, int *ret_is), (inner(file), ret_is))
PASS(xFileControl, (sqlite3_file * file, int what, void *argument), (inner(file), what, argument))
PASS(xSectorSize, (sqlite3_file * file), (inner(file)))
PASS(xDeviceCharacteristics, (sqlite3_file * file), (inner(file)))
PASS(xShmMap, (sqlite3_file * file, int region, int n, int may_grow, void volatile **ret_bytes),
     (inner(file), region, n, may_grow, ret_bytes))
PASS(xShmLock, (sqlite3_file * file, int first, int n, int flags), (inner(file), first, n, flags))
PASS(xShmUnmap, (sqlite3_file * file, int is_last), (inner(file), is_last))
#undef PASS

static void xShmBarrier(sqlite3_file *file)
{
    inner(file)->pMethods->xShmBarrier(inner(file));
}

// Version 2: without the mapping of files into memory, which would pass us by.
static const sqlite3_io_methods methods = {
    .iVersion = 2,
    .xClose = xClose,
    .xRead = read_file,
    .xWrite = write_file,
    .xTruncate = xTruncate,
    .xSync = xSync,
    .xFileSize = xFileSize,
    .xLock = xLock,
    .xUnlock = xUnlock,
    .xCheckReservedLock = xCheckReservedLock,
    .xFileControl = xFileControl,
    .xSectorSize = xSectorSize,
    .xDeviceCharacteristics = xDeviceCharacteristics,
    .xShmMap = xShmMap,
    .xShmLock = xShmLock,
    .xShmBarrier = xShmBarrier,
    .xShmUnmap = xShmUnmap,
};

// Rollback journals are the system's alone.
static int open_file(sqlite3_vfs *vfs, const char *name, sqlite3_file *file, int flags,
                     int *ret_flags)
{
    (void)vfs;
    if ((flags & SQLITE_OPEN_WAL) != 0)
        return store__open_log(below, name, file, flags, ret_flags);
    if ((flags & SQLITE_OPEN_MAIN_DB) == 0)
        return below->xOpen(below, name, file, flags, ret_flags);
    *(sums_file *)(void *)file = (sums_file){ .has = SUMS_UNKNOWN };
    int code = below->xOpen(below, name, inner(file), flags, ret_flags);
    // Where pMethods is set SQLite closes the file, also after a failure.
    if (inner(file)->pMethods != NULL)
        file->pMethods = &methods;
    return code;
}

static int registered; // a result code of SQLite

// A copy of the system's VFS but for its files: its functions know no more of a VFS than what is copied.
static void register_once(void)
{
    static sqlite3_vfs ours;

    below = sqlite3_vfs_find(NULL);
    registered = below == NULL ? SQLITE_ERROR : SQLITE_OK;
    if (below == NULL)
        return;
    ours = *below;
    ours.zName = STORE__PAGE_SUMS;
    ours.szOsFile += (int)(sizeof(sums_file) > store__log_file_bytes ? sizeof(sums_file)
                                                                     : store__log_file_bytes);
    ours.xOpen = open_file;
    registered = sqlite3_vfs_register(&ours, 0);
}

bf_status store__register_page_sums(bf_error *err)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;

    (void)pthread_once(&once, register_once);
    return registered == SQLITE_OK ? BF_OK : store__fail(NULL, registered, err);
}

bool store__has_page_sums(sqlite3 *db)
{
    int n = -1; // only asks

    return sqlite3_file_control(db, "main", SQLITE_FCNTL_RESERVE_BYTES, &n) == SQLITE_OK &&
           n == STORE__SUM_BYTES;
}

bf_status store__reserve_page_sums(sqlite3 *db, bf_error *err)
{
    int n = STORE__SUM_BYTES;
    int code = sqlite3_file_control(db, "main", SQLITE_FCNTL_RESERVE_BYTES, &n);

    return code == SQLITE_OK ? BF_OK : store__fail(db, code, err);
}
