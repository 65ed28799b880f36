// Several explicit steps in one pass: the same bits as single steps, whatever happens within.

#include "core/base/digest.h"
#include "core/base/memory.h"
#include "tests/unit/core/helper_disk_state.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// The west belt stops and starts by ramps, the east belt in jumps, within 40 ms.
static void let_belts_change(helper_disk_state *w)
{
    static double times[2][3] = { { 2e-3, 12e-3, 22e-3 }, { 3e-3, 5e-3, 30e-3 } };
    static double factors[2][3] = { { 0.0, 1.0, 0.5 }, { 0.0, 1.25, 1.0 } };

    for (int k = 0; k < 2; k++) {
        w->belts[k].acceleration = w->belts[k].deceleration = k == 0 ? 100.0 : INFINITY;
        w->belts[k].speed_schedule = (scene_speed_schedule){ 3, times[k], 3, factors[k] };
    }
}

// Parts that touch each other and a plate, change belts and leave.
static disk_state *start_crowd_on(bool changes, bool is_mixed, bool is_tiled, int n_threads)
{
    helper_disk_state *w = helper_disk_state_make(0.5, 0.9);

    helper_disk_state_crowd(w, is_mixed);
    if (changes)
        let_belts_change(w);
    w->def.n_threads = n_threads;
    disk_state *s = helper_disk_state_start(&w->def);
    free(w);
    if (is_tiled) {
        assert_int_equal(disk__tiling_init(s), BF_OK);
        assert_int_equal(disk__rebuild(s, NULL), BF_OK);
    }
    return s;
}

static disk_state *start_crowd(bool is_mixed, bool is_tiled, int n_threads)
{
    return start_crowd_on(false, is_mixed, is_tiled, n_threads);
}

static uint64_t digest_of(const disk_state *s)
{
    bf_buffer bytes = { 0 };
    checkpoint_writer w;

    checkpoint_begin(&w, &bytes, CHECKPOINT_DISK, 0);
    disk__save(s, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    uint64_t digest = digest_add(DIGEST_START, bytes.bytes, bytes.n);
    buffer_fini(&bytes);
    return digest;
}

static size_t count_gone(const disk_state *s)
{
    size_t n = 0;

    for (size_t k = 0; k < s->n; k++)
        n += s->common.presence[k];
    return n;
}

// Of less one kind of part on belts that do not change, and both on those that do.
static void compare_tiles_with_single_steps(bool changes)
{
    for (int is_mixed = HELPER_AMOUNT(0, changes); is_mixed < HELPER_AMOUNT(2, changes + 1);
         is_mixed++) {
        disk_state *single = start_crowd_on(changes, is_mixed, false, 1);
        helper_disk_state_advance(single, 803);
        assert_true(count_gone(single) > 0);
        for (int n_threads = HELPER_AMOUNT(1, 2); n_threads <= 2; n_threads++) {
            disk_state *tiled = start_crowd_on(changes, is_mixed, true, n_threads);
            helper_disk_state_advance(tiled, 803);
            assert_int_equal(tiled->common.steps, 803);
            assert_true(tiled->tiling.n_made > 20);
            assert_int_equal(digest_of(tiled), digest_of(single));
            assert_true(tiled->common.largest_overlap == single->common.largest_overlap);
            assert_true(tiled->common.overlap_share == single->common.overlap_share);
            helper_disk_state_end(tiled);
        }
        helper_disk_state_end(single);
    }
}

static void tiles_and_threads_give_the_bits_of_single_steps(void **state)
{
    compare_tiles_with_single_steps(false);
}

static void tiles_and_threads_give_the_bits_of_single_steps_on_belts_whose_speed_changes(
    void **state)
{
    compare_tiles_with_single_steps(true);
}

// The foremost part that has not left and has no plate before it.
static size_t find_front(const disk_state *s)
{
    size_t front = 0;
    double x = 0.0;

    for (size_t k = 0; k < s->n; k++) {
        const disk *row = &s->now[s->slot_of[k]];
        if (s->common.presence[k] == 0 && row->y > 0.65 && row->x > x) {
            x = row->x;
            front = k;
        }
    }
    return front;
}

// The jam when its foremost part is about to leave, at a time when the last speed makes a tile seem to
// fit; then that part is thrown out so fast that the list, good for 1.5 mm, does not hold for all of it.
static disk_state *start_burst_of_speed(bool is_mixed, bool is_tiled, double v)
{
    disk_state *s = start_crowd(is_mixed, is_tiled, 1);

    while (s->now[s->slot_of[find_front(s)]].x < 1.998 ||
           s->displacement_bound + 16.0 * s->last_bound > 0.5 * s->skin)
        helper_disk_state_advance(s, 1);
    helper_disk_state_push(s, find_front(s), v, 0.0, 0.0);
    return s;
}

static void a_tile_that_outlives_its_list_is_put_back(void **state)
{
    for (int is_mixed = 0; is_mixed < 2; is_mixed++) {
        disk_state *single = start_burst_of_speed(is_mixed, false, 12.0);
        disk_state *tiled = start_burst_of_speed(is_mixed, true, 12.0);
        uint64_t n_put_back = tiled->tiling.n_put_back;
        size_t n_gone = count_gone(single);
        helper_disk_state_advance(single, 8);
        helper_disk_state_advance(tiled, 8);
        assert_true(count_gone(single) > n_gone);
        assert_int_equal(tiled->tiling.n_put_back, n_put_back + 1);
        assert_int_equal(digest_of(tiled), digest_of(single));
        helper_disk_state_advance(single, 200);
        helper_disk_state_advance(tiled, 200);
        assert_int_equal(digest_of(tiled), digest_of(single));
        helper_disk_state_end(single);
        helper_disk_state_end(tiled);
    }
}

// 500 m/s are more than half a radius in a step.
static void a_failure_in_a_tile_is_reported_as_by_single_steps(void **state)
{
    disk_state *single = start_burst_of_speed(false, false, 500.0);
    disk_state *tiled = start_burst_of_speed(false, true, 500.0);
    bf_error of_single = { 0 }, of_tiled = { 0 };

    assert_int_equal(disk__advance_explicit(single, 8, &of_single), BF_ENUMERIC);
    assert_int_equal(disk__advance_explicit(tiled, 8, &of_tiled), BF_ENUMERIC);
    assert_string_equal(of_tiled.text, of_single.text);
    assert_int_equal(tiled->common.steps, single->common.steps);
    helper_disk_state_end(single);
    helper_disk_state_end(tiled);
}

static void no_memory_for_tiles_leaves_single_steps(void **state)
{
    disk_state *s = start_crowd(false, false, 1);

    for (size_t n = 1; n <= 3; n++) {
        memory_plan_fault(n, 0);
        assert_int_equal(disk__tiling_init(s), BF_ENOMEM);
        memory_plan_fault(0, 0);
        helper_disk_state_advance(s, 10);
        assert_int_equal(s->tiling.n_made, 0);
    }
    helper_disk_state_end(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tiles_and_threads_give_the_bits_of_single_steps),
        cmocka_unit_test(
            tiles_and_threads_give_the_bits_of_single_steps_on_belts_whose_speed_changes),
        cmocka_unit_test(a_tile_that_outlives_its_list_is_put_back),
        cmocka_unit_test(a_failure_in_a_tile_is_reported_as_by_single_steps),
        cmocka_unit_test(no_memory_for_tiles_leaves_single_steps),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
