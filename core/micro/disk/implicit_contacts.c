#include "core/base/simd_rows.h"
#include "core/micro/disk/implicit_priv.h"

#include <math.h>
#include <string.h>

// How a pair stands: n from part 0 to part 1.
typedef struct meeting {
    double nx;        // unit normal
    double ny;        //
    double gap;       // m, negative: overlap
    double stiffness; // N/m
    double damping;   // N s/m
    double friction;  // mu
    double rate;      // lambda, s/m
    double vx;        // velocity of 1 minus that of 0, m/s
    double vy;        //
    double give;      // what an impulse along n changes the parting speed by, 1/kg
    double radius[2]; // m; 0 for a solid
    double spin[2];   // rad/s
} meeting;

// False if the parts do not come nearer than `near`.
static bool meet_parts(const disk_state *s, const implicit_pair *pair, double near, meeting *ret_m)
{
    const disk_row *a = &s->now[pair->place[0]], *b = &s->now[pair->place[1]];
    double dx = b->x - a->x, dy = b->y - a->y;
    double reach = a->radius + b->radius + near, square = dx * dx + dy * dy;

    if (!(square < reach * reach))
        return false;
    double distance = sqrt(square), inverse = distance > 0.0 ? 1.0 / distance : 0.0;
    *ret_m = (meeting){ .nx = distance > 0.0 ? dx * inverse : 1.0,
                        .ny = dy * inverse,
                        .gap = distance - (a->radius + b->radius),
                        .stiffness = s->cargo.line / (a->softness + b->softness),
                        .damping = s->cargo.damping,
                        .friction = s->cargo.friction,
                        .rate = s->cargo.tanh_linear,
                        .give = a->inverse_mass + b->inverse_mass,
                        .radius = { a->radius, b->radius } };
    return true;
}

// Outward normal of a face where the part may touch it, and its distance from the face.
static bool face_near(const disk_face *f, const disk_row *part, double reach, meeting *m)
{
    double cx = part->x - f->px, cy = part->y - f->py;
    double along = cx * f->ny - cy * f->nx, off = cx * f->nx + cy * f->ny;

    m->nx = -f->nx;
    m->ny = -f->ny;
    m->gap = off - part->radius;
    m->friction = f->friction;
    return along >= f->from && along < f->to && off > -f->depth && off < reach;
}

static bool arc_near(const disk_arc *a, const disk_row *part, double reach, meeting *m)
{
    double cx = part->x - a->px, cy = part->y - a->py;
    double distance = sqrt(cx * cx + cy * cy), off = distance - a->radius;

    if (!(cx * a->ex + cy * a->ey >= 0.0 && cx * a->fx + cy * a->fy > 0.0 && off > 0.0 &&
          off < reach))
        return false;
    m->nx = -cx / distance;
    m->ny = -cy / distance;
    m->gap = off - part->radius;
    m->friction = a->friction;
    return true;
}

static bool meet_solid(const disk_state *s, const implicit_pair *pair, double near, meeting *ret_m)
{
    const disk_row *part = &s->now[pair->place[0]];
    size_t feature = pair->number[1] - s->n;
    meeting m = { .stiffness = s->handling.line / (part->softness + s->handling_softness),
                  .damping = s->handling.damping,
                  .rate = s->handling.tanh_linear,
                  .give = part->inverse_mass,
                  .radius = { part->radius, 0.0 } };
    double reach = part->radius + near;
    bool is_near = feature < s->n_faces ? face_near(&s->faces[feature], part, reach, &m)
                                        : arc_near(&s->arcs[feature - s->n_faces], part, reach, &m);

    if (is_near)
        *ret_m = m;
    return is_near;
}

static void set_lane(const disk_state *s, const implicit_state *z, size_t index, const meeting *m,
                     implicit_block *block, size_t lane)
{
    const implicit_pair *pair = &z->pairs[index];
    const double h = s->def.dt, overlap = -m->gap, pressed = overlap > 0.0 ? overlap : 0.0;
    const double joint = h * m->stiffness + m->damping, scale = 1.0 / (1.0 + h * joint * m->give);

    block->pair[lane] = (uint32_t)index;
    block->row[0][lane] = pair->place[0] * LANES_ROW;
    if (pair->number[1] < s->n)
        block->row[1][lane] = pair->place[1] * LANES_ROW;
    block->nx[lane] = m->nx;
    block->ny[lane] = m->ny;
    block->bias[lane] = (joint * overlap - m->damping * pressed) * scale;
    block->gain[lane] = h * joint * scale;
    block->floor[lane] = s->def.tension && overlap > 0.0 ? -HUGE_VAL : 0.0;
    block->friction[lane] = m->friction;
    block->rate[lane] = m->rate;
    block->lever[0][lane] = m->radius[0] - 0.5 * overlap;
    block->lever[1][lane] = m->radius[1] - 0.5 * overlap;
    block->normal[lane] = pair->normal;
    block->sliding[lane] = pair->sliding;
}

static void clear_block(implicit_block *block, uint32_t ground)
{
    memset(block, 0, sizeof *block);
    for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane++) {
        block->row[0][lane] = block->row[1][lane] = ground * LANES_ROW;
        block->pair[lane] = UINT32_MAX;
    }
}

static void raise_overlap(implicit_piece *p, const meeting *m)
{
    double small = m->radius[1] > 0.0 && m->radius[1] < m->radius[0] ? m->radius[1] : m->radius[0];

    p->overlap = -m->gap > p->overlap ? -m->gap : p->overlap;
    p->share = -m->gap > p->share * small ? -m->gap / small : p->share;
}

void disk_implicit__meet(const disk_state *s, implicit_state *z, size_t piece, double near)
{
    implicit_piece *p = &z->pieces[piece];
    const size_t width = p->is_rest ? 1 : IMPLICIT_WIDTH;
    size_t n = 0;

    p->overlap = p->share = 0.0;
    for (size_t k = p->first; k < p->last; k++) {
        implicit_pair *pair = &z->pairs[k];
        meeting m = { 0 };
        if (!(pair->number[1] < s->n ? meet_parts(s, pair, near, &m)
                                     : meet_solid(s, pair, near, &m))) {
            pair->normal = pair->sliding = 0.0;
            continue;
        }
        implicit_block *block = &z->blocks[p->block + n / width];
        if (n % width == 0)
            clear_block(block, p->ground);
        set_lane(s, z, k, &m, block, n++ % width);
        raise_overlap(p, &m);
    }
    p->n_blocks = (n + width - 1) / width;
    z->kernels->begin(z->bodies, &z->blocks[p->block], p->n_blocks);
}

void disk_implicit__keep(implicit_state *z, size_t piece)
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
