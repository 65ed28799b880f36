// The framing of a connection's requests: bytes as they are received.

#include "tests/fuzz/fuzz.h"

#include "server/http/framing.h"

enum { BODY_LIMIT = 4096 };

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    http_framing at_once = { .body_limit = BODY_LIMIT }, in_pieces = at_once;

    http_framing_follow(&at_once, (const char *)bytes, n);
    for (size_t i = 0; i < n; i++)
        http_framing_follow(&in_pieces, (const char *)bytes + i, 1);
    fuzz_require(at_once.stage == in_pieces.stage && at_once.n_left == in_pieces.n_left &&
                     at_once.n_messages == in_pieces.n_messages &&
                     at_once.refusal == in_pieces.refusal,
                 "bytes mean the same however they are cut");
    fuzz_require(at_once.refusal == 0 || at_once.refusal == 400 || at_once.refusal == 413,
                 "the status of a refusal");
    fuzz_require(at_once.n_body <= BODY_LIMIT, "no body is larger than the limit");
    return 0;
}
