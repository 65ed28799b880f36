// The service itself: examples, goods, liveness, readiness, metrics, version, the OpenAPI document.

#include "api/http/http_priv.h"
#include "api/http/problem.h"
#include "api/json/json_out.h"
#include "api/results/service_json.h"
#include "api/scenario/examples.h"
#include "api/scenario/goods_json.h"

bf_status handlers_meta_examples(exchange *x, bf_error *err)
{
    exchange__cache_revalidate(x);
    return examples_write(&x->response->body, err);
}

bf_status handlers_meta_example(exchange *x, bf_error *err)
{
    const example *item = examples_find(x->params.values[0]);

    if (item == NULL)
        return bf_fail(err, BF_ENOTFOUND, "", "there is no example '%s'", x->params.values[0]);
    exchange__cache_revalidate(x);
    json_out w = json_out_to(&x->response->body);
    json_out_raw(&w, item->document, item->n);
    return json_out_status(&w, err);
}

bf_status handlers_meta_goods(exchange *x, bf_error *err)
{
    exchange__cache_revalidate(x);
    return goods_json_write(&x->response->body, err);
}

bf_status handlers_meta_problem(exchange *x, bf_error *err)
{
    exchange__cache_revalidate(x);
    return problem_describe(x->params.values[0], &x->response->body, err);
}

bf_status handlers_meta_livez(exchange *x, bf_error *err)
{
    return service_json_alive(&x->response->body, err);
}

bf_status handlers_meta_readyz(exchange *x, bf_error *err)
{
    bf_status status = x->services->ready(x->services->service, err);

    if (status != BF_OK) {
        x->refusal = 503;
        return status;
    }
    return service_json_ready(&x->response->body, err);
}

bf_status handlers_meta_ticket(exchange *x, bf_error *err)
{
    api_ticket ticket;

    x->services->make_ticket(x->services->service, x->who.token, &ticket);
    return service_json_ticket(&ticket, &x->response->body, err);
}

bf_status handlers_meta_quota(exchange *x, bf_error *err)
{
    api_quotas quotas;

    BF_TRY(x->services->read_quotas(x->services->store, x->who.owner, &quotas, err));
    return service_json_quotas(&quotas, &x->response->body, err);
}

bf_status handlers_meta_metrics(exchange *x, bf_error *err)
{
    const bool with_owners = (x->who.scopes & (API_SCOPE_METRICS | API_SCOPE_ADMIN)) != 0;

    return x->services->metrics(x->services->service, with_owners, &x->response->body, err);
}

bf_status handlers_meta_version(exchange *x, bf_error *err)
{
    exchange__cache_revalidate(x);
    return service_json_version(&x->response->body, err);
}

bf_status handlers_meta_openapi(exchange *x, bf_error *err)
{
    exchange__cache_revalidate(x);
    return x->services->write_openapi(&x->response->body, err);
}
