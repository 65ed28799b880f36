// The microscopic reference answers of the Examples: parts upstream, U(t), by explicit steps of 1e-5 s,
// as another implementation gave them. Contacts are chaotic, and a reference is one outcome of many: it
// must lie within 3 parts of one of ours. In a perfect lattice whole rows touch at once, and rounding
// decides who comes first; so our outcomes begin from places that are spread by a micrometre.

#include "tests/unit/core/helper_outflow.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

enum { N_TIMES = 6, N_SPREADS = 4 };

static const double times[N_TIMES] = { 1.5, 2.0, 3.0, 4.0, 5.0, 6.0 };
static const double agreement = 3.0; // parts

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

// Sanitizers make a step twenty times as long; there the jam is followed while it forms.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
static const double t_end = 0.6; // before the first answer: only that all goes well
#else
static const double t_end = 6.0;
#endif

static double micrometre(void)
{
    return 1e-6 * (2.0 * rand() / RAND_MAX - 1.0);
}

// The distance from each answer of the nearest outcome, parts.
static void nearest_outcomes(const answer *a, double *ret_distance)
{
    for (int m = 0; m < N_TIMES; m++)
        ret_distance[m] = INFINITY;
    srand(1);
    for (int spread = 0; spread < N_SPREADS; spread++) {
        helper_outflow example;
        double u[HELPER_OUTFLOW_SAMPLES];
        helper_outflow_example(&example, a->angle_deg, a->modulus_reduction);
        for (int k = 0; k < HELPER_OUTFLOW_PARTS; k++) {
            example.poses[k].x += micrometre();
            example.poses[k].y += micrometre();
        }
        helper_outflow_curve(&example.def, t_end, u);
        for (int m = 0; m < N_TIMES && times[m] <= t_end; m++) {
            long sample = lround(times[m] / t_end * (HELPER_OUTFLOW_SAMPLES - 1));
            ret_distance[m] = fmin(ret_distance[m], fabs(u[sample] - a->u[m]));
        }
    }
}

static void the_examples_give_the_reference_answers(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof answers / sizeof *answers; k++) {
        double distance[N_TIMES];
        nearest_outcomes(&answers[k], distance);
        for (int m = 0; m < N_TIMES && times[m] <= t_end; m++)
            if (distance[m] > agreement)
                fail_msg("%g degrees, reduction %g: U(%g s) is %g parts from %g",
                         answers[k].angle_deg, answers[k].modulus_reduction, times[m], distance[m],
                         answers[k].u[m]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_examples_give_the_reference_answers),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
