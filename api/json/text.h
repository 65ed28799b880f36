/// Text as it may come from clients: checks of UTF-8, pieces of lines, words of a list, and the distance of names, to suggest
/// the one that was meant.

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// Bytes of the UTF-8 character, or 0 if it is none (overlong, surrogate, torn or stray) or
/// the end.
size_t text_utf8_size(const char *character);

/// True if all of text is UTF-8.
bool text_is_utf8(const char *text);

/// A piece of a text, not terminated.
typedef struct text_piece {
    const char *at; ///< its first byte
    size_t n;       ///< bytes
} text_piece;

/// Take what stands before the separator off the rest; without one, all of it.
text_piece text_take_until(text_piece *rest, char separator);

/// How many pieces the separator makes of a piece.
size_t text_count_pieces(text_piece piece, char separator);

/// True if the piece is this text.
bool text_is(text_piece piece, const char *text);

/// The index of a word in a list of n, which may end before with NULL; else that of the list's end.
size_t text_find_word(const char *const *words, size_t n, const char *word);

/// True if a list that ends with NULL has the word.
bool text_has_word(const char *const *words, const char *word);

enum { TEXT_LENGTH_MAX = 64 }; ///< bytes of a name; longer ones are like nothing

/// Fewest insertions, deletions and replacements of bytes that turn a into b (Levenshtein);
/// SIZE_MAX if one is longer than TEXT_LENGTH_MAX.
size_t text_distance(const char *a, const char *b);

/// True if a name at that edit distance may be a misspelling of `known`.
bool text_is_near(const char *known, size_t distance);
