/// What holds for every function that appends to a buffer: without memory it leaves what was there.

#pragma once

#include "core/base/buffer.h"

/// A function under test with its arguments.
typedef bf_status appender(bf_buffer *out);

/// Fail the n-th allocation, for n = 1, 2, ... until there are no more: each time the function must say
/// so, and leave the bytes before as they were. Fails the test otherwise.
void appender_survives_no_memory(appender *append);
