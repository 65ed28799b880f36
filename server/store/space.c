// Room on the disk: when nothing more is accepted, and how a full disk gets empty again.
//
// The reserve is a file of zeros. What frees something and finds the disk full is done again without it; then free
// pages at the end of the database are given back to the disk, step by step, and the reserve is taken again. Free
// pages are given back only where the disk is short: else the next runs use them. Databases that versions before this
// one made cannot give pages back.

#include "server/store/space.h"

#include "server/store/store_priv.h"

#include "server/base/clock.h"
#include "server/base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum {
    ROOM_MIN = 64 * 1024 * 1024, // bytes that must be free for more to be accepted
    ROOM_LOW = 2 * ROOM_MIN,     // below it free pages are given back
    RESERVE_BYTES =
        8 * 1024 * 1024, // more than the log grows by in a step of removal or of giving back
    RESERVE_SPARE = 1024 * 1024, // that must be free beside it, and is enough to open a store
};

static bf_status find_free_bytes(const store *s, uint64_t *ret_bytes, bf_error *err)
{
    struct statvfs disk;

    if (statvfs(s->directory, &disk) != 0)
        return bf_fail(err, BF_ESYSTEM, "", "cannot ask for the free space of %s: %s", s->directory,
                       strerror(errno));
    *ret_bytes = (uint64_t)disk.f_bavail * disk.f_frsize;
    return BF_OK;
}

uint64_t store__count_free(const store *s)
{
    uint64_t n_free = 0;

    return find_free_bytes(s, &n_free, NULL) == BF_OK ? n_free : 0;
}

bf_status store__check_room(const store *s, bf_error *err)
{
    return store__check_room_for(s, 0, err);
}

bf_status store__check_room_for(const store *s, uint64_t n, bf_error *err)
{
    uint64_t n_free = 0;

    bf_status status = find_free_bytes(s, &n_free, err);
    if (status != BF_OK || n_free >= ROOM_MIN + n)
        return status;
    return bf_fail(err, BF_ENOSPACE, "",
                   "the disk of %.150s has %" PRIu64 " MiB left, fewer than the %" PRIu64
                   " that are needed",
                   s->directory, n_free >> 20, (ROOM_MIN + n) >> 20);
}

static const char *name_reserve(const store *s, char ret_path[STORE__PATH_SIZE + 32])
{
    (void)snprintf(ret_path, STORE__PATH_SIZE + 32, "%s/beltflow.reserve", s->directory);
    return ret_path;
}

bool store__spend_reserve(store *s)
{
    char path[STORE__PATH_SIZE + 32];
    bool had_one = s->space.has_reserve;

    s->space.has_reserve = false;
    s->space.next_ms = 0;
    return unlink(name_reserve(s, path)) == 0 && had_one;
}

void store__make_room_to_open(store *s)
{
    char path[STORE__PATH_SIZE + 32];
    uint64_t n_free = 0;

    if (find_free_bytes(s, &n_free, NULL) == BF_OK && n_free < RESERVE_SPARE)
        (void)unlink(name_reserve(s, path));
}

// A file of the daemon before counts, too.
void store__take_reserve(store *s)
{
    char path[STORE__PATH_SIZE + 32];
    struct stat info;
    uint64_t n_free = 0;

    if (s->space.has_reserve || find_free_bytes(s, &n_free, NULL) != BF_OK)
        return;
    int file = open(name_reserve(s, path), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file < 0)
        return;
    bool is_there = fstat(file, &info) == 0 && info.st_size == RESERVE_BYTES;
    s->space.has_reserve = is_there || (n_free >= RESERVE_BYTES + RESERVE_SPARE &&
                                        posix_fallocate(file, 0, RESERVE_BYTES) == 0);
    (void)close(file);
    if (!s->space.has_reserve)
        (void)unlink(path);
}

// The log is emptied as well, unless someone reads an old state of it.
static bf_status shrink_file(store__connection *writer, bf_error *err)
{
    bf_status status = BF_OK;

    store__query q = store__start_with(writer, STORE__SQL_SHRINK_FILE, NULL, 0);
    while (store__next(&q, &status, err))
        ;
    store__end(&q);
    (void)sqlite3_wal_checkpoint_v2(writer->db, NULL, SQLITE_CHECKPOINT_TRUNCATE, NULL, NULL);
    return status;
}

// Give back a step of free pages. False: there are none, or it cannot be done.
static bool shrink_some(store *s)
{
    int64_t n_before = 0, n_after = 0;
    char quoted[LOG_QUOTED_SIZE];
    bf_error err = { 0 };

    bf_status status = store__read_number(&s->writer, STORE__SQL_COUNT_FREE_PAGES, &n_before, &err);
    if (status != BF_OK || n_before == 0)
        return false;
    (void)store__spend_reserve(s);
    status = shrink_file(&s->writer, &err);
    if (status == BF_OK)
        status = store__read_number(&s->writer, STORE__SQL_COUNT_FREE_PAGES, &n_after, &err);
    if (status != BF_OK)
        log_event(LOG_LEVEL_WARN, "file_not_shrunk", "error=%s", log_quote(err.text, quoted));
    return status == BF_OK && n_after < n_before;
}

// True: there is more to be done at once.
static bool maintain(store *s)
{
    uint64_t n_free = 0;

    if (find_free_bytes(s, &n_free, NULL) != BF_OK)
        return false;
    bool goes_on = n_free < ROOM_LOW && shrink_some(s);
    store__take_reserve(s);
    return goes_on;
}

void store__maintain_space(store *s)
{
    lock_assert_held(&s->lock);
    // Also before a stop: the next start may need the reserve.
    if (clock_monotonic_ms() < s->space.next_ms)
        return;
    lock_release(&s->lock);
    bool goes_on = maintain(s);
    lock_acquire(&s->lock);
    s->space.next_ms = goes_on ? 0 : INT64_MAX;
}
