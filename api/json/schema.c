#include "api/json/schema.h"

#include "core/base/check.h"

#include <ctype.h>
#include <string.h>

// Bytes of the type at text without what makes it nullable.
static size_t measure_base(const char *text)
{
    size_t n = 0;
    size_t depth = 0;

    do {
        depth += text[n] == '[';
        depth -= text[n] == ']';
        n++;
    } while (text[n] != '\0' && (depth > 0 || strchr(" ?]", text[n]) == NULL));
    BF_CHECK(depth == 0);
    return n;
}

// Writes a word of n bytes as a string.
static void write_word(json_out *w, const char *word, size_t n)
{
    char text[64];

    BF_CHECK(n < sizeof text);
    memcpy(text, word, n);
    text[n] = '\0';
    json_out_string(w, text);
}

void schema_write_words(json_out *w, const char *words)
{
    json_out_array(w);
    for (size_t n; (n = schema_next_word(&words)) > 0; words += n)
        write_word(w, words, n);
    json_out_array_end(w);
}

void schema_write_ref(json_out *w, const char *kind, const char *name, size_t n)
{
    char text[96] = "#/components/";

    BF_CHECK(strlen(text) + strlen(kind) + n + 2 <= sizeof text);
    strcat(text, kind);
    strcat(text, "/");
    strncat(text, name, n);
    json_out_key_string(w, "$ref", text);
}

// "[T 1-32]": items T, at least 1, at most 32.
static void write_list(json_out *w, const char *item)
{
    const char *at = item + measure_base(item);

    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    schema_write_members(w, item);
    json_out_object_end(w);
    at += *at == '?';
    if (*at != ' ')
        return;
    size_t n = strspn(++at, "0123456789");
    json_out_key(w, "minItems");
    json_out_raw(w, at, n);
    if (at[n] == '-') {
        at += n + 1;
        n = strspn(at, "0123456789");
    }
    json_out_key(w, "maxItems");
    json_out_raw(w, at, n);
}

static void write_base(json_out *w, const char *type, size_t n)
{
    if (*type == '#') {
        schema_write_ref(w, "schemas", type + 1, n - 1);
    } else if (*type == '[') {
        write_list(w, type + 1);
    } else if (*type == '=') {
        json_out_key_string(w, "type", "string");
        json_out_key(w, "const");
        write_word(w, type + 1, n - 1);
    } else {
        BF_CHECK(islower((unsigned char)*type));
        json_out_key(w, "type");
        write_word(w, type, n);
    }
}

void schema_write_members(json_out *w, const char *type)
{
    size_t n = measure_base(type);

    if (type[n] != '?') {
        write_base(w, type, n);
    } else if (islower((unsigned char)*type)) {
        json_out_key(w, "type");
        json_out_array(w);
        write_word(w, type, n);
        json_out_string(w, "null");
        json_out_array_end(w);
    } else {
        json_out_key(w, "anyOf");
        json_out_array(w);
        json_out_object(w);
        write_base(w, type, n);
        json_out_object_end(w);
        json_out_object(w);
        json_out_key_string(w, "type", "null");
        json_out_object_end(w);
        json_out_array_end(w);
    }
}

void schema_write_limits(json_out *w, const char *limits)
{
    if (limits == NULL)
        return;
    json_out_raw(w, limits, strlen(limits));
}

void schema_write(json_out *w, const char *type, const char *limits, const char *help)
{
    json_out_object(w);
    schema_write_members(w, type);
    schema_write_limits(w, limits);
    if (help != NULL)
        json_out_key_string(w, "description", help);
    json_out_object_end(w);
}

size_t schema_next_word(const char **words)
{
    *words += strspn(*words, " ");
    return strcspn(*words, " ");
}
