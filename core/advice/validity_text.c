#include "core/advice/validity_text.h"

#include "core/advice/validity_table.h"
#include "core/base/number_text.h"

#include <math.h>
#include <stdio.h>

enum { DIGITS = 4 };

#define UNKNOWN_DENSITY                                                                            \
    "How well the density model predicts this was not measured: solve it with the microscopic "    \
    "model, too."

static void print_range(const validity_item *item, char *ret_text, size_t size)
{
    const validity_row *row = &validity_table[item->figure];
    char minimum[NUMBER_TEXT_SIZE], maximum[NUMBER_TEXT_SIZE];

    bool is_least = true;
    for (int k = 0; k < VALIDITY_SUBJECT_COUNT; k++)
        is_least = is_least && !(row->ranges[k].maximum < item->maximum);
    (void)number_text(item->minimum, DIGITS, minimum);
    (void)number_text(item->maximum, DIGITS, maximum);
    if (row->only != NULL && is_least)
        snprintf(ret_text, size, "%s", row->only);
    else if (!isfinite(item->minimum))
        snprintf(ret_text, size, "up to %s%s", maximum, row->of);
    else if (item->minimum == item->maximum)
        snprintf(ret_text, size, "%s%s", minimum, row->of);
    else if (!isfinite(item->maximum))
        snprintf(ret_text, size, "%s%s and more", minimum, row->of);
    else
        snprintf(ret_text, size, "%s to %s%s", minimum, maximum, row->of);
}

/// What a subject was compared with, and what to do where it was not.
typedef struct subject_text {
    const char *model;
    const char *with;
    const char *unknown;
} subject_text;

static const subject_text subjects[VALIDITY_SUBJECT_COUNT] = {
    [VALIDITY_DISPERSIVE] = { "density model", "moving parts", UNKNOWN_DENSITY },
    [VALIDITY_CONGESTED] = { "density model", "moving parts", UNKNOWN_DENSITY },
    [VALIDITY_PARTS_MODEL] = { "model of moving parts", "experiments and reference runs",
                               "How well moving parts predict this was not measured." },
};

/// Titles of values that are not known, as a belt has no friction.
static const char *const without_friction[VALIDITY_FIGURE_COUNT] = {
    [VALIDITY_ACCELERATION] = "Without friction the fastest belt brings no part to its speed",
    [VALIDITY_ACCELERATION_FULL] = "The opening is nearly full, and without friction the fastest "
                                   "belt brings no part to its speed",
    [VALIDITY_CORNERING] = "Without friction no part turns with a curve",
};

/// What to expect of an item; NULL: it was not measured.
static const char *expectation_of(const validity_item *item, const validity_range *range,
                                  validity_way way)
{
    const bool is_closed =
        item->value == 0.0 && (item->figure == VALIDITY_OPENING || item->figure == VALIDITY_FUNNEL);

    if (is_closed)
        return "The deflectors close the belt: cargo collects at them, and stays there.";
    if (isnan(range->minimum) || way == VALIDITY_TOO_LARGE)
        return range->above;
    return way == VALIDITY_TOO_SMALL ? range->below : NULL;
}

void validity_complete(validity_item *item, validity_subject of, validity_way way)
{
    const validity_row *row = &validity_table[item->figure];
    const validity_range *range = &row->ranges[of];
    const subject_text *subject = &subjects[of];
    const char *then = expectation_of(item, range, way);
    char value[NUMBER_TEXT_SIZE], between[160];

    item->unit = row->unit;
    item->minimum = range->minimum;
    item->maximum = range->maximum;
    item->meaning = then == NULL ? subject->unknown : then;
    if (isnan(item->value) && without_friction[item->figure] != NULL)
        snprintf(item->title, sizeof item->title, "%s", without_friction[item->figure]);
    else
        snprintf(item->title, sizeof item->title, "%s %s%s", row->before,
                 number_text(item->value, DIGITS, value), row->after);
    if (way == VALIDITY_NEVER_COMPARED)
        snprintf(between, sizeof between, "was never compared with %s for this", subject->with);
    else {
        char numbers[96];
        print_range(item, numbers, sizeof numbers);
        snprintf(between, sizeof between, "was compared with %s for %s", subject->with, numbers);
    }
    snprintf(item->comparison, sizeof item->comparison, "The %s %s.", subject->model, between);
    snprintf(item->detail, sizeof item->detail, "%s; the model %s.%s%s", item->title, between,
             then == NULL ? "" : " ", then == NULL ? "" : then);
}
