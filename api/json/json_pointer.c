#include "api/json/json_pointer.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static bool put(json_pointer *p, const char *bytes, size_t n)
{
    if (p->n + n >= sizeof p->text)
        return false;
    memcpy(p->text + p->n, bytes, n);
    p->n += n;
    p->text[p->n] = '\0';
    return true;
}

static bool is_continuation(char c)
{
    return ((unsigned char)c & 0xc0) == 0x80;
}

// Bytes from the one at `name` to the end of its character.
static size_t measure_character(const char *name, size_t n)
{
    size_t length = 1;

    while (length < n && length < 4 && is_continuation(name[length]))
        length++;
    return length;
}

static bool put_character(json_pointer *p, const char *character, size_t n)
{
    unsigned char c = (unsigned char)*character;

    if (c == '~')
        return put(p, "~0", 2);
    if (c == '/')
        return put(p, "~1", 2);
    if (c < 0x20 || c == 0x7f)
        return put(p, "?", 1);
    return put(p, character, n);
}

size_t json_pointer_enter(json_pointer *p, const char *name, size_t n)
{
    size_t mark = p->n;
    bool fits = put(p, "/", 1);

    for (size_t at = 0; at < n && fits;) {
        size_t length = measure_character(name + at, n - at);
        fits = put_character(p, name + at, length);
        at += length;
    }
    return mark;
}

size_t json_pointer_enter_index(json_pointer *p, size_t index)
{
    char text[24];

    return json_pointer_enter(p, text, (size_t)snprintf(text, sizeof text, "%zu", index));
}

void json_pointer_leave(json_pointer *p, size_t mark)
{
    p->n = mark;
    p->text[mark] = '\0';
}
