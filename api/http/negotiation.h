/// What a client asks for in the headers of a request: the media type (Accept), the content coding
/// (Accept-Encoding), a state of the resource (If-Match, If-None-Match), a wait (Prefer), and that a
/// repeated request takes effect once (Idempotency-Key).

#pragma once

#include "api/services.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/// The formats that resources are served in: format, word, media type that Accept asks for,
/// Content-Type. The first row of a format is the one that ?format= gives. There are no registered
/// media types for .vti and .vtp; they are not XML either, as they contain raw bytes.
#define MEDIA_LIST(X)                                                                              \
    X(MEDIA_JSON, "json", "application/json", "application/json")                                  \
    X(MEDIA_CSV, "csv", "text/csv", "text/csv; charset=utf-8")                                     \
    X(MEDIA_JSON, "patch", "application/merge-patch+json", "application/merge-patch+json")         \
    X(MEDIA_NPY, "npy", "application/octet-stream", "application/octet-stream")                    \
    X(MEDIA_NPY, "npy", "application/x-npy", "application/x-npy")                                  \
    X(MEDIA_PNG, "png", "image/png", "image/png")                                                  \
    X(MEDIA_VTI, "vti", "application/x-vti", "application/x-vti")                                  \
    X(MEDIA_VTP, "vtp", "application/x-vtp", "application/x-vtp")                                  \
    X(MEDIA_PVD, "pvd", "application/xml", "application/xml")                                      \
    X(MEDIA_ZIP, "zip", "application/zip", "application/zip")                                      \
    X(MEDIA_PROMETHEUS, "prometheus", "text/plain", "text/plain; version=0.0.4; charset=utf-8")    \
    X(MEDIA_SSE, "sse", "text/event-stream", "text/event-stream")                                  \
    X(MEDIA_NDJSON, "ndjson", "application/x-ndjson", "application/x-ndjson")                      \
    X(MEDIA_FRAMES, "frames", "application/octet-stream", "application/octet-stream")

/// The formats.
typedef enum media_format {
    MEDIA_JSON,
    MEDIA_CSV,
    MEDIA_NPY,
    MEDIA_PNG,
    MEDIA_VTI,
    MEDIA_VTP,
    MEDIA_PVD,
    MEDIA_ZIP,
    MEDIA_PROMETHEUS,
    MEDIA_SSE,
    MEDIA_NDJSON,
    MEDIA_FRAMES
} media_format;

/// A row of the table.
typedef struct media {
    media_format format;      ///< which format
    const char *word;         ///< in ?format=
    const char *type;         ///< in Accept
    const char *content_type; ///< of the response
} media;

enum { NEGOTIATION_TYPES_SIZE = 64 }; ///< bytes of the types of a body with their terminator

/// Choose among the formats that a resource has ("npy json", the default first): by word, the value
/// of ?format=, if that is not NULL, else by the Accept header (NULL: anything). *ret_media is
/// static. BF_EINPUT: none fits; the text names those that exist.
BF_MUST_CHECK bf_status negotiation_choose_media(const char *formats, const char *word,
                                                 const char *accept, const media **ret_media,
                                                 bf_error *err);

/// True if a list of words of formats ("npy json") has this one.
bool negotiation_has_format(const char *formats, const char *word);

/// The one of the formats of a body that its Content-Type names; NULL: none of them. Parameters have no effect: JSON has no
/// charset (RFC 8259, 11), and what is taken of CSV is ASCII. The types of the formats are written to ret_types
/// (NEGOTIATION_TYPES_SIZE bytes), with commas between.
const media *negotiation_find_body(const char *formats, const char *content_type, char *ret_types);

/// Accept (RFC 9110, 12.5.1): the media type among offers with the highest q-value, the first one of
/// those with the same. For each offer the most specific range counts (type/subtype before type/*
/// before */*); parameters other than q are ignored. header NULL or "" accepts everything; a member
/// that cannot be read accepts nothing. Returns its index, or -1 if none is acceptable.
int negotiation_choose_type(const char *header, const char *const *offers, size_t n_offers);

/// Content codings (RFC 9110, 8.4.1): coding, its word. The first one is preferred among those with the
/// same q-value.
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
const char *negotiation_coding_word(coding c);

/// The q-value of a coding in Accept-Encoding (RFC 9110, 12.5.3), in thousandths; 0: not acceptable.
/// Where the header does not mention it, identity has the lowest q-value above 0, any other 0. header
/// NULL or "": identity only.
int negotiation_coding_quality(const char *header, coding c);

/// The coding among offers with the highest q-value, the first one of those with the same; -1 if none is
/// acceptable.
int negotiation_choose_coding(const char *header, const coding *offers, size_t n_offers);

/// Write the entity tag (without quotes, CODING_TAG_SIZE bytes) of the encoded form of a representation
/// with this tag: the tag, a dash and the coding's word, as an encoded representation differs from the
/// plain one; the tag itself for identity. Too long a tag is a bug.
void negotiation_coding_tag(const char *tag, coding c, char *ret_tag);

/// True if If-None-Match (RFC 9110, 13.1.2) names the state of which tag is the plain form's, without
/// quotes: `*`, or by weak comparison the tag of the plain or of an encoded form that the client
/// accepts (accept_encoding may be NULL). *ret_tag (CODING_TAG_SIZE bytes) is then the tag that the
/// client has sent.
bool negotiation_match_etag(const char *if_none_match, const char *tag, const char *accept_encoding,
                            char *ret_tag);

/// True if If-Match (RFC 9110, 13.1.1) allows a change of the state with this tag: `*`, or by strong
/// comparison the tag of any form.
bool negotiation_allows_change(const char *if_match, const char *tag);

/// The seconds of `wait=N` in the header Prefer (RFC 7240); true if it is there and can be read. The
/// first one counts, more than UINT_MAX is UINT_MAX, unknown preferences are ignored. header may be
/// NULL.
bool negotiation_read_wait(const char *header, unsigned *ret_seconds);

/// Read the value of Idempotency-Key (draft-ietf-httpapi-idempotency-key-header), NULL meaning none ("" in
/// ret_key): a string as structured fields write it (RFC 8941: in quotes, \" and \\ inside), or, as most
/// clients send it, the bare key, of visible ASCII without quotes, commas, semicolons and backslashes.
/// Both forms of a key are the same key. BF_EINPUT: neither, or none or more than API_KEY_SIZE - 1
/// bytes.
BF_MUST_CHECK bf_status negotiation_read_key(const char *header, char ret_key[API_KEY_SIZE],
                                             bf_error *err);
