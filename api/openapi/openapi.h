/// The OpenAPI 3.1 document of the API, generated from the tables that the code uses
/// (routes, formats, members of the scenario, states, events, problems) and from those of
/// openapi_*.c, which add what only the document needs. api/README.md describes how to extend it.

#pragma once

#include "core/base/buffer.h"

/// Append the document as JSON, laid out for people, to *out. Always the same bytes: those of
/// api/openapi.json. BF_ENOMEM: *out is as before.
BF_MUST_CHECK bf_status openapi_write(bf_buffer *out, bf_error *err);
