// Unit tests of what a study answers.

#include "core/study/study_choice.h"

#include "core/base/memory.h"
#include "core/study/study_front.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

enum { POINTS = 5 };

static const study_definition grid = { .method = STUDY_GRID,
                                       .d = 1,
                                       .n_values = 2,
                                       .is_maximized = true,
                                       .n_trials_max = 100,
                                       .n_replications = 1,
                                       .steps = { POINTS },
                                       .confidence = 0.95,
                                       .indifference = NAN };

// A study of one round; trial k says values[k] and seconds[k].
static study *solve(const study_definition *d, const double *values, const double *seconds)
{
    study *s = NULL;

    assert_int_equal(study_create(d, &s, NULL), BF_OK);
    assert_int_equal(study_advance(s, NULL), BF_OK);
    for (size_t k = 0; k < study_trials(s); k++)
        study_tell(s, k, (const double[]){ values[k], seconds[k] });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    return s;
}

static study_choice choose(study *s, bool *is_in)
{
    study_choice choice;

    assert_int_equal(study_choose(s, is_in, &choice, NULL), BF_OK);
    return choice;
}

// 0.5 % of 100 is 0.5. All but the first let the whole feed through; of these 3 s is shortest, and 3.01 s within 0.5 %: of the
// points 2 and 4 the middle is at 3, and 2 is the first of those that are as near.
static void equal_points_are_told_by_the_second_value_and_the_middle(void **state)
{
    static const double values[POINTS] = { 90.0, 99.99, 100.0, 99.6, 99.51 },
                        seconds[POINTS] = { 1.0, 6.0, 3.0, 4.0, 3.01 };
    bool is_in[POINTS];
    study *s = solve(&grid, values, seconds);
    const study_choice c = choose(s, is_in);
    assert_true(c.is_known && !is_in[0] && is_in[1] && is_in[2] && is_in[3] && is_in[4]);
    assert_int_equal(c.n_set, 4);
    assert_int_equal(c.n_candidates, POINTS);
    assert_int_equal(c.best, 2);
    assert_near(c.indifference, 0.5, 1e-12);
    study_destroy(s);

    static const double same[POINTS] = { 3.0, 3.0, 3.0, 3.0, 3.0 };
    s = solve(&grid, values, same);
    assert_int_equal(choose(s, is_in).best, 2); // 1, 2, 3, 4: the middle is 2.5
    study_destroy(s);
}

static void an_indifference_that_is_given_counts(void **state)
{
    static const double values[POINTS] = { 90.0, 99.99, 100.0, 99.6, 99.51 },
                        seconds[POINTS] = { 1.0, 6.0, 3.0, 4.0, NAN };
    bool is_in[POINTS];
    study_definition d = grid;
    d.indifference = 10.0;
    study *s = solve(&d, values, seconds);
    const study_choice c = choose(s, is_in);
    assert_int_equal(c.n_set, POINTS);
    assert_int_equal(c.best, 0); // 1 s
    study_destroy(s);
}

// At least 99.5: points 1 to 3 meet it, and the first of them is named, whatever their values are.
static void a_demand_is_met_by_the_least_point(void **state)
{
    static const double values[POINTS] = { 90.0, 99.6, 100.0, 99.5, 99.4 },
                        seconds[POINTS] = { 1.0, 6.0, 3.0, 4.0, 3.0 };
    bool is_in[POINTS];
    study_definition d = grid;
    d.has_demand = true;
    d.demand = 99.5;
    study *s = solve(&d, values, seconds);
    study_choice c = choose(s, is_in);
    assert_true(c.is_known && c.is_met && !is_in[0] && is_in[1] && is_in[2] && is_in[3]);
    assert_int_equal(c.n_set, 3);
    assert_int_equal(c.best, 1);
    study_destroy(s);
    d.demand = 101.0;
    s = solve(&d, values, seconds);
    c = choose(s, is_in);
    assert_true(c.is_known && !c.is_met && c.n_set == 0);
    assert_int_equal(c.best, 2);
    study_destroy(s);
}

// Two points, two runs each, 95 %: t(0.025; 1) = 12.706, and of 9 and 11, or of 19 and 21, s/sqrt(2) = 1: the lower limits
// are 10 - 12.7 and 20 - 12.7 = 7.29.
static void a_demand_needs_the_confidence_of_all_points(void **state)
{
    static const double values[] = { 9.0, 11.0, 19.0, 21.0 }, seconds[4] = { 0 };
    bool is_in[2];
    study_definition d = grid;
    d.has_demand = d.has_chance = true;
    d.n_replications = 2;
    d.steps[0] = 2;
    d.demand = 7.25;
    study *s = solve(&d, values, seconds);
    study_choice c = choose(s, is_in);
    assert_true(c.is_met && c.best == 1 && c.n_set == 1 && is_in[1]);
    study_destroy(s);
    d.demand = 7.35;
    s = solve(&d, values, seconds);
    c = choose(s, is_in);
    assert_true(!c.is_met && c.best == 1 && c.n_set == 0);
    study_destroy(s);
}

static size_t find_front(study *s, const study_choice *choice, bool *is_on)
{
    size_t n;

    assert_int_equal(study_front(s, choice, is_on, &n, NULL), BF_OK);
    return n;
}

// More of the first and less of the second is better: 1 is worse than 2 in both, 4 equal in the first and worse in the second,
// and 3 has no second value.
static void the_front_has_the_points_that_no_other_is_better_than(void **state)
{
    static const double values[POINTS] = { 90.0, 98.0, 100.0, 101.0, 100.0 },
                        seconds[POINTS] = { 1.0, 6.0, 3.0, NAN, 4.0 };
    bool is_in[POINTS], is_on[POINTS];
    study *s = solve(&grid, values, seconds);
    const study_choice c = choose(s, is_in);
    assert_int_equal(find_front(s, &c, is_on), 2);
    assert_true(is_on[0] && !is_on[1] && is_on[2] && !is_on[3] && !is_on[4]);
    study_destroy(s);
}

// Steps of 0.5 of the first, and of 0.5 % of 2 s: 0 to 2 are alike in the first, 0 and 1 in the second, and 2 is worse there; 3 is a step
// worse in the first and 0.4 of a step better in the second, 4 two steps worse and one better.
static void a_front_leaves_out_differences_that_do_not_matter(void **state)
{
    static const double values[POINTS] = { 100.0, 99.99, 99.7, 99.4, 98.9 },
                        seconds[POINTS] = { 2.024, 2.022, 2.031, 2.021, 2.0 };
    bool is_in[POINTS], is_on[POINTS];
    study_definition d = grid;
    d.indifference = 0.5;
    study *s = solve(&d, values, seconds);
    study_choice c = choose(s, is_in);
    c.best = SIZE_MAX;
    assert_int_equal(find_front(s, &c, is_on), 2);
    assert_true(is_on[0] && !is_on[1] && !is_on[2] && !is_on[3] && is_on[4]);
    c.best = 1; // alike 0, and named
    assert_int_equal(find_front(s, &c, is_on), 2);
    assert_true(!is_on[0] && is_on[1] && !is_on[2] && !is_on[3] && is_on[4]);
    study_destroy(s);
}

// 1 is alike 0 in the first and a step better in the second, with the steps of above or 0.5 % of 100, also where a demand is asked
// for, for which no set is taken by the indifference.
static void a_front_has_the_same_steps_with_a_demand(void **state)
{
    static const double values[POINTS] = { 100.0, 99.99, 99.7, 99.4, 98.9 },
                        seconds[POINTS] = { 2.024, 2.012, 2.031, 2.021, 2.0 };
    bool is_in[POINTS], is_on[POINTS];
    for (int k = 0; k < 4; k++) {
        study_definition d = grid;
        d.has_demand = k < 2;
        d.demand = 99.0;
        d.indifference = k % 2 == 0 ? 0.5 : (double)NAN;
        study *s = solve(&d, values, seconds);
        const study_choice c = choose(s, is_in);
        assert_int_equal(find_front(s, &c, is_on), 2);
        assert_true(is_on[1] && is_on[4]);
        study_destroy(s);
    }
}

// One run of each where there is chance: the best value is named, and no set.
static void without_replications_nothing_is_known_of_chance(void **state)
{
    static const double values[POINTS] = { 90.0, 99.99, 100.0, 99.6, 99.51 },
                        seconds[POINTS] = { 1.0, 6.0, 9.0, 4.0, 3.0 };
    bool is_in[POINTS];
    study_definition d = grid;
    d.has_chance = true;
    study *s = solve(&d, values, seconds);
    const study_choice c = choose(s, is_in);
    assert_false(c.is_known);
    assert_int_equal(c.n_set, 0);
    assert_int_equal(c.best, 2);
    assert_true(study_has_chance(s, 0));
    study_destroy(s);
}

// Replications of 80, 100, 99.9, 90, 95, with a spread of -+ 1 that is common to all and one of -+ 0.5 of the third alone.
static void chance_leaves_points_equal(void **state)
{
    static const double means[POINTS] = { 80.0, 100.0, 99.9, 90.0, 95.0 };
    double values[4 * POINTS], seconds[4 * POINTS];
    bool is_in[POINTS];
    study_definition d = grid;
    d.has_chance = true;
    d.n_replications = 4;
    d.indifference = 0.01;
    for (size_t k = 0; k < 4 * POINTS; k++) {
        values[k] = means[k / 4] + (k % 2 == 0 ? 1.0 : -1.0);
        values[k] += k / 4 == 2 ? (k % 4 < 2 ? 0.5 : -0.5) : 0.0;
        seconds[k] = k / 4 == 2 ? 2.0 : 4.0;
    }
    study *s = solve(&d, values, seconds);
    const study_choice c = choose(s, is_in);
    assert_true(c.is_known && !is_in[0] && is_in[1] && is_in[2] && !is_in[3] && !is_in[4]);
    assert_int_equal(c.best, 2);
    study_destroy(s);
}

static void a_study_without_values_chooses_nothing(void **state)
{
    static const double none[POINTS] = { NAN, NAN, NAN, NAN, NAN };
    bool is_in[POINTS];
    study *s = solve(&grid, none, none);
    assert_int_equal(choose(s, is_in).best, SIZE_MAX);
    study_destroy(s);
}

// A screening of the grid whose sweep is over: point k has the value k.
static study *swept(size_t n_confirmed, double indifference)
{
    study_definition d = grid;
    study *s = NULL;

    d.method = STUDY_SCREEN;
    d.sweep = STUDY_GRID;
    d.n_confirmed = n_confirmed;
    d.indifference = indifference;
    assert_int_equal(study_create(&d, &s, NULL), BF_OK);
    assert_int_equal(study_advance(s, NULL), BF_OK);
    for (size_t k = 0; k < POINTS; k++)
        study_tell(s, k, (const double[]){ (double)k, 1.0 });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    return s;
}

// Between the rounds of a screening the best point of the sweep is named, then one of the microscopic model; without chance
// each of these is solved once, and that decides.
static void screening_has_a_best_point_between_its_rounds(void **state)
{
    bool is_in[POINTS + 2];
    study *s = swept(2, 0.1);
    assert_int_equal(study_points(s), POINTS + 2);
    assert_int_equal(study_best(s), POINTS - 1);
    const study_choice c = choose(s, is_in);
    assert_int_equal(c.best, POINTS - 1);
    assert_true(c.first == 0 && c.end == POINTS);
    study_tell(s, POINTS, (const double[]){ 5.0, 1.0 });
    study_tell(s, POINTS + 1, (const double[]){ 6.0, 1.0 });
    assert_int_equal(study_advance(s, NULL), BF_OK);
    assert_true(study_is_ended(s) && study_is_decided(s));
    assert_int_equal(study_trials(s), POINTS + 2);
    assert_int_equal(choose(s, is_in).best, POINTS + 1);
    assert_int_equal(choose(s, is_in).first, POINTS);
    study_destroy(s);
}

// All three points that are confirmed let the same through, within 0.5 %; the one with the largest value takes longest.
static void of_confirmed_points_that_are_equal_the_second_value_chooses(void **state)
{
    static const double confirmed[][2] = { { 99.9, 3.8 }, { 99.8, 3.5 }, { 100.0, 6.1 } };
    bool is_in[POINTS + 3];
    study *s = swept(3, 0.5);
    for (size_t k = 0; k < 3; k++)
        study_tell(s, POINTS + k, confirmed[k]);
    assert_int_equal(study_advance(s, NULL), BF_OK);
    assert_true(study_is_ended(s) && study_is_decided(s));
    const study_choice c = choose(s, is_in);
    assert_true(is_in[POINTS] && is_in[POINTS + 1] && is_in[POINTS + 2]);
    assert_int_equal(c.n_set, 3);
    assert_int_equal(c.best, POINTS + 1);
    study_destroy(s);
}

static void without_memory_nothing_is_chosen(void **state)
{
    static const double values[POINTS] = { 1.0, 2.0, 3.0, 4.0, 5.0 };
    bool is_in[POINTS];
    study *s = solve(&grid, values, values);
    study_choice c;
    size_t n_on = 1;
    for (size_t n = 1; n <= 4; n++) {
        memory_plan_fault(n, 0);
        assert_int_equal(study_choose(s, is_in, &c, NULL), BF_ENOMEM);
        memory_plan_fault(0, 0);
    }
    c = choose(s, is_in);
    memory_plan_fault(1, 0);
    assert_int_equal(study_front(s, &c, is_in, &n_on, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_int_equal(n_on, 1);
    study_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_points_are_told_by_the_second_value_and_the_middle),
        cmocka_unit_test(an_indifference_that_is_given_counts),
        cmocka_unit_test(a_demand_is_met_by_the_least_point),
        cmocka_unit_test(a_demand_needs_the_confidence_of_all_points),
        cmocka_unit_test(the_front_has_the_points_that_no_other_is_better_than),
        cmocka_unit_test(a_front_leaves_out_differences_that_do_not_matter),
        cmocka_unit_test(a_front_has_the_same_steps_with_a_demand),
        cmocka_unit_test(without_replications_nothing_is_known_of_chance),
        cmocka_unit_test(chance_leaves_points_equal),
        cmocka_unit_test(a_study_without_values_chooses_nothing),
        cmocka_unit_test(screening_has_a_best_point_between_its_rounds),
        cmocka_unit_test(of_confirmed_points_that_are_equal_the_second_value_chooses),
        cmocka_unit_test(without_memory_nothing_is_chosen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
