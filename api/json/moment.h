/// Moments in UTC as text (RFC 3339): "2026-11-24T09:00:00.000Z".

#pragma once

#include <stdbool.h>
#include <stdint.h>

enum { MOMENT_SIZE = 80 }; ///< bytes that hold any moment, written or read, with its terminator

/// Write a Unix time, ms. False: it is not after 1970-01-01T00:00:00Z, or no year has it (ret_text untouched).
bool moment_write(int64_t unix_ms, char ret_text[MOMENT_SIZE]);

/// Read a moment as moment_write() writes it, with up to nine digits of a second's fraction, of which three count, or none. False: it is
/// anything else, or before 1970 (*ret_unix_ms untouched).
bool moment_read(const char *text, int64_t *ret_unix_ms);
