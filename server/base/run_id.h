/// Ids of runs: UUIDs of version 7 (RFC 9562), lower case, which sort by the time of creation.
///
///     48 bits  Unix time, ms
///      4       version, 7
///     12       a counter that starts at random in each millisecond
///      2       variant, binary 10
///     62       random
///
/// Within a process each id is greater than the one before, also within one millisecond and when
/// the clock is set back.
///
/// Threads  may be called from any thread.

#pragma once

#include "api/services.h"
#include "core/base/status.h"

/// Write a new id and its terminator to ret_id (API_ID_SIZE bytes). BF_ESYSTEM: the system gives no
/// random bytes.
BF_MUST_CHECK bf_status run_id_make(char *ret_id, bf_error *err);
