// The measurements of the daemon in arrays.

#include "tests/unit/api/helper_services.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

static bf_status no_memory(bf_error *err)
{
    return bf_fail(err, BF_ENOMEM, "", "out of memory");
}

static helper_measurement *lookup_measurement(helper_daemon *d, const char *id)
{
    for (size_t i = 0; i < d->n_measurements; i++) {
        if (strcmp(d->measurements[i].about.id, id) == 0)
            return &d->measurements[i];
    }
    return NULL;
}

static bf_status no_measurement(bf_error *err)
{
    return bf_fail(err, BF_ENOTFOUND, "", "there is no such measurement");
}

static bf_status do_add_measurement(api_store *store, const api_measurement *measurement,
                                    const api_curve *curve, const bf_buffer *csv,
                                    api_measurement *ret_measurement, bf_error *err)
{
    helper_daemon *d = (void *)store;

    if (d->refusal != BF_OK)
        return bf_fail(err, d->refusal, "", "2000 measurements are stored");
    helper_measurement *item = helper_add_measurement(d, measurement->counter);
    if (measurement->kind == API_MEASURED_CURVE) {
        assert_int_equal(curve->n, measurement->n_samples);
        assert_int_equal(curve->n_columns, 1);
        assert_string_equal(curve->columns.bytes, measurement->counter);
    } else {
        assert_true(curve->n == 0 && csv->n < sizeof item->csv);
        memcpy(item->csv, csv->bytes, csv->n + 1);
    }
    item->about.kind = measurement->kind;
    memcpy(item->about.label, measurement->label, sizeof item->about.label);
    item->about.n_samples = measurement->n_samples;
    item->about.t_start = measurement->t_start;
    item->about.t_end = measurement->t_end;
    size_t n_kept = curve->n < 8 ? curve->n : 8;
    if (n_kept > 0) {
        memcpy(item->t, curve->t.bytes, n_kept * sizeof(double));
        memcpy(item->counts, curve->values.bytes, n_kept * sizeof(double));
    }
    *ret_measurement = item->about;
    return BF_OK;
}

static bf_status do_find_measurement(api_store *store, const char *id,
                                     api_measurement *ret_measurement, bf_error *err)
{
    const helper_measurement *item = lookup_measurement((void *)store, id);

    if (item == NULL)
        return no_measurement(err);
    *ret_measurement = item->about;
    return BF_OK;
}

static bf_status do_list_measurements(api_store *store, const api_page_query *query,
                                      api_page *ret_page, bf_error *err)
{
    const helper_daemon *d = (void *)store;

    ret_page->n = 0;
    ret_page->has_more = false;
    for (size_t i = d->n_measurements; i-- > 0 && !ret_page->has_more;) {
        const api_measurement *about = &d->measurements[i].about;
        bool fits = about->id[0] != '\0' &&
                    (query->label[0] == '\0' || strcmp(about->label, query->label) == 0) &&
                    (query->before[0] == '\0' || strcmp(about->id, query->before) < 0);
        if (fits && ret_page->n == query->limit)
            ret_page->has_more = true;
        else if (fits)
            ret_page->measurements[ret_page->n++] = *about;
    }
    return BF_OK;
}

static bf_status do_read_measurement(api_store *store, const char *id, api_curve *ret_curve,
                                     bf_error *err)
{
    const helper_measurement *item = lookup_measurement((void *)store, id);
    api_curve curve = { .n_columns = 1 };

    if (item == NULL)
        return no_measurement(err);
    curve.n = (size_t)item->about.n_samples;
    if (buffer_printf(&curve.columns, "%s", item->about.counter) != BF_OK ||
        buffer_append(&curve.t, item->t, curve.n * sizeof(double)) != BF_OK ||
        buffer_append(&curve.values, item->counts, curve.n * sizeof(double)) != BF_OK) {
        api_curve_fini(&curve);
        return no_memory(err);
    }
    *ret_curve = curve;
    return BF_OK;
}

static bf_status do_read_measurement_csv(api_store *store, const char *id, bf_buffer *out,
                                         bf_error *err)
{
    helper_daemon *d = (void *)store;
    const helper_measurement *item = lookup_measurement(d, id);

    if (item == NULL)
        return no_measurement(err);
    if (d->refusal != BF_OK)
        return bf_fail(err, d->refusal, "", "the store failed");
    return buffer_append(out, item->csv, strlen(item->csv)) == BF_OK ? BF_OK : no_memory(err);
}

static bf_status do_remove_measurement(api_store *store, const char *id, bf_error *err)
{
    helper_measurement *item = lookup_measurement((void *)store, id);

    if (item == NULL)
        return no_measurement(err);
    item->about.id[0] = '\0';
    return BF_OK;
}

void helper_serve_measurements(api_services *services)
{
    services->add_measurement = do_add_measurement;
    services->find_measurement = do_find_measurement;
    services->list_measurements = do_list_measurements;
    services->read_measurement = do_read_measurement;
    services->read_measurement_csv = do_read_measurement_csv;
    services->remove_measurement = do_remove_measurement;
}

helper_measurement *helper_add_measurement(helper_daemon *d, const char *counter)
{
    assert_true(d->n_measurements < HELPER_MEASUREMENTS_MAX);
    helper_measurement *item = &d->measurements[d->n_measurements++];

    *item = (helper_measurement){ .t = { 0.0, 0.1 }, .counts = { 192.0, 191.0 } };
    item->about =
        (api_measurement){ .created_ms = 1769860800000 + 1000 * (int64_t)d->n_measurements,
                           .n_samples = 2,
                           .t_end = 0.1 };
    snprintf(item->about.id, sizeof item->about.id, "0190a0b0-0000-7000-9000-%012zx",
             d->n_measurements);
    snprintf(item->about.counter, sizeof item->about.counter, "%s", counter);
    return item;
}
