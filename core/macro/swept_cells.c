#include "core/macro/swept_cells.h"

#include "core/base/memory.h"
#include "core/scene/belt_slope.h"

#include <math.h>
#include <string.h>

struct swept_cells {
    bf_grid grid;
    scene_edge edges[SCENE_SIDE_COUNT];
    uint8_t *closed[2]; // of the x1- and x2-faces of the field before the plates moved
    uint32_t round;     // of the marks below
    uint32_t search;    // same
    uint32_t *swept_in; // per cell: last round in which it was swept over
    uint32_t *found_in; // per cell: last search that came to it
    size_t n_queue;     // cells found by the present search
    size_t queue[SWEPT_CELLS_SEARCH];
    size_t origin
        [SWEPT_CELLS_SEARCH]; // of a load: the place in the queue of the swept cell that a cell was found from
    vec2 ahead[SWEPT_CELLS_SEARCH]; // and the way that this one is pushed
};

bf_status swept_cells_create(const bf_grid *grid, const scene_edge *edges, swept_cells **ret_cells,
                             bf_error *err)
{
    swept_cells *c = memory_alloc(1, sizeof *c);

    if (c != NULL) {
        c->grid = *grid;
        memcpy(c->edges, edges, sizeof c->edges);
        for (int axis = 0; axis < 2; axis++)
            c->closed[axis] = memory_alloc(grid_faces(grid, axis), sizeof *c->closed[axis]);
        c->swept_in = memory_alloc(grid_cells(grid), sizeof *c->swept_in);
        c->found_in = memory_alloc(grid_cells(grid), sizeof *c->found_in);
    }
    if (c == NULL || c->closed[0] == NULL || c->closed[1] == NULL || c->swept_in == NULL ||
        c->found_in == NULL) {
        swept_cells_destroy(c);
        return bf_fail(err, BF_ENOMEM, "/macro/cell_m",
                       "no memory for the cells that plates sweep");
    }
    *ret_cells = c;
    return BF_OK;
}

swept_cells *swept_cells_destroy(swept_cells *c)
{
    if (c == NULL)
        return NULL;
    memory_free(c->closed[0]);
    memory_free(c->closed[1]);
    memory_free(c->swept_in);
    memory_free(c->found_in);
    memory_free(c);
    return NULL;
}

// The next number of a mark; where all were used the marks begin anew.
static uint32_t next_mark(uint32_t mark, uint32_t *marks, size_t n)
{
    if (mark == UINT32_MAX) {
        memset(marks, 0, n * sizeof *marks);
        mark = 0;
    }
    return mark + 1;
}

void swept_cells_begin(swept_cells *c, const velocity_field *f)
{
    for (int axis = 0; axis < 2; axis++)
        memcpy(c->closed[axis], f->faces[axis].closed, grid_faces(&c->grid, axis));
    c->round = next_mark(c->round, c->swept_in, grid_cells(&c->grid));
}

// What is done with a cell that a line has swept over; ahead is the line's normal on the side that it moves to.
typedef void swept_fn(void *context, size_t cell, vec2 ahead);

// Visits the cells that a plate has swept over, line by line and in the order of their indices. A cell may come twice.
static void visit_swept(const bf_grid *g, const swept_cells_plate *plate, swept_fn *visit,
                        void *context)
{
    const double margin = plate->moved + SCENE_TOLERANCE;
    const plate_pose from = plate_pose_inverse(&plate->before);
    const plate_pose to = plate_pose_inverse(&plate->after);
    const vec2 pivot = plate_pose_pivot(&plate->after);
    const vec2 shifted = vec2_sub(plate->after.shift, plate->before.shift);

    for (size_t k = 0; k < plate->n_lines; k++) {
        const closed_line *l = &plate->lines[k];
        const vec2 a = plate_pose_move(&plate->after, l->start);
        const vec2 b = plate_pose_move(&plate->after, l->end);
        const vec2 along = plate_pose_turn(&plate->after, vec2_sub(l->end, l->start));
        const vec2 normal = vec2_scale(vec2_turn_left(along), 1.0 / vec2_length(along));
        const double first = (fmin(a.y, b.y) - margin - g->lower2) / g->d2 - 0.5;
        const double last = (fmax(a.y, b.y) + margin - g->lower2) / g->d2 + 0.5;
        for (size_t j = grid_clamp(floor(first), g->n2); j < grid_clamp(ceil(last), g->n2); j++) {
            const double y = grid_x2(g, j);
            double low, high;
            if (!closed_lines_clip(a, b, y - margin, y + margin, &low, &high))
                continue;
            low = floor((low - margin - g->lower1) / g->d1 - 0.5);
            high = ceil((high + margin - g->lower1) / g->d1 + 0.5);
            for (size_t i = grid_clamp(low, g->n1); i < grid_clamp(high, g->n1); i++) {
                const vec2 centre = { grid_x1(g, i), y };
                if (!closed_line_crosses(l, plate_pose_move(&from, centre),
                                         plate_pose_move(&to, centre)))
                    continue;
                const vec2 velocity = plate_pose_velocity(pivot, plate->turned, shifted, centre);
                visit(context, j * g->n1 + i,
                      vec2_dot(velocity, normal) < 0.0 ? vec2_scale(normal, -1.0) : normal);
            }
        }
    }
}

static void mark_cell(void *context, size_t cell, vec2 ahead)
{
    swept_cells *c = context;

    (void)ahead;
    c->swept_in[cell] = c->round;
}

void swept_cells_mark(swept_cells *c, const swept_cells_plate *plate)
{
    visit_swept(&c->grid, plate, mark_cell, c);
}

// To a neighbouring cell.
typedef struct direction {
    int di;
    int dj;
} direction;

// The four directions, the one nearest to `ahead` first.
static void order_directions(vec2 ahead, direction *ret_order)
{
    const direction x = { ahead.x < 0.0 ? -1 : 1, 0 }, y = { 0, ahead.y < 0.0 ? -1 : 1 };
    const bool is_x_first = fabs(ahead.x) >= fabs(ahead.y);

    ret_order[0] = is_x_first ? x : y;
    ret_order[1] = is_x_first ? y : x;
    ret_order[2] = (direction){ -ret_order[1].di, -ret_order[1].dj };
    ret_order[3] = (direction){ -ret_order[0].di, -ret_order[0].dj };
}

// The side of the grid at which a cell lies in a direction; SCENE_SIDE_COUNT: none.
static scene_side side_of(const bf_grid *g, size_t cell, direction d)
{
    const size_t i = cell % g->n1, j = cell / g->n1;

    if (d.di != 0 && (d.di < 0 ? i == 0 : i + 1 == g->n1))
        return d.di < 0 ? SCENE_WEST : SCENE_EAST;
    if (d.dj != 0 && (d.dj < 0 ? j == 0 : j + 1 == g->n2))
        return d.dj < 0 ? SCENE_SOUTH : SCENE_NORTH;
    return SCENE_SIDE_COUNT;
}

// True if the face between a cell and the next one in a direction is closed, or the grid ends there.
static bool is_closed(const bf_grid *g, const uint8_t *closed1, const uint8_t *closed2, size_t cell,
                      direction d)
{
    const size_t i = cell % g->n1, j = cell / g->n1;

    if (side_of(g, cell, d) != SCENE_SIDE_COUNT)
        return true;
    return d.di != 0 ? closed1[j * (g->n1 + 1) + i + (d.di > 0)] != 0
                     : closed2[(j + (d.dj > 0)) * g->n1 + i] != 0;
}

// A search for room.
typedef struct room_search {
    swept_cells *cells;
    const velocity_field *field;
    macro_solver *solver;
    double full;
} room_search;

static bool is_swept(const swept_cells *c, size_t cell)
{
    return c->swept_in[cell] == c->round;
}

// True if a cell lies behind the line across `ahead` through the start of a search.
static bool is_behind(const bf_grid *g, size_t start, size_t cell, vec2 ahead)
{
    const vec2 way = { grid_x1(g, cell % g->n1) - grid_x1(g, start % g->n1),
                       grid_x2(g, cell / g->n1) - grid_x2(g, start / g->n1) };

    return vec2_dot(way, ahead) < -SCENE_TOLERANCE;
}

// True if cargo that goes on from a cell in a direction leaves the domain there, and not behind the line.
static bool leads_out(const room_search *x, size_t cell, direction d, vec2 ahead)
{
    const scene_side side = side_of(&x->cells->grid, cell, d);

    return side < SCENE_SIDE_COUNT && x->cells->edges[side] == SCENE_EDGE_OUTFLOW &&
           vec2_dot((vec2){ d.di, d.dj }, ahead) > 0.0;
}

// The cell next to `from` in a direction, if the search may go there; else `from`.
static size_t next_cell(const room_search *x, size_t from, direction d, size_t start, vec2 ahead)
{
    const swept_cells *c = x->cells;
    const bf_grid *g = &c->grid;
    const bool was = is_swept(c, from);

    if (is_closed(g, was ? c->closed[0] : x->field->faces[0].closed,
                  was ? c->closed[1] : x->field->faces[1].closed, from, d))
        return from;
    const size_t to = (size_t)((ptrdiff_t)from + d.di + d.dj * (ptrdiff_t)g->n1);
    return is_behind(g, start, to, ahead) || (!was && is_swept(c, to)) ||
                   c->found_in[to] == c->search
               ? from
               : to;
}

// Searches from a swept cell and fills what is found; returns what is left of its density.
static double fill_cells(const room_search *x, size_t start, vec2 ahead, double density)
{
    swept_cells *c = x->cells;
    direction order[4];

    order_directions(ahead, order);
    c->search = next_mark(c->search, c->found_in, grid_cells(&c->grid));
    c->found_in[start] = c->search;
    c->queue[0] = start;
    c->n_queue = 1;
    for (size_t k = 0; k < c->n_queue; k++) {
        for (int m = 0; m < 4 && c->n_queue < SWEPT_CELLS_SEARCH; m++) {
            const size_t from = c->queue[k], to = next_cell(x, from, order[m], start, ahead);
            if (leads_out(x, from, order[m], ahead))
                return 0.0;
            if (to == from)
                continue;
            c->found_in[to] = c->search;
            c->queue[c->n_queue++] = to;
            if (is_swept(c, to))
                continue;
            const double taken = fmin(density, fmax(0.0, x->full - macro_density(x->solver, to)));
            if (taken > 0.0)
                macro_add(x->solver, to, taken, macro_fractions(x->solver, start));
            density -= taken;
            if (density <= 0.0)
                return 0.0;
        }
    }
    return density;
}

// Displaces what is in a swept cell to where there is room, and what is left evenly to all cells that were found. Where none was,
// it stays. What is pushed stays before the plate: its tracers go to the nearest cell that was found.
static void displace_cell(void *context, size_t cell, vec2 ahead)
{
    const room_search *x = context;
    const swept_cells *c = x->cells;
    const double density = macro_density(x->solver, cell);
    size_t n_found = 0, nearest = cell;

    if (density == 0.0)
        return;
    const double left = fill_cells(x, cell, ahead, density);
    for (size_t k = c->n_queue; k-- > 0;)
        if (!is_swept(c, c->queue[k])) {
            nearest = c->queue[k];
            n_found++;
        }
    for (size_t k = 0; left != 0.0 && k < c->n_queue; k++)
        if (!is_swept(c, c->queue[k]))
            macro_add(x->solver, c->queue[k], left / (double)n_found,
                      macro_fractions(x->solver, cell));
    macro_add(x->solver, cell, left == 0.0 || n_found > 0 ? -density : left - density, NULL);
    if (n_found > 0)
        macro_move_tracers(x->solver, cell, nearest);
}

void swept_cells_displace(swept_cells *c, const swept_cells_plate *plate, const velocity_field *f,
                          double full, macro_solver *s)
{
    room_search x = { c, f, s, full };

    visit_swept(&c->grid, plate, displace_cell, &x);
}

// A swept cell from which room is searched for.
static void add_origin(void *context, size_t cell, vec2 ahead)
{
    const room_search *x = context;
    swept_cells *c = x->cells;

    if (macro_density(x->solver, cell) == 0.0 || c->found_in[cell] == c->search ||
        c->n_queue == SWEPT_CELLS_SEARCH)
        return;
    c->found_in[cell] = c->search;
    c->origin[c->n_queue] = c->n_queue;
    c->ahead[c->n_queue] = ahead;
    c->queue[c->n_queue++] = cell;
}

// The plate as its load has it.
typedef struct pushed {
    const swept_cells_plate *plate;
    const swept_cells_cargo *cargo;
    double w;    // rad/s
    vec2 v;      // m/s
    vec2 middle; // of its path
} pushed;

static vec2 middle_of(const swept_cells_plate *plate)
{
    vec2 sum = { 0.0, 0.0 };

    for (size_t k = 0; k < plate->n_lines; k++)
        sum = vec2_add(sum, vec2_add(plate->lines[k].start, plate->lines[k].end));
    return plate_pose_move(&plate->before, vec2_scale(sum, 0.5 / (double)plate->n_lines));
}

// True if a part fits between a cell, itself included, and what is closed beyond it, out from the plate.
static bool is_wide(const room_search *x, const pushed *p, size_t cell)
{
    const bf_grid *g = &x->cells->grid;
    const double width = 2.0 * p->cargo->around.bridge;
    const vec2 at = { grid_x1(g, cell % g->n1), grid_x2(g, cell / g->n1) };
    const vec2 from_middle = vec2_sub(at, p->middle);
    direction order[4];

    // Around the plate's free end: away from the pivot of one that turns, away from the middle of another, across its way.
    order_directions(p->w != 0.0
                         ? vec2_sub(at, plate_pose_pivot(&p->plate->before))
                         : vec2_sub(from_middle, vec2_scale(p->v, vec2_dot(from_middle, p->v) /
                                                                      vec2_dot(p->v, p->v))),
                     order);
    const double edge = order[0].di != 0 ? g->d1 : g->d2;
    const ptrdiff_t next = order[0].di + order[0].dj * (ptrdiff_t)g->n1;
    double free = edge;
    for (; free < width &&
           !is_closed(g, x->field->faces[0].closed, x->field->faces[1].closed, cell, order[0]);
         free += edge)
        cell = (size_t)((ptrdiff_t)cell + next);
    return free >= width;
}

// The force against a cell's cargo that moves in a direction at a speed, N.
static double force_against(const room_search *x, const swept_cells_cargo *cargo, size_t cell,
                            vec2 at, vec2 e, double speed)
{
    const size_t belt = surroundings_belt_at(&cargo->around, at);
    const double factor = macro_belt_factor(x->solver, belt);
    const scene_belt *under = belt < cargo->around.n_belts ? &cargo->around.belts[belt] : NULL;
    const double friction_ratio =
        under != NULL ? belt_friction_ratio(under, cargo->conveyor) * cos(under->incline) : 1.0;
    const vec2 pull = under != NULL ? belt_slope_pull(under, cargo->gravity) : (vec2){ 0.0, 0.0 };
    const vec2 slip =
        vec2_sub(vec2_scale(e, speed),
                 vec2_scale(surroundings_velocity_at(&cargo->around, belt, at), factor));
    const double slides = vec2_length(slip), against = fmax(vec2_dot(slip, e), 0.0);
    const double rubs = against == 0.0
                            ? 0.0
                            : cargo->weight * friction_ratio * macro_density(x->solver, cell) *
                                  tanh(cargo->conveyor->tanh_linear * slides) * (against / slides);
    return fmax(rubs - cargo->mass * macro_density(x->solver, cell) * vec2_dot(pull, e), 0.0);
}

swept_cells_load swept_cells_find_load(swept_cells *c, const swept_cells_plate *plate,
                                       const swept_cells_cargo *cargo, const velocity_field *f,
                                       double w, vec2 v, macro_solver *s)
{
    const bf_grid *g = &c->grid;
    const double speed = vec2_length(v);
    const vec2 anywhere = { 0.0, 0.0 };
    const swept_cells_load without_room = { INFINITY, INFINITY };
    room_search x = { c, f, s, cargo->full };
    const pushed p = { plate, cargo, w, v, middle_of(plate) };
    swept_cells_load load = { 0.0, 0.0 };
    double left = 0.0; // what has found no room

    c->round = next_mark(c->round, c->swept_in, grid_cells(g));
    c->search = next_mark(c->search, c->found_in, grid_cells(g));
    c->n_queue = 0;
    visit_swept(g, plate, add_origin, &x);
    for (size_t k = 0; k < c->n_queue; k++) {
        left += macro_density(s, c->queue[k]);
        if (macro_density(s, c->queue[k]) > cargo->most)
            return without_room;
    }
    for (size_t k = 0; k < c->n_queue && left > 0.0; k++) {
        const size_t from = c->queue[k], origin = c->origin[k];
        direction order[4];
        // What the cell's cargo that moves with the plate takes.
        const vec2 at = { grid_x1(g, from % g->n1), grid_x2(g, from / g->n1) };
        const vec2 from_pivot = vec2_sub(at, plate_pose_pivot(&plate->before));
        const double r = vec2_length(from_pivot), lever = fmin(r, cargo->radius);
        if (w != 0.0 && r > 0.0) {
            const vec2 e = vec2_scale(vec2_turn_left(from_pivot), copysign(1.0, w) / r);
            load.torque += force_against(&x, cargo, from, at, e, fabs(w) * lever) * lever;
        }
        if (speed > 0.0)
            load.force += force_against(&x, cargo, from, at, vec2_scale(v, 1.0 / speed), speed);
        // Whether there is room beyond it.
        order_directions(c->ahead[origin], order);
        for (int m = 0; m < 4 && c->n_queue < SWEPT_CELLS_SEARCH; m++) {
            const size_t to = next_cell(&x, from, order[m], from, anywhere);
            if (leads_out(&x, from, order[m], c->ahead[origin]))
                left = 0.0;
            if (to == from ||
                (is_behind(g, c->queue[origin], to, c->ahead[origin]) && !is_wide(&x, &p, to)))
                continue;
            c->found_in[to] = c->search;
            c->origin[c->n_queue] = origin;
            c->queue[c->n_queue++] = to;
            left -= fmax(0.0, cargo->full - macro_density(s, to));
        }
    }
    return left > 0.0 ? without_room : load;
}
