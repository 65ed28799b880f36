#include "api/json/json_scan.h"

#include "api/json/json_pointer.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

// An array or object that is open.
typedef struct level {
    bool is_object;
    bool awaits_key;
    size_t index;    // array: of the present item
    const char *key; // object: of the present member, between its quotes; NULL: none yet
    size_t n_key;
} level;

typedef struct scanner {
    const char *json;
    size_t n;
    size_t at;
    size_t depth;
    level levels[JSON_NESTING_MAX];
} scanner;

static level *innermost(scanner *s)
{
    return s->depth > 0 ? &s->levels[s->depth - 1] : NULL;
}

static void scan_string(scanner *s)
{
    size_t from = ++s->at;

    while (s->at < s->n && s->json[s->at] != '"')
        s->at += s->json[s->at] == '\\' ? 2 : 1;
    if (s->at > s->n) // the text ends after a backslash
        s->at = s->n;
    level *l = innermost(s);
    if (l != NULL && l->is_object && l->awaits_key) {
        l->key = s->json + from;
        l->n_key = s->at - from;
        l->awaits_key = false;
    }
    if (s->at < s->n)
        s->at++;
}

static bool is_no_number(const char *word, size_t n)
{
    return (n == 3 && strncasecmp(word, "nan", n) == 0) ||
           (n == 3 && strncasecmp(word, "inf", n) == 0) ||
           (n == 8 && strncasecmp(word, "infinity", n) == 0);
}

static json_scan_end scan_word(scanner *s)
{
    size_t from = s->at;

    while (s->at < s->n && isalnum((unsigned char)s->json[s->at]))
        s->at++;
    if (!is_no_number(s->json + from, s->at - from))
        return JSON_SCAN_ALL;
    s->at = from;
    return JSON_SCAN_NO_NUMBER;
}

static json_scan_end scan_token(scanner *s)
{
    const char c = s->json[s->at];
    level *l = innermost(s);

    if (c == '"') {
        scan_string(s);
        return JSON_SCAN_ALL;
    }
    if (isalpha((unsigned char)c))
        return scan_word(s);
    if (c == '{' || c == '[') {
        if (s->depth == JSON_NESTING_MAX)
            return JSON_SCAN_TOO_DEEP;
        s->levels[s->depth++] = (level){ .is_object = c == '{', .awaits_key = c == '{' };
    } else if (c == ',' && l != NULL) {
        l->awaits_key = l->is_object;
        l->index++;
    } else if ((c == '}' || c == ']') && s->depth > 0) {
        s->depth--;
    }
    s->at++;
    return JSON_SCAN_ALL;
}

json_scan_end json_scan(const char *json, size_t n, json_scan_place *ret_place, char *ret_pointer,
                        size_t size)
{
    scanner s = { .json = json, .n = n };
    json_pointer pointer = { 0 };
    json_scan_end end = JSON_SCAN_ALL;

    while (end == JSON_SCAN_ALL && s.at < n)
        end = scan_token(&s);
    for (size_t k = 0; k < s.depth; k++) {
        const level *l = &s.levels[k];
        if (!l->is_object)
            json_pointer_enter_index(&pointer, l->index);
        else if (l->key != NULL)
            json_pointer_enter(&pointer, l->key, l->n_key);
    }
    json_scan_place place = { .at = s.at, .line = 1, .column = 1 };
    for (size_t k = 0; k < s.at; k++) {
        bool is_end = json[k] == '\n';
        place.line += is_end;
        place.column = is_end ? 1 : place.column + 1;
    }
    *ret_place = place;
    snprintf(ret_pointer, size, "%s", pointer.text);
    return end;
}
