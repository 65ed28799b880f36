#include "server/base/metrics.h"

#include "api/http/routes.h"
#include "api/json/text.h"
#include "core/base/check.h"
#include "server/base/base_priv.h"

#include <stdbool.h>
#include <string.h>

enum {
#define X(type, word, n) SLOTS_##type = n,
    METRICS_TYPE_LIST(X)
#undef X
};

enum {
    ROUTE_NONE, // METRICS_NO_ROUTE
    ROUTE_PAGE, // METRICS_PAGE
    ROUTE_FIRST // of the table of routes
};

#define X(symbol, type, name, unit, labels, help)                                                  \
    static _Atomic int64_t slots_##symbol[METRICS__SERIES_##labels * SLOTS_##type];
METRICS_LIST(X)
#undef X

enum {
#define X(labels, a, b, c)                                                                         \
    labels##_1 = METRICS__BY_##a, labels##_2 = METRICS__BY_##b, labels##_3 = METRICS__BY_##c,
    METRICS_LABELS_LIST(X)
#undef X
};

const metrics__metric metrics__table[METRICS_COUNT] = {
#define X(symbol, type, name, unit, labels, help)                                                  \
    { name,                                                                                        \
      unit,                                                                                        \
      help,                                                                                        \
      METRICS__##type,                                                                             \
      { (metrics__dimension)labels##_1, (metrics__dimension)labels##_2,                            \
        (metrics__dimension)labels##_3 },                                                          \
      METRICS__SERIES_##labels,                                                                    \
      SLOTS_##type,                                                                                \
      slots_##symbol },
    METRICS_LIST(X)
#undef X
};

static const int64_t bounds_ns[METRICS_BOUNDS] = {
    100000,    300000,    1000000,    3000000,    10000000,    30000000,
    100000000, 300000000, 1000000000, 3000000000, 10000000000,
};

static const int64_t bounds_sizes[METRICS_BOUNDS] = {
    1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024,
};

static const char *const methods[] = { METRICS_METHODS };
static const char *const codes[] = { METRICS_CODES };

const int64_t *metrics__bounds(metrics__type type)
{
    return type == METRICS__TIMES ? bounds_ns : bounds_sizes;
}

const char *metrics__label(metrics__dimension dimension)
{
    static const char *const labels[] = {
#define X(by, label, n) label,
        METRICS_DIMENSION_LIST(X)
#undef X
    };
    return labels[dimension];
}

size_t metrics__size(metrics__dimension dimension)
{
    static const size_t sizes[] = {
#define X(by, label, n) n,
        METRICS_DIMENSION_LIST(X)
#undef X
            [METRICS__BY_NOTHING] = 1,
    };
    return sizes[dimension];
}

const char *metrics__type_word(metrics__type type)
{
    static const char *const words[] = {
#define X(symbol, word, n) word,
        METRICS_TYPE_LIST(X)
#undef X
    };
    return words[type];
}

// Words of the lists of metrics.h, by value.
#define WORD(symbol, word) word,
static const char *const reason_words[] = { METRICS_REASON_LIST(WORD) };
static const char *const quota_words[] = { METRICS_QUOTA_LIST(WORD) };
static const char *const layer_words[] = { METRICS_LAYER_LIST(WORD) };
static const char *const place_words[] = { METRICS_PLACE_LIST(WORD) };
static const char *const task_words[] = { METRICS_TASK_LIST(WORD) };
static const char *const match_words[] = { METRICS_MATCH_LIST(WORD) };
#undef WORD

static const char *route_word(size_t value)
{
    size_t n = 0;
    const route *routes = routes_list(&n);

    if (value == ROUTE_NONE)
        return METRICS_NO_ROUTE;
    if (value == ROUTE_PAGE)
        return METRICS_PAGE;
    return value - ROUTE_FIRST < n ? routes[value - ROUTE_FIRST].path : NULL;
}

// Of the events only these are frames of a run.
static const char *frame_word(api_event_type type)
{
    const bool is_frame = type != API_EVENT_STATUS && type != API_EVENT_END;
    return is_frame ? api_event_word(type) : NULL;
}

const char *metrics__word(metrics__dimension dimension, size_t value)
{
    switch (dimension) {
    case METRICS__BY_ROUTE:
        return route_word(value);
    case METRICS__BY_METHOD:
        return methods[value];
    case METRICS__BY_CODE:
        return codes[value];
    case METRICS__BY_STATE:
        return run_state_word((run_state)value);
    case METRICS__BY_MODEL:
        return run_model_words[value];
    case METRICS__BY_FRAME:
        return frame_word((api_event_type)value);
    case METRICS__BY_REASON:
        return reason_words[value];
    case METRICS__BY_QUOTA:
        return quota_words[value];
    case METRICS__BY_LAYER:
        return layer_words[value];
    case METRICS__BY_PLACE:
        return place_words[value];
    case METRICS__BY_TASK:
        return task_words[value];
    case METRICS__BY_MATCH:
        return match_words[value];
    case METRICS__BY_LEVEL:
        return log_level_word((log_level)value);
    case METRICS__BY_VERSION:
        return BELTFLOW_VERSION;
    case METRICS__BY_COMPILER:
        return __VERSION__;
    case METRICS__BY_NOTHING:
        break;
    }
    return NULL;
}

// The first slot of a series.
static _Atomic int64_t *slots_of(metrics_id id, size_t series)
{
    const metrics__metric *m = &metrics__table[id];

    BF_CHECK(series < m->n_series);
    return m->slots + series * m->n_slots;
}

void metrics_add(metrics_id metric, size_t series, int64_t n)
{
    (void)atomic_fetch_add_explicit(slots_of(metric, series), n, memory_order_relaxed);
}

void metrics_set(metrics_id metric, size_t series, int64_t value)
{
    atomic_store_explicit(slots_of(metric, series), value, memory_order_relaxed);
}

int64_t metrics_value(metrics_id metric, size_t series)
{
    return atomic_load_explicit(slots_of(metric, series), memory_order_relaxed);
}

void metrics_observe(metrics_id metric, size_t series, int64_t value)
{
    _Atomic int64_t *slots = slots_of(metric, series);
    const int64_t *bounds = metrics__bounds(metrics__table[metric].type);
    size_t i = 0;

    while (i < METRICS_BOUNDS && value > bounds[i])
        i++;
    (void)atomic_fetch_add_explicit(&slots[i], 1, memory_order_relaxed);
    (void)atomic_fetch_add_explicit(&slots[METRICS_BOUNDS + 1], value, memory_order_relaxed);
}

// The number of a route's template; several rows of the table can have the same one.
static size_t find_route(const char *template)
{
    size_t n = 0;
    const route *routes = routes_list(&n);

    BF_CHECK(n + ROUTE_FIRST <= METRICS_ROUTES_MAX);
    if (strcmp(template, METRICS_PAGE) == 0)
        return ROUTE_PAGE;
    for (size_t i = 0; i < n; i++) {
        if (routes[i].path == template || strcmp(routes[i].path, template) == 0)
            return i + ROUTE_FIRST;
    }
    return ROUTE_NONE;
}

// The number of a code in a list whose last one stands for all others, as that of methods does.
static size_t find_code(int status)
{
    const char code[] = { (char)('0' + status / 100 % 10), (char)('0' + status / 10 % 10),
                          (char)('0' + status % 10), '\0' };
    return text_find_word(codes, METRICS__N_CODES - 1, code);
}

void metrics_count_request(const char *template, const char *method, int status, int64_t ns)
{
    size_t series = find_route(template) * METRICS__N_METHODS +
                    text_find_word(methods, METRICS__N_METHODS - 1, method);

    metrics_add(METRICS_REQUESTS, series * METRICS__N_CODES + find_code(status), 1);
    if (ns >= 0)
        metrics_observe(METRICS_REQUEST_TIMES, series, ns);
}
