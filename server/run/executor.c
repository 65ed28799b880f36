#include "server/run/executor.h"

#include "core/observe/frame.h"

bf_status executor_encode(const executor_work *work, bf_buffer *out, bf_error *err)
{
    const frame job = { .type = FRAME_JOB,
                        .job = { .model = (uint32_t)work->model,
                                 .n_threads = work->n_threads,
                                 .n_document = work->scenario->n,
                                 .document = work->scenario->bytes,
                                 .is_without_snapshots = work->is_trial } };
    const frame resume = {
        .type = FRAME_RESUME,
        .bytes = { .step = work->step, .n = work->checkpoint->n, .bytes = work->checkpoint->bytes }
    };

    bf_status status = frame_encode(&job, out, err);
    return status != BF_OK || work->checkpoint->n == 0 ? status : frame_encode(&resume, out, err);
}
