#include "tests/reference/planar.h"

#include "tests/reference/schedule.h"

#include <math.h>
#include <stdlib.h>

// A plate at no more than 0.1 degrees to its belt is a guide, centred on its path.
static const double guide_sine = 1.745e-3;

struct planar {
    const micro_def *def;
    disk_part *parts;
    double *fx, *fy, *torque;
    uint64_t steps;
};

// Something a part is in touch with.
typedef struct touch {
    double nx, ny;    // unit, from the part to it
    double overlap;   // m
    double vx, vy;    // velocity relative to the part
    double own_rim;   // speed of the part's own contact point by spin, along n turned left
    double other_rim; // the same of the other's, against it
    double stiffness; // N/m
    double friction;  // mu
    bool can_pull;    // with tension
    const scene_contact *law;
} touch;

static const micro_kind *kind_of(const planar *p, size_t k)
{
    return &p->def->kinds[p->def->part_kinds != NULL ? p->def->part_kinds[k] : 0];
}

static double softness(const planar *p, const scene_material *m)
{
    return (1.0 - m->poisson_ratio * m->poisson_ratio) * p->def->modulus_reduction /
           m->young_modulus;
}

static const scene_belt *belt_under(const planar *p, double x, double y)
{
    for (size_t k = p->def->n_belts; k-- > 0;) {
        const scene_belt *belt = &p->def->belts[k];
        bool is_inside = true;
        for (size_t a = 0; a < belt->n_points; a++) {
            vec2 from = belt->polygon[a], to = belt->polygon[(a + 1) % belt->n_points];
            is_inside =
                is_inside && (to.x - from.x) * (y - from.y) >= (to.y - from.y) * (x - from.x);
        }
        if (is_inside)
            return belt;
    }
    return NULL;
}

planar *disk_create(const micro_def *def)
{
    planar *p = calloc(1, sizeof *p);

    if (p == NULL)
        return NULL;
    p->def = def;
    p->parts = calloc(def->n_parts + 1, sizeof *p->parts);
    p->fx = calloc(def->n_parts + 1, sizeof *p->fx);
    p->fy = calloc(def->n_parts + 1, sizeof *p->fy);
    p->torque = calloc(def->n_parts + 1, sizeof *p->torque);
    if (p->parts == NULL || p->fx == NULL || p->fy == NULL || p->torque == NULL)
        return disk_destroy(p);
    for (size_t k = 0; k < def->n_parts; k++) {
        const scene_pose *pose = &def->poses[k];
        const scene_belt *belt = belt_under(p, pose->x, pose->y);
        vec2 v = belt != NULL ? belt->velocity : def->start_velocity;
        // The factor at the start is the first one if that applies from there on.
        if (belt != NULL && belt->speed_schedule.n_times > 0 &&
            belt->speed_schedule.times[0] == 0.0)
            v = vec2_scale(v, belt->speed_schedule.factors[0]);
        p->parts[k] = (disk_part){ pose->x, pose->y, pose->heading, v.x, v.y, 0.0, false };
    }
    return p;
}

planar *disk_destroy(planar *p)
{
    if (p == NULL)
        return NULL;
    free(p->parts);
    free(p->fx);
    free(p->fy);
    free(p->torque);
    free(p);
    return NULL;
}

disk_part *disk_parts(planar *p)
{
    return p->parts;
}

// Normal force and friction on the part that the touch is seen from; returns the friction.
static double press(planar *p, size_t k, const touch *t)
{
    double vn = t->vx * t->nx + t->vy * t->ny;
    double force = t->stiffness * t->overlap - t->law->damping * vn;
    double tx = -t->ny, ty = t->nx;
    double sliding = t->vx * tx + t->vy * ty - t->own_rim - t->other_rim;

    if (force < 0.0 && !t->can_pull)
        force = 0.0;
    double rub = t->friction * fabs(force) * tanh(t->law->tanh_linear * sliding);
    p->fx[k] += rub * tx - force * t->nx;
    p->fy[k] += rub * ty - force * t->ny;
    return rub;
}

static void meet_part(planar *p, size_t i, size_t j)
{
    const disk_part *a = &p->parts[i], *b = &p->parts[j];
    const scene_contact *law = &p->def->contact[SCENE_CARGO_CARGO];
    double dx = b->x - a->x, dy = b->y - a->y, distance = hypot(dx, dy);
    double overlap = kind_of(p, i)->shape.radius + kind_of(p, j)->shape.radius - distance;

    if (overlap <= 0.0)
        return;
    double lever_a = kind_of(p, i)->shape.radius - 0.5 * overlap;
    double lever_b = kind_of(p, j)->shape.radius - 0.5 * overlap;
    double soft = softness(p, &kind_of(p, i)->material) + softness(p, &kind_of(p, j)->material);
    touch t = { .nx = dx / distance,
                .ny = dy / distance,
                .overlap = overlap,
                .vx = b->vx - a->vx,
                .vy = b->vy - a->vy,
                .own_rim = a->spin * lever_a,
                .other_rim = b->spin * lever_b,
                .stiffness = M_PI / 4.0 * law->length / soft,
                .friction = law->friction,
                .can_pull = p->def->tension,
                .law = law };
    double rub = press(p, i, &t);
    p->torque[i] += lever_a * rub;
    p->torque[j] += lever_b * rub;
    t.nx = -t.nx;
    t.ny = -t.ny;
    t.vx = -t.vx;
    t.vy = -t.vy;
    press(p, j, &t);
}

// A solid whose surface is `height` from part k's centre, out along n.
static void meet_solid(planar *p, size_t k, double nx, double ny, double height, double friction)
{
    const disk_part *a = &p->parts[k];
    const scene_contact *law = &p->def->contact[SCENE_HANDLING_CARGO];
    double overlap = kind_of(p, k)->shape.radius - height;
    double lever = kind_of(p, k)->shape.radius - 0.5 * overlap;

    if (overlap <= 0.0)
        return;
    double soft = softness(p, &kind_of(p, k)->material) + softness(p, &p->def->handling);
    touch t = { .nx = -nx,
                .ny = -ny,
                .overlap = overlap,
                .vx = -a->vx,
                .vy = -a->vy,
                .own_rim = a->spin * lever,
                .stiffness = M_PI / 4.0 * law->length / soft,
                .friction = friction,
                .can_pull = p->def->tension,
                .law = law };
    p->torque[k] += lever * press(p, k, &t);
}

static void meet_walls(planar *p, size_t k)
{
    const scene_rect *d = &p->def->domain;
    const scene_edge *edges = p->def->edges;
    const disk_part *a = &p->parts[k];
    const double mu = p->def->wall_friction;

    if (edges[SCENE_WEST] == SCENE_EDGE_WALL)
        meet_solid(p, k, 1.0, 0.0, a->x - d->x_min, mu);
    if (edges[SCENE_EAST] == SCENE_EDGE_WALL)
        meet_solid(p, k, -1.0, 0.0, d->x_max - a->x, mu);
    if (edges[SCENE_SOUTH] == SCENE_EDGE_WALL)
        meet_solid(p, k, 0.0, 1.0, a->y - d->y_min, mu);
    if (edges[SCENE_NORTH] == SCENE_EDGE_WALL)
        meet_solid(p, k, 0.0, -1.0, d->y_max - a->y, mu);
}

static double clamp(double x, double least, double most)
{
    return fmin(fmax(x, least), most);
}

// In the plate's own frame: s along it, h out of its upstream side, solid for -thickness < h < 0.
static void meet_plate(planar *p, size_t k, const scene_obstacle *plate)
{
    vec2 from = plate->path[0], to = plate->path[1];
    const disk_part *a = &p->parts[k];
    double length = hypot(to.x - from.x, to.y - from.y);
    double tx = (to.x - from.x) / length, ty = (to.y - from.y) / length;
    const scene_belt *belt = belt_under(p, 0.5 * (from.x + to.x), 0.5 * (from.y + to.y));
    double against = belt != NULL ? -ty * belt->velocity.x + tx * belt->velocity.y : 0.0;
    double speed = belt != NULL ? hypot(belt->velocity.x, belt->velocity.y) : 0.0;
    bool is_guide = fabs(against) <= guide_sine * speed;
    double side = !is_guide && against > 0.0 ? -1.0 : 1.0, nx = -ty * side, ny = tx * side;
    double s = (a->x - from.x) * tx + (a->y - from.y) * ty;
    double lift = is_guide ? 0.5 * plate->thickness : 0.0;
    double h = (a->x - from.x) * nx + (a->y - from.y) * ny - lift;
    double mu = p->def->contact[SCENE_HANDLING_CARGO].friction;
    double ds = s - clamp(s, 0.0, length), dh = h - clamp(h, -plate->thickness, 0.0);
    double distance = hypot(ds, dh);

    if (distance > 0.0)
        meet_solid(p, k, (ds * tx + dh * nx) / distance, (ds * ty + dh * ny) / distance, distance,
                   mu);
    else
        meet_solid(p, k, nx, ny, h, mu);
}

static double tanh_over(double lambda, double x)
{
    return x > 0.0 ? tanh(lambda * x) / x : lambda;
}

static void move_part(planar *p, size_t k)
{
    const micro_def *def = p->def;
    const micro_kind *kind = kind_of(p, k);
    const scene_contact *law = &def->contact[SCENE_CONVEYOR_CARGO];
    const double dt = def->dt, r = kind->shape.radius, inertia = 0.5 * kind->mass * r * r;
    disk_part *a = &p->parts[k];
    const scene_belt *belt = belt_under(p, a->x, a->y);

    if (p->steps > 0) {
        double factor = belt != NULL ? schedule_mean(belt, p->steps, dt) : 0.0;
        double sx = belt != NULL ? a->vx - factor * belt->velocity.x : 0.0;
        double sy = belt != NULL ? a->vy - factor * belt->velocity.y : 0.0;
        double drag = law->friction * def->gravity * tanh_over(law->tanh_linear, hypot(sx, sy));
        a->vx = (1.0 - def->damping * dt) * a->vx + dt * (p->fx[k] / kind->mass - drag * sx);
        a->vy = (1.0 - def->damping * dt) * a->vy + dt * (p->fy[k] / kind->mass - drag * sy);
        double w = pow(1.0 - def->damping, dt) * a->spin + dt * p->torque[k] / inertia;
        double brake = law->friction * kind->spin_radius * kind->mass * def->gravity / inertia;
        a->spin = belt != NULL ? w / (1.0 + dt * brake * tanh_over(law->tanh_spin, fabs(w))) : w;
    }
    a->x += dt * a->vx;
    a->y += dt * a->vy;
    a->heading += dt * a->spin;
}

static bool is_outside(const micro_def *def, const disk_part *a)
{
    const scene_rect *d = &def->domain;
    const bool is_beyond[SCENE_SIDE_COUNT] = { [SCENE_WEST] =
                                                   a->x<d->x_min, [SCENE_EAST] = a->x> d->x_max,
                                               [SCENE_SOUTH] =
                                                   a->y<d->y_min, [SCENE_NORTH] = a->y> d->y_max };
    bool is_out = false;

    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        is_out = is_out || (is_beyond[side] && def->edges[side] != SCENE_EDGE_WALL);
    return is_out;
}

void disk_advance(planar *p)
{
    const size_t n = p->def->n_parts;

    for (size_t k = 0; k < n; k++)
        p->fx[k] = p->fy[k] = p->torque[k] = 0.0;
    for (size_t k = 0; k < n; k++) {
        if (p->parts[k].is_gone)
            continue;
        meet_walls(p, k);
        for (size_t o = 0; o < p->def->n_obstacles; o++)
            meet_plate(p, k, &p->def->obstacles[o]);
        for (size_t j = k + 1; j < n; j++)
            if (!p->parts[j].is_gone)
                meet_part(p, k, j);
    }
    for (size_t k = 0; k < n; k++) {
        if (p->parts[k].is_gone)
            continue;
        move_part(p, k);
        p->parts[k].is_gone = is_outside(p->def, &p->parts[k]);
    }
    p->steps++;
}
