// What handlers read of a request.

#include "api/http/http_priv.h"
#include "api/http/precondition.h"
#include "api/http/prefer.h"
#include "core/base/check.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

bf_status exchange__find_run(const exchange *x, api_run *ret_run, bf_error *err)
{
    const char *id = x->params.values[0];

    BF_CHECK(x->params.n > 0);
    if (!param_is_id(id))
        return bf_fail(err, BF_ENOTFOUND, "", "there is no run '%s'", id);
    return x->services->find(x->services->context, id, ret_run, err);
}

const char *exchange__text(const exchange *x, const char *name)
{
    return query_value(&x->query, name);
}

uint64_t exchange__whole(const exchange *x, const char *name)
{
    param_value value = { .whole = 0 };

    (void)query_read(&x->query, x->route->params, name, &value);
    return value.whole;
}

double exchange__real(const exchange *x, const char *name)
{
    param_value value = { .real = 0.0 };

    BF_CHECK(query_read(&x->query, x->route->params, name, &value));
    return value.real;
}

size_t exchange__ids(const exchange *x, const char *name, char (*ret_ids)[API_ID_SIZE])
{
    param_value value;

    if (!query_read(&x->query, x->route->params, name, &value))
        return 0;
    memcpy(ret_ids, value.ids.items, value.ids.n * sizeof *ret_ids);
    return value.ids.n;
}

bf_status exchange__find_snapshot(const exchange *x, const api_run *of, uint64_t *ret_index,
                                  bf_error *err)
{
    const char *number = x->params.values[1];
    uint64_t index = 0;

    BF_CHECK(x->params.n > 1);
    if (param_read_digits(number, &index) != 0 || index >= of->n_snapshots)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no snapshot '%s'; it has %" PRIu64,
                       number, of->n_snapshots);
    *ret_index = index;
    return BF_OK;
}

bf_status exchange__check_match(exchange *x, const api_run *record, uint64_t *ret_revision,
                                bf_error *err)
{
    const char *wanted = exchange__header(x, "If-Match");
    char tag[EXCHANGE_ETAG_SIZE];

    snprintf(tag, sizeof tag, "r%" PRIu64, record->revision);
    if (wanted == NULL || precondition_holds(wanted, tag)) {
        *ret_revision = wanted == NULL ? API_ANY_REVISION : record->revision;
        return BF_OK;
    }
    return exchange__refuse(x, 412, "", err,
                            "the run is not in the state that If-Match names: it is \"%s\"", tag);
}

static void list_types(exchange *x, const char *const *types)
{
    size_t n = 0;

    for (size_t i = 0; types[i] != NULL && n < sizeof x->accepts; i++)
        n += (size_t)snprintf(x->accepts + n, sizeof x->accepts - n, "%s%s", i == 0 ? "" : ", ",
                              types[i]);
}

bf_status exchange__check_body(exchange *x, const char *const *types, size_t *ret_type,
                               bf_error *err)
{
    const char *type = exchange__header(x, "Content-Type");
    const char *encoding = exchange__header(x, "Content-Encoding");
    size_t found = 0;

    list_types(x, types);
    if (type == NULL)
        return exchange__refuse(x, 415, "", err, "the body needs Content-Type: %s", x->accepts);
    size_t n = strcspn(type, "; \t");
    while (types[found] != NULL &&
           (strlen(types[found]) != n || strncasecmp(type, types[found], n) != 0))
        found++;
    if (types[found] == NULL)
        return exchange__refuse(x, 415, "", err, "the body must be %s, not '%.64s'", x->accepts,
                                type);
    if (encoding != NULL && strcasecmp(encoding, "identity") != 0)
        return exchange__refuse(x, 415, "", err, "the body must not be encoded ('%.32s')",
                                encoding);
    *ret_type = found;
    return BF_OK;
}

exchange_page exchange__page(const exchange *x)
{
    const char *label = exchange__text(x, "label");
    const char *cursor = exchange__text(x, "cursor");
    exchange_page page = { .limit = (size_t)exchange__whole(x, "limit") };

    snprintf(page.label, sizeof page.label, "%s", label == NULL ? "" : label);
    snprintf(page.before, sizeof page.before, "%s", cursor == NULL ? "" : cursor);
    return page;
}

void exchange__long_poll(exchange *x, const api_run *record, unsigned seconds, bool is_for_change)
{
    api_long_poll *wait = &x->response->long_poll;

    if (x->request->polled != NULL || seconds == 0 || run_state_is_end(record->state))
        return;
    *wait = (api_long_poll){ .seconds = seconds < API_WAIT_MAX_S ? seconds : API_WAIT_MAX_S,
                             .is_for_change = is_for_change,
                             .revision = record->revision };
    memcpy(wait->run, record->id, sizeof wait->run);
}

void exchange__prefer_long_poll(exchange *x, const api_run *record)
{
    unsigned seconds = 0;

    if (!prefer_wait(exchange__header(x, "Prefer"), &seconds))
        return;
    api_response_header(x->response, "Preference-Applied", "wait=%u",
                        seconds < API_WAIT_MAX_S ? seconds : API_WAIT_MAX_S);
    exchange__long_poll(x, record, seconds, false);
}
