/// The Prefer header (RFC 7240): of its preferences, `wait`.

#pragma once

#include <stdbool.h>

/// The seconds of `wait=N`; true if it is there and can be read. The first one counts, more than
/// UINT_MAX is UINT_MAX, unknown preferences are ignored. header may be NULL.
bool prefer_wait(const char *header, unsigned *ret_seconds);
