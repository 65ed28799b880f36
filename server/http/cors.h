/// Cross-origin requests (the Fetch standard): which pages elsewhere may read the answers. None,
/// unless configured. Credentials are never allowed: there are none.

#pragma once

#include "api/http/exchange.h"
#include "core/base/status.h"

#include <stdbool.h>

/// BF_EINPUT unless origins is empty, `*`, or a list of origins such as `https://plan.example:8443`,
/// separated by spaces or commas.
BF_MUST_CHECK bf_status http_cors_check(const char *origins, bf_error *err);

/// True if a browser says that a page of another site, which is not one of origins, sent a request that may
/// change something (Fetch Metadata; fetch_site: Sec-Fetch-Site, NULL if not there). Such a page cannot read
/// the answer, but what it asked for would be done.
bool http_cors_is_forged(const char *origins, const char *method, const char *origin,
                         const char *fetch_site);

/// The Cross-Origin-Resource-Policy of every answer: who may embed it without asking. Static.
const char *http_cors_resource_policy(const char *origins);

/// Add to a response what a page needs to read it. origins as checked; origin and asked_method are the
/// request's Origin and Access-Control-Request-Method (NULL: not there). An answer to OPTIONS that
/// has Allow becomes that of a preflight.
void http_cors_answer(const char *origins, const char *method, const char *origin,
                      const char *asked_method, api_response *response);
