/// The framing of a connection's requests (RFC 9112, 6 and 7.1): a pure function over received bytes.
///
/// MHD decodes chunked bodies without showing how they were framed, and leniently: it takes a lone LF for
/// the end of a chunk's size, any byte in an extension, and trailers unread. A proxy in front of it that
/// reads such bytes differently lets one request be hidden in another. So all that is received is followed
/// here first, message by message.
///
/// Only header fields that decide the framing are looked at. A header whose framing is at fault itself is
/// refused by the guard (server/http/guard.h), with its connection; nothing behind it is followed.
///
/// White space behind a field's value is no part of it (RFC 9110, 5.5), but MHD leaves it there, and refuses a
/// Content-Length that has some. It is taken out of what is received. Since the byte that shows whether a value goes on
/// may not be there yet, white space is held back until it is.

#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    HTTP_FRAMING_TEXT_MAX = 32,  ///< bytes of a name or value that are kept
    HTTP_FRAMING_SPACE_MAX = 64, ///< bytes of white space that are held back; longer runs are left
    HTTP_CHUNK_LINE_MAX = 256,   ///< bytes of a chunk's size with its extensions
    HTTP_CHUNK_TRAILERS_MAX = 4096, ///< bytes of all trailers of a message
};

/// What the next byte belongs to.
typedef enum http_framing_stage {
    HTTP_FRAMING_START, ///< zero: between messages
    HTTP_FRAMING_REQUEST_LINE,
    HTTP_FRAMING_NAME, ///< of a header field, or the empty line
    HTTP_FRAMING_VALUE,
    HTTP_FRAMING_VALUE_LF,
    HTTP_FRAMING_HEADER_LF, ///< the last byte of the header
    HTTP_FRAMING_BODY,      ///< n_left bytes
    HTTP_FRAMING_CHUNK_SIZE,
    HTTP_FRAMING_CHUNK_EXTENSION,
    HTTP_FRAMING_CHUNK_LF, ///< after size and extensions
    HTTP_FRAMING_CHUNK,    ///< n_left bytes
    HTTP_FRAMING_CHUNK_END_CR,
    HTTP_FRAMING_CHUNK_END_LF,
    HTTP_FRAMING_TRAILER_NAME, ///< or the empty line
    HTTP_FRAMING_TRAILER_VALUE,
    HTTP_FRAMING_TRAILER_LF,
    HTTP_FRAMING_LAST_LF, ///< the last byte of a chunked message
    HTTP_FRAMING_ENDED,   ///< nothing is followed any more: see refusal
} http_framing_stage;

/// Where a connection is in its messages. Zero-initialise, and set body_limit.
typedef struct http_framing {
    uint64_t body_limit;               ///< bytes of a chunked body
    http_framing_stage stage;          ///< what comes next
    uint64_t n_left;                   ///< bytes of the body or chunk that are to come
    uint64_t n_body;                   ///< bytes of all chunks so far
    unsigned n_line;                   ///< bytes of this chunk's line, or of all trailers
    unsigned n_digits;                 ///< of the chunk's size
    unsigned n_messages;               ///< headers that are complete
    unsigned n_lengths;                ///< fields of this header that tell the body's length
    bool is_chunked;                   ///< one of them is `Transfer-Encoding: chunked`
    uint64_t length;                   ///< or else the length
    size_t n_name, n_value;            ///< bytes kept
    char name[HTTP_FRAMING_TEXT_MAX];  ///< of this field
    char value[HTTP_FRAMING_TEXT_MAX]; ///< of this field, without white space in front
    size_t n_held;                     ///< bytes held back
    char held[HTTP_FRAMING_SPACE_MAX]; ///< white space within or behind a value
    int refusal;                       ///< HTTP status for message n_messages, 400 or 413; 0: none
    const char *fault;                 ///< why
} http_framing;

/// True for the bytes that a token has (RFC 9110, 5.6.2).
bool http_framing_is_token(char c);

/// True for control bytes but the tab.
bool http_framing_is_control(char c);

/// Follow the next n bytes of the connection, which stand at bytes + f->n_held: what was held back goes before them.
/// Returns how many bytes stand at `bytes` afterwards. Once refusal is set, nothing more is looked at.
size_t http_framing_follow(http_framing *f, char *bytes, size_t n);

/// Where there is no room to go on receiving: move at most n of the bytes that are held back to `bytes`. Returns how
/// many.
size_t http_framing_release(http_framing *f, char *bytes, size_t n);
