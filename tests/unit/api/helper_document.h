/// Documents for tests: JSON that is written with ' for ".

#pragma once

#include "core/base/buffer.h"

/// The members that a scenario needs, and a document with further ones.
#define DOCUMENT_NEEDED                                                                            \
    "'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': {}, "                   \
    "'initial': {'positions_m': [[0.5, 0.3]]}"
#define DOCUMENT_WITH(members) "{" DOCUMENT_NEEDED ", " members "}"

/// The text with every ' replaced by ". The caller frees the buffer.
bf_buffer document_quote(const char *text);

/// A scenario that has every member there is, of one kind or the other. The caller frees the buffer.
bf_buffer document_complete(void);
