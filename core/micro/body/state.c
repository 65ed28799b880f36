// Access to the state: parts, totals, saving and loading.

#include "core/micro/body/implicit.h"
#include "core/micro/body/parts.h"

#include "core/base/memory.h"
#include "core/scene/shape.h"

#include <math.h>
#include <string.h>

/// The start of a saved state, followed by n saved_part, n_pairs saved_pair,
/// n_plate_memories saved_plate_memory and n_warm_starts saved_warm_start (of MICRO_IMPLICIT). None has padding.
typedef struct saved_header {
    uint64_t n_pairs;
    uint64_t n_plate_memories;
    uint64_t n_warm_starts;
    uint64_t n_contacts;
} saved_header;

typedef struct saved_part {
    vec3 x;
    quat q;
    vec3 v;
    vec3 w;
    uint32_t presence;
    uint32_t kind;
} saved_part;

typedef struct saved_pair {
    uint32_t a;
    uint32_t b;
    vec3 axis;
    double gap;
    manifold_feature feature;
    uint16_t zero;
} saved_pair;

typedef struct saved_plate_memory {
    saved_pair pair; // a: the part, b: the plate
    uint64_t slot;   // among those of the part
} saved_plate_memory;

/// A warm start; those of pairs come first, in the order of the pairs, then those with boundaries and belts.
typedef struct saved_warm_start {
    uint32_t a;
    uint32_t b;   // BODY_STATIC: a boundary or the belt
    uint32_t key; // > 0
    uint32_t zero;
    vec3 impulse;
    vec3 angular_impulse;
} saved_warm_start;

_Static_assert(sizeof(saved_part) == 13 * sizeof(double) + 8 && sizeof(saved_pair) == 48 &&
                   sizeof(saved_warm_start) == 64,
               "no padding");

micro_part body__part(const void *state, size_t k)
{
    const body_state *s = state;
    const body_body *body = &s->bodies[k];
    quat q = quat_multiply(body->q, quat_conjugate(s->kinds[body->kind].turn));
    mat3 r = mat3_of_quat(q);

    return (micro_part){ .x = { body->x.x, body->x.y, body->x.z },
                         .q = { q.w, q.v.x, q.v.y, q.v.z },
                         .v = { body->v.x, body->v.y, body->v.z },
                         .w = { body->w.x, body->w.y, body->w.z },
                         .heading = atan2(r.row[1].x, r.row[0].x),
                         .is_gone = s->common.presence[k] != MICRO_HERE,
                         .has_fallen = s->common.presence[k] == MICRO_FELL };
}

/// Cosine of the largest angle by which a part that lies flat is tilted.
#define FLAT 0.9999

// Half the sides of the rectangle around the centre of mass, along a direction and across, that holds the body seen from above.
static vec2 half_sides(const body_body *body, const body_kind *kind, vec2 along)
{
    const mat3 r = mat3_of_quat(body->q);
    vec2 half = { 0.0, 0.0 };

    if (kind->is_cylinder) {
        const vec3 axis = { r.row[0].z, r.row[1].z, r.row[2].z };
        const double a = along.x * axis.x + along.y * axis.y;
        const double b = along.x * axis.y - along.y * axis.x;
        return (vec2){ kind->radius * sqrt(fmax(1.0 - a * a, 0.0)) + kind->half_height * fabs(a),
                       kind->radius * sqrt(fmax(1.0 - b * b, 0.0)) + kind->half_height * fabs(b) };
    }
    for (size_t k = 0; k < kind->shape.n_vertices; k++) {
        const vec3 at = mat3_apply(&r, hull_vertex(&kind->shape, k));
        half.x = fmax(half.x, fabs(along.x * at.x + along.y * at.y));
        half.y = fmax(half.y, fabs(along.x * at.y - along.y * at.x));
    }
    return half;
}

micro_extent body__extent(const void *state, size_t k)
{
    const body_state *s = state;
    const body_body *body = &s->bodies[k];
    const body_kind *kind = &s->kinds[body->kind];
    const quat q = quat_multiply(body->q, quat_conjugate(kind->turn));
    const mat3 r = mat3_of_quat(q);
    const vec3 origin = vec3_sub(body->x, mat3_apply(&r, kind->centre));

    if (r.row[2].z < FLAT) {
        const double heading = atan2(r.row[1].x, r.row[0].x);
        const vec2 half = half_sides(body, kind, shape_direction(heading));
        return (micro_extent){ .kind = body->kind,
                               .pose = { body->x.x, body->x.y, heading },
                               .radius = hypot(half.x, half.y),
                               .half = half };
    }
    return (micro_extent){ .kind = body->kind,
                           .is_flat = true,
                           .pose = { origin.x, origin.y, atan2(r.row[1].x, r.row[0].x) },
                           .radius = kind->footprint_radius };
}

micro_totals body__measure(const void *state)
{
    const body_state *s = state;
    micro_totals totals = { .n_contacts = s->n_contacts,
                            .largest_overlap = s->common.largest_overlap,
                            .overlap_share = s->common.overlap_share };

    for (size_t k = 0; k < s->n; k++) {
        if (s->common.presence[k])
            continue;
        const body_body *body = &s->bodies[k];
        const body_kind *kind = &s->kinds[body->kind];
        const vec3 w = mat3_apply_back(&body->r, body->w), i = kind->inertia;
        totals.n_parts++;
        totals.kinetic_energy += 0.5 * kind->mass * vec3_dot(body->v, body->v) +
                                 0.5 * (i.x * w.x * w.x + i.y * w.y * w.y + i.z * w.z * w.z);
    }
    return totals;
}

/// Returns how many it wrote.
static uint64_t save_warm_start(uint32_t a, uint32_t b, const body_warm_start *warm_start,
                                checkpoint_writer *w)
{
    const saved_warm_start saved = {
        a, b, warm_start->key, 0, warm_start->impulse, warm_start->angular_impulse
    };

    if (warm_start->key == 0)
        return 0;
    checkpoint_write(w, &saved, sizeof saved);
    return 1;
}

static saved_pair save_memory(size_t a, size_t b, const body_memory *m)
{
    return (saved_pair){ (uint32_t)a, (uint32_t)b, m->axis, m->gap, m->feature, 0 };
}

void body__save(const void *state, checkpoint_writer *w)
{
    const body_state *s = state;
    const size_t start = checkpoint_at(w);
    saved_header header = { .n_contacts = s->n_contacts };

    checkpoint_write(w, &header, sizeof header);
    for (size_t k = 0; k < s->n; k++) {
        const body_body *body = &s->bodies[k];
        const saved_part part = { body->x,   body->q, body->v, body->w, s->common.presence[k],
                                  body->kind };
        checkpoint_write(w, &part, sizeof part);
    }
    for (size_t k = 0; k < s->n_pairs; k++) {
        const body_pair *pair = &s->pairs[k];
        const body_memory *memory = &pair->memory;
        const saved_pair saved = save_memory(pair->a, pair->b, memory);
        if (memory->feature.kind == MANIFOLD_NONE && vec3_dot(memory->axis, memory->axis) == 0.0 &&
            pair->warm_start.key == 0)
            continue;
        header.n_pairs++;
        checkpoint_write(w, &saved, sizeof saved);
    }
    for (size_t k = 0; s->plate_memories != NULL && k < s->n; k++) {
        for (size_t slot = 0; slot < BODY_PLATE_MEMORIES; slot++) {
            const body_plate_memory *kept = &s->plate_memories[k][slot];
            if (kept->plate == 0)
                continue;
            const saved_plate_memory saved = { save_memory(k, kept->plate - 1u, &kept->memory),
                                               slot };
            header.n_plate_memories++;
            checkpoint_write(w, &saved, sizeof saved);
        }
    }
    if (s->implicit != NULL) {
        uint64_t n = 0;
        for (size_t k = 0; k < s->n_pairs; k++)
            n += save_warm_start(s->pairs[k].a, s->pairs[k].b, &s->pairs[k].warm_start, w);
        for (size_t k = 0; k < s->n; k++)
            for (size_t m = 0; m < BODY_WARM_STARTS; m++)
                n += save_warm_start((uint32_t)k, BODY_STATIC, &s->implicit->warm_starts[k][m], w);
        header.n_warm_starts = n;
    }
    checkpoint_rewrite(w, start, &header, sizeof header);
}

/// How many faces and edges two hulls have; the cuboid of a plate has 6 and 12.
typedef struct sizes {
    size_t faces_a, edges_a, faces_b, edges_b;
} sizes;

static bool load_memory(const saved_pair *saved, sizes n, body_memory *ret_memory)
{
    const manifold_feature f = saved->feature;

    *ret_memory = (body_memory){ saved->axis, f, saved->gap };
    switch (f.kind) {
    case MANIFOLD_NONE:
        return true;
    case MANIFOLD_FACE_A:
        return f.of_a < n.faces_a;
    case MANIFOLD_FACE_B:
        return f.of_b < n.faces_b;
    case MANIFOLD_EDGES:
        return f.of_a < n.edges_a && f.of_b < n.edges_b;
    default:
        return false;
    }
}

static const hull *hull_of(const body_state *s, size_t k)
{
    return &s->kinds[s->bodies[k].kind].shape;
}

static bool load_parts(body_state *s, checkpoint_reader *r)
{
    saved_part saved;

    for (size_t k = 0; k < s->n; k++) {
        if (!checkpoint_read(r, &saved, sizeof saved) || saved.presence >= MICRO_PRESENCE_COUNT ||
            saved.kind >= s->n_kinds)
            return false;
        s->bodies[k] =
            (body_body){ saved.x, saved.q, saved.v, saved.w, mat3_of_quat(saved.q), saved.kind };
        s->common.presence[k] = (uint8_t)saved.presence;
        s->belt_cache[k].clearance = -1.0;
        s->bounding_radius[k] = s->kinds[saved.kind].shape.radius;
    }
    return true;
}

static bool load_pairs(body_state *s, checkpoint_reader *r)
{
    saved_pair saved;

    for (size_t k = 0; k < s->n_pairs; k++) {
        body_pair *pair = &s->pairs[k];
        if (!checkpoint_read(r, &saved, sizeof saved))
            return false;
        bool is_after =
            k == 0 || pair[-1].a < saved.a || (pair[-1].a == saved.a && pair[-1].b < saved.b);
        if (saved.a >= saved.b || saved.b >= s->n || !is_after)
            return false;
        const hull *hull_a = hull_of(s, saved.a), *hull_b = hull_of(s, saved.b);
        const sizes n = { hull_a->n_faces, hull_a->n_edges, hull_b->n_faces, hull_b->n_edges };
        *pair = (body_pair){ .a = saved.a, .b = saved.b };
        if (!load_memory(&saved, n, &pair->memory))
            return false;
    }
    return true;
}

static bool load_plate_memories(body_state *s, uint64_t n_memories, checkpoint_reader *r)
{
    saved_plate_memory saved;

    if (n_memories > 0 && s->plate_memories == NULL)
        return false;
    for (uint64_t k = 0; k < n_memories; k++) {
        if (!checkpoint_read(r, &saved, sizeof saved) || saved.pair.a >= s->n ||
            saved.pair.b >= s->n_plates || saved.slot >= BODY_PLATE_MEMORIES)
            return false;
        const hull *shape = hull_of(s, saved.pair.a);
        const sizes n = { 6, 12, shape->n_faces, shape->n_edges };
        body_plate_memory *slot = &s->plate_memories[saved.pair.a][saved.slot];
        slot->plate = saved.pair.b + 1;
        if (!load_memory(&saved.pair, n, &slot->memory))
            return false;
    }
    return true;
}

/// Where a saved warm start is loaded to; *cursor advances along the pairs. NULL: the pair is unknown, or the part has no
/// free one.
static body_warm_start *locate(const body_state *s, const saved_warm_start *saved, size_t *cursor)
{
    if (saved->key == 0 || saved->a >= s->n)
        return NULL;
    if (saved->b == BODY_STATIC) {
        body_warm_start *own = s->implicit->warm_starts[saved->a];
        size_t k = 0;
        while (k < BODY_WARM_STARTS && own[k].key != 0)
            k++;
        return k < BODY_WARM_STARTS ? &own[k] : NULL;
    }
    while (*cursor < s->n_pairs &&
           (s->pairs[*cursor].a != saved->a || s->pairs[*cursor].b != saved->b))
        (*cursor)++;
    return *cursor < s->n_pairs ? &s->pairs[*cursor].warm_start : NULL;
}

static bool load_warm_starts(const body_state *s, uint64_t n_warm_starts, checkpoint_reader *r)
{
    size_t cursor = 0;
    saved_warm_start saved;

    for (uint64_t k = 0; k < n_warm_starts; k++) {
        if (!checkpoint_read(r, &saved, sizeof saved))
            return false;
        body_warm_start *warm_start = locate(s, &saved, &cursor);
        if (warm_start == NULL)
            return false;
        *warm_start = (body_warm_start){ saved.key, saved.impulse, saved.angular_impulse };
    }
    return true;
}

bf_status body__load(void *state, size_t n, checkpoint_reader *r, bf_error *err)
{
    body_state *s = state;
    saved_header header;

    if (!checkpoint_read(r, &header, sizeof header) || n > r->n_left / sizeof(saved_part) ||
        header.n_pairs > r->n_left / sizeof(saved_pair))
        return bf_fail(err, BF_ECORRUPT, "", "the saved state is damaged");
    if ((n > s->capacity && body__resize(s, n) != BF_OK) ||
        memory_reserve(&s->pairs, &s->pairs_capacity, header.n_pairs, sizeof *s->pairs) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory to load a state");
    body__set_parts(s, n);
    s->n_pairs = header.n_pairs;
    if (!load_parts(s, r) || !load_pairs(s, r) ||
        !load_plate_memories(s, header.n_plate_memories, r) ||
        (s->implicit != NULL && !load_warm_starts(s, header.n_warm_starts, r)) || r->n_left != 0)
        return bf_fail(err, BF_ECORRUPT, "", "the saved state is damaged");
    s->n_contacts = header.n_contacts;
    body__pose_plates(s, s->common.steps);
    return BF_OK;
}
