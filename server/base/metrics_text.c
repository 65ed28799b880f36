#include "server/base/metrics.h"

#include "server/base/base_priv.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum {
    LABELS_SIZE = 512, // bytes of the labels of a series with a terminator
    VALUE_SIZE = 32,   // bytes of a value with its terminator
    NS_PER_S = 1000000000
};

// Writes 'a="x",b="y"' of a series. False: a value of it does not exist.
static bool write_labels(const metrics__metric *m, size_t series, char *ret_text)
{
    size_t values[METRICS_DIMENSIONS] = { 0 };

    ret_text[0] = '\0';
    for (size_t d = METRICS_DIMENSIONS; d-- > 0;) {
        size_t n = metrics__size(m->dimensions[d]);
        values[d] = series % n;
        series /= n;
    }
    for (size_t d = 0; d < METRICS_DIMENSIONS && m->dimensions[d] != METRICS__BY_NOTHING; d++) {
        const char *word = metrics__word(m->dimensions[d], values[d]);
        size_t n = strlen(ret_text);
        if (word == NULL)
            return false;
        (void)snprintf(ret_text + n, LABELS_SIZE - n, "%s%s=\"", d > 0 ? "," : "",
                       metrics__label(m->dimensions[d]));
        // Appends a label's value, in which backslash, quote and line end would break the form.
        size_t n_text = strlen(ret_text);
        for (; *word != '\0' && n_text + 3 < LABELS_SIZE - 1; word++) {
            if (*word == '\\' || *word == '"' || *word == '\n')
                ret_text[n_text++] = '\\';
            ret_text[n_text++] = *word == '\n' ? 'n' : *word;
        }
        ret_text[n_text] = '\0';
        n = strlen(ret_text);
        ret_text[n] = '"';
        ret_text[n + 1] = '\0';
    }
    return true;
}

// A value in its unit: nanoseconds become seconds.
static const char *write_value(const metrics__metric *m, int64_t value, char *storage)
{
    int n = 0;

    if (strcmp(m->unit, "seconds") != 0) {
        (void)snprintf(storage, VALUE_SIZE, "%" PRId64, value);
        return storage;
    }
    n = snprintf(storage, VALUE_SIZE, "%s%" PRId64 ".%09" PRId64, value < 0 ? "-" : "",
                 value < 0 ? -(value / NS_PER_S) : value / NS_PER_S,
                 value < 0 ? -(value % NS_PER_S) : value % NS_PER_S);
    while (storage[n - 1] == '0')
        storage[--n] = '\0';
    if (storage[n - 1] == '.')
        storage[n - 1] = '\0';
    return storage;
}

// Buckets hold all that is below their bound, so they add up.
static bf_status write_histogram(const metrics__metric *m, const char *labels, const int64_t *slots,
                                 bf_buffer *out)
{
    const int64_t *bounds = metrics__bounds(m->type);
    const char *comma = labels[0] == '\0' ? "" : ",";
    const char *open = labels[0] == '\0' ? "" : "{", *close = labels[0] == '\0' ? "" : "}";
    char text[VALUE_SIZE];
    int64_t n = 0;

    for (size_t i = 0; i <= METRICS_BOUNDS; i++) {
        n += slots[i];
        BF_TRY(buffer_printf(out, "%s_bucket{%s%sle=\"%s\"} %" PRId64 "\n", m->name, labels, comma,
                             i < METRICS_BOUNDS ? write_value(m, bounds[i], text) : "+Inf", n));
    }
    BF_TRY(buffer_printf(out, "%s_sum%s%s%s %s\n", m->name, open, labels, close,
                         write_value(m, slots[METRICS_BOUNDS + 1], text)));
    return buffer_printf(out, "%s_count%s%s%s %" PRId64 "\n", m->name, open, labels, close, n);
}

// Of requests there are many series, most of which never come to be: those are left out.
static bool is_shown(const metrics__metric *m, const int64_t *slots)
{
    bool is_used = m->dimensions[0] != METRICS__BY_ROUTE;

    for (size_t i = 0; i < m->n_slots && !is_used; i++)
        is_used = slots[i] != 0;
    return is_used;
}

static bf_status write_series(const metrics__metric *m, size_t series, bf_buffer *out)
{
    int64_t slots[METRICS_BOUNDS + 2];
    char labels[LABELS_SIZE];

    for (size_t i = 0; i < m->n_slots; i++)
        slots[i] = atomic_load_explicit(&m->slots[series * m->n_slots + i], memory_order_relaxed);
    if (!is_shown(m, slots) || !write_labels(m, series, labels))
        return BF_OK;
    if (m->type == METRICS__TIMES || m->type == METRICS__SIZES)
        return write_histogram(m, labels, slots, out);
    char text[VALUE_SIZE];
    const char *open = labels[0] == '\0' ? "" : "{", *close = labels[0] == '\0' ? "" : "}";
    return buffer_printf(out, "%s%s%s%s %s\n", m->name, open, labels, close,
                         write_value(m, slots[0], text));
}

bf_status metrics_write(bf_buffer *out, bf_error *err)
{
    size_t before = out->n;
    bf_status status = BF_OK;

    metrics_set(METRICS_BUILD, 0, 1);
    for (size_t i = 0; i < METRICS_COUNT && status == BF_OK; i++) {
        const metrics__metric *m = &metrics__table[i];
        status = buffer_printf(out, "# HELP %s %s\n# TYPE %s %s\n", m->name, m->help, m->name,
                               metrics__type_word(m->type));
        for (size_t series = 0; series < m->n_series && status == BF_OK; series++)
            status = write_series(m, series, out);
    }
    if (status == BF_OK)
        return BF_OK;
    buffer_truncate(out, before);
    return bf_fail(err, status, "", "no memory for the metrics");
}
