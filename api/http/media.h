/// The formats that resources are served in, as one table: the word of ?format=, the media type of
/// Accept, the Content-Type.

#pragma once

#include "core/base/status.h"

#include <stddef.h>

/// Format, word, media type that Accept asks for, Content-Type. The first row of a format is the one
/// that ?format= gives. There are no registered media types for .vti and .vtp; they are not XML either,
/// as they contain raw bytes.
#define MEDIA_LIST(X)                                                                              \
    X(MEDIA_JSON, "json", "application/json", "application/json")                                  \
    X(MEDIA_CSV, "csv", "text/csv", "text/csv; charset=utf-8")                                     \
    X(MEDIA_NPY, "npy", "application/octet-stream", "application/octet-stream")                    \
    X(MEDIA_NPY, "npy", "application/x-npy", "application/x-npy")                                  \
    X(MEDIA_PNG, "png", "image/png", "image/png")                                                  \
    X(MEDIA_VTI, "vti", "application/x-vti", "application/x-vti")                                  \
    X(MEDIA_VTP, "vtp", "application/x-vtp", "application/x-vtp")                                  \
    X(MEDIA_PVD, "pvd", "application/xml", "application/xml")                                      \
    X(MEDIA_ZIP, "zip", "application/zip", "application/zip")                                      \
    X(MEDIA_PROMETHEUS, "prometheus", "text/plain", "text/plain; version=0.0.4; charset=utf-8")    \
    X(MEDIA_SSE, "sse", "text/event-stream", "text/event-stream")                                  \
    X(MEDIA_NDJSON, "ndjson", "application/x-ndjson", "application/x-ndjson")

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
    MEDIA_NDJSON
} media_format;

/// A row of the table.
typedef struct media {
    media_format format;      ///< which format
    const char *word;         ///< in ?format=
    const char *type;         ///< in Accept
    const char *content_type; ///< of the response
} media;

/// Choose among the formats that a resource has ("npy json", the default first): by word, the value
/// of ?format=, if that is not NULL, else by the Accept header (NULL: anything). *ret_media is
/// static. BF_EINPUT: none fits; the text names those that exist.
BF_MUST_CHECK bf_status media_choose(const char *formats, const char *word, const char *accept,
                                     const media **ret_media, bf_error *err);
