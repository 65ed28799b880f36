#include "tests/unit/core/helper_backend.h"

bf_status helper_backend_save(const run_backend *model, const void *solver, bf_buffer *out)
{
    checkpoint_writer w;

    checkpoint_begin(&w, out, CHECKPOINT_RUN, 0);
    const bf_status status = model->save(solver, &w, NULL);
    w.has_failed = w.has_failed || status != BF_OK;
    return checkpoint_end(&w, NULL);
}

bf_status helper_backend_load(const run_backend *model, void *solver, const bf_buffer *from)
{
    checkpoint_reader r;
    const bf_status status = checkpoint_open(&r, from->bytes, from->n, CHECKPOINT_RUN, 0, NULL);

    return status == BF_OK ? model->load(solver, &r, NULL) : status;
}
