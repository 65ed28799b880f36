// Example 1 with boxes: implicit steps in space against explicit ones.
//
// Contacts of boxes are chaotic: runs from starts that differ by a micrometre stray from their mean by
// 0.3 to 1.3 % of the parts. So means of several runs are compared, over the 6 s of the Example. Explicit runs take a
// minute each, so that their curve is stored here; this writes it:
//
//     build/release/tests/test_spatial_implicit --reference

#include "core/micro/micro.h"
#include "tests/unit/core/helper_outflow.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RUNS = 6, REFERENCE_RUNS = 6, BEGIN_SAMPLES = 16 };

// The sum of U(t) over the explicit runs, every 0.1 s, in steps of 0.02 ms.
static const double reference[HELPER_OUTFLOW_SAMPLES] = {
    1152, 1152, 1152, 1152, 1152, 1152, 1152, 1152, 1152, 1152, 1152, 1152, 1140, 1110, 1086, 1062,
    1032, 1005, 972,  938,  897,  861,  816,  783,  748,  713,  679,  644,  609,  582,  552,  524,
    501,  476,  453,  426,  403,  384,  366,  352,  336,  320,  306,  291,  279,  263,  249,  232,
    216,  195,  177,  161,  150,  136,  126,  115,  105,  97,   86,   76,   69,
};

static void set_up(helper_outflow *e, int run)
{
    helper_outflow_example(e, 60.0, 1e4);
    e->kind.shape =
        (scene_shape){ .type = SCENE_BOX, .length = 0.02, .width = 0.02, .height = 0.008 };
    for (int k = 0; k < HELPER_OUTFLOW_PARTS; k++)
        e->poses[k].y += 1e-6 * run * ((7 * k + 3 * run) % 5 - 2) / 5.0;
}

// The sum of U(t) over n runs of 6 s.
static void sum_up(micro_integrator integrator, double dt, int n_runs, double *ret_u)
{
    helper_outflow *e = malloc(sizeof *e);
    double u[HELPER_OUTFLOW_SAMPLES];

    assert_non_null(e);
    memset(ret_u, 0, sizeof u);
    for (int run = 0; run < n_runs; run++) {
        set_up(e, run);
        e->def.integrator = integrator;
        e->def.dt = dt;
        helper_outflow_curve(&e->def, 6.0, u);
        for (int k = 0; k < HELPER_OUTFLOW_SAMPLES; k++)
            ret_u[k] += u[k];
    }
    free(e);
}

static void boxes_flow_out_as_with_explicit_steps(void **state)
{
    double expected[HELPER_OUTFLOW_SAMPLES], u[HELPER_OUTFLOW_SAMPLES];

    sum_up(MICRO_IMPLICIT, 5e-4, RUNS, u);
    for (int k = 0; k < HELPER_OUTFLOW_SAMPLES; k++) {
        u[k] /= RUNS;
        expected[k] = reference[k] / REFERENCE_RUNS;
    }
    double gap = helper_outflow_gap(u, expected);
    printf("boxes, 0.5 ms against 0.02 ms: %.2f %% of N\n", 100.0 * gap);
    assert_true(expected[HELPER_OUTFLOW_SAMPLES - 1] < 0.1 * HELPER_OUTFLOW_PARTS);
    assert_true(gap < 0.01);
}

// Before chance matters, and in steps nearly twice as long: until 1.5 s, when 15 parts have passed.
static void the_stored_curve_is_that_of_explicit_steps(void **state)
{
    helper_outflow *e = malloc(sizeof *e);
    double u[HELPER_OUTFLOW_SAMPLES];

    assert_non_null(e);
    set_up(e, 0);
    e->def.integrator = MICRO_VERLET;
    e->def.dt = 0.025 / 650.0;
    helper_outflow_curve(&e->def, 1.5, u);
    for (int k = 0; k < BEGIN_SAMPLES; k++)
        assert_true(fabs(u[4 * k] - reference[k] / REFERENCE_RUNS) <= 1.0);
    assert_true(u[HELPER_OUTFLOW_SAMPLES - 1] < HELPER_OUTFLOW_PARTS - 10);
    free(e);
}

static void print_reference(void)
{
    double u[HELPER_OUTFLOW_SAMPLES];

    sum_up(MICRO_VERLET, 2e-5, REFERENCE_RUNS, u);
    for (int k = 0; k < HELPER_OUTFLOW_SAMPLES; k++)
        printf("%g, ", u[k]);
    printf("\n");
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_flow_out_as_with_explicit_steps),
        cmocka_unit_test(the_stored_curve_is_that_of_explicit_steps),
    };
    if (argc > 1 && strcmp(argv[1], "--reference") == 0) {
        print_reference();
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
