// Contacts of disks against closed forms. Velocities that a part does not get from its belt at the start
// are put into the solver's own rows.

#include "tests/unit/core/helper_disk_state.h"
#include "tests/unit/core/helper_disks.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>

static const double radius = 0.012;

// (4b) for two of the steel cylinders.
static double stiffness(double reduction)
{
    return M_PI / 4.0 * 0.008 / (2.0 * (1.0 - 0.28 * 0.28) * reduction / 210e9);
}

// Two parts at rest that overlap by delta0 move apart as delta'' = -(k delta + d delta')/m, m half a
// part's mass: with a^2 + d/m a + k/m = 0, delta = delta0 (b e^(a t) - a e^(b t))/(b - a).
static double exact_overlap(double k, double d, double m, double delta0, double t)
{
    double half = 0.5 * d / m, square = half * half - k / m;

    if (square < 0.0) {
        double w = sqrt(-square);
        return delta0 * exp(-half * t) * (cos(w * t) + half / w * sin(w * t));
    }
    double a = -half + sqrt(square), b = -half - sqrt(square);
    return delta0 * (b * exp(a * t) - a * exp(b * t)) / (b - a);
}

// The largest error of the overlap, relative to that at the start, in n steps until t_end.
static double oscillator_error(double reduction, double t_end, int n)
{
    helper_disks *d = helper_disks_make_bare();
    double delta0 = 1e-4, error = 0.0;

    d->def.modulus_reduction = reduction;
    d->def.tension = true;
    d->def.dt = t_end / n;
    helper_disks_add(d, 0.5, 0.5);
    helper_disks_add(d, 0.5 + 2.0 * radius - delta0, 0.5);
    micro_solver *s = helper_disks_start(d);
    for (int k = 1; k <= n; k++) {
        helper_disks_advance(s, 1);
        double overlap = 2.0 * radius - micro_part_of(s, 1).x[0] + micro_part_of(s, 0).x[0];
        double exact = exact_overlap(stiffness(reduction), 119.0, 0.5 * d->kinds[0].mass, delta0,
                                     k * d->def.dt);
        error = fmax(error, fabs(overlap - exact) / delta0);
    }
    micro_destroy(s);
    helper_disks_free(d);
    return error;
}

// Lehr's ratio d / (2 sqrt(k m)) is 18.7 at reduction 1e6 and 0.19 at 100; the latter is followed
// until the parts come apart after about a quarter of a period.
static void a_head_on_contact_is_the_damped_oscillator_with_order_1(void **state)
{
    const double reduction[2] = { 1e6, 100.0 }, t_end[2] = { 4e-3, 6e-5 };

    for (int k = 0; k < 2; k++) {
        double coarse = oscillator_error(reduction[k], t_end[k], 200);
        double fine = oscillator_error(reduction[k], t_end[k], 400);
        double finest = oscillator_error(reduction[k], t_end[k], 800);
        assert_true(finest < 4e-3);
        assert_true(log2(coarse / fine) > 0.9);
        assert_true(log2(fine / finest) > 0.9);
    }
}

static void contacts_do_not_pull_unless_asked_to(void **state)
{
    helper_disks *d = helper_disks_make_bare();

    helper_disks_add(d, 0.5, 0.5);
    helper_disks_add(d, 0.5 + 2.0 * radius - 1e-4, 0.5);
    for (int tension = 0; tension < 2; tension++) {
        d->def.tension = tension != 0;
        disk_state *s = helper_disk_state_start(&d->def);
        // Parting at 1 m/s: the dashpot's 119 N against the spring's 0.07 N.
        helper_disk_state_row(s, 1)->vx = 1.0;
        helper_disk_state_advance(s, 2);
        assert_true((helper_disk_state_row(s, 1)->vx < 0.97) == (tension != 0));
        if (tension == 0)
            assert_true(helper_disk_state_row(s, 1)->vx == 1.0 &&
                        helper_disk_state_row(s, 0)->vx == 0.0);
        helper_disk_state_end(s);
    }
    helper_disks_free(d);
}

typedef struct momenta {
    double x, y, angular;
} momenta;

static momenta measure_momenta(disk_state *s, const helper_disks *d)
{
    momenta sum = { 0.0, 0.0, 0.0 };

    for (size_t k = 0; k < s->n; k++) {
        const disk *row = helper_disk_state_row(s, k);
        double m = d->kinds[d->def.part_kinds != NULL ? d->part_kinds[k] : 0].mass;
        sum.x += m * row->vx;
        sum.y += m * row->vy;
        sum.angular += m * (row->x * row->vy - row->y * row->vx) +
                       0.5 * m * row->radius * row->radius * row->spin;
    }
    return sum;
}

// Forces are equal and opposite in one line, and levers add up to the distance of the centres.
static void a_free_pair_conserves_its_momenta(void **state)
{
    helper_disks *d = helper_disks_make_bare();

    helper_disks_add(d, 0.5, 0.5);
    helper_disks_add(d, 0.522, 0.508);
    for (int mixed = 0; mixed < 2; mixed++) {
        d->def.n_kinds = mixed ? 3 : 1;
        d->part_kinds[1] = 2;
        d->def.part_kinds = mixed ? d->part_kinds : NULL;
        disk_state *s = helper_disk_state_start(&d->def);
        helper_disk_state_row(s, 0)->vx = 0.7;
        helper_disk_state_row(s, 0)->spin = 30.0;
        helper_disk_state_row(s, 1)->vy = -0.4;
        momenta before = measure_momenta(s, d);
        helper_disk_state_advance(s, 5000);
        momenta after = measure_momenta(s, d);
        double size = d->kinds[0].mass * 0.7;
        assert_true(fabs(helper_disk_state_row(s, 1)->spin) > 0.1);
        assert_near(after.x, before.x, 1e-12 * size);
        assert_near(after.y, before.y, 1e-12 * size);
        assert_near(after.angular, before.angular, 1e-12 * size);
        helper_disk_state_end(s);
    }
    helper_disks_free(d);
}

// Kinetic energy and that of the springs.
static double measure_energy(const disk_state *s)
{
    double energy = disk__measure(s).kinetic_energy;

    for (size_t place = 0; place < s->n_live; place++) {
        for (size_t row = 0; row < disk__n_rows(s, place); row++) {
            const disk *a = &s->now[place], *b = &s->now[disk__neighbour(s, place, row)];
            double overlap = 2.0 * radius - hypot(a->x - b->x, a->y - b->y);
            energy += overlap > 0.0 ? 0.25 * stiffness(1e6) * overlap * overlap : 0.0;
        }
    }
    for (size_t k = 0; k < s->n_candidates; k++) {
        bool counts;
        double overlap =
            disk__overlap(s, &s->now[s->candidates[k].slot], s->candidates[k].feature, &counts);
        double k_wall = M_PI / 4.0 * 0.008 /
                        ((1.0 - 0.34 * 0.34) * 1e6 / 70e9 + (1.0 - 0.28 * 0.28) * 1e6 / 210e9);
        energy += counts && overlap > 0.0 ? 0.5 * k_wall * overlap * overlap : 0.0;
    }
    return energy;
}

// Parts thrown about in a box lose energy all the time; the scheme's own error is of order dt, and
// a thousandth of what there is covers it.
static void energy_does_not_grow_without_a_belt(void **state)
{
    helper_disks *d = helper_disks_make_bare();

    d->def.domain = (scene_rect){ 0.0, 0.4, 0.0, 0.4 };
    d->def.edges[SCENE_WEST] = d->def.edges[SCENE_EAST] = SCENE_EDGE_WALL;
    helper_disks_fill(d, 10, 10, 0.03, 0.03, 0.035, 0.004);
    disk_state *s = helper_disk_state_start(&d->def);
    for (size_t k = 0; k < s->n; k++) {
        helper_disk_state_row(s, k)->vx = k % 3 == 0 ? 1.5 : -0.5;
        helper_disk_state_row(s, k)->vy = k % 5 == 0 ? -1.0 : 0.5;
        helper_disk_state_row(s, k)->spin = k % 2 == 0 ? 20.0 : -10.0;
    }
    double start = measure_energy(s), before = start;
    for (int k = 0; k < 100; k++) {
        helper_disk_state_advance(s, 200);
        double now = measure_energy(s);
        assert_true(now <= before * 1.001);
        before = now;
    }
    assert_true(before < 0.3 * start);
    assert_int_equal(disk__measure(s).n_parts, 100);
    helper_disk_state_end(s);
    helper_disks_free(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_head_on_contact_is_the_damped_oscillator_with_order_1),
        cmocka_unit_test(contacts_do_not_pull_unless_asked_to),
        cmocka_unit_test(a_free_pair_conserves_its_momenta),
        cmocka_unit_test(energy_does_not_grow_without_a_belt),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
