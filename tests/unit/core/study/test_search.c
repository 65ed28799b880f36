// Unit tests of searches by NLopt and by the evolution strategy.

#include "core/study/search.h"

#include "core/study/cmaes.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

enum { POINTS_MAX = 4000, D_MAX = 4 };

// A function on the unit cube.
typedef double function(const double *x, size_t d);

// Least, 0, at (0.3, 0.3 + 0.1, ...).
static double quadratic(const double *x, size_t d)
{
    double sum = 0.0;

    for (size_t k = 0; k < d; k++) {
        const double gap = x[k] - (0.3 + 0.1 * (double)k);
        sum += (1.0 + (double)k) * gap * gap;
    }
    return sum;
}

// Axes of 1 to 10^6.
static double ellipsoid(const double *x, size_t d)
{
    double sum = 0.0;

    for (size_t k = 0; k < d; k++)
        sum += pow(1e6, (double)k / ((double)d - 1.0)) * (x[k] - 0.4) * (x[k] - 0.4);
    return sum;
}

// On [-2, 2]^d; least, 0, at 1 in all coordinates: 3/4 of the cube.
static double rosenbrock(const double *x, size_t d)
{
    double sum = 0.0;

    for (size_t k = 0; k + 1 < d; k++) {
        const double a = 4.0 * x[k] - 2.0, b = 4.0 * x[k + 1] - 2.0;
        sum += 100.0 * (b - a * a) * (b - a * a) + (1.0 - a) * (1.0 - a);
    }
    return sum;
}

// Branin's function, with three least values of 0.397887 at (-pi, 12.275), (pi, 2.275), (9.42478, 2.475) on [-5, 10] x
// [0, 15].
static double branin(const double *x, size_t d)
{
    const double a = 15.0 * x[0] - 5.0, b = 15.0 * x[1];
    const double c = b - 5.1 / (4.0 * M_PI * M_PI) * a * a + 5.0 / M_PI * a - 6.0;

    return c * c + 10.0 * (1.0 - 1.0 / (8.0 * M_PI)) * cos(a) + 10.0;
}

// A corner of the cube; where no scenario is valid above 0.8.
static double corner(const double *x, size_t d)
{
    return x[0] > 0.8 ? (double)INFINITY : x[0] + 2.0 * x[1];
}

typedef struct trace {
    double points[POINTS_MAX * D_MAX];
    double values[POINTS_MAX];
    size_t n;
    size_t n_questions;
} trace;

static size_t best_of(const trace *t)
{
    size_t best = 0;

    for (size_t k = 1; k < t->n; k++)
        if (t->values[k] < t->values[best])
            best = k;
    return best;
}

static void go_on(trace *t, const search *s, function *f, size_t n_room, size_t n_max)
{
    const size_t n_before = t->n;
    size_t n = 1;

    while (n > 0 && t->n < n_max) {
        const search_known known = { t->n, t->points, t->values };
        bf_error err;
        assert_true(n_room <= POINTS_MAX - t->n);
        assert_int_equal(
            search_next(s, &known, t->n - n_before, n_room, t->points + t->n * s->d, &n, &err),
            BF_OK);
        t->n_questions++;
        for (size_t k = 0; k < n; k++, t->n++)
            t->values[t->n] = f(t->points + t->n * s->d, s->d);
    }
}

static trace asked;

// The least value lies in boxes of 3^-k; after 200 points k is 4 at least.
static void direct_finds_one_of_branins_least_values(void **state)
{
    asked.n = asked.n_questions = 0;
    go_on(&asked, &(search){ SEARCH_GLOBAL, 2, 200, NULL, 0, 0 }, branin, 64, POINTS_MAX);
    assert_int_equal(asked.n, 200);
    assert_true(asked.values[best_of(&asked)] < 0.397887 + 0.01);
    // The middle first, then two points along each parameter, a third of a side away from it.
    assert_true(asked.points[0] == 0.5 && asked.points[1] == 0.5);
    for (size_t k = 1; k < 5; k++)
        assert_near(fabs(asked.points[2 * k] - 0.5) + fabs(asked.points[2 * k + 1] - 0.5), 1.0 / 3,
                    1e-12);
    // Points that do not depend on each other come together.
    assert_true(asked.n_questions < 80);
}

static void subplex_goes_on_from_the_best_point(void **state)
{
    double start[2];
    asked.n = asked.n_questions = 0;
    go_on(&asked, &(search){ SEARCH_GLOBAL, 2, 60, NULL, 0, 0 }, branin, 64, POINTS_MAX);
    memcpy(start, asked.points + 2 * best_of(&asked), sizeof start);
    go_on(&asked, &(search){ SEARCH_LOCAL, 2, 150, start, 0.05, 1e-6 }, branin, 64, POINTS_MAX);
    assert_true(asked.n < 210);
    assert_near(asked.values[best_of(&asked)], 0.39788735772973816, 1e-9);
}

static void no_point_is_asked_for_twice(void **state)
{
    static const double start[3] = { 0.5, 0.5, 0.5 };
    asked.n = asked.n_questions = 0;
    go_on(&asked, &(search){ SEARCH_LOCAL, 3, 300, start, 0.2, 1e-5 }, quadratic, 16, POINTS_MAX);
    const double *best = asked.points + 3 * best_of(&asked);
    for (size_t k = 0; k < 3; k++)
        assert_near(best[k], 0.3 + 0.1 * (double)k, 1e-4);
    for (size_t i = 0; i < asked.n; i++)
        for (size_t k = 0; k < i; k++)
            assert_memory_not_equal(asked.points + 3 * i, asked.points + 3 * k, 3 * sizeof(double));
}

// Points that are evaluated at the same time are those of evaluating one by one: all but few. DIRECT's come
// by three and more.
static void few_points_are_evaluated_early_in_vain(void **state)
{
    static const double start[2] = { 0.2, 0.9 };
    static trace single;
    const search searches[] = { { SEARCH_GLOBAL, 2, 300, NULL, 0, 0 },
                                { SEARCH_LOCAL, 2, 300, start, 0.2, 1e-4 } };
    for (size_t s = 0; s < 2; s++) {
        single.n = asked.n = asked.n_questions = 0;
        go_on(&single, &searches[s], branin, 1, POINTS_MAX);
        go_on(&asked, &searches[s], branin, 8, POINTS_MAX);
        size_t n_found = 0;
        for (size_t i = 0; i < asked.n; i++)
            for (size_t k = 0; k < single.n; k++)
                n_found +=
                    memcmp(asked.points + 2 * i, single.points + 2 * k, 2 * sizeof(double)) == 0;
        assert_true(10 * n_found >= 9 * asked.n);
        assert_true(s == 1 || 3 * asked.n_questions < asked.n);
    }
}

static void points_without_a_value_are_left(void **state)
{
    static const double start[2] = { 0.7, 0.5 };
    asked.n = 0;
    go_on(&asked, &(search){ SEARCH_GLOBAL, 2, 80, NULL, 0, 0 }, corner, 8, POINTS_MAX);
    assert_true(asked.values[best_of(&asked)] < 0.05);
    asked.n = 0;
    go_on(&asked, &(search){ SEARCH_LOCAL, 2, 200, start, 0.2, 1e-6 }, corner, 8, POINTS_MAX);
    assert_true(asked.values[best_of(&asked)] < 1e-4);
}

// Generations until the best value is below the goal, and the state then.
static size_t evolve(cmaes *s, function *f, double goal, size_t generations_max)
{
    double points[CMAES_POPULATION * D_MAX], values[CMAES_POPULATION], least = INFINITY;

    while (s->generation < generations_max && least > goal) {
        cmaes_points(s, points);
        for (size_t k = 0; k < cmaes_population(s->d); k++) {
            values[k] = f(points + k * s->d, s->d);
            least = fmin(least, values[k]);
        }
        cmaes_update(s, values);
    }
    return s->generation;
}

// A ball in four dimensions needs some 15 generations for each power of 100 (Hansen, Ostermeier 2001, figure 2: some
// 100 lambda points for 10^-10); ellipsoids and Rosenbrock's valley some 5 to 10 times as many.
static void the_strategy_finds_least_values_within_published_budgets(void **state)
{
    const size_t d = 4;
    assert_int_equal(cmaes_population(d), 8);
    for (uint64_t seed = 1; seed <= 5; seed++) {
        cmaes s = cmaes_begin(seed, d);
        assert_true(evolve(&s, quadratic, 1e-10, 150) < 150);
        for (size_t k = 0; k < d; k++)
            assert_near(s.mean[k], 0.3 + 0.1 * (double)k, 1e-4);
        s = cmaes_begin(seed, d);
        assert_true(evolve(&s, ellipsoid, 1e-9, 500) < 500);
        // The matrix has learnt the axes, up to a factor: the longest by the shortest squared is 10^6.
        double least = INFINITY, most = 0.0;
        for (size_t k = 0; k < d; k++) {
            least = fmin(least, s.lengths[k]);
            most = fmax(most, s.lengths[k]);
        }
        assert_in_range(most / least, 300, 3000);
    }
    cmaes s = cmaes_begin(1, d);
    assert_true(evolve(&s, rosenbrock, 1e-8, 700) < 700);
    assert_near(s.mean[0], 0.75, 1e-3);
}

static void the_strategy_finds_corners_and_leaves_points_without_a_value(void **state)
{
    cmaes s = cmaes_begin(2, 2);
    assert_true(evolve(&s, corner, 1e-4, 150) < 150);
    s = cmaes_begin(2, 1);
    assert_true(evolve(&s, quadratic, 1e-10, 100) < 100);
    assert_true(evolve(&s, quadratic, -1.0, 300) == 300 && cmaes_is_converged(&s, 1e-6));
}

// B D^2 B' = C and B' B = 1, after generations in which values were arbitrary.
static void the_axes_of_the_matrix_are_its_eigenvectors(void **state)
{
    cmaes s = cmaes_begin(9, 20);
    double values[CMAES_POPULATION];
    for (size_t n = 0; n < 40; n++) {
        for (size_t k = 0; k < CMAES_POPULATION; k++)
            values[k] = (double)((7 * n + 5 * k) % 12);
        cmaes_update(&s, values);
    }
    for (size_t i = 0; i < 20; i++)
        for (size_t j = 0; j < 20; j++) {
            double c = 0.0, unit = 0.0;
            for (size_t k = 0; k < 20; k++) {
                c += s.axes[i][k] * s.lengths[k] * s.lengths[k] * s.axes[j][k];
                unit += s.axes[k][i] * s.axes[k][j];
            }
            assert_near(c, s.c[i][j], 1e-13);
            assert_near(unit, i == j, 1e-13);
        }
    assert_true(s.lengths[0] != s.lengths[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(direct_finds_one_of_branins_least_values),
        cmocka_unit_test(subplex_goes_on_from_the_best_point),
        cmocka_unit_test(no_point_is_asked_for_twice),
        cmocka_unit_test(few_points_are_evaluated_early_in_vain),
        cmocka_unit_test(points_without_a_value_are_left),
        cmocka_unit_test(the_strategy_finds_least_values_within_published_budgets),
        cmocka_unit_test(the_strategy_finds_corners_and_leaves_points_without_a_value),
        cmocka_unit_test(the_axes_of_the_matrix_are_its_eigenvectors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
