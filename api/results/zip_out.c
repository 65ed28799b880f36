#include "api/results/zip_out.h"

#include "core/base/check.h"
#include "core/base/memory.h"

#include <archive.h>
#include <archive_entry.h>
#include <stdbool.h>

// Densities and parts come from a solver: a higher level is slower and gains some 2 % of the bytes.
#define LEVEL "1"

enum { FILE_MODE = 0644 };

struct zip_out {
    struct archive *archive;
    struct archive_entry *entry;
    int64_t mtime_s;
    bf_buffer *out;  // during a call
    bool has_failed; // no memory for what came out
};

static la_ssize_t append_bytes(struct archive *archive, void *context, const void *bytes, size_t n)
{
    zip_out *z = context;

    // An unfinished archive writes its rest when it is freed (out is NULL): dropped. A failure is not
    // returned to the library, which would leak memory then (3.6.2).
    (void)archive;
    if (z->out != NULL && !z->has_failed)
        z->has_failed = buffer_append(z->out, bytes, n) != BF_OK;
    return (la_ssize_t)n;
}

// The library refuses nothing of what this module asks for but where it has no memory.
static bf_status check(int result, bf_error *err)
{
    return result == ARCHIVE_OK ? BF_OK : bf_fail_memory(err);
}

// The end of a call that writes.
static bf_status finish_call(zip_out *z, int result, bf_error *err)
{
    z->out = NULL;
    return check(z->has_failed ? ARCHIVE_FATAL : result, err);
}

static bf_status open_archive(zip_out *z, bf_error *err)
{
    struct archive *a = z->archive = archive_write_new();

    z->entry = archive_entry_new();
    if (a == NULL || z->entry == NULL)
        return check(ARCHIVE_FATAL, err);
    int result = archive_write_set_format_zip(a);
    if (result == ARCHIVE_OK)
        result = archive_write_zip_set_compression_deflate(a);
    if (result == ARCHIVE_OK)
        result = archive_write_set_format_option(a, "zip", "compression-level", LEVEL);
    if (result == ARCHIVE_OK)
        result = archive_write_set_bytes_per_block(a, 0);
    if (result == ARCHIVE_OK)
        result = archive_write_open(a, z, NULL, append_bytes, NULL);
    return check(result, err);
}

bf_status zip_out_create(int64_t mtime_s, zip_out **ret_zip, bf_error *err)
{
    zip_out *z = memory_alloc(1, sizeof *z);

    if (z == NULL)
        return check(ARCHIVE_FATAL, err);
    z->mtime_s = mtime_s;
    bf_status status = open_archive(z, err);
    if (status != BF_OK) {
        zip_out_destroy(z);
        return status;
    }
    *ret_zip = z;
    return BF_OK;
}

bf_status zip_out_file(zip_out *z, const char *name, size_t n, bf_buffer *out, bf_error *err)
{
    z->out = out;
    archive_entry_clear(z->entry);
    archive_entry_set_pathname(z->entry, name);
    archive_entry_set_filetype(z->entry, AE_IFREG);
    archive_entry_set_perm(z->entry, FILE_MODE);
    if (n != ZIP_OUT_ANY_SIZE)
        archive_entry_set_size(z->entry, (la_int64_t)n);
    archive_entry_set_mtime(z->entry, z->mtime_s, 0);
    return finish_call(z, archive_write_header(z->archive, z->entry), err);
}

bf_status zip_out_bytes(zip_out *z, const void *bytes, size_t n, bf_buffer *out, bf_error *err)
{
    const char *from = bytes;
    la_ssize_t taken = 0;

    z->out = out;
    while (n > 0 && taken >= 0) {
        taken = archive_write_data(z->archive, from, n);
        BF_CHECK(taken != 0 && taken <= (la_ssize_t)n); // 0: beyond the file's size
        if (taken > 0) {
            from += taken;
            n -= (size_t)taken;
        }
    }
    return finish_call(z, taken < 0 ? ARCHIVE_FATAL : ARCHIVE_OK, err);
}

bf_status zip_out_finish(zip_out *z, bf_buffer *out, bf_error *err)
{
    z->out = out;
    return finish_call(z, archive_write_close(z->archive), err);
}

zip_out *zip_out_destroy(zip_out *z)
{
    if (z == NULL)
        return NULL;
    archive_entry_free(z->entry);
    archive_write_free(z->archive);
    memory_free(z);
    return NULL;
}
