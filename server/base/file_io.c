#include "server/base/file_io.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CHUNK = 64 * 1024, TEMPORARY_SIZE = 300 };

bf_status file_io_read_fd(int fd, const char *name, size_t limit, bf_buffer *out, bf_error *err)
{
    size_t before = out->n;

    for (;;) {
        char *end = buffer_reserve(out, CHUNK);
        ssize_t got = end == NULL ? 0 : read(fd, end, CHUNK);
        if (end != NULL && got > 0 && (size_t)got <= limit - (out->n - before)) {
            out->n += (size_t)got;
            out->bytes[out->n] = '\0';
            continue;
        }
        if (got < 0 && errno == EINTR)
            continue;
        if (end != NULL && got == 0)
            return BF_OK;
        out->n = before;
        if (end == NULL)
            return bf_fail(err, BF_ENOMEM, "", "no memory to read %s", name);
        if (got < 0)
            return bf_fail(err, BF_EINPUT, "", "%s cannot be read: %s", name, strerror(errno));
        return bf_fail(err, BF_ELIMIT, "", "%s is longer than the limit of %zu bytes", name, limit);
    }
}

// A descriptor of path, or of `inside` in it where path is a directory; -1 with errno.
static int open_input(const char *path, const char *inside)
{
    struct stat st;
    int fd = open(path, O_RDONLY | O_CLOEXEC);

    if (fd < 0 || fstat(fd, &st) != 0 || !S_ISDIR(st.st_mode))
        return fd;
    int file = -1;
    if (inside != NULL)
        file = openat(fd, inside, O_RDONLY | O_CLOEXEC);
    else
        errno = EISDIR;
    int error = errno;
    close(fd);
    errno = error;
    return file;
}

bf_status file_io_read(const char *path, const char *inside, size_t limit, bf_buffer *out,
                       bf_error *err)
{
    if (strcmp(path, "-") == 0)
        return file_io_read_fd(STDIN_FILENO, "standard input", limit, out, err);
    int fd = open_input(path, inside);
    if (fd < 0)
        return bf_fail(err, BF_EINPUT, "", "%s cannot be opened: %s", path, strerror(errno));
    bf_status status = file_io_read_fd(fd, path, limit, out, err);
    close(fd);
    return status;
}

bool file_io_write_fd(int fd, const void *bytes, size_t n)
{
    const char *at = bytes;

    while (n > 0) {
        ssize_t put = write(fd, at, n);
        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return false;
        at += put;
        n -= (size_t)put;
    }
    return true;
}

// Fill a fresh file under a temporary name. False: errno; the file may be there.
static bool write_temporary(int directory, const char *temporary, const file_io_piece *pieces,
                            size_t n_pieces, file_io_sync sync)
{
    int fd = openat(directory, temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);

    if (fd < 0)
        return false;
    bool ok = true;
    for (size_t i = 0; i < n_pieces && ok; i++)
        ok = file_io_write_fd(fd, pieces[i].bytes, pieces[i].n);
    ok = ok && (sync != FILE_IO_NOW || fsync(fd) == 0);
    int error = errno;
    ok = close(fd) == 0 && ok;
    if (!ok && error != 0)
        errno = error;
    return ok;
}

bf_status file_io_replace_by_pieces(int directory, const char *name, const file_io_piece *pieces,
                                    size_t n_pieces, file_io_sync sync, bf_error *err)
{
    char temporary[TEMPORARY_SIZE];

    snprintf(temporary, sizeof temporary, "%s.part", name);
    errno = 0;
    if (write_temporary(directory, temporary, pieces, n_pieces, sync) &&
        renameat(directory, temporary, directory, name) == 0 &&
        (sync != FILE_IO_NOW || fsync(directory) == 0))
        return BF_OK;
    int error = errno;
    unlinkat(directory, temporary, 0);
    return bf_fail(err, BF_ESYSTEM, "", "%s cannot be written: %s", name, strerror(error));
}

bf_status file_io_replace(int directory, const char *name, const void *bytes, size_t n,
                          file_io_sync sync, bf_error *err)
{
    const file_io_piece piece = { bytes, n };

    return file_io_replace_by_pieces(directory, name, &piece, 1, sync, err);
}

static bool sync_path(const char *path, int flags)
{
    int fd = open(path, flags | O_CLOEXEC);
    bool ok = fd >= 0 && fsync(fd) == 0;
    int error = errno;

    if (fd >= 0)
        close(fd);
    errno = error;
    return ok;
}

static bool sync_folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = slash == NULL ? strdup(".") : strndup(path, (size_t)(slash - path) + 1);

    if (folder == NULL)
        return false;
    bool ok = sync_path(folder, O_RDONLY | O_DIRECTORY);
    int error = errno;
    free(folder);
    errno = error;
    return ok;
}

// Never over another file. Where the file system cannot rename so, it can link so.
static bool move_to_new(const char *from, const char *to)
{
    if (renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0)
        return true;
    if (errno != EINVAL || link(from, to) != 0)
        return false;
    if (unlink(from) == 0)
        return true;
    int error = errno;
    unlink(to);
    errno = error;
    return false;
}

// A name that may not survive a power loss is taken back.
static bool move_for_good(const char *from, const char *to)
{
    if (!move_to_new(from, to))
        return false;
    if (sync_folder_of(to))
        return true;
    int error = errno;
    rename(to, from);
    errno = error;
    return false;
}

bf_status file_io_publish(const char *temporary, const char *path, bf_error *err)
{
    if (sync_path(temporary, O_RDONLY) && move_for_good(temporary, path))
        return BF_OK;
    if (errno == EEXIST)
        return bf_fail(err, BF_EINPUT, "", "%s is there already", path);
    return bf_fail(err, BF_ESYSTEM, "", "%s cannot be written: %s", path, strerror(errno));
}

bf_status file_io_take_place(const char *temporary, const char *path, bf_error *err)
{
    if (sync_path(temporary, O_RDONLY) && rename(temporary, path) == 0 && sync_folder_of(path))
        return BF_OK;
    return bf_fail(err, BF_ESYSTEM, "", "%s cannot be replaced: %s", path, strerror(errno));
}

// A new name in a directory survives a power loss once the directory is synced.
static bool sync_parent(const char *path)
{
    int fd = open(path, O_PATH | O_DIRECTORY | O_CLOEXEC);
    int parent = fd < 0 ? -1 : openat(fd, "..", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    bool ok = parent >= 0 && fsync(parent) == 0;
    int error = errno;

    if (fd >= 0)
        close(fd);
    if (parent >= 0)
        close(parent);
    errno = error;
    return ok;
}

static bool make_directory(const char *path, mode_t mode, file_io_sync sync)
{
    if (mkdir(path, mode) != 0)
        return errno == EEXIST;
    return sync != FILE_IO_NOW || sync_parent(path);
}

bool file_io_make_directories(const char *path, mode_t mode, file_io_sync sync)
{
    char *part = strdup(path);

    if (part == NULL)
        return false;
    bool ok = true;
    for (char *slash = part; ok && slash != NULL;) {
        slash = strchr(slash + 1, '/');
        if (slash != NULL)
            *slash = '\0';
        ok = make_directory(part, mode, sync);
        if (slash != NULL)
            *slash = '/';
    }
    free(part);
    return ok;
}
