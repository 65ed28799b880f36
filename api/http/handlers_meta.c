// The service itself: ready scenarios, liveness, readiness, figures, version.

#include "api/http/http_priv.h"
#include "api/json/json_in.h"
#include "api/json/json_out.h"
#include "api/openapi/openapi.h"
#include "api/scenario/examples.h"

#include <jansson.h>
#include <stdio.h>

// The scenario's own name is its title.
static bf_status write_example(json_out *w, const example *item, bf_error *err)
{
    char url[ROUTES_PARAM_SIZE + 32];
    bf_faults faults = { .n = 0 };
    json_in in = json_in_to(&faults);

    json_t *document = json_in_parse(&in, item->document, item->n);
    if (document == NULL)
        return json_in_status(&in, err);
    snprintf(url, sizeof url, "/v1/examples/%s", item->name);
    json_out_object(w);
    json_out_key_string(w, "name", item->name);
    json_out_key_string(w, "title", json_string_value(json_object_get(document, "name")));
    json_out_key_string(w, "url", url);
    json_out_object_end(w);
    json_in_free(document);
    return BF_OK;
}

bf_status handlers_meta_examples(exchange *x, bf_error *err)
{
    json_out w = json_out_to(&x->response->body);
    size_t n = 0;
    const example *items = examples_list(&n);
    bf_status status = BF_OK;

    exchange__cache_revalidate(x);
    json_out_object(&w);
    json_out_key(&w, "examples");
    json_out_array(&w);
    for (size_t i = 0; i < n && status == BF_OK; i++)
        status = write_example(&w, &items[i], err);
    json_out_array_end(&w);
    json_out_object_end(&w);
    return status == BF_OK ? json_out_status(&w, err) : status;
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
