#include "core/scene/definition.h"

#include "core/base/digest.h"
#include "core/scene/cells.h"
#include "core/scene/scene.h"

#include <string.h>

// Structs are added member by member where they have padding or pointers, else as bytes.
_Static_assert(sizeof(scene_rect) == 4 * sizeof(double), "no padding");
_Static_assert(sizeof(scene_material) == 2 * sizeof(double), "no padding");
_Static_assert(sizeof(scene_contact) == 5 * sizeof(double), "no padding");
_Static_assert(sizeof(scene_pose) == 3 * sizeof(double), "no padding");
_Static_assert(sizeof(vec2) == 2 * sizeof(double), "no padding");

// The digest with n items of an array added to it.
#define ADD_ITEMS(digest, items, n) digest_add(digest, items, (n) * sizeof *(items))

// The digest with numbers, integers below 2^53 among them, added to it.
#define ADD_NUMBERS(digest, ...)                                                                   \
    digest_add(digest, (const double[]){ __VA_ARGS__ }, sizeof((const double[]){ __VA_ARGS__ }))

// Nothing for a belt of constant speed.
static uint64_t add_speed(uint64_t digest, const scene_belt *belt)
{
    const scene_speed_schedule *s = &belt->speed_schedule;

    if (s->n_times == 0 && !belt->is_commanded)
        return digest;
    digest = ADD_NUMBERS(digest, (double)s->n_times, belt->acceleration, belt->deceleration);
    digest = ADD_ITEMS(digest, s->times, s->n_times);
    return ADD_ITEMS(digest, s->factors, s->n_times);
}

static uint64_t add_drawn_time(uint64_t digest, const scene_drawn_time *t)
{
    return ADD_NUMBERS(digest, t->mean, t->law, t->shape);
}

// Nothing for a belt that nothing stops.
static uint64_t add_stops(uint64_t digest, const scene_belt *belt)
{
    const scene_stops *s = &belt->stops;

    if (s->n_failures == 0 && s->n_breaks == 0)
        return digest;
    digest = ADD_NUMBERS(digest, (double)s->n_failures, (double)s->n_breaks, (double)s->substream,
                         belt->acceleration, belt->deceleration);
    for (size_t k = 0; k < s->n_failures; k++) {
        const scene_failure *f = &s->failures[k];
        digest = digest_add(digest, f->id, strlen(f->id)); // of which the draws depend
        digest = ADD_NUMBERS(digest, f->type);
        digest = add_drawn_time(add_drawn_time(digest, &f->between), &f->repair);
        digest = ADD_ITEMS(digest, f->times, f->n_times);
        digest = ADD_ITEMS(digest, f->durations, f->n_times);
    }
    for (size_t k = 0; k < s->n_breaks; k++)
        digest = ADD_NUMBERS(digest, s->breaks[k].start, s->breaks[k].duration, s->breaks[k].every);
    return digest;
}

static uint64_t add_belts(uint64_t digest, size_t n, const scene_belt *belts)
{
    for (size_t k = 0; k < n; k++) {
        digest = ADD_NUMBERS(digest, belts[k].velocity.x, belts[k].velocity.y);
        if (belts[k].turn != 0.0 || belts[k].arc.is_given)
            digest = ADD_NUMBERS(digest, belts[k].turn, belts[k].centre.x, belts[k].centre.y);
        if (belts[k].friction > 0.0)
            digest = ADD_NUMBERS(digest, belts[k].friction);
        if (belts[k].incline != 0.0)
            digest = ADD_NUMBERS(digest, belts[k].incline);
        digest = add_stops(add_speed(digest, &belts[k]), &belts[k]);
        digest = ADD_ITEMS(digest, belts[k].polygon, belts[k].n_points);
        if (belts[k].path.n_points > 0)
            digest = ADD_NUMBERS(digest, (double)belts[k].path.n_points, belts[k].path.width);
        digest = ADD_ITEMS(digest, belts[k].path.points, belts[k].path.n_points);
        digest = ADD_ITEMS(digest, belts[k].path.radii, belts[k].path.n_radii);
    }
    return digest;
}

static uint64_t add_cargo(uint64_t digest, const scene *s)
{
    const scene_initial *i = &s->initial;

    for (size_t k = 0; k < s->n_cargo; k++) {
        const scene_cargo *c = &s->cargo[k];
        const scene_shape *shape = &c->shape;
        digest = ADD_NUMBERS(digest, c->share, c->mass, c->spin_friction_radius, shape->type,
                             shape->radius, shape->height, shape->length, shape->width);
        digest = ADD_ITEMS(digest, shape->vertices, shape->n_vertices);
        digest = ADD_ITEMS(digest, &c->material, 1);
    }
    digest = ADD_NUMBERS(digest, (double)s->cargo_seed, i->type);
    switch (i->type) {
    case SCENE_INITIAL_POSITIONS:
        return ADD_ITEMS(digest, i->poses, i->n_poses);
    case SCENE_INITIAL_HEXAGONAL:
        return ADD_NUMBERS(digest, i->n_rows, i->n_columns, i->first.x, i->first.y, i->spacing);
    case SCENE_INITIAL_RANDOM:
        digest = ADD_NUMBERS(digest, i->n_random, (double)i->seed);
        return ADD_ITEMS(digest, &i->region, 1);
    case SCENE_INITIAL_EMPTY:
    case SCENE_INITIAL_COUNT:
        break;
    }
    return digest;
}

static uint64_t add_series(uint64_t digest, const scene_series *s)
{
    digest = ADD_NUMBERS(digest, (double)s->n_times, s->repeat);
    digest = ADD_ITEMS(digest, s->times, s->n_times);
    return ADD_ITEMS(digest, s->values, s->n_values);
}

// An array of a list of arrivals that may be missing.
static uint64_t add_array(uint64_t digest, const void *array, size_t n, size_t size)
{
    digest = ADD_NUMBERS(digest, array != NULL);
    return array != NULL ? digest_add(digest, array, n * size) : digest;
}

static uint64_t add_feed(uint64_t digest, const scene_feed *f)
{
    const scene_arrival_list *l = &f->schedule;

    digest = digest_add(digest, f->id, strlen(f->id)); // of which the draws depend
    digest = ADD_NUMBERS(digest, f->is_edge, f->line[0].x, f->line[0].y, f->line[1].x, f->line[1].y,
                         f->start, f->end, f->count, f->arrivals, f->shape, f->batch_size,
                         f->demand, f->rate, f->has_random_heading, f->heading, f->when_blocked,
                         f->max_wait, (double)f->seed, (double)f->n_cargo);
    for (size_t k = 0; k < f->n_cargo; k++)
        digest = ADD_NUMBERS(digest, f->cargo[k].kind, f->cargo[k].share);
    digest = add_series(digest, &f->profile);
    digest = ADD_NUMBERS(digest, (double)l->n);
    digest = add_array(digest, l->times, l->n, sizeof *l->times);
    digest = add_array(digest, l->counts, l->n, sizeof *l->counts);
    digest = add_array(digest, l->kinds, l->n, sizeof *l->kinds);
    digest = add_array(digest, l->places, l->n, sizeof *l->places);
    return add_array(digest, l->headings, l->n, sizeof *l->headings);
}

// Nothing where there are no feeds, nothing moves and there are neither photo eyes nor sinks.
static uint64_t add_equipment(uint64_t digest, const scene *s)
{
    if (s->n_feeds > 0)
        digest = ADD_NUMBERS(digest, (double)s->n_feeds, (double)s->substream);
    for (size_t k = 0; k < s->n_feeds; k++)
        digest = add_feed(digest, &s->feeds[k]);
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *o = &s->obstacles[k];
        if (!scene_obstacle_moves(o))
            continue;
        digest = ADD_NUMBERS(digest, (double)k, o->pivot.x, o->pivot.y);
        digest = add_series(add_series(digest, &o->turn), &o->presence);
        if (o->n_shifts > 0)
            digest = ADD_ITEMS(ADD_NUMBERS(digest, (double)o->n_shifts), o->shifts, o->n_shifts);
        if (o->force_limit > 0.0)
            digest = ADD_NUMBERS(digest, o->force_limit);
    }
    for (size_t k = 0; k < s->n_eyes; k++) {
        const scene_photo_eye *e = &s->eyes[k];
        digest = ADD_NUMBERS(digest, e->line[0].x, e->line[0].y, e->line[1].x, e->line[1].y,
                             e->block_time, e->clear_time, e->density_ratio);
    }
    for (size_t k = 0; k < s->n_sinks; k++) {
        const scene_sink *sink = &s->sinks[k];
        digest = ADD_NUMBERS(digest, (double)sink->n_points, (double)sink->n_kinds, sink->rate);
        digest = ADD_ITEMS(digest, sink->polygon, sink->n_points);
        digest = ADD_ITEMS(digest, sink->kinds, sink->n_kinds);
    }
    for (size_t k = 0; k < s->n_actions; k++) {
        const scene_action *a = &s->actions[k];
        digest = ADD_NUMBERS(digest, (double)a->eye, a->when_blocked, a->delay, a->type,
                             (double)a->target, a->value, a->over);
        if (a->type == SCENE_ACTION_SHIFT)
            digest = ADD_NUMBERS(digest, a->shift.x, a->shift.y);
        if (a->kind != SCENE_KIND_ANY)
            digest = ADD_NUMBERS(digest, a->kind);
    }
    for (size_t k = 0; k < s->n_merges; k++) {
        const scene_merge *merge = &s->merges[k];
        digest = ADD_NUMBERS(digest, (double)merge->n_lanes, merge->order, merge->parts,
                             merge->time, merge->gap);
        for (size_t i = 0; i < merge->n_lanes; i++)
            digest = ADD_NUMBERS(digest, (double)merge->lanes[i].belt, (double)merge->lanes[i].eye);
    }
    return digest;
}

// Nothing where a run gives results at one pace from its start to its duration.
static uint64_t add_schedule(uint64_t digest, const scene *s)
{
    if (s->warmup > 0.0)
        digest = ADD_NUMBERS(digest, s->warmup);
    if (s->jam_time != SCENE_JAM_TIME)
        digest = ADD_NUMBERS(digest, s->jam_time);
    if (s->until != SCENE_UNTIL_DURATION)
        digest = ADD_NUMBERS(digest, s->until, s->steady_precision);
    for (size_t k = 0; k < s->output.n_windows; k++) {
        const scene_output_window *w = &s->output.windows[k];
        digest = ADD_NUMBERS(digest, w->from, w->to, w->curve_every, w->snapshot_every);
    }
    return digest;
}

uint64_t definition_digest(const scene *s)
{
    const scene_macro *macro = &s->macro;
    const scene_micro *micro = &s->micro;
    uint64_t digest = ADD_ITEMS(DIGEST_START, &s->domain, 1);

    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        digest = ADD_NUMBERS(digest, s->edges[side]);
    digest = add_belts(digest, s->n_belts, s->belts);
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *o = &s->obstacles[k];
        digest = ADD_NUMBERS(digest, o->thickness, o->treatment, o->band, o->slide_width);
        digest = ADD_ITEMS(digest, o->path, o->n_points);
    }
    digest = add_cargo(digest, s);
    for (size_t k = 0; k < s->n_counters; k++) {
        digest = ADD_ITEMS(digest, &s->counters[k].rect, 1);
        if (s->counters[k].kind != SCENE_KIND_ANY)
            digest = ADD_NUMBERS(digest, s->counters[k].kind);
    }
    digest = ADD_NUMBERS(digest, s->duration, s->output.curve_every, s->output.snapshot_every);
    digest = ADD_NUMBERS(digest, cells_wanted(s), macro->step, macro->scheme, macro->heaviside,
                         macro->heaviside_width, macro->dispersion, macro->mollifier,
                         macro->initial_mollifier, macro->packing);
    if (macro->closure != SCENE_DISPERSIVE)
        digest = ADD_NUMBERS(digest, macro->closure, macro->jam_density);
    digest = add_schedule(add_equipment(digest, s), s);
    digest = ADD_NUMBERS(digest, micro->integrator, micro->path, micro->step,
                         micro->modulus_reduction, micro->overlap_limit, micro->tension,
                         micro->damping, micro->gravity, micro->spin_friction_radius);
    digest = ADD_ITEMS(digest, &micro->conveyor, 1);
    digest = ADD_ITEMS(digest, &micro->handling, 1);
    digest = ADD_ITEMS(digest, micro->contact, SCENE_PAIR_COUNT);
    return micro->wall_friction > 0.0 ? ADD_NUMBERS(digest, micro->wall_friction) : digest;
}
