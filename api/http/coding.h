/// Content codings (RFC 9110, 8.4.1) and the choice between them by Accept-Encoding (12.5.3).
///
/// An encoded representation differs from the plain one, so it has an entity tag of its own: that of the
/// plain one, a dash and the coding's word.

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// Coding, its word. The first one is preferred among those with the same q-value.
#define CODING_LIST(X)                                                                             \
    X(CODING_ZSTD, "zstd")                                                                         \
    X(CODING_GZIP, "gzip")                                                                         \
    X(CODING_IDENTITY, "identity")

/// The codings.
typedef enum coding {
#define X(name, word) name,
    CODING_LIST(X)
#undef X
        CODING_COUNT
} coding;

enum { CODING_TAG_SIZE = 128 }; ///< bytes of an entity tag without quotes, with its terminator

/// The word of a coding. Never NULL.
const char *coding_word(coding c);

/// The q-value of a coding in Accept-Encoding, in thousandths; 0: not acceptable. Where the header does
/// not mention it, identity has the lowest q-value above 0, any other 0. header NULL or "": identity only.
int coding_quality(const char *header, coding c);

/// The coding among offers with the highest q-value, the first one of those with the same; -1 if none is
/// acceptable.
int coding_choose(const char *header, const coding *offers, size_t n_offers);

/// Write the entity tag (without quotes, CODING_TAG_SIZE bytes) of the encoded form of a representation
/// with this tag; too long a tag is a bug.
void coding_tag(const char *tag, coding c, char *ret_tag);
