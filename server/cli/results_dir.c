#include "server/cli/results_dir.h"

#include "api/results/results.h"
#include "api/results/results_files.h"
#include "core/base/memory.h"
#include "server/base/file_io.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

struct results_dir {
    int directory;     // locked
    int snapshots;     // directory/snapshots
    int parts;         // directory/parts; -1 where no parts came
    int curve;         // curve.csv, appended to
    off_t curve_bytes; // whole lines in it
    api_snapshot_list list;
    bf_buffer scenario; // the resolved document; empty: not known
    bf_buffer text;     // room for what is written next
    bf_buffer eyes;     // photo_eyes.csv so far
};

static bf_status fail_on(const char *name, bf_error *err)
{
    return bf_fail(err, BF_ESYSTEM, "", "%s cannot be written: %s", name, strerror(errno));
}

static bf_status open_folder(const results_dir *d, const char *name, int *ret_folder, bf_error *err)
{
    if (mkdirat(d->directory, name, 0777) != 0 && errno != EEXIST)
        return fail_on(name, err);
    *ret_folder = openat(d->directory, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return *ret_folder < 0 ? fail_on(name, err) : BF_OK;
}

static bf_status open_directories(results_dir *d, const char *path, bf_error *err)
{
    if (*path == '\0')
        errno = ENOENT;
    if (*path == '\0' || !file_io_make_directories(path, 0777, FILE_IO_LATER))
        return fail_on(path, err);
    d->directory = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (d->directory < 0)
        return fail_on(path, err);
    if (flock(d->directory, LOCK_EX | LOCK_NB) != 0)
        return bf_fail(err, BF_ESYSTEM, "", "%s is being written by another program", path);
    return open_folder(d, "snapshots", &d->snapshots, err);
}

// Append whole lines; a partial write is truncated.
static bf_status append_to_curve(results_dir *d, bf_error *err)
{
    if (!file_io_write_fd(d->curve, d->text.bytes, d->text.n)) {
        bf_status status = fail_on("curve.csv", err);
        return ftruncate(d->curve, d->curve_bytes) == 0 ? status : fail_on("curve.csv", err);
    }
    d->curve_bytes += (off_t)d->text.n;
    return BF_OK;
}

// Remove the results of an earlier run, its mark of completeness first, and begin the curve.
static bf_status begin_results(results_dir *d, const char *columns, bf_error *err)
{
    static const char *const marks[] = { "summary.json", "snapshots.json", "scenario.json",
                                         "photo_eyes.csv" };

    for (size_t i = 0; i < sizeof marks / sizeof *marks; i++) {
        if (unlinkat(d->directory, marks[i], 0) != 0 && errno != ENOENT)
            return fail_on(marks[i], err);
    }
    d->curve = openat(d->directory, "curve.csv",
                      O_WRONLY | O_APPEND | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (d->curve < 0)
        return fail_on("curve.csv", err);
    BF_TRY(results_curve_csv_header(columns, &d->text, err));
    return append_to_curve(d, err);
}

bf_status results_dir_open(const char *path, const char *columns, results_dir **ret_dir,
                           bf_error *err)
{
    results_dir *d = memory_alloc(1, sizeof *d);

    if (d == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the results");
    *d = (results_dir){ .directory = -1, .snapshots = -1, .parts = -1, .curve = -1 };
    bf_status status = open_directories(d, path, err);
    if (status == BF_OK)
        status = begin_results(d, columns, err);
    if (status != BF_OK) {
        results_dir_close(d);
        return status;
    }
    *ret_dir = d;
    return BF_OK;
}

bf_status results_dir_scenario(results_dir *d, const char *scenario, size_t n, bf_error *err)
{
    d->scenario.n = 0;
    if (buffer_append(&d->scenario, scenario, n) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the results");
    return file_io_replace(d->directory, "scenario.json", scenario, n, FILE_IO_LATER, err);
}

static bf_status take_curve(results_dir *d, const frame_curve *c, bf_error *err)
{
    d->text.n = 0;
    BF_TRY(results_curve_csv_rows(c->t, c->values, c->n, c->n_columns, &d->text, err));
    return append_to_curve(d, err);
}

static bf_status take_begin(results_dir *d, const frame_begin *begin, bf_error *err)
{
    d->list.grid = begin->grid;
    d->list.parts = (api_parts){ .n_parts = begin->n_parts, .n_values = begin->n_values };
    return begin->n_values == 0 ? BF_OK : open_folder(d, "parts", &d->parts, err);
}

// Make the text and an array behind it a file of the folder. Frames are little-endian, and so are the files.
static bf_status write_file(const results_dir *d, int folder, results_files file, uint64_t index,
                            const void *array, uint64_t n, bf_error *err)
{
    const file_io_piece pieces[] = { { d->text.bytes, d->text.n }, { array, (size_t)n } };
    char name[RESULTS_FILES_NAME_SIZE];

    return file_io_replace_by_pieces(folder, results_files_name(file, index, name), pieces, 2,
                                     FILE_IO_LATER, err);
}

static bf_status take_snapshot(results_dir *d, const frame *f, bf_error *err)
{
    const frame_snapshot *s = &f->snapshot;
    api_snapshot item = { .index = s->index, .t = s->t, .peak = s->peak, .mass = s->mass };

    d->text.n = 0;
    BF_TRY(results_npy_head(s->n1, s->n2, &d->text, err));
    BF_TRY(write_file(d, d->snapshots, RESULTS_FILES_SNAPSHOT, s->index, s->rho,
                      frame_array_bytes(f), err));
    if (buffer_append(&d->list.items, &item, sizeof item) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the list of snapshots");
    d->list.n++;
    return BF_OK;
}

static bf_status take_parts(results_dir *d, const frame *f, bf_error *err)
{
    const frame_parts *p = &f->parts;
    const api_parts parts = { .n_parts = p->n_parts, .n_values = p->n_values };

    d->text.n = 0;
    BF_TRY(results_parts_npy_head(&parts, &d->text, err));
    return write_file(d, d->parts, RESULTS_FILES_PARTS, p->index, p->rows, frame_array_bytes(f),
                      err);
}

bf_status results_dir_take(results_dir *d, const frame *f, bf_error *err)
{
    switch (f->type) {
    case FRAME_BEGIN:
        return take_begin(d, &f->begin, err);
    case FRAME_CURVE:
        return take_curve(d, &f->curve, err);
    case FRAME_SNAPSHOT:
        return take_snapshot(d, f, err);
    case FRAME_PARTS:
        return take_parts(d, f, err);
    case FRAME_CHANGE:
        return results_photo_eyes_csv(&f->change, &d->eyes, err);
    default:
        return BF_OK;
    }
}

// True for the name of a file that the run, which wrote n of them, did not write (an earlier one did).
static bool is_stale(const char *name, results_files file, uint64_t n)
{
    char own[RESULTS_FILES_NAME_SIZE];
    unsigned long long index = strtoull(name, NULL, 10);

    return index >= n && strcmp(name, results_files_name(file, index, own)) == 0;
}

// Remove what is stale from a folder; there may be none.
static bf_status remove_stale(const results_dir *d, const char *folder, results_files file,
                              uint64_t n, bf_error *err)
{
    int fd = openat(d->directory, folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *listing = fd < 0 ? NULL : fdopendir(fd);

    if (fd < 0 && errno == ENOENT)
        return BF_OK;
    if (listing == NULL) {
        if (fd >= 0)
            close(fd);
        return fail_on(folder, err);
    }
    bf_status status = BF_OK;
    for (struct dirent *entry; status == BF_OK && (entry = readdir(listing)) != NULL;) {
        if (is_stale(entry->d_name, file, n) && unlinkat(fd, entry->d_name, 0) != 0)
            status = fail_on(folder, err);
    }
    closedir(listing);
    return status;
}

// Make snapshots.json the text.
static bf_status list_snapshots(results_dir *d, bf_error *err)
{
    part_kinds kinds = { 0 };
    bf_status status = BF_OK;

    d->text.n = 0;
    if (d->scenario.n > 0)
        status = kinds_find(d->scenario.bytes, d->scenario.n, &d->list.parts, &kinds, err);
    if (status == BF_OK)
        status = results_snapshots_json(&d->list, NULL, &kinds, &d->text, err);
    kinds_fini(&kinds);
    return status;
}

bf_status results_dir_finish(results_dir *d, const char *summary, size_t n_summary, bf_error *err)
{
    bf_status status = list_snapshots(d, err);
    if (status == BF_OK)
        status = remove_stale(d, "snapshots", RESULTS_FILES_SNAPSHOT, d->list.n, err);
    if (status == BF_OK)
        status = remove_stale(d, "parts", RESULTS_FILES_PARTS, d->parts < 0 ? 0 : d->list.n, err);
    if (status == BF_OK && d->parts < 0)
        unlinkat(d->directory, "parts", AT_REMOVEDIR); // unless others put something there
    if (status == BF_OK)
        status = file_io_replace(d->directory, "snapshots.json", d->text.bytes, d->text.n,
                                 FILE_IO_LATER, err);
    if (status == BF_OK && d->eyes.n > 0)
        status = file_io_replace(d->directory, "photo_eyes.csv", d->eyes.bytes, d->eyes.n,
                                 FILE_IO_LATER, err);
    if (status != BF_OK || summary == NULL)
        return status;
    // One flush for all files, however many snapshots there are; only then their seal.
    if (syncfs(d->directory) != 0)
        return fail_on("the results", err);
    return file_io_replace(d->directory, "summary.json", summary, n_summary, FILE_IO_NOW, err);
}

results_dir *results_dir_close(results_dir *d)
{
    if (d == NULL)
        return NULL;
    int descriptors[] = { d->curve, d->parts, d->snapshots, d->directory };
    for (size_t i = 0; i < sizeof descriptors / sizeof *descriptors; i++) {
        if (descriptors[i] >= 0)
            close(descriptors[i]);
    }
    buffer_fini(&d->list.items);
    buffer_fini(&d->scenario);
    buffer_fini(&d->text);
    buffer_fini(&d->eyes);
    memory_free(d);
    return NULL;
}
