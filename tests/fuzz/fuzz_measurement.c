// The body of POST /v1/measurements: JSON if it begins with '{', else CSV, of a curve and of both kinds for feeds. What is accepted keeps what its header promises.

#include "tests/fuzz/fuzz.h"

#include "api/results/measurement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void require_promises(const measurement *m)
{
    const api_curve *c = &m->curve;
    const double *t = (const double *)(const void *)c->t.bytes;
    const double *counts = (const double *)(const void *)c->values.bytes;
    bf_buffer out = { 0 };
    bf_error err;

    fuzz_require(c->n >= 2 && c->n <= API_MEASUREMENT_SAMPLES_MAX, "samples");
    for (size_t k = 0; k < c->n; k++) {
        fuzz_require(isfinite(t[k]) && (k == 0 || t[k] > t[k - 1]), "times rise");
        fuzz_require(isfinite(counts[k]) && counts[k] >= 0.0, "counts are not negative");
    }
    fuzz_require(measurement_json(&m->about, c, &m->csv, &out, &err) == BF_OK, "it can be written");
    buffer_fini(&out);
}

static void read_feed(const char *text, size_t n, api_measured kind)
{
    measurement m;
    bf_buffer out = { 0 };
    bf_faults faults = { 0 };
    bf_error err;

    if (measurement_read_feed(text, n, kind, NULL, &m, &faults, &err) != BF_OK)
        return;
    fuzz_require(m.about.n_samples >= 1 && m.about.n_samples <= SCENE_SERIES_MAX, "rows");
    fuzz_require(m.about.t_start >= 0.0 && m.about.t_end >= m.about.t_start, "times do not fall");
    fuzz_require(m.csv.n == n && memcmp(m.csv.bytes, text, n) == 0, "the text is kept");
    fuzz_require(measurement_json(&m.about, &m.curve, &m.csv, &out, &err) == BF_OK,
                 "it can be written");
    buffer_fini(&out);
    measurement_fini(&m);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    measurement m;
    bf_faults faults = { 0 };
    bf_error err;
    char *text = fuzz_text(bytes, n);

    const bf_status status = text[0] == '{'
                                 ? measurement_read_json(text, n, &m, &faults, &err)
                                 : measurement_read_csv(text, n, NULL, NULL, &m, &faults, &err);
    if (status == BF_OK) {
        require_promises(&m);
        measurement_fini(&m);
    }
    if (text[0] != '{') {
        read_feed(text, n, API_MEASURED_PROFILE);
        read_feed(text, n, API_MEASURED_SCHEDULE);
    }
    free(text);
    return 0;
}
