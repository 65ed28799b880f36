#include "core/advice/validity.h"

#include "core/advice/comparisons.h"
#include "core/advice/validity_priv.h"
#include "core/base/memory.h"

#include <math.h>
#include <stdio.h>

/// Values are told with four digits. What is outside by less than they show, relative to the bound, is inside.
#define SLACK 2e-4

const validity_range *validity__range(const validity__findings *f, validity_figure figure)
{
    return &validity_table[figure].ranges[f->subject];
}

void validity__judge(validity__findings *f, validity_figure figure, double value,
                     const char *pointer)
{
    const validity_range *range = validity__range(f, figure);
    const bool is_any = range->minimum == -INFINITY && range->maximum == INFINITY;
    validity__noted *of = &f->figures[figure];
    int way = VALIDITY_WAY_COUNT;

    of->least = fmin(of->least, value);
    of->largest = fmax(of->largest, value);
    f->is_unknown = f->is_unknown || isnan(value);
    if (isnan(range->minimum) || isnan(value))
        way = VALIDITY_NEVER_COMPARED;
    else if (value < range->minimum - SLACK * fabs(range->minimum))
        way = VALIDITY_TOO_SMALL;
    else if (value > range->maximum + SLACK * fabs(range->maximum))
        way = VALIDITY_TOO_LARGE;
    if (way == VALIDITY_WAY_COUNT || is_any)
        return;
    validity_item *item = &of->items[way];
    if (item->pointer[0] != '\0' && !isnan(value) &&
        (way == VALIDITY_TOO_SMALL ? value >= item->value : value <= item->value))
        return;
    item->figure = figure;
    item->value = value;
    snprintf(item->pointer, sizeof item->pointer, "%s", pointer);
}

/// The values of comparisons_columns; NAN: there is none.
static void values_of(const validity__findings *f, double ret_values[COMPARISON_COLUMNS])
{
    for (size_t k = 0; k < COMPARISON_COLUMNS; k++) {
        const comparison_column *column = &comparisons_columns[k];
        const double value = column->is_least ? f->figures[column->figure].least
                                              : f->figures[column->figure].largest;
        ret_values[k] = f->is_unknown ? NAN : value;
    }
}

static void collect(const scene *s, const validity__findings *f, validity *out)
{
    double values[COMPARISON_COLUMNS];

    out->subject = f->subject;
    out->n = out->n_never = 0;
    for (int figure = 0; figure < VALIDITY_FIGURE_COUNT; figure++) {
        for (int way = 0; way < VALIDITY_WAY_COUNT; way++) {
            const validity_item *found = &f->figures[figure].items[way];
            if (found->pointer[0] == '\0')
                continue;
            validity_item *item = way == VALIDITY_NEVER_COMPARED ? &out->never[out->n_never++]
                                                                 : &out->items[out->n++];
            *item = *found;
            validity_complete(item, f->subject, (validity_way)way);
        }
    }
    out->layout = f->layout;
    out->falls = f->falls;
    out->is_compared = out->n == 0 && out->n_never == 0;
    values_of(f, values);
    // Rates of the scenes that were compared are those of what leaves over a side.
    if (s->n_sinks == 0)
        comparisons_find(f->subject, values, &out->like);
}

/// The findings of a scene, which the caller frees by memory_free(), also where it fails.
static bf_status find(const scene *s, validity_subject subject, validity__findings **ret_findings,
                      bf_error *err)
{
    validity__findings *f = *ret_findings = memory_alloc(1, sizeof *f);

    if (f == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the validity of a scenario");
    f->subject = subject;
    for (int figure = 0; figure < VALIDITY_FIGURE_COUNT; figure++)
        f->figures[figure].least = f->figures[figure].largest = NAN;
    return validity__measure(s, f, err);
}

bf_status validity_of(const scene *s, validity *ret_validity, bf_error *err)
{
    static const validity_subject of_closures[SCENE_CLOSURE_COUNT] = {
        [SCENE_DISPERSIVE] = VALIDITY_DISPERSIVE,
        [SCENE_CONGESTED] = VALIDITY_CONGESTED,
    };
    validity__findings *f;
    const bf_status status = find(s, of_closures[s->macro.closure], &f, err);

    if (status == BF_OK)
        collect(s, f, ret_validity);
    memory_free(f);
    return status;
}

bf_status validity_of_parts(const scene *s, double overlap, validity *ret_validity, bf_error *err)
{
    validity__findings *f;
    const bf_status status = find(s, VALIDITY_PARTS_MODEL, &f, err);

    if (status == BF_OK) {
        if (!isnan(overlap))
            validity__judge(f, VALIDITY_OVERLAP, 100.0 * overlap, "/micro/modulus_reduction");
        collect(s, f, ret_validity);
    }
    memory_free(f);
    return status;
}

bf_status validity_values(const scene *s, validity_subject subject, double *ret_values,
                          bf_error *err)
{
    validity__findings *f;
    const bf_status status = find(s, subject, &f, err);

    if (status == BF_OK)
        values_of(f, ret_values);
    memory_free(f);
    return status;
}
