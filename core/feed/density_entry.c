#include "core/feed/density_entry.h"

#include "core/base/memory.h"
#include "core/feed/arrivals.h"
#include "core/feed/line_cells.h"
#include "core/scene/feed_line.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Cells are filled up to this below 1, so that a feed alone never starts the dispersion.
static const double below_saturated = 1e-12;

static const double exhausted_below = 1e-6; // parts

// What a feed fills.
typedef struct cell_entry {
    size_t cell;
    size_t
        inner; // of a line on a side: the cell behind it, which takes what this one cannot; else the same
    vec2 at;         // of its line the point that is nearest to its centre
    double weight;   // of its share: the length of the line in it
    double capacity; // most density in a step at the factor 1 of its belt; INFINITY: no bound
    size_t belt;
} cell_entry;

// What a cell takes in a step.
typedef struct cell_room {
    double room;  // density
    double level; // room/weight
    size_t entry;
} cell_room;

// The state of a feed, as it is saved; parts.
typedef struct feed_state {
    double offered;
    double admitted;
    double discarded;
    uint64_t is_held; // 0 or 1
} feed_state;

// The next parts of a feed, as it is saved.
typedef struct feed_parts {
    feed_cursor arriving; // the first one that has not arrived
    feed_cursor overdue;  // the first one that is not dropped yet
    feed_cursor entering; // the one of which some enters next
} feed_parts;

typedef struct feed_line {
    feed_arrivals *arrivals;
    size_t n;
    cell_entry *cells;
    double weight; // of all cells
} feed_line;

struct feed_density {
    const scene *scene;
    double saturated;      // rho_p
    double parts_per_cell; // at density 1
    bool tells_kinds;
    bool is_by_parts; // what is offered are parts, and not Lambda
    size_t n_feeds;
    feed_line *lines;
    feed_state *states;
    feed_parts *parts; // of each feed, also where kinds are not told apart
    uint64_t n_turns;  // calls of feed_density_advance()
    cell_room *rooms;  // scratch: as many as the longest line has cells
};

// The cell behind one that lies beside a side; the same if there is none.
static size_t inner_cell(const bf_grid *grid, scene_side side, size_t cell)
{
    switch (side) {
    case SCENE_WEST:
        return grid->n1 > 1 ? cell + 1 : cell;
    case SCENE_EAST:
        return grid->n1 > 1 ? cell - 1 : cell;
    case SCENE_SOUTH:
        return grid->n2 > 1 ? cell + grid->n1 : cell;
    default:
        return grid->n2 > 1 ? cell - grid->n1 : cell;
    }
}

static vec2 nearest_on(const vec2 *line, vec2 to)
{
    const vec2 along = vec2_sub(line[1], line[0]);
    const double square = vec2_dot(along, along);
    const double part = square > 0.0 ? vec2_dot(vec2_sub(to, line[0]), along) / square : 0.0;

    return vec2_add(line[0], vec2_scale(along, fmin(fmax(part, 0.0), 1.0)));
}

static bf_status make_line(const feed_density *d, const scene_feed *f, double dt,
                           feed_line *ret_line, bf_error *err)
{
    const bf_grid grid = scene_grid(d->scene);
    const surroundings around = surroundings_of(d->scene);
    line_cell *cells = NULL;
    const vec2 inward =
        f->is_edge ? surroundings_side(&around, f->edge).inward : (vec2){ 0.0, 0.0 };
    vec2 line[2];

    feed_line_widened(d->scene, f, line);
    // A line on a side lies in the cells beside it, not on their border.
    const vec2 within = { 0.5 * grid.d1 * inward.x, 0.5 * grid.d2 * inward.y };
    bf_status status = line_cells_find(&grid, vec2_add(line[0], within), vec2_add(line[1], within),
                                       &cells, &ret_line->n, err);
    if (status != BF_OK)
        return status;
    if ((ret_line->cells = memory_alloc(ret_line->n, sizeof *ret_line->cells)) == NULL)
        status = bf_fail(err, BF_ENOMEM, "/feeds", "no memory for the line of feed %s", f->id);
    for (size_t k = 0; status == BF_OK && k < ret_line->n; k++) {
        const size_t cell = cells[k].cell;
        const vec2 centre = { grid_x1(&grid, cell % grid.n1), grid_x2(&grid, cell / grid.n1) };
        const size_t belt = surroundings_belt_at(&around, centre);
        const vec2 velocity = surroundings_velocity_at(&around, belt, centre);
        double capacity = belt < around.n_belts ? INFINITY : 0.0;
        if (f->is_edge) // what its belt carries on in a step of a packed cell, of the line's length in it
            capacity = d->saturated * (fmax(vec2_dot(inward, velocity), 0.0) * dt *
                                       cells[k].length / (grid.d1 * grid.d2));
        ret_line->cells[k] =
            (cell_entry){ .cell = cell,
                          .inner = f->is_edge ? inner_cell(&grid, f->edge, cell) : cell,
                          .at = nearest_on(f->line, centre),
                          .weight = cells[k].length,
                          .capacity = capacity,
                          .belt = belt };
        ret_line->weight += cells[k].length;
    }
    memory_free(cells);
    return status;
}

bf_status feed_density_create(const scene *s, double dt, feed_density **ret_density, bf_error *err)
{
    feed_density *d = memory_alloc(1, sizeof *d);
    bf_status status = BF_OK;
    size_t n_most = 0;

    if (d != NULL) {
        const bf_grid grid = scene_grid(s);
        *d = (feed_density){ .scene = s,
                             .tells_kinds = scene_tells_kinds(s),
                             .is_by_parts = scene_acts_by_kind(s),
                             .n_feeds = s->n_feeds };
        d->saturated =
            s->macro.closure == SCENE_CONGESTED ? s->macro.jam_density : 1.0 - below_saturated;
        d->parts_per_cell = scene_packing_density(s) * grid.d1 * grid.d2;
        d->lines = memory_alloc(s->n_feeds, sizeof *d->lines);
        d->states = memory_alloc(s->n_feeds, sizeof *d->states);
        d->parts = memory_alloc(s->n_feeds, sizeof *d->parts);
    }
    if (d == NULL || d->lines == NULL || d->states == NULL || d->parts == NULL)
        status = bf_fail(err, BF_ENOMEM, "/feeds", "no memory for %zu feeds", s->n_feeds);
    for (size_t k = 0; status == BF_OK && k < s->n_feeds; k++) {
        feed_line *line = &d->lines[k];
        status = feed_arrivals_create(&s->feeds[k], s->substream, &line->arrivals, err);
        if (status == BF_OK)
            status = make_line(d, &s->feeds[k], dt, line, err);
        if (status == BF_OK) {
            const feed_cursor first = feed_arrivals_first(line->arrivals);
            d->parts[k] = (feed_parts){ first, first, first };
        }
        n_most = line->n > n_most ? line->n : n_most;
    }
    if (status == BF_OK && (d->rooms = memory_alloc(n_most, sizeof *d->rooms)) == NULL)
        status = bf_fail(err, BF_ENOMEM, "/feeds", "no memory for %zu cells of feeds", n_most);
    if (status != BF_OK) {
        feed_density_destroy(d);
        return status;
    }
    *ret_density = d;
    return BF_OK;
}

feed_density *feed_density_destroy(feed_density *d)
{
    if (d == NULL)
        return NULL;
    for (size_t k = 0; d->lines != NULL && k < d->n_feeds; k++) {
        feed_arrivals_destroy(d->lines[k].arrivals);
        memory_free(d->lines[k].cells);
    }
    memory_free(d->lines);
    memory_free(d->states);
    memory_free(d->parts);
    memory_free(d->rooms);
    memory_free(d);
    return NULL;
}

// By rising level; in the order of the line where they are equal.
static int compare_rooms(const void *a, const void *b)
{
    const cell_room *x = a, *y = b;

    if (x->level != y->level)
        return x->level > y->level ? 1 : -1;
    return (x->entry > y->entry) - (x->entry < y->entry);
}

static double free_in(const feed_density *d, size_t cell, const feed_field *field)
{
    return fmax(d->saturated - field->density(field->context, cell), 0.0);
}

// What of each kind enters while S grows from one value to another.
static void find_fractions(feed_density *d, size_t feed, double from, double to,
                           double ret_fractions[SCENE_KINDS_MAX])
{
    feed_cursor *cursor = &d->parts[feed].entering;
    const feed_arrivals *arrivals = d->lines[feed].arrivals;
    double at = from;

    memset(ret_fractions, 0, SCENE_KINDS_MAX * sizeof *ret_fractions);
    while (isfinite(cursor->due)) {
        const feed_part part = feed_arrivals_part(arrivals, cursor);
        feed_cursor next = *cursor;
        feed_arrivals_next(arrivals, &next);
        // The last part stays for what rounding leaves.
        const bool is_last = (double)part.number >= to || !isfinite(next.due);
        const double end = is_last ? to : (double)part.number;
        if (end > at) {
            ret_fractions[part.kind] += (end - at) / (to - from);
            at = end;
        }
        if (is_last)
            return;
        *cursor = next;
    }
    // There is no part, and next to nothing enters.
    ret_fractions[0] = 1.0;
}

// Adds a density to a cell, of the kinds that are next when `taken` of this call have entered. Returns what has entered then.
static double add_to_cell(feed_density *d, size_t feed, const cell_entry *c, size_t cell,
                          double density, double taken, const feed_field *field)
{
    const feed_state *state = &d->states[feed];
    const double served = state->admitted + state->discarded;
    double fractions[SCENE_KINDS_MAX];

    if (!(density > 0.0))
        return taken;
    if (d->tells_kinds)
        find_fractions(d, feed, served + d->parts_per_cell * taken,
                       served + d->parts_per_cell * (taken + density), fractions);
    field->add(field->context, cell, density, c->at, d->tells_kinds ? fractions : NULL);
    return taken + density;
}

// Spreads a demand, a sum of densities, over the cells of a feed's line. Returns what they took.
static double fill_line(feed_density *d, size_t feed, double demand, const feed_field *field)
{
    const feed_line *line = &d->lines[feed];
    double left = demand, weight = line->weight, taken = 0.0;
    bool is_enough = true; // each cell takes its share of the demand

    for (size_t k = 0; k < line->n; k++) {
        const cell_entry *c = &line->cells[k];
        const double free =
            free_in(d, c->cell, field) + (c->inner != c->cell ? free_in(d, c->inner, field) : 0.0);
        // The bound first: infinity times the factor 0 is no number.
        const double most = isinf(c->capacity)
                                ? c->capacity
                                : c->capacity * fmax(field->factor(field->context, c->belt), 0.0);
        const double room = fmin(free, most);
        d->rooms[k] = (cell_room){ room, room / c->weight, k };
        is_enough = is_enough && d->rooms[k].level * line->weight >= demand;
    }
    if (!is_enough)
        qsort(d->rooms, line->n, sizeof *d->rooms, compare_rooms);
    for (size_t k = 0; k < line->n; k++) {
        const cell_entry *c = &line->cells[d->rooms[k].entry];
        // The cells with the lowest levels come first: once one takes its share, so do all that follow.
        const double amount =
            fmin(d->rooms[k].room, weight > c->weight ? left * (c->weight / weight) : left);
        // Adds a density to a cell as far as it is free, and the rest to the one behind it.
        const double first =
            c->inner != c->cell ? fmin(amount, free_in(d, c->cell, field)) : amount;
        (void)add_to_cell(d, feed, c, c->inner, amount - first,
                          add_to_cell(d, feed, c, c->cell, first, taken, field), field);
        taken += amount;
        left = fmax(left - amount, 0.0);
        weight -= c->weight;
    }
    return taken;
}

// What a feed offers until t. Part by part it is what is before *next, which is moved on.
static double offered_until(const feed_density *d, size_t feed, feed_cursor *next, double t)
{
    const feed_arrivals *arrivals = d->lines[feed].arrivals;

    if (!d->is_by_parts)
        return feed_arrivals_until(arrivals, t);
    while (next->due <= t)
        feed_arrivals_next(arrivals, next);
    return (double)(next->number - 1);
}

void feed_density_advance(feed_density *d, double t, const feed_field *field)
{
    const size_t turn = d->n_feeds > 0 ? (size_t)(d->n_turns++ % d->n_feeds) : 0;

    for (size_t n = 0; n < d->n_feeds; n++) {
        const size_t k = (turn + n) % d->n_feeds;
        const scene_feed *f = &d->scene->feeds[k];
        feed_parts *parts = &d->parts[k];
        feed_state *state = &d->states[k];
        state->offered = offered_until(d, k, &parts->arriving, t);
        const double waiting = state->offered - state->admitted - state->discarded;
        if (!state->is_held && waiting > 0.0)
            state->admitted +=
                d->parts_per_cell * fill_line(d, k, waiting / d->parts_per_cell, field);
        if (f->when_blocked == SCENE_BLOCKED_DISCARD) {
            const double served = state->admitted + state->discarded;
            const double overdue = offered_until(d, k, &parts->overdue, t - f->max_wait);
            state->discarded += fmax(overdue - served, 0.0);
        }
    }
}

void feed_density_hold(feed_density *d, size_t feed, bool is_held)
{
    d->states[feed].is_held = is_held;
}

feed_balance feed_density_balance(const feed_density *d, size_t feed)
{
    const feed_state *state = &d->states[feed];

    return (feed_balance){
        .offered = state->offered,
        .admitted = state->admitted,
        .waiting = fmax(state->offered - state->admitted - state->discarded, 0.0),
        .discarded = state->discarded,
    };
}

double feed_density_admitted(const feed_density *d)
{
    double sum = 0.0;

    for (size_t k = 0; k < d->n_feeds; k++)
        sum += d->states[k].admitted;
    return sum;
}

double feed_density_offered(const feed_density *d, double t)
{
    double sum = 0.0;

    for (size_t k = 0; k < d->n_feeds; k++)
        sum += feed_arrivals_until(d->lines[k].arrivals, t);
    return sum;
}

bool feed_density_is_exhausted(const feed_density *d)
{
    bool is_exhausted = true;

    for (size_t k = 0; k < d->n_feeds; k++) {
        const feed_balance b = feed_density_balance(d, k);
        const double to_come = !d->is_by_parts
                                   ? feed_arrivals_until(d->lines[k].arrivals, INFINITY) - b.offered
                               : isfinite(d->parts[k].arriving.due) ? 1.0
                                                                    : 0.0;
        is_exhausted = is_exhausted && to_come + b.waiting < exhausted_below;
    }
    return is_exhausted;
}

void feed_density_save(const feed_density *d, checkpoint_writer *w)
{
    checkpoint_write(w, &d->n_turns, sizeof d->n_turns);
    checkpoint_write(w, d->states, d->n_feeds * sizeof *d->states);
    checkpoint_write(w, d->parts, d->n_feeds * sizeof *d->parts);
}

bool feed_density_load(feed_density *d, checkpoint_reader *r)
{
    return checkpoint_read(r, &d->n_turns, sizeof d->n_turns) &&
           checkpoint_read(r, d->states, d->n_feeds * sizeof *d->states) &&
           checkpoint_read(r, d->parts, d->n_feeds * sizeof *d->parts);
}
