#include "tests/unit/server/helper_store_power.h"
#include "tests/unit/helper_cmocka.h"

#include <fcntl.h>
#include <pthread.h>
#include <sqlite3.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    FILES_MAX = 16, // of one process
    NAME_MAX_SIZE = 512,
    BYTES_MAX = 1 << 27, // of one file
    SECTOR = 512,        // that a disk writes wholly or not at all
};

// A change of a file that is not synced.
typedef struct change {
    struct change *next; // the one after it
    int64_t at;          // offset
    int64_t n;           // bytes; -1: the file was cut at the offset
    char bytes[];        // n
} change;

// What is on the disk of one file.
typedef struct disk_file {
    char name[NAME_MAX_SIZE];
    char *bytes; // synced, BYTES_MAX
    int64_t n;   // of them
    change *first;
    change **end; // where the next one is linked
} disk_file;

// One connection's handle of a file.
typedef struct handle {
    const sqlite3_file *file;
    disk_file *disk;
    const sqlite3_io_methods *original;
    sqlite3_io_methods methods; // original's, but for those that change files
} handle;

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER; // guards all of these
static sqlite3_vfs *below;
static disk_file files[FILES_MAX];
static size_t n_files;
static handle handles[8 * FILES_MAX];
static unsigned n_left; // changes and syncs until the power fails; 0: it does not
static unsigned seed;

// As assert_true(), on any thread.
static void require(bool holds)
{
    if (!holds)
        abort();
}

static bool is_lucky(unsigned of)
{
    return (unsigned)rand_r(&seed) % of == 0;
}

static void resize(disk_file *d, int64_t n)
{
    require(n <= BYTES_MAX);
    if (n > d->n)
        memset(d->bytes + d->n, 0, (size_t)(n - d->n));
    d->n = n;
}

static void apply(disk_file *d, const change *c, bool is_torn)
{
    if (c->n < 0) {
        resize(d, c->at);
        return;
    }
    if (c->at + c->n > d->n)
        resize(d, c->at + c->n);
    for (int64_t i = 0; i < c->n;) {
        int64_t n = SECTOR - (c->at + i) % SECTOR;
        n = n < c->n - i ? n : c->n - i;
        if (!is_torn || !is_lucky(2))
            memcpy(d->bytes + c->at + i, c->bytes + i, (size_t)n);
        i += n;
    }
}

static void write_disk(const disk_file *d)
{
    int fd = open(d->name, O_WRONLY | O_CLOEXEC);

    if (fd < 0)
        return; // deleted
    require(pwrite(fd, d->bytes, (size_t)d->n, 0) == d->n && ftruncate(fd, d->n) == 0);
    (void)close(fd);
}

static _Noreturn void lose_power(void)
{
    for (size_t i = 0; i < n_files; i++) {
        for (const change *c = files[i].first; c != NULL; c = c->next) {
            if (!is_lucky(3))
                apply(&files[i], c, is_lucky(2));
        }
        write_disk(&files[i]);
    }
    _exit(0);
}

static void pass_time(void)
{
    if (n_left > 0 && --n_left == 0)
        lose_power();
}

static handle *handle_of(const sqlite3_file *file)
{
    size_t i = 0;

    while (handles[i].file != file)
        require(++i < sizeof handles / sizeof *handles);
    return &handles[i];
}

static void remember(disk_file *d, int64_t at, int64_t n, const void *bytes)
{
    change *c = malloc(sizeof *c + (n > 0 ? (size_t)n : 0));

    require(c != NULL);
    *c = (change){ .at = at, .n = n };
    if (n > 0)
        memcpy(c->bytes, bytes, (size_t)n);
    *d->end = c;
    d->end = &c->next;
}

static int write_file(sqlite3_file *file, const void *bytes, int n, sqlite3_int64 at)
{
    pthread_mutex_lock(&mutex);
    const handle *h = handle_of(file);
    pass_time();
    int code = h->original->xWrite(file, bytes, n, at);
    if (code == SQLITE_OK)
        remember(h->disk, at, n, bytes);
    pthread_mutex_unlock(&mutex);
    return code;
}

static int cut_file(sqlite3_file *file, sqlite3_int64 n)
{
    pthread_mutex_lock(&mutex);
    const handle *h = handle_of(file);
    pass_time();
    int code = h->original->xTruncate(file, n);
    if (code == SQLITE_OK)
        remember(h->disk, n, -1, NULL);
    pthread_mutex_unlock(&mutex);
    return code;
}

// The real sync is left out: this process ends before the machine does.
static int sync_file(sqlite3_file *file, int flags)
{
    pthread_mutex_lock(&mutex);
    disk_file *d = handle_of(file)->disk;
    pass_time();
    while (d->first != NULL) {
        change *c = d->first;
        apply(d, c, false);
        d->first = c->next;
        free(c);
    }
    d->end = &d->first;
    pthread_mutex_unlock(&mutex);
    return SQLITE_OK;
}

static int close_file(sqlite3_file *file)
{
    pthread_mutex_lock(&mutex);
    handle *h = handle_of(file);
    const sqlite3_io_methods *original = h->original;
    h->file = NULL;
    pthread_mutex_unlock(&mutex);
    return original->xClose(file);
}

// What the file is when it is opened first counts as synced.
static disk_file *find_disk(const char *name)
{
    struct stat info;

    for (size_t i = 0; i < n_files; i++) {
        if (strcmp(files[i].name, name) == 0)
            return &files[i];
    }
    require(n_files < FILES_MAX && strlen(name) < NAME_MAX_SIZE);
    disk_file *d = &files[n_files++];
    strcpy(d->name, name);
    d->bytes = malloc(BYTES_MAX);
    require(d->bytes != NULL);
    d->end = &d->first;
    int fd = open(name, O_RDONLY | O_CLOEXEC);
    require(fd >= 0);
    require(fstat(fd, &info) == 0);
    require(info.st_size <= BYTES_MAX);
    d->n = read(fd, d->bytes, BYTES_MAX);
    require(d->n == info.st_size);
    (void)close(fd);
    return d;
}

static int open_file(sqlite3_vfs *vfs, const char *name, sqlite3_file *file, int flags,
                     int *ret_flags)
{
    int code = below->xOpen(below, name, file, flags, ret_flags);
    if (code != SQLITE_OK || name == NULL)
        return code;
    pthread_mutex_lock(&mutex);
    if (n_left > 0) {
        handle *h = handle_of(NULL);
        *h = (handle){ file, find_disk(name), file->pMethods, *file->pMethods };
        h->methods.iVersion = 2; // without the mapping of files, which would pass us by
        h->methods.xWrite = write_file;
        h->methods.xTruncate = cut_file;
        h->methods.xSync = sync_file;
        h->methods.xClose = close_file;
        file->pMethods = &h->methods;
    }
    pthread_mutex_unlock(&mutex);
    return code;
}

void helper_store_power_install(void)
{
    static sqlite3_vfs ours;

    below = sqlite3_vfs_find(NULL);
    assert_non_null(below);
    ours = *below;
    ours.zName = "power";
    ours.xOpen = open_file;
    assert_int_equal(sqlite3_vfs_register(&ours, 1), SQLITE_OK);
}

void helper_store_power_fail_at(unsigned n, unsigned seed_of_losses)
{
    n_left = n;
    seed = seed_of_losses;
}
