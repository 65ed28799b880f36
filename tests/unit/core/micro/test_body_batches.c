// Contact constraints in space that are solved in batches.

#include "core/micro/body/implicit.h"
#include "tests/unit/core/helper_body.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

// Boxes, cylinders and wedges on a belt, at a plate and at walls: batches of all sorts, most of them not full.
static void all_instruction_sets_give_the_same_bits(void **state)
{
    uint64_t expected = 0;
    for (cpu_level level = CPU_BASE; level <= cpu_best(); level++) {
        helper_body h;
        helper_body_jam(&h);
        h.def.integrator = MICRO_IMPLICIT;
        h.def.dt = 1e-3;
        body_state *s = helper_body_start(&h);
        s->implicit->kernels = body__implicit_kernels(level);
        helper_body_run(s, 0.12);
        assert_true(body__measure(s).n_contacts > 5);
        expected = level == CPU_BASE ? helper_body_digest(s) : expected;
        assert_true(helper_body_digest(s) == expected);
        micro__body.destroy(s);
    }
}

// Boxes that overlap a free plate are all pushed off it.
static void a_part_with_more_neighbours_than_colours_has_impulses_of_all(void **state)
{
    enum { ROWS = 8, COLUMNS = 10, N = 1 + ROWS * COLUMNS };
    scene_pose poses[N] = { 0 };
    uint32_t kinds[N] = { 0 };
    helper_body h;
    helper_body_init(&h, helper_body_box(0.14, 0.12, 0.01));
    for (int k = 1; k < N; k++) {
        poses[k] = (scene_pose){ 0.013 * ((k - 1) % COLUMNS - 4.5),
                                 0.013 * ((k - 1) / COLUMNS - 3.5), 0.0 };
        kinds[k] = 1;
    }
    h.kinds[1].shape = helper_body_box(0.01, 0.01, 0.01);
    h.def.n_kinds = 2;
    h.def.n_parts = N;
    h.def.poses = poses;
    h.def.part_kinds = kinds;
    h.def.integrator = MICRO_IMPLICIT;
    h.def.dt = 1e-3;
    body_state *s = helper_body_start(&h);
    s->gravity = (vec3){ 0.0, 0.0, 0.0 };
    for (int k = 0; k < N; k++)
        s->bodies[k].x.z = k == 0 ? 0.1 : 0.1099;
    helper_body_run(s, h.def.dt);
    assert_true(s->implicit->colour[BODY_COLOURS + 1] - s->implicit->colour[BODY_COLOURS] ==
                N - 1 - BODY_COLOURS);
    for (int k = 1; k < N; k++)
        assert_true(s->bodies[k].v.z > 0.0);
    assert_true(s->bodies[0].v.z < 0.0);
    assert_near(vec3_length(helper_body_momentum(s)), 0.0, 1e-12);
    micro__body.destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_instruction_sets_give_the_same_bits),
        cmocka_unit_test(a_part_with_more_neighbours_than_colours_has_impulses_of_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
