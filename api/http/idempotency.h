/// The header Idempotency-Key (draft-ietf-httpapi-idempotency-key-header).

#pragma once

#include "api/services.h"
#include "core/base/status.h"

/// Read a header's value, "" and NULL meaning none: a string as structured fields write it
/// (RFC 8941: in quotes, \" and \\ inside), or, as most clients send it, the bare key, of visible
/// ASCII without quotes, commas, semicolons and backslashes. Both forms of a key are the same key.
/// BF_EINPUT: neither, or none or more than API_KEY_SIZE - 1 bytes.
BF_MUST_CHECK bf_status idempotency_read_key(const char *header, char ret_key[API_KEY_SIZE],
                                             bf_error *err);
