#include "server/http/mhd/framing.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

bool http_framing_is_token(char c)
{
    unsigned char u = (unsigned char)c;

    return u < 0x80 && (isalnum(u) || (u != '\0' && strchr("!#$%&'*+-.^_`|~", u) != NULL));
}

bool http_framing_is_control(char c)
{
    unsigned char u = (unsigned char)c;

    return (u < 0x20 && u != '\t') || u == 0x7f;
}

static void refuse(http_framing *f, int status, const char *fault)
{
    f->stage = HTTP_FRAMING_ENDED;
    f->refusal = status;
    f->fault = fault;
}

// The guard refuses the header that is being read.
static void leave_to_guard(http_framing *f)
{
    f->stage = HTTP_FRAMING_ENDED;
}

static void append_byte(char *text, size_t *n, char c)
{
    if (*n < HTTP_FRAMING_TEXT_MAX)
        text[*n] = c;
    ++*n;
}

static bool is_text(const char *text, size_t n, const char *wanted)
{
    return n == strlen(wanted) && strncasecmp(text, wanted, n) == 0;
}

// False: no number, or none that is near a limit.
static bool read_length(http_framing *f)
{
    f->length = 0;
    for (size_t i = 0; i < f->n_value; i++) {
        if (f->value[i] < '0' || f->value[i] > '9' || f->length > UINT64_MAX / 100)
            return false;
        f->length = 10 * f->length + (uint64_t)(f->value[i] - '0');
    }
    return f->n_value > 0;
}

static void end_field(http_framing *f)
{
    bool is_length = is_text(f->name, f->n_name, "Content-Length");
    bool is_encoding = is_text(f->name, f->n_name, "Transfer-Encoding");

    f->stage = HTTP_FRAMING_NAME;
    if (is_length || is_encoding) {
        f->n_lengths++;
        f->is_chunked = is_encoding && is_text(f->value, f->n_value, "chunked");
        if (f->n_lengths > 1 || f->n_value > sizeof f->value ||
            (is_length ? !read_length(f) : !f->is_chunked))
            leave_to_guard(f);
    }
    f->n_name = f->n_value = 0;
}

static void begin_chunk(http_framing *f)
{
    f->stage = HTTP_FRAMING_CHUNK_SIZE;
    f->n_left = 0;
    f->n_line = f->n_digits = 0;
}

static void follow_header(http_framing *f, char c)
{
    switch (f->stage) {
    case HTTP_FRAMING_START:
        if (c != '\r' && c != '\n')
            f->stage = HTTP_FRAMING_REQUEST_LINE;
        break;
    case HTTP_FRAMING_REQUEST_LINE:
        if (c == '\n')
            f->stage = HTTP_FRAMING_NAME;
        break;
    case HTTP_FRAMING_NAME:
        if (c == ':')
            f->stage = HTTP_FRAMING_VALUE;
        else if (c == '\r' && f->n_name == 0)
            f->stage = HTTP_FRAMING_HEADER_LF;
        else if (c == '\n' || c == '\r')
            leave_to_guard(f);
        else
            append_byte(f->name, &f->n_name, c);
        break;
    case HTTP_FRAMING_VALUE_LF:
        if (c == '\n')
            end_field(f);
        else
            leave_to_guard(f);
        break;
    default: // HTTP_FRAMING_HEADER_LF
        if (c == '\n') {
            f->n_messages++;
            f->n_body = 0;
            f->n_left = f->n_lengths > 0 && !f->is_chunked ? f->length : 0;
            if (f->is_chunked)
                begin_chunk(f);
            else
                f->stage = f->n_left > 0 ? HTTP_FRAMING_BODY : HTTP_FRAMING_START;
            f->n_lengths = 0;
            f->is_chunked = false;
        } else {
            leave_to_guard(f);
        }
    }
}

size_t http_framing_release(http_framing *f, char *bytes, size_t n)
{
    const size_t n_released = f->n_held < n ? f->n_held : n;

    for (size_t i = 0; i < n_released; i++)
        append_byte(f->value, &f->n_value, bytes[i] = f->held[i]);
    f->n_held -= n_released;
    memmove(f->held, f->held + n_released, f->n_held);
    return n_released;
}

// Writes to `to` what the byte lets go on; returns how many bytes.
static size_t follow_value(http_framing *f, char c, char *to)
{
    const bool is_space = c == ' ' || c == '\t', is_end = c == '\r' || c == '\n';
    size_t n = 0;

    if (is_space && f->n_value == 0) {
        to[n++] = c;
        return n;
    }
    if (is_end)
        f->n_held = 0;
    else if (!is_space || f->n_held == HTTP_FRAMING_SPACE_MAX)
        n = http_framing_release(f, to, HTTP_FRAMING_SPACE_MAX);
    if (is_space) {
        f->held[f->n_held++] = c;
        return n;
    }
    to[n++] = c;
    if (!is_end)
        append_byte(f->value, &f->n_value, c);
    else if (c == '\r')
        f->stage = HTTP_FRAMING_VALUE_LF;
    else
        leave_to_guard(f);
    return n;
}

static void follow_size(http_framing *f, char c)
{
    if (isxdigit((unsigned char)c)) {
        f->n_left = 16 * f->n_left + (uint64_t)(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10);
        f->n_digits++;
        if (f->n_left > f->body_limit - f->n_body)
            refuse(f, 413, "the chunks are larger than the limit of a body");
    } else if (f->n_digits > 0 && (c == '\r' || c == ';')) {
        f->stage = c == ';' ? HTTP_FRAMING_CHUNK_EXTENSION : HTTP_FRAMING_CHUNK_LF;
    } else {
        refuse(f, 400, "a chunk's size is not hexadecimal digits");
    }
}

// A CR or LF at its one place.
static void expect(http_framing *f, char c, char wanted, http_framing_stage next)
{
    if (c == wanted)
        f->stage = next;
    else
        refuse(f, 400, "a line of a chunked body does not end in CR and LF");
}

static void follow_chunk(http_framing *f, char c)
{
    bool is_line = f->stage <= HTTP_FRAMING_CHUNK_LF;

    if (is_line && ++f->n_line > HTTP_CHUNK_LINE_MAX) {
        refuse(f, 400, "a chunk's size and extensions are too long");
        return;
    }
    switch (f->stage) {
    case HTTP_FRAMING_CHUNK_SIZE:
        follow_size(f, c);
        break;
    case HTTP_FRAMING_CHUNK_EXTENSION:
        if (c == '\r')
            f->stage = HTTP_FRAMING_CHUNK_LF;
        else if (http_framing_is_control(c))
            refuse(f, 400, "a chunk's extension has a control byte");
        break;
    case HTTP_FRAMING_CHUNK_LF:
        expect(f, c, '\n', HTTP_FRAMING_CHUNK_LF);
        if (f->refusal != 0)
            break;
        f->n_body += f->n_left;
        f->stage = f->n_left > 0 ? HTTP_FRAMING_CHUNK : HTTP_FRAMING_TRAILER_NAME;
        f->n_line = 0;
        f->n_name = 0;
        break;
    case HTTP_FRAMING_CHUNK_END_CR:
        expect(f, c, '\r', HTTP_FRAMING_CHUNK_END_LF);
        break;
    default: // HTTP_FRAMING_CHUNK_END_LF
        expect(f, c, '\n', HTTP_FRAMING_CHUNK_SIZE);
        if (f->refusal == 0)
            begin_chunk(f);
    }
}

static void follow_trailer(http_framing *f, char c)
{
    if (++f->n_line > HTTP_CHUNK_TRAILERS_MAX) {
        refuse(f, 400, "the trailers are too long");
        return;
    }
    switch (f->stage) {
    case HTTP_FRAMING_TRAILER_NAME:
        if (c == '\r' && f->n_name == 0)
            f->stage = HTTP_FRAMING_LAST_LF;
        else if (c == ':' && f->n_name > 0)
            f->stage = HTTP_FRAMING_TRAILER_VALUE;
        else if (http_framing_is_token(c))
            f->n_name++;
        else
            refuse(f, 400, "a trailer's name is not a token");
        break;
    case HTTP_FRAMING_TRAILER_VALUE:
        if (c == '\r')
            f->stage = HTTP_FRAMING_TRAILER_LF;
        else if (http_framing_is_control(c))
            refuse(f, 400, "a trailer's value has a control byte");
        break;
    case HTTP_FRAMING_TRAILER_LF:
        expect(f, c, '\n', HTTP_FRAMING_TRAILER_NAME);
        f->n_name = 0;
        break;
    default: // HTTP_FRAMING_LAST_LF
        expect(f, c, '\n', HTTP_FRAMING_START);
        f->n_name = 0;
    }
}

// The bytes of a body or chunk, or behind the end, as many as there are of n.
static size_t skip(http_framing *f, size_t n)
{
    if (f->stage == HTTP_FRAMING_ENDED)
        return n;
    size_t n_skipped = f->n_left < n ? (size_t)f->n_left : n;

    f->n_left -= n_skipped;
    if (f->n_left == 0)
        f->stage = f->stage == HTTP_FRAMING_BODY ? HTTP_FRAMING_START : HTTP_FRAMING_CHUNK_END_CR;
    return n_skipped;
}

size_t http_framing_follow(http_framing *f, char *bytes, size_t n)
{
    const char *from = bytes + f->n_held, *end = from + n;
    char *to = bytes;

    while (from < end) {
        if (f->stage == HTTP_FRAMING_BODY || f->stage == HTTP_FRAMING_CHUNK ||
            f->stage == HTTP_FRAMING_ENDED) {
            const size_t n_skipped = skip(f, (size_t)(end - from));
            if (to != from)
                memmove(to, from, n_skipped);
            from += n_skipped;
            to += n_skipped;
        } else if (f->stage == HTTP_FRAMING_VALUE) {
            to += follow_value(f, *from++, to);
        } else {
            *to++ = *from;
            const char c = *from++;
            if (f->stage <= HTTP_FRAMING_HEADER_LF)
                follow_header(f, c);
            else if (f->stage <= HTTP_FRAMING_CHUNK_END_LF)
                follow_chunk(f, c);
            else
                follow_trailer(f, c);
        }
    }
    return (size_t)(to - bytes);
}
