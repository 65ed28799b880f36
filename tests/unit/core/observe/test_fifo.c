// Unit tests of times inside by cumulative curves.

#include "core/observe/fifo.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static fifo begin(quantiles *times)
{
    fifo f;

    assert_int_equal(fifo_init(&f, NULL), BF_OK);
    assert_int_equal(quantiles_init(times, NULL), BF_OK);
    return f;
}

static void end(fifo *f, quantiles *times)
{
    fifo_fini(f);
    quantiles_fini(times);
}

// Entries at 2 parts/s from t = 0, exits of the same rate from t = 3: everyone stays 3 s.
static void a_delay_is_everyones_time(void **state)
{
    quantiles times;
    fifo f = begin(&times);
    for (int k = 0; k <= 40; k++) {
        const double t = 0.25 * k;
        fifo_sample(&f, t, 2.0 * t, 2.0 * fmax(t - 3.0, 0.0), &times);
    }
    assert_near(times.weight, 14.0, 1e-12);
    assert_near(times.min, 3.0, 1e-12);
    assert_near(times.max, 3.0, 1e-12);
    end(&f, &times);
}

// 10 parts are there at t = 0 and leave from 1 s to 2 s, evenly: times are uniform from 1 s to 2 s.
static void what_is_there_at_the_start_enters_then(void **state)
{
    quantiles times;
    fifo f = begin(&times);
    fifo_sample(&f, 0.0, 10.0, 0.0, &times);
    fifo_sample(&f, 1.0, 10.0, 0.0, &times);
    fifo_sample(&f, 2.0, 10.0, 10.0, &times);
    fifo_sample(&f, 3.0, 10.0, 10.0, &times);
    assert_near(times.weight, 10.0, 1e-14);
    assert_near(quantiles_mean(&times), 1.5, 1e-14);
    assert_near(quantiles_at(&times, 0.9), 1.9, 1e-12);
    end(&f, &times);
}

// Entries of 4 parts/s for 1 s, exits of 1 part/s from the start: the level u enters at u/4 and leaves at u, its
// time 3 u/4 is uniform from 0 to 3 s.
static void a_queue_grows_with_what_is_ahead(void **state)
{
    quantiles times;
    fifo f = begin(&times);
    fifo_sample(&f, 0.0, 0.0, 0.0, &times);
    fifo_sample(&f, 1.0, 4.0, 1.0, &times);
    fifo_sample(&f, 4.0, 4.0, 4.0, &times);
    assert_near(times.weight, 4.0, 1e-14);
    assert_near(times.max, 3.0, 1e-14);
    assert_near(quantiles_mean(&times), 1.5, 1e-14);
    assert_near(quantiles_at(&times, 0.25), 0.75, 1e-3);
    end(&f, &times);
}

// The exits of the first second are not wanted.
static void exits_can_be_left_out(void **state)
{
    quantiles times;
    fifo f = begin(&times);
    fifo_sample(&f, 0.0, 2.0, 0.0, NULL);
    fifo_sample(&f, 1.0, 2.0, 1.0, NULL);
    fifo_sample(&f, 2.0, 2.0, 2.0, &times);
    assert_near(times.weight, 1.0, 1e-14);
    assert_near(quantiles_mean(&times), 1.5, 1e-14); // from 1 s to 2 s
    end(&f, &times);
}

static void curves_that_fall_by_rounding_do_no_harm(void **state)
{
    quantiles times;
    fifo f = begin(&times);
    fifo_sample(&f, 0.0, 5.0, 0.0, &times);
    fifo_sample(&f, 1.0, 5.0 - 1e-15, -1e-15, &times);
    fifo_sample(&f, 2.0, 5.0, 5.0 + 1e-12, &times);
    fifo_sample(&f, 3.0, 6.0, 5.5, &times);
    assert_near(times.weight, 5.5, 1e-11);
    assert_true(times.min >= 0.0);
    end(&f, &times);
}

// 20,000 corners of a curve that bends at each, with nothing out until the end: more than there is room for. Mean entry
// of levels 0 .. u at t(u): E = t^2, t = sqrt(u); all leaves at T = 2000 at once: mean time T - 2/3 T = T/3.
static void many_corners_cost_resolution_alone(void **state)
{
    const double t_end = 2000.0;
    quantiles times;
    fifo f = begin(&times);
    for (int k = 0; k <= 20000; k++)
        fifo_sample(&f, 0.1 * k, 0.01 * k * k, 0.0, &times);
    assert_true(f.n <= FIFO_CORNERS);
    fifo_sample(&f, t_end, t_end * t_end, t_end * t_end, &times);
    assert_near(times.weight, t_end * t_end, 1e-6);
    assert_near(quantiles_mean(&times), t_end / 3.0, 1e-3);
    end(&f, &times);
}

static void a_checkpoint_goes_on_with_the_same_bits(void **state)
{
    bf_buffer bytes = { 0 };
    checkpoint_writer w;
    checkpoint_reader r;
    quantiles times, others;
    fifo f = begin(&times), copy = begin(&others);
    for (int k = 0; k < 50; k++)
        fifo_sample(&f, k, 3.0 * k, 0.5 * k, NULL);
    checkpoint_begin(&w, &bytes, CHECKPOINT_RUN, 1);
    fifo_save(&f, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, bytes.bytes, bytes.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
    assert_true(fifo_load(&copy, &r));
    assert_int_equal(r.n_left, 0);
    fifo_sample(&f, 60.0, 150.0, 100.0, &times);
    fifo_sample(&copy, 60.0, 150.0, 100.0, &others);
    assert_true(quantiles_mean(&times) == quantiles_mean(&others));
    assert_true(quantiles_at(&times, 0.9) == quantiles_at(&others, 0.9));
    buffer_fini(&bytes);
    end(&f, &times);
    end(&copy, &others);
}

static void no_memory_is_reported(void **state)
{
    fifo f;
    memory_plan_fault(1, 0);
    assert_int_equal(fifo_init(&f, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_delay_is_everyones_time),
        cmocka_unit_test(what_is_there_at_the_start_enters_then),
        cmocka_unit_test(a_queue_grows_with_what_is_ahead),
        cmocka_unit_test(exits_can_be_left_out),
        cmocka_unit_test(curves_that_fall_by_rounding_do_no_harm),
        cmocka_unit_test(many_corners_cost_resolution_alone),
        cmocka_unit_test(a_checkpoint_goes_on_with_the_same_bits),
        cmocka_unit_test(no_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
