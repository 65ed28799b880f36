// The service itself: ready scenarios, liveness, readiness, figures, version.

#include "api/http/http_priv.h"
#include "api/json/json_out.h"
#include "api/openapi/openapi.h"
#include "api/scenario/examples.h"

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

static bf_status write_status(exchange *x, const char *word, bf_error *err)
{
    json_out w = json_out_to(&x->response->body);

    json_out_object(&w);
    json_out_key_string(&w, "status", word);
    json_out_object_end(&w);
    return json_out_status(&w, err);
}

bf_status handlers_meta_livez(exchange *x, bf_error *err)
{
    return write_status(x, "alive", err);
}

bf_status handlers_meta_readyz(exchange *x, bf_error *err)
{
    bf_status status = x->services->ready(x->services->context, err);

    if (status != BF_OK) {
        x->refusal = 503;
        return status;
    }
    return write_status(x, "ready", err);
}

bf_status handlers_meta_metrics(exchange *x, bf_error *err)
{
    return x->services->metrics(x->services->context, &x->response->body, err);
}

bf_status handlers_meta_version(exchange *x, bf_error *err)
{
    json_out w = json_out_to(&x->response->body);

    exchange__cache_revalidate(x);
    json_out_object(&w);
    json_out_key_string(&w, "name", "beltflow");
    json_out_key_string(&w, "version", BELTFLOW_VERSION);
    json_out_key_string(&w, "api", "v1");
    json_out_key_string(&w, "compiler", __VERSION__);
    json_out_object_end(&w);
    return json_out_status(&w, err);
}

bf_status handlers_meta_openapi(exchange *x, bf_error *err)
{
    exchange__cache_revalidate(x);
    return openapi_write(&x->response->body, err);
}
