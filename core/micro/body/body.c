#include "core/micro/backend.h"

#include "core/base/memory.h"
#include "core/micro/body/body_priv.h"

#include <float.h>
#include <math.h>

/// Of the smallest ball around a body: how far parts may move before the list is made anew, twice.
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
    s->reach = memory_alloc(n, sizeof *s->reach);
    s->first_pair = memory_alloc(n + 1, sizeof *s->first_pair);
    s->cursor = memory_alloc(n, sizeof *s->cursor);
    s->reports = memory_alloc(s->n_blocks, sizeof *s->reports);
    if (s->bodies == NULL || s->is_gone == NULL || s->reach == NULL || s->first_pair == NULL ||
        s->cursor == NULL || s->reports == NULL)
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", n);
    return BF_OK;
}

/// Put part k where it starts: flat on z = 0.
static void place_part(body_state *s, const micro_def *def, size_t k)
{
    const uint32_t number = def->part_kinds != NULL ? def->part_kinds[k] : 0;
    const body_kind *kind = &s->kinds[number];
    const scene_pose pose = def->poses[k];
    const quat heading = { cos(0.5 * pose.heading), { 0.0, 0.0, sin(0.5 * pose.heading) } };
    const mat3 r = mat3_of_quat(heading);
    const vec3 origin = { pose.x, pose.y, -kind->bottom };
    body_body *body = &s->bodies[k];

    body->kind = number;
    body->q = quat_unit(quat_multiply(heading, kind->turn));
    body->r = mat3_of_quat(body->q);
    body->x = vec3_add(origin, mat3_apply(&r, kind->centre));
    if (!body__belt_at(s, body->x.x, body->x.y, &body->v))
        body->v = (vec3){ def->start_velocity.x, def->start_velocity.y, 0.0 };
    s->reach[k] = kind->shape.radius;
}

static void place_parts(body_state *s, const micro_def *def)
{
    s->reach_min = s->n > 0 ? DBL_MAX : 1.0;
    for (size_t k = 0; k < s->n; k++) {
        place_part(s, def, k);
        s->reach_max = fmax(s->reach_max, s->reach[k]);
        s->reach_min = fmin(s->reach_min, s->reach[k]);
    }
    s->list.skin = SKIN * s->reach_min;
    s->map_range = s->reach_max;
}

/// What the definition says, without its arrays.
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
    // From D = 1 on (13) leaves no spin.
    s->spin_damping = def->damping < 1.0 ? pow(1.0 - def->damping, def->dt) : 0.0;
    s->cargo = (micro_law){ 0.25 * M_PI * contact->length, contact->damping, contact->friction,
                            contact->tanh_linear, contact->tanh_spin };
}

static void destroy(void *state)
{
    body_state *s = state;

    if (s == NULL)
        return;
    body__plates_fini(s);
    body__floor_fini(s);
    body__implicit_fini(s);
    neighbours_fini(&s->list);
    memory_free(s->kinds);
    memory_free(s->bodies);
    memory_free(s->is_gone);
    memory_free(s->reach);
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
        (status = body__floor_init(s, def, err)) == BF_OK) {
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

const micro_backend micro__body = {
    .dt_stable = body__dt_stable,
    .create = create,
    .destroy = destroy,
    .advance = body__advance,
    .part = body__part,
    .measure = body__measure,
    .steps = steps,
    .save = body__save,
    .load = body__load,
    .kind = CHECKPOINT_BODY,
};
