#include "api/json/json_pointer.h"

#include <jansson.h>
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
        size_t length = 1; // bytes to the end of the character
        while (at + length < n && length < 4 && (name[at + length] & 0xc0) == 0x80)
            length++;
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

// One token of a pointer, from behind its '/', without escapes. Returns what follows; NULL: it is too long.
static const char *next_token(const char *at, char *ret_token, size_t size)
{
    size_t n = 0;

    for (; *at != '\0' && *at != '/'; at++) {
        char c = *at;
        if (c == '~' && (at[1] == '0' || at[1] == '1'))
            c = *++at == '0' ? '~' : '/';
        if (n + 1 >= size)
            return NULL;
        ret_token[n++] = c;
    }
    ret_token[n] = '\0';
    return at;
}

static json_t *item_at(json_t *array, const char *token)
{
    size_t index = 0;

    if (*token == '\0' || (token[0] == '0' && token[1] != '\0') || strlen(token) > 9)
        return NULL;
    for (; *token >= '0' && *token <= '9'; token++)
        index = 10 * index + (size_t)(*token - '0');
    return *token == '\0' ? json_array_get(array, index) : NULL;
}

json_t *json_pointer_find(json_t *root, const char *pointer)
{
    char token[BF_POINTER_SIZE];
    json_t *value = root;

    for (const char *at = pointer; value != NULL && *at != '\0';) {
        if (*at != '/' || (at = next_token(at + 1, token, sizeof token)) == NULL)
            return NULL;
        value = json_is_array(value) ? item_at(value, token) : json_object_get(value, token);
    }
    return value;
}
