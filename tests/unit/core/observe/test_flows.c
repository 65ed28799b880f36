// Flows out of counters have intervals as the throughput has.

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/observe/figures.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

enum { SAMPLES_IN_1_S = 4, WARM_UP = 10, TOO_SHORT = 15, LONG = 400, VALUES_MAX = 100 };

// A belt with a Poisson feed and two counters.
static void make_scene(scene *s)
{
    static const scene_pose pose = { 0.5, 0.3, 0.0 };

    helper_scene_belt(s, 1.0, 0.6, 0.005, &pose, 1);
    s->warmup = WARM_UP;
    (void)helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_POISSON, 2.0);
    s->n_counters = 2;
    s->counters = memory_alloc(2, sizeof *s->counters);
    for (size_t k = 0; k < 2; k++)
        scene_counter_init(&s->counters[k]);
    s->duration = LONG;
    helper_scene_resolve(s);
}

// Half of the samples one part has passed the first counter, and of these half, by lot, the second one: 2 and 1 in a second.
static void the_interval_of_a_flow_is_its_own_and_no_less_than_its_part_of_the_throughputs(
    void **state)
{
    scene s;
    figures *f = NULL;
    bf_random random;
    double flows[2] = { 0.0, 0.0 }, values[VALUES_MAX];

    make_scene(&s);
    assert_true(figure_values(&s) <= VALUES_MAX);
    assert_int_equal(figures_create(&s, true, &f, NULL), BF_OK);
    random_init(&random, 31);
    for (int k = 0; k <= SAMPLES_IN_1_S * LONG; k++) {
        const figures_now now = { .t = (double)k / SAMPLES_IN_1_S,
                                  .entered = flows[0],
                                  .exited = flows[0],
                                  .counters = (const double[]){ 0.0, 0.0 },
                                  .flows = flows,
                                  .feeds = &(feed_balance){ .offered = flows[0] } };
        figures_sample(f, &now);
        if (k == SAMPLES_IN_1_S * TOO_SHORT) {
            figures_fill(f, values);
            assert_true(values[figure_at(&s, FIGURE_FLOW, 0)] == values[FIGURE_THROUGHPUT]);
            assert_true(isnan(values[figure_at(&s, FIGURE_FLOW_ERROR, 0)]));
            assert_true(values[figure_at(&s, FIGURE_FLOW_NEEDS, 0)] ==
                        values[FIGURE_THROUGHPUT_NEEDS]);
        }
        const double n = random_unit(&random) < 0.5 ? 1.0 : 0.0;
        flows[0] += n;
        flows[1] += random_unit(&random) < 0.5 ? n : 0.0;
    }
    figures_fill(f, values);
    const double through = values[FIGURE_THROUGHPUT], error = values[FIGURE_THROUGHPUT_ERROR];
    const double flow = values[figure_at(&s, FIGURE_FLOW, 1)];
    const double of_flow = values[figure_at(&s, FIGURE_FLOW_ERROR, 1)];
    assert_true(error > 0.0 && values[figure_at(&s, FIGURE_FLOW, 0)] == through);
    assert_true(values[figure_at(&s, FIGURE_FLOW_ERROR, 0)] == error);
    assert_near(flow, 3600.0, of_flow);
    assert_true(of_flow >= flow / through * error);
    assert_true(isnan(values[figure_at(&s, FIGURE_FLOW_NEEDS, 1)]));
    figures_destroy(f);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            the_interval_of_a_flow_is_its_own_and_no_less_than_its_part_of_the_throughputs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
