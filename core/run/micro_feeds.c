#include "core/run/micro_feeds.h"

#include "core/base/memory.h"
#include "core/scene/counter.h"
#include "core/scene/mix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEPARTURES_AT_ONCE = 64 };

_Static_assert(sizeof(micro_tag) == 40, "no padding");
_Static_assert((int)SCENE_COUNTERS_MAX <= 32, "each counter has a bit of a tag");

static bf_status reserve_tags(micro_feeds *f, size_t n, bf_error *err)
{
    if (memory_reserve(&f->tags, &f->n_tags_max, n, sizeof *f->tags) == 0)
        return BF_OK;
    return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts", n);
}

vec2 micro_feeds_counted_place(const scene *s, vec2 at)
{
    const scene_rect *d = &s->domain;

    if (s->n_feeds == 0)
        return at;
    // A counter does not hold its upper borders.
    return (vec2){ fmin(fmax(at.x, d->x_min), nextafter(d->x_max, d->x_min)),
                   fmin(fmax(at.y, d->y_min), nextafter(d->y_max, d->y_min)) };
}

// The counters that count a part of a kind which is there.
static uint32_t counters_at(const scene *s, uint32_t kind, vec2 at)
{
    const vec2 counted = micro_feeds_counted_place(s, at);
    uint32_t counters = 0;

    for (size_t k = 0; k < s->n_counters; k++)
        counters |= (uint32_t)(counter_counts(&s->counters[k], kind) &&
                               counter_holds(&s->counters[k], counted))
                    << k;
    return counters;
}

// Adds to what has left some of the counters.
static void add_left(micro_feeds *f, uint32_t counters, double parts)
{
    for (size_t k = 0; k < f->scene->n_counters; k++)
        f->flows[k] += (counters >> k & 1U) != 0 ? parts : 0.0;
}

static void count_departure(micro_feeds *f, const micro_tag *tag, const micro_departure *departure)
{
    const vec2 at = micro_feeds_counted_place(f->scene, departure->at);

    if (departure->has_fallen)
        return;
    add_left(f, tag->counters, 1.0);
    const size_t outlet = figure_outlet(f->scene, surroundings_belt_at(&f->around, at));
    if (!tag->is_taken && outlet < f->n_flows - f->scene->n_counters)
        f->flows[f->scene->n_counters + outlet] += 1.0;
}

bf_status micro_feeds_init(micro_feeds *f, const scene *s, micro_solver *solver,
                           const scene_placement *placement, bf_error *err)
{
    *f = (micro_feeds){ .scene = s,
                        .solver = solver,
                        .around = surroundings_of(s),
                        .n_flows = s->n_counters + figure_items(s, FIGURE_OF_OUTLET) };
    f->flows = memory_alloc(f->n_flows, sizeof *f->flows);
    if (f->flows == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the parts that leave");
    bf_status status = reserve_tags(f, placement->n, err);
    for (size_t k = 0; k < placement->n && status == BF_OK; k++)
        f->tags[k] = (micro_tag){ .feed = (uint32_t)s->n_feeds,
                                  .kind = mix_kind(placement->kinds, k),
                                  .sink = (uint32_t)s->n_sinks,
                                  .counters = counters_at(
                                      s, mix_kind(placement->kinds, k),
                                      (vec2){ placement->poses[k].x, placement->poses[k].y }) };
    if (status == BF_OK && s->n_feeds > 0)
        status = feed_parts_create(s, &f->entry, err);
    return status;
}

void micro_feeds_fini(micro_feeds *f)
{
    feed_parts_destroy(f->entry);
    memory_free(f->tags);
    memory_free(f->departures);
    memory_free(f->flows);
    *f = (micro_feeds){ .scene = NULL };
}

static double time_now(const micro_feeds *f)
{
    return (double)micro_steps(f->solver) * micro_dt(f->solver);
}

static int compare_ids(const void *left, const void *right)
{
    const run_departure *a = left, *b = right;

    return (a->id > b->id) - (a->id < b->id);
}

bf_status micro_feeds_depart(micro_feeds *f, run_departures *ret_departures, bf_error *err)
{
    const double t = time_now(f);
    micro_departure some[DEPARTURES_AT_ONCE];
    size_t n = 0, n_some = DEPARTURES_AT_ONCE;

    while (n_some == DEPARTURES_AT_ONCE) {
        if (memory_reserve(&f->departures, &f->n_departures_max, n + DEPARTURES_AT_ONCE,
                           sizeof *f->departures) != 0)
            return bf_fail(err, BF_ENOMEM, "", "no memory for parts that left");
        n_some = micro_take_departures(f->solver, some, DEPARTURES_AT_ONCE);
        for (size_t k = 0; k < n_some; k++) {
            const micro_tag *tag = &f->tags[some[k].part];
            count_departure(f, tag, &some[k]);
            f->departures[n++] = (run_departure){ .id = some[k].id,
                                                  .kind = tag->kind,
                                                  .feed = tag->feed,
                                                  .entered = tag->entered,
                                                  .left = t,
                                                  .at = some[k].at,
                                                  .has_fallen = some[k].has_fallen };
        }
    }
    // Parts may tremble on a border: one that comes back has not left.
    for (size_t k = 0; k < micro_parts(f->solver); k++) {
        if (micro_is_gone(f->solver, k))
            continue;
        micro_tag *tag = &f->tags[k];
        const micro_part part = micro_part_of(f->solver, k);
        const uint32_t now = counters_at(f->scene, tag->kind, (vec2){ part.x[0], part.x[1] });
        const uint32_t out = tag->counters & ~now, back = now & tag->left;
        add_left(f, out, 1.0);
        add_left(f, back, -1.0);
        tag->left = (tag->left | out) & ~back;
        tag->counters = now;
    }
    qsort(f->departures, n, sizeof *f->departures, compare_ids);
    *ret_departures = (run_departures){ .n = n, .items = f->departures };
    return BF_OK;
}

// The questions of feed_room; one that fails is remembered, since feeds take only answers.
static bool is_free(void *context, uint32_t kind, scene_pose pose)
{
    micro_feeds *f = context;
    bool is_so = false;

    if (f->query_error.code == BF_OK &&
        micro_is_free(f->solver, kind, pose, &is_so, &f->query_error) != BF_OK)
        return false;
    return is_so;
}

// Bodies near a line.
typedef struct nearby {
    feed_body *bodies;
    size_t n, n_max;
} nearby;

static void add_body(void *context, size_t part, const micro_extent *extent)
{
    nearby *found = context;

    (void)part;
    if (found->n < found->n_max)
        found->bodies[found->n] = (feed_body){ { extent->pose.x, extent->pose.y }, extent->kind };
    found->n++;
}

static size_t find_near(void *context, vec2 start, vec2 end, double within, feed_body *ret_bodies,
                        size_t n_max)
{
    micro_feeds *f = context;
    nearby found = { .bodies = ret_bodies, .n_max = n_max };

    if (f->query_error.code == BF_OK &&
        micro_visit_near(f->solver, start, end, within, add_body, &found, &f->query_error) != BF_OK)
        return 0;
    return found.n;
}

static bf_status admit(void *context, const feed_admission *part, bf_error *err)
{
    micro_feeds *f = context;
    const vec2 at = { part->pose.x, part->pose.y };
    const micro_arrival arrival = { .kind = part->kind,
                                    .pose = part->pose,
                                    .velocity = micro_belt_velocity(f->solver, at) };
    size_t handle;

    // A place that was found free without an answer is none.
    if (f->query_error.code != BF_OK)
        return BF_ENOMEM;
    bf_status status = reserve_tags(f, micro_parts(f->solver) + 1, err);
    if (status == BF_OK)
        status = micro_admit(f->solver, &arrival, &handle, err);
    if (status != BF_OK)
        return status;
    f->tags[handle] = (micro_tag){ .entered = time_now(f),
                                   .feed = (uint32_t)part->feed,
                                   .kind = part->kind,
                                   .counters = counters_at(f->scene, part->kind, at),
                                   .sink = (uint32_t)f->scene->n_sinks };
    figures_wait(f->figures, part->feed, part->wait);
    return BF_OK;
}

bf_status micro_feeds_admit(micro_feeds *f, figures *to, bf_error *err)
{
    const feed_room room = { .context = f, .is_free = is_free, .near = find_near, .admit = admit };

    f->figures = to;
    f->query_error = (bf_error){ .code = BF_OK };
    const bf_status status = feed_parts_advance(f->entry, time_now(f), &room, err);
    if (f->query_error.code == BF_OK)
        return status;
    return bf_fail(err, f->query_error.code, f->query_error.pointer, "%s", f->query_error.text);
}

void micro_feeds_count_steps(micro_feeds *f, uint64_t n)
{
    size_t n_present = 0;

    for (size_t k = 0; k < micro_parts(f->solver); k++)
        n_present += micro_is_gone(f->solver, k) ? 0 : 1;
    f->part_steps += (double)n * (double)n_present;
}

double micro_feeds_age(const micro_feeds *f, size_t part)
{
    return time_now(f) - f->tags[part].entered;
}

double micro_feeds_entered(const micro_feeds *f)
{
    double n = 0.0;

    for (size_t k = 0; k < f->scene->n_feeds; k++)
        n += feed_parts_balance(f->entry, k).admitted;
    return n;
}

bf_status micro_feeds_save(const micro_feeds *f, checkpoint_writer *w, bf_error *err)
{
    const uint64_t n = micro_parts(f->solver);

    if (f->entry != NULL)
        feed_parts_save(f->entry, w);
    checkpoint_write(w, &f->part_steps, sizeof f->part_steps);
    checkpoint_write(w, f->flows, f->n_flows * sizeof *f->flows);
    checkpoint_write(w, &n, sizeof n);
    checkpoint_write(w, f->tags, n * sizeof *f->tags);
    return micro_save(f->solver, w->out, err);
}

bf_status micro_feeds_load(micro_feeds *f, checkpoint_reader *r, bf_error *err)
{
    uint64_t n = 0;

    if ((f->entry != NULL && !feed_parts_load(f->entry, r)) ||
        !checkpoint_read(r, &f->part_steps, sizeof f->part_steps) ||
        !checkpoint_read(r, f->flows, f->n_flows * sizeof *f->flows) ||
        !checkpoint_read(r, &n, sizeof n) || n > r->n_left / sizeof *f->tags)
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint has a wrong length");
    bf_status status = reserve_tags(f, n, err);
    if (status != BF_OK)
        return status;
    if (!checkpoint_read(r, f->tags, n * sizeof *f->tags))
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint has a wrong length");
    status = micro_load(f->solver, r->at, r->n_left, err);
    return status == BF_OK && micro_parts(f->solver) != n
               ? bf_fail(err, BF_ECORRUPT, "", "the saved feeds are of other parts")
               : status;
}
