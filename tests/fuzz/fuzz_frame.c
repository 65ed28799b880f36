// Frames, as a solver that went wrong could send them: with a digest that fits. What is read can be written, and reads
// back to the same bytes.

#include "tests/fuzz/fuzz.h"

#include "core/observe/frame.h"

#include <stdlib.h>
#include <string.h>

static void read_back(const frame *f)
{
    frame again;
    size_t used = 0;
    bf_error err;
    bf_buffer out = { 0 }, twice = { 0 };

    fuzz_require(frame_encode(f, &out, &err) == BF_OK, "a frame that was read can be written");
    fuzz_require(frame_decode(out.bytes, out.n, &again, &used, &err) == BF_OK && used == out.n,
                 "and read");
    fuzz_require(frame_encode(&again, &twice, &err) == BF_OK, "and written");
    fuzz_require(twice.n == out.n && memcmp(twice.bytes, out.bytes, out.n) == 0,
                 "to the same bytes");
    buffer_fini(&out);
    buffer_fini(&twice);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    const size_t n_aligned = n / 8 * 8;
    uint8_t *copy = malloc(n_aligned > 0 ? n_aligned : 1);
    frame f;
    size_t used = 0;
    bf_error err;

    fuzz_require(copy != NULL, "memory for an input");
    if (n_aligned > 0)
        memcpy(copy, bytes, n_aligned);
    if (fuzz_seal_frame(copy, n_aligned) &&
        frame_decode(copy, n_aligned, &f, &used, &err) == BF_OK && used > 0)
        read_back(&f);
    free(copy);
    return 0;
}
