/// UTF-8 as it may come from clients, which need not send any.

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// Bytes of the UTF-8 character, or 0 if it is none (overlong, surrogate, torn or stray) or
/// the end.
size_t utf8_size(const char *character);

/// True if all of text is UTF-8.
bool utf8_is_text(const char *text);
