#include "core/macro/tracers.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

enum { MOST_CELLS = 16 }; // that a tracer enters in one move

static const double golden_ratio = 0.61803398874989485;
// Off a face without velocity, from which a tracer would come away only after any time.
static const double closed_margin = 0.02;

static void begin(const macro_solver *s, tracers *t)
{
    t->state = (tracers_state){ .portion = s->def.tracer_portion };
    random_init(&t->state.random, 0);
    t->n_exits = 0;
}

bf_status tracers_create(const macro_solver *s, tracers **ret_tracers)
{
    tracers *t = memory_alloc(1, sizeof *t);

    if (t == NULL)
        return BF_ENOMEM;
    begin(s, t);
    t->inside = memory_alloc(TRACERS_MOST, sizeof *t->inside);
    t->exits = memory_alloc(TRACERS_MOST, sizeof *t->exits);
    if (t->inside == NULL || t->exits == NULL || cargo_velocity_init(s, &t->record) != BF_OK) {
        tracers_destroy(t);
        return BF_ENOMEM;
    }
    *ret_tracers = t;
    return BF_OK;
}

tracers *tracers_destroy(tracers *t)
{
    if (t == NULL)
        return NULL;
    cargo_velocity_fini(&t->record);
    memory_free(t->inside);
    memory_free(t->exits);
    memory_free(t);
    return NULL;
}

// w_k.
static double offset_of(uint64_t k)
{
    const double multiple = (double)k * golden_ratio;

    return multiple - floor(multiple);
}

// Counts a density that enters with tracers like *like, and places those that stand for it.
static void enter(tracers *t, const macro_tracer *like, double density)
{
    tracers_state *state = &t->state;

    state->sum += density;
    while (state->sum >= state->begin + offset_of(state->n_made) * state->portion) {
        if (state->n == TRACERS_MOST) {
            // Drops every second tracer; those that stay stand for twice as much.
            const uint64_t n = (t->state.n + 1) / 2;
            for (uint64_t k = 1; k < n; k++)
                t->inside[k] = t->inside[2 * k];
            t->state.n = n;
            t->state.portion *= 2.0;
        }
        t->inside[state->n++] = *like;
        state->n_made++;
        state->begin += state->portion;
    }
}

void tracers_reset(macro_solver *s)
{
    tracers *t = s->tracers;

    begin(s, t);
    for (ptrdiff_t j = 0; j < s->n2; j++)
        for (ptrdiff_t i = 0; i < s->n1; i++) {
            const macro_tracer like = {
                .at1 = 0.5, .at2 = 0.5, .column = (uint32_t)i, .row = (uint32_t)j
            };
            enter(t, &like, macro__row(s, s->now.rho, j)[i]);
        }
}

// The cell of n along an axis in which a place is, in cells.
static uint32_t cell_at(double place, ptrdiff_t n)
{
    return place > 0.0 ? (uint32_t)fmin(place, (double)(n - 1)) : 0;
}

void macro_trace(macro_solver *s, vec2 at, double density)
{
    const bf_grid *g = &s->def.grid;

    if (s->tracers == NULL)
        return;
    const double x = (at.x - g->lower1) / g->d1, y = (at.y - g->lower2) / g->d2;
    const uint32_t column = cell_at(x, s->n1), row = cell_at(y, s->n2);
    const macro_tracer like = { .at1 = fmin(fmax(x - column, 0.0), 1.0),
                                .at2 = fmin(fmax(y - row, 0.0), 1.0),
                                .entered = macro_time(s),
                                .column = column,
                                .row = row };
    enter(s->tracers, &like, density);
}

void macro_move_tracers(macro_solver *s, size_t from, size_t to)
{
    const size_t n1 = (size_t)s->n1;

    for (uint64_t k = 0; s->tracers != NULL && k < s->tracers->state.n; k++) {
        macro_tracer *t = &s->tracers->inside[k];
        if (t->row * n1 + t->column != from)
            continue;
        t->column = (uint32_t)(to % n1);
        t->row = (uint32_t)(to / n1);
    }
}

void macro_let_leave(macro_solver *s, const double *kept)
{
    tracers *t = s->tracers;
    const uint64_t n = t != NULL ? t->state.n : 0;

    if (n > 0)
        t->state.n = 0;
    for (uint64_t k = 0; k < n; k++) {
        const macro_tracer one = t->inside[k];
        const double stays = kept[one.row * (size_t)s->n1 + one.column];
        if (stays < 1.0 && random_unit(&t->state.random) >= stays)
            t->exits[t->n_exits++] = (macro_exit){ one.entered, macro_time(s) };
        else
            t->inside[t->state.n++] = one;
    }
}

const macro_tracer *macro_tracers(const macro_solver *s, size_t *ret_n, double *ret_portion)
{
    *ret_n = s->tracers != NULL ? (size_t)s->tracers->state.n : 0;
    *ret_portion = s->tracers != NULL ? s->tracers->state.portion : 0.0;
    return s->tracers != NULL ? s->tracers->inside : NULL;
}

const macro_exit *macro_exits(const macro_solver *s, size_t *ret_n, double *ret_portion)
{
    *ret_n = s->tracers != NULL ? s->tracers->n_exits : 0;
    *ret_portion = s->tracers != NULL ? s->tracers->state.portion : 0.0;
    return s->tracers != NULL ? s->tracers->exits : NULL;
}

// Velocities at both ends of an axis of a cell, in cells per second.
typedef struct axis {
    double low;
    double high;
} axis;

// Cargo moves by a cell in a step at most.
static double limited(const macro_solver *s, double rate)
{
    const double most = 1.0 / s->def.dt;

    return rate > most ? most : rate < -most ? -most : rate;
}

static axis axis_of(const macro_solver *s, double low, double high, double edge)
{
    return (axis){ limited(s, low / edge), limited(s, high / edge) };
}

// Cargo that is fed through a border is put into its cell and crosses no face: it comes in as fast as it goes on.
static axis with_borders(axis a, uint32_t cell, ptrdiff_t n)
{
    if (cell == 0 && a.low >= 0.0 && a.high > 0.0)
        a.low = a.high;
    else if (cell + 1 == n && a.high <= 0.0 && a.low < 0.0)
        a.high = a.low;
    return a;
}

static double rate_at(axis a, double at)
{
    return a.low + at * (a.high - a.low);
}

static double off_closed(axis a, double at)
{
    if (a.low == 0.0 && at < closed_margin)
        return closed_margin;
    return a.high == 0.0 && at > 1.0 - closed_margin ? 1.0 - closed_margin : at;
}

// The time up to the face ahead, the integral of dx/u, by Gauss's rule of three nodes.
static double time_to_face(axis a, double at)
{
    const double rate = rate_at(a, at), end = rate > 0.0 ? a.high : -a.low, begin = fabs(rate);
    const double way = rate > 0.0 ? 1.0 - at : at, node = 0.11270166537925831;

    if (rate == 0.0 || end <= 0.0)
        return INFINITY;
    const double first = begin + node * (end - begin), last = end - node * (end - begin);
    return way * (5.0 / 18.0 * (1.0 / first + 1.0 / last) + 16.0 / 18.0 / (begin + end));
}

// The place after a time in which no face is reached, of dx/dt = u + b x: by Pade's (1, 2) approximation of (1 - e^-z)/z
// where cargo slows down, which never comes beyond the place where it stands.
static double after(axis a, double at, double t)
{
    const double rate = rate_at(a, at), growth = (a.high - a.low) * t, z = -growth;
    const double mean =
        growth > 0.0 ? 1.0 + 0.5 * growth : (1.0 + 0.5 * z) / (1.0 + z + 0.5 * z * z);
    const double place = at + rate * t * mean;

    return place < 0.0 ? 0.0 : place > 1.0 ? 1.0 : place;
}

// Moves a place over the face ahead, into the next one of n cells. False: it leaves the grid.
static bool cross(double rate, ptrdiff_t n, uint32_t *cell, double *at)
{
    if (rate > 0.0 ? *cell + 1 == n : *cell == 0)
        return false;
    *cell = rate > 0.0 ? *cell + 1 : *cell - 1;
    *at = rate > 0.0 ? 0.0 : 1.0;
    return true;
}

// True if a velocity in a cell is not that of its belt: cargo is pushed there.
static bool is_pushed(const macro_solver *s, const macro_tracer *t, const cargo_velocity *u)
{
    const double *v1 = macro__row(s, s->faces1.v, t->row) + t->column;
    const double *v2 = macro__row(s, s->faces2.v, t->row) + t->column;

    return u->west != v1[-1] || u->east != v1[0] || u->south != v2[0] || u->north != v2[s->stride];
}

// Moves a tracer for a time by the velocities in its cell. Returns what is left of it at a face, or 0; *is_out: it has left.
static double glide(const macro_solver *s, const cargo_velocity *u, macro_tracer *t, double left,
                    bool *is_out)
{
    const axis x = with_borders(axis_of(s, u->west, u->east, s->def.grid.d1), t->column, s->n1);
    const axis y = with_borders(axis_of(s, u->south, u->north, s->def.grid.d2), t->row, s->n2);
    const double at1 = off_closed(x, t->at1), at2 = off_closed(y, t->at2);
    const double to_face1 = time_to_face(x, at1), to_face2 = time_to_face(y, at2);
    const double to_face = to_face1 < to_face2 ? to_face1 : to_face2;
    const double dt = to_face < left ? to_face : left;

    t->at1 = after(x, at1, dt);
    t->at2 = after(y, at2, dt);
    if (to_face >= left)
        return 0.0;
    *is_out = !(to_face1 < to_face2 ? cross(rate_at(x, at1), s->n1, &t->column, &t->at1)
                                    : cross(rate_at(y, at2), s->n2, &t->row, &t->at2));
    return left - to_face;
}

// Lets a tracer stay in its cell for a step, or leave it over a face, as likely as cargo does, which goes on in the next
// step. Returns what is left of the time.
static double jump(const macro_solver *s, const cargo_velocity *u, macro_tracer *t, double left,
                   bool *is_out)
{
    const double d1 = s->def.grid.d1, d2 = s->def.grid.d2;
    const double out[4] = { limited(s, -u->west / d1), limited(s, u->east / d1),
                            limited(s, -u->south / d2), limited(s, u->north / d2) };
    const double dt = s->def.dt < left ? s->def.dt : left;
    double chance = random_unit(&s->tracers->state.random);

    for (int side = 0; side < 4; side++) {
        const double part = out[side] > 0.0 ? out[side] * dt : 0.0;
        if (chance < part) {
            *(side < 2 ? &t->at2 : &t->at1) = random_unit(&s->tracers->state.random);
            *is_out = !(side < 2 ? cross(side == 1 ? 1.0 : -1.0, s->n1, &t->column, &t->at1)
                                 : cross(side == 3 ? 1.0 : -1.0, s->n2, &t->row, &t->at2));
            break;
        }
        chance -= part;
    }
    return left - dt;
}

// Moves a tracer for a time. Returns what is left of it when it leaves the grid, or 0.
static double move(const macro_solver *s, macro_tracer *t, double left)
{
    const double rounding = 1e-9 * s->def.dt;

    for (int k = 0; k < MOST_CELLS && left > rounding; k++) {
        const cargo_velocity u = cargo_velocity_of(s, t->column, t->row);
        bool is_out = false;
        left = is_pushed(s, t, &u) ? jump(s, &u, t, left, &is_out) : glide(s, &u, t, left, &is_out);
        if (is_out)
            return left > rounding ? left : rounding;
    }
    return 0.0;
}

void tracers_follow(macro_solver *s)
{
    tracers *t = s->tracers;
    const uint64_t n_steps = macro_flux_steps(s);
    const double now = macro_time(s), all = (double)n_steps * s->def.dt;
    const uint64_t n = t->state.n;

    t->n_exits = 0;
    if (s->steps % n_steps != 0)
        return;
    t->state.n = 0;
    for (uint64_t k = 0; k < n; k++) {
        macro_tracer one = t->inside[k];
        const double left = move(s, &one, fmin(all, now - one.entered));
        if (left > 0.0)
            t->exits[t->n_exits++] = (macro_exit){ one.entered, now - left };
        else if (!macro_is_off(s, (size_t)(one.row * s->n1 + one.column)))
            t->inside[t->state.n++] = one;
    }
}

void tracers_save(const macro_solver *s, checkpoint_writer *w)
{
    const tracers *t = s->tracers;

    checkpoint_write(w, &t->state, sizeof t->state);
    checkpoint_write(w, t->inside, (size_t)t->state.n * sizeof *t->inside);
}

bool tracers_load(macro_solver *s, checkpoint_reader *r)
{
    tracers *t = s->tracers;

    if (!checkpoint_read(r, &t->state, sizeof t->state) || t->state.n > TRACERS_MOST ||
        !(t->state.portion > 0.0) ||
        !checkpoint_read(r, t->inside, (size_t)t->state.n * sizeof *t->inside))
        return false;
    for (uint64_t k = 0; k < t->state.n; k++)
        if (t->inside[k].column >= s->def.grid.n1 || t->inside[k].row >= s->def.grid.n2)
            return false;
    return true;
}
