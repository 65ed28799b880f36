#include "api/results/array_file.h"

#include "api/results/results.h"
#include "api/results/results_priv.h"
#include "core/base/memory.h"

#include <string.h>

// What the form has before and behind the numbers.
static bf_status enclose(array_file_form form, const api_array *of, array_file *file)
{
    if (form == ARRAY_FILE_PARTS_NPY)
        return results__npy_head("<f8", of->parts.n_values, (size_t)of->parts.n_parts, &file->head);
    if (form == ARRAY_FILE_NPY)
        return results__npy_head("<f4", of->grid.n1, of->grid.n2, &file->head);
    BF_TRY(results__vti_head(&of->grid, of->snapshot.t, &file->head));
    return results__vti_tail(&file->tail);
}

bf_status array_file_open(const api_services *services, const char *id, uint64_t index,
                          array_file_form form, array_file *ret_file, bf_error *err)
{
    const bool is_parts = form == ARRAY_FILE_PARTS_NPY;
    array_file file = { .item_size = is_parts ? sizeof(double) : sizeof(float) };
    api_array of;

    bf_status status = services->open_array(services->store, id, index,
                                            is_parts ? API_ARRAY_PARTS : API_ARRAY_DENSITY, &of,
                                            &file.slices, err);
    if (status == BF_OK)
        status = enclose(form, &of, &file);
    if (status == BF_OK)
        *ret_file = file;
    else
        array_file_fini(&file);
    // What is appended to buffers says no more than that there is no memory.
    return status == BF_ENOMEM ? bf_fail_memory(err) : status;
}

uint64_t array_file_size(const array_file *file)
{
    return file->head.n + file->slices.n + file->tail.n;
}

// From byte `at` of a text on.
static bf_status read_text(const bf_buffer *text, uint64_t at, size_t limit, bf_buffer *out,
                           bf_error *err)
{
    const size_t left = text->n - (size_t)at;

    if (buffer_append(out, text->bytes + at, left < limit ? left : limit) == BF_OK)
        return BF_OK;
    return bf_fail_memory(err);
}

// From byte `at` of the numbers on. Whole numbers are read, so that their byte order can be changed.
static bf_status read_numbers(array_file *file, const api_services *services, uint64_t at,
                              size_t limit, bf_buffer *out, bf_error *err)
{
    const size_t size = file->item_size, n_before = out->n, n_extra = (size_t)(at % size);
    const uint64_t left = file->slices.n - at;
    const size_t n_wanted =
        ((left < limit ? (size_t)left : limit) + n_extra + size - 1) / size * size;

    BF_TRY(services->read_slice(services->store, &file->slices, at - n_extra, n_wanted, out, err));
    results__order_bytes(out->bytes + n_before, (out->n - n_before) / size, size);
    size_t n = out->n - n_before - n_extra;
    n = n < limit ? n : limit;
    memmove(out->bytes + n_before, out->bytes + n_before + n_extra, n);
    buffer_truncate(out, n_before + n);
    return BF_OK;
}

bf_status array_file_read(array_file *file, const api_services *services, uint64_t at,
                          size_t limit_bytes, bf_buffer *out, bf_error *err)
{
    const uint64_t n_before_tail = file->head.n + file->slices.n;

    if (at < file->head.n)
        return read_text(&file->head, at, limit_bytes, out, err);
    if (at < n_before_tail)
        return read_numbers(file, services, at - file->head.n, limit_bytes, out, err);
    if (at < n_before_tail + file->tail.n)
        return read_text(&file->tail, at - n_before_tail, limit_bytes, out, err);
    return BF_OK;
}

void array_file_fini(array_file *file)
{
    buffer_fini(&file->head);
    buffer_fini(&file->tail);
    api_slices_fini(&file->slices);
    *file = (array_file){ .item_size = 0 };
}

// The body's state.
typedef struct sent_file {
    array_file file;
    uint64_t at;
} sent_file;

static bf_status next_chunk(void *state, const api_services *services, size_t limit_bytes,
                            bf_buffer *out, body_state *ret_state, bf_error *err)
{
    sent_file *sent = state;
    const size_t n_before = out->n;

    BF_TRY(array_file_read(&sent->file, services, sent->at, limit_bytes, out, err));
    sent->at += out->n - n_before;
    *ret_state = sent->at < array_file_size(&sent->file) ? BODY_MORE : BODY_DONE;
    return BF_OK;
}

static void seek(void *state, uint64_t at)
{
    ((sent_file *)state)->at = at;
}

static void destroy(void *state)
{
    sent_file *sent = state;

    array_file_fini(&sent->file);
    memory_free(sent);
}

bf_status array_file_send(array_file *file, body_source *ret_source, bf_error *err)
{
    sent_file *sent = memory_alloc(1, sizeof *sent);

    if (sent == NULL) {
        array_file_fini(file);
        return bf_fail_memory(err);
    }
    sent->file = *file;
    *file = (array_file){ .item_size = 0 };
    *ret_source = (body_source){ .state = sent,
                                 .next_chunk = next_chunk,
                                 .destroy = destroy,
                                 .seek = seek,
                                 .n = array_file_size(&sent->file),
                                 .n_held = sizeof *sent + sent->file.slices.n_held };
    return BF_OK;
}
