// Unit tests of parts that pass a photo eye.

#include "core/observe/passages.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

enum { VALUES_MAX = 64 };

// A scene with one photo eye, and what it saw.
typedef struct fixture {
    scene s;
    figures *f;
    passages p;
} fixture;

static void begin(fixture *x)
{
    static const scene_pose pose = { 0.5, 0.3, 0.0 };
    const figures_now now = { .counters = (const double[]){ 0.0 } };

    *x = (fixture){ .f = NULL };
    helper_scene_belt(&x->s, 1.0, 0.6, 0.005, &pose, 1);
    x->s.n_eyes = 1;
    x->s.eyes = memory_alloc(1, sizeof *x->s.eyes);
    helper_scene_resolve(&x->s);
    assert_int_equal(figures_create(&x->s, true, &x->f, NULL), BF_OK);
    figures_sample(x->f, &now);
}

static void end(fixture *x)
{
    passages_fini(&x->p);
    figures_destroy(x->f);
    scene_fini(&x->s);
}

static double value(const fixture *x, figure_id id)
{
    double values[VALUES_MAX];

    assert_true(figure_values(&x->s) <= VALUES_MAX);
    figures_fill(x->f, values);
    return values[figure_at(&x->s, id, 0)];
}

// For how long the beam was free between two parts since the last tick.
static double see(fixture *x, double t, double belt_speed, size_t n, const passages_part *parts)
{
    const passages_view view = { belt_speed, n, parts };
    double is_free = NAN;

    assert_int_equal(passages_see(&x->p, t, &view, 0, x->f, &is_free, NULL), BF_OK);
    return is_free;
}

// A belt at 0.5 m/s, ticks of 0.1 s. Part 1 began 0.04 s before 0.1 s and ends 0.02 s after 0.2 s, at 0.22 s;
// part 2 begins 0.03 s before 0.4 s, at 0.37 s: a gap of 0.15 s, 75 mm.
static void crossings_lie_between_ticks(void **state)
{
    fixture x;
    begin(&x);
    (void)see(&x, 0.0, 0.5, 0, NULL);
    (void)see(&x, 0.1, 0.5, 1, (const passages_part[]){ { 1, 0.04, 0.12 } });
    (void)see(&x, 0.2, 0.5, 1, (const passages_part[]){ { 1, 0.14, 0.02 } });
    (void)see(&x, 0.3, 0.5, 0, NULL);
    (void)see(&x, 0.4, 0.5, 1, (const passages_part[]){ { 2, 0.03, 0.13 } });
    assert_near(value(&x, FIGURE_GAP_MEAN), 0.075, 1e-12);
    assert_near(value(&x, FIGURE_DOUBLES), 0.0, 0.0);
    end(&x);
}

// Part 7 ends at 0.12 s and part 3 begins at 0.15 s, both seen at the tick of 0.2 s: they do not overlap.
static void what_happens_between_two_ticks_is_put_in_order(void **state)
{
    fixture x;
    begin(&x);
    (void)see(&x, 0.0, 0.5, 0, NULL);
    (void)see(&x, 0.1, 0.5, 1, (const passages_part[]){ { 7, 0.05, 0.02 } });
    (void)see(&x, 0.2, 0.5, 1, (const passages_part[]){ { 3, 0.05, 0.1 } });
    assert_near(value(&x, FIGURE_GAP_MEAN), 0.015, 1e-12);
    assert_near(value(&x, FIGURE_DOUBLES), 0.0, 0.0);
    end(&x);
}

// Part 7 ends at 0.12 s, and part 3 begins at 0.15 s. Beside part 8, which breaks the beam at both ticks, that is no gap.
static void gaps_between_two_ticks_are_told(void **state)
{
    const passages_part seven = { 7, 0.05, 0.02 }, three = { 3, 0.05, 0.1 };
    fixture x;
    begin(&x);
    assert_near(see(&x, 0.0, 0.5, 0, NULL), 0.0, 0.0);
    assert_near(see(&x, 0.1, 0.5, 1, &seven), 0.0, 0.0); // free before it, not between two parts
    assert_near(see(&x, 0.2, 0.5, 1, &three), 0.03, 1e-12);
    assert_near(see(&x, 0.3, 0.5, 0, NULL), 0.0, 0.0);
    assert_near(see(&x, 0.4, 0.5, 2, (const passages_part[]){ seven, { 8, 0.1, 0.2 } }), 0.0, 0.0);
    assert_near(see(&x, 0.5, 0.5, 2, (const passages_part[]){ three, { 8, 0.2, 0.1 } }), 0.0, 0.0);
    end(&x);
}

// The belt stands: nothing is free, and no time is 0/0.
static void a_belt_that_stands_leaves_nothing_free(void **state)
{
    fixture x;
    begin(&x);
    (void)see(&x, 0.1, 0.0, 1,
              (const passages_part[]){ { 1, (double)INFINITY, (double)INFINITY } });
    assert_near(see(&x, 0.2, 0.0, 1, (const passages_part[]){ { 2, 0.0, (double)INFINITY } }), 0.0,
                0.0);
    end(&x);
}

// There and back by as much: the gap of two parts over a travel of 0 is no time.
static void a_belt_that_turns_back_leaves_nothing_free(void **state)
{
    const passages_part seven = { 7, 0.05, 0.02 }, three = { 3, 0.05, 0.1 };
    fixture x;
    begin(&x);
    (void)see(&x, 0.1, 0.5, 1, &seven);
    assert_near(see(&x, 0.2, -0.5, 1, &three), 0.0, 0.0);
    end(&x);
}

// Parts 1 and 2 break the beam together; 3 comes alone.
static void parts_side_by_side_are_doubles(void **state)
{
    fixture x;
    begin(&x);
    (void)see(&x, 0.0, 0.5, 0, NULL);
    (void)see(&x, 0.1, 0.5, 2, (const passages_part[]){ { 1, 0.04, 0.1 }, { 2, 0.02, 0.1 } });
    (void)see(&x, 0.2, 0.5, 1, (const passages_part[]){ { 2, 0.12, 0.0 } });
    (void)see(&x, 0.3, 0.5, 0, NULL);
    (void)see(&x, 0.4, 0.5, 1, (const passages_part[]){ { 3, 0.0, 0.1 } });
    assert_near(value(&x, FIGURE_DOUBLES), 0.666666666667, 1e-15);
    end(&x);
}

// The belt stops from 0.2 s to 5.2 s: of the gap counts what it moves, 0.05 m until 0.2 s with the ramps to and from 0, and
// 0.05 m until 5.4 s.
static void a_belt_that_stands_makes_no_gap(void **state)
{
    fixture x;
    begin(&x);
    (void)see(&x, 0.0, 0.5, 1, (const passages_part[]){ { 1, 0.0, 0.0 } });
    (void)see(&x, 0.1, 0.5, 0, NULL);                                       // ended at 0
    (void)see(&x, 0.2, 0.0, 0, NULL);                                       // 0.05 + 0.025 m
    (void)see(&x, 5.2, 0.0, 0, NULL);                                       // the same
    (void)see(&x, 5.3, 0.5, 0, NULL);                                       // 0.1 m
    (void)see(&x, 5.4, 0.5, 1, (const passages_part[]){ { 2, 0.0, 0.1 } }); // 0.15 m
    assert_near(value(&x, FIGURE_GAP_MEAN), 0.15, 1e-12);
    end(&x);
}

// A part that stands under the beam ends when it moves on: at the last tick at which it was there, at the earliest.
static void a_part_that_stands_has_no_end(void **state)
{
    fixture x;
    begin(&x);
    (void)see(&x, 0.0, 0.5, 0, NULL);
    (void)see(&x, 0.1, 0.5, 1,
              (const passages_part[]){ { 1, (double)INFINITY, (double)INFINITY } });
    (void)see(&x, 0.2, 0.5, 0, NULL);
    (void)see(&x, 0.3, 0.5, 1, (const passages_part[]){ { 2, 0.02, 0.1 } });
    assert_near(value(&x, FIGURE_GAP_MEAN), 0.04, 1e-12); // from 0.2 s to 0.28 s
    end(&x);
}

static void a_checkpoint_goes_on_with_the_same_passages(void **state)
{
    bf_buffer bytes = { 0 };
    checkpoint_writer w;
    checkpoint_reader r;
    fixture x;
    passages loaded = { .n = 0 };
    begin(&x);
    (void)see(&x, 0.0, 0.5, 0, NULL);
    (void)see(&x, 0.1, 0.4, 2, (const passages_part[]){ { 1, 0.04, 0.1 }, { 9, 0.02, 0.1 } });
    checkpoint_begin(&w, &bytes, CHECKPOINT_RUN, 1);
    passages_save(&x.p, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, bytes.bytes, bytes.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
    const checkpoint_reader all = r;
    assert_int_equal(passages_load(&loaded, &r, NULL), BF_OK);
    assert_int_equal(r.n_left, 0);
    assert_true(loaded.n == 2 && loaded.parts[1].id == 9 && loaded.parts[1].left == 0.1);
    assert_true(loaded.t == 0.1 && loaded.travel == x.p.travel && loaded.belt_speed == 0.4);
    for (size_t n = 0; n < all.n_left; n += 8) {
        r = (checkpoint_reader){ all.at, n };
        assert_int_equal(passages_load(&loaded, &r, NULL), BF_ECORRUPT);
    }
    passages_fini(&loaded);
    buffer_fini(&bytes);
    end(&x);
}

static void no_memory_is_reported(void **state)
{
    const passages_part part = { 1, 0.0, 0.1 };
    const passages_view view = { 0.5, 1, &part };
    double is_free;
    fixture x;
    begin(&x);
    for (size_t n = 1; n <= 2; n++) {
        memory_plan_fault(n, 0);
        assert_int_equal(passages_see(&x.p, 0.1, &view, 0, x.f, &is_free, NULL), BF_ENOMEM);
        memory_plan_fault(0, 0);
    }
    end(&x);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crossings_lie_between_ticks),
        cmocka_unit_test(what_happens_between_two_ticks_is_put_in_order),
        cmocka_unit_test(gaps_between_two_ticks_are_told),
        cmocka_unit_test(a_belt_that_stands_leaves_nothing_free),
        cmocka_unit_test(a_belt_that_turns_back_leaves_nothing_free),
        cmocka_unit_test(parts_side_by_side_are_doubles),
        cmocka_unit_test(a_belt_that_stands_makes_no_gap),
        cmocka_unit_test(a_part_that_stands_has_no_end),
        cmocka_unit_test(a_checkpoint_goes_on_with_the_same_passages),
        cmocka_unit_test(no_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
