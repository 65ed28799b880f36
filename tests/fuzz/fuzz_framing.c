// The framing of a connection's requests: bytes as they are received.

#include "tests/fuzz/fuzz.h"

#include "core/base/buffer.h"
#include "server/http/mhd/framing.h"

#include <string.h>

enum { BODY_LIMIT = 4096 };

// Follows bytes in pieces of n_piece; *ret_left is what is left of them.
static http_framing follow(const uint8_t *bytes, size_t n, size_t n_piece, bf_buffer *ret_left)
{
    http_framing f = { .body_limit = BODY_LIMIT };

    for (size_t i = 0; i < n; i += n_piece) {
        const size_t n_now = n - i < n_piece ? n - i : n_piece;
        char *at = buffer_reserve(ret_left, f.n_held + n_now);
        fuzz_require(at != NULL, "memory");
        memcpy(at + f.n_held, bytes + i, n_now);
        ret_left->n += http_framing_follow(&f, at, n_now);
    }
    return f;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    bf_buffer left = { 0 }, left_of_pieces = { 0 };
    http_framing at_once = follow(bytes, n, n + 1, &left);
    http_framing in_pieces = follow(bytes, n, 1, &left_of_pieces);

    fuzz_require(at_once.stage == in_pieces.stage && at_once.n_left == in_pieces.n_left &&
                     at_once.n_messages == in_pieces.n_messages &&
                     at_once.refusal == in_pieces.refusal,
                 "bytes mean the same however they are cut");
    fuzz_require(left.n == left_of_pieces.n &&
                     (left.n == 0 || memcmp(left.bytes, left_of_pieces.bytes, left.n) == 0),
                 "the same bytes go on however they are cut");
    fuzz_require(left.n + at_once.n_held <= n, "nothing is added");
    fuzz_require(at_once.refusal == 0 || at_once.refusal == 400 || at_once.refusal == 413,
                 "the status of a refusal");
    fuzz_require(at_once.n_body <= BODY_LIMIT, "no body is larger than the limit");
    buffer_fini(&left);
    buffer_fini(&left_of_pieces);
    return 0;
}
