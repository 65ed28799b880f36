/// Cross-origin requests (the Fetch standard): which pages elsewhere may read the answers. None,
/// unless configured. Credentials are never allowed: there are none.

#pragma once

#include "api/http/exchange.h"
#include "core/base/status.h"

/// BF_EINPUT unless origins is empty, `*`, or a list of origins such as `https://plan.example:8443`,
/// separated by spaces or commas.
BF_MUST_CHECK bf_status http_cors_check(const char *origins, bf_error *err);

/// Add to a response what a page needs to read it. origins as checked; origin and asked_method are the
/// request's Origin and Access-Control-Request-Method (NULL: not there). An answer to OPTIONS that
/// has Allow becomes that of a preflight.
void http_cors_answer(const char *origins, const char *method, const char *origin,
                      const char *asked_method, api_response *response);
