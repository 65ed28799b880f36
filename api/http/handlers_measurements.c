// Measurements: store, show, remove.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/json/number.h"
#include "api/json/text.h"
#include "api/results/measurement.h"
#include "api/results/results.h"

#include <stdio.h>
#include <string.h>

// Bytes that hold the members of any measurement as JSON, besides its samples.
enum { MEMBERS_JSON_MAX = 4096 };

// Bytes of JSON that a byte of a text takes at most: "\\n" of a line's end.
enum { CSV_JSON_MAX = 2 };

// Of a word that the route's table has accepted; NULL: a curve.
static api_measured kind_of(const char *word)
{
    return word == NULL
               ? API_MEASURED_CURVE
               : (api_measured)text_find_word(api_measured_words, API_MEASURED_COUNT, word);
}

static bf_status read_measurement(exchange *x, measurement *ret_measurement, bf_error *err)
{
    const char *body = exchange__body(x);
    const size_t n = x->request->n_body;
    const char *label = exchange__text(x, "label");
    const char *counter = exchange__text(x, "counter");
    const char *kind = exchange__text(x, "kind");
    const bool is_csv = x->body_media->format == MEDIA_CSV;

    if (is_csv && kind_of(kind) != API_MEASURED_CURVE) {
        if (counter != NULL)
            return exchange__refuse(x, 422, "/counter", err, "a %s has no counter", kind);
        return measurement_read_feed(body, n, kind_of(kind), label, ret_measurement, &x->faults,
                                     err);
    }
    if (is_csv)
        return measurement_read_csv(body, n, label, counter, ret_measurement, &x->faults, err);
    if (kind_of(kind) != API_MEASURED_CURVE)
        return exchange__refuse(x, 415, "", err, "a %s is sent as text/csv", kind);
    if (label != NULL || counter != NULL)
        return exchange__refuse(x, 400, "", err, "query parameter '%s': JSON has it in the body",
                                label != NULL ? "label" : "counter");
    return measurement_read_json(body, n, ret_measurement, &x->faults, err);
}

bf_status handlers_measurements_add(exchange *x, bf_error *err)
{
    measurement m = { .curve = { .n = 0 } };
    api_measurement stored;

    BF_TRY(read_measurement(x, &m, err));
    memcpy(m.about.owner, x->who.owner, sizeof m.about.owner);
    // Room for the answer comes first: what was stored must not be answered with a failure.
    size_t room = MEMBERS_JSON_MAX + 2 * m.curve.n * NUMBER_SIZE + CSV_JSON_MAX * m.csv.n;
    bf_status status;
    if (buffer_reserve(&x->response->body, room) == NULL)
        status = bf_fail_memory(err);
    else
        status = x->services->add_measurement(x->services->store, &m.about, &m.curve, &m.csv,
                                              &stored, err);
    if (status == BF_OK) {
        x->response->status = 201;
        api_response_header(x->response, "Location", "/v1/measurements/%s", stored.id);
        status = measurement_json(&stored, &m.curve, &m.csv, &x->response->body, err);
    }
    measurement_fini(&m);
    return status;
}

static bf_status find_measurement(exchange *x, api_measurement *ret_measurement, bf_error *err)
{
    const char *id = x->params.values[0];

    if (!param_is_id(id))
        return bf_fail(err, BF_ENOTFOUND, "", "there is no measurement '%s'", id);
    return access_find_measurement(x, id, ret_measurement, err);
}

bf_status handlers_measurements_show(exchange *x, bf_error *err)
{
    bf_buffer *body = &x->response->body;
    api_curve curve = { 0 };
    bf_buffer csv = { 0 };
    api_measurement about;

    BF_TRY(find_measurement(x, &about, err));
    // It never changes, but it may be removed.
    exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "%s-%s", about.id, x->media->word))
        return BF_OK;
    bf_status status =
        about.kind == API_MEASURED_CURVE
            ? x->services->read_measurement(x->services->store, about.id, &curve, err)
            : x->services->read_measurement_csv(x->services->store, about.id, &csv, err);
    if (status == BF_OK && x->media->format != MEDIA_CSV)
        status = measurement_json(&about, &curve, &csv, body, err);
    else if (status == BF_OK)
        status = about.kind == API_MEASURED_CURVE ? results_curve_csv(&curve, body, err)
                                                  : buffer_append(body, csv.bytes, csv.n);
    api_curve_fini(&curve);
    buffer_fini(&csv);
    return status;
}

bf_status handlers_measurements_remove(exchange *x, bf_error *err)
{
    char json[EXCHANGE_ETAG_SIZE], csv[EXCHANGE_ETAG_SIZE];
    const char *const tags[] = { json, csv, NULL };
    api_measurement about;

    BF_TRY(find_measurement(x, &about, err));
    snprintf(json, sizeof json, "%s-json", about.id);
    snprintf(csv, sizeof csv, "%s-csv", about.id);
    BF_TRY(exchange__check_change(x, tags, err));
    BF_TRY(x->services->remove_measurement(x->services->store, about.id, err));
    x->response->status = 204;
    return BF_OK;
}
