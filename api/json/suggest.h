/// How far two names are apart, to suggest the one that was meant.

#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { SUGGEST_LENGTH_MAX = 64 }; ///< bytes of a name; longer ones are like nothing

/// Fewest insertions, deletions and replacements of bytes that turn a into b (Levenshtein);
/// SIZE_MAX if one is longer than SUGGEST_LENGTH_MAX.
size_t suggest_distance(const char *a, const char *b);

/// True if someone who wrote a name at that distance may have meant `known`.
bool suggest_is_near(const char *known, size_t distance);
