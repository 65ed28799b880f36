#include "core/advice/comparisons.h"

#include <math.h>
#include <stdio.h>

#define BY_DIFFERENCE(figure, tolerance)                                                           \
    {                                                                                              \
        figure, false, COMPARISON_DIFFERENCE, tolerance                                            \
    }
#define BY_RATIO(figure, tolerance)                                                                \
    {                                                                                              \
        figure, false, COMPARISON_RATIO, tolerance                                                 \
    }
#define AS_MANY(figure)                                                                            \
    {                                                                                              \
        figure, false, COMPARISON_DIFFERENCE, 0.0                                                  \
    }

// **Choice**: within these tolerances the errors of the rows of one group differ by a few percent.
const comparison_column comparisons_columns[COMPARISON_COLUMNS] = {
    { VALIDITY_ANGLE, true, COMPARISON_DIFFERENCE, 15.0 },
    BY_DIFFERENCE(VALIDITY_ANGLE, 15.0),
    BY_RATIO(VALIDITY_OPENING, 1.4),
    BY_RATIO(VALIDITY_FUNNEL, 1.4),
    BY_RATIO(VALIDITY_LOAD, 1.5),
    BY_RATIO(VALIDITY_QUEUE, 2.0),
    BY_DIFFERENCE(VALIDITY_PART_FRICTION, 0.2),
    BY_DIFFERENCE(VALIDITY_PLATE_FRICTION, 0.2),
    BY_RATIO(VALIDITY_BELT_FRICTION, 2.0),
    BY_DIFFERENCE(VALIDITY_ACCELERATION, 0.5),
    BY_RATIO(VALIDITY_SIZES, 1.4),
    BY_DIFFERENCE(VALIDITY_SHAPE, 20.0),
    BY_DIFFERENCE(VALIDITY_TURN, 15.0),
    BY_RATIO(VALIDITY_RATIO, 1.4),
    BY_DIFFERENCE(VALIDITY_TRANSFER, 25.0),
    BY_DIFFERENCE(VALIDITY_WALL, 5.0),
    AS_MANY(VALIDITY_PLATES),
    AS_MANY(VALIDITY_GUIDES),
    AS_MANY(VALIDITY_BELTS),
    AS_MANY(VALIDITY_KINDS),
    AS_MANY(VALIDITY_SCHEDULES),
    AS_MANY(VALIDITY_COMMANDS),
    AS_MANY(VALIDITY_MOTIONS),
    AS_MANY(VALIDITY_BATCH),
    AS_MANY(VALIDITY_FALLS),
    { VALIDITY_INCLINE, true, COMPARISON_DIFFERENCE, 5.0 },
    BY_DIFFERENCE(VALIDITY_INCLINE, 5.0),
    BY_DIFFERENCE(VALIDITY_STAGGER, 2.0),
    BY_RATIO(VALIDITY_RUN_OUT, 1.4),
    AS_MANY(VALIDITY_BENDS),
};

static bool is_alike(const comparison_column *column, double a, double b)
{
    if (isnan(a) || isnan(b))
        return isnan(a) && isnan(b);
    if (column->rule == COMPARISON_DIFFERENCE)
        return fabs(a - b) <= column->tolerance;
    return fmax(a, b) <= column->tolerance * fmin(a, b);
}

void comparisons_find(validity_subject subject, const double values[COMPARISON_COLUMNS],
                      validity_like *ret_like)
{
    static const char *const with[VALIDITY_SUBJECT_COUNT] = {
        [VALIDITY_DISPERSIVE] = "of moving parts",
        [VALIDITY_CONGESTED] = "of moving parts",
        [VALIDITY_PARTS_MODEL] = "with contacts 100 times as hard",
    };
    double sum = 0.0;

    *ret_like = (validity_like){ .n = 0 };
    for (size_t k = 0; k < comparisons_table_n; k++) {
        const comparison_row *row = &comparisons_table[k];
        size_t column = 0;
        while (column < COMPARISON_COLUMNS &&
               is_alike(&comparisons_columns[column], values[column], row->values[column]))
            column++;
        if (row->subject != subject || column < COMPARISON_COLUMNS)
            continue;
        ret_like->n++;
        ret_like->largest = fmax(ret_like->largest, 100.0 * fabs(row->error));
        sum += 100.0 * fabs(row->error);
    }
    if (ret_like->n == 0)
        return;
    ret_like->mean = sum / (double)ret_like->n;
    snprintf(ret_like->text, sizeof ret_like->text,
             "The throughput was within %.2g %% of that %s in %zu scene%s like this one.",
             ret_like->largest, with[subject], ret_like->n, ret_like->n == 1 ? "" : "s");
}
