#include "core/micro/body/parts.h"

#include "core/micro/body/implicit.h"

#include <math.h>
#include <string.h>

enum { ROOM_AT_FIRST = 64 }; // parts, where there were few

static size_t count_blocks(size_t n)
{
    return (n + BODY_BLOCK - 1) / BODY_BLOCK;
}

bf_status body__resize(body_state *s, size_t capacity)
{
    const size_t n = s->n, n_memories = s->plates != NULL ? capacity : 0;
    memory_array arrays[MEMORY_ARRAYS_MAX] = {
        { &s->bodies, sizeof *s->bodies, n, capacity },
        { &s->common.presence, sizeof *s->common.presence, n, capacity },
        { &s->bounding_radius, sizeof *s->bounding_radius, n, capacity },
        { &s->belt_cache, sizeof *s->belt_cache, n, capacity },
        { &s->plate_memories, sizeof *s->plate_memories, s->plates != NULL ? n : 0, n_memories },
        { &s->first_pair, sizeof *s->first_pair, 0, capacity + 1 },
        { &s->cursor, sizeof *s->cursor, 0, capacity },
        { &s->reports, sizeof *s->reports, 0, count_blocks(capacity) },
    };
    size_t n_arrays = 8;

    if (s->implicit != NULL)
        n_arrays += body__implicit_arrays(s->implicit, n, capacity, &arrays[n_arrays]);
    if (memory_resize(arrays, n_arrays) != 0)
        return BF_ENOMEM;
    s->capacity = capacity;
    s->is_listed = false;
    return BF_OK;
}

void body__set_parts(body_state *s, size_t n)
{
    s->n = n;
    s->n_blocks = count_blocks(n);
}

void body__place_part(body_state *s, size_t k, const micro_arrival *arrival)
{
    const body_kind *kind = &s->kinds[arrival->kind];
    const scene_pose pose = arrival->pose;
    const quat heading = { cos(0.5 * pose.heading), { 0.0, 0.0, sin(0.5 * pose.heading) } };
    const mat3 r = mat3_of_quat(heading);
    const vec3 origin = { pose.x, pose.y, -kind->bottom };
    body_body *body = &s->bodies[k];

    *body = (body_body){ .kind = arrival->kind, .v = { arrival->velocity.x, arrival->velocity.y } };
    body->q = quat_unit(quat_multiply(heading, kind->turn));
    body->r = mat3_of_quat(body->q);
    body->x = vec3_add(origin, mat3_apply(&r, kind->centre));
    s->bounding_radius[k] = kind->shape.radius;
    s->belt_cache[k].clearance = -1.0;
    s->common.presence[k] = MICRO_HERE;
}

bf_status body__admit(void *state, size_t k, const micro_arrival *arrival, bf_error *err)
{
    body_state *s = state;
    const size_t doubled = 2 * s->capacity > ROOM_AT_FIRST ? 2 * s->capacity : ROOM_AT_FIRST;

    if (k == s->capacity && body__resize(s, doubled) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts", doubled);
    if (k == s->n)
        body__set_parts(s, k + 1);
    body__place_part(s, k, arrival);
    s->is_listed = false;
    return BF_OK;
}

void body__take_out(void *state, size_t k)
{
    body_state *s = state;

    s->common.presence[k] = MICRO_LEFT;
}

void body__forget_gone(void *state)
{
    body_state *s = state;

    for (size_t k = 0; k < s->n_pairs; k++) {
        body_pair *pair = &s->pairs[k];
        if (s->common.presence[pair->a] != MICRO_HERE || s->common.presence[pair->b] != MICRO_HERE)
            *pair = (body_pair){ .a = pair->a, .b = pair->b };
    }
    for (size_t k = 0; k < s->n; k++) {
        if (s->common.presence[k] == MICRO_HERE)
            continue;
        if (s->plate_memories != NULL)
            memset(s->plate_memories[k], 0, sizeof s->plate_memories[k]);
        if (s->implicit != NULL)
            memset(s->implicit->warm_starts[k], 0, sizeof s->implicit->warm_starts[k]);
    }
}
