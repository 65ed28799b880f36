// Creation and destruction of the state of bodies, and the list of neighbours: each pair once, with what is
// stored of it from step to step.

#include "core/micro/body/parts.h"

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

static void note_radius(body_state *s, double radius)
{
    s->bounding_radius_max = fmax(s->bounding_radius_max, radius);
    s->bounding_radius_min = fmin(s->bounding_radius_min, radius);
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

bf_status body__list(body_state *s, bf_error *err)
{
    const neighbours_parts parts = { .x = &s->bodies->x.x,
                                     .y = &s->bodies->x.y,
                                     .stride = sizeof *s->bodies / sizeof(double),
                                     .radius = s->bounding_radius,
                                     .radius_stride = 1 };

    s->is_listed = false;
    bf_status status = neighbours_build(&s->list, s->n, parts, s->common.presence, err);
    if (status != BF_OK)
        return status;
    if (count_pairs(s) != BF_OK || s->first_pair[s->n] > UINT32_MAX)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the pairs of neighbours");
    // Write the new pairs into the spare storage, with memory and warm start of those that were pairs before;
    // both lists are sorted, so that one pass along the old one finds them.
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
    // Set the links of neighbours with smaller ids: pairs come up in the order in which they stand at the part
    // with the smaller id.
    size_t *cursor = s->cursor;
    memcpy(cursor, s->first_pair, s->n * sizeof *cursor);
    for (size_t k = 0; k < s->n; k++)
        for (size_t at = list->start[k]; at < list->start[k + 1]; at++)
            if (list->neighbour[at] < k)
                s->links[at] = (uint32_t)cursor[list->neighbour[at]]++;
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
    memory_free(s->common.presence);
    memory_free(s->bounding_radius);
    memory_free(s->first_pair);
    memory_free(s->cursor);
    memory_free(s->reports);
    memory_free(s->pairs);
    memory_free(s->spare);
    memory_free(s->links);
    memory_free(s);
}

static bf_status create(const micro_def *def, micro_common **ret_state, bf_error *err)
{
    bf_status status;
    body_state *s = memory_alloc(1, sizeof *s);
    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a solver");
    const scene_contact *contact = &def->contact[SCENE_CARGO_CARGO];
    s->common.world = micro__world(def);
    s->def = micro__without_arrays(def);
    s->gravity = (vec3){ 0.0, 0.0, -def->gravity };
    // For D >= 1 (13) leaves no spin.
    s->spin_damping = def->damping < 1.0 ? pow(1.0 - def->damping, def->dt) : 0.0;
    s->cargo = (micro_law){ 0.25 * M_PI * contact->length, contact->damping, contact->friction,
                            contact->tanh_linear, contact->tanh_spin };
    status = init_kinds(s, def, err);
    // One more, so that no array is empty.
    if (status == BF_OK && body__resize(s, def->n_parts > 0 ? def->n_parts : 1) != BF_OK)
        status = bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", def->n_parts);
    if (status == BF_OK) {
        body__set_parts(s, def->n_parts);
        status = body__belt_init(s, def, err);
    }
    if (status == BF_OK) {
        // Place the parts of the definition; those on a belt start with its velocity.
        for (size_t k = 0; k < s->n; k++) {
            const micro_arrival arrival = { .kind =
                                                def->part_kinds != NULL ? def->part_kinds[k] : 0,
                                            .pose = def->poses[k] };
            body_body *body = &s->bodies[k];
            body__place_part(s, k, &arrival);
            const vec2 v = micro__start_velocity(def, &s->common, (vec2){ body->x.x, body->x.y },
                                                 s->kinds[body->kind].inner_radius, &body->w.z);
            body->v = (vec3){ v.x, v.y, 0.0 };
        }
        // The extremes of all parts that there may be, and lengths that follow.
        s->bounding_radius_min = s->n > 0 || s->def.n_parts_expected > 0 ? DBL_MAX : 1.0;
        for (size_t k = 0; k < s->n; k++)
            note_radius(s, s->bounding_radius[k]);
        for (size_t k = 0; s->def.n_parts_expected > 0 && k < s->n_kinds; k++)
            note_radius(s, s->kinds[k].shape.radius);
        s->list.skin = SKIN * s->bounding_radius_min;
        s->map_range = s->bounding_radius_max;
        if (def->integrator == MICRO_IMPLICIT)
            status = body__implicit_init(s, err);
        if (status == BF_OK)
            status = body__plates_init(s, def, err);
    }
    if (status != BF_OK) {
        destroy(s);
        return status;
    }
    *ret_state = &s->common;
    return BF_OK;
}

static void press(const void *state, micro_press *ret_press)
{
    const body_state *s = state;
    const body_report *worst = &s->reports[0];

    for (size_t block = 1; block < s->n_blocks; block++)
        if (s->reports[block].overlap_share > worst->overlap_share)
            worst = &s->reports[block];
    const uint32_t k = worst->pressed[0];
    *ret_press = (micro_press){
        .part = k,
        .other = worst->pressed[1] == UINT32_MAX ? UINT64_MAX : worst->pressed[1],
        .at = { s->bodies[k].x.x, s->bodies[k].x.y },
    };
}

const micro_backend micro__body = {
    .dt_stable = body__dt_stable,
    .create = create,
    .destroy = destroy,
    .advance = body__advance,
    .part = body__part,
    .extent = body__extent,
    .admit = body__admit,
    .take_out = body__take_out,
    .forget_gone = body__forget_gone,
    .measure = body__measure,
    .press = press,
    .load_on = body__load_on,
    .save = body__save,
    .load = body__load,
    .kind = CHECKPOINT_BODY,
};
