#include "server/cli/study_files.h"

#include "core/base/memory.h"
#include "server/base/file_io.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#define FILE_BYTES_MAX ((size_t)1 << 30)

static const char trials_name[] = "trials.csv";

struct study_files {
    int directory;
    int trials;     // of trials.csv, to append to; -1: not open
    char **lines;   // of each trial, with its end of line; NULL: it has not ended
    size_t n_lines; // room
};

static bf_status fail_at(const char *name, bf_error *err)
{
    return bf_fail(err, BF_ESYSTEM, "", "%s: %s", name, strerror(errno));
}

// Append a file of the directory to *out; nothing if there is none.
static bf_status read_file(const study_files *f, const char *name, bf_buffer *out, bf_error *err)
{
    const int fd = openat(f->directory, name, O_RDONLY | O_CLOEXEC);

    if (fd < 0)
        return errno == ENOENT ? BF_OK : fail_at(name, err);
    bf_status status = file_io_read_fd(fd, name, FILE_BYTES_MAX, out, err);
    close(fd);
    return status;
}

static bf_status check_document(study_files *f, const char *json, size_t n, bf_error *err)
{
    bf_buffer stored = { 0 };

    bf_status status = read_file(f, "study.json", &stored, err);
    if (status == BF_OK && stored.bytes == NULL)
        status = file_io_replace(f->directory, "study.json", json, n, FILE_IO_NOW, err);
    else if (status == BF_OK && (stored.n != n || memcmp(stored.bytes, json, n) != 0))
        status = bf_fail(err, BF_EINPUT, "",
                         "the directory has another study; its study.json is not this document");
    buffer_fini(&stored);
    return status;
}

bf_status study_files_open(const char *path, const char *json, size_t n, study_files **ret_files,
                           bf_error *err)
{
    study_files *f = memory_alloc(1, sizeof *f);

    if (f == NULL)
        return bf_fail_memory(err);
    f->trials = -1;
    f->directory = -1;
    if (file_io_make_directories(path, 0777, FILE_IO_LATER))
        f->directory = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    // Two that write to the same files would undo each other's lines. The lock ends with the descriptor.
    bf_status status = BF_OK;
    if (f->directory < 0 || flock(f->directory, LOCK_EX | LOCK_NB) != 0)
        status =
            f->directory >= 0 && errno == EWOULDBLOCK
                ? bf_fail(err, BF_EBUSY, "", "%.400s is used by another study that goes on", path)
                : fail_at(path, err);
    if (status == BF_OK)
        status = check_document(f, json, n, err);
    if (status == BF_OK)
        *ret_files = f;
    else
        study_files_close(f);
    return status;
}

static bf_status set_line(study_files *f, size_t trial, const char *line, size_t n, bf_error *err)
{
    if (trial >= f->n_lines) {
        const size_t n_new = 2 * trial + 64;
        const memory_array lines = { &f->lines, sizeof *f->lines, f->n_lines, n_new };
        if (memory_resize(&lines, 1) != 0)
            return bf_fail_memory(err);
        f->n_lines = n_new;
    }
    char *copy = strndup(line, n);
    if (copy == NULL)
        return bf_fail_memory(err);
    free(f->lines[trial]);
    f->lines[trial] = copy;
    return BF_OK;
}

// Write all lines by number in the place of the file.
static bf_status write_sorted(const study_files *f, const bf_buffer *header, bf_error *err)
{
    bf_buffer out = { 0 };

    bf_status status = buffer_append(&out, header->bytes, header->n);
    for (size_t k = 0; k < f->n_lines && status == BF_OK; k++)
        if (f->lines[k] != NULL)
            status = buffer_append(&out, f->lines[k], strlen(f->lines[k]));
    status = status != BF_OK
                 ? bf_fail(err, status, "", "out of memory")
                 : file_io_replace(f->directory, trials_name, out.bytes, out.n, FILE_IO_NOW, err);
    buffer_fini(&out);
    return status;
}

static bf_status read_lines(study_files *f, const study_columns *columns, const bf_buffer *text,
                            size_t from, bf_error *err)
{
    double values[STUDY_VALUES];
    bf_status status = BF_OK;
    size_t trial = 0;

    while (from < text->n && status == BF_OK) {
        const char *line = text->bytes + from;
        const char *end = memchr(line, '\n', text->n - from);
        if (end == NULL)
            break;
        const size_t n = (size_t)(end - line) + 1;
        if (study_trial_csv_read(columns, line, n, &trial, values))
            status = set_line(f, trial, line, n, err);
        from += n;
    }
    return status;
}

bf_status study_files_resume(study_files *f, const study_columns *columns, const bf_buffer *header,
                             bf_error *err)
{
    bf_buffer text = { 0 };

    bf_status status = read_file(f, trials_name, &text, err);
    if (status == BF_OK && text.n > 0) {
        if (text.n < header->n || memcmp(text.bytes, header->bytes, header->n) != 0)
            status = bf_fail(err, BF_EINPUT, "", "trials.csv is not that of this study");
        else
            status = read_lines(f, columns, &text, header->n, err);
    }
    buffer_fini(&text);
    if (status == BF_OK)
        status = write_sorted(f, header, err);
    if (status == BF_OK) {
        f->trials = openat(f->directory, trials_name, O_WRONLY | O_APPEND | O_CLOEXEC);
        status = f->trials < 0 ? fail_at(trials_name, err) : BF_OK;
    }
    return status;
}

bool study_files_find(const study_files *f, const study_columns *columns, size_t trial,
                      double *ret_values)
{
    size_t read = 0;

    return trial < f->n_lines && f->lines[trial] != NULL &&
           study_trial_csv_read(columns, f->lines[trial], strlen(f->lines[trial]), &read,
                                ret_values);
}

bf_status study_files_add(study_files *f, size_t trial, const bf_buffer *line, bf_error *err)
{
    BF_TRY(set_line(f, trial, line->bytes, line->n, err));
    if (!file_io_write_fd(f->trials, line->bytes, line->n))
        return fail_at(trials_name, err);
    return BF_OK;
}

bf_status study_files_finish(study_files *f, const bf_buffer *header, const bf_buffer *best,
                             bf_error *err)
{
    BF_TRY(write_sorted(f, header, err));
    return file_io_replace(f->directory, "best.json", best->bytes, best->n, FILE_IO_NOW, err);
}

void study_files_close(study_files *f)
{
    if (f == NULL)
        return;
    for (size_t k = 0; k < f->n_lines; k++)
        free(f->lines[k]);
    memory_free(f->lines);
    if (f->trials >= 0)
        close(f->trials);
    if (f->directory >= 0)
        close(f->directory);
    memory_free(f);
}
