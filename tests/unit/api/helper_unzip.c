#include "tests/unit/api/helper_unzip.h"
#include "tests/unit/helper_cmocka.h"

#include <archive.h>
#include <archive_entry.h>
#include <stdio.h>

static void read_file(struct archive *a, struct archive_entry *entry, unzip_file *file)
{
    char bytes[4096];
    la_ssize_t n;

    snprintf(file->name, sizeof file->name, "%s", archive_entry_pathname(entry));
    file->mtime_s = archive_entry_mtime(entry);
    while ((n = archive_read_data(a, bytes, sizeof bytes)) > 0)
        assert_int_equal(buffer_append(&file->content, bytes, (size_t)n), BF_OK);
    assert_int_equal(n, 0);
}

size_t unzip_all(const bf_buffer *zip, unzip_file *ret_files)
{
    struct archive *a = archive_read_new();
    struct archive_entry *entry;
    size_t n = 0;
    int result;

    assert_non_null(a);
    assert_int_equal(archive_read_support_format_zip_seekable(a), ARCHIVE_OK);
    assert_int_equal(archive_read_open_memory(a, zip->bytes, zip->n), ARCHIVE_OK);
    while ((result = archive_read_next_header(a, &entry)) == ARCHIVE_OK) {
        assert_true(n < UNZIP_FILES_MAX);
        ret_files[n] = (unzip_file){ .mtime_s = 0 };
        read_file(a, entry, &ret_files[n++]);
    }
    assert_int_equal(result, ARCHIVE_EOF);
    archive_read_free(a);
    return n;
}

void unzip_fini(unzip_file *files, size_t n)
{
    for (size_t i = 0; i < n; i++)
        buffer_fini(&files[i].content);
}
