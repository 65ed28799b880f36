// Reproducibility of implicit steps: the same bits for any number of threads, any instruction set
// and any interruption; and their behaviour without memory or with damaged bytes.

#include "core/base/memory.h"
#include "core/micro/disk/implicit.h"
#include "core/micro/micro.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 48, COLUMNS = 60, CROWD = ROWS * COLUMNS, STEPS = 90 };

// A jam that a belt drives against a plate and, past its end, out of the domain. Larger than two
// threads' least partitions, with parts of two sizes.
typedef struct scenery {
    micro_def def;
    scene_belt belt;
    scene_obstacle obstacle;
    vec2 path[3];
    micro_kind kinds[2];
    scene_pose poses[CROWD];
    uint32_t part_kinds[CROWD];
} scenery;

static scenery *make_scenery(void)
{
    scenery *w = calloc(1, sizeof *w);

    assert_non_null(w);
    w->def = micro_def_default();
    w->def.integrator = MICRO_IMPLICIT;
    w->def.dt = 1e-3;
    w->def.domain = (scene_rect){ 0.0, 1.48, 0.0, 1.2 };
    w->belt.velocity = (vec2){ 0.395, 0.02 };
    w->path[0] = (vec2){ 1.467, 0.0 };
    w->path[1] = (vec2){ 1.470, 0.5 };
    w->path[2] = (vec2){ 1.472, 0.9 };
    w->obstacle = (scene_obstacle){ .n_points = 3, .path = w->path, .thickness = 0.005 };
    for (int k = 0; k < 2; k++) {
        double r = k == 0 ? 0.012 : 0.009;
        w->kinds[k].shape = (scene_shape){ .type = SCENE_CYLINDER, .radius = r, .height = 0.008 };
        w->kinds[k].material = (scene_material){ 210e9, 0.28 };
        w->kinds[k].mass = 7850.0 * M_PI * r * r * 0.008;
        w->kinds[k].spin_radius = 2.0 / 3.0 * r;
    }
    for (int k = 0; k < CROWD; k++) {
        int row = k / COLUMNS, column = k % COLUMNS;
        w->poses[k].x = 0.03 + 0.0239 * (column + 0.5 * (row % 2));
        w->poses[k].y = 0.02 + 0.0239 * sqrt(0.75) * row;
        w->part_kinds[k] = k % 7 == 0;
    }
    w->def.n_belts = w->def.n_obstacles = 1;
    w->def.belts = &w->belt;
    w->def.obstacles = &w->obstacle;
    w->def.n_kinds = 2;
    w->def.kinds = w->kinds;
    w->def.n_parts = CROWD;
    w->def.poses = w->poses;
    w->def.part_kinds = w->part_kinds;
    return w;
}

static micro_solver *start(const scenery *w, int n_threads)
{
    micro_def def = w->def;
    micro_solver *s = NULL;

    def.n_threads = n_threads;
    assert_int_equal(micro_create(&def, &s, NULL), BF_OK);
    return s;
}

static void one_and_two_threads_give_the_same_bits(void **state)
{
    scenery *w = make_scenery();
    micro_solver *one = start(w, 1), *two = start(w, 2);

    assert_int_equal(micro_advance(one, STEPS, NULL), BF_OK);
    assert_int_equal(micro_advance(two, STEPS, NULL), BF_OK);
    assert_true(micro_measure(one).n_contacts > CROWD / 4);
    assert_true(micro_measure(one).n_parts < CROWD);
    assert_true(micro_digest(one) == micro_digest(two));
    micro_destroy(one);
    micro_destroy(two);
    free(w);
}

static void steps_one_by_one_give_the_bits_of_steps_in_a_row(void **state)
{
    scenery *w = make_scenery();
    micro_solver *row = start(w, 1), *single = start(w, 1);

    assert_int_equal(micro_advance(row, STEPS, NULL), BF_OK);
    for (int k = 0; k < STEPS; k++)
        assert_int_equal(micro_advance(single, 1, NULL), BF_OK);
    assert_true(micro_digest(row) == micro_digest(single));
    micro_destroy(row);
    micro_destroy(single);
    free(w);
}

// Saves after n steps and goes on to STEPS in a new solver on two threads, saving there again.
static uint64_t interrupt(const scenery *w, uint64_t n)
{
    bf_buffer first = { 0 }, second = { 0 };
    micro_solver *s = start(w, 1), *resumed = start(w, 2);

    assert_int_equal(micro_advance(s, n, NULL), BF_OK);
    assert_int_equal(micro_save(s, &first, NULL), BF_OK);
    assert_int_equal(micro_load(resumed, first.bytes, first.n, NULL), BF_OK);
    assert_true(micro_digest(s) == micro_digest(resumed));
    assert_int_equal(micro_save(resumed, &second, NULL), BF_OK);
    assert_int_equal(first.n, second.n);
    assert_memory_equal(first.bytes, second.bytes, first.n);
    assert_int_equal(micro_advance(resumed, STEPS - n, NULL), BF_OK);
    uint64_t digest = micro_digest(resumed);
    micro_destroy(s);
    micro_destroy(resumed);
    buffer_fini(&first);
    buffer_fini(&second);
    return digest;
}

static void an_interrupted_run_ends_with_the_same_bits(void **state)
{
    scenery *w = make_scenery();
    micro_solver *s = start(w, 1);

    assert_int_equal(micro_advance(s, STEPS, NULL), BF_OK);
    const uint64_t stops[] = { 0, 1, 37, 61, 62, 63, 64, 65, 66 };
    for (size_t k = 0; k < sizeof stops / sizeof *stops; k += HELPER_AMOUNT(1, 3))
        assert_true(interrupt(w, stops[k]) == micro_digest(s));
    micro_destroy(s);
    free(w);
}

static void a_part_with_more_neighbours_than_colours_has_forces_of_all(void **state)
{
    // A disk of 0.3 m amid 64 small ones, evenly around it and moving with it: it stays where it is.
    scenery *w = make_scenery();
    enum { AROUND = 64 };

    w->kinds[0].shape.radius = 0.3;
    w->kinds[0].mass = 17.0;
    w->def.n_obstacles = 0;
    w->def.damping = 0.0;
    w->def.n_parts = AROUND + 1;
    w->poses[0] = (scene_pose){ 0.6, 0.6, 0.0 };
    w->part_kinds[0] = 0;
    for (int k = 1; k <= AROUND; k++) {
        double angle = 2.0 * M_PI * k / AROUND, distance = 0.3 + 0.009 - 1e-4;
        w->poses[k] = (scene_pose){ 0.6 + distance * cos(angle), 0.6 + distance * sin(angle), 0.0 };
        w->part_kinds[k] = 1;
    }
    micro_solver *s = start(w, 1);
    assert_int_equal(micro_measure(s).n_contacts, AROUND);
    assert_int_equal(micro_advance(s, 100, NULL), BF_OK);
    assert_true(fabs(micro_part_of(s, 0).x[0] - (0.6 + 0.1 * 0.395)) < 1e-6);
    for (size_t k = 1; k <= AROUND; k++) {
        micro_part big = micro_part_of(s, 0), part = micro_part_of(s, k);
        double distance = hypot(part.x[0] - big.x[0], part.x[1] - big.x[1]);
        assert_true(distance > 0.3 + 0.009 - 0.9e-4);
    }
    micro_destroy(s);
    free(w);
}

static void without_memory_nothing_is_lost(void **state)
{
    scenery *w = make_scenery();
    uint64_t expected = 0;

    w->def.n_parts = 200;
    for (size_t fault = 0;; fault++) {
        bf_buffer saved = { 0 };
        micro_solver *s = start(w, 1);
        memory_plan_fault(fault, 0);
        bf_status status = micro_advance(s, 20, NULL);
        bf_status save_status = micro_save(s, &saved, NULL);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || status == BF_ENOMEM);
        assert_true(save_status == BF_OK || (save_status == BF_ENOMEM && saved.n == 0));
        assert_int_equal(micro_advance(s, 20 - micro_steps(s), NULL), BF_OK);
        expected = fault == 0 ? micro_digest(s) : expected;
        assert_true(micro_digest(s) == expected);
        micro_destroy(s);
        buffer_fini(&saved);
        if (fault > 0 && n_faults == 0)
            break;
    }
    free(w);
}

// A planar state with the members that saving and loading read: 4 parts, 2 features.
static disk_state make_bare_state(void)
{
    disk_state s = {
        .n = 4, .capacity = 4, .n_faces = 1, .n_arcs = 1, .void_slot = 16, .radius_min = 0.01
    };

    s.def.dt = 1e-3;
    s.def.integrator = MICRO_IMPLICIT;
    s.implicit = disk_implicit__create(&s);
    assert_non_null(s.implicit);
    return s;
}

// Part 0 touches feature 0, parts 0 and 1 and parts 2 and 3 are of one colour.
static bf_buffer save_sound(disk_state *s)
{
    const implicit_pair pairs[] = { { .id = { 0, IMPLICIT_FEATURE }, .normal = 1.0 },
                                    { .id = { 0, 1 }, .normal = 2.0, .sliding = -1.0 },
                                    { .id = { 2, 3 } } };
    size_t group[IMPLICIT_GROUPS + 1] = { 0 };
    implicit_state *z = s->implicit;
    bf_buffer bytes = { 0 };

    for (size_t g = 1; g <= IMPLICIT_GROUPS; g++)
        group[g] = g <= IMPLICIT_BOUNDARY ? 1 : 3;
    assert_int_equal(disk_implicit__cut(s, z, group, NULL), BF_OK);
    disk_implicit__set_pair(z, &z->pieces[0], 0, &pairs[0]);
    disk_implicit__set_pair(z, &z->pieces[1], 0, &pairs[1]);
    disk_implicit__set_pair(z, &z->pieces[1], 1, &pairs[2]);
    z->is_chosen = true;
    checkpoint_writer w = { .out = &bytes };
    disk_implicit__save(s, &w);
    assert_false(w.has_failed);
    return bytes;
}

static bf_status load(disk_state *s, const char *bytes, size_t n)
{
    disk__implicit_fini(s);
    return disk_implicit__load(s, &(checkpoint_reader){ bytes, n }, NULL);
}

static void pairs_that_cannot_be_are_refused(void **state)
{
    enum { FEATURE = IMPLICIT_FEATURE };
    const uint32_t impossible[][3][2] = {
        { { 0, FEATURE + 2 }, { 0, 1 }, { 2, 3 } }, // no such feature
        { { 9, FEATURE }, { 0, 1 }, { 2, 3 } },     // no such part
        { { 0, FEATURE }, { 0, 4 }, { 2, 3 } },     // nor as the second one
        { { 0, FEATURE }, { 1, 0 }, { 2, 3 } },     // numbers do not rise
        { { 0, FEATURE }, { 0, 1 }, { 1, 3 } },     // a part twice in a colour
        { { 0, 1 }, { 0, 1 }, { 2, 3 } },           // parts among the contacts with the boundary
        { { 0, FEATURE }, { 0, FEATURE + 1 }, { 2, 3 } }, // a touch among the parts
    };
    disk_state s = make_bare_state();
    bf_buffer sound = save_sound(&s);
    size_t first = sound.n - 3 * (2 * sizeof(uint32_t) + 2 * sizeof(double));

    for (size_t k = 0; k < sizeof impossible / sizeof *impossible; k++) {
        bf_buffer bad = { 0 };
        assert_int_equal(buffer_append(&bad, sound.bytes, sound.n), BF_OK);
        for (size_t p = 0; p < 3; p++)
            memcpy(bad.bytes + first + p * 24, impossible[k][p], 2 * sizeof(uint32_t));
        assert_int_equal(load(&s, bad.bytes, bad.n), BF_ECORRUPT);
        buffer_fini(&bad);
    }
    assert_int_equal(load(&s, sound.bytes, sound.n), BF_OK);
    const implicit_state *z = s.implicit;
    assert_int_equal(z->group[IMPLICIT_GROUPS], 3);
    const implicit_pair pair = disk_implicit__pair(&s, z, &z->pieces[1], 0);
    assert_true(pair.normal == 2.0 && pair.sliding == -1.0);
    disk__implicit_fini(&s);
    buffer_fini(&sound);
}

static void bytes_of_another_length_are_refused(void **state)
{
    disk_state s = make_bare_state();
    bf_buffer sound = save_sound(&s);

    for (size_t n = 1; n < sound.n; n++)
        assert_int_equal(load(&s, sound.bytes, n), BF_ECORRUPT);
    assert_int_equal(load(&s, NULL, 0), BF_OK);
    assert_null(s.implicit);
    buffer_fini(&sound);
}

// One block, its contacts and its bodies.
typedef struct block_case {
    _Alignas(64) implicit_block block;
    _Alignas(64) implicit_contacts contacts;
    _Alignas(64) implicit_law law;
    _Alignas(64) solver_body bodies[2 * IMPLICIT_WIDTH];
} block_case;

// Of no particular meaning, but of plausible magnitudes.
static void fill_case(block_case *c)
{
    for (uint32_t k = 0; k < 2 * IMPLICIT_WIDTH; k++)
        c->bodies[k] = (solver_body){ sin(k), cos(3 * k), sin(5 * k), 2e5 + 1e4 * k };
    for (uint32_t k = 0; k < IMPLICIT_WIDTH; k++) {
        c->block.row[0][k] = 4 * k;
        c->block.row[1][k] = 4 * (2 * IMPLICIT_WIDTH - 1 - k);
        c->block.normal[k] = 1e-3 * k;
        c->block.sliding[k] = 1e-4 * k;
        c->contacts.nx[k] = cos(k);
        c->contacts.ny[k] = sin(k);
        c->contacts.overlap[k] = 1e-3 * sin(7 * k);
        c->law.joint[k] = 2.0 + 0.1 * k;
        c->law.damping[k] = 1.0;
        c->law.scale[k] = 0.5;
        c->law.gain[k] = 0.01 + 1e-3 * k;
        c->law.lower_bound[k] = k == 3 ? -HUGE_VAL : 0.0;
        c->law.friction[k] = 0.1 + 0.01 * k;
        c->law.rate[k] = 10.0;
        c->law.radius[0][k] = 0.012;
        c->law.radius[1][k] = 0.011;
        c->law.inv_mass[0][k] = 30.0 + k;
        c->law.inv_mass[1][k] = 40.0 + k;
    }
}

static void all_instruction_sets_give_the_same_bits(void **state)
{
    block_case *cases = memory_alloc(2, sizeof *cases);

    assert_non_null(cases);
    for (cpu_level level = CPU_BASE; level <= cpu_best(); level++) {
        const implicit_kernels *kernels = disk__implicit_kernels(level);
        block_case *c = &cases[level == CPU_BASE ? 0 : 1];
        const implicit_blocks one = { 1, &c->block, &c->contacts, &c->law, false, 0.4 };
        fill_case(c);
        kernels->warm_start(c->bodies, &one);
        for (int iteration = 0; iteration < 3; iteration++)
            kernels->solve(c->bodies, &one);
        assert_memory_equal(c, cases, sizeof *c);
    }
    memory_free(cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_and_two_threads_give_the_same_bits),
        cmocka_unit_test(steps_one_by_one_give_the_bits_of_steps_in_a_row),
        cmocka_unit_test(an_interrupted_run_ends_with_the_same_bits),
        cmocka_unit_test(a_part_with_more_neighbours_than_colours_has_forces_of_all),
        cmocka_unit_test(without_memory_nothing_is_lost),
        cmocka_unit_test(pairs_that_cannot_be_are_refused),
        cmocka_unit_test(bytes_of_another_length_are_refused),
        cmocka_unit_test(all_instruction_sets_give_the_same_bits),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
