// The planar path as a program: threads, lists, memory and steps.

#include "core/base/buffer.h"
#include "core/base/digest.h"
#include "core/base/memory.h"
#include "core/micro/backend.h"
#include "core/micro/disk/disk_priv.h"
#include "core/micro/disk/kernels.h"
#include "tests/unit/core/helper_disk_state.h"
#include "tests/unit/core/helper_disks.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// 15 x 10 parts, some in touch from the start, run against a slanted plate; those behind it leave.
static helper_disks *make_crowd(void)
{
    helper_disks *d = helper_disks_make(0.6, 0.33, 0.395);

    d->path[0] = (vec2){ 0.30, 0.0 };
    d->path[1] = (vec2){ 0.42, 0.22 };
    helper_disks_block(d, 2, 0.005);
    helper_disks_fill(d, 11, 10, 0.03, 0.04, 0.0245, 0.0015);
    helper_disks_fill(d, 4, 10, 0.50, 0.04, 0.0275, 0.0015);
    return d;
}

// The same with three kinds, belts side by side and a gap between them, and contacts that pull.
static helper_disks *make_mix(void)
{
    static const vec2 south[4] = { { 0.0, 0.0 }, { 0.7, 0.0 }, { 0.7, 0.16 }, { 0.0, 0.16 } };
    static const vec2 north[4] = { { 0.0, 0.165 }, { 0.7, 0.165 }, { 0.7, 0.4 }, { 0.0, 0.4 } };
    helper_disks *d = make_crowd();

    d->belts[0] =
        (scene_belt){ .velocity = { 0.395, 0.05 }, .n_points = 4, .polygon = (vec2 *)south };
    d->belts[1] =
        (scene_belt){ .velocity = { 0.2, -0.1 }, .n_points = 4, .polygon = (vec2 *)north };
    d->def.n_belts = 2;
    d->def.n_kinds = 3;
    d->def.part_kinds = d->part_kinds;
    d->def.tension = true;
    d->def.start_velocity = (vec2){ 0.1, 0.1 };
    for (size_t k = 0; k < d->def.n_parts; k++) {
        d->part_kinds[k] = (uint32_t)(k * 7 % 3);
        d->poses[k].heading = 0.01 * (double)k;
    }
    return d;
}

// 56 x 56 parts make work for several threads; the list is rebuilt some 10 times.
static helper_disks *make_jam(void)
{
    helper_disks *d = helper_disks_make(2.0, 1.5, 0.395);

    d->path[0] = (vec2){ 1.40, 0.0 };
    d->path[1] = (vec2){ 1.50, 0.7 };
    d->path[2] = (vec2){ 1.40, 1.4 };
    helper_disks_block(d, 3, 0.005);
    helper_disks_fill(d, 56, 56, 0.02, 0.03, 0.0243, 0.0008);
    helper_disks_fill(d, 8, 8, 1.78, 0.1, 0.0275, 0.001);
    return d;
}

static uint64_t run_jam(int n_threads)
{
    helper_disks *d = make_jam();

    d->def.n_threads = n_threads;
    micro_solver *s = helper_disks_start(d);
    helper_disks_advance(s, HELPER_AMOUNT(1000, 300));
    helper_disks_advance(s, HELPER_AMOUNT(500, 100));
    uint64_t digest = micro_digest(s);
    micro_destroy(s);
    helper_disks_free(d);
    return digest;
}

static void any_number_of_threads_gives_the_same_bits(void **state)
{
    static const int numbers[] = { 2, 3, 7 };

    uint64_t one = run_jam(1);

    for (int k = HELPER_AMOUNT(0, 1); k < HELPER_AMOUNT(3, 2); k++)
        assert_true(run_jam(numbers[k]) == one);
}

// From where tanh(x) = x to where it is 1, both signs.
static void tanh_is_within_1e_12_of_libm(void **state)
{
    enum { N_VALUES = 4096 };
    static double x[N_VALUES], y[N_VALUES];

    for (int k = 0; k < N_VALUES; k++)
        x[k] = (k % 2 == 0 ? 1.0 : -1.0) * pow(10.0, -9.0 + 11.5 * k / N_VALUES);
    x[0] = 0.0;
    x[1] = INFINITY;
    for (cpu_level level = CPU_BASE; level <= cpu_best(); level++) {
        disk__explicit_kernels(level)->tanh_of(N_VALUES, x, y);
        assert_true(y[0] == 0.0);
        assert_near(y[1], 1.0, 1e-12);
        for (int k = 2; k < N_VALUES; k++)
            assert_near(y[k], tanh(x[k]), 1e-12 * fabs(tanh(x[k])));
    }
}

static void when_a_list_was_made_has_no_influence(void **state)
{
    micro_totals totals[2];
    uint64_t digest[2] = { DIGEST_START, DIGEST_START };

    for (int often = 0; often < 2; often++) {
        helper_disks *d = make_mix();
        disk_state *s = helper_disk_state_start(&d->def);
        for (int k = 0; k < 60; k++) {
            assert_int_equal(micro__disk.advance(s, 37, NULL), BF_OK);
            if (often)
                assert_int_equal(disk__rebuild(s, NULL), BF_OK);
        }
        for (size_t k = 0; k < d->def.n_parts; k++) {
            micro_part part = disk__part(s, k);
            digest[often] = digest_add(digest[often], &part, offsetof(micro_part, heading));
        }
        totals[often] = disk__measure(s);
        micro__disk.destroy(s);
        helper_disks_free(d);
    }
    assert_true(digest[0] == digest[1]);
    assert_int_equal(totals[0].n_parts, totals[1].n_parts);
    assert_int_equal(totals[0].n_contacts, totals[1].n_contacts);
    assert_true(totals[0].largest_overlap == totals[1].largest_overlap);
    assert_true(totals[0].overlap_share == totals[1].overlap_share);
}

// No pair in contact is missing from the list, however long it has been in use.
static void the_list_holds_every_contact(void **state)
{
    helper_disks *d = make_crowd();
    disk_state *s = helper_disk_state_start(&d->def);

    for (int k = 0; k < 40; k++) {
        size_t n_pressing = 0, n_listed = 0;
        assert_int_equal(micro__disk.advance(s, 29, NULL), BF_OK);
        for (size_t a = 0; a < s->n_live; a++) {
            for (size_t b = 0; b < s->n_live; b++)
                n_pressing +=
                    a != b && hypot(s->now[a].x - s->now[b].x, s->now[a].y - s->now[b].y) < 0.024;
            for (size_t row = 0; row < disk__n_rows(s, a); row++) {
                const disk *with = &s->now[disk__neighbour(s, a, row)];
                n_listed += hypot(s->now[a].x - with->x, s->now[a].y - with->y) < 0.024;
            }
        }
        assert_int_equal(n_listed, n_pressing);
        assert_true(n_pressing > 100);
    }
    assert_true(s->n_builds > 3);
    micro__disk.destroy(s);
    helper_disks_free(d);
}

// After a failure the run continues with the same results.
static void steps_and_checkpoints_without_memory_fail_and_can_be_repeated(void **state)
{
    helper_disks *d = make_mix();
    micro_solver *s = helper_disks_start(d), *untroubled = helper_disks_start(d);
    bf_buffer bytes = { 0 };

    for (int k = 0; k < HELPER_AMOUNT(300, 60); k++) {
        memory_plan_fault(1, 0);
        (void)!micro_advance(s, 20, NULL);
        memory_plan_fault(0, 0);
        helper_disks_advance(s, 20 * ((uint64_t)k + 1) - micro_steps(s));
    }
    helper_disks_advance(untroubled, micro_steps(s));
    assert_true(micro_digest(s) == micro_digest(untroubled));
    memory_plan_fault(1, 0);
    assert_int_equal(micro_save(s, &bytes, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_int_equal(bytes.n, 0);
    assert_int_equal(micro_save(s, &bytes, NULL), BF_OK);
    buffer_fini(&bytes);
    micro_destroy(s);
    micro_destroy(untroubled);
    helper_disks_free(d);
}

// The largest stable step is in the text, is itself accepted and keeps a jam together; it is chosen for
// dt = 0 with a margin.
static void the_largest_stable_step_is_stable(void **state)
{
    helper_disks *d = make_crowd();
    const double stable = micro_dt_stable(&d->def);
    micro_solver *s = NULL;
    bf_error err;

    // 6 d/m to either side for six neighbours that all move against a part; 2 d' dt < 4.
    assert_near(stable, 2.0 / (6.0 * 119.0 / d->kinds[0].mass), 0.02 * stable);
    d->def.dt = 2.0 * stable;
    assert_int_equal(micro_create(&d->def, &s, &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "the largest stable one is 7.8"));
    d->def.dt = stable;
    s = helper_disks_start(d);
    helper_disks_advance(s, 10000);
    assert_true(micro_measure(s).kinetic_energy < 0.5 * 150.0 * d->kinds[0].mass * 0.395 * 0.395);
    micro_destroy(s);
    d->def.dt = 0.0;
    s = helper_disks_start(d);
    assert_true(micro_dt(s) > 0.0 && micro_dt(s) <= stable);
    micro_destroy(s);
    helper_disks_free(d);
}

static void nobody_is_no_trouble(void **state)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.395);
    micro_solver *s = helper_disks_start(d);

    helper_disks_advance(s, 1000);
    assert_int_equal(micro_steps(s), 1000);
    assert_int_equal(micro_measure(s).n_parts, 0);
    micro_destroy(s);
    helper_disks_free(d);
}

// One part rests against a plate across a belt of 0.5 m/s. Rows that fill its group up ride the belt and
// would be 250 mm away in 0.5 s; the list, good for half a skin of 3 mm, is for the part alone.
static void the_list_of_a_part_at_rest_stays_valid(void **state)
{
    helper_disks *d = helper_disks_make(1.0, 0.2, 0.5);

    d->path[0] = (vec2){ 0.5, 0.0 };
    d->path[1] = (vec2){ 0.5, 0.2 };
    helper_disks_block(d, 2, 0.005);
    helper_disks_add(d, 0.48, 0.1);
    d->def.dt = 5e-5;
    for (int has_kinds = 0; has_kinds < 2; has_kinds++) {
        d->def.n_kinds = has_kinds ? 2 : 1;
        disk_state *s = helper_disk_state_start(&d->def);
        helper_disk_state_advance(s, 4000);
        uint64_t n_builds = s->n_builds;
        helper_disk_state_advance(s, 10000);
        assert_true(s->n_builds <= n_builds + 1);
        helper_disk_state_end(s);
    }
    helper_disks_free(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(tanh_is_within_1e_12_of_libm),
        cmocka_unit_test(when_a_list_was_made_has_no_influence),
        cmocka_unit_test(the_list_holds_every_contact),
        cmocka_unit_test(steps_and_checkpoints_without_memory_fail_and_can_be_repeated),
        cmocka_unit_test(the_largest_stable_step_is_stable),
        cmocka_unit_test(nobody_is_no_trouble),
        cmocka_unit_test(the_list_of_a_part_at_rest_stays_valid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
