#include "core/scene/definition.h"

#include "core/base/digest.h"

// Structs are added member by member where they have padding or pointers, else as bytes.
_Static_assert(sizeof(scene_rect) == 4 * sizeof(double), "no padding");
_Static_assert(sizeof(scene_material) == 2 * sizeof(double), "no padding");
_Static_assert(sizeof(scene_contact) == 5 * sizeof(double), "no padding");
_Static_assert(sizeof(scene_pose) == 3 * sizeof(double), "no padding");
_Static_assert(sizeof(vec2) == 2 * sizeof(double), "no padding");

// The digest with numbers, integers below 2^53 among them, added to it.
#define ADD_NUMBERS(digest, ...)                                                                   \
    digest_add(digest, (const double[]){ __VA_ARGS__ }, sizeof((const double[]){ __VA_ARGS__ }))

uint64_t definition_add_rect(uint64_t digest, const scene_rect *rect)
{
    return digest_add(digest, rect, sizeof *rect);
}

// Nothing for a belt of constant speed.
static uint64_t add_speed(uint64_t digest, const scene_belt *belt)
{
    const scene_speed_schedule *s = &belt->speed_schedule;

    if (s->n_times == 0)
        return digest;
    digest = ADD_NUMBERS(digest, (double)s->n_times, belt->acceleration, belt->deceleration);
    digest = digest_add(digest, s->times, s->n_times * sizeof *s->times);
    return digest_add(digest, s->factors, s->n_times * sizeof *s->factors);
}

uint64_t definition_add_belts(uint64_t digest, size_t n, const scene_belt *belts)
{
    for (size_t k = 0; k < n; k++) {
        digest = ADD_NUMBERS(digest, belts[k].velocity.x, belts[k].velocity.y);
        digest = add_speed(digest, &belts[k]);
        digest = digest_add(digest, belts[k].polygon, belts[k].n_points * sizeof(vec2));
    }
    return digest;
}

uint64_t definition_add_obstacles(uint64_t digest, size_t n, const scene_obstacle *obstacles)
{
    for (size_t k = 0; k < n; k++) {
        const scene_obstacle *o = &obstacles[k];
        digest = ADD_NUMBERS(digest, o->thickness, o->treatment, o->band, o->slide_width);
        digest = digest_add(digest, o->path, o->n_points * sizeof *o->path);
    }
    return digest;
}

uint64_t definition_add_shape(uint64_t digest, const scene_shape *shape)
{
    digest =
        ADD_NUMBERS(digest, shape->type, shape->radius, shape->height, shape->length, shape->width);
    return digest_add(digest, shape->vertices, shape->n_vertices * sizeof *shape->vertices);
}

uint64_t definition_add_materials(uint64_t digest, size_t n, const scene_material *materials)
{
    return digest_add(digest, materials, n * sizeof *materials);
}

uint64_t definition_add_contacts(uint64_t digest, const scene_contact contact[SCENE_PAIR_COUNT])
{
    return digest_add(digest, contact, SCENE_PAIR_COUNT * sizeof *contact);
}

uint64_t definition_add_poses(uint64_t digest, size_t n, const scene_pose *poses)
{
    return digest_add(digest, poses, n * sizeof *poses);
}

static uint64_t add_cargo(uint64_t digest, const scene *s)
{
    const scene_initial *i = &s->initial;

    for (size_t k = 0; k < s->n_cargo; k++) {
        const scene_cargo *c = &s->cargo[k];
        digest = ADD_NUMBERS(digest, c->share, c->mass, c->spin_friction_radius);
        digest = definition_add_shape(digest, &c->shape);
        digest = definition_add_materials(digest, 1, &c->material);
    }
    digest = ADD_NUMBERS(digest, (double)s->cargo_seed, i->type);
    switch (i->type) {
    case SCENE_INITIAL_POSITIONS:
        return definition_add_poses(digest, i->n_poses, i->poses);
    case SCENE_INITIAL_HEXAGONAL:
        return ADD_NUMBERS(digest, i->n_rows, i->n_columns, i->first.x, i->first.y, i->spacing);
    case SCENE_INITIAL_RANDOM:
        return definition_add_rect(ADD_NUMBERS(digest, i->n_random, (double)i->seed), &i->region);
    case SCENE_INITIAL_COUNT:
        break;
    }
    return digest;
}

// Nothing for the dispersive closure.
static uint64_t add_closure(uint64_t digest, const scene_macro *macro)
{
    if (macro->closure == SCENE_DISPERSIVE)
        return digest;
    return ADD_NUMBERS(digest, macro->closure, macro->jam_density);
}

uint64_t definition_digest(const scene *s)
{
    const scene_macro *macro = &s->macro;
    const scene_micro *micro = &s->micro;
    uint64_t digest = definition_add_rect(DIGEST_START, &s->domain);

    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        digest = ADD_NUMBERS(digest, s->edges[side]);
    digest = definition_add_belts(digest, s->n_belts, s->belts);
    digest = definition_add_obstacles(digest, s->n_obstacles, s->obstacles);
    digest = add_cargo(digest, s);
    for (size_t k = 0; k < s->n_counters; k++)
        digest = definition_add_rect(digest, &s->counters[k].rect);
    digest = ADD_NUMBERS(digest, s->duration, s->output.curve_every, s->output.snapshot_every);
    digest = ADD_NUMBERS(digest, macro->cell, macro->step, macro->scheme, macro->heaviside,
                         macro->heaviside_width, macro->dispersion, macro->mollifier,
                         macro->initial_mollifier, macro->packing);
    digest = add_closure(digest, macro);
    digest =
        ADD_NUMBERS(digest, micro->integrator, micro->path, micro->step, micro->modulus_reduction,
                    micro->tension, micro->damping, micro->gravity, micro->spin_friction_radius);
    digest = definition_add_materials(digest, 1, &micro->conveyor);
    digest = definition_add_materials(digest, 1, &micro->handling);
    return definition_add_contacts(digest, micro->contact);
}
