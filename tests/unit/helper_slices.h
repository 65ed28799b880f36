/// Arrays that are read piece by piece (api_slices), for services that hold them whole.

#pragma once

#include "api/services.h"
#include "core/base/buffer.h"
#include "core/base/memory.h"

static inline void helper_slices_destroy(void *state)
{
    buffer_fini(state);
    memory_free(state);
}

/// Hand over what was read into *bytes, from memory_alloc(), if status says that it was; else free it. Returns status.
static inline bf_status helper_slices_open(bf_status status, bf_buffer *bytes,
                                           api_slices *ret_slices)
{
    if (status == BF_OK)
        *ret_slices =
            (api_slices){ .n = bytes->n, .state = bytes, .destroy = helper_slices_destroy };
    else
        helper_slices_destroy(bytes);
    return status;
}

/// api_services.read_slice.
static inline bf_status helper_slices_read(api_store *store, api_slices *slices, uint64_t at,
                                           size_t limit_bytes, bf_buffer *out, bf_error *err)
{
    const bf_buffer *bytes = slices->state;
    const size_t left = bytes->n - (size_t)at;

    if (buffer_append(out, bytes->bytes + at, left < limit_bytes ? left : limit_bytes) == BF_OK)
        return BF_OK;
    return bf_fail(err, BF_ENOMEM, "", "out of memory");
}
