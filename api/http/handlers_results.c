// What a run has given so far: resolved scenario, summary, curve.

#include "api/http/exchange_priv.h"
#include "api/http/handlers.h"
#include "api/results/results.h"

#include <inttypes.h>

bf_status handlers_results_scenario(exchange *x, bf_error *err)
{
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    exchange__let_keep(x);
    if (exchange__is_unchanged(x, "%s-scenario", record.id))
        return BF_OK;
    return x->services->read_text(x->services->context, record.id, API_TEXT_SCENARIO,
                                  &x->response->body, err);
}

bf_status handlers_results_summary(exchange *x, bf_error *err)
{
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    if (!record.has_summary)
        return bf_fail(err, BF_ECONFLICT, "",
                       run_state_is_end(record.state)
                           ? "the run is %s and has left no summary"
                           : "the run is %s: the summary comes at its end",
                       run_state_word(record.state));
    exchange__let_revalidate(x);
    if (exchange__is_unchanged(x, "%s-summary", record.id))
        return BF_OK;
    return x->services->read_text(x->services->context, record.id, API_TEXT_SUMMARY,
                                  &x->response->body, err);
}

bf_status handlers_results_curve(exchange *x, bf_error *err)
{
    api_curve curve = { 0 };
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status != BF_OK)
        return status;
    exchange__let_revalidate(x);
    if (exchange__is_unchanged(x, "r%" PRIu64 "-%s", record.revision, x->media->word))
        return BF_OK;
    status = x->services->read_curve(x->services->context, record.id, 0, &curve, err);
    if (status != BF_OK)
        return status;
    status = x->media->format == MEDIA_CSV ? results_curve_csv(&curve, &x->response->body, err)
                                           : results_curve_json(&curve, &x->response->body, err);
    api_curve_fini(&curve);
    return status;
}
