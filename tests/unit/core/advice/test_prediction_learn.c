// Predictions that learn: runs of a machine whose costs differ from those of the table.

#include "core/advice/prediction_learn.h"

#include "core/base/random.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

enum { RUNS = 64 }; // as many as the daemon learns from when it starts

static prediction_speed speed_of(double factor)
{
    prediction_speed speed = { 0 };

    for (size_t kind = 0; kind < PREDICTION_KIND_COUNT; kind++)
        speed.factors[kind] = factor;
    return speed;
}

// Work of the congested closure of 10 to 100 million cell steps, of which up to a tenth are a jam that takes 100 sweeps.
static prediction_work draw_work(bf_random *random)
{
    prediction_work work = { .kind = PREDICTION_CONGESTED };
    const double cell_steps = 1e7 * (1.0 + 9.0 * random_unit(random));

    work.amounts[PREDICTION_RUN] = 1.0;
    work.amounts[PREDICTION_CELL_STEPS] = cell_steps;
    work.amounts[PREDICTION_COVERED_STEPS] = cell_steps * random_unit(random);
    work.amounts[PREDICTION_RELAXED] = 100.0 * 0.1 * cell_steps * random_unit(random);
    return work;
}

// The truth: jams cost twice what the table says, the rest 0.8 of it.
static double seconds_of(const prediction_work *work)
{
    const prediction_speed speed = speed_of(1.0);
    double terms[PREDICTION_TERM_COUNT], seconds = 0.0;

    prediction_seconds_of_terms(work, &speed, terms);
    for (size_t i = 0; i < PREDICTION_TERM_COUNT; i++)
        seconds += terms[i] * (i == PREDICTION_RELAXED ? 2.0 : 0.8);
    return seconds;
}

static double worst_error(bf_random *random, const prediction_speed *speed)
{
    double worst = 0.0;

    for (size_t k = 0; k < 50; k++) {
        const prediction_work work = draw_work(random);
        worst = fmax(worst, fabs(log(prediction_seconds(&work, speed) / seconds_of(&work))));
    }
    return worst;
}

static void runs_correct_what_is_predicted_of_others(void **state)
{
    static prediction_learned learned;
    bf_random random;
    prediction_speed speed = speed_of(1.0);

    random_init(&random, 7);
    prediction_learn_begin(&learned);
    assert_true(worst_error(&random, &speed) > 0.5);
    for (size_t k = 0; k < RUNS; k++) {
        const prediction_work work = draw_work(&random);
        prediction_learn(&learned, &work, seconds_of(&work), &speed);
    }
    assert_int_equal(learned.n[PREDICTION_CONGESTED], RUNS);
    assert_true(worst_error(&random, &speed) < 0.1);
    for (size_t i = 0; i < PREDICTION_TERM_COUNT; i++)
        assert_true(speed.corrections[PREDICTION_ROE][i] == 0.0);
}

// A run that was hindered, by a hundred times, must not spoil what is known.
static void one_run_that_is_far_off_counts_little(void **state)
{
    static prediction_learned learned;
    bf_random random;
    prediction_speed speed = speed_of(1.0);

    random_init(&random, 8);
    prediction_learn_begin(&learned);
    for (size_t k = 0; k < 30; k++) {
        const prediction_work work = draw_work(&random);
        prediction_learn(&learned, &work, (k == 20 ? 100.0 : 1.0) * seconds_of(&work), &speed);
    }
    assert_true(worst_error(&random, &speed) < 0.2);
}

static void times_that_are_none_are_left_out(void **state)
{
    static const double none[] = { 0.0, -1.0, NAN, INFINITY };
    static prediction_learned learned;
    bf_random random;
    prediction_speed speed = speed_of(1.0);
    prediction_work work;

    random_init(&random, 9);
    prediction_learn_begin(&learned);
    work = draw_work(&random);
    for (size_t k = 0; k < sizeof none / sizeof *none; k++)
        prediction_learn(&learned, &work, none[k], &speed);
    work = (prediction_work){ .kind = PREDICTION_CONGESTED };
    prediction_learn(&learned, &work, 1.0, &speed);
    assert_int_equal(learned.n[PREDICTION_CONGESTED], 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(runs_correct_what_is_predicted_of_others),
        cmocka_unit_test(one_run_that_is_far_off_counts_little),
        cmocka_unit_test(times_that_are_none_are_left_out),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
