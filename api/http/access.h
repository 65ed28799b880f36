/// Whether a request may go on, and what it may see: the one place that decides, from the scope of the route, the token
/// that came with the request and the owners of runs, studies and measurements.
///
/// A token comes in `Authorization: Bearer` alone (RFC 6750, 2.1), never in the URL, where logs and histories keep it.
/// For what a browser fetches by itself (EventSource, downloads, images) a ticket stands for it: `?ticket=` of a GET or
/// HEAD without that header. It is taken out of the query, so that nothing behind this place can write it anywhere.

#pragma once

#include "api/access.h"
#include "api/http/routes.h"
#include "core/base/status.h"

/// The HTTP status of the refusal: 401 without a valid token, 403 with one that lacks the route's scope; 0: go on. A granted
/// token may use what reads runs and studies one at a time; which one it is access_find_run() and _study() decide.
int access_decide(const route *r, api_credential credential, unsigned scopes);

/// True if a ticket may stand for the token: the route reads, and needs a token.
bool access_takes_ticket(const route *r);

/// Identify who sent the request (exchange.who) and decide. BF_EINPUT as a 401 or 403.
BF_MUST_CHECK bf_status access_check(exchange *x, bf_error *err);

/// Refuse a priority above 0 to a token without the scope for it, as a 403 at /priority: it would overtake others.
BF_MUST_CHECK bf_status access_check_priority(exchange *x, int priority, bf_error *err);

/// What a list that the sender asks for is narrowed to: the sender's name; "": everybody's.
const char *access_list_owner(const exchange *x);

/// The same into ret_owner (API_OWNER_SIZE bytes), or whom the parameter `owner` names. BF_EINPUT as a 403: somebody whose lists
/// the sender does not see.
BF_MUST_CHECK bf_status access_list_owner_asked(exchange *x, char *ret_owner, bf_error *err);

/// Find a run, a study or a measurement that the sender may see: without tokens all, with the scope admin all, with a granted
/// token its run, or its study with the runs of that, else those of the same owner. BF_ENOTFOUND: there is none of this id, or it is somebody else's, which looks the same.
BF_MUST_CHECK bf_status access_find_run(const exchange *x, const char *id, api_run *ret_run,
                                        bf_error *err);
BF_MUST_CHECK bf_status access_find_study(const exchange *x, const char *id, api_study *ret_study,
                                          bf_error *err);
BF_MUST_CHECK bf_status access_find_measurement(const exchange *x, const char *id,
                                                api_measurement *ret_measurement, bf_error *err);

/// Add what a refusal with this status has to say of tokens: WWW-Authenticate (RFC 6750, 3). Does nothing for
/// other refusals.
void access_challenge(exchange *x, int status);
