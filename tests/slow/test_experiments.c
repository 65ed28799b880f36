// Experiments that others made with disks on a conveyor belt before an opening, and what they found.
//
//     Aguirre et al. 2010   through a straight opening the rate is proportional to the speed of the
//                           belt and does not depend on how many parts wait (Phys. Rev. Lett. 104)
//     Wang et al. 2020      of a funnel at the angle phi to the wall across the belt the rate grows with
//                           phi and levels off; over D/(d cos phi) all rates fall on one curve,
//                           0.95 (1 - 0.74 exp(-0.19 D/(d cos phi))) (Chin. Phys. B 29)
//
// Noise: parts pass at most as irregularly as if they came independently of each other, so the count n
// has a standard deviation of sqrt(n) or less; a ratio of rates is believed to three of its own.

#include "core/base/check.h"
#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/micro/micro.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

enum { RUNS = 3, SPEEDS = 3, HEAPS = 2, ANGLES = 5, OPENINGS = 2 };

static const double radius = 0.012;        // m
static const double belt_width = 0.42;     // m
static const double pitch = 1.05 * 2.4e-2; // of the parts at the start, m
static const double jitter = 1e-3;         // the range of it, m
static const double count_every = 4e-3;    // s
static const double run_out = 0.1;         // behind the opening, m

// What is tried: every rate is that of the parts number first + 1 to last that pass.
typedef struct trial {
    double angle;   // phi, rad
    double opening; // D, m
    double speed;   // of the belt, m/s
    size_t n_parts; // at the start
    size_t first;   // see above
    size_t last;
} trial;

// A belt with a funnel across it and what the definition points to.
typedef struct hopper {
    micro_def def;
    scene_belt belt;
    vec2 paths[2][3];
    scene_obstacle sides[2];
    micro_kind kind;
    scene_pose *poses;
    double exit; // x where the opening is, m
} hopper;

// The disks of such experiments have more friction with each other and with the funnel than the paper's steel, by
// Coulomb's law: the paper's 10 s/m would smooth it over 0.1 m/s, the speed of a belt here. Moduli are
// high enough that a heap does not compress its disks.
static void set_contacts(micro_def *def)
{
    for (int pair = 0; pair < SCENE_PAIR_COUNT; pair++)
        def->contact[pair].tanh_linear = 100.0;
    def->contact[SCENE_CARGO_CARGO].friction = 0.5;
    def->contact[SCENE_HANDLING_CARGO].friction = 0.5;
    def->modulus_reduction = 1e4;
}

// Rows across the belt, the first one just before the funnel. Returns how long the heap is, m.
static double place_parts(hopper *h, const trial *t, uint64_t seed)
{
    const size_t in_row = (size_t)((belt_width - 2.0 * radius - 0.5 * pitch - jitter) / pitch) + 1;
    const double apart = 0.5 * sqrt(3.0) * pitch;
    const double length = apart * (double)((t->n_parts + in_row - 1) / in_row);
    bf_random random;

    random_init(&random, seed);
    h->poses = memory_alloc(t->n_parts, sizeof *h->poses);
    BF_CHECK(h->poses != NULL);
    for (size_t k = 0; k < t->n_parts; k++) {
        size_t row = k / in_row, place = k % in_row;
        double y = radius + pitch * ((double)place + 0.5 * (double)(row % 2));
        h->poses[k] = (scene_pose){ length - apart * (double)row + jitter * random_unit(&random),
                                    y + jitter * random_unit(&random), 0.0 };
    }
    return length + 2.0 * radius;
}

// The sides of the channel are plates, too: walls of the domain would be slippery, and a heap between
// them would load the opening with all its length.
static void place_funnel(hopper *h, const trial *t, double heap)
{
    const double side = 0.5 * (belt_width - t->opening), edge = 2.0 * radius;

    h->exit = heap + side * tan(t->angle);
    h->def.domain = (scene_rect){ 0.0, h->exit + run_out, -edge, belt_width + edge };
    // Cargo runs on the left of both.
    h->paths[0][0] = (vec2){ 0.0, 0.0 };
    h->paths[0][1] = (vec2){ heap, 0.0 };
    h->paths[0][2] = (vec2){ h->exit, side };
    h->paths[1][0] = (vec2){ h->exit, belt_width - side };
    h->paths[1][1] = (vec2){ heap, belt_width };
    h->paths[1][2] = (vec2){ 0.0, belt_width };
    for (int k = 0; k < 2; k++)
        h->sides[k] = (scene_obstacle){ .n_points = 3, .path = h->paths[k], .thickness = 0.005 };
}

static void make_hopper(hopper *h, const trial *t, uint64_t seed)
{
    *h = (hopper){ .def = micro_def_default() };
    place_funnel(h, t, place_parts(h, t, seed));
    h->belt.velocity.x = t->speed;
    h->kind = (micro_kind){
        .shape = { .type = SCENE_CYLINDER, .radius = radius, .height = 0.008 },
        .material = { 210e9, 0.28 },
        .mass = 0.02841,
        .spin_radius = 0.008,
    };
    set_contacts(&h->def);
    h->def.integrator = MICRO_IMPLICIT;
    h->def.dt = 0.0;
    h->def.n_belts = h->def.n_kinds = 1;
    h->def.belts = &h->belt;
    h->def.kinds = &h->kind;
    h->def.n_obstacles = 2;
    h->def.obstacles = h->sides;
    h->def.n_parts = t->n_parts;
    h->def.poses = h->poses;
}

// Parts that are wholly through the opening.
static size_t count_through(const micro_solver *s, double exit)
{
    size_t n = 0;

    for (size_t k = 0; k < micro_parts(s); k++) {
        micro_part part = micro_part_of(s, k);
        n += part.is_gone || part.x[0] > exit + radius;
    }
    return n;
}

// Makes steps until n parts are through, which must be before a heap of them could have passed at a
// tenth of the speed of the belt. Returns how many are.
static size_t advance_to(micro_solver *s, const hopper *h, size_t n)
{
    const double patience = 10.0 * h->exit / h->belt.velocity.x;
    const uint64_t n_steps = (uint64_t)ceil(count_every / micro_dt(s));
    size_t n_through = count_through(s, h->exit);

    while (n_through < n) {
        assert_int_equal(micro_advance(s, n_steps, NULL), BF_OK);
        assert_true((double)micro_steps(s) * micro_dt(s) < patience);
        n_through = count_through(s, h->exit);
    }
    return n_through;
}

// Parts and seconds of one run between first and last.
static void run_trial(const trial *t, uint64_t seed, double *ret_parts, double *ret_time)
{
    micro_solver *s = NULL;
    hopper h;

    make_hopper(&h, t, seed);
    assert_int_equal(micro_create(&h.def, &s, NULL), BF_OK);
    size_t first = advance_to(s, &h, t->first);
    uint64_t begin = micro_steps(s);
    size_t last = advance_to(s, &h, t->last);
    *ret_parts = (double)(last - first);
    *ret_time = (double)(micro_steps(s) - begin) * micro_dt(s);
    assert_true(micro_measure(s).overlap_share < 0.25);
    micro_destroy(s);
    memory_free(h.poses);
}

// Parts a second, divided by speed and opening: parts/m2.
static double measure(const trial *t)
{
    double parts = 0.0, time = 0.0;

    for (uint64_t seed = 1; seed <= RUNS; seed++) {
        double n, seconds;
        run_trial(t, seed, &n, &seconds);
        parts += n;
        time += seconds;
    }
    return parts / time / (t->speed * t->opening);
}

// Three standard deviations of the ratio of two rates of this trial.
static double noise_of(const trial *t)
{
    return 3.0 * sqrt(2.0 / (double)(RUNS * (t->last - t->first)));
}

// Two rates are the same but for noise and a known effect.
static void assert_same(double rate, double reference, double margin)
{
    if (fabs(rate / reference - 1.0) > margin)
        print_message("%.0f against %.0f is more than %.3f off\n", rate, reference, margin);
    assert_true(fabs(rate / reference - 1.0) <= margin);
}

static void the_rate_through_a_straight_opening_follows_the_belt_not_the_heap(void **state)
{
    static const double speeds[SPEEDS] = { 0.1, 0.2, 0.4 };
    static const size_t heaps[HEAPS] = { 600, 1200 };
    trial t = { .opening = 12.0 * radius, .first = 60, .last = 180 };
    double rates[SPEEDS][HEAPS];

    print_message("rate/(v D), parts/m2, by belt speed, of 600 and 1200 parts:\n");
    for (int v = 0; v < SPEEDS; v++) {
        for (int n = 0; n < HEAPS; n++) {
            t.speed = speeds[v];
            t.n_parts = heaps[n];
            rates[v][n] = measure(&t);
        }
        print_message("%.1f m/s  %5.0f  %5.0f\n", speeds[v], rates[v][0], rates[v][1]);
    }
    for (int v = 0; v < SPEEDS; v++) {
        // A belt takes v^2/(2 mu g) to bring a part from rest to speed, mu = 1; so much longer is the way
        // through the opening. A rate like a liquid's, by the square root of the head, would be 1.41
        // times as high for the larger heap.
        double take_up = speeds[v] * speeds[v] / (2.0 * 9.81) / t.opening;
        assert_same(rates[v][1], rates[v][0], noise_of(&t));
        for (int n = 0; n < HEAPS; n++)
            assert_same(rates[v][n], rates[0][n], noise_of(&t) + take_up);
    }
    assert_true(noise_of(&t) < 0.41);
}

static double curve_of_wang(double diameters, double degrees)
{
    return 1.0 - 0.74 * exp(-0.19 * diameters / cos(degrees * M_PI / 180.0));
}

static void print_funnels(double diameters, const double *degrees, const double *rates)
{
    const int last = ANGLES - 1;

    print_message("opening of %.0f diameters: phi, rate/(v D) in parts/m2, share of the last one, "
                  "the same on Wang's curve:\n",
                  diameters);
    for (int k = 0; k < ANGLES; k++)
        print_message("%4.0f  %5.0f  %.3f  %.3f\n", degrees[k], rates[k], rates[k] / rates[last],
                      curve_of_wang(diameters, degrees[k]) /
                          curve_of_wang(diameters, degrees[last]));
}

static void a_steeper_funnel_passes_more_and_then_levels_off(void **state)
{
    static const double degrees[ANGLES] = { 0.0, 30.0, 60.0, 70.0, 80.0 };
    static const double openings[OPENINGS] = { 6.0, 10.0 };
    trial t = { .speed = 0.2, .n_parts = 640, .first = 60, .last = 420 };

    for (int d = 0; d < OPENINGS; d++) {
        double rates[ANGLES];
        t.opening = openings[d] * 2.0 * radius;
        for (int k = 0; k < ANGLES; k++) {
            t.angle = degrees[k] * M_PI / 180.0;
            rates[k] = measure(&t);
        }
        print_funnels(openings[d], degrees, rates);
        for (int k = 1; k < ANGLES; k++)
            assert_true(rates[k] > rates[k - 1] * (1.0 - noise_of(&t)));
        // The last two are both on the level, which makes the mean of them less noisy.
        double level = 0.5 * (rates[ANGLES - 2] + rates[ANGLES - 1]);
        assert_same(rates[ANGLES - 1], rates[ANGLES - 2], noise_of(&t));
        assert_true(level > rates[0] * (1.0 + noise_of(&t) * sqrt(0.75)));
        for (int k = 0; k < ANGLES; k++)
            assert_same(rates[k] / level,
                        curve_of_wang(openings[d], degrees[k]) / curve_of_wang(openings[d], 80.0),
                        noise_of(&t));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rate_through_a_straight_opening_follows_the_belt_not_the_heap),
        cmocka_unit_test(a_steeper_funnel_passes_more_and_then_levels_off),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
