/// JSON pointers (RFC 6901): those that grow and shrink while a document is walked, and what one leads to.

#pragma once

#include "core/base/status.h"

#include <stddef.h>

/// A pointer as text; too long a one is cut. Zero is the whole document.
typedef struct json_pointer {
    size_t n;                   ///< bytes in use
    char text[BF_POINTER_SIZE]; ///< always terminated
} json_pointer;

/// Append "/" and a name of n bytes, escaped; control characters become "?". Returns what
/// json_pointer_leave() needs to take it away again.
size_t json_pointer_enter(json_pointer *p, const char *name, size_t n);

/// Append "/" and an index.
size_t json_pointer_enter_index(json_pointer *p, size_t index);

/// Go back to the place before the json_pointer_enter...() that returned mark.
void json_pointer_leave(json_pointer *p, size_t mark);

struct json_t;

/// The value in a document that a pointer leads to, borrowed; NULL: none, or a name has BF_POINTER_SIZE bytes or more.
struct json_t *json_pointer_find(struct json_t *root, const char *pointer);
