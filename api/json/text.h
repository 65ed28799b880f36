/// Text as it may come from clients: checks of UTF-8, and the distance of names, to suggest the one that
/// was meant.

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// Bytes of the UTF-8 character, or 0 if it is none (overlong, surrogate, torn or stray) or
/// the end.
size_t text_utf8_size(const char *character);

/// True if all of text is UTF-8.
bool text_is_utf8(const char *text);

enum { TEXT_LENGTH_MAX = 64 }; ///< bytes of a name; longer ones are like nothing

/// Fewest insertions, deletions and replacements of bytes that turn a into b (Levenshtein);
/// SIZE_MAX if one is longer than TEXT_LENGTH_MAX.
size_t text_distance(const char *a, const char *b);

/// True if a name at that edit distance may be a misspelling of `known`.
bool text_is_near(const char *known, size_t distance);
