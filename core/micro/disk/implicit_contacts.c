// Contacts of pairs in an implicit step: which pairs are near, where they touch, and work on them.

#include "core/base/simd_rows.h"
#include "core/micro/disk/implicit.h"
#include "core/micro/disk/parts.h"

#include <math.h>
#include <string.h>

// Where the bodies of a pair touch; the normal points from body 0 to body 1.
typedef struct contact_geometry {
    double nx;        // unit normal
    double ny;        //
    double gap;       // m, negative: overlap
    double vx;        // velocity of the boundary in the contact, m/s
    double vy;        //
    double radius[2]; // m; 0 for the boundary
} contact_geometry;

// False if the parts do not come nearer than `margin`.
static bool find_contact_of_parts(const disk *a, const disk *b, double margin,
                                  contact_geometry *ret_m)
{
    double dx = b->x - a->x, dy = b->y - a->y;
    double range = a->radius + b->radius + margin, square = dx * dx + dy * dy;

    if (!(square < range * range))
        return false;
    double distance = sqrt(square), inverse = distance > 0.0 ? 1.0 / distance : 0.0;
    *ret_m = (contact_geometry){ .nx = distance > 0.0 ? dx * inverse : 1.0,
                                 .ny = dy * inverse,
                                 .gap = distance - (a->radius + b->radius),
                                 .radius = { a->radius, b->radius } };
    return true;
}

// False if the part does not come nearer than `margin` to a face or an arc of the boundary, as it is in this step.
static bool find_contact_with_boundary(const disk_state *s, const disk *part, size_t feature,
                                       double margin, contact_geometry *ret_m)
{
    const double range = part->radius + margin;
    contact_geometry m = { .radius = { part->radius, 0.0 } };

    if (feature < s->n_faces) {
        const disk_face *f = &s->faces[feature];
        const double cx = part->x - f->px, cy = part->y - f->py;
        const double along = cx * f->ny - cy * f->nx, off = cx * f->nx + cy * f->ny;
        if (!(along >= f->from && along < f->to && off > -f->depth && off < range))
            return false;
        m.nx = -f->nx;
        m.ny = -f->ny;
        m.gap = off - part->radius;
    } else {
        const disk_arc *a = &s->arcs[feature - s->n_faces];
        const double cx = part->x - a->px, cy = part->y - a->py;
        const double distance = sqrt(cx * cx + cy * cy), off = distance - a->radius;
        if (!(cx * a->ex + cy * a->ey >= 0.0 && cx * a->fx + cy * a->fy > 0.0 && off > 0.0 &&
              off < range))
            return false;
        m.nx = -cx / distance;
        m.ny = -cy / distance;
        m.gap = off - part->radius;
    }
    if (s->plates.n > 0) {
        const disk_surface *surface = &s->plates.surfaces[feature];
        m.gap += surface->recess;
        if (!(m.gap < margin))
            return false;
        const double lever = part->radius + 0.5 * m.gap;
        const vec2 at = { part->x + lever * m.nx, part->y + lever * m.ny };
        const vec2 v = disk__surface_velocity(surface, (vec2){ -m.nx, -m.ny }, at);
        m.vx = v.x;
        m.vy = v.y;
    }
    *ret_m = m;
    return true;
}

// The contact of a pair; false if it has none. Parts that left before the list was made stand behind the others.
static bool find_contact(const disk_state *s, const implicit_state *z, const implicit_block *block,
                         size_t lane, double margin, contact_geometry *ret_m)
{
    const size_t a = implicit_body(block, 0, lane), b = implicit_body(block, 1, lane);

    if (a >= s->n_live || (b >= s->n_live && b < z->first_feature))
        return false;
    return b < s->n_live ? find_contact_of_parts(&s->now[a], &s->now[b], margin, ret_m)
                         : find_contact_with_boundary(
                               s, &s->now[a], z->features[b - z->first_feature], margin, ret_m);
}

// Count an overlap, m, of parts of which the smaller one has the radius `small`, m.
static void note_overlap(implicit_piece *p, double overlap, double small)
{
    p->overlap = overlap > p->overlap ? overlap : p->overlap;
    p->overlap_share = overlap > p->overlap_share * small ? overlap / small : p->overlap_share;
}

// Contact k at the front of a piece. The boundary has a body of its own for it.
static void set_contact(const disk_state *s, implicit_state *z, implicit_piece *p, size_t k,
                        const contact_geometry *m)
{
    const size_t at = k / IMPLICIT_WIDTH, lane = k % IMPLICIT_WIDTH;
    const implicit_block *block = &z->blocks[p->block + at];
    implicit_contacts *contacts = &z->contacts[p->block + at];
    const size_t b = implicit_body(block, 1, lane);
    const double small =
        m->radius[1] > 0.0 && m->radius[1] < m->radius[0] ? m->radius[1] : m->radius[0];

    contacts->nx[lane] = m->nx;
    contacts->ny[lane] = m->ny;
    contacts->overlap[lane] = -m->gap;
    if (!p->is_one_law)
        disk_implicit__set_law(s, z, block, lane, m->gap, &z->laws[p->law + at]);
    if (b >= z->first_feature)
        z->bodies.rows[b] = (solver_body){ .vx = m->vx, .vy = m->vy };
    note_overlap(p, -m->gap, small);
}

// Set n doubles of a lane to zero: those of an implicit_contacts or of an implicit_law.
static void clear_lane(double *block, size_t n, size_t lane)
{
    for (size_t k = 0; k < n; k++)
        block[k * IMPLICIT_WIDTH + lane] = 0.0;
}

static void copy_pair(implicit_block *blocks, size_t to, size_t from)
{
    const size_t lane = from % IMPLICIT_WIDTH, to_lane = to % IMPLICIT_WIDTH;
    const implicit_block *of = &blocks[from / IMPLICIT_WIDTH];
    implicit_block *block = &blocks[to / IMPLICIT_WIDTH];

    block->row[0][to_lane] = of->row[0][lane];
    block->row[1][to_lane] = of->row[1][lane];
    block->normal[to_lane] = of->normal[lane];
    block->sliding[to_lane] = of->sliding[lane];
}

// Pairs that are near come from the end of a piece to its front.
static void bring_near(const disk_state *s, const implicit_state *z, implicit_piece *p,
                       double margin)
{
    implicit_block *blocks = &z->blocks[p->block];
    const size_t end = p->n_blocks * IMPLICIT_WIDTH;
    size_t first = end - (p->n - p->n_front);
    contact_geometry m;

    for (size_t at = first; at < end; at++)
        if (find_contact(s, z, &blocks[at / IMPLICIT_WIDTH], at % IMPLICIT_WIDTH, margin, &m)) {
            copy_pair(blocks, p->n_front++, at);
            copy_pair(blocks, at, first++);
        }
}

// A pair at the front goes to the end, without impulses, and the last one of the front takes its place.
static void send_away(const implicit_state *z, implicit_piece *p, size_t k)
{
    implicit_block *blocks = &z->blocks[p->block];
    const size_t end = p->n_blocks * IMPLICIT_WIDTH - (p->n - p->n_front) - 1;

    blocks[k / IMPLICIT_WIDTH].normal[k % IMPLICIT_WIDTH] = 0.0;
    blocks[k / IMPLICIT_WIDTH].sliding[k % IMPLICIT_WIDTH] = 0.0;
    copy_pair(blocks, end, k);
    copy_pair(blocks, k, --p->n_front);
}

// Let the lanes behind the last contact of a piece have none.
static void clear_rest(const implicit_state *z, const implicit_piece *p)
{
    for (size_t k = p->n_front; k % IMPLICIT_WIDTH != 0; k++) {
        const size_t at = k / IMPLICIT_WIDTH, lane = k % IMPLICIT_WIDTH;
        implicit_block *block = &z->blocks[p->block + at];
        block->row[0][lane] = block->row[1][lane] = p->static_body * SIMD_QUAD;
        block->normal[lane] = block->sliding[lane] = 0.0;
        clear_lane(z->contacts[p->block + at].nx, sizeof *z->contacts / sizeof z->contacts->nx,
                   lane);
        if (!p->is_one_law)
            clear_lane(z->laws[p->law + at].joint, sizeof *z->laws / sizeof z->laws->joint, lane);
    }
}

// The same as bring_near() for a piece whose pairs are all of parts.
static void bring_near_parts(const disk_state *s, const implicit_state *z, implicit_piece *p,
                             double margin)
{
    implicit_block *blocks = &z->blocks[p->block];
    const size_t end = p->n_blocks * IMPLICIT_WIDTH;
    size_t first = end - (p->n - p->n_front);
    _Alignas(64) implicit_contacts unused;

    for (size_t block = first / IMPLICIT_WIDTH; block < p->n_blocks; block++) {
        const size_t begin = block * IMPLICIT_WIDTH, skipped = first > begin ? first - begin : 0;
        unsigned near =
            z->kernels->find_contacts(s, &blocks[block], margin, &unused) >> skipped << skipped;
        for (; near != 0; near &= near - 1) {
            const size_t at = begin + (size_t)__builtin_ctz(near);
            copy_pair(blocks, p->n_front++, at);
            copy_pair(blocks, at, first++);
        }
    }
}

// The contacts of a piece whose pairs are all of parts, block by block. A pair that is not near goes to the end, and
// the one that takes its place is looked at along with its block again.
static void find_contacts_of_parts(const disk_state *s, implicit_state *z, implicit_piece *p,
                                   double margin)
{
    double small = s->kinds[0].part.radius;

    bring_near_parts(s, z, p, margin);
    for (size_t first = 0; first < p->n_front;) {
        const size_t at = first / IMPLICIT_WIDTH;
        const size_t n = p->n_front - first < IMPLICIT_WIDTH ? p->n_front - first : IMPLICIT_WIDTH;
        const implicit_block *block = &z->blocks[p->block + at];
        implicit_contacts *contacts = &z->contacts[p->block + at];
        const unsigned far =
            ~z->kernels->find_contacts(s, block, margin, contacts) & ((1U << n) - 1);
        if (far != 0) {
            send_away(z, p, first + (size_t)__builtin_ctz(far));
            continue;
        }
        for (size_t lane = 0; lane < n; lane++) {
            const double overlap = contacts->overlap[lane];
            if (!p->is_one_law) {
                implicit_law *law = &z->laws[p->law + at];
                disk_implicit__set_law(s, z, block, lane, -overlap, law);
                small = law->radius[0][lane] < law->radius[1][lane] ? law->radius[0][lane]
                                                                    : law->radius[1][lane];
            }
            note_overlap(p, overlap, small);
        }
        first += n;
    }
    clear_rest(z, p);
}

static void find_contacts(const disk_state *s, implicit_state *z, implicit_piece *p, double margin)
{
    contact_geometry m;

    bring_near(s, z, p, margin);
    for (size_t k = 0; k < p->n_front;) {
        if (find_contact(s, z, &z->blocks[p->block + k / IMPLICIT_WIDTH], k % IMPLICIT_WIDTH,
                         margin, &m))
            set_contact(s, z, p, k++, &m);
        else
            send_away(z, p, k);
    }
    clear_rest(z, p);
}

typedef void kernel(solver_body *bodies, const implicit_blocks *blocks);

// Copy n doubles of a lane to lane 0, as clear_lane().
static void take_lane(double *to, const double *from, size_t n, size_t lane)
{
    for (size_t k = 0; k < n; k++)
        to[k * IMPLICIT_WIDTH] = from[k * IMPLICIT_WIDTH + lane];
}

static void work_on(implicit_state *z, const implicit_piece *p, double excess, kernel *work)
{
    const implicit_blocks blocks = { .n = (p->n_front + IMPLICIT_WIDTH - 1) / IMPLICIT_WIDTH,
                                     .pairs = &z->blocks[p->block],
                                     .contacts = &z->contacts[p->block],
                                     .laws = &z->laws[p->law],
                                     .is_one_law = p->is_one_law,
                                     .excess = excess };

    if (p->is_rest) {
        // Let a kernel work on each contact of the last group in a block of its own.
        _Alignas(64) implicit_block pair = { .normal = { 0.0 } };
        _Alignas(64) implicit_contacts contact = { .nx = { 0.0 } };
        _Alignas(64) implicit_law law = { .joint = { 0.0 } };
        const implicit_blocks one = { 1, &pair, &contact, &law, true, excess };
        for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane++)
            pair.row[0][lane] = pair.row[1][lane] = p->static_body * SIMD_QUAD;
        for (size_t k = 0; k < p->n; k++) {
            const size_t at = k / IMPLICIT_WIDTH, lane = k % IMPLICIT_WIDTH;
            implicit_block *block = &z->blocks[p->block + at];
            const implicit_contacts *contacts = &z->contacts[p->block + at];
            if (contacts->overlap[lane] == -HUGE_VAL)
                continue;
            pair.row[0][0] = block->row[0][lane];
            pair.row[1][0] = block->row[1][lane];
            pair.normal[0] = block->normal[lane];
            pair.sliding[0] = block->sliding[lane];
            take_lane(contact.nx, contacts->nx, sizeof contact / sizeof contact.nx, lane);
            take_lane(law.joint, z->laws[p->law + at].joint, sizeof law / sizeof law.joint, lane);
            work(z->bodies.rows, &one);
            block->normal[lane] = pair.normal[0];
            block->sliding[lane] = pair.sliding[0];
        }
    } else {
        work(z->bodies.rows, &blocks);
    }
}

void disk_implicit__find_contacts(const disk_state *s, implicit_state *z, size_t piece,
                                  double margin)
{
    implicit_piece *p = &z->pieces[piece];

    p->overlap = p->overlap_share = 0.0;
    z->bodies.rows[p->static_body] = (solver_body){ .vx = 0.0 };
    if (p->is_rest) {
        // The pairs of the last group stay in their order; those without a contact have an infinite gap.
        contact_geometry m;
        for (size_t k = 0; k < p->n; k++) {
            const size_t at = p->block + k / IMPLICIT_WIDTH, lane = k % IMPLICIT_WIDTH;
            if (find_contact(s, z, &z->blocks[at], lane, margin, &m)) {
                set_contact(s, z, p, k, &m);
                continue;
            }
            z->contacts[at].overlap[lane] = -HUGE_VAL;
            z->blocks[at].normal[lane] = z->blocks[at].sliding[lane] = 0.0;
        }
    } else if (piece >= z->group_piece[IMPLICIT_BOUNDARY]) {
        find_contacts_of_parts(s, z, p, margin);
    } else {
        find_contacts(s, z, p, margin);
    }
    work_on(z, p, 0.0, z->kernels->warm_start);
}

void disk_implicit__solve(implicit_state *z, size_t piece, double excess)
{
    work_on(z, &z->pieces[piece], excess, z->kernels->solve);
}

void disk_implicit__count_contacts(const disk_state *s, const implicit_state *z, disk_contacts *all)
{
    for (size_t piece = 0; piece < z->group_piece[IMPLICIT_GROUPS]; piece++) {
        const implicit_piece *p = &z->pieces[piece];
        for (size_t k = 0; k < p->n; k++) {
            size_t lane;
            const implicit_block *block = implicit_lane(z, p, k, &lane);
            const size_t a = implicit_body(block, 0, lane), b = implicit_body(block, 1, lane);
            contact_geometry m;
            if (a < s->n_live && b < s->n_live &&
                find_contact_of_parts(&s->now[a], &s->now[b], s->radius_min, &m))
                disk__count_contact(s, a, s->id_of[b], -m.gap, fmin(m.radius[0], m.radius[1]), all);
        }
    }
}
