#include "core/run/crossings.h"

#include "core/base/digest.h"
#include "core/base/draws.h"
#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/feed/line_cells.h"
#include "core/scene/belt_range.h"
#include "core/scene/mix.h"
#include "core/scene/regime.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <string.h>

enum {
    HEADINGS = 64,      ///< over half a turn, of a mean length
    STEPS_ON = 32,      ///< in which the end of the belts is looked for
    PARTS_AT_ONCE = 64, ///< that are told of a step
};

/// A cell of a beam's line.
typedef struct crossed_cell {
    size_t cell;
    size_t belt;
    double weight; // length of the line in it, m
    double speed;  // of its belt at the factor 1 on the eye's first way, m/s
} crossed_cell;

/// The state of an eye, as it is saved.
typedef struct crossing_state {
    uint64_t part; // the next one, from 1
    uint64_t way;  // on which the last one came: 0, or 1: backwards
    double due;    // parts until it comes
    double held;   // m of travel in which the last one breaks the beam
} crossing_state;

/// A way on which parts come to a beam.
typedef struct crossing_way {
    size_t n;
    crossed_cell *cells;
    double weight; // of all cells
    double width;  // P, m
    double chord;  // h, m
    double lanes;  // m
} crossing_way;

/// The parts of a step, and the one that broke the beam before.
typedef struct crossing_parts {
    size_t n;
    photo_eye_part items[PARTS_AT_ONCE];
    photo_eye_part last;
} crossing_parts;

typedef struct crossing {
    crossing_way ways[2]; // as the belts' velocities, and against them where one may run backwards
    draws from;
    crossing_state state;
    crossing_parts parts;
} crossing;

struct crossings {
    const scene *scene;
    double packing; // sigma
    double dt;
    uint32_t shape; // of the gaps; 0: all are 1
    bool tells_kinds;
    size_t n;
    crossing eyes[SCENE_EYES_MAX];
};

// ---- parts

static double extent_of(const shape_footprint *footprint, double heading, vec2 along)
{
    return shape_extent(footprint, heading, along) +
           shape_extent(footprint, heading, vec2_scale(along, -1.0));
}

/// The length of a kind of parts along a belt, m; of no heading the mean over all.
static double length_of_kind(const shape_footprint *footprint, double heading, vec2 along)
{
    double sum = 0.0;

    if (!isnan(heading))
        return extent_of(footprint, heading, along);
    for (int k = 0; k < HEADINGS; k++)
        sum += extent_of(footprint, M_PI * k / HEADINGS, along);
    return sum / HEADINGS;
}

static double length_of_parts(const scene *s, vec2 along)
{
    shape_footprint footprints[SCENE_KINDS_MAX];
    const double heading =
        s->n_feeds > 0 && !s->feeds[0].has_random_heading ? s->feeds[0].heading : NAN;
    double sum = 0.0, weight = 0.0;

    mix_footprints(s, footprints);
    for (size_t k = 0; k < s->n_feeds; k++) {
        for (size_t i = 0; i < s->feeds[k].n_cargo; i++) {
            const double of = s->feeds[k].cargo[i].share;
            sum += of * length_of_kind(&footprints[s->feeds[k].cargo[i].kind], heading, along);
            weight += of;
        }
    }
    if (weight > 0.0)
        return sum / weight;
    for (size_t k = 0; k < s->n_cargo; k++)
        sum += length_of_kind(&footprints[k], heading, along);
    return sum / (double)s->n_cargo;
}

// ---- the line of a beam

/// The part of a line in the domain. False: there is none.
static bool clip(const scene *s, vec2 line[2])
{
    const vec2 lower = { s->domain.x_min, s->domain.y_min };
    const vec2 upper = { s->domain.x_max, s->domain.y_max };

    return polygon_clip_segment(&line[0], &line[1], lower, upper);
}

/// Take the cells of the line on which parts come to the beam.
static bf_status take_cells(const scene *s, const vec2 line[2], crossing_way *eye, bf_error *err)
{
    const bf_grid grid = scene_grid(s);
    const surroundings around = surroundings_of(s);
    line_cell *cells = NULL;

    bf_status status = line_cells_find(&grid, line[0], line[1], &cells, &eye->n, err);
    if (status != BF_OK)
        return status;
    if ((eye->cells = memory_alloc(eye->n, sizeof *eye->cells)) == NULL)
        status = bf_fail(err, BF_ENOMEM, "/photo_eyes", "no memory for a photo eye");
    for (size_t k = 0; status == BF_OK && k < eye->n; k++) {
        const size_t cell = cells[k].cell;
        const vec2 at = { grid_x1(&grid, cell % grid.n1), grid_x2(&grid, cell / grid.n1) };
        const size_t belt = surroundings_belt_at(&around, at);
        eye->cells[k] = (crossed_cell){ cell, belt, cells[k].length,
                                        vec2_length(surroundings_velocity_at(&around, belt, at)) };
        eye->weight += cells[k].length;
    }
    memory_free(cells);
    return status;
}

/// How far parts are carried on beyond a place before they leave the belts, m, at most `most`.
static double carried_on(const scene *s, vec2 from, vec2 along, double most)
{
    const surroundings around = surroundings_of(s);

    for (int k = 1; k <= STEPS_ON; k++) {
        const vec2 at = vec2_add(from, vec2_scale(along, most * k / STEPS_ON));
        if (surroundings_is_outside(&around, at) ||
            surroundings_falls(&around, surroundings_belt_at(&around, at)))
            return most * (k - 0.5) / STEPS_ON;
    }
    return most;
}

/// Where belts run under a beam, `beam` being the part of it in the domain: how wide it is for parts of a length
/// along the belts' direction, and the line on which they come.
static bf_status measure(const scene *s, const vec2 beam[2], vec2 along, double length,
                         crossing_way *eye, bf_error *err)
{
    const vec2 way = vec2_sub(beam[1], beam[0]);
    const double beam_length = vec2_length(way), half = 0.5 * length;
    const vec2 out = beam_length > 0.0 ? vec2_scale(way, half / beam_length)
                                       : vec2_scale(vec2_turn_left(along), half);
    const vec2 back = vec2_scale(along, -half);
    vec2 line[2] = { vec2_sub(beam[0], out), vec2_add(beam[1], out) };

    clip(s, line);
    // Parts around the free ends of a beam break it, too: up to a half disk at each.
    const double ends = vec2_length(vec2_sub(line[1], line[0])) - beam_length;
    eye->width = fabs(vec2_cross(along, way)) + ends;
    const double on = carried_on(s, vec2_scale(vec2_add(beam[0], beam[1]), 0.5), along, half);
    eye->chord = (half + on) * (beam_length + 0.25 * M_PI * ends) / eye->width;
    eye->lanes = fmax(floor(eye->width / length), 1.0);
    vec2 before[2] = { vec2_add(line[0], back), vec2_add(line[1], back) };
    return take_cells(s, clip(s, before) ? before : line, eye, err);
}

static bf_status create_eye(crossings *c, size_t index, bf_error *err)
{
    const scene *s = c->scene;
    const scene_photo_eye *of = &s->eyes[index];
    const surroundings around = surroundings_of(s);
    const bf_grid grid = scene_grid(s);
    crossing *eye = &c->eyes[index];
    vec2 beam[2] = { of->line[0], of->line[1] };
    line_cell *below = NULL;
    size_t n = 0;

    if (!clip(s, beam))
        return BF_OK;
    bf_status status = line_cells_find(&grid, beam[0], beam[1], &below, &n, err);
    if (status != BF_OK)
        return status;
    // The mean velocity of the belts under a line times its length, zero off all of them.
    vec2 velocity = { 0.0, 0.0 };
    for (size_t k = 0; k < n; k++) {
        const vec2 at = { grid_x1(&grid, below[k].cell % grid.n1),
                          grid_x2(&grid, below[k].cell / grid.n1) };
        const vec2 belt = surroundings_velocity_under(&around, at);
        velocity = vec2_add(velocity, vec2_scale(belt, below[k].length));
    }
    memory_free(below);
    const double speed = vec2_length(velocity);
    if (speed > 0.0) {
        const vec2 along = vec2_scale(velocity, 1.0 / speed);
        const double length = length_of_parts(s, along);
        status = measure(s, beam, along, length, &eye->ways[0], err);
        if (status == BF_OK && belt_range_may_reverse_any(s->n_belts, s->belts))
            status = measure(s, beam, vec2_scale(along, -1.0), length, &eye->ways[1], err);
    }
    eye->from = (draws){ 0, s->substream, digest_add(DIGEST_START, of->id, strlen(of->id)) };
    eye->state = (crossing_state){ .part = 1,
                                   .due = c->shape > 0 ? draws_gap(&eye->from, 0, c->shape) : 0.5 };
    return status;
}

bf_status crossings_create(const scene *s, crossings **ret_crossings, bf_error *err)
{
    crossings *c = memory_alloc(1, sizeof *c);
    bf_status status = BF_OK;

    if (c == NULL)
        return bf_fail(err, BF_ENOMEM, "/photo_eyes", "no memory for photo eyes");
    *c = (crossings){ .scene = s,
                      .packing = scene_packing_density(s),
                      .dt = scene_macro_step(s),
                      .shape = scene_gap_shape(s),
                      .tells_kinds = scene_tells_kinds(s),
                      .n = s->n_eyes };
    for (size_t k = 0; k < c->n && status == BF_OK; k++)
        status = create_eye(c, k, err);
    if (status == BF_OK)
        *ret_crossings = c;
    else
        crossings_destroy(c);
    return status;
}

crossings *crossings_destroy(crossings *c)
{
    if (c == NULL)
        return NULL;
    for (size_t k = 0; k < c->n; k++)
        for (int way = 0; way < 2; way++)
            memory_free(c->eyes[k].ways[way].cells);
    memory_free(c);
    return NULL;
}

// ---- parts that cross

/// What comes to a beam.
typedef struct crossing_flow {
    double parts; // for each m across the belt and m along it
    double speed; // m/s
} crossing_flow;

static crossing_flow flow_of(const crossings *c, const crossing_way *eye,
                             const crossings_field *field)
{
    double density = 0.0, carried = 0.0, speed = 0.0;

    for (size_t k = 0; k < eye->n; k++) {
        const crossed_cell *of = &eye->cells[k];
        const double v = of->speed * field->factor(field->context, of->belt) * of->weight;
        const double rho = field->density(field->context, of->cell);
        density += rho * of->weight;
        carried += rho * v;
        speed += v;
    }
    return (crossing_flow){ c->packing * density / eye->weight,
                            density > 0.0 ? carried / density : speed / eye->weight };
}

/// The kind of the part that comes to a beam now.
static uint64_t kind_of(const crossings *c, const crossing *eye, const crossing_way *on,
                        const crossings_field *field)
{
    const size_t n = c->scene->n_cargo;
    double carried[SCENE_KINDS_MAX] = { 0.0 }, left = 0.0;

    for (size_t k = 0; k < on->n; k++) {
        const crossed_cell *of = &on->cells[k];
        const double *fractions = field->fractions(field->context, of->cell);
        const double flow = field->density(field->context, of->cell) * of->weight *
                            fabs(of->speed * field->factor(field->context, of->belt));
        for (size_t m = 0; m < n; m++)
            carried[m] += flow * fractions[m];
        left += flow;
    }
    left *= draws_unit(&eye->from, eye->state.part, DRAWS_KIND, 0);
    uint64_t kind = 0;
    while (kind + 1 < n && left >= carried[kind])
        left -= carried[kind++];
    return kind;
}

const photo_eye_part *crossings_parts(const crossings *c, size_t eye, size_t *ret_n)
{
    *ret_n = c->eyes[eye].parts.n;
    return c->eyes[eye].parts.items;
}

uint64_t crossings_left(const crossings *c, size_t eye)
{
    const crossing_state *state = &c->eyes[eye].state;

    return state->part - 1 - (state->held > 0.0 ? 1 : 0);
}

bool crossings_advance(crossings *c, size_t index, const crossings_field *field)
{
    crossing *eye = &c->eyes[index];
    crossing_state *state = &eye->state;
    const bool was_broken = state->held > 0.0;
    const crossing_way *on = &eye->ways[0];
    bool was_free = false;

    eye->parts.n = 0;
    if (on->n == 0)
        return false;
    crossing_flow flow = flow_of(c, on, field);
    if (flow.speed < 0.0) {
        on = &eye->ways[1];
        flow = flow_of(c, on, field);
    }
    // A part goes back as far as it has come.
    if (flow.speed != 0.0 && state->way != (flow.speed < 0.0)) {
        state->way = flow.speed < 0.0;
        state->held = was_broken ? fmax(on->chord - state->held, 0.0) : 0.0;
    }
    const double travel = fabs(flow.speed) * c->dt, across = flow.parts * on->width;
    state->due -= across * travel;
    while (across > 0.0 && state->due <= 0.0) {
        const double came = travel + state->due / across;
        was_free = was_free || came > state->held;
        state->held = came + on->chord;
        if (field->fractions != NULL) {
            eye->parts.last = (photo_eye_part){ state->part, kind_of(c, eye, on, field) };
            if (eye->parts.n < PARTS_AT_ONCE)
                eye->parts.items[eye->parts.n++] = eye->parts.last;
        }
        // The gap before the next part, where across * chord parts break the beam in the mean.
        const double fixed = pow(fmin(across * on->chord / on->lanes, 1.0), on->lanes);
        state->due += c->shape == 0 ? 1.0
                                    : fixed + (1.0 - fixed) *
                                                  draws_gap(&eye->from, eye->state.part, c->shape);
        state->part++;
    }
    state->held = fmax(state->held - travel, 0.0);
    if (field->fractions != NULL && state->held > 0.0 && eye->parts.n == 0)
        eye->parts.items[eye->parts.n++] = eye->parts.last;
    return state->held > 0.0 && !(was_broken && was_free);
}

void crossings_save(const crossings *c, checkpoint_writer *w)
{
    for (size_t k = 0; k < c->n; k++)
        checkpoint_write(w, &c->eyes[k].state, sizeof c->eyes[k].state);
    for (size_t k = 0; k < c->n && c->tells_kinds; k++)
        checkpoint_write(w, &c->eyes[k].parts.last, sizeof c->eyes[k].parts.last);
}

bool crossings_load(crossings *c, checkpoint_reader *r)
{
    bool is_read = true;

    for (size_t k = 0; k < c->n && is_read; k++)
        is_read = checkpoint_read(r, &c->eyes[k].state, sizeof c->eyes[k].state);
    for (size_t k = 0; k < c->n && c->tells_kinds && is_read; k++)
        is_read = checkpoint_read(r, &c->eyes[k].parts.last, sizeof c->eyes[k].parts.last);
    return is_read;
}
