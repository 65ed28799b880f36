#include "core/macro/moving_field.h"

#include "core/base/memory.h"
#include "core/macro/swept_cells.h"
#include "core/scene/belt_range.h"
#include "core/scene/mix.h"
#include "core/scene/plate_range.h"
#include "core/scene/scene.h"

#include <float.h>
#include <math.h>
#include <string.h>

// How far a point of a plate may move before the field is made again, cells.
static const double most_moved = 0.25;

// How far beyond the density at which cargo is packed it may be pressed before a drive stalls.
static const double pressed = 1.1;

// Where the field has an obstacle.
typedef struct placement {
    plate_displacement displacement;
    double presence; // 1 or 0
} placement;

// An obstacle of the scene.
typedef struct plate {
    placement placement;
    double radius;      // plate_range_radius()
    uint64_t n_steps;   // between two loads of its drive; 0: it neither turns nor is shifted
    size_t n_lines;     // 0: it closes nothing
    closed_line *lines; // as in the document
    vec2 *path;         // as displaced
    scene_rect around;  // holds its path
} plate;

struct moving_field {
    const scene *scene;        // as in the document
    const belt_speeds *speeds; // of its world, borrowed; NULL: no belt may run backwards
    scene_belt *belts;         // of now; with speeds
    int8_t *directions;        // of each of them: 1, or -1: it runs backwards; with speeds
    double dt;                 // step of the solver, s
    double edge;               // shorter one of a cell, m
    scene now; // the same with the plates that are there, displaced, and belts as they run
    scene_obstacle *obstacles; // of now
    plate_motion *motion;      // of the scene's world, borrowed
    const plate_drive *drives; // same
    plate *plates;             // one for each obstacle of the scene
    velocity_field *field;
    swept_cells *swept;
    scene_rect *changed; // scratch: what holds an obstacle where it was and where it is
    placement *before;   // scratch: where the field had each obstacle
    placement *after;    // scratch: where it has to have it
};

static bool add_line(void *context, const closed_line *l)
{
    plate *p = context;

    p->lines[p->n_lines++] = *l;
    return false;
}

static bf_status init_plate(const scene *s, const scene_obstacle *o, plate *p)
{
    const surroundings around = surroundings_of(s);

    p->path = memory_alloc(o->n_points, sizeof *p->path);
    p->lines = memory_alloc(o->n_points - 1, sizeof *p->lines);
    if (p->path == NULL || p->lines == NULL)
        return BF_ENOMEM;
    p->radius = plate_range_radius(o);
    if (closed_lines_has(s, o))
        (void)closed_lines_visit_one(&around, o, add_line, p);
    return BF_OK;
}

// The density up to which cells take what plates push.
static double full_density(const scene *s)
{
    return s->macro.closure == SCENE_CONGESTED ? s->macro.jam_density : 1.0;
}

// The placements at a time.
static void find_placements(const moving_field *p, double t, placement *ret_placements)
{
    for (size_t k = 0; k < p->scene->n_obstacles; k++)
        ret_placements[k] = (placement){ plate_motion_at(p->motion, k, t),
                                         plate_motion_is_present(p->motion, k, t) ? 1.0 : 0.0 };
}

// Makes `now` the scene with these placements, and the field that of `now`; all of it, or what has changed.
static void set_placements(moving_field *p, const placement *placements, bool is_all)
{
    const scene *s = p->scene;
    size_t n_changed = 0;

    p->now.n_obstacles = 0;
    for (size_t k = 0; k < s->n_obstacles; k++) {
        plate *of = &p->plates[k];
        const plate_pose pose = plate_pose_of(&p->motion->obstacles[k], placements[k].displacement);
        const placement before = of->placement;
        const scene_rect was = of->around;
        of->placement = placements[k];
        for (size_t m = 0; m < s->obstacles[k].n_points; m++)
            of->path[m] = plate_pose_move(&pose, s->obstacles[k].path[m]);
        of->around = scene_rect_around(of->path, s->obstacles[k].n_points);
        if (placements[k].presence == 1.0) {
            p->obstacles[p->now.n_obstacles] = s->obstacles[k];
            p->obstacles[p->now.n_obstacles++].path = of->path;
        }
        if ((placements[k].presence == 1.0 || before.presence == 1.0) &&
            (placements[k].presence != before.presence ||
             !plate_displacement_is_same(placements[k].displacement, before.displacement)))
            p->changed[n_changed++] =
                (scene_rect){ fmin(was.x_min, of->around.x_min), fmax(was.x_max, of->around.x_max),
                              fmin(was.y_min, of->around.y_min),
                              fmax(was.y_max, of->around.y_max) };
    }
    velocity_field_update(p->field, &p->now, n_changed, is_all ? NULL : p->changed);
}

// Lets the belts of `now` have their directions.
static void set_directions(moving_field *p)
{
    for (size_t k = 0; k < p->scene->n_sections; k++) {
        const scene_belt *belt = &p->scene->belts[k];
        p->belts[k].velocity = vec2_scale(belt->velocity, p->directions[k]);
        p->belts[k].turn = p->directions[k] * belt->turn;
        p->belts[k].incline = p->directions[k] * belt->incline;
    }
}

// Finds the directions of belts in a step; one that stands keeps its own. True if one has changed.
static bool find_directions(moving_field *p, uint64_t step)
{
    bool have_changed = false;

    for (size_t k = 0; p->speeds != NULL && k < p->scene->n_sections; k++) {
        const double factor =
            belt_speeds_mean(p->speeds, k, (double)step * p->dt, (double)(step + 1) * p->dt);
        const int8_t direction = factor < 0.0 ? -1 : factor > 0.0 ? 1 : p->directions[k];
        have_changed = have_changed || direction != p->directions[k];
        p->directions[k] = direction;
    }
    if (have_changed)
        set_directions(p);
    return have_changed;
}

static bf_status init_belts(moving_field *p, const bf_world *w, bf_error *err)
{
    const scene *s = p->scene;

    if (!belt_range_may_reverse_any(s->n_sections, s->belts))
        return BF_OK;
    p->speeds = &w->belts;
    p->belts = memory_alloc(s->n_sections, sizeof *p->belts);
    p->directions = memory_alloc(s->n_sections, sizeof *p->directions);
    if (p->belts == NULL || p->directions == NULL)
        return bf_fail(err, BF_ENOMEM, "/belts", "no memory for belts");
    memcpy(p->belts, s->belts, s->n_sections * sizeof *p->belts);
    memset(p->directions, 1, s->n_sections);
    p->now.belts = p->belts;
    return BF_OK;
}

static bf_status init_arrays(moving_field *p, bf_error *err)
{
    const scene *s = p->scene;
    bf_status status = BF_OK;

    p->obstacles = memory_alloc(s->n_obstacles, sizeof *p->obstacles);
    p->plates = memory_alloc(s->n_obstacles, sizeof *p->plates);
    p->changed = memory_alloc(s->n_obstacles, sizeof *p->changed);
    p->before = memory_alloc(s->n_obstacles, sizeof *p->before);
    p->after = memory_alloc(s->n_obstacles, sizeof *p->after);
    if (p->obstacles == NULL || p->plates == NULL || p->changed == NULL || p->before == NULL ||
        p->after == NULL)
        status = BF_ENOMEM;
    for (size_t k = 0; status == BF_OK && k < s->n_obstacles; k++)
        status = init_plate(s, &s->obstacles[k], &p->plates[k]);
    for (size_t k = 0; status == BF_OK && k < s->n_obstacles; k++) {
        plate *of = &p->plates[k];
        const double speed = p->drives[k].rate * of->radius + p->drives[k].speed;
        if (speed > 0.0)
            of->n_steps = (uint64_t)fmax(floor(most_moved * p->edge / (speed * p->dt)), 1.0);
    }
    p->now.obstacles = p->obstacles;
    return status == BF_OK ? BF_OK : bf_fail(err, status, "/obstacles", "no memory for obstacles");
}

bf_status moving_field_create(const scene *s, bf_world *w, moving_field **ret_field, bf_error *err)
{
    const bf_grid grid = scene_grid(s);
    moving_field *p = memory_alloc(1, sizeof *p);
    bf_status status;

    if (p == NULL)
        return bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for obstacles");
    p->scene = s;
    p->motion = &w->plates;
    p->drives = w->drives;
    p->now = *s;
    p->dt = scene_macro_step(s);
    p->edge = scene_cell_edge(s);
    // The field has room for all obstacles, and is then made for those that are there at the start.
    if ((status = init_arrays(p, err)) != BF_OK || (status = init_belts(p, w, err)) != BF_OK ||
        (status = swept_cells_create(&grid, s->edges, &p->swept, err)) != BF_OK ||
        (status = velocity_field_create(s, &p->field, err)) != BF_OK) {
        moving_field_destroy(p);
        return status;
    }
    find_placements(p, 0.0, p->after);
    (void)find_directions(p, 0);
    set_placements(p, p->after, true);
    *ret_field = p;
    return BF_OK;
}

moving_field *moving_field_destroy(moving_field *p)
{
    if (p == NULL)
        return NULL;
    for (size_t k = 0; p->plates != NULL && k < p->scene->n_obstacles; k++) {
        memory_free(p->plates[k].lines);
        memory_free(p->plates[k].path);
    }
    memory_free(p->plates);
    memory_free(p->obstacles);
    memory_free(p->changed);
    memory_free(p->before);
    memory_free(p->after);
    memory_free(p->belts);
    memory_free(p->directions);
    velocity_field_destroy(p->field);
    swept_cells_destroy(p->swept);
    memory_free(p);
    return NULL;
}

const velocity_field *moving_field_now(const moving_field *p)
{
    return p->field;
}

const scene_belt *moving_field_belts(const moving_field *p)
{
    return p->belts;
}

// How far a point of an obstacle moves at most from one displacement to another, m.
static double way_of(const plate *p, const plate_displacement *from, const plate_displacement *to)
{
    return p->radius * fabs(to->angle - from->angle) +
           vec2_length(vec2_sub(to->shift, from->shift));
}

// True if the field has to be made again for the step that begins at t, when plates are at `after`.
static bool is_due(const moving_field *p, double t)
{
    bool is = false;

    for (size_t k = 0; k < p->scene->n_obstacles && !is; k++) {
        const plate *of = &p->plates[k];
        const placement *to = &p->after[k];
        const double moved = way_of(of, &of->placement.displacement, &to->displacement);
        is = to->presence != of->placement.presence;
        if (!is && to->presence == 1.0 && moved > 0.0)
            is = moved >= most_moved * p->edge ||
                 plate_displacement_is_same(to->displacement,
                                            plate_motion_at(p->motion, k, t + p->dt));
    }
    return is;
}

// The way of an obstacle from `before` to `after`. False: it sweeps over nothing.
static bool find_sweep(const moving_field *p, size_t k, swept_cells_plate *ret_sweep)
{
    const plate *of = &p->plates[k];
    const placement *from = &p->before[k], *to = &p->after[k];
    const double moved = way_of(of, &from->displacement, &to->displacement);

    *ret_sweep =
        (swept_cells_plate){ .n_lines = of->n_lines,
                             .lines = of->lines,
                             .before = plate_pose_of(&p->motion->obstacles[k], from->displacement),
                             .after = plate_pose_of(&p->motion->obstacles[k], to->displacement),
                             .turned = to->displacement.angle - from->displacement.angle,
                             .moved = moved };
    return moved > 0.0 && from->presence == 1.0 && to->presence == 1.0;
}

// Lets the drive of a plate follow until its next load is found.
static void follow(moving_field *p, size_t k, macro_solver *s)
{
    const scene *of = p->scene;
    const plate *moving = &p->plates[k];
    const double t = macro_time(s);
    const double until = (double)(macro_steps(s) + moving->n_steps) * p->dt;
    swept_cells_plate sweep;

    if (!plate_drive_is_needed(p->motion, k, t, until))
        return;
    const scene_contact *belt = &of->micro.contact[SCENE_CONVEYOR_CARGO];
    const bf_grid grid = scene_grid(of);
    const bool has_limit = of->macro.closure == SCENE_CONGESTED;
    const double mass_per_area = mix_mass_per_area(of), gravity = of->micro.gravity;
    const swept_cells_cargo cargo = { surroundings_of(of),
                                      full_density(of),
                                      has_limit ? pressed * full_density(of) : INFINITY,
                                      belt->friction * gravity * mass_per_area * grid.d1 * grid.d2,
                                      mass_per_area * grid.d1 * grid.d2,
                                      gravity,
                                      belt,
                                      moving->radius };
    plate_load load = { .torque = 0.0 };
    p->before[k] = moving->placement;
    p->after[k] = moving->placement;
    p->after[k].displacement = plate_motion_told(p->motion, k, until);
    if (find_sweep(p, k, &sweep)) {
        const vec2 shifted =
            vec2_sub(p->after[k].displacement.shift, p->before[k].displacement.shift);
        const double way = vec2_length(shifted);
        const vec2 along = way > 0.0 ? vec2_scale(shifted, 1.0 / way) : shifted;
        const double w = sweep.turned != 0.0 ? copysign(p->drives[k].rate, sweep.turned) : 0.0;
        const swept_cells_load of_cargo = swept_cells_find_load(
            p->swept, &sweep, &cargo, p->field, w, vec2_scale(along, p->drives[k].speed), s);
        load.torque = -copysign(of_cargo.torque, w);
        load.resultant = vec2_scale(along, -fmin(of_cargo.force, DBL_MAX));
    }
    plate_drive_follow(p->motion, k, &p->drives[k], &load, t, until);
}

void moving_field_update(moving_field *p, macro_solver *s)
{
    const scene *of = p->scene;
    swept_cells_plate sweep;

    for (size_t k = 0; k < of->n_obstacles; k++)
        if (p->plates[k].n_steps > 0 && macro_steps(s) % p->plates[k].n_steps == 0)
            follow(p, k, s);
    const bool reverses = find_directions(p, macro_steps(s));
    find_placements(p, macro_time(s), p->after);
    if (!is_due(p, macro_time(s))) {
        if (reverses) {
            velocity_field_update(p->field, &p->now, 0, NULL);
            macro_set_field(s, p->field, p->belts);
        }
        return;
    }
    for (size_t k = 0; k < of->n_obstacles; k++)
        p->before[k] = p->plates[k].placement;
    swept_cells_begin(p->swept, p->field);
    set_placements(p, p->after, reverses);
    for (size_t k = 0; k < of->n_obstacles; k++)
        if (find_sweep(p, k, &sweep))
            swept_cells_mark(p->swept, &sweep);
    for (size_t k = 0; k < of->n_obstacles; k++)
        if (find_sweep(p, k, &sweep))
            swept_cells_displace(p->swept, &sweep, p->field, full_density(of), s);
    macro_set_field(s, p->field, p->belts);
}

void moving_field_save(const moving_field *p, checkpoint_writer *w)
{
    for (size_t k = 0; k < p->scene->n_obstacles; k++)
        checkpoint_write(w, &p->plates[k].placement, sizeof p->plates[k].placement);
    if (p->directions != NULL)
        checkpoint_write(w, p->directions, p->scene->n_sections);
}

bool moving_field_load(moving_field *p, macro_solver *s, checkpoint_reader *r)
{
    for (size_t k = 0; k < p->scene->n_obstacles; k++)
        if (!checkpoint_read(r, &p->after[k], sizeof p->after[k]) ||
            !isfinite(p->after[k].displacement.angle) ||
            !isfinite(p->after[k].displacement.shift.x) ||
            !isfinite(p->after[k].displacement.shift.y) ||
            (p->after[k].presence != 0.0 && p->after[k].presence != 1.0))
            return false;
    if (p->directions != NULL && !checkpoint_read(r, p->directions, p->scene->n_sections))
        return false;
    for (size_t k = 0; p->directions != NULL && k < p->scene->n_sections; k++)
        if (p->directions[k] != 1 && p->directions[k] != -1)
            return false;
    if (p->directions != NULL)
        set_directions(p);
    set_placements(p, p->after, true);
    macro_set_field(s, p->field, p->belts);
    return true;
}
