// Reproducibility of explicit planar steps: the same bits for any number of threads, any instruction set and any
// interruption; and their behaviour without memory, with damaged bytes and with invalid input.

#include "core/base/memory.h"
#include "core/micro/disk/kernels.h"
#include "tests/unit/core/helper_disk_state.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 450 };

static helper_disk_state *make_crowd(bool is_mixed)
{
    helper_disk_state *w = helper_disk_state_make(0.395, 2.0);

    helper_disk_state_crowd(w, is_mixed);
    return w;
}

static micro_solver *start(const helper_disk_state *w, int n_threads)
{
    micro_def def = w->def;
    micro_solver *s = NULL;

    def.n_threads = n_threads;
    assert_int_equal(micro_create(&def, &s, NULL), BF_OK);
    return s;
}

static uint64_t digest_after(const helper_disk_state *w, int n_threads)
{
    micro_solver *s = start(w, n_threads);

    assert_int_equal(micro_advance(s, STEPS, NULL), BF_OK);
    assert_true(micro_measure(s).n_parts < micro_parts(s));
    assert_true(micro_measure(s).n_contacts > micro_parts(s) / 2);
    uint64_t digest = micro_digest(s);
    micro_destroy(s);
    return digest;
}

static void one_to_three_threads_give_the_same_bits(void **state)
{
    for (int is_mixed = 0; is_mixed < 2; is_mixed++) {
        helper_disk_state *w = make_crowd(is_mixed);
        uint64_t one = digest_after(w, 1);
        for (int n_threads = HELPER_AMOUNT(2, 3); n_threads <= 3; n_threads++)
            assert_true(digest_after(w, n_threads) == one);
        free(w);
    }
}

// One step of all parts by a table of kernels, into copies of what it writes.
static void step_with(const explicit_kernels *kernels, disk_state *s, disk *rows, double *heading,
                      driver_extremes *extremes)
{
    const explicit_step step = { .state = s,
                                 .belts = s->belts.of,
                                 .now = s->now,
                                 .next = rows,
                                 .heading = heading,
                                 .forces = s->list.forces,
                                 .dt = s->def.dt,
                                 .dt_force = s->def.dt,
                                 .damping_factor = 1.0 };

    *extremes = (driver_extremes){ 0 };
    memcpy(heading, s->heading, s->n_padded * sizeof *heading);
    memcpy(rows, s->now, s->n_padded * sizeof *rows);
    kernels->add_boundary_forces(&step, 0, s->n_candidates, extremes);
    kernels->advance(&step, 0, s->n_padded / DISK_GROUP, extremes);
}

static void check_builds(disk_state *s)
{
    const size_t n = s->n_padded;
    disk *rows = memory_alloc(2 * n, sizeof *rows);
    double *heading = memory_alloc(2 * n, sizeof *heading);
    driver_extremes extremes[2];

    assert_non_null(rows);
    assert_non_null(heading);
    assert_true(s->n_candidates > 0);
    for (cpu_level level = CPU_BASE; level <= cpu_best(); level++) {
        size_t set = level == CPU_BASE ? 0 : 1;
        step_with(disk__explicit_kernels(level), s, rows + set * n, heading + set * n,
                  &extremes[set]);
        assert_memory_equal(rows + set * n, rows, n * sizeof *rows);
        assert_memory_equal(heading + set * n, heading, n * sizeof *heading);
        // The sum only shows whether all is finite; its order is not specified.
        assert_true(extremes[set].speed2 == extremes[0].speed2);
        assert_true(extremes[set].overlap == extremes[0].overlap);
        assert_true(extremes[set].overlap_share == extremes[0].overlap_share);
    }
    memory_free(rows);
    memory_free(heading);
}

static void all_instruction_sets_give_the_same_bits(void **state)
{
    helper_outflow *e = malloc(sizeof *e);
    helper_disk_state *w = make_crowd(true);

    assert_non_null(e);
    helper_disk_state_jam(e, 60.0);
    double times[] = { 0.0, 1.0 }, angles[] = { 0.0, 0.5 };
    const micro_def *defs[] = { &e->def, &w->def }; // plain and not
    for (size_t k = 0; k < 4; k++) {
        micro_def def = *defs[k % 2];
        scene_obstacle turning = def.obstacles[0];
        turning.pivot = turning.path[0];
        turning.turn = (scene_series){ 2, times, 2, angles, INFINITY };
        if (k >= 2) {
            def.n_obstacles = 1;
            def.obstacles = &turning;
        }
        disk_state *s = helper_disk_state_start(&def);
        assert_int_equal(s->is_uniform, k % 2 == 0);
        assert_int_equal(s->plates.n, k / 2);
        helper_disk_state_advance(s, 100);
        check_builds(s);
        helper_disk_state_end(s);
    }
    free(e);
    free(w);
}

static void an_interrupted_run_ends_with_the_same_bits(void **state)
{
    const uint64_t stops[] = { 0, 1, 150, 449 };
    helper_disk_state *w = make_crowd(true);
    uint64_t expected = digest_after(w, 1);

    for (size_t k = 0; k < sizeof stops / sizeof *stops; k++) {
        bf_buffer saved = { 0 };
        micro_solver *s = start(w, 1), *resumed = start(w, 2);
        assert_int_equal(micro_advance(s, stops[k], NULL), BF_OK);
        assert_int_equal(micro_save(s, &saved, NULL), BF_OK);
        assert_int_equal(micro_load(resumed, saved.bytes, saved.n, NULL), BF_OK);
        assert_int_equal(micro_advance(resumed, STEPS - stops[k], NULL), BF_OK);
        assert_true(micro_digest(resumed) == expected);
        micro_destroy(s);
        micro_destroy(resumed);
        buffer_fini(&saved);
    }
    free(w);
}

// What a new solver makes of a state; it has then made ret_steps.
static bf_status load(helper_disk_state *w, const char *bytes, size_t n, uint64_t *ret_steps)
{
    micro_solver *s = start(w, 1);
    const bf_status status = micro_load(s, bytes, n, NULL);

    *ret_steps = micro_steps(s);
    micro_destroy(s);
    return status;
}

static void damaged_states_are_refused(void **state)
{
    helper_disk_state *w = make_crowd(false);
    bf_buffer saved = { 0 };
    uint64_t steps;

    w->def.n_parts = 20;
    micro_solver *s = start(w, 1);
    assert_int_equal(micro_advance(s, 5, NULL), BF_OK);
    assert_int_equal(micro_save(s, &saved, NULL), BF_OK);
    for (size_t k = 0; k < saved.n; k++) {
        saved.bytes[k] ^= 4;
        assert_int_equal(load(w, saved.bytes, saved.n, &steps), BF_ECORRUPT);
        saved.bytes[k] ^= 4;
        assert_int_equal(load(w, saved.bytes, k, &steps), BF_ECORRUPT);
    }
    assert_int_equal(load(w, saved.bytes, saved.n, &steps), BF_OK);
    assert_int_equal(steps, 5);
    micro_destroy(s);
    buffer_fini(&saved);
    free(w);
}

static void without_memory_nothing_is_lost(void **state)
{
    helper_disk_state *w = make_crowd(true);
    size_t n_failed = 0;

    w->def.n_parts = 44 * 4;
    w->def.n_obstacles = 0; // so that parts leave
    uint64_t expected = digest_after(w, 1);
    for (size_t fault = 1;; fault++) {
        micro_solver *s = NULL;
        bf_buffer saved = { 0 };
        memory_plan_fault(fault, 0);
        bf_status status = micro_create(&w->def, &s, NULL);
        assert_true(status == BF_OK || (status == BF_ENOMEM && s == NULL));
        if (status == BF_OK)
            status = micro_advance(s, STEPS, NULL);
        if (status == BF_OK)
            status = micro_save(s, &saved, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || (status == BF_ENOMEM && saved.n == 0));
        if (s != NULL) {
            assert_int_equal(micro_advance(s, STEPS - micro_steps(s), NULL), BF_OK);
            assert_true(micro_digest(s) == expected);
        }
        micro_destroy(s);
        buffer_fini(&saved);
        n_failed += status == BF_ENOMEM;
        if (status == BF_OK)
            break;
    }
    assert_true(n_failed > 20);
    free(w);
}

// The text of BF_ENUMERIC after steps of which one must fail.
static void advance_wrongly(disk_state *s, bf_error *err)
{
    assert_int_equal(disk__advance_explicit(s, 10, err), BF_ENUMERIC);
    assert_non_null(strstr(err->text, "step 3 (t = 0.00015 s)"));
    assert_non_null(strstr(err->text, "part 17 "));
}

static void an_impossible_state_is_reported_with_step_time_and_part(void **state)
{
    const double speeds[] = { 121.0, NAN, INFINITY }; // 4.5 mm in 50 us are 90 m/s, 6 mm 120 m/s

    for (size_t k = 0; k < 3; k++) {
        helper_disk_state *w = make_crowd(false);
        bf_error err = { 0 };
        disk_state *s = helper_disk_state_start(&w->def);
        helper_disk_state_advance(s, 2);
        helper_disk_state_push(s, 17, 0.0, -speeds[k], 0.0);
        w->def.n_obstacles = 0;
        advance_wrongly(s, &err);
        helper_disk_state_end(s);
        free(w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_to_three_threads_give_the_same_bits),
        cmocka_unit_test(all_instruction_sets_give_the_same_bits),
        cmocka_unit_test(an_interrupted_run_ends_with_the_same_bits),
        cmocka_unit_test(damaged_states_are_refused),
        cmocka_unit_test(without_memory_nothing_is_lost),
        cmocka_unit_test(an_impossible_state_is_reported_with_step_time_and_part),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
