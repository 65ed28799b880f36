#include "api/json/text.h"

#include <stdint.h>
#include <string.h>

size_t text_utf8_size(const char *character)
{
    const unsigned char *text = (const unsigned char *)character;
    static const struct {
        unsigned char from, to;          // of the first byte
        unsigned char second, second_to; // of the second byte
        size_t n;                        // bytes
    } forms[] = {
        { 0x01, 0x7f, 0, 0, 1 },       { 0xc2, 0xdf, 0x80, 0xbf, 2 }, { 0xe0, 0xe0, 0xa0, 0xbf, 3 },
        { 0xe1, 0xec, 0x80, 0xbf, 3 }, { 0xed, 0xed, 0x80, 0x9f, 3 }, { 0xee, 0xef, 0x80, 0xbf, 3 },
        { 0xf0, 0xf0, 0x90, 0xbf, 4 }, { 0xf1, 0xf3, 0x80, 0xbf, 4 }, { 0xf4, 0xf4, 0x80, 0x8f, 4 },
    };
    for (size_t k = 0; k < sizeof forms / sizeof *forms; k++) {
        if (text[0] < forms[k].from || text[0] > forms[k].to)
            continue;
        size_t n = forms[k].n;
        if (n > 1 && (text[1] < forms[k].second || text[1] > forms[k].second_to))
            return 0;
        for (size_t i = 2; i < n; i++) {
            if ((text[i] & 0xc0) != 0x80)
                return 0;
        }
        return n;
    }
    return 0;
}

bool text_is_utf8(const char *text)
{
    size_t n = 0;

    while ((n = text_utf8_size(text)) > 0)
        text += n;
    return *text == '\0';
}

text_piece text_take_until(text_piece *rest, char separator)
{
    const char *end = memchr(rest->at, separator, rest->n);
    const text_piece taken = { rest->at, end == NULL ? rest->n : (size_t)(end - rest->at) };
    const size_t n_used = taken.n + (end != NULL);

    *rest = (text_piece){ rest->at + n_used, rest->n - n_used };
    return taken;
}

size_t text_count_pieces(text_piece piece, char separator)
{
    size_t n = 1;

    for (size_t k = 0; k < piece.n; k++)
        n += piece.at[k] == separator;
    return n;
}

bool text_is(text_piece piece, const char *text)
{
    return piece.n == strlen(text) && memcmp(piece.at, text, piece.n) == 0;
}

size_t text_find_word(const char *const *words, size_t n, const char *word)
{
    size_t i = 0;

    while (i < n && words[i] != NULL && strcmp(words[i], word) != 0)
        i++;
    return i;
}

bool text_has_word(const char *const *words, const char *word)
{
    return words[text_find_word(words, SIZE_MAX, word)] != NULL;
}

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

size_t text_distance(const char *a, const char *b)
{
    size_t row[TEXT_LENGTH_MAX + 1]; // distances of a's first bytes to b's first k
    size_t n_a = strlen(a);
    size_t n_b = strlen(b);

    if (n_a > TEXT_LENGTH_MAX || n_b > TEXT_LENGTH_MAX)
        return SIZE_MAX;
    for (size_t k = 0; k <= n_b; k++)
        row[k] = k;
    for (size_t i = 0; i < n_a; i++) {
        size_t diagonal = row[0]++;
        for (size_t k = 0; k < n_b; k++) {
            size_t replaced = diagonal + (a[i] != b[k]);
            diagonal = row[k + 1];
            row[k + 1] = smaller(replaced, 1 + smaller(row[k], diagonal));
        }
    }
    return row[n_b];
}

bool text_is_near(const char *known, size_t distance)
{
    return distance <= strlen(known) / 2;
}
