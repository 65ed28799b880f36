#include "core/scene/goods.h"

#include "core/scene/ranges.h"
#include "core/scene/scene.h"

#include <math.h>

/// The paper's frictions.
static const double paper_friction[SCENE_PAIR_COUNT] = {
    [SCENE_CARGO_CARGO] = 0.15, [SCENE_CONVEYOR_CARGO] = 1.0, [SCENE_HANDLING_CARGO] = 0.19
};

static const char *const friction_pointers[SCENE_PAIR_COUNT] = {
    [SCENE_CARGO_CARGO] = "/contacts/cargo_cargo/friction",
    [SCENE_CONVEYOR_CARGO] = "/contacts/conveyor_cargo/friction",
    [SCENE_HANDLING_CARGO] = "/contacts/handling_cargo/friction"
};

static bool has_surface(const scene_cargo *kind)
{
    return (unsigned)kind->surface < SCENE_SURFACE_COUNT;
}

static bool is_any_surface(const scene *s)
{
    bool is_any = false;

    for (size_t k = 0; k < s->n_cargo; k++)
        is_any = is_any || has_surface(&s->cargo[k]);
    return is_any;
}

double goods_friction_of(const goods_friction *pair)
{
    return round((pair->low + pair->high) / 2.0 * 1e4) / 1e4;
}

// Sizes that the other shape would have are no numbers, so that a document that changes the type must give them.
void goods_apply(scene_goods goods, scene_cargo *kind)
{
    const goods_item *item = &goods_items[goods];
    scene_shape *shape = &kind->shape;

    kind->goods = goods;
    kind->surface = item->surface;
    if (item->mass > 0.0)
        kind->mass = item->mass;
    shape->type = item->type;
    if (item->type == SCENE_CYLINDER) {
        shape->radius = item->size[0] / 2.0;
        shape->height = item->size[1];
        return;
    }
    shape->radius = NAN;
    shape->length = item->size[0];
    shape->width = item->size[1];
    shape->height = item->size[2];
}

// What the frictions of a pair are in a scene.
typedef struct pair_frictions {
    double first;      // NAN: there is none
    double other;      // another one; NAN: there is none
    scene_surface on;  // the kind's surface, where its friction is not known
    scene_surface and; // and that which it rubs on; SCENE_SURFACE_COUNT: all are known
} pair_frictions;

static void add_friction(pair_frictions *all, scene_surface a, scene_surface b)
{
    double friction = NAN; // of the first pair of the table that is this one

    for (size_t k = 0; k < goods_n_frictions && isnan(friction); k++) {
        const goods_friction *pair = &goods_frictions[k];
        if ((pair->a == a && pair->b == b) || (pair->a == b && pair->b == a))
            friction = goods_friction_of(pair);
    }
    if (isnan(friction)) {
        all->on = a;
        all->and = b;
    } else if (isnan(all->first)) {
        all->first = friction;
    } else if (friction != all->first) {
        all->other = friction;
    }
}

// Each kind has a surface.
static pair_frictions list_frictions(const scene *s, scene_pair pair)
{
    pair_frictions all = { NAN, NAN, SCENE_SURFACE_COUNT, SCENE_SURFACE_COUNT };

    for (size_t k = 0; k < s->n_cargo; k++) {
        const scene_surface own = s->cargo[k].surface;
        if (pair == SCENE_CONVEYOR_CARGO)
            add_friction(&all, own, s->surfaces.conveyor);
        else if (pair == SCENE_HANDLING_CARGO)
            add_friction(&all, own, s->surfaces.handling);
        for (size_t j = k; pair == SCENE_CARGO_CARGO && j < s->n_cargo; j++)
            add_friction(&all, own, s->cargo[j].surface);
    }
    return all;
}

// The first kind without a surface; n_cargo: there is none.
static size_t find_bare(const scene *s)
{
    size_t k = 0;

    while (k < s->n_cargo && has_surface(&s->cargo[k]))
        k++;
    return k;
}

static double choose_friction(const scene *s, scene_pair pair)
{
    if (!is_any_surface(s))
        return paper_friction[pair];
    if (find_bare(s) < s->n_cargo)
        return NAN;
    const pair_frictions all = list_frictions(s, pair);
    return all.and == SCENE_SURFACE_COUNT && isnan(all.other) ? all.first : NAN;
}

void goods_resolve(scene *s)
{
    if (is_any_surface(s)) {
        if (s->surfaces.conveyor == SCENE_SURFACE_COUNT)
            s->surfaces.conveyor = SCENE_ACETAL;
        if (s->surfaces.handling == SCENE_SURFACE_COUNT)
            s->surfaces.handling = SCENE_STEEL;
    }
    for (int pair = 0; pair < SCENE_PAIR_COUNT; pair++) {
        double *friction = &s->micro.contact[pair].friction;
        if (isnan(*friction))
            *friction = choose_friction(s, (scene_pair)pair);
    }
}

static void note_friction(const scene *s, scene_pair pair, bf_faults *faults)
{
    const char *pointer = friction_pointers[pair];
    const size_t bare = find_bare(s);

    if (bare < s->n_cargo) {
        faults_add(faults, pointer,
                   "must be given, or a surface for kind %zu of cargo: other kinds have one", bare);
        return;
    }
    const pair_frictions all = list_frictions(s, pair);
    if (all.and != SCENE_SURFACE_COUNT)
        faults_add(faults, pointer, "must be given: that of %s on %s is not known",
                   scene_surface_words[all.on], scene_surface_words[all.and ]);
    else
        faults_add(
            faults, pointer,
            "must be given: kinds of cargo have different ones, %g and %g, and one holds for all",
            all.first, all.other);
}

void goods_check(const scene *s, bf_faults *faults)
{
    const bool is_any = is_any_surface(s);

    if (!is_any && s->surfaces.conveyor != SCENE_SURFACE_COUNT)
        faults_add(faults, "/surfaces/conveyor", "nothing follows from it: no cargo has a surface");
    if (!is_any && s->surfaces.handling != SCENE_SURFACE_COUNT)
        faults_add(faults, "/surfaces/handling", "nothing follows from it: no cargo has a surface");
    for (int pair = 0; pair < SCENE_PAIR_COUNT; pair++) {
        const double friction = s->micro.contact[pair].friction;
        if (isnan(friction))
            note_friction(s, (scene_pair)pair, faults);
        else
            range_check(&scene_range_friction, friction, friction_pointers[pair], faults);
    }
}
