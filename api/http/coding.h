/// Content codings (RFC 9110, 8.4.1) and the choice between them by Accept-Encoding (12.5.3).
///
/// A representation that is encoded is another one than the plain one, so it has an entity tag of its
/// own: that of the plain one, a dash and the coding's word.

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// Coding, its word. The first one is preferred where a client likes several as much.
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

/// What a client thinks of a coding, in thousandths; 0 is not acceptable. Where the header does not
/// speak of it, identity is acceptable but least liked, any other is not. header NULL or "": identity
/// only.
int coding_quality(const char *header, coding c);

/// The coding among offers that the client likes most, the first of those it likes as much; -1 if it
/// accepts none of them.
int coding_choose(const char *header, const coding *offers, size_t n_offers);

/// Write the entity tag (without quotes, CODING_TAG_SIZE bytes) that a representation with this tag
/// has when it is encoded; too long a tag is a bug.
void coding_tag(const char *tag, coding c, char *ret_tag);
