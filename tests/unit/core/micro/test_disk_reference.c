// Explicit planar steps against a solver without any list.

#include "tests/reference/planar.h"
#include "tests/unit/core/helper_disk_state.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>

enum { STEPS = 200 };

static double difference(const disk_part *a, const micro_part *b)
{
    const double r = 0.012;
    double places = hypot(a->x - b->x[0], a->y - b->x[1]);
    double speeds = hypot(a->vx - b->v[0], a->vy - b->v[1]);

    return fmax(fmax(places, speeds),
                r * fmax(fabs(a->heading - b->heading), fabs(a->spin - b->w[2])));
}

// Returns how many parts have left.
static size_t check_against_all_pairs(const micro_def *def)
{
    planar *oracle = disk_create(def);
    disk_state *s = helper_disk_state_start(def);
    double largest = 0.0;
    size_t n_gone = 0;

    assert_non_null(oracle);
    assert_true(disk__measure(s).n_contacts > 150);
    for (int k = 0; k < STEPS; k++)
        disk_advance(oracle);
    helper_disk_state_advance(s, STEPS);
    for (size_t k = 0; k < def->n_parts; k++) {
        micro_part part = disk__part(s, k);
        assert_int_equal(disk_parts(oracle)[k].is_gone, part.is_gone);
        largest = fmax(largest, difference(&disk_parts(oracle)[k], &part));
        n_gone += part.is_gone;
    }
    if (!(largest <= 1e-9))
        fail_msg("trajectories differ by %g", largest);
    helper_disk_state_end(s);
    disk_destroy(oracle);
    return n_gone;
}

static void a_jam_moves_as_without_any_list(void **state)
{
    helper_outflow *e = malloc(sizeof *e);

    assert_non_null(e);
    for (double angle = 60.0; angle < 100.0; angle += 30.0) {
        helper_disk_state_jam(e, angle);
        check_against_all_pairs(&e->def);
        e->def.tension = true;
        check_against_all_pairs(&e->def);
    }
    free(e);
}

static void a_jam_of_two_kinds_on_two_belts_moves_as_without_any_list(void **state)
{
    helper_disk_state *w = helper_disk_state_make(0.395, 4.0);

    helper_disk_state_crowd(w, true);
    w->def.damping = 0.1;
    w->def.n_parts = 44 * 5;
    check_against_all_pairs(&w->def);
    w->def.n_obstacles = 0;
    assert_true(check_against_all_pairs(&w->def) > 0);
    w->def.edges[SCENE_EAST] = SCENE_EDGE_WALL;
    assert_int_equal(check_against_all_pairs(&w->def), 0);
    free(w);
}

// The belts stop, stand and start within the 5 ms of the runs.
static void belts_whose_speed_changes_move_parts_as_without_any_list(void **state)
{
    double times[2][3] = { { 1e-3, 2e-3, 3e-3 }, { 0.0, 1.5e-3, 2.5e-3 } };
    double factors[2][3] = { { 0.0, 0.0, 1.5 }, { 0.25, 0.0, 2.0 } };
    helper_disk_state *w = helper_disk_state_make(0.395, 4.0);

    helper_disk_state_crowd(w, true);
    w->def.n_parts = 44 * 5;
    for (int k = 0; k < 2; k++) {
        w->belts[k].acceleration = 1e3;
        w->belts[k].deceleration = k == 0 ? 600.0 : INFINITY;
        w->belts[k].speed_schedule = (scene_speed_schedule){ 3, times[k], 3, factors[k] };
    }
    check_against_all_pairs(&w->def);
    // One kind on one belt all over.
    w->belts[0].n_points = 0;
    w->def.n_belts = w->def.n_kinds = 1;
    w->def.part_kinds = NULL;
    check_against_all_pairs(&w->def);
    free(w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_jam_moves_as_without_any_list),
        cmocka_unit_test(a_jam_of_two_kinds_on_two_belts_moves_as_without_any_list),
        cmocka_unit_test(belts_whose_speed_changes_move_parts_as_without_any_list),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
