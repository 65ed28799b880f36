/// Whether a request may go on: the one place that decides, from the scope of the route and the token that came
/// with the request.
///
/// A token comes in `Authorization: Bearer` alone (RFC 6750, 2.1), never in the URL, where logs and histories keep it.

#pragma once

#include "api/access.h"
#include "api/http/routes.h"
#include "core/base/status.h"

/// The HTTP status of the refusal: 401 without a valid token, 403 with one that lacks the route's scope; 0: go on.
int access_decide(const route *r, api_credential credential, unsigned scopes);

/// Identify who sent the request (exchange.who) and decide. BF_EINPUT as a 401 or 403.
BF_MUST_CHECK bf_status access_check(exchange *x, bf_error *err);

/// Add what a refusal with this status has to say of tokens: WWW-Authenticate (RFC 6750, 3). Does nothing for
/// other refusals.
void access_challenge(exchange *x, int status);
