// Scenes of the comparison that are like another one.

#include "core/advice/comparisons.h"

#include "core/advice/validity_table.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static validity_like like_of(const double *values)
{
    validity_like like;

    comparisons_find(VALIDITY_CONGESTED, values, &like);
    return like;
}

static size_t column_of(validity_figure figure, bool is_least)
{
    size_t k = 0;

    while (comparisons_columns[k].figure != figure || comparisons_columns[k].is_least != is_least)
        k++;
    return k;
}

static const comparison_row *first_row_of(validity_subject subject)
{
    const comparison_row *row = comparisons_table;

    while (row->subject != subject)
        row++;
    return row;
}

// And of the 273 lines 194 are like others, too, as core/advice/README.md says.
static void a_scene_of_the_table_is_like_itself(void **state)
{
    size_t n_lines = 0, n_like_others = 0;

    for (size_t k = 0; k < comparisons_table_n; k++) {
        const comparison_row *row = &comparisons_table[k];
        validity_like like;
        comparisons_find(row->subject, row->values, &like);
        assert_true(like.n >= 1);
        assert_true(like.largest >= 100.0 * fabs(row->error));
        assert_true(like.mean <= like.largest);
        n_lines += row->subject == VALIDITY_CONGESTED;
        n_like_others += row->subject == VALIDITY_CONGESTED && like.n >= 2;
    }
    assert_int_equal(n_lines, 273);
    assert_int_equal(n_like_others, 194);
}

static void a_figure_beyond_its_tolerance_is_not_alike(void **state)
{
    const comparison_row *row = first_row_of(VALIDITY_CONGESTED);
    double values[COMPARISON_COLUMNS];

    memcpy(values, row->values, sizeof values);
    values[column_of(VALIDITY_PART_FRICTION, false)] += 5.0;
    assert_int_equal(like_of(values).n, 0);
}

// A scene without the angle of a plate, and one with a thing that the rows do not have.
static void a_figure_that_one_of_them_lacks_is_not_alike(void **state)
{
    const comparison_row *row = first_row_of(VALIDITY_CONGESTED);
    double values[COMPARISON_COLUMNS];

    memcpy(values, row->values, sizeof values);
    values[column_of(VALIDITY_ANGLE, true)] = NAN;
    assert_int_equal(like_of(values).n, 0);
    memcpy(values, row->values, sizeof values);
    values[column_of(VALIDITY_MOTIONS, false)] = 1.0;
    assert_int_equal(like_of(values).n, 0);
    assert_string_equal(like_of(values).text, "");
}

// Nothing is like a scene of which nothing is known, or like one for a closure without rows.
static void without_figures_or_rows_there_are_none(void **state)
{
    double values[COMPARISON_COLUMNS];
    validity_like like;

    for (size_t k = 0; k < COMPARISON_COLUMNS; k++)
        values[k] = NAN;
    assert_int_equal(like_of(values).n, 0);
    comparisons_find(VALIDITY_DISPERSIVE, first_row_of(VALIDITY_CONGESTED)->values, &like);
    assert_int_equal(like.n, 0);
}

// What is said to be compared is no wider than the rows are, where rows alone compare it.
static void ranges_are_those_of_the_rows(void **state)
{
    static const validity_figure figures[] = { VALIDITY_OPENING,        VALIDITY_ACCELERATION,
                                               VALIDITY_PLATE_FRICTION, VALIDITY_PART_FRICTION,
                                               VALIDITY_BELT_FRICTION,  VALIDITY_SIZES };

    for (size_t i = 0; i < sizeof figures / sizeof *figures; i++) {
        const validity_range *range = &validity_table[figures[i]].ranges[VALIDITY_CONGESTED];
        const size_t column = column_of(figures[i], false);
        double least = NAN, largest = NAN;
        for (size_t k = 0; k < comparisons_table_n; k++) {
            if (comparisons_table[k].subject != VALIDITY_CONGESTED)
                continue;
            least = fmin(least, comparisons_table[k].values[column]);
            largest = fmax(largest, comparisons_table[k].values[column]);
        }
        assert_true(range->minimum == -INFINITY || range->minimum >= least);
        assert_true(range->maximum <= largest * 1.01);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_of_the_table_is_like_itself),
        cmocka_unit_test(a_figure_beyond_its_tolerance_is_not_alike),
        cmocka_unit_test(a_figure_that_one_of_them_lacks_is_not_alike),
        cmocka_unit_test(without_figures_or_rows_there_are_none),
        cmocka_unit_test(ranges_are_those_of_the_rows),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
