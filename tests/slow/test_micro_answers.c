// The microscopic reference answers of the Examples: parts upstream, U(t), by explicit steps of 1e-5 s,
// as another implementation gave them once.
//
// Contacts are chaotic: a reference is one outcome of many, and so is a run of ours. Two outcomes agree
// when they are within 3 parts; the solver agrees with a reference when more of N_OUTCOMES outcomes do than do
// not, at each time; no more of them are made than decide it. Outcomes begin from places that are spread at random, by so little that nothing but chance is
// in them; what they are does not depend on rounding, as the outcome of a perfect lattice does, in
// which whole rows touch at once. Run with -V, the test prints how its outcomes lie.

#include "core/base/random.h"
#include "tests/unit/core/helper_outflow.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>

enum { N_TIMES = 6, N_OUTCOMES = 5 };

static const double times[N_TIMES] = { 1.5, 2.0, 3.0, 4.0, 5.0, 6.0 };
static const double t_end = 6.0;
static const double agreement = 3.0; // parts
static const double spread = 1e-6;   // of the places at the start, m

typedef struct answer {
    double angle_deg;
    double modulus_reduction;
    double u[N_TIMES]; // at those times
} answer;

static const answer answers[] = {
    { 60.0, 1e6, { 172, 139, 87, 50, 25, 9 } },
    { 60.0, 1e4, { 171, 146, 91, 49, 25, 9 } },
    { 90.0, 1e6, { 186, 173, 147, 133, 122, 114 } },
    { 90.0, 1e4, { 185, 174, 149, 131, 120, 111 } },
};

static double shift(bf_random *random)
{
    return spread * (2.0 * random_unit(random) - 1.0);
}

// One outcome: U at the times.
static void find_outcome(const answer *a, bf_random *random, double *ret_u)
{
    double u[HELPER_OUTFLOW_SAMPLES];
    helper_outflow example;

    helper_outflow_example(&example, a->angle_deg, a->modulus_reduction);
    for (int k = 0; k < HELPER_OUTFLOW_PARTS; k++) {
        example.poses[k].x += shift(random);
        example.poses[k].y += shift(random);
    }
    helper_outflow_curve(&example.def, t_end, u);
    for (int m = 0; m < N_TIMES; m++)
        ret_u[m] = u[lround(times[m] / t_end * (HELPER_OUTFLOW_SAMPLES - 1))];
}

// Outcomes at one time.
typedef struct tally {
    double least, most, sum;
    int n_agree;
} tally;

static bool is_decided(const tally *all)
{
    bool is = true;

    for (int m = 0; m < N_TIMES; m++)
        is = is && 2 * all[m].n_agree > N_OUTCOMES;
    return is;
}

static void check_answer(const answer *a)
{
    tally all[N_TIMES];
    bf_random random;
    int n = 0;

    random_init(&random, 1);
    for (int m = 0; m < N_TIMES; m++)
        all[m] = (tally){ .least = INFINITY, .most = -INFINITY };
    while (n < N_OUTCOMES && !is_decided(all)) {
        double u[N_TIMES];
        find_outcome(a, &random, u);
        n++;
        for (int m = 0; m < N_TIMES; m++) {
            all[m].least = fmin(all[m].least, u[m]);
            all[m].most = fmax(all[m].most, u[m]);
            all[m].sum += u[m];
            all[m].n_agree += fabs(u[m] - a->u[m]) <= agreement;
        }
    }
    print_message("%g degrees, reduction %g\n", a->angle_deg, a->modulus_reduction);
    for (int m = 0; m < N_TIMES; m++) {
        const tally *t = &all[m];
        print_message("  U(%.1f s): reference %3.0f, mean %5.1f, %.0f to %.0f, %d of %d agree\n",
                      times[m], a->u[m], t->sum / n, t->least, t->most, t->n_agree, n);
    }
    assert_true(is_decided(all));
}

static void most_outcomes_of_the_examples_agree_with_the_reference(void **state)
{
    for (size_t k = 0; k < sizeof answers / sizeof *answers; k++)
        check_answer(&answers[k]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(most_outcomes_of_the_examples_agree_with_the_reference),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
