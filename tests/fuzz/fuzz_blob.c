// Compressed bytes of the store, as a damaged file could have them.

#include "tests/fuzz/fuzz.h"

#include "server/store/store_priv.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    bf_buffer out = { 0 };
    bf_error err;
    char *copy = fuzz_text(bytes, n);
    const bf_buffer compressed = { .bytes = copy, .n = n };

    const bf_status status = store__unpack(&compressed, &out, &err);
    fuzz_require(status == BF_OK || status == BF_ECORRUPT || status == BF_ENOMEM,
                 "bytes are unpacked or damaged");
    buffer_fini(&out);
    free(copy);
    return 0;
}
