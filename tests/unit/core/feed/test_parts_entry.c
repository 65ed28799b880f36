// Unit tests of how parts enter: into a room of bodies that do not move unless the test takes them away.

#include "core/feed/parts_entry.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/feed/arrivals.h"
#include "core/scene/mix.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

enum { MAX = 2000 };

typedef struct body {
    uint32_t kind;
    scene_pose pose;
} body;

// Bodies, and what was admitted.
typedef struct room {
    shape_footprint footprints[SCENE_KINDS_MAX];
    size_t n_bodies;
    body bodies[MAX];
    size_t n_admitted;
    feed_admission admitted[MAX];
    size_t n_trials; // calls of is_free()
    double plate[2]; // denies places between these, y in m
    bool refuses;    // admit() fails
} room;

static bool is_free(void *context, uint32_t kind, scene_pose pose)
{
    room *r = (room *)context;
    vec2 own[SCENE_VERTICES_MAX + 1], other[SCENE_VERTICES_MAX + 1];
    const shape_footprint *a = &r->footprints[kind];
    bool is = !(pose.y > r->plate[0] && pose.y < r->plate[1]);

    r->n_trials++;
    shape_place(a, pose, own);
    for (size_t k = 0; k < r->n_bodies; k++) {
        const shape_footprint *b = &r->footprints[r->bodies[k].kind];
        const vec2 at = { r->bodies[k].pose.x, r->bodies[k].pose.y };
        const double apart = vec2_length(vec2_sub(at, (vec2){ pose.x, pose.y }));
        shape_place(b, r->bodies[k].pose, other);
        if (a->n_corners == 0 && b->n_corners == 0)
            is = is && apart >= a->bounding_radius + b->bounding_radius;
        else if (a->n_corners == 0)
            is = is && !polygon_overlaps_disk((vec2){ pose.x, pose.y }, a->bounding_radius, other,
                                              b->n_corners, 0.0);
        else if (b->n_corners == 0)
            is = is && !polygon_overlaps_disk(at, b->bounding_radius, own, a->n_corners, 0.0);
        else
            is = is && !polygon_overlaps(own, a->n_corners, other, b->n_corners, 0.0);
    }
    return is;
}

static size_t near(void *context, vec2 start, vec2 end, double within, feed_body *ret_bodies,
                   size_t n_max)
{
    const room *r = context;
    size_t n = 0;

    for (size_t k = 0; k < r->n_bodies; k++) {
        const vec2 at = { r->bodies[k].pose.x, r->bodies[k].pose.y };
        if (polygon_segment_distance(at, start, end) >= within)
            continue;
        if (n < n_max)
            ret_bodies[n] = (feed_body){ at, r->bodies[k].kind };
        n++;
    }
    return n;
}

static bf_status admit(void *context, const feed_admission *part, bf_error *err)
{
    room *r = context;

    if (r->refuses)
        return bf_fail(err, BF_ELIMIT, "", "full");
    assert_true(is_free(r, part->kind, part->pose));
    assert_true(r->n_bodies < MAX && r->n_admitted < MAX);
    r->bodies[r->n_bodies++] = (body){ part->kind, part->pose };
    r->admitted[r->n_admitted++] = *part;
    return BF_OK;
}

// A belt of 1 m x 1 m between walls, disks of radius 0.05 m, and boxes of 0.2 m x 0.1 m as kind 1; n feeds across it
// at x = 0, 10 parts/s of disks.
static void make_scene(scene *s, size_t n_feeds)
{
    helper_scene_belt(s, 1.0, 1.0, 0.1, NULL, 0);
    s->n_cargo = 2;
    scene_cargo_init(&s->cargo[1]);
    s->cargo[0].shape.radius = 0.05;
    s->cargo[1].shape.type = SCENE_BOX;
    s->cargo[1].shape.length = 0.2;
    s->cargo[1].shape.width = 0.1;
    s->n_feeds = n_feeds;
    s->feeds = memory_alloc(n_feeds, sizeof *s->feeds);
    assert_non_null(s->feeds);
    for (size_t k = 0; k < n_feeds; k++) {
        scene_feed *f = &s->feeds[k];
        scene_feed_init(f);
        f->is_edge = true;
        f->edge = SCENE_WEST;
        f->demand = SCENE_DEMAND_RATE;
        f->rate = 10.0;
        f->n_cargo = 1;
        f->cargo[0] = (scene_feed_kind){ 0, 1.0 };
    }
    helper_scene_resolve(s);
}

static feed_parts *make_parts(const scene *s, room *r)
{
    feed_parts *p = NULL;

    memset(r, 0, sizeof *r);
    mix_footprints(s, r->footprints);
    assert_int_equal(feed_parts_create(s, &p, NULL), BF_OK);
    return p;
}

static void advance(feed_parts *p, double t, room *r)
{
    const feed_room table = { r, is_free, near, admit };

    assert_int_equal(feed_parts_advance(p, t, &table, NULL), BF_OK);
}

static void check_balance(const feed_parts *p, size_t feed, double offered, double admitted,
                          double discarded)
{
    const feed_balance b = feed_parts_balance(p, feed);

    assert_true(b.offered == offered && b.admitted == admitted && b.discarded == discarded);
    assert_true(b.waiting == offered - admitted - discarded);
}

// Parts of a feed that a list delivers, each at 0 s and at a place of its own.
static void set_list(scene_feed *f, size_t n, const double *places, const uint32_t *kinds)
{
    f->demand = SCENE_DEMAND_SCHEDULE;
    f->schedule.n = n;
    f->schedule.times = memory_alloc(n, sizeof *f->schedule.times);
    assert_non_null(f->schedule.times);
    if (places != NULL) {
        f->schedule.places = memory_alloc(n, sizeof *places);
        assert_non_null(f->schedule.places);
        memcpy(f->schedule.places, places, n * sizeof *places);
    }
    if (kinds != NULL) {
        f->schedule.kinds = memory_alloc(n, sizeof *kinds);
        assert_non_null(f->schedule.kinds);
        memcpy(f->schedule.kinds, kinds, n * sizeof *kinds);
    }
}

// Parts arrive at 0.05, 0.15, ... s; a tick is 0.04 s: they enter at 0.08, 0.16, 0.28, ... s, where they were drawn:
// between 0.05 and 0.95 m, as the walls need the radius.
static void parts_enter_at_the_first_tick_where_they_were_drawn(void **state)
{
    static room r;
    feed_arrivals *a = NULL;
    scene s;
    make_scene(&s, 1);
    feed_parts *p = make_parts(&s, &r);
    assert_int_equal(feed_arrivals_create(&s.feeds[0], 0, &a, NULL), BF_OK);
    feed_cursor c = feed_arrivals_first(a);
    for (int k = 0; k <= 50; k++) {
        advance(p, 0.04 * k, &r);
        r.n_bodies = 0;
        check_balance(p, 0, (double)r.n_admitted, (double)r.n_admitted, 0.0);
    }
    assert_int_equal(r.n_admitted, 20);
    assert_int_equal(r.n_trials, 40); // one of them is by admit()
    for (size_t k = 0; k < r.n_admitted; k++, feed_arrivals_next(a, &c)) {
        const feed_part part = feed_arrivals_part(a, &c);
        const feed_admission *entry = &r.admitted[k];
        const double due = 0.05 + 0.1 * (double)k;
        assert_true(entry->number == k + 1 && entry->kind == part.kind && entry->feed == 0);
        assert_near(entry->wait, 0.04 * ceil(due / 0.04 - 1e-9) - due, 1e-12);
        assert_true(entry->pose.x == 0.0);
        assert_near(entry->pose.y, 0.05 + 0.9 * part.place, 1e-8);
    }
    feed_arrivals_destroy(a);
    feed_parts_destroy(p);
    scene_fini(&s);
}

// Disks at 0.1, 0.2 and 0.35 m leave no place between 0 and 0.45 m: the first one is where the third is touched. Another
// at 0.5501 m leaves 0.1 mm there. With one at 0.51 m, which denies 0.45 m, the first place is 0.61 m.
static void the_first_free_place_of_a_disk_is_exact(void **state)
{
    static const double last[] = { NAN, 0.5501, 0.51 };
    static const double expected[] = { 0.45, 0.45, 0.61 };
    for (size_t k = 0; k < 3; k++) {
        static room r;
        scene s;
        make_scene(&s, 1);
        feed_parts *p = make_parts(&s, &r);
        const double places[] = { 0.1, 0.2, 0.35, last[k] };
        for (size_t i = 0; i < 4 && !isnan(places[i]); i++)
            r.bodies[r.n_bodies++] = (body){ 0, { 0.0, places[i], 0.0 } };
        // What is beyond is filled by disks off the line, which are near enough to deny all but a point each.
        for (double y = 0.0; y <= 0.9; y += 0.02)
            if (y > expected[k] + 0.1)
                r.bodies[r.n_bodies++] = (body){ 0, { -0.02, y, 0.0 } };
        advance(p, 0.05, &r);
        assert_int_equal(r.n_admitted, 1);
        assert_true(r.n_trials >= 12);
        assert_near(r.admitted[0].pose.y, expected[k], 1e-8);
        feed_parts_destroy(p);
        scene_fini(&s);
    }
}

// A plate denies 0.05 m to 0.62 m, disks what is beyond 0.632 m. Places are tried from 0.05 m on by a quarter of the radius,
// 0.0125 m: the first one that is free is 0.625 m, in the middle of the only gap that disks leave.
static void a_free_place_behind_a_plate_is_found(void **state)
{
    static room r;
    scene s;
    make_scene(&s, 1);
    feed_parts *p = make_parts(&s, &r);
    r.plate[1] = 0.62;
    for (double y = 0.73; y <= 0.96; y += 0.02)
        r.bodies[r.n_bodies++] = (body){ 0, { -0.02, y, 0.0 } };
    advance(p, 0.05, &r);
    assert_int_equal(r.n_admitted, 1);
    assert_near(r.admitted[0].pose.y, 0.625, 1e-8);
    feed_parts_destroy(p);
    scene_fini(&s);
}

// 0.9 m for centres 0.1 m apart, and what the draws waste: at least five of them fit, at most ten. The others wait, and
// cost at most one search a tick.
static void parts_wait_in_order_while_the_line_is_full(void **state)
{
    static room r;
    scene s;
    make_scene(&s, 1);
    feed_parts *p = make_parts(&s, &r);
    for (int k = 1; k <= 100; k++) {
        advance(p, 0.1 * k, &r);
        if (k == 50)
            r.n_trials = 0;
    }
    assert_in_range(r.n_admitted, 5, 10);
    assert_true(r.n_trials <= 50 * (1 + PARTS_ENTRY_DRAWS + r.n_admitted));
    check_balance(p, 0, 100.0, (double)r.n_admitted, 0.0);
    const size_t before = r.n_admitted;
    r.n_bodies = 0;
    advance(p, 10.0, &r);
    assert_true(r.n_admitted > before);
    for (size_t k = 0; k < r.n_admitted; k++)
        assert_int_equal(r.admitted[k].number, k + 1);
    assert_near(r.admitted[before].wait, 10.0 - 0.1 * (double)before - 0.05, 1e-12);
    feed_parts_destroy(p);
    scene_fini(&s);
}

// The first part's place is taken, and it takes no other: the second one waits behind it. A place at the wall is moved
// to where the disk fits.
static void a_given_place_is_the_only_one(void **state)
{
    static room r;
    scene s;
    make_scene(&s, 1);
    set_list(&s.feeds[0], 3, (double[]){ 0.5, 0.9, 0.0 }, NULL);
    feed_parts *p = make_parts(&s, &r);
    r.bodies[r.n_bodies++] = (body){ 0, { 0.0, 0.58, 0.0 } };
    advance(p, 0.0, &r);
    check_balance(p, 0, 3.0, 0.0, 0.0);
    assert_int_equal(r.n_trials, 1);
    r.n_bodies = 0;
    advance(p, 0.1, &r);
    check_balance(p, 0, 3.0, 3.0, 0.0);
    assert_true(feed_parts_are_exhausted(p));
    assert_near(r.admitted[0].pose.y, 0.5, 0.0);
    assert_near(r.admitted[1].pose.y, 0.9, 0.0);
    assert_near(r.admitted[2].pose.y, 0.05, 1e-8);
    feed_parts_destroy(p);
    scene_fini(&s);
}

// A box of 0.2 m x 0.1 m reaches 0.05 m across its heading and 0.1 m along it, and at 45 degrees
// (0.1 + 0.05)/sqrt(2) in y. Its given places are moved by as much from the walls.
static void other_footprints_keep_off_the_walls_at_their_heading(void **state)
{
    static const double headings[] = { 0.0, M_PI / 2.0, M_PI / 4.0 };
    static const double reached[] = { 0.05, 0.1, 0.10606601717798213 };
    for (size_t k = 0; k < 3; k++) {
        static room r;
        scene s;
        make_scene(&s, 1);
        set_list(&s.feeds[0], 2, (double[]){ 0.0, 1.0 }, (uint32_t[]){ 1, 1 });
        s.feeds[0].heading = headings[k];
        feed_parts *p = make_parts(&s, &r);
        advance(p, 0.0, &r);
        assert_int_equal(r.n_admitted, 2);
        assert_near(r.admitted[0].pose.y, reached[k], 1e-8);
        assert_near(r.admitted[1].pose.y, 1.0 - reached[k], 1e-8);
        assert_true(r.admitted[0].pose.heading == headings[k]);
        feed_parts_destroy(p);
        scene_fini(&s);
    }
}

// Boxes that lie along the belt deny 0.1 m each: with trials every quarter of 0.1118 m, and draws before, more than half of
// what could be packed enters, and the line is full: between neighbours there is less than a box and a trial's step.
static void other_footprints_are_tried_along_the_line(void **state)
{
    static room r;
    scene s;
    make_scene(&s, 1);
    s.feeds[0].cargo[0].kind = 1;
    s.feeds[0].rate = 1000.0;
    feed_parts *p = make_parts(&s, &r);
    advance(p, 1.0, &r);
    assert_in_range(r.n_admitted, 6, 10);
    for (double y = 0.05; y < 0.95; y += 0.25 * r.footprints[1].bounding_radius) {
        double nearest = 1.0;
        for (size_t k = 0; k < r.n_bodies; k++)
            nearest = fmin(nearest, fabs(r.bodies[k].pose.y - y));
        assert_true(nearest < 0.1 + 0.25 * r.footprints[1].bounding_radius);
    }
    feed_parts_destroy(p);
    scene_fini(&s);
}

// Ten parts at once onto a line that takes one, and every 0.1 s one place: those that have waited for 0.25 s
// and find none are dropped. At 0.3 s three have entered and at 0.25 s none had expired, so the call at 0.3 s drops seven
// less the one that enters.
static void parts_are_dropped_that_have_waited_too_long(void **state)
{
    static room r;
    scene s;
    make_scene(&s, 1);
    set_list(&s.feeds[0], 10, NULL, NULL);
    s.feeds[0].line[1] = s.feeds[0].line[0] = (vec2){ 0.0, 0.5 };
    s.feeds[0].when_blocked = SCENE_BLOCKED_DISCARD;
    s.feeds[0].max_wait = 0.25;
    feed_parts *p = make_parts(&s, &r);
    for (int k = 0; k < 3; k++) {
        r.n_bodies = 0;
        advance(p, 0.1 * k, &r);
        check_balance(p, 0, 10.0, k + 1.0, 0.0);
    }
    r.n_bodies = 0;
    r.n_trials = 0;
    advance(p, 0.3, &r);
    check_balance(p, 0, 10.0, 4.0, 6.0);
    // The first is admitted; the second finds no place, and the others of its kind are not tried.
    assert_int_equal(r.n_trials, 2 + 1 + PARTS_ENTRY_DRAWS + 1);
    assert_true(feed_parts_are_exhausted(p));
    feed_parts_destroy(p);
    scene_fini(&s);
}

static void a_held_feed_admits_nothing(void **state)
{
    static room r;
    scene s;
    make_scene(&s, 2);
    feed_parts *p = make_parts(&s, &r);
    feed_parts_hold(p, 0, true);
    advance(p, 0.3, &r);
    check_balance(p, 0, 3.0, 0.0, 0.0);
    check_balance(p, 1, 3.0, 3.0, 0.0);
    feed_parts_hold(p, 0, false);
    advance(p, 0.3, &r);
    check_balance(p, 0, 3.0, 3.0, 0.0);
    assert_false(feed_parts_are_exhausted(p));
    feed_parts_destroy(p);
    scene_fini(&s);
}

// Two feeds onto the same point, which is free at every call: they alternate.
static void feeds_at_one_place_take_turns(void **state)
{
    static room r;
    scene s;
    make_scene(&s, 2);
    for (size_t k = 0; k < 2; k++)
        s.feeds[k].line[0] = s.feeds[k].line[1] = (vec2){ 0.0, 0.5 };
    feed_parts *p = make_parts(&s, &r);
    for (int k = 0; k < 10; k++) {
        r.n_bodies = 0;
        advance(p, 1.0 + 0.1 * k, &r);
    }
    assert_int_equal(r.n_admitted, 10);
    for (size_t k = 0; k < 10; k++)
        assert_int_equal(r.admitted[k].feed, k % 2);
    feed_parts_destroy(p);
    scene_fini(&s);
}

static void a_saved_state_goes_on_alike(void **state)
{
    static room r, again;
    bf_buffer saved = { 0 };
    checkpoint_writer w;
    checkpoint_reader reader;
    scene s;
    make_scene(&s, 3);
    s.feeds[1].arrivals = SCENE_ARRIVALS_POISSON;
    s.feeds[2].when_blocked = SCENE_BLOCKED_DISCARD;
    feed_parts *p = make_parts(&s, &r);
    feed_parts_hold(p, 2, true);
    for (int k = 0; k < 7; k++)
        advance(p, 0.13 * k, &r);
    checkpoint_begin(&w, &saved, CHECKPOINT_RUN, 5);
    feed_parts_save(p, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    feed_parts *q = make_parts(&s, &again);
    assert_int_equal(checkpoint_open(&reader, saved.bytes, saved.n, CHECKPOINT_RUN, 5, NULL),
                     BF_OK);
    assert_true(feed_parts_load(q, &reader));
    assert_int_equal(reader.n_left, 0);
    again = r;
    for (int k = 7; k < 40; k++) {
        if (k % 5 == 0)
            r.n_bodies = again.n_bodies = 0;
        advance(p, 0.13 * k, &r);
        advance(q, 0.13 * k, &again);
    }
    assert_int_equal(r.n_admitted, again.n_admitted);
    for (size_t k = 0; k < r.n_admitted; k++)
        assert_true(r.admitted[k].number == again.admitted[k].number &&
                    r.admitted[k].pose.y == again.admitted[k].pose.y &&
                    r.admitted[k].wait == again.admitted[k].wait);
    assert_true(feed_parts_balance(q, 2).admitted == 0.0);
    buffer_fini(&saved);
    feed_parts_destroy(p);
    feed_parts_destroy(q);
    scene_fini(&s);
}

static void failures_are_handed_on(void **state)
{
    static room r;
    const feed_room table = { &r, is_free, near, admit };
    bf_status status = BF_ENOMEM;
    feed_parts *p = NULL;
    scene s;
    make_scene(&s, 2);
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = feed_parts_create(&s, &p, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || (status == BF_ENOMEM && p == NULL));
    }
    feed_parts_destroy(p);
    p = make_parts(&s, &r);
    r.refuses = true;
    assert_int_equal(feed_parts_advance(p, 0.05, &table, NULL), BF_ELIMIT);
    r.refuses = false;
    // The line is full, so that the bodies on it are asked for.
    for (int k = 0; k < 100; k++)
        r.bodies[r.n_bodies++] = (body){ 0, { 0.0, 0.01 * k, 0.0 } };
    for (size_t n = 1; n <= 2; n++) {
        memory_plan_fault(n, 0);
        assert_int_equal(feed_parts_advance(p, 0.05, &table, NULL), BF_ENOMEM);
        memory_plan_fault(0, 0);
    }
    advance(p, 0.05, &r);
    check_balance(p, 0, 1.0, 0.0, 0.0);
    feed_parts_destroy(p);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_enter_at_the_first_tick_where_they_were_drawn),
        cmocka_unit_test(the_first_free_place_of_a_disk_is_exact),
        cmocka_unit_test(a_free_place_behind_a_plate_is_found),
        cmocka_unit_test(parts_wait_in_order_while_the_line_is_full),
        cmocka_unit_test(a_given_place_is_the_only_one),
        cmocka_unit_test(other_footprints_keep_off_the_walls_at_their_heading),
        cmocka_unit_test(other_footprints_are_tried_along_the_line),
        cmocka_unit_test(parts_are_dropped_that_have_waited_too_long),
        cmocka_unit_test(a_held_feed_admits_nothing),
        cmocka_unit_test(feeds_at_one_place_take_turns),
        cmocka_unit_test(a_saved_state_goes_on_alike),
        cmocka_unit_test(failures_are_handed_on),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
