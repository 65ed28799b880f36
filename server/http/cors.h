/// Cross-origin requests (the Fetch standard): which pages elsewhere may read the answers. None,
/// unless configured. Credentials are never allowed: there are none.

#pragma once

#include "api/http/exchange.h"
#include "core/base/status.h"

#include <stdbool.h>

/// BF_EINPUT unless origins is empty, `*`, or a list of origins such as `https://plan.example:8443`,
/// separated by spaces or commas.
BF_MUST_CHECK bf_status http_cors_check(const char *origins, bf_error *err);

/// What a request says of who made a browser send it. NULL: the header is not there.
typedef struct http_cors_sender {
    const char *method;     ///< of the request
    const char *origin;     ///< Origin
    const char *fetch_site; ///< Sec-Fetch-Site
    const char *host;       ///< Host: where it was sent to
} http_cors_sender;

/// True if a page that is neither our own nor one of origins made a browser send a request that may change something.
/// Such a page cannot read the answer, but what it asked for would be done. A browser with Fetch Metadata says whose page
/// it is; a page of another port of our host (same-site) is not our own. Of others Origin is compared with Host. No browser
/// leaves out both headers when another page sends such a request.
bool http_cors_is_forged(const char *origins, const http_cors_sender *sender);

/// The Cross-Origin-Resource-Policy of every answer: who may embed it without asking. Static.
const char *http_cors_resource_policy(const char *origins);

/// Add to a response what a page needs to read it. origins as checked; origin and asked_method are the
/// request's Origin and Access-Control-Request-Method (NULL: not there). An answer to OPTIONS that
/// has Allow becomes that of a preflight.
void http_cors_answer(const char *origins, const char *method, const char *origin,
                      const char *asked_method, api_response *response);
