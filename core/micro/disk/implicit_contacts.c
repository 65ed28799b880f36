// Pairs of parts for implicit steps, and their contacts in a step.

#include "core/base/memory.h"
#include "core/base/simd_rows.h"
#include "core/micro/disk/implicit.h"

#include <math.h>
#include <string.h>

static const uint32_t nothing = UINT32_MAX;

static bf_status fail_for_memory(bf_error *err)
{
    return bf_fail(err, BF_ENOMEM, "", "no memory for the pairs of parts");
}

// Number of pairs at most: candidates, and the list without those that stand there a second time.
static size_t bound_pairs(const disk_state *s)
{
    size_t n_rows = s->list.first[s->n_padded / DISK_GROUP];

    return s->n_candidates + n_rows * DISK_GROUP / 2;
}

// A colour that neither slot has; without one the pair goes to the last group.
static uint8_t take_colour(uint32_t *used, uint32_t a, uint32_t b)
{
    uint32_t free = ~(used[a] | used[b]) & (UINT32_MAX >> (32 - IMPLICIT_COLOURS));

    if (free == 0)
        return IMPLICIT_REST;
    int colour = __builtin_ctz(free);
    used[a] |= 1U << colour;
    used[b] |= 1U << colour;
    return (uint8_t)(IMPLICIT_BOUNDARY + colour);
}

static void add_pair(implicit_state *z, size_t *n, implicit_pair pair, uint8_t colour)
{
    z->colour[*n] = colour;
    z->spare[(*n)++] = pair;
}

// The pairs of a part with those of higher ids.
static void collect_of_part(const disk_state *s, implicit_state *z, uint32_t slot, size_t *n)
{
    for (size_t row = 0; row < disk__n_rows(s, slot); row++) {
        uint32_t other = disk__neighbour(s, slot, row);
        if (other == s->void_slot || s->id_of[other] < s->id_of[slot])
            continue;
        implicit_pair pair = { .id = { s->id_of[slot], s->id_of[other] }, .slot = { slot, other } };
        add_pair(z, n, pair, take_colour(z->used, slot, other));
    }
}

// The candidates, which stand by slot: a part's first one to group 0 and so on.
static void collect_candidates(const disk_state *s, implicit_state *z, size_t *n)
{
    uint8_t group = 0;

    for (size_t k = 0; k < s->n_candidates; k++) {
        disk_candidate t = s->candidates[k];
        implicit_pair pair = { .id = { s->id_of[t.slot], IMPLICIT_FEATURE + t.feature },
                               .slot = { t.slot, s->void_slot } };
        bool is_another = k > 0 && s->candidates[k - 1].slot == t.slot;
        group = is_another && group < IMPLICIT_BOUNDARY ? (uint8_t)(group + 1) : group;
        group = is_another ? group : 0;
        add_pair(z, n, pair, group < IMPLICIT_BOUNDARY ? group : IMPLICIT_REST);
    }
}

// All pairs into spare, those of parts in the order of ids: colours must not depend on the order
// of slots, which depends on earlier steps. Memory is reserved.
static size_t collect_pairs(const disk_state *s, implicit_state *z)
{
    size_t n = 0;

    memset(z->used, 0, s->n_padded * sizeof *z->used);
    collect_candidates(s, z, &n);
    for (size_t id = 0; id < s->n; id++) {
        z->first[id] = (uint32_t)n;
        if (s->slot_of[id] < s->n_live)
            collect_of_part(s, z, s->slot_of[id], &n);
    }
    z->first[s->n] = (uint32_t)n;
    return n;
}

// Impulses of the pairs in z->pairs go to the same pairs among the n in spare.
static void warm_start(const disk_state *s, implicit_state *z, size_t n)
{
    memset(z->head, 0xff, s->n * sizeof *z->head);
    for (size_t k = 0; k < z->n_pairs; k++) {
        const implicit_pair *old = &z->pairs[k];
        if (old->normal == 0.0 && old->sliding == 0.0)
            continue;
        z->next[k] = z->head[old->id[0]];
        z->head[old->id[0]] = (uint32_t)k;
    }
    for (size_t k = 0; k < n; k++) {
        implicit_pair *pair = &z->spare[k];
        uint32_t at = z->head[pair->id[0]];
        while (at != nothing && z->pairs[at].id[1] != pair->id[1])
            at = z->next[at];
        if (at == nothing)
            continue;
        pair->normal = z->pairs[at].normal;
        pair->sliding = z->pairs[at].sliding;
    }
}

// Where each group begins if the n pairs in spare are sorted by groups.
static void count_groups(implicit_state *z, size_t n)
{
    memset(z->group, 0, sizeof z->group);
    for (size_t k = 0; k < n; k++)
        z->group[z->colour[k] + 1]++;
    for (size_t g = 0; g < IMPLICIT_GROUPS; g++)
        z->group[g + 1] += z->group[g];
}

// The n pairs in spare by their groups into z->pairs, whose memory is reserved; coloured ones by slots, so that
// memory is accessed in order, the others in their present order.
static void sort_pairs(const disk_state *s, implicit_state *z, size_t n)
{
    size_t at[IMPLICIT_GROUPS];

    count_groups(z, n);
    memcpy(at, z->group, sizeof at);
    for (size_t slot = 0; slot < s->n_live; slot++) {
        uint32_t id = s->id_of[slot];
        for (size_t k = z->first[id]; k < z->first[id + 1]; k++)
            if (z->colour[k] != IMPLICIT_REST)
                z->pairs[at[z->colour[k]]++] = z->spare[k];
    }
    for (size_t k = 0; k < n; k++)
        if (z->colour[k] < IMPLICIT_BOUNDARY || z->colour[k] == IMPLICIT_REST)
            z->pairs[at[z->colour[k]]++] = z->spare[k];
    z->n_pairs = n;
}

static int reserve_pairs(implicit_state *z, size_t n)
{
    size_t n_pieces = n / IMPLICIT_PIECE + IMPLICIT_GROUPS;

    return memory_reserve(&z->pairs, &z->pairs_capacity, n, sizeof *z->pairs) ||
           memory_reserve(&z->pieces, &z->pieces_capacity, n_pieces, sizeof *z->pieces);
}

// Groups into pieces. Returns how many blocks they need.
static size_t cut_groups(const disk_state *s, implicit_state *z)
{
    size_t n = 0, n_blocks = 0;

    for (size_t g = 0; g < IMPLICIT_GROUPS; g++) {
        const bool is_rest = g == IMPLICIT_REST;
        const size_t end = z->group[g + 1];
        z->group_piece[g] = n;
        for (size_t first = z->group[g]; first < end;) {
            size_t left = end - first;
            size_t length = !is_rest && left > IMPLICIT_PIECE ? IMPLICIT_PIECE : left;
            z->pieces[n] =
                (implicit_piece){ .first = first,
                                  .last = first + length,
                                  .block = n_blocks,
                                  .static_body = s->void_slot + (uint32_t)(n - z->group_piece[g]),
                                  .is_rest = is_rest };
            n_blocks += is_rest ? length : (length + IMPLICIT_WIDTH - 1) / IMPLICIT_WIDTH;
            first += length;
            n++;
        }
    }
    z->group_piece[IMPLICIT_GROUPS] = n;
    return n_blocks;
}

// The row of a contact with the boundary where plates move. Such contacts are in the first groups and in the last.
static size_t row_of_driven(const implicit_state *z, size_t index)
{
    const size_t n_first = z->group[IMPLICIT_BOUNDARY];

    return z->first_driven + (index < n_first ? index : n_first + index - z->group[IMPLICIT_REST]);
}

bf_status disk_implicit__cut(const disk_state *s, implicit_state *z, bf_error *err)
{
    size_t n_blocks = cut_groups(s, z);

    if (memory_reserve(&z->blocks, &z->blocks_capacity, n_blocks, sizeof *z->blocks) ||
        (s->plates.n > 0 && memory_reserve(&z->bodies, &z->bodies_capacity,
                                           row_of_driven(z, z->n_pairs), sizeof *z->bodies)))
        return fail_for_memory(err);
    return BF_OK;
}

bf_status disk_implicit__reserve(implicit_state *z, size_t n, bf_error *err)
{
    return reserve_pairs(z, n) ? fail_for_memory(err) : BF_OK;
}

bf_status disk_implicit__choose(disk_state *s, implicit_state *z, bf_error *err)
{
    size_t bound = bound_pairs(s);

    if (memory_reserve(&z->spare, &z->spare_capacity, bound, sizeof *z->spare) ||
        memory_reserve(&z->colour, &z->colour_capacity, bound, sizeof *z->colour) ||
        memory_reserve(&z->next, &z->next_capacity, z->n_pairs, sizeof *z->next) ||
        reserve_pairs(z, bound))
        return fail_for_memory(err);
    size_t n = collect_pairs(s, z);
    warm_start(s, z, n);
    sort_pairs(s, z, n);
    return disk_implicit__cut(s, z, err);
}

void disk_implicit__locate(const disk_state *s, implicit_state *z)
{
    for (size_t k = 0; k < z->n_pairs; k++)
        for (int end = 0; end < 2; end++) {
            uint32_t id = z->pairs[k].id[end];
            bool is_there = id < IMPLICIT_FEATURE && s->is_gone[id] == MICRO_HERE;
            z->pairs[k].slot[end] = is_there ? s->slot_of[id] : s->void_slot;
        }
}

// The geometry and the law of a contact; the normal points from part 0 to part 1.
typedef struct contact_geometry {
    double nx;        // unit normal
    double ny;        //
    double gap;       // m, negative: overlap
    double stiffness; // N/m
    double damping;   // N s/m
    double friction;  // mu
    double rate;      // lambda, s/m
    double vx;        // velocity of the boundary in the contact, m/s
    double vy;        //
    double inv_mass;  // change of the parting speed by a unit impulse along n, 1/kg
    double radius[2]; // m; 0 for the boundary
} contact_geometry;

// False if the parts do not come nearer than `margin`.
static bool find_contact_of_parts(const disk_state *s, const implicit_pair *pair, double margin,
                                  contact_geometry *ret_m)
{
    const disk *a = &s->now[pair->slot[0]], *b = &s->now[pair->slot[1]];
    double dx = b->x - a->x, dy = b->y - a->y;
    double range = a->radius + b->radius + margin, square = dx * dx + dy * dy;

    if (!(square < range * range))
        return false;
    double distance = sqrt(square), inverse = distance > 0.0 ? 1.0 / distance : 0.0;
    *ret_m = (contact_geometry){ .nx = distance > 0.0 ? dx * inverse : 1.0,
                                 .ny = dy * inverse,
                                 .gap = distance - (a->radius + b->radius),
                                 .stiffness = s->cargo.line / (a->compliance + b->compliance),
                                 .damping = s->cargo.damping,
                                 .friction = s->cargo.friction,
                                 .rate = s->cargo.tanh_linear,
                                 .inv_mass = a->inv_mass + b->inv_mass,
                                 .radius = { a->radius, b->radius } };
    return true;
}

// Outward normal of a face where the part may touch it, and its distance from the face.
static bool face_near(const disk_face *f, const disk *part, double range, contact_geometry *m)
{
    double cx = part->x - f->px, cy = part->y - f->py;
    double along = cx * f->ny - cy * f->nx, off = cx * f->nx + cy * f->ny;

    m->nx = -f->nx;
    m->ny = -f->ny;
    m->gap = off - part->radius;
    m->friction = f->friction;
    return along >= f->from && along < f->to && off > -f->depth && off < range;
}

static bool arc_near(const disk_arc *a, const disk *part, double range, contact_geometry *m)
{
    double cx = part->x - a->px, cy = part->y - a->py;
    double distance = sqrt(cx * cx + cy * cy), off = distance - a->radius;

    if (!(cx * a->ex + cy * a->ey >= 0.0 && cx * a->fx + cy * a->fy > 0.0 && off > 0.0 &&
          off < range))
        return false;
    m->nx = -cx / distance;
    m->ny = -cy / distance;
    m->gap = off - part->radius;
    m->friction = a->friction;
    return true;
}

// Where plates move: the contact with a feature as it is in this step. False if it is not within `margin`.
static bool follow_plate(const disk_state *s, const disk *part, size_t feature, double margin,
                         contact_geometry *m)
{
    const disk_surface *surface = &s->plates.surfaces[feature];

    m->gap += surface->recess;
    const double lever = part->radius + 0.5 * m->gap;
    const vec2 at = { part->x + lever * m->nx, part->y + lever * m->ny };
    const vec2 v = disk__surface_velocity(surface, (vec2){ -m->nx, -m->ny }, at);
    m->vx = v.x;
    m->vy = v.y;
    return m->gap < margin;
}

static bool find_contact_with_boundary(const disk_state *s, const implicit_pair *pair,
                                       double margin, contact_geometry *ret_m)
{
    const disk *part = &s->now[pair->slot[0]];
    size_t feature = pair->id[1] - IMPLICIT_FEATURE;
    contact_geometry m = { .stiffness =
                               s->handling.line / (part->compliance + s->handling_compliance),
                           .damping = s->handling.damping,
                           .rate = s->handling.tanh_linear,
                           .inv_mass = part->inv_mass,
                           .radius = { part->radius, 0.0 } };
    double range = part->radius + margin;
    bool is_near = feature < s->n_faces ? face_near(&s->faces[feature], part, range, &m)
                                        : arc_near(&s->arcs[feature - s->n_faces], part, range, &m);

    if (is_near && s->plates.n > 0)
        is_near = follow_plate(s, part, feature, margin, &m);
    if (is_near)
        *ret_m = m;
    return is_near;
}

// Let a row move with the boundary.
static void drive(const implicit_state *z, size_t row, const contact_geometry *m)
{
    z->bodies[row] = (solver_body){ .vx = m->vx, .vy = m->vy };
}

static void set_lane(const disk_state *s, const implicit_state *z, size_t index,
                     const contact_geometry *m, implicit_block *block, size_t lane)
{
    const implicit_pair *pair = &z->pairs[index];
    const double h = s->def.dt, overlap = -m->gap, pressed = overlap > 0.0 ? overlap : 0.0;
    const double joint = h * m->stiffness + m->damping,
                 scale = 1.0 / (1.0 + h * joint * m->inv_mass);

    block->pair[lane] = (uint32_t)index;
    block->row[0][lane] = pair->slot[0] * SIMD_ROW;
    if (!implicit_is_at_boundary(pair)) {
        block->row[1][lane] = pair->slot[1] * SIMD_ROW;
    } else if (s->plates.n > 0) {
        const size_t row = row_of_driven(z, index);
        drive(z, row, m);
        block->row[1][lane] = (uint32_t)row * SIMD_ROW;
    }
    block->nx[lane] = m->nx;
    block->ny[lane] = m->ny;
    block->bias[lane] = (joint * overlap - m->damping * pressed) * scale;
    block->gain[lane] = h * joint * scale;
    block->lower_bound[lane] = s->def.tension && overlap > 0.0 ? -HUGE_VAL : 0.0;
    block->friction[lane] = m->friction;
    block->rate[lane] = m->rate;
    block->lever[0][lane] = m->radius[0] - 0.5 * overlap;
    block->lever[1][lane] = m->radius[1] - 0.5 * overlap;
    block->normal[lane] = pair->normal;
    block->sliding[lane] = pair->sliding;
}

static void clear_block(implicit_block *block, uint32_t static_body)
{
    memset(block, 0, sizeof *block);
    for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane++) {
        block->row[0][lane] = block->row[1][lane] = static_body * SIMD_ROW;
        block->pair[lane] = UINT32_MAX;
    }
}

static void raise_overlap(implicit_piece *p, const contact_geometry *m)
{
    double small = m->radius[1] > 0.0 && m->radius[1] < m->radius[0] ? m->radius[1] : m->radius[0];

    p->overlap = -m->gap > p->overlap ? -m->gap : p->overlap;
    p->overlap_share = -m->gap > p->overlap_share * small ? -m->gap / small : p->overlap_share;
}

void disk_implicit__find_contacts(const disk_state *s, implicit_state *z, size_t piece,
                                  double margin)
{
    implicit_piece *p = &z->pieces[piece];
    const size_t width = p->is_rest ? 1 : IMPLICIT_WIDTH;
    size_t n = 0;

    p->overlap = p->overlap_share = 0.0;
    for (size_t k = p->first; k < p->last; k++) {
        implicit_pair *pair = &z->pairs[k];
        contact_geometry m = { 0 };
        if (!(implicit_is_at_boundary(pair) ? find_contact_with_boundary(s, pair, margin, &m)
                                            : find_contact_of_parts(s, pair, margin, &m))) {
            pair->normal = pair->sliding = 0.0;
            continue;
        }
        implicit_block *block = &z->blocks[p->block + n / width];
        if (n % width == 0)
            clear_block(block, p->static_body);
        set_lane(s, z, k, &m, block, n++ % width);
        raise_overlap(p, &m);
    }
    p->n_blocks = (n + width - 1) / width;
    z->kernels->warm_start(z->bodies, &z->blocks[p->block], p->n_blocks);
}

void disk_implicit__store_impulses(implicit_state *z, size_t piece)
{
    const implicit_piece *p = &z->pieces[piece];

    for (size_t k = p->block; k < p->block + p->n_blocks; k++) {
        const implicit_block *b = &z->blocks[k];
        for (size_t lane = 0; lane < IMPLICIT_WIDTH && b->pair[lane] != UINT32_MAX; lane++) {
            z->pairs[b->pair[lane]].normal = b->normal[lane];
            z->pairs[b->pair[lane]].sliding = b->sliding[lane];
        }
    }
}
