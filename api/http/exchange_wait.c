// Answers that wait for a run. The first answer says what it waits for; the transport asks now and
// then whether that is over, and lets the request be answered again when it is.

#include "api/http/exchange_priv.h"
#include "api/http/prefer.h"

#include <inttypes.h>
#include <string.h>

void exchange__wait(exchange *x, const api_run *record, unsigned seconds, bool is_for_change)
{
    api_wait *wait = &x->response->wait;

    if (x->request->waited != NULL || seconds == 0 || run_state_is_end(record->state))
        return;
    *wait = (api_wait){ .seconds = seconds < API_WAIT_MAX_S ? seconds : API_WAIT_MAX_S,
                        .is_for_change = is_for_change,
                        .revision = record->revision };
    memcpy(wait->run, record->id, sizeof wait->run);
}

void exchange__prefer_wait(exchange *x, const api_run *record)
{
    unsigned seconds = 0;

    if (!prefer_wait(exchange__header(x, "Prefer"), &seconds))
        return;
    api_response_header(x->response, "Preference-Applied", "wait=%u",
                        seconds < API_WAIT_MAX_S ? seconds : API_WAIT_MAX_S);
    exchange__wait(x, record, seconds, false);
}

bool api_wait_is_over(const api_services *services, const api_wait *wait)
{
    api_run record;

    if (services->find(services->context, wait->run, &record, NULL) != BF_OK)
        return true;
    return run_state_is_end(record.state) ||
           (wait->is_for_change && record.revision != wait->revision);
}

void api_handle_again(const api_services *services, const api_request *request,
                      api_response *response)
{
    const api_wait waited = response->wait;
    api_request again = *request;
    api_response late;

    again.waited = &waited;
    response->wait.seconds = 0;
    api_handle(services, &again, &late);
    // What was promised stays: a run that was accepted, and is gone or cannot be read now.
    bool is_worse = response->status == 201 && late.status != 201;
    api_response *unused = is_worse ? &late : response;
    api_response_fini(unused);
    if (!is_worse)
        *response = late;
}
