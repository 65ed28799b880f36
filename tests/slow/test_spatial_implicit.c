// Example 1 with boxes: implicit steps in space against explicit ones.
//
// Contacts of boxes are chaotic: runs from starts that differ by a micrometre stray from their mean by
// 0.4 to 0.9 % of the parts. So means of several runs are compared, over the 6 s of the Example.

#include "core/micro/micro.h"
#include "tests/unit/core/helper_outflow.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RUNS = 4 };

static void average(micro_integrator integrator, double dt, double *ret_u)
{
    helper_outflow *e = malloc(sizeof *e);
    double u[HELPER_OUTFLOW_SAMPLES];

    assert_non_null(e);
    memset(ret_u, 0, sizeof u);
    for (int run = 0; run < RUNS; run++) {
        helper_outflow_example(e, 60.0, 1e4);
        e->kind.shape =
            (scene_shape){ .type = SCENE_BOX, .length = 0.02, .width = 0.02, .height = 0.008 };
        for (int k = 0; k < HELPER_OUTFLOW_PARTS; k++)
            e->poses[k].y += 1e-6 * run * ((7 * k + 3 * run) % 5 - 2) / 5.0;
        e->def.integrator = integrator;
        e->def.dt = dt;
        helper_outflow_curve(&e->def, 6.0, u);
        for (int k = 0; k < HELPER_OUTFLOW_SAMPLES; k++)
            ret_u[k] += u[k] / RUNS;
    }
    free(e);
}

static void boxes_flow_out_as_with_explicit_steps(void **state)
{
    double expected[HELPER_OUTFLOW_SAMPLES], u[HELPER_OUTFLOW_SAMPLES];

    (void)state;
    average(MICRO_VERLET, 2e-5, expected);
    average(MICRO_IMPLICIT, 5e-4, u);
    double gap = helper_outflow_gap(u, expected);
    printf("boxes, 0.5 ms against 0.02 ms: %.2f %% of N\n", 100.0 * gap);
    assert_true(expected[HELPER_OUTFLOW_SAMPLES - 1] < 0.1 * HELPER_OUTFLOW_PARTS);
    assert_true(gap < 0.01);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_flow_out_as_with_explicit_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
