#include "server/store/store_priv.h"

#include "server/base/file_io.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

static bf_status fail_errno(const char *what, const char *path, bf_error *err)
{
    return bf_fail(err, BF_ESYSTEM, "", "%s %s: %s", what, path, strerror(errno));
}

// The number of the process that the holder of the lock wrote into it; 0 if it cannot be read.
static long read_holder(int file)
{
    char text[32] = "";
    long holder = 0;

    if (pread(file, text, sizeof text - 1, 0) <= 0 || sscanf(text, "%ld", &holder) != 1)
        return 0;
    return holder;
}

static bf_status fail_held(const store *s, int file, bf_error *err)
{
    long holder = read_holder(file);
    if (holder == 0)
        return bf_fail(err, BF_ESYSTEM, "", "the data directory %s is in use by another daemon",
                       s->directory);
    return bf_fail(err, BF_ESYSTEM, "",
                   "the data directory %s is in use by another daemon, process %ld", s->directory,
                   holder);
}

// For people who look; the lock itself is what counts.
static bool write_holder(int file)
{
    char text[32];
    int n = snprintf(text, sizeof text, "%ld\n", (long)getpid());
    return ftruncate(file, 0) == 0 && pwrite(file, text, (size_t)n, 0) == n;
}

static bf_status take_lock_file(store *s, bf_error *err)
{
    char path[STORE__PATH_SIZE + 16];
    bf_status status = BF_OK;

    snprintf(path, sizeof path, "%s/beltflow.lock", s->directory);
    int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file < 0)
        return fail_errno("cannot open the lock file", path, err);
    if (flock(file, LOCK_EX | LOCK_NB) != 0)
        status =
            errno == EWOULDBLOCK ? fail_held(s, file, err) : fail_errno("cannot lock", path, err);
    else if (!write_holder(file))
        status = fail_errno("cannot write", path, err);
    if (status != BF_OK)
        close(file);
    else
        s->lock_file = file;
    return status;
}

// SQLite would create the file readable by others. Its own descriptors do not exist yet: closing
// one of ours later would drop their locks.
static bf_status create_database_file(const store *s, bf_error *err)
{
    int file = open(s->path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file < 0)
        return errno == EEXIST ? BF_OK : fail_errno("cannot create", s->path, err);
    close(file);
    return BF_OK;
}

// A new name in a directory survives a power loss once the directory is synced.
static bf_status sync_directory(const char *path, bf_error *err)
{
    int directory = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory < 0)
        return fail_errno("cannot open", path, err);
    bf_status status = fsync(directory) == 0 ? BF_OK : fail_errno("cannot sync", path, err);
    close(directory);
    return status;
}

static bf_status make_directory(const store *s, bf_error *err)
{
    if (file_io_make_directories(s->directory, 0700, FILE_IO_NOW))
        return BF_OK;
    return fail_errno("cannot make the data directory", s->directory, err);
}

bf_status store__take_directory(store *s, bf_error *err)
{
    bf_status status = make_directory(s, err);
    if (status == BF_OK)
        status = take_lock_file(s, err);
    if (status == BF_OK)
        status = create_database_file(s, err);
    if (status == BF_OK)
        status = sync_directory(s->directory, err);
    return status;
}

bf_status store__free_bytes(const store *s, uint64_t *ret_bytes, bf_error *err)
{
    struct statvfs disk;

    if (statvfs(s->directory, &disk) != 0)
        return fail_errno("cannot ask for the free space of", s->directory, err);
    *ret_bytes = (uint64_t)disk.f_bavail * disk.f_frsize;
    return BF_OK;
}
