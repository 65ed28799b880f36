#include "core/feed/parts_entry.h"

#include "core/base/memory.h"
#include "core/feed/arrivals.h"
#include "core/scene/feed_line.h"
#include "core/scene/mix.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <stdlib.h>

// The state of a feed, as it is saved.
typedef struct feed_state {
    feed_cursor next;  // the first part that is not due yet
    feed_cursor first; // the first one that waits; next: none does
    uint64_t n_admitted;
    uint64_t is_held; // 0 or 1
} feed_state;

struct feed_parts {
    const scene *scene;
    surroundings around;
    shape_footprint footprints[SCENE_KINDS_MAX];
    double largest_radius;
    size_t n_feeds;
    feed_arrivals **arrivals;
    feed_state *states;
    uint64_t n_turns;  // calls of feed_parts_advance()
    feed_body *bodies; // scratch of find_first_free()
    size_t n_bodies_max;
    feed_line_span *blocked; // by each of them
    size_t n_blocked_max;
};

bf_status feed_parts_create(const scene *s, feed_parts **ret_parts, bf_error *err)
{
    feed_parts *p = memory_alloc(1, sizeof *p);
    bf_status status = BF_OK;

    if (p != NULL) {
        *p = (feed_parts){ .scene = s,
                           .around = surroundings_of(s),
                           .largest_radius = mix_radii_of(s).largest,
                           .n_feeds = s->n_feeds };
        mix_footprints(s, p->footprints);
        p->arrivals = memory_alloc(p->n_feeds, sizeof *p->arrivals);
        p->states = memory_alloc(p->n_feeds, sizeof *p->states);
    }
    if (p == NULL || p->arrivals == NULL || p->states == NULL)
        status = bf_fail(err, BF_ENOMEM, "/feeds", "no memory for %zu feeds", s->n_feeds);
    for (size_t k = 0; status == BF_OK && k < p->n_feeds; k++) {
        status = feed_arrivals_create(&s->feeds[k], s->substream, &p->arrivals[k], err);
        if (status == BF_OK)
            p->states[k].next = p->states[k].first = feed_arrivals_first(p->arrivals[k]);
    }
    if (status != BF_OK) {
        feed_parts_destroy(p);
        return status;
    }
    *ret_parts = p;
    return BF_OK;
}

feed_parts *feed_parts_destroy(feed_parts *p)
{
    if (p == NULL)
        return NULL;
    for (size_t k = 0; p->arrivals != NULL && k < p->n_feeds; k++)
        feed_arrivals_destroy(p->arrivals[k]);
    memory_free(p->arrivals);
    memory_free(p->states);
    memory_free(p->bodies);
    memory_free(p->blocked);
    memory_free(p);
    return NULL;
}

static double line_length(const scene_feed *f)
{
    return vec2_length(vec2_sub(f->line[1], f->line[0]));
}

static int compare_spans(const void *a, const void *b)
{
    const double x = ((const feed_line_span *)a)->low, y = ((const feed_line_span *)b)->low;

    return (x > y) - (x < y);
}

// Fills p->blocked, by rising start, with the places that the bodies deny to the centre of a disk; returns how many.
static size_t find_blocked(feed_parts *p, const scene_feed *f, double radius, size_t n_bodies)
{
    const vec2 line = vec2_sub(f->line[1], f->line[0]);
    const double length = line_length(f);
    const vec2 along = vec2_scale(line, 1.0 / length);
    size_t n = 0;

    for (size_t k = 0; k < n_bodies; k++) {
        const vec2 from = vec2_sub(p->bodies[k].at, f->line[0]);
        const double apart =
            radius + p->footprints[p->bodies[k].kind].bounding_radius + SCENE_TOLERANCE;
        const double off = vec2_cross(along, from), at = vec2_dot(along, from);
        const double half = sqrt(fmax(apart * apart - off * off, 0.0));
        if (half > 0.0)
            p->blocked[n++] = (feed_line_span){ (at - half) / length, (at + half) / length };
    }
    if (n > 0)
        qsort(p->blocked, n, sizeof *p->blocked, compare_spans);
    return n;
}

typedef struct search {
    const scene_feed *feed;
    const feed_part *part;
    const feed_room *room;
    feed_line_span places;
} search;

static bool is_free_at(const search *in, double place, scene_pose *ret_pose)
{
    const vec2 at = feed_line_at(in->feed, place);

    *ret_pose = (scene_pose){ at.x, at.y, in->part->heading };
    return in->room->is_free(in->room->context, in->part->kind, *ret_pose);
}

// Between places that are tried one after the other.
static double step_of(const feed_parts *p, const search *in)
{
    return 0.25 * p->footprints[in->part->kind].bounding_radius;
}

// The first free place from one to before another, of which no body denies any; plates may.
static bool find_in_gap(const search *in, double from, double to, double step, int *trials,
                        scene_pose *ret_pose)
{
    const double start = from;

    for (int k = 1; from<to && * trials> 0; k++, --*trials) {
        if (is_free_at(in, from, ret_pose))
            return true;
        from = start + k * step;
    }
    return false;
}

// The first place that neither bodies nor plates deny to a disk among disks.
static bool find_gap(const feed_parts *p, const search *in, size_t n_blocked, scene_pose *ret_pose)
{
    const double step = step_of(p, in) / line_length(in->feed);
    double place = in->places.low;
    int trials = PARTS_ENTRY_TRIALS;

    for (size_t k = 0; k < n_blocked; k++) {
        const double end = fmin(p->blocked[k].low, in->places.high);
        if (find_in_gap(in, place, end, step, &trials, ret_pose))
            return true;
        place = fmax(place, p->blocked[k].high);
        if (place > in->places.high)
            return false;
    }
    return find_in_gap(in, place, in->places.high, step, &trials, ret_pose) ||
           is_free_at(in, in->places.high, ret_pose);
}

static bool scan_places(const feed_parts *p, const search *in, scene_pose *ret_pose)
{
    const double length = line_length(in->feed) * (in->places.high - in->places.low);
    const double step = step_of(p, in);
    const int n = (int)fmin(ceil(length / step), PARTS_ENTRY_TRIALS - 1);

    for (int k = 0; k <= n; k++)
        if (is_free_at(in,
                       n == 0 ? in->places.low
                              : in->places.low + (in->places.high - in->places.low) * k / n,
                       ret_pose))
            return true;
    return false;
}

// The first free place from the start of the line.
static bf_status find_first_free(feed_parts *p, const search *in, bool *ret_found,
                                 scene_pose *ret_pose, bf_error *err)
{
    const shape_footprint *footprint = &p->footprints[in->part->kind];
    // On a line without length there is one place.
    bool are_disks = footprint->n_corners == 0 && line_length(in->feed) > 0.0;
    size_t n = 0;

    if (are_disks) {
        const vec2 from = feed_line_at(in->feed, in->places.low);
        const vec2 to = feed_line_at(in->feed, in->places.high);
        const double within = footprint->bounding_radius + p->largest_radius + SCENE_TOLERANCE;
        const feed_room *room = in->room;
        const size_t n_before = p->n_bodies_max;
        n = room->near(room->context, from, to, within, p->bodies, p->n_bodies_max);
        if (memory_reserve(&p->bodies, &p->n_bodies_max, n, sizeof *p->bodies) != 0 ||
            memory_reserve(&p->blocked, &p->n_blocked_max, n, sizeof *p->blocked) != 0)
            return bf_fail(err, BF_ENOMEM, "/feeds", "no memory for %zu bodies at feed %s", n,
                           in->feed->id);
        if (n > n_before)
            room->near(room->context, from, to, within, p->bodies, p->n_bodies_max);
    }
    for (size_t k = 0; k < n; k++)
        are_disks = are_disks && p->footprints[p->bodies[k].kind].n_corners == 0;
    *ret_found =
        are_disks
            ? find_gap(p, in, find_blocked(p, in->feed, footprint->bounding_radius, n), ret_pose)
            : scan_places(p, in, ret_pose);
    return BF_OK;
}

static bf_status find_place(feed_parts *p, size_t k, const feed_part *part, const feed_room *room,
                            bool *ret_found, scene_pose *ret_pose, bf_error *err)
{
    const scene_feed *f = &p->scene->feeds[k];
    const search in = {
        f, part, room, feed_line_usable(&p->around, f, &p->footprints[part->kind], part->heading)
    };
    const double low = in.places.low, high = in.places.high;

    *ret_found = false;
    if (low > high)
        return BF_OK;
    if (part->is_placed) {
        *ret_found = is_free_at(&in, fmax(low, fmin(part->place, high)), ret_pose);
        return BF_OK;
    }
    for (uint32_t attempt = 0; attempt <= PARTS_ENTRY_DRAWS && !*ret_found; attempt++) {
        const double drawn = feed_arrivals_place(p->arrivals[k], part->number, attempt);
        *ret_found = is_free_at(&in, low + drawn * (high - low), ret_pose);
    }
    return *ret_found ? BF_OK : find_first_free(p, &in, ret_found, ret_pose, err);
}

// Admits what waits at a feed as far as there is room. A kind that has found no place in this call is not tried again: so
// the work is bounded, however many parts are discarded.
static bf_status serve(feed_parts *p, size_t k, double t, const feed_room *room, bf_error *err)
{
    const scene_feed *f = &p->scene->feeds[k];
    feed_state *state = &p->states[k];
    uint32_t refused = 0; // bit per kind
    bf_status status;

    _Static_assert(SCENE_KINDS_MAX <= 32, "a bit per kind");
    for (; state->first.number < state->next.number;
         feed_arrivals_next(p->arrivals[k], &state->first)) {
        const feed_part part = feed_arrivals_part(p->arrivals[k], &state->first);
        const uint32_t bit = UINT32_C(1) << part.kind;
        feed_admission admission = { k, part.number, part.kind, { 0.0, 0.0, 0.0 }, t - part.due };
        bool is_found = false;
        if (!state->is_held && (part.is_placed || !(refused & bit)) &&
            (status = find_place(p, k, &part, room, &is_found, &admission.pose, err)) != BF_OK)
            return status;
        if (is_found) {
            if ((status = room->admit(room->context, &admission, err)) != BF_OK)
                return status;
            state->n_admitted++;
            continue;
        }
        if (f->when_blocked != SCENE_BLOCKED_DISCARD || t - part.due < f->max_wait)
            return BF_OK;
        refused |= part.is_placed ? 0 : bit;
    }
    return BF_OK;
}

bf_status feed_parts_advance(feed_parts *p, double t, const feed_room *room, bf_error *err)
{
    const size_t turn = p->n_feeds > 0 ? (size_t)(p->n_turns++ % p->n_feeds) : 0;
    bf_status status = BF_OK;

    for (size_t n = 0; status == BF_OK && n < p->n_feeds; n++) {
        const size_t k = (turn + n) % p->n_feeds;
        while (p->states[k].next.due <= t)
            feed_arrivals_next(p->arrivals[k], &p->states[k].next);
        status = serve(p, k, t, room, err);
    }
    return status;
}

void feed_parts_hold(feed_parts *p, size_t feed, bool is_held)
{
    p->states[feed].is_held = is_held;
}

feed_balance feed_parts_balance(const feed_parts *p, size_t feed)
{
    const feed_state *state = &p->states[feed];
    const uint64_t n_served = state->first.number - 1;

    return (feed_balance){
        .offered = (double)(state->next.number - 1),
        .admitted = (double)state->n_admitted,
        .waiting = (double)(state->next.number - state->first.number),
        .discarded = (double)(n_served - state->n_admitted),
    };
}

bool feed_parts_are_exhausted(const feed_parts *p)
{
    bool are_exhausted = true;

    for (size_t k = 0; k < p->n_feeds; k++)
        are_exhausted = are_exhausted && !isfinite(p->states[k].next.due) &&
                        p->states[k].first.number == p->states[k].next.number;
    return are_exhausted;
}

void feed_parts_save(const feed_parts *p, checkpoint_writer *w)
{
    checkpoint_write(w, &p->n_turns, sizeof p->n_turns);
    checkpoint_write(w, p->states, p->n_feeds * sizeof *p->states);
}

bool feed_parts_load(feed_parts *p, checkpoint_reader *r)
{
    return checkpoint_read(r, &p->n_turns, sizeof p->n_turns) &&
           checkpoint_read(r, p->states, p->n_feeds * sizeof *p->states);
}
