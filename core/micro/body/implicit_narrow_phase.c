// The patches of a step.

#include "core/base/check.h"
#include "core/micro/body/implicit_priv.h"

enum { KEY_FLOOR = 1, KEY_SOLIDS = 2 }; // of holds: then walls and plates by their numbers

static const manifold_plane floor_plane = { .normal = { 0.0, 0.0, 1.0 } };

/// Room for one more patch.
static body_patch *next_patch(const body_solver *z, const body_shelf *shelf)
{
    BF_CHECK(shelf->n < shelf->room);
    return &z->patches[shelf->first + shelf->n];
}

static void meet_pair(const body_state *s, double near, body_pair *pair, body_shelf *shelf)
{
    const body_kind *kind_a = &s->kinds[s->bodies[pair->a].kind];
    const body_kind *kind_b = &s->kinds[s->bodies[pair->b].kind];
    const micro_law law = body__law(s, kind_a, kind_b);
    const body_touch touch = { pair->a, pair->b, &law, NULL, &pair->hold };
    body_region region;

    if (!body__find_pair(s, near, pair, &region)) {
        pair->hold = (body_hold){ 0 };
        return;
    }
    body_patch *patch = next_patch(s->implicit, shelf);
    if (!body_implicit__make(s, &touch, &region, patch)) {
        pair->hold = (body_hold){ 0 };
        return;
    }
    patch->hold = &pair->hold;
    patch->key = 1;
    shelf->n++;
}

/// A part that meets solids.
typedef struct visitor {
    const body_state *s;
    body_shelf *shelf;
    const body_hold *before; // of the part
    body_hold *after;        // same, being written
    size_t n_after;
} visitor;

static const body_hold *find_hold(const body_hold *holds, uint32_t key)
{
    for (size_t k = 0; k < BODY_HOLDS; k++)
        if (holds[k].key == key)
            return &holds[k];
    return NULL;
}

/// Returns the patch; NULL if there is no point.
static body_patch *add_solid(visitor *v, size_t k, const micro_law *law, uint32_t key,
                             const body_kind *floor, const body_region *region)
{
    const body_touch touch = { BODY_STILL, (uint32_t)k, law, floor, find_hold(v->before, key) };
    body_patch *patch = next_patch(v->s->implicit, v->shelf);

    if (!body_implicit__make(v->s, &touch, region, patch))
        return NULL;
    if (v->n_after < BODY_HOLDS)
        patch->hold = &v->after[v->n_after++];
    patch->key = key;
    v->shelf->n++;
    return patch;
}

static void visit_solid(void *context, size_t k, const micro_law *law, uint32_t solid,
                        const body_region *region)
{
    (void)add_solid(context, k, law, KEY_SOLIDS + solid, NULL, region);
}

/// The belts under the points of a patch.
static void find_drives(body_state *s, size_t k, body_patch *patch)
{
    const vec3 middle = vec3_add(s->bodies[k].x, patch->lever[1]);
    vec3 belt;
    bool is_one = body__is_on_one_belt(s, k, &belt);

    for (uint32_t m = 0; m < patch->n; m++) {
        body_point *point = &patch->point[m];
        if (!is_one)
            (void)body__belt_at(s, middle.x + point->x, middle.y + point->y, &belt);
        point->drive[0] = belt.x;
        point->drive[1] = belt.y;
    }
}

static void meet_floor(body_state *s, size_t k, double near, visitor *v)
{
    const body_body *body = &s->bodies[k];
    const body_kind *kind = &s->kinds[body->kind];
    body_region region;

    if (body->x.z >= s->reach[k] + near)
        return;
    body__find_at_plane(s, body, &floor_plane, near, &region);
    body_patch *patch = add_solid(v, k, &kind->floor, KEY_FLOOR, kind, &region);
    if (patch != NULL)
        find_drives(s, k, patch);
}

static void meet_solids(body_state *s, size_t k, double near, body_shelf *shelf)
{
    body_hold before[BODY_HOLDS], *holds = s->implicit->holds[k];
    visitor v = { .s = s, .shelf = shelf, .before = before, .after = holds };

    for (size_t m = 0; m < BODY_HOLDS; m++) {
        before[m] = holds[m];
        holds[m] = (body_hold){ 0 };
    }
    body__solids_visit(s, k, near, visit_solid, &v);
    meet_floor(s, k, near, &v);
}

void body_implicit__meet(body_state *s, size_t block, double near)
{
    body_shelf *shelf = &s->implicit->shelves[block];
    const size_t first = body__first_of(block), last = body__last_of(s, block);

    shelf->n = 0;
    for (size_t p = s->first_pair[first]; p < s->first_pair[last]; p++)
        meet_pair(s, near, &s->pairs[p], shelf);
    shelf->n_pairs = shelf->n;
    for (size_t k = first; k < last; k++)
        if (!s->is_gone[k])
            meet_solids(s, k, near, shelf);
}
