#include "core/base/buffer.h"

#include "core/base/check.h"
#include "core/base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

char *buffer_reserve(bf_buffer *b, size_t n)
{
    size_t needed;

    if (__builtin_add_overflow(b->n, n, &needed) || __builtin_add_overflow(needed, 1, &needed) ||
        memory_reserve(&b->bytes, &b->capacity, needed, 1) != 0)
        return NULL;
    return b->bytes + b->n;
}

bf_status buffer_append(bf_buffer *b, const void *bytes, size_t n)
{
    char *end = buffer_reserve(b, n);
    if (end == NULL)
        return BF_ENOMEM;
    if (n > 0)
        memcpy(end, bytes, n);
    end[n] = '\0';
    b->n += n;
    return BF_OK;
}

bf_status buffer_printf(bf_buffer *b, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    int n = vsnprintf(NULL, 0, format, args);
    va_end(args);
    BF_CHECK(n >= 0);
    char *end = buffer_reserve(b, (size_t)n);
    if (end == NULL)
        return BF_ENOMEM;
    va_start(args, format);
    vsnprintf(end, (size_t)n + 1, format, args);
    va_end(args);
    b->n += (size_t)n;
    return BF_OK;
}

void buffer_drop(bf_buffer *b, size_t n)
{
    BF_CHECK(n <= b->n);
    if (n == 0)
        return;
    memmove(b->bytes, b->bytes + n, b->n - n + 1);
    b->n -= n;
}

void buffer_truncate(bf_buffer *b, size_t n)
{
    BF_CHECK(n <= b->n);
    b->n = n;
    if (b->bytes != NULL)
        b->bytes[n] = '\0';
}

void buffer_fini(bf_buffer *b)
{
    if (b == NULL)
        return;
    memory_free(b->bytes);
    *b = (bf_buffer){ 0 };
}
