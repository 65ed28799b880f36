/// Documents for tests: JSON that is written with ' for ".

#pragma once

#include "core/base/buffer.h"
#include "core/base/faults.h"

#include <stdbool.h>

/// The members that a scenario needs, and a document with further ones.
#define DOCUMENT_NEEDED                                                                            \
    "'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': {}, "                   \
    "'initial': {'positions_m': [[0.5, 0.3]]}"
#define DOCUMENT_WITH(members) "{" DOCUMENT_NEEDED ", " members "}"

/// The text with every ' replaced by ". The caller frees the buffer.
bf_buffer document_quote(const char *text);

/// The resolved document of a scenario, of which every ' is a ". The caller frees the buffer.
bf_buffer document_resolve(const char *text);

/// A scenario that has every member there is, of one kind or the other. The caller frees the buffer.
bf_buffer document_complete(void);

/// One that has every member of feeds, of what moves, of photo eyes and actions. The caller frees the buffer.
bf_buffer document_fed(void);

/// Read a scenario that must be refused, with the scene that was handed over untouched. Returns the
/// status; *faults and *err are as scenario_read() leaves them.
bf_status document_refuse(const char *json, size_t n, bf_faults *faults, bf_error *err);

/// True if a fault at the pointer was recorded.
bool document_has_fault(const bf_faults *faults, const char *pointer);
