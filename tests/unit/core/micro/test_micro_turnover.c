// Unit tests of parts that enter and leave during a run: handles, ids, departures, free places; and that results
// depend neither on threads nor on interruptions.

#include "core/base/checkpoint.h"
#include "core/base/memory.h"
#include "core/micro/body/implicit.h"
#include "core/micro/disk/implicit.h"
#include "tests/unit/core/helper_fed_belt.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

enum { DEPARTURES = 8 };

static const double speed = 1.0; // of the belt, m/s

// Takes all departures and asserts that they come in order of handles. Returns how many.
static size_t take(micro_solver *s)
{
    micro_departure left[DEPARTURES];
    size_t n = micro_take_departures(s, left, DEPARTURES);

    assert_true(n < DEPARTURES);
    for (size_t k = 0; k < n; k++) {
        assert_true(k == 0 || left[k].part > left[k - 1].part);
        assert_true(micro_is_gone(s, left[k].part));
        assert_true(left[k].id == micro_id_of(s, left[k].part));
        assert_true(left[k].at.x > 0.12 && left[k].at.y > 0.0 && left[k].at.y < 0.1);
    }
    return n;
}

// What a fed belt has seen.
typedef struct tally {
    size_t n_admitted;
    size_t n_left;
} tally;

// One tick: what left is taken; cylinders and others enter in the west, in three rows, where there is room.
static void tick(micro_solver *s, double time, tally *of)
{
    helper_fed_belt_run(s, time);
    of->n_left += take(s);
    for (int row = 0; row < 3; row++) {
        const uint32_t kind = (uint32_t)(of->n_admitted % 2);
        if (!helper_fed_belt_is_free(s, kind, 0.02, 0.02 + 0.03 * row, 0.0))
            continue;
        const size_t part = helper_fed_belt_admit(s, kind, 0.02, 0.02 + 0.03 * row);
        assert_true(micro_id_of(s, part) == of->n_admitted);
        of->n_admitted++;
    }
    assert_int_equal(micro_measure(s).n_parts, of->n_admitted - of->n_left);
}

static void handles_are_used_again_and_ids_never(void **state)
{
    for (int k = 0; k < HELPER_FED_BELT_SOLVERS; k++) {
        helper_fed_belt w;
        tally of = { 0, 0 };
        size_t most = 0;
        helper_fed_belt_init(&w, k);
        micro_solver *s = helper_fed_belt_start(&w);
        for (int t = 0; t < 80; t++) {
            tick(s, 0.01, &of);
            most = of.n_admitted - of.n_left > most ? of.n_admitted - of.n_left : most;
        }
        // 3 rows, 0.8 m of belt, parts of 18 to 30 mm.
        assert_in_range(of.n_admitted, 3 * 0.8 / 0.045, 3 * 0.8 / 0.02);
        assert_true(of.n_left > 30);
        assert_int_equal(micro_parts(s), most);
        micro_destroy(s);
    }
}

static void a_fed_belt_ends_with_the_same_bits_for_any_threads_and_interruption(void **state)
{
    for (int k = 0; k < HELPER_FED_BELT_SOLVERS; k++) {
        uint64_t expected = 0;
        helper_fed_belt w;
        helper_fed_belt_init(&w, k);
        w.def.n_obstacles = 1;
        for (int n_threads = 1; n_threads <= 2; n_threads++)
            // -1: it is not interrupted. Of less only two threads are.
            for (int stop = n_threads == 1 ? -1 : HELPER_AMOUNT(-1, 11); stop < 12;
                 stop += n_threads == 1 ? HELPER_AMOUNT(3, 20) : 20) {
                tally of = { 0, 0 };
                w.def.n_threads = n_threads;
                micro_solver *s = helper_fed_belt_start(&w);
                for (int t = 0; t < 14; t++) {
                    tick(s, 0.017, &of);
                    if (t != stop)
                        continue;
                    bf_buffer saved = { 0 };
                    assert_int_equal(micro_save(s, &saved, NULL), BF_OK);
                    micro_destroy(s);
                    s = helper_fed_belt_start(&w);
                    assert_int_equal(micro_load(s, saved.bytes, saved.n, NULL), BF_OK);
                    buffer_fini(&saved);
                }
                expected = expected == 0 ? micro_digest(s) : expected;
                assert_true(micro_digest(s) == expected);
                assert_true(of.n_left > 3);
                micro_destroy(s);
            }
    }
}

static void an_admitted_part_moves_like_one_of_the_definition(void **state)
{
    for (int k = 0; k < HELPER_FED_BELT_SOLVERS; k++) {
        helper_fed_belt w;
        helper_fed_belt_init(&w, k);
        w.def.n_obstacles = 1;
        micro_solver *fed = helper_fed_belt_start(&w);
        assert_int_equal(helper_fed_belt_admit(fed, 0, 0.03, 0.06), 0);
        w.poses[0] = (scene_pose){ 0.03, 0.06, 0.0 };
        w.def.n_parts = 1;
        micro_solver *defined = helper_fed_belt_start(&w);
        assert_true(micro_digest(fed) == micro_digest(defined));
        for (int t = 0; t < 5; t++) {
            helper_fed_belt_run(fed, 0.01);
            helper_fed_belt_run(defined, 0.01);
            assert_true(micro_digest(fed) == micro_digest(defined));
        }
        assert_true(fabs(micro_part_of(fed, 0).x[1] - 0.06) > 1e-3); // the plate deflects it
        micro_destroy(fed);
        micro_destroy(defined);
    }
}

static void departures_that_nobody_takes_keep_their_handles(void **state)
{
    for (int k = 0; k < HELPER_FED_BELT_SOLVERS; k++) {
        helper_fed_belt w;
        micro_departure left[2];
        helper_fed_belt_init(&w, k);
        micro_solver *s = helper_fed_belt_start(&w);
        for (int row = 0; row < 3; row++)
            assert_int_equal(helper_fed_belt_admit(s, 0, 0.11, 0.02 + 0.03 * row), row);
        helper_fed_belt_run(s, 0.02);
        assert_int_equal(micro_measure(s).n_parts, 0);
        assert_int_equal(helper_fed_belt_admit(s, 0, 0.02, 0.05), 3);
        assert_int_equal(micro_take_departures(s, left, 2), 2);
        assert_true(left[0].id == 0 && left[1].id == 1 && left[0].kind == 0);
        const micro_part last = micro_part_of(s, 0);
        assert_true(last.is_gone && last.x[0] == left[0].at.x && last.x[1] == left[0].at.y);
        assert_int_equal(helper_fed_belt_admit(s, 1, 0.06, 0.05), 0);
        assert_int_equal(micro_take_departures(s, left, 2), 1);
        assert_true(left[0].part == 2 && left[0].id == 2);
        assert_int_equal(micro_take_departures(s, left, 2), 0);
        assert_int_equal(helper_fed_belt_admit(s, 0, 0.02, 0.02), 1);
        assert_int_equal(helper_fed_belt_admit(s, 0, 0.02, 0.08), 2);
        assert_true(micro_id_of(s, 0) == 4 && micro_id_of(s, 1) == 5 && micro_id_of(s, 2) == 6);
        assert_int_equal(micro_parts(s), 4);
        micro_destroy(s);
    }
}

static void a_handle_can_be_used_again_at_once(void **state)
{
    for (int k = 0; k < HELPER_FED_BELT_SOLVERS; k++) {
        helper_fed_belt w;
        micro_departure left;
        helper_fed_belt_init(&w, k);
        w.poses[0] = (scene_pose){ 0.12 - 1e-6, 0.05, 0.0 };
        w.def.n_parts = 1;
        micro_solver *s = helper_fed_belt_start(&w);
        while (!micro_is_gone(s, 0))
            assert_int_equal(micro_advance(s, 1, NULL), BF_OK);
        assert_int_equal(micro_take_departures(s, &left, 1), 1);
        assert_int_equal(helper_fed_belt_admit(s, 1, 0.03, 0.06), 0);
        for (int n = 0; n < 3; n++) {
            const micro_part part = micro_part_of(s, 0);
            assert_false(part.is_gone);
            assert_true(fabs(part.x[0] - 0.03 - n * speed * micro_dt(s)) < 1e-6);
            assert_true(fabs(part.x[1] - 0.06) < 1e-9);
            assert_int_equal(micro_advance(s, 1, NULL), BF_OK);
        }
        micro_destroy(s);
    }
}

// Part 0 leaves in the first step, while it is in contact with part 1.
static void leave_in_contact(helper_fed_belt *w, const micro_backend *backend, int solver,
                             micro_common **ret_state)
{
    helper_fed_belt_init(w, solver);
    w->poses[0] = (scene_pose){ 0.1199, 0.05, 0.0 };
    w->poses[1] = (scene_pose){ 0.0960, 0.05, 0.0 };
    w->def.n_parts = 2;
    w->def.dt = 1e-3;
    assert_int_equal(backend->create(&w->def, ret_state, NULL), BF_OK);
    assert_int_equal(backend->advance(*ret_state, 1, NULL), BF_OK);
    assert_int_equal((*ret_state)->presence[0], MICRO_LEFT);
}

static void impulses_of_parts_that_left_are_erased(void **state)
{
    helper_fed_belt w;
    micro_common *own = NULL;

    leave_in_contact(&w, &micro__disk, 1, &own);
    const disk_state *disks = (const disk_state *)own;
    const implicit_state *z = disks->implicit;
    assert_int_equal(z->group[IMPLICIT_GROUPS], 1);
    assert_true(disk_implicit__pair(disks, z, &z->pieces[0], 0).normal > 0.0);
    micro__disk.forget_gone(own);
    const implicit_pair pair = disk_implicit__pair(disks, z, &z->pieces[0], 0);
    assert_true(pair.normal == 0.0 && pair.sliding == 0.0);
    micro__disk.destroy(own);

    leave_in_contact(&w, &micro__body, 3, &own);
    const body_state *bodies = (const body_state *)own;
    assert_int_equal(bodies->n_pairs, 1);
    assert_true(bodies->pairs[0].warm_start.key != 0);
    assert_true(bodies->implicit->warm_starts[0][0].key != 0); // of the belt
    assert_true(bodies->implicit->warm_starts[1][0].key != 0);
    micro__body.forget_gone(own);
    assert_int_equal(bodies->pairs[0].warm_start.key, 0);
    assert_int_equal(bodies->implicit->warm_starts[0][0].key, 0);
    assert_true(bodies->implicit->warm_starts[1][0].key != 0);
    micro__body.destroy(own);
}

static void there_is_a_limit_to_the_parts_at_a_time(void **state)
{
    const micro_arrival arrival = { 0, { 0.05, 0.05, 0.0 }, { speed, 0.0 } };
    helper_fed_belt w;
    size_t part = SIZE_MAX;
    bf_error err;

    helper_fed_belt_init(&w, 0);
    micro_solver *s = helper_fed_belt_start(&w);
    for (size_t k = 0; k < SCENE_PARTS_MAX; k++)
        assert_int_equal(micro_admit(s, &arrival, &part, NULL), BF_OK);
    assert_int_equal(part, SCENE_PARTS_MAX - 1);
    assert_int_equal(micro_admit(s, &arrival, &part, &err), BF_ELIMIT);
    assert_non_null(strstr(err.text, "1000000 parts at a time"));
    assert_int_equal(part, SCENE_PARTS_MAX - 1);
    assert_int_equal(micro_parts(s), SCENE_PARTS_MAX);
    micro_destroy(s);
}

enum { ROWS = 10 }; // of a square of parts, more than there is room for at first

// Admits a square of parts and lets them move a little. Every failure is BF_ENOMEM and changes nothing. Returns
// the first one.
static bf_status fill_square(micro_solver *s)
{
    bf_status first = BF_OK;
    bool is_free = false;

    for (int k = 0; k < ROWS * ROWS;) {
        const micro_arrival arrival = { 0,
                                        { 0.05 + 0.03 * (k % ROWS), 0.05 + 0.03 * (k / ROWS), 0.0 },
                                        { speed, 0.0 } };
        const uint64_t before = micro_digest(s);
        size_t part = SIZE_MAX;
        bf_status status = micro_is_free(s, 0, arrival.pose, &is_free, NULL);
        if (status == BF_OK)
            status = micro_admit(s, &arrival, &part, NULL);
        assert_true(status == BF_OK ? is_free && part == (size_t)k : micro_digest(s) == before);
        k += status == BF_OK;
        first = first == BF_OK ? status : first;
    }
    for (int n = 0; n < 4;) {
        const uint64_t steps = micro_steps(s);
        bf_status status = micro_advance(s, 1, NULL);
        n += micro_steps(s) > steps;
        first = first == BF_OK ? status : first;
    }
    return first;
}

static void without_memory_nobody_enters_and_nothing_is_lost(void **state)
{
    for (int k = 0; k < HELPER_FED_BELT_SOLVERS; k++) {
        uint64_t expected = 0;
        size_t n_failed = 0;
        helper_fed_belt w;
        helper_fed_belt_init(&w, k);
        w.def.domain = (scene_rect){ 0.0, 1.0, 0.0, 1.0 };
        for (size_t fault = 0;; fault++) {
            micro_solver *s = helper_fed_belt_start(&w);
            memory_plan_fault(fault, 0);
            bf_status status = fill_square(s);
            memory_plan_fault(0, 0);
            assert_true(status == BF_OK || status == BF_ENOMEM);
            expected = fault == 0 ? micro_digest(s) : expected;
            assert_true(micro_digest(s) == expected);
            micro_destroy(s);
            n_failed += status == BF_ENOMEM;
            if (fault > 0 && status == BF_OK)
                break;
        }
        assert_true(n_failed > 20);
    }
}

enum { ENVELOPE = 40, IDS = 64, OWN_IDS = 2 }; // bytes before the payload, before the ids; parts

// Writes a number into the payload of a checkpoint, and seals it again.
static bf_buffer forge(const bf_buffer *saved, size_t at, uint64_t value)
{
    bf_buffer forged = { 0 };
    checkpoint_writer w;
    uint32_t kind;
    uint64_t definition;

    memcpy(&kind, saved->bytes + 8, sizeof kind);
    memcpy(&definition, saved->bytes + 16, sizeof definition);
    checkpoint_begin(&w, &forged, (checkpoint_kind)kind, definition);
    checkpoint_write(&w, saved->bytes + ENVELOPE, saved->n - ENVELOPE);
    checkpoint_rewrite(&w, at, &value, sizeof value);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    return forged;
}

static void forged_handles_and_ids_are_refused(void **state)
{
    const struct {
        size_t at;
        uint64_t value;
        bf_status status;
    } forgeries[] = {
        { 0, OWN_IDS, BF_OK },            // number of handles: as it is
        { 0, OWN_IDS + 1, BF_ECORRUPT },  // more than parts
        { 0, OWN_IDS - 1, BF_ECORRUPT },  // fewer
        { 0, UINT64_MAX, BF_ECORRUPT },   // so many
        { 8, OWN_IDS - 1, BF_ECORRUPT },  // next id: below one that is in use
        { 8, UINT64_MAX, BF_OK },         // after many
        { 16, 1, BF_OK },                 // one that fell and was told
        { 16, OWN_IDS + 1, BF_ECORRUPT }, // more than there ever were
        { IDS, 1, BF_ECORRUPT },          // an id twice
        { IDS + 8, OWN_IDS, BF_ECORRUPT } // an id that comes next
    };

    for (int k = 0; k < HELPER_FED_BELT_SOLVERS; k++) {
        helper_fed_belt w;
        bf_buffer saved = { 0 };
        helper_fed_belt_init(&w, k);
        micro_solver *s = helper_fed_belt_start(&w);
        (void)helper_fed_belt_admit(s, 0, 0.02, 0.03);
        (void)helper_fed_belt_admit(s, 1, 0.02, 0.07);
        helper_fed_belt_run(s, 0.01);
        assert_int_equal(micro_save(s, &saved, NULL), BF_OK);
        for (size_t f = 0; f < sizeof forgeries / sizeof *forgeries; f++) {
            micro_solver *other = helper_fed_belt_start(&w);
            bf_buffer forged = forge(&saved, forgeries[f].at, forgeries[f].value);
            assert_int_equal(micro_load(other, forged.bytes, forged.n, NULL), forgeries[f].status);
            assert_true(forgeries[f].status != BF_OK || micro_parts(other) == OWN_IDS);
            buffer_fini(&forged);
            micro_destroy(other);
        }
        buffer_fini(&saved);
        micro_destroy(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(handles_are_used_again_and_ids_never),
        cmocka_unit_test(a_fed_belt_ends_with_the_same_bits_for_any_threads_and_interruption),
        cmocka_unit_test(an_admitted_part_moves_like_one_of_the_definition),
        cmocka_unit_test(departures_that_nobody_takes_keep_their_handles),
        cmocka_unit_test(a_handle_can_be_used_again_at_once),
        cmocka_unit_test(impulses_of_parts_that_left_are_erased),
        cmocka_unit_test(there_is_a_limit_to_the_parts_at_a_time),
        cmocka_unit_test(without_memory_nobody_enters_and_nothing_is_lost),
        cmocka_unit_test(forged_handles_and_ids_are_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
