// Creation and destruction of the state of bodies, and the list of neighbours: each pair once, with what is
// stored of it from step to step.

#include "core/micro/body/body_priv.h"

#include "core/base/memory.h"
#include "core/micro/backend.h"

#include <float.h>
#include <math.h>
#include <string.h>

/// Twice the displacement after which the list is built again, in bounding radii of the smallest part.
#define SKIN 0.25

static bf_status init_kinds(body_state *s, const micro_def *def, bf_error *err)
{
    bf_status status = BF_OK;

    s->kinds = memory_alloc(def->n_kinds, sizeof *s->kinds);
    if (s->kinds == NULL)
        return bf_fail(err, BF_ENOMEM, "/cargo", "no memory for %zu kinds of parts", def->n_kinds);
    while (s->n_kinds < def->n_kinds && status == BF_OK)
        if ((status = body__kind_init(def, &def->kinds[s->n_kinds], &s->kinds[s->n_kinds], err)) ==
            BF_OK)
            s->n_kinds++;
    return status;
}

static bf_status init_arrays(body_state *s, size_t n, bf_error *err)
{
    s->n = n;
    s->n_blocks = (n + BODY_BLOCK - 1) / BODY_BLOCK;
    s->bodies = memory_alloc(n, sizeof *s->bodies);
    s->is_gone = memory_alloc(n, sizeof *s->is_gone);
    s->bounding_radius = memory_alloc(n, sizeof *s->bounding_radius);
    s->first_pair = memory_alloc(n + 1, sizeof *s->first_pair);
    s->cursor = memory_alloc(n, sizeof *s->cursor);
    s->reports = memory_alloc(s->n_blocks, sizeof *s->reports);
    if (s->bodies == NULL || s->is_gone == NULL || s->bounding_radius == NULL ||
        s->first_pair == NULL || s->cursor == NULL || s->reports == NULL)
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", n);
    return BF_OK;
}

/// Place part k at its initial pose, flat on z = 0.
static void place_part(body_state *s, const micro_def *def, size_t k)
{
    const uint32_t kind_id = def->part_kinds != NULL ? def->part_kinds[k] : 0;
    const body_kind *kind = &s->kinds[kind_id];
    const scene_pose pose = def->poses[k];
    const quat heading = { cos(0.5 * pose.heading), { 0.0, 0.0, sin(0.5 * pose.heading) } };
    const mat3 r = mat3_of_quat(heading);
    const vec3 origin = { pose.x, pose.y, -kind->bottom };
    body_body *body = &s->bodies[k];

    body->kind = kind_id;
    body->q = quat_unit(quat_multiply(heading, kind->turn));
    body->r = mat3_of_quat(body->q);
    body->x = vec3_add(origin, mat3_apply(&r, kind->centre));
    size_t belt = surroundings_belt_at(&s->around, (vec2){ body->x.x, body->x.y });
    vec2 v = def->start_velocity;
    if (belt < s->speeds.n_belts)
        v = vec2_scale(def->belts[belt].velocity, belt_speeds_at(&s->speeds, belt, 0.0));
    body->v = (vec3){ v.x, v.y, 0.0 };
    s->bounding_radius[k] = kind->shape.radius;
}

static void place_parts(body_state *s, const micro_def *def)
{
    s->bounding_radius_min = s->n > 0 ? DBL_MAX : 1.0;
    for (size_t k = 0; k < s->n; k++) {
        place_part(s, def, k);
        s->bounding_radius_max = fmax(s->bounding_radius_max, s->bounding_radius[k]);
        s->bounding_radius_min = fmin(s->bounding_radius_min, s->bounding_radius[k]);
    }
    s->list.skin = SKIN * s->bounding_radius_min;
    s->map_range = s->bounding_radius_max;
}

/// Copy the definition without its arrays.
static void take_def(body_state *s, const micro_def *def)
{
    const scene_contact *contact = &def->contact[SCENE_CARGO_CARGO];

    s->def = *def;
    s->def.belts = NULL;
    s->def.obstacles = NULL;
    s->def.kinds = NULL;
    s->def.poses = NULL;
    s->def.part_kinds = NULL;
    s->gravity = (vec3){ 0.0, 0.0, -def->gravity };
    // For D >= 1 (13) leaves no spin.
    s->spin_damping = def->damping < 1.0 ? pow(1.0 - def->damping, def->dt) : 0.0;
    s->cargo = (micro_law){ 0.25 * M_PI * contact->length, contact->damping, contact->friction,
                            contact->tanh_linear, contact->tanh_spin };
}

/// Find the first pair of each part and reserve memory for all.
static bf_status count_pairs(body_state *s)
{
    const neighbours_list *list = &s->list;
    size_t n = 0;

    for (size_t k = 0; k < s->n; k++) {
        s->first_pair[k] = n;
        for (size_t at = list->start[k]; at < list->start[k + 1]; at++)
            n += list->neighbour[at] > k;
    }
    s->first_pair[s->n] = n;
    if (memory_reserve(&s->spare, &s->spare_capacity, n, sizeof *s->spare) != 0 ||
        memory_reserve(&s->links, &s->links_capacity, 2 * n, sizeof *s->links) != 0)
        return BF_ENOMEM;
    return BF_OK;
}

static bool is_before(const body_pair *left, const body_pair *right)
{
    return left->a != right->a ? left->a < right->a : left->b < right->b;
}

/// Write the new pairs into the spare storage, with memory and warm start of those that were pairs before;
/// both lists are sorted, so that one pass along the old one finds them.
static void write_pairs(body_state *s)
{
    const neighbours_list *list = &s->list;
    size_t old = 0, n = 0;

    for (size_t k = 0; k < s->n; k++) {
        for (size_t at = list->start[k]; at < list->start[k + 1]; at++) {
            if (list->neighbour[at] <= k)
                continue;
            body_pair pair = { .a = (uint32_t)k, .b = list->neighbour[at] };
            while (old < s->n_pairs && is_before(&s->pairs[old], &pair))
                old++;
            if (old < s->n_pairs && !is_before(&pair, &s->pairs[old]))
                pair = s->pairs[old];
            s->links[at] = (uint32_t)n;
            s->spare[n++] = pair;
        }
    }
}

/// Set the links of neighbours with smaller ids: pairs come up in the order in which they stand at the part
/// with the smaller id.
static void link_back(body_state *s)
{
    const neighbours_list *list = &s->list;
    size_t *cursor = s->cursor;

    memcpy(cursor, s->first_pair, s->n * sizeof *cursor);
    for (size_t k = 0; k < s->n; k++)
        for (size_t at = list->start[k]; at < list->start[k + 1]; at++)
            if (list->neighbour[at] < k)
                s->links[at] = (uint32_t)cursor[list->neighbour[at]]++;
}

bf_status body__list(body_state *s, bf_error *err)
{
    const neighbours_parts parts = { .x = &s->bodies->x.x,
                                     .y = &s->bodies->x.y,
                                     .stride = sizeof *s->bodies / sizeof(double),
                                     .radius = s->bounding_radius,
                                     .radius_stride = 1 };

    s->is_listed = false;
    bf_status status = neighbours_build(&s->list, s->n, parts, s->is_gone, err);
    if (status != BF_OK)
        return status;
    if (count_pairs(s) != BF_OK || s->first_pair[s->n] > UINT32_MAX)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the pairs of neighbours");
    write_pairs(s);
    link_back(s);
    body_pair *swap = s->pairs;
    size_t swap_capacity = s->pairs_capacity;
    s->pairs = s->spare;
    s->pairs_capacity = s->spare_capacity;
    s->spare = swap;
    s->spare_capacity = swap_capacity;
    s->n_pairs = s->first_pair[s->n];
    for (size_t block = 0; block < s->n_blocks; block++)
        s->reports[block].is_stale = false;
    s->is_listed = true;
    return BF_OK;
}

static void destroy(void *state)
{
    body_state *s = state;

    if (s == NULL)
        return;
    body__plates_fini(s);
    body__belt_fini(s);
    body__implicit_fini(s);
    neighbours_fini(&s->list);
    memory_free(s->kinds);
    memory_free(s->bodies);
    memory_free(s->is_gone);
    memory_free(s->bounding_radius);
    memory_free(s->first_pair);
    memory_free(s->cursor);
    memory_free(s->reports);
    memory_free(s->pairs);
    memory_free(s->spare);
    memory_free(s->links);
    memory_free(s);
}

static bf_status create(const micro_def *def, void **ret_state, bf_error *err)
{
    bf_status status;
    body_state *s = memory_alloc(1, sizeof *s);
    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a solver");
    take_def(s, def);
    if ((status = init_kinds(s, def, err)) == BF_OK &&
        (status = init_arrays(s, def->n_parts, err)) == BF_OK &&
        (status = body__belt_init(s, def, err)) == BF_OK) {
        place_parts(s, def);
        if (def->integrator == MICRO_IMPLICIT)
            status = body__implicit_init(s, err);
        if (status == BF_OK)
            status = body__plates_init(s, def, err);
    }
    if (status != BF_OK) {
        destroy(s);
        return status;
    }
    *ret_state = s;
    return BF_OK;
}

static uint64_t steps(const void *state)
{
    const body_state *s = state;

    return s->steps;
}

static plate_motion *motion(void *state)
{
    body_state *s = state;

    return &s->motion;
}

static void pose_plates(void *state)
{
    body_state *s = state;

    body__pose_plates(s, s->steps);
}

const micro_backend micro__body = {
    .dt_stable = body__dt_stable,
    .create = create,
    .destroy = destroy,
    .advance = body__advance,
    .part = body__part,
    .measure = body__measure,
    .steps = steps,
    .motion = motion,
    .pose_plates = pose_plates,
    .save = body__save,
    .load = body__load,
    .kind = CHECKPOINT_BODY,
};
