/// The API described by itself: the OpenAPI 3.1 document, made from the tables that the code goes
/// by (routes, formats, members of the scenario, states, events, problems) and from those of
/// openapi_*.c, which say of each what only a document needs. README of api says how to add to it.

#pragma once

#include "core/base/buffer.h"

/// Append the document as JSON, laid out for people, to *out. Always the same bytes: those of
/// api/openapi.json. BF_ENOMEM: *out is as before.
BF_MUST_CHECK bf_status openapi_write(bf_buffer *out, bf_error *err);
